"""Exact numbers, rational functions and balls in one arithmetic; matrices of them are lists of rows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import acb, arb

from derive.decide.spectra.ratio import Fractional, Undefined

__all__ = ["NoValue", "Scalar", "Value", "less"]

Scalar = Fractional | arb | acb
Value = Scalar | list[list[Any]]


class NoValue(Exception):  # noqa: N818 - what was found about a formula
    """A formula has a form that is not evaluated."""


def mapped(function: Callable[[Any], Any], x: Value) -> Value:
    return [[function(y) for y in row] for row in x] if isinstance(x, list) else function(x)


def pair(x: Any, y: Any) -> tuple[Any, Any]:
    """Return two scalars of one kind: balls as soon as one is a ball."""
    if isinstance(x, Fractional) and isinstance(y, Fractional):
        return x, y
    x, y = (constant(z) if isinstance(z, Fractional) else z for z in (x, y))
    return (acb(x), acb(y)) if isinstance(x, acb) or isinstance(y, acb) else (x, y)


def constant(x: Fractional) -> arb | acb:
    """Return a rational function that is a constant as a ball."""
    if x.den.degree() > 0 or max(x.re.degree(), x.im.degree()) > 0:
        raise NoValue("a function of s stands where a number is expected")
    re, im = ((arb(p[0].p) / arb(p[0].q)) if p else arb(0) for p in (x.re, x.im))
    return acb(re, im) if x.im else re


def ball(x: Value) -> arb:
    """Return a real number as a ball."""
    x = as_scalar(x)
    x = constant(x) if isinstance(x, Fractional) else x
    if isinstance(x, acb):
        if not x.imag.is_zero():
            raise NoValue("a real number is expected")
        return x.real
    return x


def complex_ball(x: Scalar) -> acb:
    return acb(constant(x) if isinstance(x, Fractional) else x)


def as_scalar(x: Value) -> Scalar:
    """Return a number, also where it is the only entry of a matrix."""
    if not isinstance(x, list):
        return x
    if len(x) == len(x[0]) == 1:
        return x[0][0]
    raise NoValue("a number is expected, not a matrix")


def add(x: Value, y: Value) -> Value:
    if isinstance(x, list) and isinstance(y, list):
        return [[add(a, b) for a, b in zip(r, s, strict=True)] for r, s in zip(x, y, strict=True)]
    a, b = pair(as_scalar(x), as_scalar(y))
    return a + b


def less(x: Value, y: Value) -> Value:
    """Return x - y."""
    return add(x, mapped(lambda a: -a, y))


def multiply(x: Value, y: Value) -> Value:
    if isinstance(x, list) and isinstance(y, list):
        columns = list(zip(*y, strict=True))
        return [[total_of([multiply(a, b) for a, b in zip(row, c, strict=True)]) for c in columns] for row in x]
    if isinstance(x, list):
        return mapped(lambda a: multiply(a, y), x)
    if isinstance(y, list):
        return mapped(lambda b: multiply(x, b), y)
    a, b = pair(x, y)
    return a * b


def total_of(items: list[Any]) -> Any:
    total = items[0]
    for item in items[1:]:
        total = add(total, item)
    return total


def power(x: Value, exponent: int) -> Value:
    if exponent < 0:
        return power(reciprocal(as_scalar(x)), -exponent)
    total: Value = Fractional.of(1)
    for _ in range(exponent):
        total = multiply(total, x)
    return total


def reciprocal(x: Scalar) -> Scalar:
    if isinstance(x, Fractional):
        return x.reciprocal()
    if x.contains(0):
        raise Undefined("a division by zero")
    return 1 / x


def square(x: Value) -> list[list[Any]]:
    matrix = x if isinstance(x, list) else [[x]]
    if any(len(row) != len(matrix) for row in matrix):
        raise NoValue("a square matrix is expected")
    return matrix


def exact(matrix: list[list[Any]]) -> list[list[Fractional]]:
    if any(not isinstance(x, Fractional) for row in matrix for x in row):
        raise NoValue("the inverse or determinant of a matrix of balls is not evaluated")
    return matrix


def modulus(x: Scalar) -> Scalar:
    """Return |x|; of a function of s on the axis it is the square root of x(s) x(-s), which is kept as such."""
    if isinstance(x, Fractional):
        number = x.number()
        if number is not None:
            return Fractional.of(abs(number))
        raise NoValue("the modulus of a function is evaluated in its square and in its logarithm")
    return abs(x)


def real_root(x: Value) -> Scalar:
    radicand = ball(x)
    if radicand < 0:
        raise Undefined("the root of a negative number")
    return radicand.max(arb(0)).sqrt()


def nonzero(x: Scalar) -> Scalar:
    if x.is_zero if isinstance(x, Fractional) else x.contains(0):
        raise Undefined("the logarithm of zero")
    return x


def positive(x: arb) -> arb:
    if x > 0:
        return x
    raise Undefined("the logarithm of a number that is not positive")
