"""Values to try for the free letters of a plan: scalars by increasing cost, then small random matrices."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

from derive.kernel import Poly
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import Instance, one
from derive.matrix.plan import Plan

if TYPE_CHECKING:
    from flint import fmpq_mat

__all__ = ["matrix_instances", "scalar_instances"]

LADDER = (1, 2, 0, -1, 3, -2)  # values of a scalar letter, the plainest first; a one hides less than a zero
POINTS = (2, 3, 5, Fraction(1, 2), -1)  # values of a central scalar
LARGEST = (2, 2, 3, 3, 4)  # bounds on the sizes, round by round
RANGES = ((1, 1), (1, 1), (2, 1), (1, 2))  # bound on the numerators of a random matrix, and its denominator


def scalar_instances(problem: Hypotheses, plan: Plan, sides: Sequence[Poly]) -> Iterator[Instance]:
    """Iterate over 1 x 1 letters in the order of their total cost, the sum of their places in the ladder."""
    from flint import fmpq, fmpq_mat

    sizes, ladders = dict.fromkeys(_dimensions(problem, plan, sides), 1), _ladders(problem, plan)
    for cost in range(sum(len(ladder) - 1 for ladder in ladders) + 1):
        for places in _spread(cost, [len(ladder) for ladder in ladders]):
            values = [fmpq(v.numerator, v.denominator) for v in (ladders[i][p] for i, p in enumerate(places))]
            matrices = {name: fmpq_mat(1, 1, [v]) for name, v in zip(plan.free, values, strict=False)}
            points = dict(zip(plan.free_scalars, values[len(plan.free) :], strict=True))
            yield Instance(problem.alphabet, sizes, matrices, points)


def matrix_instances(problem: Hypotheses, plan: Plan, sides: Sequence[Poly], repeat: int) -> Iterator[Instance]:
    """Iterate without end over random small matrices, the smallest sizes first, each size several times."""
    dimensions, generator = _dimensions(problem, plan, sides), random.Random(0)
    for largest in LARGEST:
        sizes = product(range(1, largest + 1), repeat=len(dimensions))
        for size in sorted((s for s in sizes if max(s, default=1) > 1), key=sum):
            for _ in range(repeat):
                yield _random(problem, plan, dict(zip(dimensions, size, strict=True)), generator)
    while dimensions:
        yield _random(problem, plan, {d: generator.randint(1, LARGEST[-1]) for d in dimensions}, generator)


def _dimensions(problem: Hypotheses, plan: Plan, sides: Sequence[Poly]) -> list[str]:
    used = [*plan.free, *(rule.target for rule in plan.rules if rule.kind != "scalar")]
    names = [d for a in used for d in problem.alphabet.shape(a)] + [d for p in sides for d in (p.rows, p.cols)]
    return [d for d in dict.fromkeys(names) if d and not d.isdigit()]


def _ladders(problem: Hypotheses, plan: Plan) -> list[Sequence[int | Fraction]]:
    """Return the values to be tried for each free letter and scalar."""
    ladders: list[Sequence[int | Fraction]] = []
    for name in plan.free:
        kind = _sign(problem, plan, name)
        ladders.append([v for v in LADDER if not kind or v > 0 or (v == 0 and kind == "psd")])
    return ladders + [POINTS] * len(plan.free_scalars)


def _sign(problem: Hypotheses, plan: Plan, letter: str) -> str:
    """Return what is known of a letter itself: 'psd', 'pd' or nothing."""
    own = {f.matrix[0][0]: f.kind for f in plan.facts.values() if len(f.matrix) == 1}
    kind = own.get(Poly({((), (letter,)): 1}, *problem.alphabet.shape(letter)), "")
    return kind if kind in ("psd", "pd") else ""


def _spread(total: int, lengths: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Iterate over tuples of places with the given sum, each below its length; the last ones vary slowest."""
    if not lengths:
        if total == 0:
            yield ()
        return
    for place in range(min(total, lengths[0] - 1), -1, -1):
        for rest in _spread(total - place, lengths[1:]):
            yield (place, *rest)


def _random(problem: Hypotheses, plan: Plan, sizes: dict[str, int], generator: random.Random) -> Instance:
    """Draw small matrices; a letter that must be positive is a square."""
    from flint import fmpq

    instance = Instance(problem.alphabet, sizes)
    for name in plan.free:
        rows, cols = instance.shape(name)
        value, kind = _draw(rows, cols, generator), _sign(problem, plan, name)
        if kind:
            value = value * value.transpose()
            if kind == "pd" and value.det() == 0:
                value += one(rows)
        elif problem.alphabet.letters[name.partition("@")[0]].symmetric:
            value += value.transpose()
        instance.values[name] = value
    for name in plan.free_scalars:
        point = Fraction(generator.choice(POINTS))
        instance.scalars[name] = fmpq(point.numerator, point.denominator)
    return instance


def _draw(rows: int, cols: int, generator: random.Random) -> fmpq_mat:
    from flint import fmpq_mat

    high, denominator = generator.choice(RANGES)
    return fmpq_mat(rows, cols, [generator.randint(-high, high) for _ in range(rows * cols)]) / denominator
