"""From the Riccati equation to the spectrum of the output: theorems 1 and 2 of the source, and the Bode integrals."""

from __future__ import annotations

from dataclasses import replace

from derive.context import Theory
from derive.derivation import Evidence
from derive.functions import Abs, Infinity, Limit, Log, Max, Quotient
from derive.spectral import At, Det, Entry, Modulus, RealPart, Roots, Total
from derive.terms import Equation, Glyph, Identity, Neg, Number, Product, Symbol, Term, Trace, Zero
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_roots import (
    HALF,
    SOURCE,
    axis,
    declare_family,
    declare_integrals,
    derive_family,
    derive_first_term,
    derive_integral,
    derive_root,
    on_axis,
    whole,
)

GENERIC = "s is a generic point"


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
    L = t.matrix("L", "l", "l", show_args=("s",), meaning="open loop of the filter")
    t.complex.add("L")
    t.define("L", L, C * resolvent(t) * K)
    _declare_roots(t)
    _declare_numbers(t)


def resolvent(t: Theory, sign: int = 1) -> Term:
    """Return (sI - A)^-1, or (-sI - A)^-1."""
    return _point(t, sign, t.symbols["A"]).inv


def _point(t: Theory, sign: int, matrix: Term) -> Term:
    """Return sI - M, or -sI - M."""
    s, size = t.symbols["s"], Identity("m")
    return (s * size if sign > 0 else -(s * size)) - matrix


def factor(t: Theory, sign: int = 1) -> Term:
    """Return I + C (sI - A)^-1 K."""
    return Identity("l") + t.symbols["C"] * resolvent(t, sign) * t.symbols["K"]


def _declare_roots(t: Theory) -> None:
    A, C, K, i, m, s = (t.symbols[k] for k in ("A", "C", "K", "i", "m", "s"))
    open_loop = t.roots("λ", i, m, Glyph("λ", sub="i"), of="A", meaning="eigenvalues of A")
    closed = t.roots("μ", i, m, Glyph("μ", sub="i"), meaning="eigenvalues of A - KC")
    for root, matrix in ((open_loop, A), (closed, A - K * C)):
        declare_family(t, root, 1, -1)
        for sign in (1, -1):
            body, name = _point(t, sign, matrix), f"eigenvalues {root.name}{'' if sign > 0 else ' at -s'}"
            t.atom("spectral", Det(body), name=f"det of {name}")
            t.define(name, Det(body), Roots(s if sign > 0 else Neg(s), root, i, m), f"the eigenvalues of {'A' if root is open_loop else 'A - KC'}")  # fmt: skip
        re, w = RealPart(root), t.symbols["ω"]
        from derive.spectral import ImaginaryPart
        from derive.theory.spectrum_roots import root_integrand

        t.atom("improper", root_integrand(w, re, ImaginaryPart(root)), name=f"integral of {root.name}")
    t.assume("strong solution", Neg(RealPart(closed)), "≥", text="P is the stabilising solution, or the strong one")
    degree = t.scalar("h", Glyph("h"), meaning="degree of instability")
    t.symbols["h"] = degree = replace(degree, show_args=("A",))
    t.define("degree of instability", degree, Total(Max(RealPart(open_loop)), i, m))


def _declare_numbers(t: Theory) -> None:
    A, C, P, K, V, Phi, L, Sigma, s = (t.symbols[k] for k in ("A", "C", "P", "K", "V", "Phi_y", "L", "Sigma", "s"))
    I = Identity("l")
    for name, body in (
        ("Phi_y", Phi), ("V", V), ("Phi_y V^-1", Phi * V.inv), ("factor", factor(t)), ("factor at -s", factor(t, -1)),
        ("exchanged", Identity("m") + K * C * resolvent(t)), ("exchanged at -s", Identity("m") + K * C * resolvent(t, -1)),
        ("I + L", I + L),
    ):  # fmt: skip
        t.atom("spectral", Det(body), name=f"det {name}")
    for name, body in (
        ("A", A), ("KC", K * C), ("CPC'V^-1", C * P * C.T * V.inv), ("Sigma V^-1", Sigma * V.inv), ("CK", C * K),
        ("L", L), ("CFK", C * resolvent(t) * K), ("CAFK", C * A * resolvent(t) * K),
    ):  # fmt: skip
        t.atom("spectral", Trace(body), name=f"tr {name}")
    t.atom("reciprocal", Det(V), "det V > 0", "1/det V")
    t.atom("reciprocal", Det(factor(t)), "the factor is regular", "1/det factor")
    t.atom("reciprocal", Det(I + L), "I + L is regular", "1/det(I+L)")
    open_loop, closed = t.symbols["λ"], t.symbols["μ"]
    declare_integrals(t, "Phi_y", log_spectrum(t), closed, open_loop)
    sensitivity, bode = Quotient(ONE, Det(factor(t))), Quotient(ONE, Det(I + L))
    declare_integrals(t, "sensitivity", on_axis(t, sensitivity), open_loop, closed)
    t.atom("spectral", Log(Modulus(At(sensitivity, s, s))), name="ln|sensitivity(s)|")
    t.atom("spectral", on_axis(t, bode), name="ln|1/det(I+L)|")
    t.atom("improper", on_axis(t, bode), name="integral of ln|1/det(I+L)|")
    t.atom("spectral", Log(Modulus(At(bode, s, s))), name="ln|1/det(I+L(s))|")


def spectrum_ratio(t: Theory) -> Quotient:
    """Return det Phi_y / det V."""
    return Quotient(Det(t.symbols["Phi_y"]), Det(t.symbols["V"]))


def log_spectrum(t: Theory) -> Log:
    """Return ln(det Phi_y(ω) / det V)."""
    return Log(At(spectrum_ratio(t), t.symbols["s"], axis(t)))


# ------------------------------------------------------------------------------------------------ theorem 1
def derive(b: SpectrumBuilder) -> None:
    """Derive theorem 1 and the Bode integrals."""
    _derive_factorisation(b)
    _derive_roots(b)
    _derive_theorem(b)
    _derive_bode(b)


def _derive_factorisation(b: SpectrumBuilder) -> None:
    t = b.theory
    A, C, K, V, Phi, s = (t.symbols[k] for k in ("A", "C", "K", "V", "Phi_y", "s"))
    b.heading("Spectral factorisation")
    b.say("The steady filter, and the spectrum of its input continued to all s:")
    b.given("Riccati equation", "gain", "output error covariance", "Phi_y")
    inverses = ["(sI-A)^-1", "(-sI-A)^-1"]
    b.state("spectral factorisation", Equation(Phi, "=", factor(t) * V * factor(t, -1).T), "the Riccati equation, and both inverses", ["Phi_y", "Riccati equation", "gain", "V^-1", *inverses])  # fmt: skip
    dets = Product((Det(factor(t)), Det(V), Det(factor(t, -1).T)))
    b.state("determinant of the spectrum", Equation(Det(Phi), "=", dets), "the determinant of a product", ["spectral factorisation"], rule="determinant")  # fmt: skip
    for sign, name, inverse in ((1, "", inverses[0]), (-1, " at -s", inverses[1])):
        F = resolvent(t, sign)
        b.linked("exchange" + name, Equation(Det(factor(t, sign)), "=", Det(Identity("m") + K * C * F)), "exchange", "det(I + XY) = det(I + YX)", [])  # fmt: skip
        product = Product((Det(Identity("m") + K * C * F), Det(_point(t, sign, A))))
        b.state("open and closed loop" + name, Equation(product, "=", Det(_point(t, sign, A - K * C))), "the determinant of a product", [inverse], rule="determinant")  # fmt: skip
    b.positive_number("det V > 0", Equation(Det(V), ">", ZERO), "a positive definite matrix", ["V > 0"])


def _derive_roots(b: SpectrumBuilder) -> None:
    t = b.theory
    A, K, C, s, i, m, open_loop, closed = (t.symbols[k] for k in ("A", "K", "C", "s", "i", "m", "λ", "μ"))
    b.say("Eigenvalues are the roots of the characteristic polynomial; the closed loop has none in the open right half plane:")
    b.given("eigenvalues λ", "eigenvalues μ", "strong solution")
    for root, matrix in ((open_loop, A), (closed, A - K * C)):
        name = f"characteristic polynomial {root.name}"
        b.state(name, Equation(Det(_point(t, 1, matrix)), "=", Roots(s, root, i, m)), "definition", [f"eigenvalues {root.name}"])  # fmt: skip
        b.linked(f"trace by {root.name}", Equation(Trace(matrix), "=", Total(RealPart(root), i, m)), "trace of roots", "the trace is the sum of the eigenvalues", [name])  # fmt: skip
        derive_root(b, root)
        derive_family(b, root, reals=-1)
    for sign, name in ((1, ""), (-1, " at -s")):
        point = s if sign > 0 else Neg(s)
        ratio = Quotient(Roots(point, closed, i, m), Roots(point, open_loop, i, m))
        b.state("factor by its roots" + name, Equation(Det(factor(t, sign)), "=", ratio), "closed loop over open loop",
                ["exchange" + name, "open and closed loop" + name, "eigenvalues λ" + name, "eigenvalues μ" + name])  # fmt: skip
    top, bottom = (Product((Roots(s, r, i, m), Roots(Neg(s), r, i, m))) for r in (closed, open_loop))
    b.state("spectrum by its roots", Equation(spectrum_ratio(t), "=", Quotient(top, bottom)), "both factors", ["determinant of the spectrum", "factor by its roots", "factor by its roots at -s"])  # fmt: skip
    b.equal("closed loop", Equation(Abs(RealPart(closed)), "=", Neg(RealPart(closed))), ["|Re μ| ≥ 0", "strong solution"], reason="the closed loop is stable")  # fmt: skip
    b.linked("closed loop, summed", Equation(Total(Abs(RealPart(closed)), i, m), "=", Total(Neg(RealPart(closed)), i, m)), "sum over", "summed over the eigenvalues", ["closed loop"])  # fmt: skip


def output_cost(t: Theory) -> Trace:
    """Return tr(C P C' V^-1)."""
    C, P, V = (t.symbols[k] for k in ("C", "P", "V"))
    return Trace(C * P * C.T * V.inv)


def unstable(t: Theory) -> Total:
    """Return the sum of the positive real parts of the eigenvalues of A."""
    return Total(Max(RealPart(t.symbols["λ"])), t.symbols["i"], t.symbols["m"])


def _derive_theorem(b: SpectrumBuilder) -> None:
    t = b.theory
    A, C, P, K, V, Sigma, open_loop, closed = (t.symbols[k] for k in ("A", "C", "P", "K", "V", "Sigma", "λ", "μ"))
    b.heading("Theorem 1: the error covariance by the spectrum")
    derive_integral(b, "Phi_y", log_spectrum(t), closed, open_loop, "spectrum by its roots")
    b.state("trace of KC", Equation(Trace(K * C), "=", output_cost(t)), "the trace is cyclic", ["gain", "V^-1"], rule="trace")
    b.given("degree of instability", numbers=("14",), source=SOURCE)
    b.state("output error", Equation(Trace(Sigma * V.inv), "=", output_cost(t)), "equation (4)", ["output error covariance"], rule="trace", number="12", source=SOURCE)  # fmt: skip
    b.state(
        "theorem 1", Equation(output_cost(t), "=", whole(b, log_spectrum(t)) + 2 * unstable(t)),
        "|x| = 2 max(0, x) - x; the traces of A cancel",
        ["log-integral of Phi_y", "closed loop, summed", "modulus of λ, summed", "trace by λ", "trace by μ", "trace of KC"],
        number="12", source=SOURCE,
    )  # fmt: skip


# ------------------------------------------------------------------------------------------------ Bode integrals
def _derive_bode(b: SpectrumBuilder) -> None:
    t = b.theory
    A, C, K, L, s, i, m, open_loop, closed = (t.symbols[k] for k in ("A", "C", "K", "L", "s", "i", "m", "λ", "μ"))
    b.heading("The Bode integral of the filter")
    sensitivity = Quotient(ONE, Det(factor(t)))
    b.sign("the factor is regular", Equation(Det(factor(t)), "≠", ZERO), "a quotient of polynomials that are not zero",
           ["product u(s) μ ≠ 0"], identities=["factor by its roots"])  # fmt: skip
    b.state("sensitivity by its roots", Equation(sensitivity, "=", Quotient(Roots(s, open_loop, i, m), Roots(s, closed, i, m))), "open loop over closed loop", ["factor by its roots"])  # fmt: skip
    derive_integral(b, "sensitivity", on_axis(t, sensitivity), open_loop, closed, "sensitivity by its roots")
    limit = HALF * Total(RealPart(closed), i, m) - HALF * Total(RealPart(open_loop), i, m)
    first = derive_first_term(b, "sensitivity", sensitivity, [(open_loop, 1)], [(closed, 1)], limit, "sensitivity by its roots")  # fmt: skip
    cost = Neg(HALF * output_cost(t))
    b.say("Its zeros are the eigenvalues of A:")
    sums = ["log-integral of sensitivity", "closed loop, summed", "modulus of λ, summed"]
    integral = whole(b, on_axis(t, sensitivity))
    b.state("sensitivity integral", Equation(integral, "=", first + unstable(t)), "proposition 1 for this function", [*sums, "first term of sensitivity"], number="17", source=SOURCE)  # fmt: skip
    traces = ["trace by λ", "trace by μ", "trace of KC"]
    b.state("sensitivity and cost", Equation(first + unstable(t), "=", cost + unstable(t)), "the trace of A - KC", ["first term of sensitivity", *traces], number="17", source=SOURCE)  # fmt: skip
    b.state("Bode integral", Equation(integral, "=", cost + unstable(t)), "both equations", ["sensitivity integral", "sensitivity and cost"], number="18", source=SOURCE)  # fmt: skip
    _derive_open_loop(b)


def _derive_open_loop(b: SpectrumBuilder) -> None:
    t = b.theory
    A, C, K, L, s, open_loop = (t.symbols[k] for k in ("A", "C", "K", "L", "s", "λ"))
    F, I, sensitivity = resolvent(t), Identity("l"), Quotient(ONE, Det(factor(t)))
    b.say("With the open loop of the filter as a feedback system")
    b.given("L", numbers=("19",), source=SOURCE)
    b.state("det(I + L)", Equation(Det(I + L), "=", Det(factor(t))), "definition", ["L"], rule="determinant")
    b.sign("I + L is regular", Equation(Det(I + L), "≠", ZERO), "as before", ["product u(s) μ ≠ 0"], identities=["factor by its roots", "det(I + L)"])  # fmt: skip
    bode = Quotient(ONE, Det(I + L))
    b.state("return difference", Equation(bode, "=", sensitivity), "definition", ["det(I + L)"])
    b.linked("ln of the return difference", Equation(on_axis(t, bode), "=", on_axis(t, sensitivity)), "same argument", "the same function", ["return difference"])  # fmt: skip
    w = t.symbols["ω"]
    from derive.functions import Definite

    halves = [Definite(on_axis(t, f), w, ZERO, Infinity()) for f in (bode, sensitivity)]
    b.linked("integral of the return difference", Equation(halves[0], "=", halves[1]), "same argument", "the same integrand", ["ln of the return difference"])  # fmt: skip
    b.say("For large s the trace of sL tends to that of CK, because s(sI - A)⁻¹ = I + A(sI - A)⁻¹:")
    b.state("resolvent", Equation(Trace(L), "=", Trace(C * F * K)), "definition", ["L"], rule="trace")
    b.state("s times the resolvent", Equation(Trace(s * (C * F * K)), "=", Trace(C * K) + Trace(C * A * F * K)), "the inverse", ["(sI-A)^-1"], rule="trace")  # fmt: skip
    b.linked("the resolvent vanishes", Equation(Limit(Trace(C * A * F * K), s, Infinity()), "=", ZERO), "resolvent", "its entries are strictly proper", [])  # fmt: skip
    b.state("s tr L", Equation(HALF * s * Trace(L), "=", HALF * Trace(C * K) + HALF * Trace(C * A * F * K)), "both", ["resolvent", "s times the resolvent"])  # fmt: skip
    slope = Limit(HALF * s * Trace(L), s, Infinity())
    b.linked("limit of s tr L", Equation(slope, "=", HALF * Trace(C * K)), "same argument", "the last term vanishes", ["s tr L"])  # fmt: skip
    b.state("trace of CK", Equation(Trace(C * K), "=", output_cost(t)), "the gain", ["gain"], rule="trace")
    b.state("Bode integral of L", Equation(whole(b, on_axis(t, bode)), "=", Neg(slope) + unstable(t)), "the Bode integral", ["integral of the return difference", "Bode integral", "limit of s tr L", "trace of CK"], number="20", source=SOURCE)  # fmt: skip
