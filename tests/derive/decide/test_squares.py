"""Equations with nonnegative unknowns: solved exactly, or shown to have no solution by another method."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import combinations

import pytest

from derive.claim import Verdict
from derive.decide.squares import nonnegative_solution
from derive.matrix.recheck import eliminate
from tests.derive.decide.reading import DT, KB, answer


def by_bases(rows: list[list[Fraction]]) -> bool:
    """Decide by trying every choice of at most two unknowns that are not zero, for two equations."""
    size, right = len(rows[0]) - 1, [row[-1] for row in rows]
    if not any(right):
        return True
    for i, j in combinations(range(size), 2):
        found = eliminate([[row[i], row[j]] for row in rows], right)
        if found is not None and min(found) >= 0:
            return True
    columns = [[row[j] for row in rows] for j in range(size)]
    return any(
        c[0] * right[1] == c[1] * right[0] and any(x and r / x >= 0 for x, r in zip(c, right, strict=True))
        for c in columns
        if any(c)
    )


@pytest.mark.parametrize("seed", range(60))
def test_nonnegative_solutions(seed):
    generator = random.Random(seed)
    rows = [[Fraction(generator.randint(-3, 3)) for _ in range(5)] for _ in range(2)]
    found = nonnegative_solution(rows)
    assert (found is not None) == by_bases(rows)
    if found is not None:
        assert min(found) >= 0
        assert all(sum(a * c for a, c in zip(row[:-1], found, strict=True)) == row[-1] for row in rows)


def test_no_equation_is_solved_by_nothing():
    assert nonnegative_solution([]) == []


def test_a_claim_that_is_zero_is_a_sum_of_no_squares():
    assert answer(r"P \succeq 2 P", DT, ("P = 0",)).verdict is Verdict.proved


ORDER = [
    (r"P_k \succeq P_{k+1}", DT, (r"P_{k-1} \succeq P_k",)),
    (r"P_{k+1} \succeq P_k", DT, (r"P_k \succeq P_{k-1}",)),
    (r"Q - L_k S^T - S L_k^T + L_k R L_k^T \succeq 0", DT, ()),
    (r"Q \succeq S R^{-1} S^T", DT, ()),
    (r"\begin{bmatrix} W & N \\ N^T & V \end{bmatrix} \succeq 0", KB, ()),
    (r"\begin{bmatrix} A P + P A^T + W & P C^T \\ C P & V \end{bmatrix} \succeq 0", KB, ()),
    (r"(P^+)^{-1} \succeq P^{-1}", DT, (r"P \succ 0",)),
]


@pytest.mark.parametrize(("latex", "theory", "assume"), ORDER)
def test_orders_by_several_squares(latex, theory, assume):
    assert answer(latex, theory, assume).verdict is Verdict.proved


@pytest.mark.parametrize(
    ("latex", "theory", "assume"),
    [
        (r"P_k \succeq P_{k+1}", DT, ()),
        (r"P_k \preceq P_{k+1}", DT, (r"P_{k-1} \succeq P_k",)),
        (r"Q - L_k S^T - S L_k^T \succeq 0", DT, ()),
        (r"Q \preceq S R^{-1} S^T", DT, ()),
    ],
)
def test_orders_that_fail(latex, theory, assume):
    assert answer(latex, theory, assume).verdict is Verdict.refuted
