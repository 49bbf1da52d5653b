"""Jensen's formula for a real matrix M: the mean of ln |det(zI - M)| over the unit circle, by the eigenvalues.

    (1/2π) ∫ ln |det(e^{jω} I - M)| dω = Σ max(0, ln |λ_i(M)|),  the integral over -π < ω < π

M may be singular, where max(0, ln 0) is 0, and have eigenvalues on the circle. Those at -1 are numbered apart, for the
variable of the integral takes -1 to infinity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.context import Theory
from derive.functions import PI, Definite, Log, Max, Quotient
from derive.spectral import At, Det, Distance, Growth, Modulus, Total
from derive.terms import Equation, Glyph, Neg, Product, Symbol, Term
from derive.theory.scalar_continuous import ONE, ZERO
from derive.theory.spectrum_builder import SpectrumBuilder
from derive.theory.spectrum_circle import (
    PAIRS,
    angle,
    both,
    centre,
    centre_integral,
    circle,
    constant,
    declare_distances,
    declare_growth,
    declare_root,
    derive_at_minus_one,
    derive_growth,
    derive_jensen,
    derive_number,
    derive_root,
    excess,
    over,
    parts,
    point,
    same_integrand,
    weight,
)
from derive.theory.spectrum_discrete import at, closed_loop
from derive.theory.spectrum_poisson import FOUR
from derive.theory.spectrum_roots import HALF, half, over_roots

QUARTER = Fraction(1, 4)


@dataclass(frozen=True)
class Loop:
    """A real matrix, and its eigenvalues: those other than -1, and those at -1."""

    matrix: str
    others: str
    ends: str
    given: tuple[str, ...]

    @property
    def families(self) -> tuple[str, str]:
        """The names of both families."""
        return self.others, self.ends


OPEN = Loop("A", "ζ", "χ", ("eigenvalues of A", "eigenvalues of A at -1 apart"))
CLOSED = Loop("A - KC", "ξ", "ψ", ("eigenvalues of A - KC",))
LOOPS = (OPEN, CLOSED)


# ------------------------------------------------------------------------------------------------ terms
def around(t: Theory, body: Term) -> Term:
    """Return the mean over the circle, of a function of e^{jω}."""
    return Quotient(ONE, 2 * PI) * Definite(body, t.symbols["ω"], Neg(PI), PI)


def matrix(t: Theory, loop: Loop) -> Term:
    """Return A, or A - KC."""
    return t.symbols["A"] if loop == OPEN else closed_loop(t)


def log_modulus(t: Theory, loop: Loop, place: Term | None = None) -> Log:
    """Return ln |det(zI - M)| at a point z of the circle."""
    return Log(Modulus(At(Det(at(t, matrix(t, loop))), t.symbols["s"], place or point(t))))


def weighted(t: Theory, log: Term) -> Term:
    """Return the integrand over the axis for a logarithm on the circle."""
    return Product((weight(t), log))


def product(t: Theory, *names: str) -> Term:
    """Return the product of (s - root) over one or two families."""
    factors = tuple(over_roots(t, t.symbols[n], t.symbols["s"]) for n in names)
    return factors[0] if len(factors) == 1 else Product(factors)


def contributions(t: Theory, loop: Loop) -> Term:
    """Return what all eigenvalues and their conjugates contribute to the integral over half of the circle."""
    one, other = (over(t, t.symbols[n], circle(t, t.symbols[n])) for n in loop.families)
    return one + other


def outside(t: Theory, name: str = "λ") -> Total:
    """Return the sum of max(0, ln|λ|)."""
    return over(t, t.symbols[name], Growth(t.symbols[name]))


def at_minus_one(t: Theory) -> Term:
    """Return what an eigenvalue at -1 contributes: ln 4, less the centre."""
    return constant(t, 2 * Log(FOUR)) - centre(t)


# ------------------------------------------------------------------------------------------------ declarations
def declare(t: Theory) -> None:
    """Declare the eigenvalues of A and of A - KC, those at -1 apart, and the moduli of both determinants."""
    t.roots("λ", t.symbols["i"], t.symbols["m"], Glyph("λ", sub="i"), of="A", meaning="eigenvalues of A")
    for name, index, count, meaning in (
        ("ζ", "k", "n", "eigenvalues of A other than -1"), ("χ", "q", "p", "eigenvalues of A at -1"),
        ("ξ", "h", "d", "eigenvalues of A - KC other than -1"), ("ψ", "g", "c", "eigenvalues of A - KC at -1"),
    ):  # fmt: skip
        where = t.scalar(f"number {index}", Glyph(index), meaning="number of a root")
        many = t.scalar(f"count {count}", Glyph(count), meaning="number of roots")
        t.roots(name, where, many, Glyph(name, sub=index), meaning=meaning)
    for name in ("λ", *OPEN.families, *CLOSED.families):
        t.atom("spectral", product(t, name), name=f"product {name}")
    A, closed, apart = t.symbols["A"], closed_loop(t), "those at -1 are numbered apart"
    t.define(OPEN.given[0], Det(at(t, A)), product(t, "λ"), "counted as often as they occur")
    t.define(OPEN.given[1], product(t, "λ"), product(t, *OPEN.families), apart)
    t.define(CLOSED.given[0], Det(at(t, closed)), product(t, *CLOSED.families), apart)
    declare_growth(t, t.symbols["λ"])
    t.atom("improper", constant(t, 2 * Log(FOUR)), name="circle integral of ln 4")
    t.atom("improper", at_minus_one(t), name="circle integral of ln 4, less the centre")
    for loop in LOOPS:
        _declare_loop(t, loop)
    disc = Neg(excess(t.symbols["ξ"]))
    t.assume("strong solution", disc, "≥", text="the stabilising solution, or the strong one: no eigenvalue is outside")


def _declare_loop(t: Theory, loop: Loop) -> None:
    declare_root(t, t.symbols[loop.others])
    a, c = parts(t.symbols[loop.ends])
    t.assume(f"Re {loop.ends} = -1", a, "=", Neg(ONE), text="an eigenvalue at -1")
    t.assume(f"Im {loop.ends} = 0", c, "=", ZERO, text="an eigenvalue at -1")
    declare_distances(t, t.symbols[loop.ends])
    log, whole = log_modulus(t, loop), contributions(t, loop)
    t.atom("spectral", log, name=f"ln |det(zI - ({loop.matrix}))|")
    for name, body in (
        ("the eigenvalues", whole), ("a quarter", QUARTER * whole), ("the determinant", weighted(t, log)),
    ):  # fmt: skip
        t.atom("improper", body, name=f"circle integral of {name}, {loop.matrix}")


# ------------------------------------------------------------------------------------------------ derivation
def derive(b: SpectrumBuilder) -> None:
    """Derive Jensen's formula for A, and for the closed loop of the strong solution."""
    t = b.theory
    b.heading("Jensen's formula for each eigenvalue")
    b.say(
        "Eigenvalues are the roots of the characteristic polynomial; those at -1 have numbers of their own. An "
        "eigenvalue other than -1 is, times a factor, at the same distance from the point of the circle as its image "
        "from the point of the axis:"
    )
    b.given(*OPEN.given, *CLOSED.given)
    derive_root(b, t.symbols["ζ"])
    b.say("which is Jensen's formula on the circle, in the angle:")
    mean = Equation(around(t, Log(Distance(angle(t), t.symbols["ζ"]))), "=", 2 * Growth(t.symbols["ζ"]))
    b.state("Jensen's formula for ζ", mean, "the integrand at both conjugates", ["circle lemma of ζ"])
    b.say("The same for the closed loop, which has no eigenvalue outside of the circle:")
    derive_root(b, t.symbols["ξ"])
    b.given("strong solution")
    _derive_no_growth(b, t.symbols["ξ"], ["strong solution"])
    b.say("Eigenvalues at -1 contribute nothing:")
    _derive_at_minus_one(b)
    b.heading("Jensen's formula for a matrix")
    b.say("Summed over the eigenvalues, this is the mean of the logarithm of the modulus of a determinant:")
    _derive_all(b)
    _derive_loop(b, OPEN, outside(t), ["all eigenvalues", "no growth of χ, summed"])
    b.say("and for the closed loop:")
    _derive_loop(b, CLOSED, ZERO, ["no growth of ξ, summed", "no growth of ψ, summed"])


def _derive_no_growth(b: SpectrumBuilder, root: Symbol, using: Sequence[str], identities: Sequence[str] = ()) -> None:
    """Derive max(0, ln|λ|) = 0 for a family that is in the disc or on the circle, and the sum."""
    t, name, part = b.theory, root.name, Max(excess(root))
    facts = [f"max(0,|{name}|^2-1) ≥ 0", f"max(0,|{name}|^2-1) ≥ its argument", *using]
    b.equal(f"no {name} outside", Equation(part, "=", ZERO), facts, identities=identities, reason="it is not positive")
    b.state(f"four and {name}", Equation(Product((ONE + part, FOUR)), "=", FOUR), "times 4", [f"no {name} outside"])
    logs = Equation(Log(ONE + part) + Log(FOUR), "=", Log(FOUR))
    b.linked(f"log of four and {name}", logs, "logarithms", "of a product", [f"four and {name}"])
    none = Equation(Growth(root), "=", ZERO)
    b.state(f"no growth of {name}", none, "ln 1 is 0", [f"log of four and {name}"])
    zero = Equation(over(t, root, none.lhs), "=", over(t, root, ZERO))
    b.linked(f"no growth of {name}, summed", zero, "sum over", "summed", [f"no growth of {name}"])


def _derive_at_minus_one(b: SpectrumBuilder) -> None:
    t = b.theory
    derive_number(b, "ln 4", 2 * Log(FOUR))
    value = Product((PI, 2 * Log(FOUR))) - centre_integral(t)
    whole = Equation(half(t, at_minus_one(t)), "=", value)
    b.linked("-1: integral", whole, "linear", "the difference", ["number lemma: ln 4", "centre: integral"])
    for root in (t.symbols["χ"], t.symbols["ψ"]):
        derive_at_minus_one(b, root, at_minus_one(t))
        derive_growth(b, root)
        _derive_no_growth(b, root, [], [f"Re {root.name} = -1", f"Im {root.name} = 0"])
        known = [f"{root.name} on the circle, integral", "-1: integral", f"no growth of {root.name}"]
        derive_jensen(b, root, [*known, *(f"far centre{sign}, logarithm" for sign in "-+")])


def _derive_all(b: SpectrumBuilder) -> None:
    """Derive that the sum over all eigenvalues of A is one over those other than -1 and one over those at -1."""
    t = b.theory
    roots = [t.symbols[n] for n in ("λ", *OPEN.families)]
    split = t.statement(OPEN.given[1])
    b.state("eigenvalues at -1 apart", Equation(split.lhs, "=", split.rhs), "definition", [OPEN.given[1]])
    derive_growth(b, roots[0])
    sums = [over(t, r, Log(ONE + Max(excess(r)))) for r in roots]
    b.linked(
        "all eigenvalues",
        Equation(sums[0], "=", sums[1] + sums[2]),
        "same roots",
        "equal polynomials have equal roots",
        ["eigenvalues at -1 apart"],
    )


def _derive_loop(b: SpectrumBuilder, loop: Loop, value: Term, using: Sequence[str]) -> None:
    """Derive the integral of ln|det(zI - M)| over half of the circle, and the mean in the angle."""
    t, name = b.theory, loop.matrix
    polynomial, logs = f"characteristic polynomial of {name}", f"modulus for {name}"
    roots = Equation(Det(at(t, matrix(t, loop))), "=", product(t, *loop.families))
    b.state(polynomial, roots, "by its roots", loop.given)
    one, other = (over(t, t.symbols[n], both(t, t.symbols[n])[0]) for n in loop.families)
    sums = Equation(log_modulus(t, loop), "=", HALF * one + HALF * other)
    b.linked(logs, sums, "modulus", "the modulus of a product", [polynomial])
    for n in loop.families:
        first, second = (over(t, t.symbols[n], log) for log in both(t, t.symbols[n]))
        b.linked(f"conjugates of {n}", Equation(first, "=", second), "conjugate", PAIRS, [])
    whole, growth = (
        contributions(t, loop),
        [over(t, t.symbols[n], 4 * PI * Growth(t.symbols[n])) for n in loop.families],
    )
    b.linked(
        f"eigenvalues of {name}: integral",
        Equation(half(t, whole), "=", growth[0] + growth[1]),
        "linear",
        "both sums",
        [f"circle lemma of {n}, summed" for n in loop.families],
    )
    b.linked(
        f"a quarter for {name}: integral",
        Equation(half(t, QUARTER * whole), "=", QUARTER * (growth[0] + growth[1])),
        "linear",
        "times a number",
        [f"eigenvalues of {name}: integral"],
    )
    pairs = [logs, *(f"conjugates of {n}" for n in loop.families)]
    same_integrand(b, f"determinant for {name}", weighted(t, log_modulus(t, loop)), QUARTER * whole, pairs)
    total = value if value == ZERO else PI * value
    known = [f"determinant for {name}, integral", f"a quarter for {name}: integral", *using]
    lemma = Equation(half(t, weighted(t, log_modulus(t, loop))), "=", total)
    b.state(f"determinant lemma for {name}", lemma, "by the eigenvalues outside", known)
    mean = Equation(around(t, log_modulus(t, loop, angle(t))), "=", value)
    b.state(f"Jensen's formula for {name}", mean, "the integrand is even", [f"determinant lemma for {name}"])
