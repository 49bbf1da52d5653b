"""Terms of real analysis: roots, quotients, functions, limits and integrals, and how they are read as scalars.

A term prints as it was written; ``value`` gives its meaning, a polynomial in central scalars, with derivatives and
limits evaluated by the rules of real.py. A root, a quotient or a logarithm is read only where the theory declares it,
which it does with the reason why it is defined. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from fractions import Fraction

from derive.kernel import ANY, Poly, Rejected, identity, times
from derive.real import (
    CIRCLE,
    FREQUENCY,
    INFINITY,
    ONE,
    ORIGIN,
    SIGNS,
    ZERO,
    Atom,
    Family,
    Real,
    at_origin,
    constant,
    derivative,
    limit,
    power,
    reciprocal,
    reflect,
    scalar,
)
from derive.spectral import (
    At,
    Conjugate,
    Det,
    Distance,
    Entry,
    ImaginaryPart,
    Modulus,
    RealPart,
    Roots,
    TimesArctan,
    TimesLog,
    Total,
)
from derive.terms import Equation, MissingInverse, Neg, Number, Product, Reading, Sum, Symbol, Term, Trace, Zero, lower

PI = Symbol(CIRCLE, scalar=True)


@dataclass(frozen=True)
class Root(Term):
    """The square root, not negative."""

    body: Term


@dataclass(frozen=True)
class Quotient(Term):
    """A fraction."""

    top: Term
    bottom: Term


@dataclass(frozen=True)
class Power(Term):
    """A power whose exponent is a natural number."""

    body: Term
    exponent: int


@dataclass(frozen=True)
class Abs(Term):
    """The absolute value."""

    body: Term


@dataclass(frozen=True)
class Max(Term):
    """The larger of zero and a term."""

    body: Term


@dataclass(frozen=True)
class Exp(Term):
    """The exponential function."""

    body: Term


@dataclass(frozen=True)
class Log(Term):
    """The natural logarithm; that of a quotient is the difference of two."""

    body: Term


@dataclass(frozen=True)
class Arctan(Term):
    """The inverse of the tangent."""

    body: Term


@dataclass(frozen=True)
class Infinity(Term):
    """The point at infinity of a limit or an integral."""


@dataclass(frozen=True)
class Rate(Term):
    """The derivative with respect to a variable."""

    body: Term
    symbol: Symbol


@dataclass(frozen=True)
class Start(Term):
    """The value where a variable is 0."""

    body: Term
    symbol: Symbol


@dataclass(frozen=True)
class Limit(Term):
    """The limit as a positive variable tends to a point: 0 (from above) or infinity."""

    body: Term
    symbol: Symbol
    point: Term


@dataclass(frozen=True)
class Definite(Term):
    """The integral over a variable between bounds: 0 and t, or 0 or minus infinity and infinity."""

    body: Term
    symbol: Symbol
    lower: Term
    upper: Term


OF_MATRIX = (Det, Trace, Entry)  # numbers that a matrix has


def is_scalar(statement: Equation) -> bool:
    """Tell whether a statement is about scalars only; the determinant and the trace of a matrix are."""
    nodes = [n for side in (statement.lhs, statement.rhs) for n in _leaves(side)]
    real = [n for n in nodes if isinstance(n, OF_MATRIX) or (isinstance(n, Symbol) and n.scalar)]
    plain = all(n in real or isinstance(n, (Number, Infinity)) or n == Zero("", "") for n in nodes)
    return plain and (bool(real) or statement.relation in SIGNS)


def _leaves(term: Term) -> Iterator[Term]:
    children = [] if isinstance(term, OF_MATRIX) else list(term.children())
    if not children:
        yield term
    for child in children:
        yield from _leaves(child)


def value(term: Term, reading: Reading) -> Poly:
    """Read a term as a polynomial in scalars.

    Raises:
        Rejected: a root, quotient or logarithm that is not declared, or a function without a rule.
    """
    real = reading.real
    match term:
        case Symbol(scalar=True):
            return scalar(term.name)
        case Number(number):
            return constant(number)
        case Zero("", ""):
            return ZERO
        case Neg(body):
            return -value(body, reading)
        case Sum(addends):
            total = ZERO
            for addend in addends:
                total = total + value(addend, reading)
            return total
        case Product(factors):
            total = ONE
            for factor in factors:
                total = total * value(factor, reading)
            return total
        case Power(body, exponent) if exponent >= 0:
            return power(value(body, reading), exponent)
        case Quotient(top, bottom):
            return value(top, reading) * _over(bottom, reading)
        case Log(Modulus() | At()):
            return _spectral(term, reading)
        case Log(Quotient(top, bottom)):
            return value(Log(top), reading) - value(Log(bottom), reading)
        case Root(body) | Abs(body) | Max(body) | Exp(body) | Log(body) | Arctan(body):
            return scalar(_atom(term, value(body, reading), real))
        case Rate(body, symbol):
            return derivative(value(body, reading), symbol.name, real)
        case Start(body, symbol):
            return at_origin(value(body, reading), symbol.name, real)
        case Limit(body, symbol, point):
            return limit(value(body, reading), symbol.name, point_of(point), real, reading.context)
        case Definite():
            return _integral(term, reading)
        case _:
            return _spectral(term, reading)


KINDS = {Root: "root", Abs: "absolute", Max: "part", Exp: "exp", Log: "log", Arctan: "arctan"}


def _atom(term: Term, of: Poly, real: Real) -> str:
    name = real.find(KINDS[type(term)], of)
    if name is None:
        raise MissingInverse(f"a {type(term).__name__.lower()} that is not declared, or whose reason is not proved yet")
    return name


# ------------------------------------------------------------------------------------------------ frequency domain
COMPLEX, AXIS = "s", ("j", FREQUENCY)  # a generic complex number, and the factors of a point on the imaginary axis


def _spectral(term: Term, reading: Reading) -> Poly:
    """Read a term of the frequency domain: a family of roots, a determinant or trace, a logarithm on the axis."""
    match term:
        case RealPart(root):
            return scalar(_family(root, reading).real)
        case ImaginaryPart(root):
            return scalar(_family(root, reading).imaginary)
        case Distance(point, root):
            return _distance(point, root, reading)
        case Total(body, index, count):
            return total(value(body, reading), index.name, count.name, reading.real)
        case Det() | Roots() | TimesLog() | TimesArctan() | Log():
            atom = spectral_atom("", term, reading)
            if atom.kind == "det" and atom.of == identity(atom.of.rows):
                return ONE
            name = _find(atom, reading)
            if name is None:
                raise MissingInverse(f"{atom.kind}: not declared, or its reason is not proved yet")
            return scalar(name)
        case Trace(body):
            return _trace(body, reading)
        case Entry(body):
            return _entry(body, reading)
        case _:
            raise Rejected(f"{type(term).__name__} has no meaning as a scalar")


def spectral_atom(name: str, term: Term, reading: Reading) -> Atom:
    """Return the atom that a determinant, trace, product over roots, sum or logarithm stands for."""
    match term:
        case Det(body) | Trace(body):
            poly, kind = _square(body, reading), "det" if isinstance(term, Det) else "trace"
            return Atom(name, kind, poly, over="" if reading.context.is_real(poly) else COMPLEX)
        case Roots(point, root, index, count):
            family = _family(root, reading)
            if (family.index, family.count) != (index.name, count.name):
                raise Rejected(f"the roots {root.name} are numbered otherwise")
            if point not in (Symbol(COMPLEX, scalar=True), Neg(Symbol(COMPLEX, scalar=True))):
                raise Rejected("a product over roots is read at s or -s")
            return Atom(name, "roots", value(point, reading), over=root.name)
        case Total(body, index, _):
            poly = value(body, reading)
            if list(poly.terms.values()) != [1]:
                raise Rejected("a sum is declared of one product")
            return Atom(name, "sum", poly, over=index.name)
        case TimesLog(factor, width):
            return Atom(name, "times log", value(factor, reading), value(width, reading))
        case TimesArctan(factor, width):
            return Atom(name, "times arctan", value(factor, reading), value(width, reading))
        case Log(Modulus(At(body, symbol, point))):
            return Atom(name, "log modulus", value(body, reading), over=_variable(symbol, point))
        case Log(At(body, symbol, point)):
            return Atom(name, "log value", value(body, reading), over=_variable(symbol, point))
        case _:
            raise Rejected(f"{type(term).__name__} stands for no atom")


def _variable(symbol: Symbol, point: Term) -> str:
    """Return the real variable of a point: ω on the imaginary axis, s itself along the reals."""
    if symbol.name != COMPLEX:
        raise Rejected("a function is taken at a point of its variable s")
    match point:
        case Symbol(name=name) if name == COMPLEX:
            return COMPLEX
        case Product((Symbol() as j, Symbol() as w)) if (j.name, w.name) == AXIS:
            return FREQUENCY
        case _:
            raise Rejected("a function is taken on the imaginary axis, or along the reals")


def _distance(point: Term, root: Term, reading: Reading) -> Poly:
    """Read |point - root|^2 for a point on the imaginary axis, or on the real axis."""
    conjugate = isinstance(root, Conjugate)
    symbol = root.root if isinstance(root, Conjugate) else root
    if not isinstance(symbol, Symbol):
        raise Rejected("a distance is that to a root of a family")
    family = _family(symbol, reading)
    re, im = scalar(family.real), scalar(family.imaginary).scale(-1 if conjugate else 1)
    match point:
        case Product((Symbol() as j, Symbol() as w)) if (j.name, w.name) == AXIS:
            along, across = scalar(FREQUENCY) - im, re
        case Symbol(name=name) | Neg(Symbol(name=name)) if name == COMPLEX:
            along, across = value(point, reading) - re, im
        case _:
            raise Rejected("a distance is taken on the imaginary axis, or along the reals")
    return along * along + across * across


def _family(root: Symbol, reading: Reading) -> Family:
    family = reading.real.families.get(root.name)
    if family is None:
        raise Rejected(f"{root.name} is no family of roots")
    return family


def _square(body: Term, reading: Reading) -> Poly:
    grid = lower(body, reading)
    if len(grid) != 1 or len(grid[0]) != 1 or grid[0][0].rows != grid[0][0].cols:
        raise Rejected("a determinant or trace is that of one square matrix")
    return grid[0][0]


def _find(atom: Atom, reading: Reading) -> str | None:
    found = reading.real.find(atom.kind, atom.of, atom.by, atom.over)
    if found is None and atom.kind == "det":
        return reading.real.find("det", reading.context.alphabet.transpose(atom.of), None, atom.over)
    return found


def _trace(body: Term, reading: Reading) -> Poly:
    """Read a trace as a sum of the traces of products, each of which is declared."""
    return _traces(_square(body, reading), reading)


def _traces(poly: Poly, reading: Reading) -> Poly:
    alphabet, result = reading.context.alphabet, ZERO
    known = {tuple(alphabet.cyclic(a.of).items()): a.name for a in reading.real.atoms.values() if a.kind == "trace"}
    for (m, w), c in poly.terms.items():
        name = known.get(tuple(alphabet.cyclic(Poly({((), w): 1}, poly.rows, poly.cols)).items()))
        if name is None:
            raise MissingInverse("a trace that is not declared")
        result = result + Poly({(times(m, (name,)), ()): c}, ANY, ANY)
    return result


def _entry(body: Term, reading: Reading) -> Poly:
    """Read the entry of a matrix with one row and one column, which is its trace; that of the identity is 1."""
    poly = _square(body, reading)
    if not any(f.kind == "single" and f.matrix[0][0].rows == poly.rows for f in reading.context.facts.values()):
        raise MissingInverse(f"the dimension {poly.rows} is not known to be 1")
    rest = Poly({(m, w): c for (m, w), c in poly.terms.items() if w}, poly.rows, poly.cols)
    ones = Poly({(m, ()): c for (m, w), c in poly.terms.items() if not w}, ANY, ANY)
    return _traces(rest, reading) + ones


def total(poly: Poly, index: str, count: str, real: Real) -> Poly:
    """Return the sum over an index: of each product the part that carries the index, which is declared as a sum."""
    counts = {(f.index, f.count) for f in real.families.values()}
    if (index, count) not in counts:
        raise Rejected(f"{index} is not the index of a family with {count} members")
    result = ZERO
    for (m, _), c in poly.terms.items():
        moving = tuple(s for s in m if real.varies(s, index))
        fixed = Poly({(tuple(s for s in m if s not in moving), ()): c}, ANY, ANY)
        name = real.find("sum", Poly({(moving, ()): 1}, ANY, ANY), None, index) if moving else count
        if name is None:
            raise MissingInverse(f"the sum of {' '.join(moving)} is not declared")
        result = result + fixed * scalar(name)
    return result


# ------------------------------------------------------------------------------------------------ quotients, integrals
def _over(term: Term, reading: Reading) -> Poly:
    try:
        return over(term, reading)
    except MissingInverse:
        raise
    except Rejected as error:
        raise MissingInverse(str(error)) from None


def over(term: Term, reading: Reading) -> Poly:
    """Return the reciprocal of a term, factor by factor unless the whole is declared."""
    try:
        return reciprocal(value(term, reading), reading.real)
    except Rejected:
        match term:
            case Product(factors):
                total = ONE
                for factor in factors:
                    total = total * over(factor, reading)
                return total
            case Power(body, exponent):
                return power(over(body, reading), exponent)
            case Quotient(top, bottom):
                return value(bottom, reading) * over(top, reading)
            case _:
                raise


def point_of(term: Term) -> str:
    """Return the name of a point: 0, ∞ or -∞."""
    match term:
        case Infinity():
            return INFINITY
        case Neg(Infinity()):
            return "-" + INFINITY
        case Zero() | Number(Fraction(numerator=0)):
            return ORIGIN
        case Symbol(name="t"):
            return "t"
        case _:
            raise Rejected("a limit or bound that is neither 0, t nor infinite")


def _integral(term: Definite, reading: Reading) -> Poly:
    if (point_of(term.lower), point_of(term.upper)) == (ORIGIN, "t"):
        assert isinstance(term.upper, Symbol)
        name = reading.real.find("integral", value(replaced(term.body, term.symbol, term.upper), reading))
        if name is None:
            raise MissingInverse("an integral from 0 to t that is not declared")
        return scalar(name)
    body, bounds = value(term.body, reading), (point_of(term.lower), point_of(term.upper))
    name = reading.real.find("improper", body)
    whole = bounds == ("-" + INFINITY, INFINITY)
    if name is None or term.symbol.name != FREQUENCY or not (whole or bounds == (ORIGIN, INFINITY)):
        raise MissingInverse("an improper integral that is not declared")
    if whole and reflect(body, FREQUENCY, reading.real) != body:
        raise Rejected("the integrand is not even")
    return scalar(name).scale(2 if whole else 1)


def replaced(term: Term, old: Symbol, new: Symbol) -> Term:
    """Replace a symbol in a term."""
    if term == old:
        return new

    def within(part: object) -> object:
        if isinstance(part, Term):
            return replaced(part, old, new)
        return tuple(map(within, part)) if isinstance(part, tuple) else part

    if isinstance(term, Symbol):
        return term
    return replace(term, **{f.name: within(getattr(term, f.name)) for f in fields(term)})  # type: ignore[type-var]
