"""A plant of order two with one output: its spectral factor and its whole covariance in closed form.

x1' = x2 + w1, x2' = -b0 x1 - b1 x2 + w2, y = x1 + v, with b0, b1 any real numbers; the noises are white, of
intensities W1, W2 and V, and uncorrelated. Everything follows from the monic factor s^2 + a1 s + a0 of the output
spectrum: it is the characteristic polynomial of the error. Internal names f0, f1 are a0, a1 of the plant.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.context import Theory
from derive.functions import Power, Quotient, Root
from derive.terms import Block, Equation, Glyph, Symbol, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square

ENTRIES = ("11", "12", "22")
POSITIVE = "it is not negative, and its square is positive"


def spectrum(w: Term, c0: Term, c2: Term) -> Term:
    """Return ω^4 + c2 ω^2 + c0."""
    return Power(w, 4) + c2 * square(w) + c0


def modulus(w: Term, a0: Term, a1: Term) -> Term:
    """Return |a(jω)|^2 of a(s) = s^2 + a1 s + a0."""
    return square(a0 - square(w)) + square(a1) * square(w)


def equations(s: dict[str, Symbol], X11: Term, X12: Term, X22: Term) -> tuple[Term, Term, Term]:
    """Return the entries 11, 12 and 22 of AX + XA' + W - XC'CX/V."""
    b0, b1, w1, w2, V = (s[k] for k in ("b0", "b1", "w1", "w2", "V"))
    return (
        2 * X12 + w1 - Quotient(square(X11), V),
        X22 - b0 * X11 - b1 * X12 - Quotient(X11 * X12, V),
        -2 * b0 * X12 - 2 * b1 * X22 + w2 - Quotient(square(X12), V),
    )


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the factor of a spectrum, the plant of order two, and its covariance."""
    t.scalar("Ω", Glyph("ω"), meaning="frequency, any real number")
    t.scalar("α", meaning="real part of a root")
    t.scalar("β", meaning="imaginary part of a root")
    t.scalar("polynomial s", Glyph("s"), meaning="variable of a polynomial")
    _declare_factor(t)
    _declare_plant(t)
    _declare_solution(t)


def _declare_root_of(t: Theory, name: str, a0: Term, a1: Term) -> None:
    """Declare that α + jβ is a root of s^2 + a1 s + a0."""
    al, be = t.symbols["α"], t.symbols["β"]
    real, imaginary = square(al) - square(be) + a1 * al + a0, 2 * al * be + a1 * be
    t.assume(f"real part, {name}", real, "=", text="the real part of the polynomial vanishes at α + jβ", case=True)
    t.assume(f"imaginary part, {name}", imaginary, "=", text="its imaginary part vanishes too", case=True)


def _declare_factor(t: Theory) -> None:
    c0, c2 = t.scalar("c0", Glyph("c", sub="0")), t.scalar("c2", Glyph("c", sub="2"))
    t.assume("c0 > 0", c0, ">", text="the spectrum is positive at zero")
    r = Root(c0)
    t.atom("root", c0, "c0 > 0", "root of c0")
    text = "the spectrum is positive at the frequency whose square is the root of c0"
    t.assume("spectrum at √c0", square(r) + c2 * r + c0, ">", text=text, case=True)
    t.atom("root", c2 + 2 * r, "c2 + 2√c0 > 0", "root of c2 + 2√c0")
    a0 = t.scalar("a0", Glyph("a", sub="0"), meaning="constant coefficient of the factor")
    a1 = t.scalar("a1", Glyph("a", sub="1"), meaning="linear coefficient of the factor")
    t.define("a0", a0, r)
    t.define("a1", a1, Root(c2 + 2 * r))
    _declare_root_of(t, "factor", a0, a1)
    x0, x1 = t.scalar("x0", Glyph("x", sub="0")), t.scalar("x1", Glyph("x", sub="1"))
    for name, x in (("x0", x0), ("x1", x1)):
        t.assume(f"{name} >= 0", x, "≥", text="no root in the right half-plane", case=True)
    t.assume("x0^2 = c0", square(x0), "=", c0, "another factor of the same spectrum", case=True)
    t.assume("x1^2 - 2 x0 = c2", square(x1) - 2 * x0, "=", c2, "another factor of the same spectrum", case=True)


def _coefficients(s: dict[str, Symbol]) -> tuple[Term, Term]:
    """Return c0 and c2 of the output spectrum of the plant."""
    b0, b1, w1, w2, V = (s[k] for k in ("b0", "b1", "w1", "w2", "V"))
    return square(b0) + Quotient(w1 * square(b1) + w2, V), square(b1) - 2 * b0 + Quotient(w1, V)


def _declare_plant(t: Theory) -> None:
    s, V = t.symbols, t.symbols["V"]
    for i, what in ((0, "stiffness"), (1, "damping")):
        t.scalar(f"b{i}", Glyph("b", sub=str(i)), meaning=f"{what} by mass")
    for i in (1, 2):
        w = t.scalar(f"w{i}", Glyph("W", sub=str(i)), meaning=f"intensity of the noise of the state {i}")
        t.assume(f"w{i} >= 0", w, "≥", text="an intensity is not negative")
    t.assume("w2 > 0", s["w2"], ">", text="noise drives the acceleration", case=True)
    for i in (0, 1):
        t.scalar(f"f{i}", Glyph("a", sub=str(i)), meaning="coefficient of the factor of the output spectrum")
    c0, c2 = _coefficients(s)
    for i, radicand, reason in ((0, c0, "plant c0"), (1, c2 + 2 * s["f0"], "plant c2 + 2 a0")):
        t.atom("root", radicand, reason, f"root of {reason}")
        t.define(f"f{i}", s[f"f{i}"], Root(radicand))
    b0, b1, f0, f1 = (s[k] for k in ("b0", "b1", "f0", "f1"))
    P11, P12, P22 = (t.scalar(f"P{k}", Glyph("P", sub=k), meaning=f"entry {k} of the covariance") for k in ENTRIES)
    t.define("P11", P11, V * (f1 - b1))
    t.define("P12", P12, V * (f0 - b0 - b1 * (f1 - b1)))
    t.define("P22", P22, b0 * P11 + b1 * P12 + Quotient(P11 * P12, V))
    for k in "12":
        t.define(
            f"K{k}", t.scalar(f"K{k}", Glyph("K", sub=k), meaning=f"entry {k} of the gain"), Quotient(s[f"P1{k}"], V)
        )
    _declare_root_of(t, "closed loop", f0, f1)


def _declare_solution(t: Theory) -> None:
    X11, X12, X22 = (t.scalar(f"X{k}", Glyph("X", sub=k), meaning=f"entry {k} of any solution") for k in ENTRIES)
    for k, entry in zip(ENTRIES, equations(t.symbols, X11, X12, X22), strict=True):
        t.assume(f"Riccati equation {k} of X", entry, "=", text=f"X is a solution, entry {k}", case=True)
    b0, b1, V = (t.symbols[k] for k in ("b0", "b1", "V"))
    loop = b0 + Quotient(X12, V) + b1 * Quotient(X11, V), Quotient(X11, V) + b1
    for i, coefficient in enumerate(loop):
        name, text = f"X leaves a{i}", "its closed loop has no root in the right half-plane"
        x = t.scalar(name, Glyph("x", sub=str(i)), meaning="coefficient of the closed loop of X")
        t.define(name, x, coefficient)
        t.assume(f"{name} >= 0", x, "≥", text=text, case=True)


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: ScalarBuilder) -> None:
    """Derive factor, covariance, uniqueness, stability and sign."""
    _derive_factor(b)
    _derive_other_factor(b)
    _derive_plant(b)
    _derive_covariance(b)
    _derive_value(b)
    _derive_stability(b)
    _derive_sign(b)


def _derive_factor(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    c0, c2, a0, a1, w = (s[k] for k in ("c0", "c2", "a0", "a1", "Ω"))
    r = Root(c0)
    b.heading("The spectral factor of order two")
    b.say(
        "An even polynomial of the frequency, of degree four, is positive at every frequency only if it is so at two:"
    )
    b.given("c0 > 0")
    b.sign("√c0 > 0", Equation(r, ">", ZERO), POSITIVE, ["root of c0 ≥ 0", "c0 > 0"])
    b.given("spectrum at √c0")
    b.state("value at √c0", Equation(square(r) + c2 * r + c0, "=", r * (c2 + 2 * r)), "the square of the root is c0")
    b.sign("c2 + 2√c0 > 0", Equation(c2 + 2 * r, ">", ZERO), "divide by the root", ["√c0 > 0", "spectrum at √c0"])
    b.say("So the coefficients of the factor are square roots of positive numbers:")
    b.given("a0", "a1")
    b.state(
        "spectral factor of order two", Equation(spectrum(w, c0, c2), "=", modulus(w, a0, a1)),
        "compare the coefficients",
    )  # fmt: skip
    b.state("a0 in roots", Equation(a0, "=", r), "its definition")
    b.state("a1 in roots", Equation(a1, "=", Root(c2 + 2 * r)), "its definition")
    b.sign("a0 > 0", Equation(a0, ">", ZERO), "a root of a positive number", ["√c0 > 0"])
    b.sign("a1 > 0", Equation(a1, ">", ZERO), POSITIVE, ["root of c2 + 2√c0 ≥ 0", "c2 + 2√c0 > 0"])
    b.say("So positive values at two frequencies make it positive at all:")
    b.sign(
        "spectrum of order two > 0", Equation(spectrum(w, c0, c2), ">", ZERO),
        "its two squares do not vanish together", ["a0 > 0", "a1 > 0"],
        identities=["spectral factor of order two"], squares=[a0 - square(w), a1 * square(w), square(a1) * w], degree=4,
        alone=True,
    )  # fmt: skip
    _derive_hurwitz(b, "factor", a0, a1, ["a0 > 0", "a1 > 0"])


def _derive_hurwitz(b: ScalarBuilder, name: str, a0: Term, a1: Term, facts: list[str]) -> None:
    """A root α + jβ of s^2 + a1 s + a0 with positive coefficients has α < 0."""
    al = b.theory.symbols["α"]
    b.say("Its roots ", al, " + j", b.theory.symbols["β"], " lie in the open left half-plane:")
    cases = [f"real part, {name}", f"imaginary part, {name}"]
    b.given(*cases)
    b.sign(
        f"{name} is Hurwitz", Equation(-al, ">", ZERO), "else a sum of both is positive",
        facts, identities=cases, squares=[al],
    )  # fmt: skip


def _derive_other_factor(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    x0, x1, a0, a1 = (s[k] for k in ("x0", "x1", "a0", "a1"))
    b.say("No other factor is free of roots in the right half-plane, where a coefficient would be negative:")
    b.given("x0^2 = c0", "x1^2 - 2 x0 = c2", "x0 >= 0", "x1 >= 0")
    b.equal("only a0", Equation(x0, "=", a0), ["x0 >= 0", "a0 > 0"], identities=["x0^2 = c0"])
    b.equal("only a1", Equation(x1, "=", a1), ["x1 >= 0", "a1 > 0"], identities=["x1^2 - 2 x0 = c2", "only a0"])


def _derive_plant(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    b0, b1, w1, w2, V, f0, f1, w = (s[k] for k in ("b0", "b1", "w1", "w2", "V", "f0", "f1", "Ω"))
    c0, c2 = _coefficients(s)
    noise = ["1/V > 0", "w1 >= 0", "w2 >= 0"]
    b.heading("A plant of order two")
    A, W = Block(((ZERO, ONE), (-b0, -b1))), Block(((w1, ZERO), (ZERO, w2)))
    b.say("For a plant of order two, A = ", A, ", C = ", Block(((ONE, ZERO),)), ", W = ", W, ", with any real ", b0)
    b.say("and ", b1, ", stable or not, the output spectrum has again two coefficients, and a factor:")
    b.given("w1 >= 0", "w2 >= 0")
    b.sign("plant c0", Equation(c0, "≥", ZERO), "squares and intensities", noise, squares=[b0, b1])
    b.given("f0")
    for name, sign in (("a0 >= b0", -b0), ("a0 >= -b0", b0)):
        b.sign(
            name, Equation(f0 + sign, "≥", ZERO), "its square is at least that of b0",
            ["root of plant c0 ≥ 0", *noise], squares=[b1],
        )  # fmt: skip
    b.sign(
        "plant c2 + 2 a0",
        Equation(c2 + 2 * f0, "≥", ZERO),
        "a0 is at least b0",
        ["a0 >= b0", "1/V > 0", "w1 >= 0"],
        squares=[b1],
    )
    b.given("f1")
    left = modulus(w, b0, b1) + Quotient(w1 * (square(w) + square(b1)) + w2, V)
    b.state(
        "spectral factor of the plant", Equation(left, "=", modulus(w, f0, f1)),
        "the output spectrum times |b(jω)|^2/V: compare the coefficients",
    )  # fmt: skip


def _derive_covariance(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    P11, P12, P22, f0, f1, z = (s[k] for k in ("P11", "P12", "P22", "f0", "f1", "polynomial s"))
    b0, b1, K1, K2 = (s[k] for k in ("b0", "b1", "K1", "K2"))
    b.say("The covariance in closed form, entry by entry, and the gain K = PC'/V:")
    b.given("P11", "P12", "P22", "K1", "K2")
    for k, entry in zip(ENTRIES, equations(s, P11, P12, P22), strict=True):
        b.state(f"Riccati equation {k} of order two", Equation(entry, "=", ZERO), "insert the coefficients")
    b.state(
        "closed loop of order two",
        _characteristic(z, b0, b1, K1, K2, f0, f1),
        "the characteristic polynomial of A - KC is the spectral factor",
    )  # fmt: skip


def _characteristic(z: Term, b0: Term, b1: Term, K1: Term, K2: Term, a0: Term, a1: Term) -> Equation:
    """Return det(sI - A + KC) = s^2 + a1 s + a0."""
    return Equation((z + K1) * (z + b1) + b0 + K2, "=", square(z) + a1 * z + a0)


def _derive_stability(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    b0, b1, f0, f1 = (s[k] for k in ("b0", "b1", "f0", "f1"))
    b.say("Where noise drives the acceleration, the error is stable and the covariance positive definite:")
    b.given("w2 > 0")
    for name, sign in (("a0 > b0", -b0), ("a0 > -b0", b0)):
        weak = name.replace(">", ">=")
        b.sign(
            name, Equation(f0 + sign, ">", ZERO), "the square of a0 is greater",
            [weak, "root of plant c0 ≥ 0", "1/V > 0", "w1 >= 0", "w2 > 0"], squares=[b1],
        )  # fmt: skip
    b.sign("plant a0 > 0", Equation(f0, ">", ZERO), "half of the sum of both", ["a0 > b0", "a0 > -b0"])
    less = ["root of plant c2 + 2 a0 ≥ 0", "a0 > b0", "1/V > 0", "w1 >= 0"]
    for name, sign in (("a1 > b1", -b1), ("a1 > -b1", b1)):
        b.sign(name, Equation(f1 + sign, ">", ZERO), "the square of a1 is greater", less)
    b.sign("plant a1 > 0", Equation(f1, ">", ZERO), "half of the sum of both", ["a1 > b1", "a1 > -b1"])
    _derive_hurwitz(b, "closed loop", f0, f1, ["plant a0 > 0", "plant a1 > 0"])


def _derive_sign(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    b0, f0, V, w1, w2, P11, P12, P22 = (s[k] for k in ("b0", "f0", "V", "w1", "w2", "P11", "P12", "P22"))
    det = P11 * P22 - square(P12)
    b.sign("P11 > 0", Equation(P11, ">", ZERO), "a1 is greater than b1", ["V > 0", "a1 > b1"])
    b.state(
        "determinant of order two", Equation(2 * V * (f0 - b0) * det, "=", w1 * square(P12) + w2 * square(P11)),
        "eliminate P22", [f"Riccati equation {k} of order two" for k in ENTRIES],
    )  # fmt: skip
    b.sign(
        "det P > 0", Equation(det, ">", ZERO), "the right-hand side is positive",
        ["P11 > 0", "w2 > 0", "w1 >= 0", "a0 > b0", "V > 0"], identities=["determinant of order two"],
        squares=[P12], alone=True,
    )  # fmt: skip


def _derive_value(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    V, b1, f0, f1, P11, P12, P22 = (s[k] for k in ("V", "b1", "f0", "f1", "P11", "P12", "P22"))
    X11, X12, X22 = (s[f"X{k}"] for k in ENTRIES)
    c0, c2 = _coefficients(s)
    x0, x1, z, b0 = (s[k] for k in ("X leaves a0", "X leaves a1", "polynomial s", "b0"))
    b.say("Conversely, let X be any solution of the Riccati equation:")
    names = [f"Riccati equation {k} of X" for k in ENTRIES]
    b.given(*names)
    b.given("X leaves a0", "X leaves a1")
    loop = _characteristic(z, b0, b1, Quotient(X11, V), Quotient(X12, V), x0, x1)
    b.state("closed loop of X", loop, "the determinant")
    made = [*names, "X leaves a0", "X leaves a1"]
    b.state("factor from X, c0", Equation(square(x0), "=", c0), "eliminate X22", made)
    b.state("factor from X, c2", Equation(square(x1) - 2 * x0, "=", c2), "entry 11", made)
    b.say("Only one leaves the closed loop without roots in the right half-plane, and CXC'/V is the difference of two")
    b.say("coefficients, ", f1, " of the factor and ", b1, " of the plant, whether the plant is stable or not:")
    b.given("X leaves a0 >= 0", "X leaves a1 >= 0")
    known = ["factor from X, c0", "root of plant c0", "f0"]
    equal(b, "a0 of X", Equation(x0, "=", f0), ["X leaves a0 >= 0", "root of plant c0 ≥ 0"], known)
    known = ["factor from X, c2", "a0 of X", "root of plant c2 + 2 a0", "f1"]
    equal(b, "a1 of X", Equation(x1, "=", f1), ["X leaves a1 >= 0", "root of plant c2 + 2 a0 ≥ 0"], known)
    b.state("value of order two", Equation(Quotient(X11, V), "=", f1 - b1), "CXC'/V", ["a1 of X", "X leaves a1"])
    b.state("only P11", Equation(X11, "=", P11), "insert the factor", ["value of order two", "P11"])
    known = ["a0 of X", "a1 of X", "only P11", "X leaves a0", "X leaves a1", "P11", "P12"]
    b.state("only P12", Equation(X12, "=", P12), "insert the factor", known)
    known = ["Riccati equation 12 of X", "Riccati equation 12 of order two", "only P11", "only P12"]
    b.state("only P22", Equation(X22, "=", P22), "entry 12", known)
    b.state("value of P11", Equation(Quotient(P11, V), "=", f1 - b1), "the covariance itself")


def equal(
    b: ScalarBuilder,
    name: str,
    statement: Equation,
    facts: Sequence[str],
    identities: Sequence[str],
    squares: Sequence[Term] = (),
    degree: int = 3,
) -> None:
    """Prove a = b by two inequalities, from the named facts and identities alone."""
    links, turned = (f"{name}, one way", f"{name}, the other"), Equation(statement.rhs, "=", statement.lhs)
    for link, e in zip(links, (statement, turned), strict=True):
        b.sign(
            link, Equation(e.lhs, "≥", e.rhs), "were it less, the identity would fail", facts, identities=identities,
            squares=squares, degree=degree, alone=True,
        )  # fmt: skip
    b.linked(name, statement, "both", "two inequalities", links)
