"""What follows from theorem 1: bounds on tr P, one output, stable plants, no process noise, unit noise intensity."""

from __future__ import annotations

from collections.abc import Sequence

from derive.context import Theory
from derive.functions import Definite, Infinity, Limit, Log, Max, Quotient
from derive.spectral import At, Det, Entry, Modulus, RealPart, Total
from derive.terms import Equation, Glyph, Identity, Neg, Product, Term, Trace, Zero
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import (
    factor,
    log_spectrum,
    on_axis,
    output_cost,
    resolvent,
    spectrum_ratio,
    unstable,
)
from derive.theory.spectrum_roots import HALF, SOURCE, axis, over_roots, whole


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the bounds and the special cases."""
    C, W, V, P, K, Phi, L = (t.symbols[k] for k in ("C", "W", "V", "P", "K", "Phi_y", "L"))
    one, size, s = Identity("l"), Identity("m"), t.symbols["s"]
    t.assume("P >= 0", P, "⪰", Zero("m", "m"), "a covariance")
    low, high = (
        t.scalar(n, Glyph("λ", sub=k), nonnegative=True, meaning=f"{w} eigenvalue of C'V^-1C")
        for n, k, w in (("λmin", "min", "least"), ("λmax", "max", "largest"))
    )
    information = C.T * V.inv * C
    t.assume("least eigenvalue", information - low * size, "⪰", Zero("m", "m"), "the least eigenvalue of C'V⁻¹C")
    t.assume("largest eigenvalue", high * size - information, "⪰", Zero("m", "m"), "the largest eigenvalue of C'V⁻¹C")
    t.assume("λmin > 0", low, ">", text="C has full column rank", case=True)
    t.assume("λmax > 0", high, ">", text="C is not zero", case=True)
    t.atom("reciprocal", low, "λmin > 0", "1/λmin")
    t.atom("reciprocal", high, "λmax > 0", "1/λmax")
    root = t.matrix("V^1/2", "l", "l", Glyph("V", sup="1/2"), symmetric=True, meaning="square root of V")
    t.assume("root of V > 0", root, "≻", Zero("l", "l"), "the positive definite root")
    t.inverse("V^-1/2", root, "l", symmetric=True, because="root of V > 0")
    t.define("root of V", root * root, V)
    variance = t.scalar("σ_v^2", Glyph("σ", sub="v", sup="2"), nonnegative=True, meaning="intensity of one noise")
    t.assume("σ_v^2 > 0", variance, ">", text="the output is noisy")
    t.atom("reciprocal", variance, "σ_v^2 > 0", "1/σ_v^2")
    t.fact("l = 1", "single", one, "one output", case=True)
    t.assume("V = σ_v^2", V, "=", variance * one, "one intensity", case=True)
    t.assume("σ_v^2 = 1", variance, "=", ONE, "unit intensity", case=True)
    t.assume("V = I", V, "=", one, "unit intensity", case=True)
    t.assume("W = 0", W, "=", Zero("m", "m"), "no process noise", case=True)
    B = t.matrix("B", "m", "1", meaning="input of one process noise")
    t.assume("W = BB'", W, "=", B * B.T, "one process noise of unit intensity", case=True)
    t.assume("A stable", Neg(RealPart(t.symbols["λ"])), ">", text="the plant is stable", case=True)
    t.assume("CK = 0", C * K, "=", Zero("l", "l"), "all entries of L have two more poles than zeros", case=True)
    Phi_z = t.matrix("Phi_z", "l", "l", Glyph("Φ", sub="z"), show_args=("s",), meaning="spectrum of the true output")
    t.complex.add("Phi_z")
    t.define("Phi_z", Phi_z, C * resolvent(t) * W * resolvent(t, -1).T * C.T)
    for name, body in (
        ("P", P), ("CPC'", C * P * C.T), ("V", V), ("Phi_y", Phi), ("Phi_z", Phi_z), ("Sigma", t.symbols["Sigma"]),
        ("response", response(t)), ("symmetric form", root.inv * C * P * C.T * root.inv),
    ):  # fmt: skip
        t.atom("spectral", Trace(body), name=f"tr {name}")
    t.atom("spectral", Det(Phi_z + V), name="det(Phi_z + V)")
    t.atom("reciprocal", ONE + Entry(L), "1 + L is regular", "1/(1+L)")
    for name, ratio in ratios(t).items():
        log = Log(At(ratio, s, axis(t)))
        t.atom("spectral", log, name=f"ln {name}")
        t.atom("improper", log, name=f"integral of ln {name}")
    bode = Quotient(ONE, ONE + Entry(L))
    t.atom("spectral", on_axis(t, bode), name="ln|1/(1+L)|")
    t.atom("improper", on_axis(t, bode), name="integral of ln|1/(1+L)|")


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
    """Derive the bounds and every special case of the source."""
    _derive_feedback(b)
    _derive_bounds(b)
    _derive_one_output(b)
    _derive_stable(b)
    _derive_one_input(b)
    _derive_no_noise(b)
    _derive_unit(b)


def _relog(b: SpectrumBuilder, name: str, reason: str, using: Sequence[str]) -> Term:
    """Derive that det Phi_y / det V is another function in a special case, and so is the integral of its logarithm."""
    t = b.theory
    ratio, old, w = ratios(t)[name], spectrum_ratio(t), t.symbols["ω"]
    log = Log(At(ratio, t.symbols["s"], axis(t)))
    b.state(f"spectrum: {name}", Equation(ratio, "=", old), reason, using)
    b.linked(
        f"logarithm: {name}",
        Equation(log, "=", log_spectrum(t)),
        "same argument",
        "the same function",
        [f"spectrum: {name}"],
    )
    halves = [Definite(x, w, ZERO, Infinity()) for x in (log, log_spectrum(t))]
    b.linked(
        f"integral: {name}",
        Equation(halves[0], "=", halves[1]),
        "same argument",
        "the same integrand",
        [f"logarithm: {name}"],
    )
    return whole(b, log)


def _derive_feedback(b: SpectrumBuilder) -> None:
    t = b.theory
    C, K, L, s = (t.symbols[k] for k in ("C", "K", "L", "s"))
    bode, sensitivity = Quotient(ONE, Det(Identity("l") + L)), Quotient(ONE, Det(factor(t)))
    logs = [Log(Modulus(At(f, s, s))) for f in (bode, sensitivity)]
    b.heading("The Bode integral: one output, and a faster roll-off")
    b.linked(
        "return difference along the reals",
        Equation(logs[0], "=", logs[1]),
        "same argument",
        "the same function",
        ["return difference"],
    )
    b.state(
        "s ln|1/det(I+L)|", Equation(s * logs[0], "=", s * logs[1]), "the same", ["return difference along the reals"]
    )
    roots = [Total(RealPart(t.symbols[n]), t.symbols["i"], t.symbols["m"]) for n in ("μ", "λ")]
    first = Limit(s * logs[0], s, Infinity())
    b.linked(
        "roll-off by roots",
        Equation(first, "=", roots[0] - roots[1]),
        "same argument",
        "as for the sensitivity",
        ["s ln|1/det(I+L)|"],
    )
    b.say("This limit is zero exactly where the output error is, so for a filter it needs more than detectability:")
    b.state(
        "roll-off",
        Equation(first, "=", Neg(output_cost(t))),
        "the trace of A - KC",
        ["roll-off by roots", "trace by λ", "trace by μ", "trace of KC"],
    )
    b.given("CK = 0")
    b.state(
        "no slope", Equation(Trace(C * K), "=", Trace(Zero("l", "l"))), "sL(s) tends to CK", ["CK = 0"], rule="trace"
    )
    b.state(
        "fast roll-off",
        Equation(first, "=", ZERO),
        "then tr CK = 0",
        ["trace by λ", "trace by μ", "trace of KC", "no slope", "trace of CK"],
        number="23",
        source=SOURCE,
    )
    single = Quotient(ONE, ONE + Entry(L))
    b.say("For one output a determinant is the number itself:")
    b.linked("det of one entry", Equation(Det(Identity("l") + L), "=", Entry(Identity("l") + L)), "single", "l = 1", [])
    b.sign(
        "1 + L is regular",
        Equation(ONE + Entry(L), "≠", ZERO),
        "as before",
        ["product u(s) μ ≠ 0"],
        identities=["det of one entry", "factor by its roots", "det(I + L)"],
    )
    b.state("one return difference", Equation(single, "=", bode), "l = 1", ["det of one entry"])
    b.linked(
        "ln of one return difference",
        Equation(on_axis(t, single), "=", on_axis(t, bode)),
        "same argument",
        "the same function",
        ["one return difference"],
    )
    w = t.symbols["ω"]
    halves = [Definite(on_axis(t, f), w, ZERO, Infinity()) for f in (single, bode)]
    b.linked(
        "integral of one return difference",
        Equation(halves[0], "=", halves[1]),
        "same argument",
        "the same integrand",
        ["ln of one return difference"],
    )
    slope = Limit(HALF * s * Entry(L), s, Infinity())
    b.state(
        "Bode integral of one output",
        Equation(whole(b, on_axis(t, single)), "=", Neg(slope) + unstable(t)),
        "(20) for l = 1",
        ["Bode integral of L", "integral of one return difference", "limit of s tr L"],
        number="22",
        source=SOURCE,
    )


def _derive_bounds(b: SpectrumBuilder) -> None:
    t = b.theory
    C, P, V, root, low, high = (t.symbols[k] for k in ("C", "P", "V", "V^1/2", "λmin", "λmax"))
    information, size, cost = C.T * V.inv * C, Identity("m"), output_cost(t)
    b.heading("Bounds on the trace of the error covariance")
    b.given("P >= 0", "least eigenvalue", "largest eigenvalue")
    for name, matrix, fact in (
        ("below", information - low * size, "least eigenvalue"),
        ("above", high * size - information, "largest eigenvalue"),
    ):
        b.positive_number(
            f"trace {name}",
            Equation(Trace(matrix * P), "≥", ZERO),
            "the trace of a product of nonnegative matrices",
            [fact, "P >= 0"],
        )
    b.sign(
        "lower bound",
        Equation(cost, "≥", low * Trace(P)),
        "the trace is linear and cyclic",
        ["trace below"],
        number="26",
        source=SOURCE,
    )
    b.state(
        "symmetric form",
        Equation(cost, "=", Trace(root.inv * C * P * C.T * root.inv)),
        "the trace is cyclic",
        ["root of V", "V^-1", "V^-1/2"],
        rule="trace",
        number="26",
        source=SOURCE,
    )
    b.sign(
        "upper bound",
        Equation(high * Trace(P), "≥", cost),
        "the trace is linear and cyclic",
        ["trace above"],
        number="26",
        source=SOURCE,
    )
    value = whole(b, log_spectrum(t)) + 2 * unstable(t)
    b.say("The first bound needs C ≠ 0, the second full column rank of C:")
    for name, number, fact, bound, left, right in (
        ("trace at least", "27", "λmax > 0", "upper bound", Trace(P), Quotient(ONE, high) * value),
        ("trace at most", "28", "λmin > 0", "lower bound", Quotient(ONE, low) * value, Trace(P)),
    ):
        scale = high if number == "27" else low
        b.given(fact)
        b.sign(
            f"1/{fact}", Equation(Quotient(ONE, scale), ">", ZERO), "a reciprocal has the sign of its number", [fact]
        )
        b.sign(
            name,
            Equation(left, "≥", right),
            "theorem 1",
            [bound, f"1/{fact}"],
            identities=["theorem 1"],
            alone=False,
            number=number,
            source=SOURCE,
        )


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
    C, P, V, Phi, Phi_z, Sigma, variance, root = (
        t.symbols[k] for k in ("C", "P", "V", "Phi_y", "Phi_z", "Sigma", "σ_v^2", "λ")
    )
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
        number="37",
        source=SOURCE,
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
