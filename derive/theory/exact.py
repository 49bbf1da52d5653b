"""Exact arithmetic for evidence: small rational instances that separate a printed formula from the true one."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

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
