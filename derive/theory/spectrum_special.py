"""Special cases of theorem 1: one output, stable plants, no process noise, unit noise intensity."""

from __future__ import annotations

from collections.abc import Sequence

from derive.context import Theory
from derive.functions import Log, Max, Quotient
from derive.spectral import At, Det, Entry, RealPart, Total
from derive.terms import Equation, Glyph, Identity, Neg, Product, Term, Trace, Zero
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import (
    TRACES,
    closed_loop,
    log_spectrum,
    output_cost,
    resolvent,
    spectrum_ratio,
    unstable,
)
from derive.theory.spectrum_roots import SOURCE, axis, derive_same, over_roots, whole


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the special cases."""
    C, W, V, P, Phi = (t.symbols[k] for k in ("C", "W", "V", "P", "Phi_y"))
    one, s = Identity("l"), t.symbols["s"]
    variance = t.scalar("σ_v^2", Glyph("σ", sub="v", sup="2"), nonnegative=True, meaning="intensity of one noise")
    t.assume("σ_v^2 > 0", variance, ">", text="the output is noisy")
    t.atom("reciprocal", variance, "σ_v^2 > 0", "1/σ_v^2")
    t.assume("V = σ_v^2", V, "=", variance * one, "one intensity", case=True)
    t.assume("σ_v^2 = 1", variance, "=", ONE, "unit intensity", case=True)
    t.assume("V = I", V, "=", one, "unit intensity", case=True)
    t.assume("W = 0", W, "=", Zero("m", "m"), "no process noise", case=True)
    B = t.matrix("B", "m", "1", meaning="input of one process noise")
    t.assume("W = BB'", W, "=", B * B.T, "one process noise of unit intensity", case=True)
    t.assume("A stable", Neg(RealPart(t.symbols["λ"])), ">", text="the plant is stable", case=True)
    Phi_z = t.matrix("Phi_z", "l", "l", Glyph("Φ", sub="z"), show_args=("s",), meaning="spectrum of the true output")
    t.complex.add("Phi_z")
    t.define("Phi_z", Phi_z, C * resolvent(t) * W * resolvent(t, -1).T * C.T)
    for name, body in (
        ("CPC'", C * P * C.T), ("V", V), ("Phi_y", Phi), ("Phi_z", Phi_z), ("Sigma", t.symbols["Sigma"]),
        ("response", response(t)),
    ):  # fmt: skip
        t.atom("spectral", Trace(body), name=f"tr {name}")
    t.atom("spectral", Det(Phi_z + V), name="det(Phi_z + V)")
    for name, ratio in ratios(t).items():
        log = Log(At(ratio, s, axis(t)))
        t.atom("spectral", log, name=f"ln {name}")
        t.atom("improper", log, name=f"integral of ln {name}")


def response(t: Theory) -> Product:
    """Return the response C(sI-A)^-1 B times its mirror image."""
    C, B = t.symbols["C"], t.symbols["B"]
    return C * resolvent(t) * B * (C * resolvent(t, -1) * B).T


def ratios(t: Theory) -> dict[str, Term]:
    """Return the arguments of the logarithms in the special cases."""
    V, Phi, Phi_z, variance = (t.symbols[k] for k in ("V", "Phi_y", "Phi_z", "σ_v^2"))
    return {
        "one output": Quotient(Entry(Phi), variance),
        "one stable output": Quotient(Entry(Phi_z) + variance, variance),
        "one input and output": Entry(response(t)) + ONE,
        "unit intensity": Det(Phi),
        "stable plant": Quotient(Det(Phi_z + V), Det(V)),
    }


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: SpectrumBuilder) -> None:
    """Derive every special case of the source."""
    _derive_one_output(b)
    _derive_stable(b)
    _derive_one_input(b)
    _derive_no_noise(b)
    _derive_unit(b)


def _relog(b: SpectrumBuilder, name: str, reason: str, using: Sequence[str]) -> Term:
    """Derive that det Phi_y / det V is another function in a special case, and so is the integral of its logarithm."""
    t = b.theory
    ratio = ratios(t)[name]
    log = Log(At(ratio, t.symbols["s"], axis(t)))
    b.state(f"spectrum: {name}", Equation(ratio, "=", spectrum_ratio(t)), reason, using)
    derive_same(b, name, log, log_spectrum(t), f"spectrum: {name}")
    return whole(b, log)


def _derive_one_output(b: SpectrumBuilder) -> None:
    t = b.theory
    C, P, V, Phi, W, Sigma, variance = (t.symbols[k] for k in ("C", "P", "V", "Phi_y", "W", "Sigma", "σ_v^2"))
    error, one = C * P * C.T, Identity("l")
    b.heading("Corollary 1: one output")
    b.given("V = σ_v^2")
    b.state(
        "spectrum of one output",
        Equation(Phi, "=", C * resolvent(t) * W * resolvent(t, -1).T * C.T + variance * one),
        "V is a number",
        ["Phi_y", "V = σ_v^2"],
        number="30",
        source=SOURCE,
    )
    b.state(
        "cost of one output",
        Equation(Trace(variance * (error * V.inv)), "=", Trace(error)),
        "V is a number",
        ["V = σ_v^2", "V^-1"],
        rule="trace",
    )
    b.state(
        "V of one output", Equation(Entry(V), "=", Entry(variance * one)), "V is a number", ["V = σ_v^2"], rule="apply"
    )
    for name, matrix in (("Phi_y", Phi), ("V", V)):
        b.linked(f"det {name} of one output", Equation(Det(matrix), "=", Entry(matrix)), "single", "l = 1", [])
    integral = _relog(b, "one output", "l = 1", ["det Phi_y of one output", "det V of one output", "V of one output"])
    b.state(
        "variance of one output",
        Equation(Entry(Sigma), "=", Entry(error)),
        "equation (4)",
        ["output error covariance"],
        rule="apply",
        number="29",
        source=SOURCE,
    )
    right = variance * integral + 2 * variance * unstable(t)
    b.state(
        "corollary 1",
        Equation(Entry(error), "=", right),
        "theorem 1 times the intensity",
        ["theorem 1", "cost of one output", "integral: one output"],
        number="29",
        source=SOURCE,
    )


def _derive_stable(b: SpectrumBuilder) -> None:
    t = b.theory
    V, Phi, Phi_z, Sigma, variance, root = (t.symbols[k] for k in ("V", "Phi_y", "Phi_z", "Sigma", "σ_v^2", "λ"))
    i, m = t.symbols["i"], t.symbols["m"]
    b.heading("A stable plant")
    b.given("A stable", "Phi_z")
    b.equal(
        "no unstable λ",
        Equation(Max(RealPart(root)), "=", ZERO),
        ["max(0,Re λ) ≥ 0", "A stable"],
        reason="it is not positive",
    )
    b.linked(
        "no unstable λ, summed", Equation(unstable(t), "=", Total(ZERO, i, m)), "sum over", "summed", ["no unstable λ"]
    )
    b.say(
        "The integral is then the difference of the second coefficients of the monic characteristic polynomials of "
        "closed and open loop, which are minus the traces:"
    )
    A, closed = t.symbols["A"], closed_loop(t)
    b.state(
        "integral by coefficients",
        Equation(whole(b, log_spectrum(t)), "=", Neg(Trace(closed)) + Trace(A)),
        "all eigenvalues are in the left half plane",
        ["log-integral of Phi_y", "closed loop, summed", "modulus of λ, summed", "no unstable λ, summed", *TRACES[:2]],
    )
    b.state("signal and noise", Equation(Phi, "=", Phi_z + V), "definition", ["Phi_y", "Phi_z"])
    b.state(
        "signal and noise of one output",
        Equation(Entry(Phi), "=", Entry(Phi_z + V)),
        "definition",
        ["Phi_y", "Phi_z"],
        rule="apply",
    )
    known = ["det Phi_y of one output", "det V of one output", "V of one output", "signal and noise of one output"]
    integral = _relog(b, "one stable output", "the spectrum is that of the signal and of the noise", known)
    stable = ["corollary 1", "no unstable λ, summed", "integral: one output"]
    b.state(
        "Yovits-Jackson formula",
        Equation(Entry(Sigma), "=", variance * integral),
        "corollary 1 without unstable poles",
        [*stable, "variance of one output", "integral: one stable output"],
        number="33",
        source=SOURCE,
    )
    b.state(
        "determinant of signal and noise",
        Equation(Det(Phi_z + V), "=", Det(Phi)),
        "the same matrix",
        ["signal and noise"],
        rule="determinant",
    )
    several = _relog(b, "stable plant", "the same matrix", ["determinant of signal and noise"])
    cost = Trace(Sigma * V.inv)
    b.state(
        "stable plant",
        Equation(cost, "=", whole(b, log_spectrum(t))),
        "theorem 1 without unstable poles",
        ["theorem 1", "output error", "no unstable λ, summed"],
        number="39",
        source=SOURCE,
    )
    b.state(
        "Wiener-Masani formula",
        Equation(cost, "=", several),
        "signal and noise",
        ["stable plant", "integral: stable plant"],
        number="39",
        source=SOURCE,
    )


def _derive_one_input(b: SpectrumBuilder) -> None:
    t = b.theory
    C, P, Phi, V = (t.symbols[k] for k in ("C", "P", "Phi_y", "V"))
    product = response(t)
    b.heading("One noise, one output")
    b.given("W = BB'", "σ_v^2 = 1")
    b.say("The squared modulus of the response is the response times its mirror image:")
    b.state("response", Equation(Entry(Phi), "=", Entry(product + V)), "definition", ["Phi_y", "W = BB'"], rule="apply")
    known = ["det Phi_y of one output", "det V of one output", "V of one output", "response", "σ_v^2 = 1"]
    integral = _relog(b, "one input and output", "both intensities are one", known)
    b.state(
        "one input and output",
        Equation(Entry(C * P * C.T), "=", integral + 2 * unstable(t)),
        "corollary 1",
        ["theorem 1", "cost of one output", "σ_v^2 = 1", "integral: one input and output"],
        number="34",
        source=SOURCE,
    )


def _derive_no_noise(b: SpectrumBuilder) -> None:
    t = b.theory
    C, P, V, Phi, s, i, m = (t.symbols[k] for k in ("C", "P", "V", "Phi_y", "s", "i", "m"))
    b.heading("No process noise")
    b.say("The closed loop then has the eigenvalues of A, the unstable ones mirrored:")
    b.given("W = 0")
    b.state(
        "no signal",
        Equation(Det(Phi), "=", Det(V)),
        "only the measurement noise is left",
        ["Phi_y", "W = 0"],
        rule="determinant",
    )
    closed, opened = (Product(tuple(over_roots(t, t.symbols[n], x) for x in (s, Neg(s)))) for n in ("μ", "λ"))
    b.state(
        "mirrored eigenvalues", Equation(closed, "=", opened), "multiply out", ["spectrum by its roots", "no signal"]
    )
    sums = [
        Total(Max(RealPart(t.symbols[n])), i, m) + Total(Max(Neg(RealPart(t.symbols[n]))), i, m) for n in ("μ", "λ")
    ]
    b.linked(
        "mirrored sums",
        Equation(sums[0], "=", sums[1]),
        "same roots",
        "equal polynomials have equal roots",
        ["mirrored eigenvalues"],
    )
    b.state(
        "cost without process noise",
        Equation(output_cost(t), "=", 2 * unstable(t)),
        "the trace of A - KC",
        [
            "mirrored sums",
            "parts of λ, summed",
            "parts of μ, summed",
            "closed loop, summed",
            "modulus of λ, summed",
            "trace by λ",
            "trace by μ",
            "trace of KC",
        ],
    )
    b.state(
        "error without process noise",
        Equation(Entry(C * P * C.T), "=", 2 * unstable(t)),
        "one output of unit intensity",
        ["cost without process noise", "cost of one output", "σ_v^2 = 1"],
        number="36",
        source=SOURCE,
    )


def _derive_unit(b: SpectrumBuilder) -> None:
    t = b.theory
    C, P, V, W, Phi, Sigma = (t.symbols[k] for k in ("C", "P", "V", "W", "Phi_y", "Sigma"))
    one, error = Identity("l"), C * P * C.T
    b.heading("Unit noise intensity")
    b.given("V = I")
    b.state(
        "unit cost", Equation(output_cost(t), "=", Trace(error)), "V is the identity", ["V = I", "V^-1"], rule="trace"
    )
    b.state("unit determinant", Equation(Det(V), "=", Det(one)), "V is the identity", ["V = I"], rule="determinant")
    b.state(
        "trace of the output error",
        Equation(Trace(Sigma), "=", Trace(error)),
        "equation (4)",
        ["output error covariance"],
        rule="trace",
    )
    integral = _relog(b, "unit intensity", "V is the identity", ["unit determinant"])
    b.state(
        "unit intensity",
        Equation(Trace(error), "=", integral + 2 * unstable(t)),
        "theorem 1",
        ["theorem 1", "unit cost", "integral: unit intensity"],
        number="37",
        source=SOURCE,
    )
    b.state(
        "spectrum with unit intensity",
        Equation(Phi, "=", C * resolvent(t) * W * resolvent(t, -1).T * C.T + one),
        "V is the identity",
        ["Phi_y", "V = I"],
        number="38",
        source=SOURCE,
    )
