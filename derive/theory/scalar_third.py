"""A plant of order three with one output: the factor of its spectrum, and its covariance in terms of that factor.

x1' = x2 + w1, x2' = x3 + w2, x3' = -b0 x1 - b1 x2 - b2 x3 + w3, y = x1 + v; the noises are white, of intensities W1,
W2, W3 and V, and uncorrelated. The monic factor s^3 + a2 s^2 + a1 s + a0 is Hurwitz by definition: a0 > 0, a2 > 0 and
a2 a1 > a0. Its a2 is the largest real root of a quartic; everything else follows without a root but that of c0.
"""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import Power, Quotient, Root
from derive.terms import Block, Equation, Glyph, Number, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_second import equal

ENTRIES = ("11", "12", "13", "22", "23", "33")
HALF = Number(Fraction(1, 2))


def three(name: str) -> str:
    """Return the internal name of a letter or step of order three."""
    return f"cubic {name}"


def letters(t: Theory, *names: str) -> tuple[Symbol, ...]:
    """Return symbols of order three by the letters on the page."""
    return tuple(t.symbols[three(name)] for name in names)


def declared(t: Theory, name: str, meaning: str) -> Symbol:
    """Declare a letter with an index."""
    return t.scalar(three(name), Glyph(name[0], sub=name[1:]), meaning=meaning)


def modulus(w: Term, a0: Term, a1: Term, a2: Term) -> Term:
    """Return |a(jω)|^2 of a(s) = s^3 + a2 s^2 + a1 s + a0."""
    return square(a0 - a2 * square(w)) + square(a1 * w - Power(w, 3))


def quartic(y: Term, a0: Term, c2: Term, c4: Term) -> Term:
    """Return (y^2 - c4)^2 - 8 a0 y - 4 c2."""
    return square(square(y) - c4) - 8 * a0 * y - 4 * c2


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare spectrum, factor, plant and covariance."""
    _declare_factor(t)
    _declare_plant(t)
    _declare_solution(t)


def _declare_factor(t: Theory) -> None:
    c0, c2, c4 = (declared(t, f"c{i}", "coefficient of the spectrum") for i in (0, 2, 4))
    a0, a1, a2 = (declared(t, f"a{i}", "coefficient of the factor") for i in (0, 1, 2))
    t.assume(three("c0 > 0"), c0, ">", text="the spectrum is positive at zero")
    t.atom("root", c0, three("c0 > 0"), three("root of c0"))
    t.define(three("a0"), a0, Root(c0))
    t.assume(three("a2^2 - 2 a1 = c4"), square(a2) - 2 * a1, "=", c4, "the factor at ω^4", case=True)
    t.assume(three("a1^2 - 2 a0 a2 = c2"), square(a1) - 2 * a0 * a2, "=", c2, "the factor at ω^2", case=True)
    t.assume(three("a2 > 0"), a2, ">", text="the factor is Hurwitz", case=True)
    t.assume(three("a2 a1 > a0"), a2 * a1, ">", a0, "the factor is Hurwitz", case=True)
    al, be = t.symbols["α"], t.symbols["β"]
    real = Power(al, 3) - 3 * al * square(be) + a2 * (square(al) - square(be)) + a1 * al + a0
    imaginary = 3 * square(al) * be - Power(be, 3) + 2 * a2 * al * be + a1 * be
    t.assume(three("real part"), real, "=", text="the real part of the polynomial vanishes at α + jβ", case=True)
    t.assume(three("imaginary part"), imaginary, "=", text="its imaginary part vanishes too", case=True)
    y = t.scalar(three("y"), Glyph("y"), meaning="any real root of the quartic")
    t.assume(three("root of the quartic"), quartic(y, a0, c2, c4), "=", text="any real root", case=True)


def _coefficients(t: Theory) -> tuple[Term, Term, Term]:
    """Return c0, c2 and c4 of the output spectrum of the plant."""
    V, w1, w2, w3 = (t.symbols[k] for k in ("V", "w1", "w2", "w3"))
    b0, b1, b2 = letters(t, "b0", "b1", "b2")
    return (
        square(b0) + Quotient(w1 * square(b1) + w2 * square(b2) + w3, V),
        square(b1) - 2 * b0 * b2 + Quotient(w1 * (square(b2) - 2 * b1) + w2, V),
        square(b2) - 2 * b1 + Quotient(w1, V),
    )


def _declare_plant(t: Theory) -> None:
    t.scalar("w3", Glyph("W", sub="3"), meaning="intensity of the noise of the state 3")
    V = t.symbols["V"]
    b0, b1, b2 = (declared(t, f"b{i}", "coefficient of the plant") for i in (0, 1, 2))
    for i, value in zip((0, 2, 4), _coefficients(t), strict=True):
        t.assume(
            three(f"plant c{i}"), *_is(letters(t, f"c{i}")[0], value), "coefficient of the output spectrum", case=True
        )
    a0, a1, a2 = letters(t, "a0", "a1", "a2")
    P11, P12, P13, P22, P23, P33 = (declared(t, f"P{k}", f"entry {k} of the covariance") for k in ENTRIES)
    K1, K2, K3 = (declared(t, f"K{i}", f"entry {i} of the gain") for i in (1, 2, 3))
    t.define(three("K1"), K1, a2 - b2)
    t.define(three("K2"), K2, a1 - b1 - b2 * K1)
    t.define(three("K3"), K3, a0 - b0 - b1 * K1 - b2 * K2)
    for P, K in ((P11, K1), (P12, K2), (P13, K3)):
        t.define(P.name, P, V * K)
    t.define(P22.name, P22, K1 * P12 - P13)
    t.define(P23.name, P23, b0 * P11 + b1 * P12 + b2 * P13 + K1 * P13)
    t.define(P33.name, P33, b0 * P12 + b1 * P22 + b2 * P23 + K2 * P13)


def _is(left: Term, right: Term) -> tuple[Term, str, Term]:
    return left, "=", right


def equations(t: Theory, name: str) -> tuple[Term, ...]:
    """Return the entries of AX + XA' + W - XC'CX/V in the order of ENTRIES."""
    V, w1, w2, w3 = (t.symbols[k] for k in ("V", "w1", "w2", "w3"))
    b0, b1, b2 = letters(t, "b0", "b1", "b2")
    X11, X12, X13, X22, X23, X33 = letters(t, *(name + k for k in ENTRIES))
    return (
        2 * X12 + w1 - Quotient(square(X11), V),
        X22 + X13 - Quotient(X11 * X12, V),
        X23 - b0 * X11 - b1 * X12 - b2 * X13 - Quotient(X11 * X13, V),
        2 * X23 + w2 - Quotient(square(X12), V),
        X33 - b0 * X12 - b1 * X22 - b2 * X23 - Quotient(X12 * X13, V),
        -2 * b0 * X13 - 2 * b1 * X23 - 2 * b2 * X33 + w3 - Quotient(square(X13), V),
    )


def loop(t: Theory, K1: Term, K2: Term, K3: Term) -> tuple[Term, Term, Term]:
    """Return the coefficients of det(sI - A + KC), that of s^0 first."""
    b0, b1, b2 = letters(t, "b0", "b1", "b2")
    return b0 + b1 * K1 + b2 * K2 + K3, b1 + b2 * K1 + K2, b2 + K1


def _declare_solution(t: Theory) -> None:
    for k in ENTRIES:
        declared(t, f"X{k}", f"entry {k} of any solution")
    for k, entry in zip(ENTRIES, equations(t, "X"), strict=True):
        t.assume(three(f"Riccati equation {k} of X"), entry, "=", text=f"X is a solution, entry {k}", case=True)
    V = t.symbols["V"]
    gains = (Quotient(X, V) for X in letters(t, "X11", "X12", "X13"))
    x0, x1, x2 = (declared(t, f"x{i}", "coefficient of the closed loop of X") for i in (0, 1, 2))
    for x, value in zip((x0, x1, x2), loop(t, *gains), strict=True):
        t.define(x.name, x, value)
    t.assume(three("x0 > 0"), x0, ">", text="the closed loop of X is stable", case=True)
    t.assume(three("x2 > 0"), x2, ">", text="the closed loop of X is stable", case=True)
    t.assume(three("x2 x1 > x0"), x2 * x1, ">", x0, "the closed loop of X is stable", case=True)


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: ScalarBuilder) -> None:
    """Derive factor, covariance and value."""
    _derive_factor(b)
    _derive_quartic(b)
    _derive_hurwitz(b)
    _derive_covariance(b)
    _derive_value(b)


FACTOR = (three("a2^2 - 2 a1 = c4"), three("a1^2 - 2 a0 a2 = c2"))
HURWITZ = (three("a2 > 0"), three("a2 a1 > a0"))
DEFINITIONS = tuple(map(three, ("a0", "K1", "K2", "K3", *(f"P{k}" for k in ENTRIES))))
POSITIVE = tuple(map(three, ("a0 > 0", "a1 > 0", "a2 > 0", "a2 a1 > a0")))


def _derive_factor(b: ScalarBuilder) -> None:
    t = b.theory
    c0, c2, c4, a0, a1, a2 = letters(t, "c0", "c2", "c4", "a0", "a1", "a2")
    w = t.symbols["Ω"]
    b.heading("The spectral factor of order three")
    b.say("An even polynomial of degree six, and its Hurwitz factor, given by its conditions:")
    b.given(three("c0 > 0"), three("a0"), *FACTOR, *HURWITZ)
    spectrum = Power(w, 6) + c4 * Power(w, 4) + c2 * square(w) + c0
    b.state(
        three("spectral factor"), Equation(spectrum, "=", modulus(w, a0, a1, a2)), "compare the coefficients", FACTOR
    )
    b.sign(
        three("a0 > 0"),
        Equation(a0, ">", ZERO),
        "a root of a positive number",
        [three("root of c0") + " ≥ 0", three("c0 > 0")],
    )
    b.sign(three("a1 > 0"), Equation(a1, ">", ZERO), "its product with a2 is", [*HURWITZ, three("a0 > 0")], alone=True)


def _derive_quartic(b: ScalarBuilder) -> None:
    t = b.theory
    c2, c4, a0, a1, a2, y = letters(t, "c2", "c4", "a0", "a1", "a2", "y")
    b.say("One coefficient gives the others:")
    b.state(three("a1 from a2"), Equation(a1, "=", HALF * (square(a2) - c4)), "the coefficient of ω^4", FACTOR[:1])
    b.state(three("quartic"), Equation(quartic(a2, a0, c2, c4), "=", ZERO), "insert it", FACTOR)
    b.say("Of the real roots of this quartic it is the largest, so the factor is unique:")
    b.given(three("root of the quartic"))
    b.sign(
        three("largest root"), Equation(a2, "≥", y), "the quartic grows beyond a2, where it grows with a2 a1 - a0",
        POSITIVE, identities=[three("root of the quartic"), *FACTOR], squares=[a2 - y], alone=True,
    )  # fmt: skip


def _derive_hurwitz(b: ScalarBuilder) -> None:
    t = b.theory
    al, a2 = t.symbols["α"], letters(t, "a2")[0]
    b.say("Its roots ", al, " + j", t.symbols["β"], " lie in the open left half-plane:")
    cases = [three("real part"), three("imaginary part")]
    b.given(*cases)
    b.sign(
        three("factor is Hurwitz"), Equation(-al, ">", ZERO), "else the resultant of both in β is positive", POSITIVE,
        identities=cases, squares=[a2, al, square(al), Power(al, 3), a2 * al], alone=True,
    )  # fmt: skip


def _derive_covariance(b: ScalarBuilder) -> None:
    t = b.theory
    z, w, V = (t.symbols[k] for k in ("polynomial s", "Ω", "V"))
    a0, a1, a2, b0, b1, b2, K1, K2, K3 = letters(t, "a0", "a1", "a2", "b0", "b1", "b2", "K1", "K2", "K3")
    b.heading("A plant of order three")
    w1, w2, w3 = (t.symbols[k] for k in ("w1", "w2", "w3"))
    A = Block(((ZERO, ONE, ZERO), (ZERO, ZERO, ONE), (-b0, -b1, -b2)))
    W = Block(((w1, ZERO, ZERO), (ZERO, w2, ZERO), (ZERO, ZERO, w3)))
    b.say("For a plant of order three, A = ", A, ", C = ", Block(((ONE, ZERO, ZERO),)), ", W = ", W, ", the output")
    b.say("spectrum has the coefficients")
    plant = [three(f"plant c{i}") for i in (0, 2, 4)]
    b.given(*plant)
    through = w1 * (square(b1 - square(w)) + square(b2 * w)) + w2 * (square(w) + square(b2)) + w3
    b.state(
        three("spectral factor of the plant"),
        Equation(modulus(w, b0, b1, b2) + Quotient(through, V), "=", modulus(w, a0, a1, a2)),
        "the output spectrum times |b(jω)|^2/V: compare the coefficients", [*plant, *FACTOR, three("a0")],
    )  # fmt: skip
    b.say("The covariance and the gain K = PC'/V, entry by entry, in terms of the factor:")
    b.given(*map(three, ("K1", "K2", "K3", *(f"P{k}" for k in ENTRIES))))
    known = [*plant, *FACTOR, *DEFINITIONS]
    for k, entry in zip(ENTRIES, equations(t, "P"), strict=True):
        using = known if k in ("11", "22", "33") else []
        b.state(three(f"Riccati equation {k}"), Equation(entry, "=", ZERO), "insert the coefficients", using)
    b.state(
        three("closed loop"),
        _characteristic(z, (b0, b1, b2), (K1, K2, K3), (a0, a1, a2)),
        "the characteristic polynomial of A - KC is the spectral factor",
    )  # fmt: skip


def _characteristic(z: Term, b: tuple[Term, ...], K: tuple[Term, ...], a: tuple[Term, ...]) -> Equation:
    """Return det(sI - A + KC) = s^3 + a2 s^2 + a1 s + a0, expanded by the first column."""
    left = (z + K[0]) * (z * (z + b[2]) + b[1]) + K[1] * (z + b[2]) + b[0] + K[2]
    return Equation(left, "=", Power(z, 3) + a[2] * square(z) + a[1] * z + a[0])


def _derive_value(b: ScalarBuilder) -> None:
    t = b.theory
    V = t.symbols["V"]
    c0, c2, c4, a2, b2, x0, x1, x2 = letters(t, "c0", "c2", "c4", "a2", "b2", "x0", "x1", "x2")
    b.say("Conversely, let X be any solution of the Riccati equation:")
    names = [three(f"Riccati equation {k} of X") for k in ENTRIES]
    b.given(*names, *map(three, ("x0", "x1", "x2")))
    X1, X2, X3 = (Quotient(X, V) for X in letters(t, "X11", "X12", "X13"))
    b0, b1, z = *letters(t, "b0", "b1"), t.symbols["polynomial s"]
    b.state(three("closed loop of X"), _characteristic(z, (b0, b1, b2), (X1, X2, X3), (x0, x1, x2)), "the determinant")
    known = [*names, *map(three, ("plant c0", "plant c2", "plant c4", "x0", "x1", "x2"))]
    factor = [three("factor from X, " + c) for c in ("c4", "c2", "c0")]
    b.state(factor[0], Equation(square(x2) - 2 * x1, "=", c4), "entry 11", known)
    b.state(factor[1], Equation(square(x1) - 2 * x0 * x2, "=", c2), "entries 12, 13 and 22", known)
    b.state(factor[2], Equation(square(x0), "=", c0), "the other entries", known)
    b.say("Only one has a stable closed loop, and CXC'/V is the difference of two coefficients, one of the factor and")
    b.say("one of the plant, whether the plant is stable or not:")
    b.given(*map(three, ("x0 > 0", "x2 > 0", "x2 x1 > x0")))
    _derive_same_factor(b, factor)
    X11, P11 = letters(t, "X11", "P11")
    b.state(three("value"), Equation(Quotient(X11, V), "=", a2 - b2), "CXC'/V", [three("a2 of X"), three("x2")])
    _derive_same(b)
    b.state(three("value of P11"), Equation(Quotient(P11, V), "=", a2 - b2), "the covariance itself")


def _derive_same(b: ScalarBuilder) -> None:
    """The gain of X is K, and three of the Riccati equations give the other entries."""
    t = b.theory
    first = {
        "11": ("a2 of X", "x2"),
        "12": ("a1 of X", "x1", "only P11"),
        "13": ("a0 of X", "x0", "only P11", "only P12"),
    }
    other: dict[str, tuple[str, ...]] = {
        "22": ("Riccati equation 12 of X",), "23": ("Riccati equation 13 of X",),
        "33": ("Riccati equation 23 of X", "only P22", "only P23"),
    }  # fmt: skip
    gains = ("K1", "K2", "K3", "P11", "P12", "P13")
    for k in ENTRIES:
        X, P = letters(t, "X" + k, "P" + k)
        known = (*first[k], *gains) if k in first else (*other[k], "only P11", "only P12", "only P13", f"P{k}", *gains)
        b.state(three(f"only P{k}"), Equation(X, "=", P), "insert the factor", list(map(three, known)))


def _derive_same_factor(b: ScalarBuilder, factor: list[str]) -> None:
    """Both factors of one spectrum are Hurwitz, so each a2 is at most the other."""
    a0, a1, a2, x0, x1, x2 = letters(b.theory, "a0", "a1", "a2", "x0", "x1", "x2")
    root, stable = [three("root of c0"), three("a0")], list(map(three, ("x2 > 0", "x2 x1 > x0")))
    facts = [three("x0 > 0"), three("a0 > 0")]
    equal(b, three("a0 of X"), Equation(x0, "=", a0), facts, [factor[2], *root])
    b.sign(three("x1 > 0"), Equation(x1, ">", ZERO), "its product with x2 is", [*facts, *stable], alone=True)
    both = [*POSITIVE, *stable, three("x1 > 0")]
    relations = [*factor[:2], *FACTOR, three("a0 of X")]
    equal(b, three("a2 of X"), Equation(x2, "=", a2), both, relations, [a2 - x2])
    b.state(three("a1 of X"), Equation(x1, "=", a1), "the coefficient of ω^4", [three("a2 of X"), factor[0], FACTOR[0]])
