"""What the covariance tends to when the sensor becomes perfect, or the process noise grows without bound."""

from __future__ import annotations

from derive.context import Theory
from derive.functions import Abs, Infinity, Limit, Quotient, Root
from derive.terms import Equation, Glyph, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL


def declare(t: Theory) -> None:
    """Declare the root of an intensity that grows, and the covariance as a function of it."""
    A, C, Q, V, g = (t.symbols[k] for k in "ACQVg")
    y = t.scalar("y", meaning="square root of the intensity of the process noise")
    t.assume("y > 0", y, ">", text="the process is noisy")
    t.atom("reciprocal", y, "y > 0", "1/y")
    t.atom("root", g, "g >= 0", "root of g")
    t.atom("root", square(A) + g * square(y), "radicand with y", "root with y")
    P_y = t.scalar("P(y^2)", Glyph("P", sub="y"), meaning="covariance for the intensity y^2")
    t.define("P(y^2)", P_y, Quotient(V * (A + Root(square(A) + g * square(y))), square(C)))
    t.assume("Q > 0", Q, ">", text="the process is noisy", case=True)
    t.atom("reciprocal", Q, "Q > 0", "1/Q")


def derive(b: ScalarBuilder) -> None:
    """Derive the limits in continuous and in discrete time."""
    _derive_continuous(b)
    _derive_perfect_sensor(b)
    _derive_noisy_process(b)


def _squeeze(b: ScalarBuilder, name: str, limit: Limit, value: Term, of: str) -> None:
    links = [f"{of} from {side}" for side in ("above", "below")]
    b.linked(name, Equation(limit, "=", value), "squeeze", "between bounds that vanish", links)


def _derive_continuous(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, V, g, y, P = (s[k] for k in ("A", "C", "V", "g", "y", "P(y^2)"))
    root, slope = Root(square(A) + g * square(y)), Root(g)
    b.heading("Ever more process noise")
    b.say("The covariance grows like the square root ", y, " of the intensity:")
    b.given("y > 0")
    b.sign("radicand with y", Equation(root.body, "≥", ZERO), "squares", ["g >= 0"], squares=[A, y])
    b.given("P(y^2)")
    roots = ["root of g ≥ 0", "root with y ≥ 0", "y > 0", "|A| ≥ 0"]
    b.sign("root at least", Equation(root, "≥", slope * y), "its square is larger by A^2", roots, squares=[A])
    b.sign("root at most", Equation(Abs(A) + slope * y, "≥", root), "its square is smaller", roots)
    b.sign("|A| >= A", Equation(Abs(A) - A, "≥", ZERO), "by its square", ["|A| ≥ 0"])
    b.sign("|A| >= -A", Equation(Abs(A) + A, "≥", ZERO), "by its square", ["|A| ≥ 0"])
    b.sign("1/y > 0", Equation(Quotient(ONE, y), ">", ZERO), RECIPROCAL, ["y > 0"])
    ratio, value = Quotient(P, y), Quotient(V * slope, square(C))
    bound = Quotient(2 * V * Abs(A), square(C) * y)
    facts, over = ["V > 0", "1/y > 0"], [Quotient(ONE, C)]
    b.sign("P/y from above", Equation(bound, "≥", ratio - value), "insert the bounds of the root",
           ["root at most", "|A| >= A", *facts], squares=over)  # fmt: skip
    b.sign("P/y from below", Equation(bound, "≥", value - ratio), "insert the bounds of the root",
           ["root at least", "|A| >= -A", "|A| ≥ 0", *facts], squares=over)  # fmt: skip
    _squeeze(b, "limit of a noisy process", Limit(ratio, y, Infinity()), value, "P/y")


def _derive_perfect_sensor(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, M = (s[k] for k in ("A", "C", "Q", "R", "M"))
    b.heading("A perfect sensor, and a very noisy process, in discrete time")
    b.say("What is predicted has at least the covariance of the last disturbance, and little more:")
    b.state("more than the disturbance", Equation(M - Q, "=", Quotient(square(A) * M * R, square(C) * M + R)),
            "the Riccati equation")  # fmt: skip
    bound = Quotient(square(A) * R, square(C))
    b.sign("M >= Q", Equation(M - Q, "≥", ZERO), "a product of nonnegative numbers", ["M >= 0", "R > 0", "1/Σ > 0"],
           squares=[A], identities=["more than the disturbance"])  # fmt: skip
    b.sign("M from above", Equation(bound, "≥", M - Q), "leave out M in the numerator and the denominator",
           ["R > 0", "1/Σ > 0"], squares=[Quotient(A, C)], identities=["more than the disturbance"])  # fmt: skip
    b.sign("M from below", Equation(bound, "≥", Q - M), "the bound is not negative", ["M >= Q", "R > 0"],
           squares=[Quotient(A, C)])  # fmt: skip
    _squeeze(b, "limit of a perfect sensor in discrete time", Limit(M, R, ZERO), Q, "M")


def _derive_noisy_process(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, M, plus = (s[k] for k in ("A", "C", "Q", "R", "M", "M+"))
    b.given("Q > 0")
    b.sign("1/Q > 0", Equation(Quotient(ONE, Q), ">", ZERO), RECIPROCAL, ["Q > 0"])
    bound = Quotient(square(A) * R, square(C) * Q)
    for side, x in (("above", Quotient(M, Q) - ONE), ("below", ONE - Quotient(M, Q))):
        b.sign(f"M/Q from {side}", Equation(bound, "≥", x), "divide by Q", [f"M from {side}", "1/Q > 0"])
    _squeeze(b, "limit of a noisy process in discrete time", Limit(Quotient(M, Q), Q, Infinity()), ONE, "M/Q")
    b.say("After the measurement, only what the sensor cannot tell is left:")
    gap, bound = plus - Quotient(R, square(C)), Quotient(square(R), square(C) * square(C) * Q)
    less, over = "less than the sensor's covariance", [Quotient(R, C), Quotient(R, square(C))]
    b.state(less, Equation(-gap, "=", Quotient(square(R), square(C) * (square(C) * M + R))), "common denominator")
    b.sign("M+ from above", Equation(bound, "≥", gap), "it is less", ["1/Q > 0", "1/Σ > 0", "R > 0"],
           squares=over, identities=[less])  # fmt: skip
    b.sign("M+ from below", Equation(bound, "≥", -gap), "M is at least Q", ["1/Q > 0", "1/Σ > 0", "M >= Q", "R > 0"],
           squares=over, identities=[less], degree=4)  # fmt: skip
    _squeeze(b, "limit of the filter for a noisy process", Limit(plus, Q, Infinity()), Quotient(R, square(C)), "M+")
