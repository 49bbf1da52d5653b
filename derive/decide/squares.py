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

__all__ = ["usual_squares"]

MOST = 40  # squares that are tried at once
ROUNDS = 4  # in which squares with negative coefficients are left out


def usual_squares(claim: Poly, strict: bool, work: Workspace) -> Iterator[tuple[Square, ...]]:
    """Iterate over sums of usual squares that are equal to the claim at random instances."""
    squares = list(islice(_usual(claim, strict, work), MOST))
    instances = _instances(claim, squares, work)
    for _ in range(ROUNDS if instances and squares else 0):
        solution = _solve(claim, squares, instances, work)
        if solution is None:
            return
        if all(c >= 0 for c in solution):
            found = zip(squares, solution, strict=True)
            yield tuple(Square(fraction(c), (), s.factor, s.fact) for s, c in found if c)
            return
        squares = [s for s, c in zip(squares, solution, strict=True) if c >= 0]


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
        if set(core.terms) == {((), ())} or len(core.terms) > 1:
            continue
        plain = core.rows == claim.rows and not (strict and core == claim)
        ours = [identity(core.rows)] if plain else []
        ours += [f for f in factors if (f.rows, f.cols) == (claim.rows, core.rows)]
        yield from (Square(Fraction(1), (), ((f,),), name) for f in ours)


def _factors(work: Workspace) -> Iterator[Poly]:
    """Iterate over closed loops, gains and A."""
    context = work.theory.reading.context
    for fact in context.facts.values():
        if fact.kind in ("schur", "hurwitz"):
            yield fact.matrix[0][0]
    for name in sorted(work.theory.optimal):
        relation = context.relations.get(name)
        if relation is not None:
            gains = [w for m, w in relation.terms if not m and len(w) == 1]
            yield from (Poly({((), w): 1}, relation.rows, relation.cols) for w in gains)
    for letter in ("A", "A'"):
        if letter[0] in context.alphabet.letters:
            yield Poly({((), (letter,)): 1}, *context.alphabet.shape(letter))


def _instances(claim: Poly, squares: list[Square], work: Workspace) -> list[Instance]:
    polys = [claim, *(s.factor[0][0] for s in squares)]
    polys += [work.reading.context.facts[s.fact].matrix[0][0] for s in squares]
    return sample(work.equations(False), polys, 2 + len(squares) // 3)


def _solve(claim: Poly, squares: list[Square], instances: list[Instance], work: Workspace) -> list[fmpq] | None:
    """Return coefficients with claim = sum c F H F' at every instance, zero where they are free; or None."""
    rows: list[list[fmpq]] = []
    for instance in instances:
        columns = [_value(s, instance, work).entries() for s in squares]
        rows += [list(row) for row in zip(*columns, instance.evaluate(claim).entries(), strict=True)]
    echelon, rank = stack(rows).rref()
    found = [echelon[0, 0] * 0 for _ in squares]
    for i in range(rank):
        pivot = next(j for j in range(len(squares) + 1) if echelon[i, j] != 0)
        if pivot == len(squares):
            return None
        found[pivot] = echelon[i, len(squares)]
    return found


def _value(square: Square, instance: Instance, work: Workspace):
    factor = instance.evaluate(square.factor[0][0])
    core = instance.evaluate(work.reading.context.facts[square.fact].matrix[0][0])
    return factor * core * factor.transpose()
