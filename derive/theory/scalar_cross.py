"""Process and sensor noise that have a part in common: the same closed forms for another plant, in both times."""

from __future__ import annotations

from derive.context import Theory
from derive.functions import Quotient, Root
from derive.terms import Equation, Glyph, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL, declare_roots, derive_signs, innovation


def declare(t: Theory) -> None:
    """Declare the cross terms, and the plants that they lead to."""
    _declare_continuous(t)
    _declare_discrete(t)


def _declare_continuous(t: Theory) -> None:
    A, C, W, V, g = (t.symbols[k] for k in "ACWVg")
    N = t.scalar("N", meaning="cross intensity of the noises")
    t.assume("N^2 <= VW", V * W - square(N), "≥", text="the joint intensity of the noises is not negative")
    F, q = t.scalar("F", meaning="state coefficient without the common noise"), t.scalar("q")
    t.define("F", F, A - Quotient(N * C, V))
    t.define("q", q, W - Quotient(square(N), V))
    t.atom("root", square(F) + g * q, "radicand with N", "root with N")
    S = t.scalar("S_N", Glyph("S", sub="N"), meaning="decay rate with common noise")
    t.define("S_N", S, Root(square(F) + g * q))
    P = t.scalar("P_N", Glyph("P", sub="N"), meaning="error covariance with common noise")
    t.define("P_N", P, Quotient(V * (F + S), square(C)))
    K = t.scalar("K_N", Glyph("K", sub="N"), meaning="gain with common noise")
    t.define("K_N", K, Quotient(P * C + N, V))
    t.assume(
        "S_N > F", S, ">", F, "noise excites the state, or it is stable, once the common noise is removed", case=True
    )
    t.atom("reciprocal", S - F, "S_N > F", "1/(S_N-F)")
    p = t.scalar("p_N", Glyph("p", sub="N"), meaning="error covariance with common noise, without a division by C")
    t.define("p_N", p, Quotient(q, S - F))
    t.assume("F = 0", F, "=", text="an integrator, once the common noise is removed", case=True)
    t.assume("q = 0", q, "=", text="all process noise is seen by the sensor", case=True)


def _declare_discrete(t: Theory) -> None:
    A, C, Q, R = (t.symbols[k] for k in "ACQR")
    N = t.scalar("S_d", Glyph("S", sup="d"), meaning="cross covariance of the noises")
    t.assume("S^2 <= QR", Q * R - square(N), "≥", text="the joint covariance of the noises is not negative")
    F, q = t.scalar("F_d", Glyph("F", sup="d")), t.scalar("q_d", Glyph("q", sup="d"))
    t.define("F_d", F, A - Quotient(N * C, R))
    t.define("q_d", q, Q - Quotient(square(N), R))
    declare_roots(t, F, C, q, R, "_S", "S")
    beta, T, M = (t.symbols[k] for k in ("b_S", "T_S", "M_S"))
    L = t.scalar("L_S", Glyph("L", sub="S"), meaning="gain of the predictor with common noise")
    t.define("L_S", L, Quotient(A * M * C + N, square(C) * M + R))
    half = innovation(F, C, q, R, T)
    t.atom("reciprocal", half, "half with common noise > 0", "1/(half with common noise)")
    t.assume("T_S > 0", T, ">", text="no mode on the circle that is not excited", case=True)
    t.assume("T_S > b_S", T, ">", beta, "noise excites the state, or it is stable", case=True)
    t.atom("reciprocal", T - beta, "T_S > b_S", "1/(T_S-b_S)")
    t.assume("q_d = 0", q, "=", text="all process noise is seen by the sensor", case=True)
    t.assume("F_d^2 = 1", square(F), "=", ONE, "a mode on the circle", case=True)


def derive(b: ScalarBuilder) -> None:
    """Derive what a common noise changes."""
    _derive_continuous(b)
    _derive_alternatives(b)
    _derive_discrete(b)
    _derive_circle(b)


def _derive_continuous(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, N, F, q, g, S, P, K = (s[k] for k in ("A", "C", "W", "V", "N", "F", "q", "g", "S_N", "P_N", "K_N"))
    b.heading("Noises that have a part in common")
    b.given("N^2 <= VW", "F", "q")
    b.sign("q >= 0", Equation(q, "≥", ZERO), "a joint intensity", ["N^2 <= VW", "1/V > 0"])
    b.sign("radicand with N", Equation(square(F) + g * q, "≥", ZERO), "as before", ["g >= 0", "q >= 0"], squares=[F])
    b.given("S_N", "P_N", "K_N")
    b.state(
        "Riccati equation with common noise",
        Equation(2 * A * P + W - Quotient(square(P * C + N), V), "=", ZERO),
        "complete the square: F and q take the place of A and W",
    )
    b.state("closed loop with common noise", Equation(A - K * C, "=", -S), "insert the gain")
    b.state("gain with common noise", Equation(K, "=", Quotient(A + S, C)), "insert the covariance; F + N C/V is A")
    b.sign("S_N >= 0", Equation(S, "≥", ZERO), "a square root", ["root with N ≥ 0"])
    b.sign("S_N + F >= 0", Equation(S + F, "≥", ZERO), "as before", ["S_N >= 0", "g >= 0", "q >= 0"])
    b.sign("P_N >= 0", Equation(P, "≥", ZERO), "the upper root is a covariance", ["V > 0", "S_N + F >= 0"],
           squares=[Quotient(ONE, C)])  # fmt: skip


def _derive_alternatives(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, N, F, q, g, S, P, K, p = (
        s[k] for k in ("A", "C", "W", "V", "N", "F", "q", "g", "S_N", "P_N", "K_N", "p_N")
    )
    root = Root(square(F) + g * q)
    b.state("P_N from its definition", Equation(P, "=", Quotient(V * (F + root), square(C))), "insert the root")
    b.say("Without a division by ", C, ":")
    b.given("S_N > F", "p_N")
    b.state(
        "Riccati equation with common noise, without a division by C",
        Equation(2 * A * p + W - Quotient(square(p * C + N), V), "=", ZERO), "as before",
    )  # fmt: skip
    b.state("closed loop with common noise, without a division by C",
            Equation(A - Quotient(p * C + N, V) * C, "=", -S), "as before")  # fmt: skip
    b.state("same covariance with common noise", Equation(P, "=", p), "multiply by S - F")
    gain = Quotient(p * C + N, V)
    b.state("same gain with common noise", Equation(K, "=", gain), "insert it", ["same covariance with common noise"])
    b.given("F = 0", "q = 0")
    b.state(
        "square of the double root with common noise", Equation(square(P), "=", ZERO), "S^2 = 0", ["F = 0", "q = 0"]
    )
    b.equal("double root with common noise", Equation(P, "=", ZERO), ["P_N >= 0"],
            identities=["square of the double root with common noise"])  # fmt: skip
    b.state("double root with common noise, gain", Equation(K, "=", Quotient(N, V)), "insert it",
            ["double root with common noise"])  # fmt: skip


def _derive_discrete(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, N, F, q, T, M, L = (s[k] for k in ("A", "C", "Q", "R", "S_d", "F_d", "q_d", "T_S", "M_S", "L_S"))
    b.heading("Noises that have a part in common, in discrete time")
    b.given("S^2 <= QR", "F_d", "q_d")
    b.sign("1/R > 0", Equation(Quotient(ONE, R), ">", ZERO), RECIPROCAL, ["R > 0"])
    b.sign("q_d >= 0", Equation(q, "≥", ZERO), "a joint covariance", ["S^2 <= QR", "1/R > 0"])
    b.given("b_S")
    derive_signs(b, C, q, "q_d >= 0", "_S")
    b.given("T_S", "M_S", "L_S")
    sigma = square(C) * M + R
    b.state(
        "discrete Riccati equation with common noise",
        Equation(M, "=", square(A) * M + Q - Quotient(square(A * M * C + N), sigma)),
        "complete the square: F and q take the place of A and Q",
    )
    b.state(
        "discrete closed loop with common noise", Equation(A - L * C, "=", Quotient(F * R, sigma)), "insert the gain"
    )
    b.given("T_S > 0")
    _derive_inside(b, sigma, F * R, A - L * C)
    b.state("M_S from its definition", Equation(M, "=", Quotient(s["b_S"] + T, 2 * square(C))), "the upper root")


def _derive_inside(b: ScalarBuilder, sigma: Term, over: Term, loop: Term) -> None:
    s = b.theory.symbols
    C, F = s["C"], s["F_d"]
    names = [f"Σ_S {sign} F R > 0" for sign in "-+"]
    for name, x, root in zip(names, (sigma - over, sigma + over), (F - ONE, F + ONE), strict=True):
        b.sign(name, Equation(x, ">", ZERO), "T is positive", ["T_S > 0", "R > 0", "q_d >= 0"], squares=[root, C])
    b.sign("1/Σ_S > 0", Equation(Quotient(ONE, sigma), ">", ZERO), RECIPROCAL, ["C^2 M + R > 0_S"])
    b.state(
        "distance to the circle with common noise",
        Equation(ONE - square(loop), "=", Quotient((sigma - over) * (sigma + over), square(sigma))),
        "common denominator", ["discrete closed loop with common noise"],
    )  # fmt: skip
    b.sign(
        "inside the circle with common noise", Equation(ONE - square(loop), ">", ZERO),
        "a product of positive numbers", [*names, "1/Σ_S > 0"],
        identities=["distance to the circle with common noise"], degree=5,
    )  # fmt: skip


def _derive_circle(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, R, N, F, q, beta, T, M, L = (s[k] for k in ("A", "C", "R", "S_d", "F_d", "q_d", "b_S", "T_S", "M_S", "L_S"))
    half, tail = innovation(F, C, q, R, T), " with common noise"
    over, below = Quotient(beta + T, 2 * square(C)), Quotient(2 * q * R, T - beta)
    b.sign("half with common noise > 0", Equation(half, ">", ZERO), "R is positive",
           ["T >= 0_S", "R > 0", "q_d >= 0"], squares=[F, C])  # fmt: skip
    b.state("innovation covariance" + tail, Equation(square(C) * M + R, "=", half), "insert the root")
    b.state("predictor gain" + tail, Equation(L, "=", Quotient(A * C * over + N, half)), "insert both")
    b.say("Without a division by ", C, ", and where both roots are one:")
    b.given("T_S > b_S")
    b.state("same discrete covariance" + tail, Equation(M, "=", below), "multiply by T - b")
    b.state("same predictor gain" + tail, Equation(L, "=", Quotient(A * C * below + N, half)), "insert it",
            ["predictor gain" + tail, "same discrete covariance" + tail, "M_S from its definition"])  # fmt: skip
    b.given("q_d = 0", "F_d^2 = 1")
    circle = "double root on the circle with common noise"
    b.state("square of the " + circle, Equation(square(M), "=", ZERO), "T^2 = b^2 = 0", ["q_d = 0", "F_d^2 = 1"])
    b.equal(circle, Equation(M, "=", ZERO), ["M >= 0_S"], identities=["square of the " + circle])
    b.state(circle + ", gain", Equation(L, "=", Quotient(N, R)), "insert it", [circle])
