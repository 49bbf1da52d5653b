"""The dual: the scalar linear quadratic regulator, cost, gain and closed loop in both times.

Minimise the integral (the sum) of Q x^2 + R u^2 for dx/dt = A x + B u (x_{k+1} = A x_k + B u_k). Duality puts B for C,
Q for the process noise and R for the sensor noise; for numbers, A' is A.
"""

from __future__ import annotations

from derive.context import Theory
from derive.functions import Quotient, Root
from derive.terms import Equation, Glyph, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL, declare_roots, derive_signs, innovation, recursion


def declare(t: Theory) -> None:
    """Declare the input coefficient, and both Riccati equations of the regulator; Q and R are its weights."""
    A, Q, R = (t.symbols[k] for k in "AQR")
    B = t.scalar("B", meaning="input coefficient")
    t.assume("B ≠ 0", B, "≠", text="the input moves the state", case=True)
    t.atom("reciprocal", B, "B ≠ 0", "1/B")
    t.atom("root", square(A) + Quotient(square(B) * Q, R), "radicand of the regulator", "root of the regulator")
    S = t.scalar("S_B", Glyph("S", sub="B"), meaning="decay rate of the controlled state")
    t.define("S_B", S, Root(square(A) + Quotient(square(B) * Q, R)))
    X = t.scalar("X_B", Glyph("X"), meaning="optimal cost of a unit state")
    t.define("X_B", X, Quotient(R * (A + S), square(B)))
    K = t.scalar("K_B", Glyph("K", sub="B"), meaning="feedback gain, u = -K x")
    t.define("K_B", K, Quotient(B * X, R))
    t.assume("S_B > A", S, ">", A, "the state is stable, or it is weighted and the input moves it", case=True)
    t.atom("reciprocal", S - A, "S_B > A", "1/(S_B-A)")
    declare_roots(t, A, B, Q, R, "_B", "B", "X")
    _declare_discrete(t, B)


def _declare_discrete(t: Theory, B: Symbol) -> None:
    A, R, T, beta, X = (t.symbols[k] for k in ("A", "R", "T_B", "b_B", "M_B"))
    F = t.scalar("F_B", Glyph("F", sub="B"), meaning="feedback gain in discrete time, u = -F x")
    t.define("F_B", F, Quotient(A * B * X, square(B) * X + R))
    t.assume("T_B > 0", T, ">", text="no mode on the circle that is not weighted", case=True)
    t.assume("T_B > b_B", T, ">", beta, "the state is weighted, or stable", case=True)
    t.atom("reciprocal", T - beta, "T_B > b_B", "1/(T_B-b_B)")
    t.atom("reciprocal", weight(t), "half of the regulator > 0", "1/(half of the regulator)")


def weight(t: Theory) -> Term:
    """Return B^2 X + R without a division by B."""
    A, B, Q, R, T = (t.symbols[k] for k in ("A", "B", "Q", "R", "T_B"))
    return innovation(A, B, Q, R, T)


def derive(b: ScalarBuilder) -> None:
    """Derive cost, gain and closed loop of the regulator."""
    _derive_continuous(b)
    _derive_discrete(b)
    _derive_gain(b)


def _derive_continuous(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, B, Q, R, S, X, K = (s[k] for k in ("A", "B", "Q", "R", "S_B", "X_B", "K_B"))
    root = Root(square(A) + Quotient(square(B) * Q, R))
    b.heading("The regulator, which is the dual")
    b.say("Now ", Q, " and ", R, " weigh the state and the input:")
    b.sign("radicand of the regulator", Equation(root.body, "≥", ZERO), "as before", ["Q >= 0", "1/R > 0"],
           squares=[A, B])  # fmt: skip
    b.given("S_B", "B ≠ 0", "X_B", "K_B")
    riccati = 2 * A * X + Q - Quotient(square(B) * square(X), R)
    b.state("Riccati equation of the regulator", Equation(riccati, "=", ZERO), "the upper root")
    b.state("cost of the regulator", Equation(X, "=", Quotient(R * (A + root), square(B))), "insert the root")
    b.state("gain of the regulator", Equation(K, "=", Quotient(A + root, B)), "insert the cost")
    b.state("closed loop of the regulator", Equation(A - B * K, "=", -root), "insert the gain")
    b.sign("S_B >= 0", Equation(S, "≥", ZERO), "a square root", ["root of the regulator ≥ 0"])
    b.sign("S_B + A >= 0", Equation(S + A, "≥", ZERO), "as before", ["S_B >= 0", "Q >= 0", "1/R > 0"], squares=[B])
    b.sign("X_B >= 0", Equation(X, "≥", ZERO), "the upper root is a cost", ["R > 0", "S_B + A >= 0"],
           squares=[Quotient(ONE, B)])  # fmt: skip
    b.given("S_B > A")
    b.state("cost without a division by B", Equation(X, "=", Quotient(Q, S - A)), "multiply by S - A")
    b.state("gain without a division by B", Equation(K, "=", Quotient(Q * B, R * (S - A))), "insert it",
            ["cost without a division by B", "K_B"])  # fmt: skip
    _derive_double(b, "double root of the regulator", X, K, "X_B >= 0", ["A = 0", "Q = 0"])


def _derive_double(b: ScalarBuilder, name: str, cost: Term, gain: Term, fact: str, cases: list[str]) -> None:
    b.state("square of the " + name, Equation(square(cost), "=", ZERO), "the root vanishes", cases)
    b.equal(name, Equation(cost, "=", ZERO), [fact], identities=["square of the " + name])
    b.state(name + ", gain", Equation(gain, "=", ZERO), "insert it", [name])


def _derive_discrete(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, B, Q, R, X, F = (s[k] for k in ("A", "B", "Q", "R", "M_B", "F_B"))
    sigma = square(B) * X + R
    b.say("In discrete time:")
    b.given("b_B")
    derive_signs(b, B, Q, "Q >= 0", "_B")
    b.given("T_B", "M_B", "F_B")
    b.state("discrete Riccati equation of the regulator", Equation(X, "=", recursion(A, B, Q, R, X)), "the upper root")
    b.state(
        "discrete closed loop of the regulator", Equation(A - B * F, "=", Quotient(A * R, sigma)), "insert the gain"
    )
    b.given("T_B > 0")
    names = [f"Σ_B {sign} A R > 0" for sign in "-+"]
    for name, x, root in zip(names, (sigma - A * R, sigma + A * R), (A - ONE, A + ONE), strict=True):
        b.sign(name, Equation(x, ">", ZERO), "T is positive", ["T_B > 0", "R > 0", "Q >= 0"], squares=[root, B])
    b.sign("1/Σ_B > 0", Equation(Quotient(ONE, sigma), ">", ZERO), RECIPROCAL, ["C^2 M + R > 0_B"])
    loop = A - B * F
    b.state(
        "distance of the regulator to the circle",
        Equation(ONE - square(loop), "=", Quotient((sigma - A * R) * (sigma + A * R), square(sigma))),
        "common denominator", ["discrete closed loop of the regulator"],
    )  # fmt: skip
    b.sign(
        "the regulator is inside the circle", Equation(ONE - square(loop), ">", ZERO), "a product of positive numbers",
        [*names, "1/Σ_B > 0"], identities=["distance of the regulator to the circle"], degree=5,
    )  # fmt: skip


def _derive_gain(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, B, Q, R, T, beta, X, F = (s[k] for k in ("A", "B", "Q", "R", "T_B", "b_B", "M_B", "F_B"))
    b.sign("half of the regulator > 0", Equation(weight(b.theory), ">", ZERO), "R is positive",
           ["T >= 0_B", "R > 0", "Q >= 0"], squares=[A, B])  # fmt: skip
    over, below = Quotient(beta + T, 2 * square(B)), Quotient(2 * Q * R, T - beta)
    b.state("discrete cost of the regulator", Equation(X, "=", over), "the upper root")
    b.state("weight of the input", Equation(square(B) * X + R, "=", weight(b.theory)), "insert the root")
    b.state("discrete gain of the regulator", Equation(F, "=", Quotient(A * B * over, weight(b.theory))), "insert it")
    b.given("T_B > b_B")
    b.state("discrete cost without a division by B", Equation(X, "=", below), "multiply by T - b")
    b.state("discrete gain without a division by B", Equation(F, "=", Quotient(A * B * below, weight(b.theory))),
            "insert it", ["discrete gain of the regulator", "discrete cost without a division by B",
                          "discrete cost of the regulator"])  # fmt: skip
    _derive_double(b, "double root of the regulator on the circle", X, F, "M >= 0_B", ["A^2 = 1", "Q = 0"])
