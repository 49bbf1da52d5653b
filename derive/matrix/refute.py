"""Exact counterexamples: rational matrices that satisfy every hypothesis, and at which the claim fails.

Scalars come first, ones before twos before zeros; then small integer matrices. What is found is simplified entry by
entry, and checked once more by code that shares nothing with the search.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

from derive.claim import Counterexample, Entries
from derive.kernel import Poly
from derive.matrix.hypotheses import Hypotheses, at_start
from derive.matrix.instance import Instance, one
from derive.matrix.plan import Plan, make_plan
from derive.matrix.recheck import confirm

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mat

__all__ = ["refute"]

LADDER = (1, 2, 0, -1, 3, -2)  # values of a scalar letter, the plainest first; a one hides less than a zero
POINTS = (2, 3, 5, Fraction(1, 2), -1)  # values of a central scalar
ENOUGH = 60  # instances that satisfy the hypotheses without failing, before larger sizes are tried
TRIES = 4000  # attempts at scalars
EQUAL = 0.8  # how often a letter outside the claim takes the value of its twin


def refute(
    lhs: Poly, rhs: Poly, problem: Hypotheses, *, relation: str = "=", trace: bool = False, seconds: float = 2.0
) -> Counterexample | None:
    """Search for an instance of the hypotheses where lhs relation rhs is false.

    Args:
        lhs: the left side.
        rhs: the right side, of the same type.
        problem: the hypotheses; those that bear on the claim hold exactly at what is returned.
        relation: '=', or '⪰', '≻' in the Loewner order.
        trace: compare the traces.
        seconds: bound on the time.

    Returns:
        The instance, or None if nothing was found. Where integrals from t0 to t bear on the claim, the instance is at
        t = t0, and its letters are named so. A claim with a Dirac delta is not tried.

    Example:
        >>> from derive.kernel import Alphabet, Letter
        >>> letters = Alphabet({x: Letter(x, "n", "n") for x in ("A", "B")})
        >>> A, B = (Poly({((), (x,)): 1}, "n", "n") for x in ("A", "B"))
        >>> found = refute(A * B, B * A, Hypotheses(letters))
        >>> found.left != found.right
        True
    """
    if _has_delta(lhs) or _has_delta(rhs):
        return None
    plan = make_plan(problem, (lhs, rhs))
    if plan is None:
        problem, lhs, rhs = problem.at_start(), at_start(lhs), at_start(rhs)
        plan = make_plan(problem, (lhs, rhs))
        assert plan is not None, "no integral is left at the start"
    attempt = Attempt(problem, plan, lhs, rhs, relation, trace)
    deadline = time.monotonic() + seconds
    for instance in _candidates(attempt):
        if time.monotonic() > deadline:
            return None
        if attempt.fails(instance):
            found = attempt.report(_simplified(attempt, instance, deadline))
            if confirm(found, lhs, rhs, problem):
                return found
    return None


def _has_delta(poly: Poly) -> bool:
    return any(s.startswith("δ") for m, _ in poly.terms for s in m)


@dataclass
class Attempt:
    """One claim under its hypotheses, and how many instances it has survived."""

    problem: Hypotheses
    plan: Plan
    lhs: Poly
    rhs: Poly
    relation: str
    trace: bool
    survived: int = 0

    def fails(self, instance: Instance) -> bool:
        """Complete an instance by the rules; tell whether the hypotheses hold there and the claim does not."""
        if not all(rule.apply(instance) for rule in self.plan.rules):
            return False
        refuted, admissible = self._refuted(instance), self._admissible(instance)
        self.survived += admissible and not refuted
        return admissible and refuted

    def _admissible(self, instance: Instance) -> bool:
        if any(instance.scalars.get(s, 0) < 0 for s in self.problem.nonnegative):
            return False
        if any(instance.central(poly) != 0 for poly in self.plan.central.values()):
            return False
        if any(x != 0 for poly in self.plan.relations.values() for x in instance.evaluate(poly).entries()):
            return False
        return all(map(instance.holds, self.plan.facts.values()))

    def _refuted(self, instance: Instance) -> bool:
        from derive.matrix.exact import positive_definite, positive_semidefinite

        if self.trace:
            return instance.trace(self.lhs) != instance.trace(self.rhs)
        difference = instance.evaluate(self.lhs) - instance.evaluate(self.rhs)
        if self.relation == "=":
            return any(x != 0 for x in difference.entries())
        return not (positive_definite if self.relation == "≻" else positive_semidefinite)(difference)

    def report(self, instance: Instance) -> Counterexample:
        """Return the instance as a counterexample, letters in the order of the alphabet."""
        self.fails(instance)
        order = {name: i for i, name in enumerate(self.problem.alphabet.letters)}
        names = sorted(instance.values, key=lambda a: (order.get(a.partition("@")[0], 0), a))
        sides = [((fraction(instance.trace(p)),),) if self.trace else entries(instance.evaluate(p)) for p in self.sides]
        return Counterexample(
            sizes=dict(instance.sizes),
            values={name: entries(instance.values[name]) for name in names},
            left=sides[0],
            right=sides[1],
            relation=self.relation,
            scalars={name: fraction(value) for name, value in sorted(instance.scalars.items())},
            hidden=frozenset(self.problem.inverses) | (frozenset(names) - self.plan.shown),
            trace=self.trace,
        )

    @property
    def sides(self) -> tuple[Poly, Poly]:
        """Both sides of the claim."""
        return self.lhs, self.rhs


# ------------------------------------------------------------------------------------------------ candidates
def _candidates(attempt: Attempt) -> Iterator[Instance]:
    """Iterate over choices of the free letters: scalars by increasing cost, then matrices, size by size."""
    dimensions = _dimensions(attempt)
    yield from _scalars(attempt, dict.fromkeys(dimensions, 1))
    generator = random.Random(0)
    for largest in (2, 2, 3, 3, 4):
        sizes = product(range(1, largest + 1), repeat=len(dimensions))
        for size in sorted((s for s in sizes if max(s, default=1) > 1), key=sum):
            attempt.survived = 0
            for _ in range(ENOUGH):
                yield _random(attempt, dict(zip(dimensions, size, strict=True)), generator)
    while dimensions:
        attempt.survived = 0
        yield _random(attempt, {d: generator.randint(1, 4) for d in dimensions}, generator)


def _dimensions(attempt: Attempt) -> list[str]:
    letters = attempt.problem.alphabet
    used = [*attempt.plan.free, *(rule.target for rule in attempt.plan.rules if rule.kind != "scalar")]
    names = [d for a in used for d in letters.shape(a)] + [d for p in attempt.sides for d in (p.rows, p.cols)]
    return [d for d in dict.fromkeys(names) if d and not d.isdigit()]


def _scalars(attempt: Attempt, sizes: dict[str, int]) -> Iterator[Instance]:
    """Iterate over 1 x 1 letters in the order of their total cost, the sum of their places in the ladder."""
    from flint import fmpq, fmpq_mat

    plan, ladders = attempt.plan, _ladders(attempt)
    tried = 0
    for cost in range(sum(len(ladder) - 1 for ladder in ladders) + 1):
        for places in _spread(cost, [len(ladder) for ladder in ladders]):
            values: dict[str, fmpq] = {}
            for name, ladder, place in zip((*plan.free, *plan.free_scalars), ladders, places, strict=True):
                value = ladder[place]
                values[name] = values[value] if isinstance(value, str) else fmpq(value.numerator, value.denominator)
            matrices = {name: fmpq_mat(1, 1, [values[name]]) for name in plan.free}
            points = {name: values[name] for name in plan.free_scalars}
            yield Instance(attempt.problem.alphabet, sizes, matrices, points)
            tried += 1
            if tried >= TRIES or attempt.survived >= ENOUGH:
                return


def _ladders(attempt: Attempt) -> list[Sequence[int | Fraction | str]]:
    """Return the values to be tried for each free letter and scalar; the name of a letter stands for its value."""
    plan, ladders = attempt.plan, list[Sequence[int | Fraction | str]]()
    for name in plan.free:
        kind = _sign(attempt, name)
        values = [v for v in LADDER if not kind or v > 0 or (v == 0 and kind == "psd")]
        ladders.append([plan.twins[name], *values] if name in plan.twins else values)
    return ladders + [POINTS] * len(plan.free_scalars)


def _sign(attempt: Attempt, letter: str) -> str:
    """Return what is known of a letter itself: 'psd', 'pd' or nothing."""
    own = {f.matrix[0][0]: f.kind for f in attempt.plan.facts.values() if len(f.matrix) == 1}
    kind = own.get(Poly({((), (letter,)): 1}, *attempt.problem.alphabet.shape(letter)), "")
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


def _random(attempt: Attempt, sizes: dict[str, int], generator: random.Random) -> Instance:
    """Draw small integer matrices; a letter that must be positive is a square, a twin mostly an equal."""
    from flint import fmpq

    instance, plan = Instance(attempt.problem.alphabet, sizes), attempt.plan
    for name in plan.free:
        if name in plan.twins and generator.random() < EQUAL:
            instance.values[name] = instance.values[plan.twins[name]]
            continue
        rows, cols = instance.shape(name)
        value, kind = _integers(rows, cols, generator), _sign(attempt, name)
        if kind:
            value = value * value.transpose()
            if kind == "pd" and value.det() == 0:
                value += one(rows)
        elif attempt.problem.alphabet.letters[name.partition("@")[0]].symmetric:
            value += value.transpose()
        instance.values[name] = value
    for name in plan.free_scalars:
        point = Fraction(generator.choice(POINTS))
        instance.scalars[name] = fmpq(point.numerator, point.denominator)
    return instance


def _integers(rows: int, cols: int, generator: random.Random) -> fmpq_mat:
    from flint import fmpq_mat

    high = generator.choice((1, 1, 2))
    return fmpq_mat(rows, cols, [generator.randint(-high, high) for _ in range(rows * cols)])


def _simplified(attempt: Attempt, instance: Instance, deadline: float) -> Instance:
    """Replace entries of the free letters by 0, 1 or -1 while the claim still fails."""
    for name in attempt.plan.free:
        rows, cols = instance.shape(name)
        if max(instance.sizes.values(), default=1) == 1:
            break
        for i, j in product(range(rows), range(cols)):
            for simple in (0, 1, -1):
                if time.monotonic() > deadline or abs(instance.values[name][i, j]) <= abs(simple):
                    break
                trial = _changed(attempt, instance, name, (i, j), simple)
                if attempt.fails(trial):
                    instance = trial
                    break
    return instance


def _changed(attempt: Attempt, instance: Instance, name: str, place: tuple[int, int], value: int) -> Instance:
    """Return a copy of the free part of an instance with one entry changed (and its mirror, if symmetric)."""
    from flint import fmpq_mat

    free = {a: fmpq_mat(instance.values[a]) for a in attempt.plan.free}
    i, j = place
    free[name][i, j] = value
    if attempt.problem.alphabet.letters[name.partition("@")[0]].symmetric:
        free[name][j, i] = value
    points = {s: instance.scalars[s] for s in attempt.plan.free_scalars}
    return Instance(instance.alphabet, instance.sizes, free, points)


def fraction(value: fmpq) -> Fraction:
    """Return a rational number of FLINT as a fraction of the standard library."""
    return Fraction(int(value.p), int(value.q))


def entries(matrix: fmpq_mat) -> Entries:
    """Return a matrix of FLINT as rows of fractions."""
    rows, cols = matrix.nrows(), matrix.ncols()
    return tuple(tuple(fraction(matrix[i, j]) for j in range(cols)) for i in range(rows))
