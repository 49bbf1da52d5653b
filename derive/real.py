"""Rules for real scalars: atoms (roots, reciprocals, exponentials, ...), signs, derivatives, limits.

A real number is a polynomial in central scalars. A scalar that is no parameter is an atom: it stands for a function of
a polynomial and brings that function's defining relation. Signs follow by a certificate that the kernel replays: if the
claim were false, a sum of products of nonnegative numbers, one of them positive, would be zero. Like the kernel, these
rules search nothing, and use the standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
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
        same = [a for a in self.atoms.values() if (a.kind, a.by, a.over) == (kind, by, over)]
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
            ratio = _ratio(poly, atom.of)
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


def _ratio(poly: Poly, other: Poly) -> Fraction | None:
    """Return c with poly = c * other, if there is one."""
    if set(poly.terms) != set(other.terms):
        return None
    key = next(iter(poly.terms))
    ratio = poly.terms[key] / other.terms[key]
    return ratio if other.scale(ratio) == poly else None


def show(poly: Poly) -> str:
    """Write a polynomial in scalars for a message."""
    return " + ".join(" ".join((str(c), *m)) for (m, _), c in poly.terms.items()) or "0"


# ------------------------------------------------------------------------------------------------ calculus
def derivative(poly: Poly, variable: str, real: Real) -> Poly:
    """Return d poly/d variable by sum, product and chain rule."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        for i, s in enumerate(m):
            if real.varies(s, variable):
                rest = Poly({((*m[:i], *m[i + 1 :]), ()): c}, ANY, ANY)
                total = total + multiply(rest, rate(s, variable, real))
    return total


def rate(name: str, variable: str, real: Real) -> Poly:
    """Return the derivative of one scalar."""
    if name == variable:
        return ONE
    atom = real.atoms.get(name)
    if atom is None:
        raise Rejected(f"the derivative of {name} is not known")
    inner = derivative(atom.of, variable, real) if atom.kind != "integral" else ZERO
    match atom.kind:
        case "defined":
            return inner
        case "reciprocal":
            return -(scalar(name) * scalar(name) * inner)
        case "exp":
            return scalar(name) * inner
        case "log":
            return inner * reciprocal(atom.of, real)
        case "arctan":
            return inner * reciprocal(ONE + atom.of * atom.of, real)
        case "integral" if variable == "t":
            return atom.of
        case "times log" | "times arctan" if atom.by is not None and not _moves(atom.by, variable, real):
            square, width = atom.of * atom.of, atom.by * atom.by
            over = reciprocal(square + width, real)
            log = real.find("log", square + width) if atom.kind == "times log" else None
            if log is None and atom.kind == "times log":
                raise Rejected(f"the logarithm in {name} is not declared")
            return inner * (scalar(log) + square.scale(2) * over if log else width * over)
        case _:
            raise Rejected(f"no rule for the derivative of {name}, a {atom.kind}")


def _moves(poly: Poly, variable: str, real: Real) -> bool:
    return any(real.varies(s, variable) for s in scalars_of(poly))


def at_origin(poly: Poly, variable: str, real: Real) -> Poly:
    """Return the value where the variable is 0."""
    return substituted(poly, variable, real, lambda name: _atom_at_origin(name, variable, real))


def substituted(poly: Poly, variable: str, real: Real, image: Callable[[str], Poly]) -> Poly:
    """Replace every scalar that depends on a variable by its image."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        product = constant(c)
        for s in m:
            product = multiply(product, image(s) if real.varies(s, variable) else scalar(s))
        total = total + product
    return total


def _atom_at_origin(name: str, variable: str, real: Real) -> Poly:
    if name == variable:
        return ZERO
    if variable == STEPS and name in real.sequences:
        return real.sequences[name].start
    atom = real.atoms.get(name)
    if atom is None:
        raise Rejected(f"the value of {name} at 0 is not known")
    if atom.kind == "integral" and variable == "t":
        return ZERO
    inner = at_origin(atom.of, variable, real)
    match atom.kind:
        case "defined":
            return inner
        case "reciprocal":
            return reciprocal(inner, real)
        case "times log" | "times arctan" if atom.by is not None and not _moves(atom.by, variable, real):
            return _odd(atom, inner, real)
        case "exp" | "arctan" | "root" if inner == ZERO:
            return ONE if atom.kind == "exp" else ZERO
        case "exp" | "arctan" | "log" if real.find(atom.kind, inner):
            return scalar(real.find(atom.kind, inner) or "")
        case _:
            raise Rejected(f"no value of {name} at 0")


def _odd(atom: Atom, inner: Poly, real: Real) -> Poly:
    """Return the value of a function that is odd in its argument, at a point that is declared or minus one."""
    if inner == ZERO:
        return ZERO
    name, turned = real.find(atom.kind, inner, atom.by), real.find(atom.kind, -inner, atom.by)
    if name is None and turned is None:
        raise Rejected(f"no value of {atom.name} at 0")
    return scalar(name) if name else -scalar(turned or "")


def reflect(poly: Poly, variable: str, real: Real) -> Poly:
    """Return the polynomial at minus the variable, which atoms may take into others of their kind."""

    def image(name: str) -> Poly:
        if name == variable:
            return -scalar(name)
        atom = real.atoms.get(name)
        if atom is not None and atom.kind in LOGARITHMS and variable == FREQUENCY and atom.over in (FREQUENCY, ROUND):
            return scalar(name)  # f takes conjugate values at conjugate points, its coefficients are real
        if atom is None or atom.kind not in EVERYWHERE:
            raise Rejected(f"{name} is not even in {variable}")
        found = real.find(atom.kind, reflect(atom.of, variable, real), atom.by, atom.over)
        if found is None:
            raise Rejected(f"{name} is not even in {variable}")
        return scalar(found)

    return substituted(poly, variable, real, image)


def limit(poly: Poly, variable: str, point: str, real: Real, context: Context) -> Poly:
    """Return the limit as the variable, positive, tends to 0 or to infinity: of sums, products and known functions."""
    if point not in (ORIGIN, INFINITY):
        raise Rejected("a limit is taken at 0 or at infinity")
    total = ZERO
    for known in (k for k in real.sums if k[:2] == (variable, point)):
        poly, reached = _less(poly, known[2], known[3], variable, real)
        total = total + reached
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, variable))
        fixed = Poly({(tuple(s for s in m if s not in moving), ()): c}, ANY, ANY)
        total = total + multiply(fixed, _limit_of_product(moving, variable, point, real, context))
    return total


def _less(poly: Poly, known: Poly, value: Poly, variable: str, real: Real) -> tuple[Poly, Poly]:
    """Subtract the multiple of a sum whose limit is known that removes its first product; return its limit as well."""
    ((first, _), coefficient) = next(iter(known.terms.items()))
    if not first or not all(real.varies(s, variable) for s in first):
        return poly, ZERO
    factor = ZERO
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, variable))
        if moving == first:
            factor = factor + Poly({(tuple(s for s in m if s not in moving), ()): c / coefficient}, ANY, ANY)
    return poly - factor * known, factor * value


def _limit_of_product(m: Scalars, variable: str, point: str, real: Real, context: Context) -> Poly:
    known = real.limits.get((variable, point, m))
    if known is not None:
        return known
    if len(m) == 2 and point == ORIGIN and variable in m:
        other = real.atoms.get(m[0] if m[1] == variable else m[1])
        if other and other.kind == "log" and other.of == scalar(variable) * scalar(variable):
            return ZERO  # x ln x tends to 0 with x
    for i, s in enumerate(m):
        if s in real.atoms and real.atoms[s].kind == "defined":
            rest = Poly({((*m[:i], *m[i + 1 :]), ()): 1}, ANY, ANY)
            return limit(rest * real.atoms[s].of, variable, point, real, context)
    proper = _limit_of_rational(m, variable, real) if point == INFINITY else None
    if proper is not None:
        return proper
    total = ONE
    for s in m:
        total = total * _limit_of_scalar(s, variable, point, real, context)
    return total


def _limit_of_rational(m: Scalars, variable: str, real: Real) -> Poly | None:
    """Return the limit of x^k times reciprocals of polynomials in x with a number before the highest power, k <= it."""
    degree, leading = 0, Fraction(1)
    for s in m:
        atom = real.atoms.get(s)
        if s == variable:
            degree += 1
        elif atom is not None and atom.kind == "reciprocal":
            powers = [(n.count(variable), n, c) for (n, _), c in atom.of.terms.items()]
            highest = max(k for k, _, _ in powers)
            top = [(n, c) for k, n, c in powers if k == highest]
            if len(top) != 1 or set(top[0][0]) != {variable} or _moves_besides(atom.of, variable, real):
                return None
            degree, leading = degree - highest, leading * top[0][1]
        else:
            return None
    if degree > 0:
        raise Rejected(f"{' '.join(m)} tends to infinity")
    return constant(1 / leading) if degree == 0 else ZERO


def _moves_besides(poly: Poly, variable: str, real: Real) -> bool:
    return any(s != variable and real.varies(s, variable) for s in scalars_of(poly))


def _limit_of_scalar(name: str, variable: str, point: str, real: Real, context: Context) -> Poly:
    known, atom = real.limits.get((variable, point, (name,))), real.atoms.get(name)
    if known is not None:
        return known
    if atom is not None and atom.kind == "defined":
        return limit(atom.of, variable, point, real, context)
    if point == ORIGIN:
        return _atom_at_origin(name, variable, real)
    slope = _slope(atom.of, variable) if atom is not None else None
    if atom is not None and slope is not None and any(real.varies(s, variable) for s in scalars_of(slope)):
        slope = None
    match atom and atom.kind:
        case "reciprocal" if slope == ONE:
            return ZERO
        case "exp" if slope is not None and _positive(-slope, context):
            return ZERO
        case "times arctan" if atom is not None and _is_shift(atom.of, variable, real):
            by = atom.by or ZERO
            width = None if _moves(by, variable, real) else real.find("absolute", by)
            if width is None:
                raise Rejected(f"the modulus in {name} is not declared")
            return scalar(CIRCLE).scale(Fraction(1, 2)) * scalar(width)
        case "arctan" if slope is not None and _positive(slope, context):
            return scalar(CIRCLE).scale(Fraction(1, 2))
        case "reciprocal" if atom is not None:
            return reciprocal(limit(atom.of, variable, point, real, context), real)
        case _:
            raise Rejected(f"the limit of {name} is not known")


def _is_shift(poly: Poly, variable: str, real: Real) -> bool:
    """Tell whether a polynomial is the variable plus what does not depend on it."""
    return not _moves(poly - scalar(variable), variable, real)


def _slope(poly: Poly, variable: str) -> Poly | None:
    """Return c if poly = c * variable."""
    total = ZERO
    for (m, _), c in poly.terms.items():
        if m.count(variable) != 1:
            return None
        rest = list(m)
        rest.remove(variable)
        total = total + Poly({(tuple(rest), ()): c}, ANY, ANY)
    return total


def _positive(poly: Poly, context: Context) -> bool:
    """Tell whether a fact says that the polynomial, or a positive multiple of it, is positive."""
    for fact in context.facts.values():
        if fact.kind == "positive":
            ratio = _ratio(poly, fact.matrix[0][0]) if poly.terms else None
            if ratio is not None and ratio > 0:
                return True
    return False


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
