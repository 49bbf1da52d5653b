"""Squares that the claims of estimation are sums of: a covariance under the closed loop, noise under the gain.

The coefficients are found by solving linear equations at exact instances; what is found is proved like any proposal.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING

from derive.decide.workspace import Workspace
from derive.kernel import Poly, identity
from derive.matrix.instance import Instance, stack
from derive.matrix.refute import fraction
from derive.matrix.sample import sample
from derive.rules import Square

if TYPE_CHECKING:
    from flint import fmpq

__all__ = ["gains", "nonnegative_solution", "usual_squares"]

MOST = 60  # squares that are tried at once


def usual_squares(claim: Poly, strict: bool, work: Workspace) -> Iterator[tuple[Square, ...]]:
    """Iterate over sums of usual squares that are equal to the claim at random instances; there is one at most."""
    squares = list(islice(_usual(claim, strict, work), MOST))
    instances = _instances(claim, squares, work)
    if not instances or not squares:
        return
    solution = nonnegative_solution(_equations(claim, squares, instances, work))
    if solution is not None:
        found = zip(squares, solution or [Fraction(0)] * len(squares), strict=True)
        yield tuple(Square(c, (), s.factor, s.fact) for s, c in found if c)


def _usual(claim: Poly, strict: bool, work: Workspace) -> Iterator[Square]:
    """Iterate over F H F' for the facts H and the factors F that fit; not the claim itself where more is asked."""
    factors = list(_factors(work))
    facts = work.reading.context.facts
    definite = {f.matrix[0][0] for f in facts.values() if f.kind == "pd" and len(f.matrix) == 1}
    for name, fact in facts.items():
        if fact.kind not in ("psd", "pd") or len(fact.matrix) != 1:
            continue
        core = fact.matrix[0][0]
        if fact.kind == "psd" and core in definite:
            continue
        if set(core.terms) == {((), ())}:
            continue
        plain = core.rows == claim.rows and not (strict and core == claim)
        ours = [identity(core.rows)] if plain else []
        ours += [f for f in factors if (f.rows, f.cols) == (claim.rows, core.rows)]
        yield from (Square(Fraction(1), (), ((f,),), name) for f in ours)


def _factors(work: Workspace) -> Iterator[Poly]:
    """Iterate over closed loops, gains and their differences, and A."""
    context = work.theory.reading.context
    yield from (f.matrix[0][0] for f in context.facts.values() if f.kind in ("schur", "hurwitz"))
    known, found = context.alphabet, gains(work)
    yield from found
    yield from (x - y for x in found for y in found if x != y and (x.rows, x.cols) == (y.rows, y.cols))
    if "A" in known.letters:
        A = Poly({((), ("A",)): 1}, *known.shape("A"))
        yield from (A, known.transpose(A))
        if "C" in known.letters:
            C = Poly({((), ("C",)): 1}, *known.shape("C"))
            yield from (A - x * C for x in found if (x.rows, x.cols) == (A.rows, C.rows))


def gains(work: Workspace) -> list[Poly]:
    """Return the letters that the theory gives an optimum."""
    context = work.theory.reading.context
    relations = [context.relations[n] for n in sorted(work.theory.optimal) if n in context.relations]
    words = [(w, r) for r in relations for m, w in r.terms if not m and len(w) == 1]
    return [Poly({((), w): 1}, r.rows, r.cols) for w, r in words]


def _instances(claim: Poly, squares: list[Square], work: Workspace) -> list[Instance]:
    polys = [claim, *(s.factor[0][0] for s in squares)]
    polys += [work.reading.context.facts[s.fact].matrix[0][0] for s in squares]
    return sample(work.equations(False), polys, 2 + len(squares) // 3)


def _equations(claim: Poly, squares: list[Square], instances: list[Instance], work: Workspace) -> list[list[Fraction]]:
    """Return the equations claim = sum c F H F' for the c, entry by entry: coefficients and right-hand side."""
    rows: list[list[fmpq]] = []
    for instance in instances:
        columns = [_value(s, instance, work).entries() for s in squares]
        rows += [list(row) for row in zip(*columns, instance.evaluate(claim).entries(), strict=True)]
    echelon, rank = stack(rows).rref()
    return [[fraction(echelon[i, j]) for j in range(len(squares) + 1)] for i in range(rank)]


def nonnegative_solution(rows: list[list[Fraction]]) -> list[Fraction] | None:
    """Return c >= 0 that solves equations, each given as its coefficients and right-hand side, or None.

    The simplex method: an unknown is added to every equation, and their sum is made zero; by Bland's rule it ends.
    """
    count, size = len(rows), len(rows[0]) - 1 if rows else 0
    table = [[-x for x in row] if row[-1] < 0 else list(row) for row in rows]
    table = [[*row[:-1], *(Fraction(int(i == j)) for j in range(count)), row[-1]] for i, row in enumerate(table)]
    cost = [-sum((row[j] for row in table), Fraction(0)) if not size <= j < size + count else Fraction(0)
            for j in range(size + count + 1)]  # fmt: skip
    basis = list(range(size, size + count))
    while (entering := next((j for j in range(size) if cost[j] < 0), None)) is not None:
        steps = [(row[-1] / row[entering], basis[i], i) for i, row in enumerate(table) if row[entering] > 0]
        if not steps:
            return None
        _, _, at = min(steps)
        pivot = table[at][entering]
        table[at] = [x / pivot for x in table[at]]
        for row in (*table[:at], *table[at + 1 :], cost):
            factor = row[entering]
            if factor:
                row[:] = [x - factor * y for x, y in zip(row, table[at], strict=True)]
        basis[at] = entering
    if cost[-1] != 0:
        return None
    solution = [Fraction(0)] * size
    for i, j in enumerate(basis):
        if j < size:
            solution[j] = table[i][-1]
    return solution


def _value(square: Square, instance: Instance, work: Workspace):
    factor = instance.evaluate(square.factor[0][0])
    core = instance.evaluate(work.reading.context.facts[square.fact].matrix[0][0])
    return factor * core * factor.transpose()
