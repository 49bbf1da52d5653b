"""From the Riccati equation to the spectrum of the output: theorem 1 of the source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from derive.context import Theory
from derive.functions import Abs, Log, Max, Quotient
from derive.spectral import At, Det, ImaginaryPart, RealPart, Roots, Total
from derive.terms import Equation, Glyph, Identity, Neg, Product, Symbol, Term, Trace, Zero
from derive.theory.scalar_continuous import ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_roots import (
    SOURCE,
    axis,
    declare_family,
    declare_integrals,
    derive_family,
    derive_integral,
    derive_root,
    root_integrand,
    whole,
)

GENERIC = "s is a generic point"


@dataclass(frozen=True)
class Filter:
    """A steady filter: names of its gain, its spectrum and its closed loop's eigenvalues, and what its steps end in."""

    gain: str = "K"
    spectrum: str = "Phi_y"
    closed: str = "μ"
    tail: str = ""


PAPER = Filter()
TRACES = ("trace by λ", "trace by μ", "trace of KC")


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the plant, the steady filter, the spectrum of the output and the eigenvalues."""
    A = t.matrix("A", "m", "m", meaning="state matrix")
    C = t.matrix("C", "l", "m", meaning="output matrix")
    W = t.matrix("W", "m", "m", symmetric=True, meaning="intensity of the process noise", unit="[state]^2/[s]")
    V = t.matrix("V", "l", "l", symmetric=True, meaning="intensity of the measurement noise", unit="[output]^2*[s]")
    t.assume("V > 0", V, "≻", Zero("l", "l"), "the output is noisy")
    t.inverse("V^-1", V, "l", symmetric=True, because="V > 0")
    P = t.matrix("P", "m", "m", symmetric=True, meaning="steady error covariance", unit="[state]^2")
    K = t.matrix("K", "m", "l", meaning="steady Kalman gain")
    riccati = A * P + P * A.T + W - P * C.T * V.inv * C * P
    t.assume("Riccati equation", riccati, "=", Zero("m", "m"), "equation (2) of the lecture on the filter")
    t.assume("gain", K, "=", P * C.T * V.inv, "equation (3) of the lecture on the filter")
    Sigma = t.matrix("Sigma", "l", "l", Glyph("Σ", sub="z-ȳ"), symmetric=True, meaning="output error covariance")
    t.assume("output error covariance", Sigma, "=", C * P * C.T, "equation (4) of the lecture on the filter")
    for name, value in (("s", _point(t, 1, A)), ("-s", _point(t, -1, A))):
        t.fact(f"{name} regular", "invertible", value, GENERIC)
        t.inverse(f"({name}I-A)^-1", value, "m", because=f"{name} regular")
    Phi = t.matrix("Phi_y", "l", "l", Glyph("Φ", sub="y"), show_args=("s",), meaning="spectrum of the output")
    t.complex.add("Phi_y")
    t.define("Phi_y", Phi, C * resolvent(t) * W * resolvent(t, -1).T * C.T + V)
    _declare_roots(t)
    _declare_numbers(t)


def resolvent(t: Theory, sign: int = 1) -> Term:
    """Return (sI - A)^-1, or (-sI - A)^-1."""
    return _point(t, sign, t.symbols["A"]).inv


def _point(t: Theory, sign: int, matrix: Term) -> Term:
    """Return sI - M, or -sI - M."""
    s, size = t.symbols["s"], Identity("m")
    return (s * size if sign > 0 else -(s * size)) - matrix


def factor(t: Theory, sign: int = 1, f: Filter = PAPER) -> Term:
    """Return I + C (sI - A)^-1 K."""
    return Identity("l") + t.symbols["C"] * resolvent(t, sign) * t.symbols[f.gain]


def closed_loop(t: Theory, f: Filter = PAPER) -> Term:
    """Return A - KC."""
    return t.symbols["A"] - t.symbols[f.gain] * t.symbols["C"]


def _declare_eigenvalues(t: Theory, root: Symbol, matrix: Term, of: str) -> None:
    i, m, s = (t.symbols[k] for k in ("i", "m", "s"))
    declare_family(t, root, 1, -1)
    for sign in (1, -1):
        body, name = _point(t, sign, matrix), f"eigenvalues {root.name}{'' if sign > 0 else ' at -s'}"
        t.atom("spectral", Det(body), name=f"det of {name}")
        t.define(name, Det(body), Roots(s if sign > 0 else Neg(s), root, i, m), f"the eigenvalues of {of}")
    integrand = root_integrand(t.symbols["ω"], RealPart(root), ImaginaryPart(root))
    t.atom("improper", integrand, name=f"integral of {root.name}")


def declare_filter(t: Theory, f: Filter, glyph: str) -> None:
    """Declare the eigenvalues of the closed loop, and the determinants and traces of one filter."""
    K, C, Phi = (t.symbols[k] for k in (f.gain, "C", f.spectrum))
    closed = t.roots(f.closed, t.symbols["i"], t.symbols["m"], Glyph(glyph, sub="i"), meaning="eigenvalues of A - KC")
    _declare_eigenvalues(t, closed, closed_loop(t, f), "A - KC")
    t.assume("strong solution" + f.tail, Neg(RealPart(closed)), "≥", text="the stabilising solution, or the strong one")
    for name, body in (
        (f.spectrum, Phi), ("factor", factor(t, 1, f)), ("factor at -s", factor(t, -1, f)),
        ("exchanged", Identity("m") + K * C * resolvent(t)),
        ("exchanged at -s", Identity("m") + K * C * resolvent(t, -1)),
    ):  # fmt: skip
        t.atom("spectral", Det(body), name=f"det {name}{f.tail}")
    t.atom("spectral", Trace(K * C), name=f"tr KC{f.tail}")
    declare_integrals(t, f.spectrum, log_spectrum(t, f), closed, t.symbols["λ"])


def _declare_roots(t: Theory) -> None:
    A, i, m = (t.symbols[k] for k in ("A", "i", "m"))
    open_loop = t.roots("λ", i, m, Glyph("λ", sub="i"), of="A", meaning="eigenvalues of A")
    _declare_eigenvalues(t, open_loop, A, "A")
    degree = t.scalar("h", Glyph("h"), meaning="degree of instability")
    t.symbols["h"] = degree = replace(degree, show_args=("A",))
    t.define("degree of instability", degree, Total(Max(RealPart(open_loop)), i, m))


def _declare_numbers(t: Theory) -> None:
    A, C, P, V, Phi, Sigma = (t.symbols[k] for k in ("A", "C", "P", "V", "Phi_y", "Sigma"))
    for name, body in (("V", V), ("Phi_y V^-1", Phi * V.inv)):
        t.atom("spectral", Det(body), name=f"det {name}")
    t.atom("reciprocal", Det(V), "det V > 0", "1/det V")
    declare_filter(t, PAPER, "μ")
    for name, body in (("A", A), ("CPC'V^-1", C * P * C.T * V.inv), ("Sigma V^-1", Sigma * V.inv)):
        t.atom("spectral", Trace(body), name=f"tr {name}")


def spectrum_ratio(t: Theory, f: Filter = PAPER) -> Quotient:
    """Return det Phi_y / det V."""
    return Quotient(Det(t.symbols[f.spectrum]), Det(t.symbols["V"]))


def log_spectrum(t: Theory, f: Filter = PAPER) -> Log:
    """Return ln(det Phi_y(ω) / det V)."""
    return Log(At(spectrum_ratio(t, f), t.symbols["s"], axis(t)))


# ------------------------------------------------------------------------------------------------ theorem 1
def derive(b: SpectrumBuilder) -> None:
    """Derive theorem 1."""
    t = b.theory
    b.heading("Spectral factorisation")
    b.say("The steady filter, and the spectrum of its input continued to all s:")
    b.given("Riccati equation", "gain", "output error covariance", "Phi_y")
    using = ["Phi_y", "Riccati equation", "gain"]
    _derive_open_loop_determinant(b)
    derive_factorisation(b, PAPER, using)
    b.say(
        "Eigenvalues are the roots of the characteristic polynomial; the closed loop has none in the open right half "
        "plane:"
    )
    b.given("eigenvalues λ", "eigenvalues μ", "strong solution")
    derive_eigenvalues(b, t.symbols["λ"], t.symbols["A"])
    derive_spectrum(b, PAPER)
    _derive_theorem(b)


def _derive_open_loop_determinant(b: SpectrumBuilder) -> None:
    V = b.theory.symbols["V"]
    b.positive_number("det V > 0", Equation(Det(V), ">", ZERO), "a positive definite matrix", ["V > 0"])


def derive_factorisation(b: SpectrumBuilder, f: Filter, using: Sequence[str]) -> None:
    """Derive the spectral factors of a filter, and their determinants by those of open and closed loop."""
    t = b.theory
    A, C, K, V, Phi = (t.symbols[k] for k in ("A", "C", f.gain, "V", f.spectrum))
    inverses, one, other = ["(sI-A)^-1", "(-sI-A)^-1"], factor(t, 1, f), factor(t, -1, f)
    b.state(
        "spectral factorisation" + f.tail,
        Equation(Phi, "=", one * V * other.T),
        "the Riccati equation, and both inverses",
        [*using, "V^-1", *inverses],
    )
    dets = Product((Det(one), Det(V), Det(other.T)))
    b.state(
        "determinant of the spectrum" + f.tail,
        Equation(Det(Phi), "=", dets),
        "the determinant of a product",
        ["spectral factorisation" + f.tail],
        rule="determinant",
    )
    for sign, where, inverse in ((1, "", inverses[0]), (-1, " at -s", inverses[1])):
        exchanged, name = Identity("m") + K * C * resolvent(t, sign), where + f.tail
        b.linked(
            "exchange" + name,
            Equation(Det(factor(t, sign, f)), "=", Det(exchanged)),
            "exchange",
            "det(I + XY) = det(I + YX)",
            [],
        )
        product = Product((Det(exchanged), Det(_point(t, sign, A))))
        b.state(
            "open and closed loop" + name,
            Equation(product, "=", Det(_point(t, sign, closed_loop(t, f)))),
            "the determinant of a product",
            [inverse],
            rule="determinant",
        )


def derive_eigenvalues(b: SpectrumBuilder, root: Symbol, matrix: Term) -> None:
    """Derive the trace by the eigenvalues, and put them into the lemmas about one root."""
    t, name = b.theory, f"characteristic polynomial {root.name}"
    s, i, m = (t.symbols[k] for k in ("s", "i", "m"))
    b.state(
        name, Equation(Det(_point(t, 1, matrix)), "=", Roots(s, root, i, m)), "definition", [f"eigenvalues {root.name}"]
    )
    b.linked(
        f"trace by {root.name}",
        Equation(Trace(matrix), "=", Total(RealPart(root), i, m)),
        "trace of roots",
        "the trace is the sum of the eigenvalues",
        [name],
    )
    derive_root(b, root)
    derive_family(b, root, reals=-1)


def derive_spectrum(b: SpectrumBuilder, f: Filter) -> None:
    """Derive the log-integral of the spectrum by the eigenvalues of closed and open loop."""
    t = b.theory
    s, i, m, open_loop, closed = (t.symbols[k] for k in ("s", "i", "m", "λ", f.closed))
    derive_eigenvalues(b, closed, closed_loop(t, f))
    for sign, where in ((1, ""), (-1, " at -s")):
        point, name = s if sign > 0 else Neg(s), where + f.tail
        ratio = Quotient(Roots(point, closed, i, m), Roots(point, open_loop, i, m))
        b.state(
            "factor by its roots" + name,
            Equation(Det(factor(t, sign, f)), "=", ratio),
            "closed loop over open loop",
            [
                "exchange" + name,
                "open and closed loop" + name,
                "eigenvalues λ" + where,
                f"eigenvalues {f.closed}" + where,
            ],
        )
    top, bottom = (Product((Roots(s, r, i, m), Roots(Neg(s), r, i, m))) for r in (closed, open_loop))
    factors = [
        f"{n}{f.tail}" for n in ("determinant of the spectrum", "factor by its roots", "factor by its roots at -s")
    ]
    b.state(
        "spectrum by its roots" + f.tail,
        Equation(spectrum_ratio(t, f), "=", Quotient(top, bottom)),
        "both factors",
        factors,
    )
    re, name = RealPart(closed), "closed loop" + f.tail
    b.equal(
        name,
        Equation(Abs(re), "=", Neg(re)),
        [f"|Re {closed.name}| ≥ 0", "strong solution" + f.tail],
        reason="the closed loop is stable",
    )
    b.linked(
        name + ", summed",
        Equation(Total(Abs(re), i, m), "=", Total(Neg(re), i, m)),
        "sum over",
        "summed over the eigenvalues",
        [name],
    )
    derive_integral(b, f.spectrum, log_spectrum(t, f), closed, open_loop, "spectrum by its roots" + f.tail)


def output_cost(t: Theory) -> Trace:
    """Return tr(C P C' V^-1)."""
    C, P, V = (t.symbols[k] for k in ("C", "P", "V"))
    return Trace(C * P * C.T * V.inv)


def unstable(t: Theory) -> Total:
    """Return the sum of the positive real parts of the eigenvalues of A."""
    return Total(Max(RealPart(t.symbols["λ"])), t.symbols["i"], t.symbols["m"])


def _derive_theorem(b: SpectrumBuilder) -> None:
    t = b.theory
    C, K, V, Sigma = (t.symbols[k] for k in ("C", "K", "V", "Sigma"))
    b.heading("Theorem 1: the error covariance by the spectrum")
    b.state(
        "trace of KC",
        Equation(Trace(K * C), "=", output_cost(t)),
        "the trace is cyclic",
        ["gain", "V^-1"],
        rule="trace",
    )
    b.given("degree of instability", numbers=("14",), source=SOURCE)
    b.state(
        "output error",
        Equation(Trace(Sigma * V.inv), "=", output_cost(t)),
        "equation (4)",
        ["output error covariance"],
        rule="trace",
        number="12",
        source=SOURCE,
    )
    b.state(
        "theorem 1",
        Equation(output_cost(t), "=", whole(b, log_spectrum(t)) + 2 * unstable(t)),
        "|x| = 2 max(0, x) - x; the traces of A cancel",
        ["log-integral of Phi_y", "closed loop, summed", "modulus of λ, summed", *TRACES],
        number="12",
        source=SOURCE,
    )
