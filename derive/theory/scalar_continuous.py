"""The scalar Riccati equation in continuous time: both roots, the stabilising one, and the degenerate cases."""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import Abs, Limit, Max, Power, Quotient, Root
from derive.terms import Equation, Glyph, Number, Symbol, Term, Zero
from derive.theory.scalar_builder import ScalarBuilder

ZERO = Zero("", "")
ONE = Number(Fraction(1))


def square(x: Term) -> Power:
    """Return x^2."""
    return Power(x, 2)


def riccati(A: Term, W: Term, g: Term, P: Term) -> Term:
    """Return 2 A P + W - g P^2."""
    return 2 * A * P + W - g * square(P)


def declare(t: Theory) -> None:
    """Declare plant, noise, the two roots and the cases."""
    A = t.scalar("A", meaning="state coefficient")
    C = t.scalar("C", meaning="output coefficient")
    W = t.scalar("W", meaning="intensity of the process noise")
    V = t.scalar("V", meaning="intensity of the measurement noise")
    g = t.scalar("g", meaning="information rate")
    t.assume("V > 0", V, ">", text="the output is noisy")
    t.assume("W >= 0", W, "≥", text="an intensity is not negative")
    t.atom("reciprocal", V, "V > 0", "1/V")
    t.define("g", g, Quotient(square(C), V))
    t.atom("root", square(A) + g * W, "radicand", "root")
    S = t.scalar("S", meaning="decay rate of the error")
    t.define("S", S, Root(square(A) + g * W))
    t.assume("C ≠ 0", C, "≠", text="the output sees the state", case=True)
    t.atom("reciprocal", C, "C ≠ 0", "1/C")
    P = t.scalar("P", meaning="steady error covariance")
    other = t.scalar("P-", Glyph("P", sub="-"), meaning="other root")
    t.define("P", P, Quotient(V * (A + S), square(C)))
    t.define("P-", other, Quotient(V * (A - S), square(C)))
    K, K_other = t.scalar("K", meaning="Kalman gain"), t.scalar("K-", Glyph("K", sub="-"), meaning="other gain")
    t.define("K", K, Quotient(P * C, V))
    t.define("K-", K_other, Quotient(other * C, V))
    t.scalar("X", meaning="any number")
    t.assume("S > A", S, ">", A, "the state is stable, or noise excites it and the output sees it", case=True)
    t.atom("reciprocal", S - A, "S > A", "1/(S-A)")
    p = t.scalar("p", meaning="error covariance without a division by C")
    t.define("p", p, Quotient(W, S - A))
    _declare_cases(t)


def _declare_cases(t: Theory) -> None:
    A, C, W, V = (t.symbols[k] for k in "ACWV")
    t.atom("absolute", A, name="|A|")
    t.atom("absolute", C, name="|C|")
    t.atom("part", A, name="max(0,A)")
    t.atom("reciprocal", Abs(C), "|C| > 0", "1/|C|")
    t.atom("root", V * W, "VW >= 0", "root of VW")
    t.atom("root", square(A) * square(V) + square(C) * V * W, "radicand times V^2", "root without a division")
    t.assume("A = 0", A, "=", text="an integrator", case=True)
    t.assume("W = 0", W, "=", text="no process noise", case=True)
    t.assume("C = 0", C, "=", text="the output does not see the state", case=True)
    t.assume("A < 0", -A, ">", text="a stable state", case=True)
    t.atom("reciprocal", A, "A < 0", "1/A")


def derive(b: ScalarBuilder) -> None:
    """Derive the roots and what they mean."""
    _derive_roots(b)
    _derive_stability(b)
    _derive_cases(b)
    _derive_limits(b)


def _derive_roots(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, g, P, other, X = (s[k] for k in ("A", "C", "W", "V", "g", "P", "P-", "X"))
    b.heading("The Riccati equation and its two roots")
    b.say("One state, one output: ", A, ", ", C, ", ", W, " and ", V, " are real numbers,")
    b.given("V > 0", "W >= 0")
    b.sign("1/V > 0", Equation(Quotient(ONE, V), ">", ZERO), "a reciprocal has the sign of its number", ["V > 0"])
    b.given("g")
    b.sign("g >= 0", Equation(g, "≥", ZERO), "a square over a positive number", ["1/V > 0"], squares=[C])
    b.sign(
        "radicand", Equation(square(A) + g * W, "≥", ZERO), "a square and a product of nonnegative numbers",
        ["g >= 0", "W >= 0"], squares=[A],
    )  # fmt: skip
    b.say("The square root of that number is")
    b.given("S")
    b.say("Where the output sees the state, the Riccati equation has two roots.")
    b.given("C ≠ 0", "P", "P-")
    b.state(
        "both roots",
        Equation(riccati(A, W, g, X), "=", -(g * (X - P) * (X - other))),
        "multiply out: no other number is a root",
    )
    b.state("Riccati equation", Equation(riccati(A, W, g, P), "=", ZERO), "the upper root")
    b.state("Riccati equation of the other root", Equation(riccati(A, W, g, other), "=", ZERO), "the lower root")


def _derive_stability(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, g, S, P, other, K, p = (s[k] for k in ("A", "C", "W", "V", "g", "S", "P", "P-", "K", "p"))
    b.heading("Which root stabilises")
    b.given("K", "K-")
    root = Root(square(A) + Quotient(square(C) * W, V))
    b.state("P from its definition", Equation(P, "=", Quotient(V * (A + root), square(C))), "insert g")
    b.state("gain in closed form", Equation(K, "=", Quotient(A + root, C)), "insert P")
    b.state("closed loop", Equation(A - K * C, "=", -S), "insert the gain and the upper root")
    b.state("other closed loop", Equation(A - s["K-"] * C, "=", S), "insert the lower root")
    b.say("So the upper root stabilises, and the lower one never does, unless both are one: ", Equation(S, "=", ZERO))
    b.say("happens only where ", Equation(A, "=", ZERO), " and ", Equation(C * W, "=", ZERO), ".")
    b.sign("S >= 0", Equation(S, "≥", ZERO), "a square root", ["root ≥ 0"])
    facts = ["S >= 0", "g >= 0", "W >= 0"]
    b.sign("S + A >= 0", Equation(S + A, "≥", ZERO), "S is at least |A|", facts)
    b.sign("S - A >= 0", Equation(S - A, "≥", ZERO), "S is at least |A|", facts)
    over = Quotient(ONE, C)
    b.sign("P >= 0", Equation(P, "≥", ZERO), "the upper root is a covariance", ["V > 0", "S + A >= 0"], squares=[over])
    b.sign(
        "P- <= 0", Equation(-other, "≥", ZERO), "the lower root is none, unless it is zero",
        ["V > 0", "S - A >= 0"], squares=[over],
    )  # fmt: skip
    b.say("A form without a division by ", C, " holds where ", Equation(S, ">", A), ", and does not cancel where")
    b.say(A, " is negative:")
    b.given("S > A", "p")
    b.state("Riccati equation without a division by C", Equation(riccati(A, W, g, p), "=", ZERO), "S^2 = A^2 + g W")
    b.state("closed loop without a division by C", Equation(A - g * p, "=", -S), "S^2 = A^2 + g W")
    b.state("same covariance", Equation(P, "=", p), "multiply by S - A")
    b.state("gain without a division by C", Equation(K, "=", Quotient(W * C, V * (S - A))), "insert it")


def _derive_cases(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, S, P, K, p = (s[k] for k in ("A", "C", "W", "V", "S", "P", "K", "p"))
    b.heading("Degenerate cases")
    b.say("Without process noise the decay rate is ", Abs(A), ", whatever the sign of ", A, ".")
    b.given("W = 0")
    b.equal("S = |A|", Equation(S, "=", Abs(A)), ["S >= 0", "|A| ≥ 0"], identities=["W = 0"])
    b.equal(
        "|A| by the maximum",
        Equation(Abs(A), "=", 2 * Max(A) - A),
        ["|A| ≥ 0", "max(0,A) ≥ 0", "max(0,A) ≥ its argument"],
    )
    b.state(
        "no process noise",
        Equation(P, "=", Quotient(2 * V * Max(A), square(C))),
        "zero for a stable state, twice A V/C^2 for an unstable one",
        ["S = |A|", "|A| by the maximum"],
    )
    b.say("An integrator:")
    b.given("A = 0")
    b.sign("VW >= 0", Equation(V * W, "≥", ZERO), "a product of nonnegative numbers", ["V > 0", "W >= 0"])
    b.sign(
        "|C| > 0", Equation(Abs(C), ">", ZERO), "it is nonnegative, and its square is positive", ["|C| ≥ 0", "C ≠ 0"]
    )
    b.sign(
        "1/|C| > 0", Equation(Quotient(ONE, Abs(C)), ">", ZERO), "a reciprocal has the sign of its number",
        ["|C| > 0"],
    )  # fmt: skip
    value = Quotient(Root(V * W), Abs(C))
    b.sign("root over |C|", Equation(value, "≥", ZERO), "of nonnegative numbers", ["root of VW ≥ 0", "1/|C| > 0"])
    b.state("squares of the integrator", Equation(square(P), "=", square(value)), "S^2 = g W", ["A = 0"])
    b.equal(
        "integrator", Equation(P, "=", value), ["P >= 0", "root over |C|"], identities=["squares of the integrator"]
    )
    b.say("Neither noise nor dynamics: both roots are one, and the closed loop stays at the boundary.")
    b.state("square of the double root", Equation(square(P), "=", ZERO), "S^2 = 0", ["A = 0", "W = 0"])
    b.equal("double root", Equation(P, "=", ZERO), ["P >= 0"], identities=["square of the double root"])
    b.state("double root, gain", Equation(K, "=", ZERO), "insert it", ["double root"])
    b.say("An output that does not see the state leaves a stable state its own covariance:")
    b.given("C = 0", "A < 0")
    b.equal("S = -A", Equation(S, "=", -A), ["S >= 0", "A < 0"], identities=["C = 0"])
    b.state("unseen", Equation(p, "=", -Quotient(W, 2 * A)), "S = -A", ["S = -A"])


def _derive_limits(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, W, V, S, P = (s[k] for k in ("A", "C", "W", "V", "S", "P"))
    radicand = square(A) * square(V) + square(C) * V * W
    b.heading("Ever better sensors")
    b.sign("radicand times V^2", Equation(radicand, "≥", ZERO), "V^2 times the radicand", ["V > 0", "W >= 0"],
           squares=[A * V, C], degree=3)  # fmt: skip
    b.equal("V S", Equation(Root(radicand), "=", V * S), ["S >= 0", "V > 0", "root without a division ≥ 0"])
    form = Quotient(A * V + Root(radicand), square(C))
    b.state("P without a division by V", Equation(P, "=", form), "multiply the root by V", ["V S"])
    b.state(
        "limit of a perfect sensor", Equation(Limit(form, V, ZERO), "=", ZERO),
        "sums, products and roots are continuous",
    )  # fmt: skip


__all__ = ["Symbol", "declare", "derive", "riccati", "square"]
