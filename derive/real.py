"""Real scalars: atoms (roots, reciprocals, exponentials, ...), sequences, and certificates of sign.

A real number is a polynomial in central scalars. A scalar that is no parameter is an atom: it stands for a function of
a polynomial and brings that function's defining relation. Signs follow by a certificate that the kernel replays: if the
claim were false, a sum of products of nonnegative numbers, one of them positive, would be zero. Like the kernel, these
rules search nothing, and use the standard library only.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from derive.kernel import ANY, Certificate, Poly, Rejected, Scalars, replay, times
from derive.kernel import Term as Addend
from derive.rules import Context, Fact

SIGNS = {"≥": "nonnegative", ">": "positive", "≠": "nonzero"}
NEGATION = "¬"  # the fact (for ≠: the relation) that the claim is false
HYPOTHESIS = "claim at k"  # what a step of an induction may use, the claim that it is about
SUPPOSED = frozenset({NEGATION, HYPOTHESIS})  # what a certificate supposes, and no step or declaration is called
ORIGIN, INFINITY = "0", "∞"
FREQUENCY = "ω"  # the variable of improper integrals
TIME = "t"  # the variable of integrals from 0
STEPS = "k"  # the number of steps, 0, 1, 2, ..., in a theory with sequences
COMPLEX, UNIT = "s", "j"  # a generic complex number, and the imaginary unit
AXIS = (UNIT, FREQUENCY)  # the factors of a point on the imaginary axis
ROUND = " ".join(AXIS)  # what a function at the point (1 + jω)/(1 - jω) of the unit circle is taken over
CIRCLE = "π"  # the scalar that stands for the circle's number
RESERVED = frozenset({FREQUENCY, TIME, COMPLEX, UNIT, CIRCLE})  # scalars to which the rules give a meaning
MATRIX = ("det", "trace")  # atoms of a matrix polynomial
EVERYWHERE = ("defined", "root", "reciprocal", "absolute", "part", "exp", "log", "arctan", "sum")  # functions of ``of``
LOGARITHMS = ("log modulus", "log value")  # atoms of a complex function of a real variable
LARGEST, LONGEST = 2_000, 400  # products that one multiplication writes, and the factors of one product


@dataclass(frozen=True)
class Atom:
    """A scalar that is a function of a polynomial ``of``.

    root: r >= 0, r^2 = of. reciprocal: r of = 1. absolute: r >= 0, r^2 = of^2. part: r = max(0, of). exp, log, arctan.
    integral: of ``of`` over t from 0 to t. improper: of ``of`` over ω from 0 to infinity. defined: r = of.
    times log: x ln(x^2 + a^2), times arctan: |a| arctan(x/|a|), with x = of, a = by. sum: of ``of`` over the index.
    roots: the product of (of - root) over a family. log modulus, log value: ln |f| and ln f on the axis, or along the
    reals. det, trace: of a matrix.
    """

    name: str
    kind: str
    of: Poly
    by: Poly | None = None
    over: str = ""  # the index of a sum, the family of a product over roots, the variable of a log modulus


@dataclass(frozen=True)
class Family:
    """The roots of a monic polynomial with real coefficients: the scalars of their real and imaginary parts."""

    real: str
    imaginary: str
    index: str
    count: str


@dataclass(frozen=True)
class Progression:
    """A sequence, x_k for each number of steps k: its first member x_0, and the scalar that stands for x_{k+1}.

    ``name`` is that of the definition of the first member.
    """

    start: Poly
    after: str
    name: str


@dataclass(frozen=True)
class Real:
    """What is known of scalars: atoms by name, and proved limits."""

    atoms: Mapping[str, Atom] = field(default_factory=dict[str, Atom])
    limits: Mapping[tuple[str, str, Scalars], Poly] = field(default_factory=dict[tuple[str, str, Scalars], Poly])
    sums: tuple[tuple[str, str, Poly, Poly, str], ...] = ()  # limits of sums: variable, point, sum, limit, its name
    named: tuple[tuple[str, tuple[str, str, Scalars], Poly], ...] = ()  # the names of limits; the first one counts
    families: Mapping[str, Family] = field(default_factory=dict[str, Family])
    sequences: Mapping[str, Progression] = field(default_factory=dict[str, Progression])
    arbitrary: frozenset[str] = frozenset()  # parameters of which no hypothesis is made
    fixed: Mapping[str, frozenset[str]] = field(default_factory=dict[str, frozenset[str]])  # by a hypothesis, its name
    letters: Mapping[str, frozenset[str]] = field(default_factory=dict[str, frozenset[str]])  # what defines matrices
    cases: frozenset[str] = frozenset()  # hypotheses that only the steps make which name them
    reasons: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])  # why they exist
    pending: frozenset[str] = frozenset()  # scalars that stand for others, once their declarations are taken up
    generic: frozenset[str] = frozenset()  # variables of which finitely many values are excepted by some facts
    running: frozenset[str] = frozenset()  # parameters of which nothing but r > 0 is assumed, for all r or almost all

    def find(self, kind: str, of: Poly, by: Poly | None = None, over: str = "") -> str | None:
        """Return the name of an atom; definitions in its argument may be written out or not."""
        same = [a for a in self.atoms.values() if a.kind == kind and a.over == over and a.by == by]
        exact = next((a.name for a in same if a.of == of), None)
        if exact or kind in MATRIX:
            return exact
        wanted = self.unfold(of)
        return next((a.name for a in same if self.unfold(a.of) == wanted), None)

    def indexed(self, name: str) -> str:
        """Return the index that a scalar carries, or nothing."""
        return next((f.index for f in self.families.values() if name in (f.real, f.imaginary)), "")

    def unfold(self, poly: Poly) -> Poly:
        """Write out the definitions in a polynomial."""
        if not any(s in self.atoms and self.atoms[s].kind == "defined" for s in scalars_of(poly)):
            return poly
        total = ZERO
        for (m, _), c in poly.terms.items():
            product = constant(c)
            for s in m:
                atom = self.atoms.get(s)
                product = multiply(product, self.unfold(atom.of) if atom and atom.kind == "defined" else scalar(s))
            total = total + product
        return total

    def varies(self, name: str, variable: str) -> bool:
        """Tell whether a scalar depends on a variable."""
        if name == variable or (variable and self.indexed(name) == variable):
            return True
        if self.sequence(name):
            return not self.determined(name) or variable in self.reached({name})
        atom = self.atoms.get(name)
        if atom is None or (atom.kind == "improper" and variable == FREQUENCY):
            return False
        if " " in atom.over and any(self.varies(part, variable) for part in atom.over.split()):
            return True  # a function at the point x + jy
        if atom.kind in (*LOGARITHMS, *MATRIX) and variable in (atom.over, COMPLEX):
            return variable == atom.over
        if atom.kind == "sum" and atom.over == variable:
            return False
        if atom.kind == "integral" and variable == TIME:
            return True
        family = self.families.get(atom.over) if atom.kind == "roots" else None
        if family is not None and variable in (family.real, family.imaginary):
            return True
        below = scalars_of(atom.of) | (scalars_of(atom.by) if atom.by is not None else set())
        return any(self.varies(s, variable) for s in below)

    def sequence(self, name: str) -> bool:
        """Tell whether a scalar is the member x_k of a sequence, or stands for x_{k+1} without being defined by it."""
        return name in self.sequences or (name in self.following and name not in self.atoms)

    @property
    def following(self) -> frozenset[str]:
        """The scalars that stand for the next members of sequences."""
        return frozenset(s.after for s in self.sequences.values())

    def determined(self, name: str) -> bool:
        """Tell whether the next member of a sequence is defined by this one; else it may depend on anything."""
        return name in self.sequences and self.sequences[name].after in self.atoms

    def reached(self, names: Iterable[str]) -> set[str]:
        """Return the scalars, and all that the atoms and sequences among them are made of."""
        found, waiting = set[str](), set(names)
        while waiting:
            found.add(name := waiting.pop())
            atom, family = self.atoms.get(name), self.families.get(name)
            if atom is not None:
                waiting |= scalars_of(atom.of) | (scalars_of(atom.by) if atom.by is not None else set())
                waiting |= {TIME} if atom.kind == "integral" else {*atom.over.split()}
            if family is not None:
                waiting |= {family.real, family.imaginary}
            if self.sequence(name):
                waiting.add(STEPS)
            if name in self.sequences:
                waiting |= scalars_of(self.sequences[name].start) | {self.sequences[name].after}
            waiting -= found
        return found


def constant(value: Fraction | int) -> Poly:
    """Return a rational number."""
    return Poly({((), ()): value}, ANY, ANY)


def scalar(name: str) -> Poly:
    """Return a central scalar."""
    return Poly({((name,), ()): 1}, ANY, ANY)


ZERO, ONE = constant(0), constant(1)


def scalars_of(poly: Poly) -> set[str]:
    """Return the scalars that occur in a polynomial."""
    return {s for m, _ in poly.terms for s in m}


def number(poly: Poly) -> Fraction | None:
    """Return the value of a polynomial without scalars, else None."""
    return None if scalars_of(poly) else poly.terms.get(((), ()), Fraction(0))


def multiply(one: Poly, two: Poly) -> Poly:
    """Return the product of two polynomials, of bounded size."""
    length = sum(max((len(m) for m, _ in p.terms), default=0) for p in (one, two))
    if len(one.terms) * len(two.terms) > LARGEST or length > LONGEST:
        raise Rejected("a product is too large to be written out")
    return one * two


def power(poly: Poly, exponent: int) -> Poly:
    """Return a power with an exponent that is a natural number."""
    if not 0 <= exponent <= LONGEST:
        raise Rejected(f"the exponent {exponent} is no natural number up to {LONGEST}")
    total = ONE
    for _ in range(exponent):
        total = multiply(total, poly)
    return total


# ------------------------------------------------------------------------------------------------ atoms
def atom_relation(atom: Atom, real: Real | None = None) -> Poly | None:
    """Return the polynomial that the atom makes zero, if there is one; x ln u has it where ln u is declared."""
    r = scalar(atom.name)
    match atom.kind:
        case "root":
            return r * r - atom.of
        case "reciprocal":
            return r * atom.of - ONE
        case "absolute":
            return r * r - atom.of * atom.of
        case "part":
            return r * (r - atom.of)
        case "defined":
            return r - atom.of
        case "times log" if atom.by is not None and real is not None:
            log = real.find("log", atom.of * atom.of + atom.by * atom.by)
            return r - atom.of * scalar(log) if log else None
        case _:
            return None


def atom_facts(atom: Atom) -> dict[str, Fact]:
    """Return what is known of the sign of an atom: names and facts."""
    r, name = scalar(atom.name), atom.name
    found: dict[str, tuple[str, Poly]] = {}
    if atom.kind in ("root", "absolute", "part"):
        found[f"{name} ≥ 0"] = "nonnegative", r
    if atom.kind == "part":
        found[f"{name} ≥ its argument"] = "nonnegative", r - atom.of
    if atom.kind == "exp":
        found[f"{name} > 0"] = "positive", r
    if atom.kind == "roots":
        found[f"{name} ≠ 0"] = "nonzero", r
    return {key: Fact(kind, ((poly,),)) for key, (kind, poly) in found.items()}


def log_facts(name: str, real: Real) -> dict[str, Fact]:
    """Return ln a - ln b <= a/b - 1 for a logarithm and every other one, both ways round, where 1/b is declared."""
    found, pairs = dict[str, Fact](), [(name, n) for n, a in real.atoms.items() if a.kind == "log" and n != name]
    for one, two in (*pairs, *((n, m) for m, n in pairs)):
        a, b = real.atoms[one].of, real.atoms[two].of
        try:
            bound = a * reciprocal(b, real) - ONE - scalar(one) + scalar(two)
        except Rejected:
            continue
        found[f"{one} - {two} ≤"] = Fact("nonnegative", ((bound,),))
    return found


def needs(kind: str) -> tuple[str, ...]:
    """Return the kinds of fact, one of which the argument of an atom must satisfy; none if it is always defined."""
    return {
        "root": ("nonnegative", "positive"),
        "reciprocal": ("positive", "nonzero", "negative"),
        "log": ("positive",),
    }.get(kind, ())


# ------------------------------------------------------------------------------------------------ reciprocals
def reciprocal(poly: Poly, real: Real) -> Poly:
    """Return 1/poly: of a number, of a declared atom, of a rational multiple of one, or of a product of such."""
    value = number(poly)
    if value is not None:
        if not value:
            raise Rejected("division by zero")
        return constant(1 / value)
    for atom in real.atoms.values():
        if atom.kind == "reciprocal":
            ratio = ratio_of(poly, atom.of)
            if ratio is not None:
                return scalar(atom.name).scale(1 / ratio)
    if len(poly.terms) == 1:
        (((m, _), c),) = poly.terms.items()
        if len(m) > 1:
            total = constant(1 / c)
            for s in m:
                total = total * reciprocal(scalar(s), real)
            return total
        atom = real.atoms.get(m[0]) if m else None
        if atom is not None and atom.kind == "reciprocal":
            return atom.of.scale(1 / c)
        if atom is not None and atom.kind == "defined":
            return reciprocal(atom.of, real).scale(1 / c)
    raise Rejected(f"a division by what is not known to be different from zero: {show(poly)}")


def ratio_of(poly: Poly, other: Poly) -> Fraction | None:
    """Return c with poly = c * other, if there is one."""
    if set(poly.terms) != set(other.terms):
        return None
    key = next(iter(poly.terms))
    ratio = poly.terms[key] / other.terms[key]
    return ratio if other.scale(ratio) == poly else None


def show(poly: Poly) -> str:
    """Write a polynomial in scalars for a message."""
    return " + ".join(" ".join((str(c), *m)) for (m, _), c in poly.terms.items()) or "0"


# ------------------------------------------------------------------------------------------------ signs
@dataclass(frozen=True)
class SignProduct:
    """The addend c * (product of facts) * (product of squares) with c >= 0; a ≠ fact counts in pairs only."""

    coefficient: Fraction
    facts: tuple[str, ...]
    squares: tuple[Poly, ...] = ()


@dataclass(frozen=True)
class Sign:
    """p >= 0, p > 0 or p ≠ 0: with the contrary, ``¬``, the products add up to 0 though one of them is positive."""

    claim: Poly
    relation: str
    products: tuple[SignProduct, ...]
    terms: tuple[Addend, ...]


def contrary(claim: Poly, relation: str) -> Fact | None:
    """Return the fact that the claim is false; p = 0 is a relation, not a fact."""
    return {"≥": Fact("positive", ((-claim,),)), ">": Fact("nonnegative", ((-claim,),))}.get(relation)


def sign_product(product: SignProduct, facts: Mapping[str, Fact]) -> tuple[Poly, bool]:
    """Return the value of a product of facts and whether it is positive rather than only nonnegative."""
    total, strict = constant(product.coefficient), product.coefficient > 0 and not product.squares
    if product.coefficient < 0:
        raise Rejected("a negative coefficient in a certificate of sign")
    for name in product.facts:
        if name not in facts:
            raise Rejected(f"no fact {name}")
        fact = facts[name]
        if fact.kind not in SIGNS.values() or (fact.kind == "nonzero" and product.facts.count(name) % 2):
            raise Rejected(f"the fact {name} does not say that a number is nonnegative")
        strict = strict and fact.kind != "nonnegative"
        total = multiply(total, fact.matrix[0][0])
    for square in product.squares:
        total = multiply(multiply(total, square), square)
    return total, strict


def replay_sign(proof: Sign, claim: Poly, relation: str, context: Context) -> None:
    """Accept p >= 0, p > 0 or p ≠ 0, or raise Rejected."""
    if (proof.claim, proof.relation) != (claim, relation) or relation not in SIGNS:
        raise Rejected("the certificate belongs to another claim")
    facts, relations = dict(context.facts), dict(context.relations)
    against = contrary(claim, relation)
    if against is None:
        relations[NEGATION] = claim
    else:
        facts[NEGATION] = against
    total, contradiction = ZERO, False
    for product in proof.products:
        value, strict = sign_product(product, facts)
        total, contradiction = total + value, contradiction or strict
    if not contradiction:
        raise Rejected("no product is positive: there is no contradiction")
    replay(Certificate(total, proof.terms), total, relations, context.alphabet)


def monomial(m: Scalars) -> Scalars:
    """Return a product of scalars in the kernel's order."""
    return times(m, ())
