"""Terms of real analysis: roots, quotients, functions, derivatives, limits and integrals, as they are written.

What they mean is read in functions.py. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from fractions import Fraction

from derive.kernel import Rejected
from derive.real import INFINITY, ORIGIN, SIGNS
from derive.spectral import Det, Entry
from derive.terms import Equation, Neg, Number, Symbol, Term, Trace, Zero


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


def replaced(term: Term, old: Symbol, new: Term) -> Term:
    """Replace a symbol in a term."""
    return put(term, {old: new})


def put(term: Term, images: Mapping[Term, Term]) -> Term:
    """Put terms in the place of others; a symbol has nothing within."""
    if term in images:
        return images[term]

    def within(part: object) -> object:
        if isinstance(part, Term):
            return put(part, images)
        return tuple(map(within, part)) if isinstance(part, tuple) else part

    if isinstance(term, Symbol):
        return term
    return replace(term, **{f.name: within(getattr(term, f.name)) for f in fields(term)})  # type: ignore[type-var]
