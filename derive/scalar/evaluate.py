"""The value of a term at an instance: exact where it is rational, else enclosed in a ball.

A ball that excludes what a claim says refutes it; one that contains it says nothing more than that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq

from derive.functions import Abs, Arctan, Exp, Log, Max, Power, Quotient, Root
from derive.scalar.flint_ring import rational
from derive.scalar.ratio import Beyond, name_of, rate
from derive.spectral import Det, Entry, RealPart
from derive.terms import (
    Block,
    Dot,
    Equation,
    Identity,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
)

__all__ = ["Undefined", "Unsure", "compare", "holds", "number"]

BITS = 200  # of a ball's midpoint


class Undefined(Exception):  # noqa: N818 - what a formula is at a point, no fault of the code
    """A division by zero, or a root or logarithm of a negative number; the message says which."""


class Unsure(Exception):  # noqa: N818 - what a ball can say
    """A ball contains the point at which the term is undefined."""


def _ball(value: Any) -> Any:
    return value if isinstance(value, arb) else arb(value)


def _both(one: Any, two: Any) -> tuple[Any, Any]:
    exact = isinstance(one, fmpq) and isinstance(two, fmpq)
    return (one, two) if exact else (_ball(one), _ball(two))


def _add(one: Any, two: Any) -> Any:
    a, b = _both(one, two)
    return a + b


def _multiply(one: Any, two: Any) -> Any:
    a, b = _both(one, two)
    return a * b


def _divide(one: Any, two: Any) -> Any:
    if isinstance(two, fmpq):
        if two == 0:
            raise Undefined("division by zero")
        return one / two if isinstance(one, fmpq) else one / arb(two)
    if two.contains(0):
        raise Unsure("a divisor that may be zero")
    return _ball(one) / two


def _root(value: Any) -> Any:
    if isinstance(value, fmpq):
        if value < 0:
            raise Undefined("the root of a negative number")
        p, q = value.p.isqrt(), value.q.isqrt()
        return fmpq(p, q) if p * p == value.p and q * q == value.q else arb(value).sqrt()
    if value < 0:
        raise Undefined("the root of a negative number")
    if not value >= 0:
        raise Unsure("a radicand that may be negative")
    return value.sqrt()


def _log(value: Any) -> Any:
    if isinstance(value, fmpq) and value == 1:
        return fmpq(0)
    ball = _ball(value)
    if ball <= 0:
        raise Undefined("the logarithm of a number that is not positive")
    if not ball > 0:
        raise Unsure("a logarithm of what may be zero")
    return ball.log()


def _part(value: Any) -> Any:
    return max(value, fmpq(0)) if isinstance(value, fmpq) else value.max(arb(0))


def _exp(value: Any) -> Any:
    return fmpq(1) if isinstance(value, fmpq) and value == 0 else _ball(value).exp()


ONE_ARGUMENT: Mapping[type[Term], Callable[[Any], Any]] = {
    Root: _root, Log: _log, Max: _part, Exp: _exp, Abs: abs, Neg: lambda x: -x, Inverse: lambda x: _divide(fmpq(1), x),
    Arctan: lambda x: fmpq(0) if isinstance(x, fmpq) and x == 0 else _ball(x).atan(),
    **dict.fromkeys((Transpose, Trace, Det, Entry, RealPart), lambda x: x),
}  # fmt: skip


def number(term: Term, point: Mapping[str, Any]) -> Any:
    """Return the value of a term as a rational number or a ball.

    Raises:
        Undefined: the term has no value at the point.
        Unsure: the balls are too wide to tell.
        Beyond: the term is no function of real numbers, or has a letter without value.
    """
    match term:
        case Symbol():
            name = name_of(term)
            if name not in point:
                raise Beyond(f"{name} has no value")
            return point[name]
        case Number(value):
            return rational(value)
        case Identity():
            return fmpq(1)
        case Zero():
            return fmpq(0)
        case Sum(parts):
            total = number(parts[0], point)
            for part in parts[1:]:
                total = _add(total, number(part, point))
            return total
        case Product(parts):
            total = number(parts[0], point)
            for part in parts[1:]:
                total = _multiply(total, number(part, point))
            return total
        case Quotient(top, bottom):
            return _divide(number(top, point), number(bottom, point))
        case Power(body, exponent) if abs(exponent) <= 64:
            value = number(body, point) ** abs(exponent)
            return value if exponent >= 0 else _divide(fmpq(1), value)
        case Dot(body):
            return number(rate(body), point)
        case Block(((entry,),)):
            return number(entry, point)
        case _ if type(term) in ONE_ARGUMENT:
            return ONE_ARGUMENT[type(term)](number(term.body, point))  # type: ignore[attr-defined]
        case _:
            raise Beyond(f"{type(term).__name__} is not evaluated")


def compare(left: Any, relation: str, right: Any) -> bool | None:
    """Tell whether two numbers are in a relation; None if the balls do not say."""
    a, b = _both(left, right)
    d = a - b
    exact = isinstance(d, fmpq)
    match relation:
        case "=" | ":=":
            return d == 0 if exact else None if d.contains(0) else False
        case "≠":
            return d != 0 if exact else None if d.contains(0) else True
        case "≥" | "⪰":
            return d >= 0 if exact else True if d >= 0 else False if d < 0 else None
        case ">" | "≻":
            return d > 0 if exact else True if d > 0 else False if d <= 0 else None
        case _:
            raise Beyond(f"the relation {relation} is not decided between numbers")


def holds(equation: Equation, point: Mapping[str, Any]) -> tuple[bool | None, Any, Any]:
    """Return whether a claim holds at a point, and its two sides."""
    before, ctx.prec = ctx.prec, BITS
    try:
        left, right = number(equation.lhs, point), number(equation.rhs, point)
        return compare(left, equation.relation, right), left, right
    finally:
        ctx.prec = before


def plain(value: Any) -> Fraction | None:
    """Return a rational number of Python, None for a ball."""
    return Fraction(int(value.p), int(value.q)) if isinstance(value, fmpq) else None
