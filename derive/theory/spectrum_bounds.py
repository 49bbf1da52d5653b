"""Bounds on the trace of the error covariance, from theorem 1 and the extreme eigenvalues of C'V^-1C."""

from __future__ import annotations

from derive.context import Theory
from derive.functions import Quotient
from derive.terms import Equation, Glyph, Identity, Trace, Zero
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_filter import log_spectrum, output_cost, unstable
from derive.theory.spectrum_roots import SOURCE, whole


def declare(t: Theory) -> None:
    """Declare the extreme eigenvalues of C'V^-1C, and the square root of V."""
    C, P, V, size = t.symbols["C"], t.symbols["P"], t.symbols["V"], Identity("m")
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
    for name, body in (("P", P), ("symmetric form", root.inv * C * P * C.T * root.inv)):
        t.atom("spectral", Trace(body), name=f"tr {name}")


def derive(b: SpectrumBuilder) -> None:
    """Derive (26) to (28)."""
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
