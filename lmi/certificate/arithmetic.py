"""Exact arithmetic on rational matrices, and their definiteness. Standard library only.

A matrix is a table of integers over one positive denominator. Definiteness is decided by fraction-free L D L'; a
congruence that floating point suggests saves that work when its exact result is diagonally dominant.
"""

# pyright: strict

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite, lcm, ldexp, sqrt
from operator import mul

__all__ = ["Exact", "TooLargeError", "is_definite", "is_semidefinite", "symmetric_block"]

Table = list[list[int]]

WORK = 5 * 10**9
"""Entries times bits that an elimination may go through: about a minute."""

CONGRUENCE_BITS = 53
"""Bits of the congruence that floating point suggests."""


class TooLargeError(ArithmeticError):
    """A question that could be decided, but not in reasonable time."""


@dataclass(frozen=True)
class Exact:
    """A rational matrix (rows, columns): integers over one positive denominator."""

    numerators: tuple[tuple[int, ...], ...]
    denominator: int = 1

    @classmethod
    def of(cls, rows: Sequence[Sequence[Fraction | int]]) -> "Exact":
        """Put fractions over their least common denominator."""
        denominator = lcm(*(x.denominator for row in rows for x in row))
        numerators = (tuple(x.numerator * (denominator // x.denominator) for x in row) for row in rows)
        return cls(tuple(numerators), denominator)

    @classmethod
    def of_floats(cls, rows: Sequence[Sequence[float]]) -> "Exact":
        """Take doubles for the rationals that they are."""
        return cls.of([[Fraction(x) for x in row] for row in rows])

    @classmethod
    def identity(cls, n: int) -> "Exact":
        """Return the identity (n, n)."""
        return cls(tuple(tuple(int(i == j) for j in range(n)) for i in range(n)))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.numerators), len(self.numerators[0])

    @property
    def T(self) -> "Exact":
        """The transpose."""
        return Exact(tuple(zip(*self.numerators, strict=True)), self.denominator)

    @property
    def bits(self) -> int:
        """Length of the longest integer."""
        return max(self.denominator, *(abs(x) for row in self.numerators for x in row)).bit_length()

    def __getitem__(self, index: tuple[int, int]) -> Fraction:
        return Fraction(self.numerators[index[0]][index[1]], self.denominator)

    def __matmul__(self, other: "Exact") -> "Exact":
        columns = other.T.numerators
        product = (tuple(sum(map(mul, row, column)) for column in columns) for row in self.numerators)
        return Exact(tuple(product), self.denominator * other.denominator)

    def __add__(self, other: "Exact") -> "Exact":
        denominator = lcm(self.denominator, other.denominator)
        a, b = denominator // self.denominator, denominator // other.denominator
        pairs = zip(self.numerators, other.numerators, strict=True)
        return Exact(tuple(tuple(a * x + b * y for x, y in zip(p, q, strict=True)) for p, q in pairs), denominator)

    def __neg__(self) -> "Exact":
        return Exact(tuple(tuple(-x for x in row) for row in self.numerators), self.denominator)

    def __sub__(self, other: "Exact") -> "Exact":
        return self + -other

    def __mul__(self, factor: Fraction) -> "Exact":
        numerators = tuple(tuple(factor.numerator * x for x in row) for row in self.numerators)
        return Exact(numerators, self.denominator * factor.denominator)

    def equals(self, other: "Exact") -> bool:
        """Tell whether both are the same matrix."""
        return self.shape == other.shape and not any(any(row) for row in (self - other).numerators)

    @property
    def is_symmetric(self) -> bool:
        """Whether it is its own transpose."""
        return self.numerators == self.T.numerators

    def trace_of_product(self, other: "Exact") -> Fraction:
        """Return tr(self @ other)."""
        pairs = zip(self.numerators, other.T.numerators, strict=True)
        return Fraction(sum(sum(map(mul, p, q)) for p, q in pairs), self.denominator * other.denominator)


def symmetric_block(a: Exact, b: Exact, c: Exact) -> Exact:
    """Return [[a, b], [b', c]]."""
    denominator = lcm(a.denominator, b.denominator, c.denominator)
    x, y, z = (denominator // part.denominator for part in (a, b, c))
    cross = b.T
    rows = zip(a.numerators, b.numerators, strict=True)
    top = [(*(x * p for p in row), *(y * q for q in right)) for row, right in rows]
    rows = zip(cross.numerators, c.numerators, strict=True)
    below = [(*(y * q for q in left), *(z * r for r in row)) for left, row in rows]
    return Exact((*top, *below), denominator)


def is_definite(M: Exact) -> bool:
    """Decide M > 0 for a symmetric M; may raise TooLargeError."""
    return _decide(M, strict=True)


def is_semidefinite(M: Exact) -> bool:
    """Decide M >= 0 for a symmetric M; may raise TooLargeError."""
    return _decide(M, strict=False)


def _decide(M: Exact, strict: bool) -> bool:
    if not M.is_symmetric:
        raise ValueError("expected a symmetric matrix")
    table = [list(row) for row in M.numerators]
    return _dominant(table) or _pivots(table, strict)


def _pivots(a: Table, strict: bool) -> bool:
    """Tell whether all pivots of L D L' are positive, or where not strict, zero with a row of zeros.

    Fraction-free elimination (E. H. Bareiss, 1968): every division is exact, and the pivots met are the leading minors
    of the matrix without the rows left out.

    Raises:
        TooLargeError: it would take too long.
    """
    a, before, work = [row[: i + 1] for i, row in enumerate(a)], 1, 0
    for k in range(len(a)):
        pivot = a[k][k]
        column = [a[i][k] for i in range(k + 1, len(a))]
        if pivot < 0 or (pivot == 0 and (strict or any(column))):
            return False
        if pivot == 0:
            continue
        work += len(column) ** 2 * pivot.bit_length()
        if work > WORK:
            raise TooLargeError(f"a matrix of {len(a)} rows takes too long to decide whether it is semidefinite")
        for i, x in enumerate(column, start=k + 1):
            row = a[i]
            for j, y in enumerate(column[: i - k], start=k + 1):
                row[j] = (row[j] * pivot - x * y) // before
        before = pivot
    return True


def _dominant(a: Table) -> bool:
    """Prove M > 0: T M T' is strictly diagonally dominant, with T triangular, its diagonal positive, and all exact.

    T is the inverse of a Cholesky factor in floating point; False proves nothing.
    """
    n = len(a)
    halves = [(row[i].bit_length() + 1) // 2 for i, row in enumerate(a)]
    most = max(halves)
    scaled = [[x << (2 * most - halves[i] - halves[j]) for j, x in enumerate(row)] for i, row in enumerate(a)]
    T = _inverse_factor([[_ratio(x, 2 * most) for x in row] for row in scaled])
    if T is None:
        return False
    rows = [[int(ldexp(x, CONGRUENCE_BITS)) for x in row] for row in T]
    half = [[sum(map(mul, row, scaled_row)) for scaled_row in scaled] for row in rows]
    for i, row in enumerate(half):
        entries = [sum(map(mul, row, rows[j])) for j in range(n)]
        if rows[i][i] <= 0 or not 2 * entries[i] > sum(map(abs, entries)):
            return False
    return True


def _ratio(x: int, bits: int) -> float:
    """Return x / 2^bits; what is beyond the range of doubles is not finite."""
    shift = max(0, abs(x).bit_length() - 64)
    try:
        return ldexp(float(x >> shift), shift - bits)
    except OverflowError:
        return float("inf")


def _inverse_factor(a: list[list[float]]) -> list[list[float]] | None:
    """Return T = R^-1, R R' = a, as full rows with zeros right of the diagonal, or None."""
    n = len(a)
    R: list[list[float]] = []
    for i in range(n):
        row: list[float] = []
        for j in range(i):
            row.append((a[i][j] - sum(map(mul, row, R[j]))) / R[j][j])
        pivot = a[i][i] - sum(map(mul, row, row))
        if not (isfinite(pivot) and pivot > 0):
            return None
        R.append([*row, sqrt(pivot)])
    columns: list[list[float]] = []  # of T, from their diagonal downwards
    for j in range(n):
        column = [1.0 / R[j][j]]
        for i in range(j + 1, n):
            column.append(-sum(map(mul, R[i][j:i], column)) / R[i][i])
        columns.append(column)
    rows = [[columns[j][i - j] if j <= i else 0.0 for j in range(n)] for i in range(n)]
    return rows if all(map(isfinite, (x for row in rows for x in row))) else None
