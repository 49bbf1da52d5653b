"""Exact arithmetic for evidence: small rational instances that separate a printed formula from the true one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt, lcm

from derive.terms import Identity, Inverse, Neg, Number, Product, Sum, Symbol, Term, Transpose, Zero

Matrix = list[list[Fraction]]


def solve_linear(matrix: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction]:
    """Solve M x = b by elimination over the rationals.

    Raises:
        ValueError: M is singular.
    """
    rows = [[Fraction(x) for x in row] + [Fraction(b)] for row, b in zip(matrix, right, strict=True)]
    for i in range(len(rows)):
        pivot = next((r for r in range(i, len(rows)) if rows[r][i]), None)
        if pivot is None:
            raise ValueError("singular matrix")
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for r in range(len(rows)):
            if r != i:
                rows[r] = [x - rows[r][i] * y for x, y in zip(rows[r], rows[i], strict=True)]
    return [row[-1] for row in rows]


def lyapunov(a: Sequence[Sequence[Fraction | int]], q: Sequence[Sequence[Fraction | int]]) -> Matrix:
    """Solve A X + X A' + Q = 0 over the rationals."""
    n = len(a)
    index = [(i, j) for i in range(n) for j in range(n)]
    matrix = [[Fraction(a[i][k] * (j == m) + a[j][m] * (i == k)) for k, m in index] for i, j in index]
    x = solve_linear(matrix, [Fraction(-q[i][j]) for i, j in index])
    return [[x[i * n + j] for j in range(n)] for i in range(n)]


# ------------------------------------------------------------------------------------------------ quadratic numbers
@dataclass(frozen=True)
class Surd:
    """The number a + b sqrt(d): a and b rational, d > 0 an integer that is no square (or b = 0)."""

    a: Fraction
    b: Fraction
    d: int

    def _like(self, other: Surd | Fraction | int) -> Surd:
        if not isinstance(other, Surd):
            return Surd(Fraction(other), Fraction(0), self.d)
        if self.b and other.b and self.d != other.d:
            raise ValueError(f"numbers with the roots of {self.d} and {other.d} are not combined")
        return other

    def __add__(self, other: Surd | Fraction | int) -> Surd:
        y = self._like(other)
        return Surd(self.a + y.a, self.b + y.b, self.d if self.b else y.d)

    def __neg__(self) -> Surd:
        return Surd(-self.a, -self.b, self.d)

    def __sub__(self, other: Surd | Fraction | int) -> Surd:
        return self + -self._like(other)

    def __mul__(self, other: Surd | Fraction | int) -> Surd:
        y = self._like(other)
        d = self.d if self.b else y.d
        return Surd(self.a * y.a + self.b * y.b * d, self.a * y.b + self.b * y.a, d)

    def __rtruediv__(self, other: Fraction | int) -> Surd:
        norm = self.a**2 - self.b**2 * self.d
        return Surd(self.a / norm, -self.b / norm, self.d) * other

    def __radd__(self, other: Fraction | int) -> Surd:
        return self + other

    def __rsub__(self, other: Fraction | int) -> Surd:
        return -self + other

    def __rmul__(self, other: Fraction | int) -> Surd:
        return self * other

    def __float__(self) -> float:
        return float(self.a) + float(self.b) * self.d**0.5

    def __str__(self) -> str:
        if not self.b:
            return str(self.a)
        q = lcm(self.a.denominator, self.b.denominator)
        a, b = self.a * q, self.b * q
        text = f"{a} {'−' if b < 0 else '+'} {'' if abs(b) == 1 else abs(b)}√{self.d}"
        return f"({text})/{q} ≈ {float(self):.3f}" if q > 1 else f"{text} ≈ {float(self):.3f}"


Real = Fraction | Surd


def root(number: Fraction) -> Real:
    """Return the square root of a rational number >= 0."""
    under = number.numerator * number.denominator
    square = max(k for k in range(1, isqrt(under) + 2) if under % k**2 == 0) if under else 0
    scale = Fraction(square, number.denominator)
    return scale if under == square**2 else Surd(Fraction(0), scale, under // square**2)


def value(term: Term, values: Mapping[str, Real | int]) -> Real:
    """Evaluate a term whose matrices are all 1 by 1; ``values`` are those of its letters."""
    match term:
        case Symbol():
            found = values[term.letter]
            return Fraction(found) if isinstance(found, int) else found
        case Number(number):
            return number
        case Identity() | Zero():
            return Fraction(isinstance(term, Identity))
        case Neg(body):
            return -value(body, values)
        case Transpose(body):
            return value(body, values)
        case Inverse(body):
            return 1 / value(body, values)
        case Sum(addends):
            total: Real = Fraction(0)
            for addend in addends:
                total = total + value(addend, values)
            return total
        case Product(factors):
            product: Real = Fraction(1)
            for factor in factors:
                product = product * value(factor, values)
            return product
        case _:
            raise ValueError(f"{type(term).__name__} has no value here")


def riccati_roots(a: Fraction | int, c: Fraction | int, q: Fraction | int, r: Fraction | int) -> list[Real]:
    """Return every root P of the scalar Riccati equation, the largest last.

    P = Q + A P A - A P C (C P C + R)^-1 C P A

    Requires: C P C + R != 0 at the roots.
    """
    a2, c2, middle = Fraction(a) ** 2, Fraction(c) ** 2, Fraction(r) * (1 - Fraction(a) ** 2) - Fraction(c) ** 2 * q
    if c2 == 0:
        return [Fraction(q) / (1 - a2)]
    spread = root(middle**2 + 4 * c2 * q * r)
    return [(-middle - spread) * (1 / (2 * c2)), (-middle + spread) * (1 / (2 * c2))]
