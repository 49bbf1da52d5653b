"""The scalar Riccati equation in discrete time: both roots, predictor and filter, and the degenerate cases."""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import Abs, Max, Quotient, Root
from derive.terms import Equation, Glyph, Number, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square

RECIPROCAL = "a reciprocal has the sign of its number"


def recursion(A: Term, C: Term, Q: Term, R: Term, P: Term) -> Term:
    """Return A^2 P R/(C^2 P + R) + Q."""
    return Quotient(square(A) * P * R, square(C) * P + R) + Q


def linear(A: Term, C: Term, Q: Term, R: Term) -> Term:
    """Return A^2 R + C^2 Q - R."""
    return square(A) * R + square(C) * Q - R


def innovation(A: Term, C: Term, Q: Term, R: Term, T: Term) -> Term:
    """Return the innovation covariance C^2 M + R of the upper root M without a division by C."""
    return Number(Fraction(1, 2)) * (square(A) * R + square(C) * Q + R + T)


def declare(t: Theory) -> None:
    """Declare covariances and roots."""
    Q, R = (
        t.scalar("Q", meaning="covariance of the process noise"),
        t.scalar("R", meaning="covariance of the sensor noise"),
    )
    t.assume("R > 0", R, ">", text="the output is noisy")
    t.assume("Q >= 0", Q, "≥", text="a covariance is not negative")
    t.atom("reciprocal", R, "R > 0", "1/R")
    declare_roots(t, t.symbols["A"], t.symbols["C"], Q, R)
    _declare_cases(t)


def declare_roots(
    t: Theory, A: Term, C: Term, Q: Term, R: Term, tail: str = "", sub: str = "", letter: str = "P"
) -> None:
    """Declare b, T and both roots of a discrete Riccati equation."""
    beta, T = t.scalar("b" + tail, Glyph("b", sub=sub)), t.scalar("T" + tail, Glyph("T", sub=sub))
    t.define("b" + tail, beta, linear(A, C, Q, R))
    t.atom("root", square(beta) + 4 * square(C) * Q * R, "discrete radicand" + tail, "discrete root" + tail)
    t.define("T" + tail, T, Root(square(beta) + 4 * square(C) * Q * R))
    for name, sign, sup in (("M", T, ""), ("M-", -T, "-")):
        M = t.scalar(
            name + tail, Glyph(letter, sub=sub, sup="d" + sup), meaning="steady covariance of the predicted state"
        )
        t.define(name + tail, M, Quotient(beta + sign, 2 * square(C)))
    upper = t.symbols["M" + tail]
    t.atom("reciprocal", square(C) * upper + R, "C^2 M + R > 0" + tail, "1/(C^2 M+R)" + tail)


def _declare_cases(t: Theory) -> None:
    A, C, Q, R, M = (t.symbols[k] for k in ("A", "C", "Q", "R", "M"))
    sigma = square(C) * M + R
    L, filter_gain = t.scalar("L", meaning="gain of the predictor"), t.scalar("L_f", Glyph("L", sub="f"))
    t.define("L", L, Quotient(A * M * C, sigma))
    t.define("L_f", filter_gain, Quotient(M * C, sigma))
    plus = t.scalar("M+", Glyph("P", sup="+"), meaning="steady covariance after the measurement")
    t.define("M+", plus, Quotient(M * R, sigma))
    t.assume("T > b", t.symbols["T"], ">", t.symbols["b"], "noise excites the state, or the state is stable", case=True)
    t.atom("reciprocal", t.symbols["T"] - t.symbols["b"], "T > b", "1/(T-b)")
    m = t.scalar("m", meaning="the covariance without a division by C")
    t.define("m", m, Quotient(2 * Q * R, t.symbols["T"] - t.symbols["b"]))
    t.atom("reciprocal", square(C) * m + R, "C^2 m + R > 0", "1/(C^2 m+R)")
    t.assume("T > 0", t.symbols["T"], ">", text="no mode on the circle that is not excited", case=True)
    t.assume("Q = 0", Q, "=", text="no process noise", case=True)
    t.assume("A^2 = 1", square(A), "=", ONE, "a mode on the circle", case=True)
    t.atom("absolute", square(A) - ONE, name="|A^2-1|")
    t.atom("part", square(A) - ONE, name="max(0,A^2-1)")


def derive(b: ScalarBuilder) -> None:
    """Derive the steady roots and their cases."""
    _derive_roots(b)
    _derive_stability(b)
    _derive_cases(b)


def derive_signs(b: ScalarBuilder, C: Term, Q: Term, q_fact: str, tail: str = "") -> None:
    """Derive that the radicand, T ± b, the upper root and its innovation covariance have the signs they need."""
    s = b.theory.symbols
    R, beta, T, M = s["R"], s["b" + tail], s["T" + tail], s["M" + tail]
    b.sign(
        "discrete radicand" + tail, Equation(square(beta) + 4 * square(C) * Q * R, "≥", ZERO),
        "squares and products of nonnegative numbers", [q_fact, "R > 0"], squares=[beta, C],
    )  # fmt: skip
    b.sign("T >= 0" + tail, Equation(T, "≥", ZERO), "a square root", [f"discrete root{tail} ≥ 0"])
    facts = ["T >= 0" + tail, q_fact, "R > 0"]
    for name, x in (("T + b >= 0", T + beta), ("T - b >= 0", T - beta)):
        b.sign(name + tail, Equation(x, "≥", ZERO), "T is at least |b|", facts, squares=[C], degree=3)
    b.sign(
        "M >= 0" + tail, Equation(M, "≥", ZERO), "the upper root is a covariance", ["T + b >= 0" + tail],
        squares=[Quotient(ONE, C)],
    )  # fmt: skip
    b.sign(
        "C^2 M + R > 0" + tail, Equation(square(C) * M + R, ">", ZERO), "an innovation covariance",
        ["M >= 0" + tail, "R > 0"], squares=[C],
    )  # fmt: skip


def _derive_roots(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, M = (s[k] for k in ("A", "C", "Q", "R", "M"))
    b.heading("Discrete time: the steady covariance")
    b.given("R > 0", "Q >= 0", "b")
    derive_signs(b, C, Q, "Q >= 0")
    b.given("T", "M")
    b.state("discrete Riccati equation", Equation(M, "=", recursion(A, C, Q, R, M)), "the upper root")
    b.say("The other root solves the same equation, multiplied out:")
    b.given("M-")
    for name in ("M", "M-"):
        X = s[name]
        b.state(
            f"quadratic equation of {name}",
            Equation(square(C) * square(X) - s["b"] * X - Q * R, "=", ZERO), "insert the root",
        )  # fmt: skip
    b.state(
        "both innovation covariances",
        Equation((square(C) * M + R) * (square(C) * s["M-"] + R), "=", square(A) * square(R)),
        "so one closed loop is inside the circle where the other is outside",
    )


def _derive_stability(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, M, L, T, plus = (s[k] for k in ("A", "C", "Q", "R", "M", "L", "T", "M+"))
    sigma = square(C) * M + R
    b.heading("Gain, predictor and filter")
    b.given("L", "L_f", "M+")
    loop = A - L * C
    b.state("discrete closed loop", Equation(loop, "=", Quotient(A * R, sigma)), "insert the gain")
    for name, x in (("Σ - A R >= 0", sigma - A * R), ("Σ + A R >= 0", sigma + A * R)):
        root = A - ONE if "-" in name else A + ONE
        b.sign(
            name, Equation(x, "≥", ZERO), "half of (A ∓ 1)^2 R + C^2 Q + T", ["T >= 0", "R > 0", "Q >= 0"],
            squares=[root, C],
        )  # fmt: skip
    b.sign(
        "1/Σ > 0", Equation(Quotient(ONE, sigma), ">", ZERO), RECIPROCAL,
        ["C^2 M + R > 0"],
    )  # fmt: skip
    b.state(
        "distance to the circle",
        Equation(ONE - square(loop), "=", Quotient((sigma - A * R) * (sigma + A * R), square(sigma))),
        "common denominator", ["discrete closed loop"],
    )  # fmt: skip
    b.sign(
        "not outside the circle", Equation(ONE - square(loop), "≥", ZERO), "a product of nonnegative numbers",
        ["Σ - A R >= 0", "Σ + A R >= 0", "1/Σ > 0"], identities=["distance to the circle"], degree=5,
    )  # fmt: skip
    b.given("T > 0")
    for name, x in (("Σ - A R > 0", sigma - A * R), ("Σ + A R > 0", sigma + A * R)):
        root = A - ONE if "-" in name else A + ONE
        b.sign(name, Equation(x, ">", ZERO), "T is positive", ["T > 0", "R > 0", "Q >= 0"], squares=[root, C])
    b.sign(
        "inside the circle", Equation(ONE - square(loop), ">", ZERO), "a product of positive numbers",
        ["Σ - A R > 0", "Σ + A R > 0", "1/Σ > 0"], identities=["distance to the circle"], degree=5,
    )  # fmt: skip
    b.state(
        "radicand in factors",
        Equation(square(T), "=", (square(A - ONE) * R + square(C) * Q) * (square(A + ONE) * R + square(C) * Q)),
        "so T is zero only for A^2 = 1 without excitation",
    )
    b.state("M from its definition", Equation(M, "=", Quotient(s["b"] + T, 2 * square(C))), "the upper root")
    b.state("filtered covariance", Equation(plus, "=", Quotient(M * R, sigma)), "the definition")
    b.state("predictor from filter", Equation(M, "=", square(A) * plus + Q), "the Riccati equation")
    b.state("filter from predictor", Equation(plus, "=", (ONE - s["L_f"] * C) * M), "insert the gain")
    b.state("gains", Equation(L, "=", A * s["L_f"]), "insert both")


def _derive_cases(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, M, T, m = (s[k] for k in ("A", "C", "Q", "R", "M", "T", "m"))
    b.heading("Degenerate cases in discrete time")
    b.say("A form without a division by ", C, ":")
    b.given("T > b", "m")
    b.sign("1/(T-b) > 0", Equation(Quotient(ONE, T - s["b"]), ">", ZERO), RECIPROCAL, ["T > b"])
    b.sign("m >= 0", Equation(m, "≥", ZERO), "of nonnegative numbers", ["1/(T-b) > 0", "Q >= 0", "R > 0"])
    b.sign(
        "C^2 m + R > 0",
        Equation(square(C) * m + R, ">", ZERO),
        "an innovation covariance",
        ["m >= 0", "R > 0"],
        squares=[C],
    )
    b.state(
        "discrete Riccati equation without a division by C",
        Equation(m, "=", recursion(A, C, Q, R, m)),
        "T^2 - b^2 = 4 C^2 Q R",
    )
    b.state("same discrete covariance", Equation(M, "=", m), "multiply by T - b")
    b.sign(
        "C^2 Q + R > 0",
        Equation(square(C) * Q + R, ">", ZERO),
        "an innovation covariance",
        ["Q >= 0", "R > 0"],
        squares=[C],
    )
    b.equal("T for A = 0", Equation(T, "=", square(C) * Q + R), ["T >= 0", "C^2 Q + R > 0"], identities=["A = 0"])
    b.state(
        "b in factors", Equation(s["b"], "=", (A - ONE) * (A + ONE) * R + square(C) * Q), "no cancellation at |A| = 1"
    )
    b.state("no memory", Equation(M, "=", Q), "only the last disturbance is left", ["T for A = 0", "A = 0"])
    b.given("Q = 0")
    b.sign(
        "R |A^2 - 1| >= 0",
        Equation(R * Abs(square(A) - ONE), "≥", ZERO),
        "a product of nonnegative numbers",
        ["R > 0", "|A^2-1| ≥ 0"],
    )
    b.equal(
        "T for Q = 0", Equation(T, "=", R * Abs(square(A) - ONE)), ["T >= 0", "R |A^2 - 1| >= 0"], identities=["Q = 0"]
    )
    b.equal(
        "|A^2 - 1|", Equation(Abs(square(A) - ONE), "=", 2 * Max(square(A) - ONE) - (square(A) - ONE)),
        ["|A^2-1| ≥ 0", "max(0,A^2-1) ≥ 0", "max(0,A^2-1) ≥ its argument"],
    )  # fmt: skip
    b.state(
        "no process noise in discrete time", Equation(M, "=", Quotient(R * Max(square(A) - ONE), square(C))),
        "zero unless the state is unstable", ["T for Q = 0", "|A^2 - 1|", "Q = 0"],
    )  # fmt: skip
    b.given("A^2 = 1")
    b.state(
        "square of the double root on the circle", Equation(square(M), "=", ZERO), "T^2 = b^2 = 0", ["Q = 0", "A^2 = 1"]
    )
    b.equal(
        "double root on the circle",
        Equation(M, "=", ZERO),
        ["M >= 0"],
        identities=["square of the double root on the circle"],
    )
    b.state("filtered double root", Equation(s["M+"], "=", ZERO), "insert it", ["double root on the circle"])
