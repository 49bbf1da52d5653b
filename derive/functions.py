"""Terms of real analysis: roots, quotients, functions, limits and integrals, and how they are read as scalars.

A term prints as it was written; ``value`` gives its meaning, a polynomial in central scalars, with derivatives and
limits evaluated by the rules of real.py. A root, a quotient or a logarithm is read only where the theory declares it,
which it does with the reason why it is defined. Standard library only.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from fractions import Fraction

from derive.kernel import Poly, Rejected
from derive.real import (
    CIRCLE,
    FREQUENCY,
    INFINITY,
    ONE,
    ORIGIN,
    SIGNS,
    ZERO,
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
from derive.terms import Equation, MissingInverse, Neg, Number, Product, Reading, Sum, Symbol, Term, Zero, walk

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


def is_scalar(statement: Equation) -> bool:
    """Tell whether a statement is about real scalars only."""
    nodes = [n for side in (statement.lhs, statement.rhs) for n in walk(side) if not list(n.children())]
    real = [n for n in nodes if isinstance(n, Symbol) and n.scalar]
    plain = all(n in real or isinstance(n, (Number, Infinity)) or n == Zero("", "") for n in nodes)
    return plain and (bool(real) or statement.relation in SIGNS)


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
            raise Rejected(f"{type(term).__name__} has no meaning as a scalar")


KINDS = {Root: "root", Abs: "absolute", Max: "part", Exp: "exp", Log: "log", Arctan: "arctan"}


def _atom(term: Term, of: Poly, real: Real) -> str:
    name = real.find(KINDS[type(term)], of)
    if name is None:
        raise MissingInverse(f"a {type(term).__name__.lower()} that is not declared, or whose reason is not proved yet")
    return name


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
