"""Two plants of order two in closed form: the double integrator and the damped oscillator.

Both are instances of scalar_second: b0 = b1 = 0 with noise on position and velocity, and b0 = ω0^2, b1 = 2 ζ ω0 with
noise on the velocity. The forms of the oscillator are given once as they are written, once without cancellation.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from derive.context import Theory
from derive.functions import Abs, Power, Quotient, Root
from derive.terms import Equation, Glyph, Number, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_second import equal


def inner(o: Term, w2: Term, V: Term) -> Term:
    """Return ω0^4 + W2/V, the square of a0 of the oscillator."""
    return Power(o, 4) + Quotient(w2, V)


def outer(o: Term, zeta: Term, a0: Term) -> Term:
    """Return 4 ζ^2 ω0^2 - 2 ω0^2 + 2 a0, the square of a1 of the oscillator."""
    return 4 * square(zeta) * square(o) - 2 * square(o) + 2 * a0


def declare(t: Theory) -> None:
    """Declare the cases, the roots and the conjugate forms."""
    b0, b1, w1, w2, V = (t.symbols[k] for k in ("b0", "b1", "w1", "w2", "V"))
    t.assume("b0 = 0", b0, "=", text="no stiffness", case=True)
    t.assume("b1 = 0", b1, "=", text="no damping", case=True)
    t.assume("w1 = 0", w1, "=", text="noise drives the acceleration alone", case=True)
    t.atom("root", V * w2, "V W2 >= 0", "root of V W2")
    t.atom("root", V * (w1 + 2 * Root(V * w2)), "root of P11", "root of V(W1 + 2√VW2)")
    t.atom("root", w2 * (w1 + 2 * Root(V * w2)), "root of P22", "root of W2(W1 + 2√VW2)")
    o, zeta = t.scalar("ω0", Glyph("ω", sub="0"), meaning="natural frequency"), t.scalar("ζ", meaning="damping ratio")
    t.assume("b0 = ω0^2", b0, "=", square(o), "the square of the natural frequency", case=True)
    t.assume("b1 = 2 ζ ω0", b1, "=", 2 * zeta * o, "twice the damping ratio times the natural frequency", case=True)
    e0, e1 = (t.scalar(f"e{i}", Glyph("r", sub=str(i)), meaning="coefficient of the factor") for i in (0, 1))
    t.atom("root", inner(o, w2, V), "ω0^4 + W2/V >= 0", "root of ω0^4 + W2/V")
    t.define("e0", e0, Root(inner(o, w2, V)))
    radicand = outer(o, zeta, e0)
    t.atom("root", radicand, "oscillator c2 + 2 a0", "root of oscillator c2 + 2 a0")
    t.define("e1", e1, Root(radicand))
    t.atom("reciprocal", e0 + square(o), "a0 + ω0^2 > 0", "1/(a0+ω0^2)")
    t.atom("reciprocal", e1 + 2 * zeta * o, "a1 + 2 ζ ω0 > 0", "1/(a1+2ζω0)")
    t.define("excess", t.scalar("excess", Glyph("δ"), meaning="excess of the factor"), e0 - square(o))
    t.assume("w2 = 0", w2, "=", text="no noise at all", case=True)
    t.atom("absolute", zeta * o, name="|ζ ω0|")
    t.define("κ", t.scalar("κ", meaning="gain of the position"), e1 - 2 * zeta * o)


def derive(b: ScalarBuilder) -> None:
    """Derive both covariances, entry by entry."""
    _derive_integrator(b)
    _derive_oscillator(b)
    _derive_conjugates(b)
    _derive_unexcited(b)


def _derive_integrator(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    V, w1, w2, P11, P12, P22 = (s[k] for k in ("V", "w1", "w2", "P11", "P12", "P22"))
    cases, r = ["b0 = 0", "b1 = 0"], Root(V * w2)
    both = w1 + 2 * r
    b.heading("The double integrator")
    b.say("Acceleration is white noise, and the position may drift:")
    b.given(*cases)
    b.sign("V W2 >= 0", Equation(V * w2, "≥", ZERO), "intensities", ["V > 0", "w2 >= 0"])
    facts = ["root of V W2 ≥ 0", "w1 >= 0"]
    b.sign("root of P11", Equation(V * both, "≥", ZERO), "intensities", [*facts, "V > 0"])
    b.sign("root of P22", Equation(w2 * both, "≥", ZERO), "intensities", [*facts, "w2 >= 0"])
    b.sign("P12 >= 0", Equation(P12, "≥", ZERO), "a root", ["V > 0", "root of plant c0 ≥ 0"], identities=cases)
    b.sign("P11 >= 0", Equation(P11, "≥", ZERO), "a root", ["V > 0", "root of plant c2 + 2 a0 ≥ 0"], identities=cases)
    b.sign(
        "P22 >= 0", Equation(P22, "≥", ZERO), "a product of such", ["P11 >= 0", "P12 >= 0", "1/V > 0"], identities=cases
    )
    _derive_root(b, P12, V * w2, "22", cases)
    _derive_root(b, P11, V * both, "11", ["double integrator, P12"])
    known = ["double integrator, P12", "double integrator, P11", ROOTS["P12"], ROOTS["P11"]]
    _derive_root(b, P22, w2 * both, "12", [*cases, *known])
    b.state("double integrator, det P", Equation(P11 * P22 - square(P12), "=", P12 * (w1 + P12)), "eliminate", [
        *cases, "Riccati equation 11 of order two", "Riccati equation 12 of order two"
    ])  # fmt: skip


ROOTS = {"P12": "root of V W2", "P11": "root of V(W1 + 2√VW2)", "P22": "root of W2(W1 + 2√VW2)"}


def _derive_root(b: ScalarBuilder, P: Symbol, radicand: Term, entry: str, known: Sequence[str]) -> None:
    """An entry of the covariance of the double integrator is a root, since it is not negative."""
    root = ROOTS[P.name]
    identities = [*known, f"Riccati equation {entry} of order two", root, "1/V"]
    facts = [f"{P.name} >= 0", f"{root} ≥ 0"]
    equal(b, f"double integrator, {P.name}", Equation(P, "=", Root(radicand)), facts, identities)


def _derive_oscillator(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    V, w2, o, zeta, e0, e1, f0, f1, kappa = (s[k] for k in ("V", "w2", "ω0", "ζ", "e0", "e1", "f0", "f1", "κ"))
    P11, P12, P22 = (s[k] for k in ("P11", "P12", "P22"))
    cases = ["b0 = ω0^2", "b1 = 2 ζ ω0", "w1 = 0"]
    b.heading("The damped oscillator")
    b.given(*cases)
    b.sign(
        "ω0^4 + W2/V >= 0", Equation(inner(o, w2, V), "≥", ZERO), "a square and an intensity",
        ["1/V > 0", "w2 >= 0"], squares=[square(o)],
    )  # fmt: skip
    b.given("e0")
    b.sign(
        "a0 >= ω0^2",
        Equation(e0, "≥", square(o)),
        "its square is at least ω0^4",
        ["root of ω0^4 + W2/V ≥ 0", "1/V > 0", "w2 >= 0"],
    )
    b.sign(
        "oscillator c2 + 2 a0", Equation(outer(o, zeta, e0), "≥", ZERO),
        "a0 is at least ω0^2", ["a0 >= ω0^2"], squares=[zeta * o],
    )  # fmt: skip
    b.given("e1")
    b.equal(
        "oscillator, a0", Equation(f0, "=", e0), ["root of plant c0 ≥ 0", "root of ω0^4 + W2/V ≥ 0"], identities=cases
    )
    b.equal(
        "oscillator, a1", Equation(f1, "=", e1), ["root of plant c2 + 2 a0 ≥ 0", "root of oscillator c2 + 2 a0 ≥ 0"],
        identities=[*cases, "oscillator, a0"],
    )  # fmt: skip
    b.given("κ")
    known = [*cases, "oscillator, a0", "oscillator, a1"]
    written = Root(outer(o, zeta, Root(inner(o, w2, V)))) - 2 * zeta * o
    b.state("oscillator, P11", Equation(P11, "=", V * written), "insert the factor", known)
    b.say("The other entries are powers of ", kappa, ", which is ", Quotient(P11, V), ":")
    b.state("oscillator, P12", Equation(P12, "=", Number(Fraction(1, 2)) * V * square(kappa)), "entry 11", known)
    b.state(
        "oscillator, P22",
        Equation(P22, "=", V * kappa * (square(o) + Number(Fraction(1, 2)) * kappa * e1)),
        "entry 12",
        known,
    )
    b.state(
        "oscillator, det P", Equation(2 * (P11 * P22 - square(P12)), "=", square(P11) * (e0 + square(o))), "eliminate",
        known,
    )  # fmt: skip


def _derive_conjugates(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    V, w2, o, zeta, e0, e1, delta, kappa = (s[k] for k in ("V", "w2", "ω0", "ζ", "e0", "e1", "excess", "κ"))
    b.say("Where noise is small or damping light these differences cancel; their conjugates do not:")
    b.given("w2 > 0")
    b.sign(
        "a0 + ω0^2 > 0", Equation(e0 + square(o), ">", ZERO), "the square of a0 is positive",
        ["root of ω0^4 + W2/V ≥ 0", "1/V > 0", "w2 > 0"], squares=[o, square(o)],
    )  # fmt: skip
    b.given("excess")
    b.state("a0 - ω0^2", Equation(delta, "=", Quotient(w2, V * (e0 + square(o)))), "a difference of squares")
    b.sign("1/(a0 + ω0^2) > 0", Equation(Quotient(ONE, e0 + square(o)), ">", ZERO), "a reciprocal", ["a0 + ω0^2 > 0"])
    b.sign(
        "excess > 0",
        Equation(delta, ">", ZERO),
        "a quotient of positive numbers",
        ["1/(a0 + ω0^2) > 0", "1/V > 0", "w2 > 0"],
        identities=["a0 - ω0^2"],
        alone=True,
    )
    b.state("a1^2 by the excess", Equation(square(e1), "=", 4 * square(zeta) * square(o) + 2 * delta), "insert it")
    b.sign(
        "a1 + 2 ζ ω0 > 0",
        Equation(e1 + 2 * zeta * o, ">", ZERO),
        "the square of a1 is greater",
        ["root of oscillator c2 + 2 a0 ≥ 0", "excess > 0"],
    )
    conjugate = Quotient(2 * delta, e1 + 2 * zeta * o)
    b.state(
        "κ without a difference", Equation(kappa, "=", conjugate), "a difference of squares", ["a1^2 by the excess"]
    )


def _derive_unexcited(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    V, o, zeta, e0, e1, P11, P12, P22 = (s[k] for k in ("V", "ω0", "ζ", "e0", "e1", "P11", "P12", "P22"))
    b.say("Without noise the covariance is zero, unless the damping is negative:")
    b.given("w2 = 0")
    size = Abs(zeta * o)
    excess = size - zeta * o
    root = ["root of ω0^4 + W2/V ≥ 0", "root of oscillator c2 + 2 a0 ≥ 0"]
    made = ["root of ω0^4 + W2/V", "e0", "w2 = 0"]
    equal(b, "unexcited, r0", Equation(e0, "=", square(o)), root[:1], made, [o])
    made = ["root of oscillator c2 + 2 a0", "e1", "unexcited, r0", "|ζ ω0|"]
    equal(b, "unexcited, r1", Equation(e1, "=", 2 * size), [root[1], "|ζ ω0| ≥ 0"], made)
    entries = (2 * V * excess, 2 * V * square(excess), 2 * V * excess * (square(o) + 2 * excess * size))
    for P, value in zip((P11, P12, P22), entries, strict=True):
        known = [f"oscillator, {P.name}", "unexcited, r1", "κ"]
        b.state(f"unexcited, {P.name}", Equation(P, "=", value), "insert them", known)
