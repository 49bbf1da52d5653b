"""A first look at a claim: does it hold at random instances of its equations?

What fails there does not follow from them, so no proof is looked for. Definiteness and stability are not asked of these
instances; ``refute`` finds those that satisfy everything.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import replace

from derive.kernel import Poly, parts
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import Instance, one
from derive.matrix.plan import Plan, make_plans

__all__ = ["holds_at", "sample"]

TRIES = 6  # random instances for each that is wanted
LARGEST = 3  # entries of free letters are between -3 and 3
SIZES = (2, 3)  # dimensions in turn


def sample(problem: Hypotheses, polys: Iterable[Poly], count: int = 1, seed: int = 1) -> list[Instance]:
    """Return random instances of the equations that bear on some polynomials; fewer if they are hard to solve."""
    polys = list(polys)
    plans = make_plans(replace(problem, facts={}), polys)
    return _sample(problem, plans[-1], polys, count, seed) if plans else []


def _sample(problem: Hypotheses, plan: Plan, polys: Sequence[Poly], count: int, seed: int) -> list[Instance]:
    generator, found = random.Random(seed), list[Instance]()
    letters = [*plan.free, *(rule.target for rule in plan.rules if rule.kind != "scalar")]
    names = [d for a in letters for d in problem.alphabet.shape(a)] + [d for p in polys for d in (p.rows, p.cols)]
    dimensions = [d for d in dict.fromkeys(names) if d and not d.isdigit()]
    sizes = {d: SIZES[i % len(SIZES)] for i, d in enumerate(dimensions)}
    for _ in range(TRIES * count):
        instance = _draw(problem, plan, sizes, generator)
        if all(rule.apply(instance) for rule in plan.rules) and _satisfies(plan, instance):
            found.append(instance)
            if len(found) == count:
                break
    return found


def holds_at(instances: Iterable[Instance], poly: Poly, trace: bool = False) -> bool:
    """Tell whether a polynomial (its trace) is zero at every instance; also if it has letters without a value."""
    for instance in instances:
        try:
            zero = instance.trace(poly) == 0 if trace else not any(x != 0 for x in instance.evaluate(poly).entries())
        except KeyError:
            return True
        if not zero:
            return False
    return True


def _draw(problem: Hypotheses, plan: Plan, sizes: dict[str, int], generator: random.Random) -> Instance:
    from flint import fmpq, fmpq_mat

    instance = Instance(problem.alphabet, sizes)
    for s in plan.free_scalars:
        instance.scalars[s] = fmpq(generator.randint(2, 9), generator.choice((1, 7)))
    for name in plan.free:
        rows, cols = instance.shape(name)
        value = fmpq_mat(rows, cols, [generator.randint(-LARGEST, LARGEST) for _ in range(rows * cols)])
        symmetric = problem.alphabet.letters[parts(name)[0]].symmetric
        instance.values[name] = value * value.transpose() + one(rows) if symmetric else value
    return instance


def _satisfies(plan: Plan, instance: Instance) -> bool:
    if any(instance.central(poly) != 0 for poly in plan.central.values()):
        return False
    return not any(x != 0 for poly in plan.relations.values() for x in instance.evaluate(poly).entries())
