"""Exact counterexamples: rational matrices that satisfy every hypothesis, and at which the claim fails.

Scalars come first, ones before twos before zeros; then small integer matrices. What is found is simplified entry by
entry, and checked once more by code that shares nothing with the search.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, product
from typing import TYPE_CHECKING

from derive.claim import Counterexample, Entries
from derive.kernel import Poly
from derive.matrix.candidates import matrix_instances, scalar_instances
from derive.matrix.hypotheses import Hypotheses, at_start
from derive.matrix.instance import Instance
from derive.matrix.plan import Plan, make_plans
from derive.matrix.recheck import confirm

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mat

__all__ = ["instances", "refute", "satisfy"]

ENOUGH = 60  # instances that satisfy the hypotheses without failing, before larger sizes are tried; tries of a size
MOST = 4000  # instances that are tried for one that satisfies the hypotheses
TRIES = 2000  # attempts at scalars


def refute(
    lhs: Poly,
    rhs: Poly,
    problem: Hypotheses,
    *,
    relation: str = "=",
    trace: bool = False,
    most: int | None = None,
    seconds: float = 2.0,
) -> Counterexample | None:
    """Search for an instance of the hypotheses where lhs relation rhs is false.

    Args:
        lhs: the left side.
        rhs: the right side, of the same type.
        problem: the hypotheses; those that bear on the claim hold exactly at what is returned.
        relation: '=', '≠', or '⪰', '≻' in the Loewner order; 'invertible' says that lhs is, 'false' nothing true.
        trace: compare the traces, by '=', '≠', '≥' or '>'.
        most: bound on the number of instances that are tried, the same on every machine.
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
    deadline = time.monotonic() + seconds
    plans = make_plans(problem, (lhs, rhs))
    if not plans:
        problem, lhs, rhs = problem.at_start(), at_start(lhs), at_start(rhs)
        plans = make_plans(problem, (lhs, rhs))
    attempts = [Attempt(problem, plan, lhs, rhs, relation, trace) for plan in plans]
    for attempt, instance in islice(_candidates(attempts), most):
        if time.monotonic() > deadline:
            return None
        if attempt.fails(instance):
            found = attempt.report(_simplified(attempt, instance, deadline))
            if confirm(found, lhs, rhs, problem):
                return found
    return None


def satisfy(problem: Hypotheses, polys: Sequence[Poly], *, seconds: float = 2.0) -> Counterexample | None:
    """Search for an instance of the hypotheses that bear on some polynomials.

    Returns:
        The instance, which says that the hypotheses do not contradict each other, or None if nothing was found.
    """
    deadline = time.monotonic() + seconds
    plans = make_plans(problem, polys)
    if not plans:
        problem, polys = problem.at_start(), [at_start(p) for p in polys]
        plans = make_plans(problem, polys)
    nothing = Poly({}, "1", "1")
    attempts = [Attempt(problem, plan, nothing, nothing, "false", False) for plan in plans]
    for attempt, instance in islice(_candidates(attempts), MOST):
        if time.monotonic() > deadline:
            return None
        if attempt.fails(instance):
            found = attempt.report(instance)
            if confirm(found, nothing, nothing, problem):
                return found
    return None


def instances(problem: Hypotheses, polys: Sequence[Poly], count: int, *, seconds: float = 1.0) -> list[Instance]:
    """Return random matrices that satisfy the hypotheses which bear on some polynomials; fewer if time is up."""
    deadline, nothing, found = time.monotonic() + seconds, Poly({}, "1", "1"), list[Instance]()
    for plan in make_plans(problem, polys)[-1:]:
        attempt = Attempt(problem, plan, nothing, nothing, "false", False)
        for instance in islice(matrix_instances(problem, plan, [*polys], repeat=3), MOST):
            if len(found) == count or time.monotonic() > deadline:
                break
            if attempt.fails(instance):
                found.append(instance)
    return found


def _candidates(attempts: Sequence[Attempt]) -> Iterator[tuple[Attempt, Instance]]:
    """Iterate over instances to try: scalars by the first plan that has some, then matrices by all plans in turn."""
    for attempt in attempts:
        scalars = scalar_instances(attempt.problem, attempt.plan, attempt.sides)
        for instance in islice(scalars, TRIES):
            yield attempt, instance
            if attempt.survived >= ENOUGH:
                break
        if attempt.survived:
            break
    series = [matrix_instances(a.problem, a.plan, a.sides, repeat=ENOUGH) for a in attempts]
    for round_ in zip(*series, strict=False):
        yield from zip(attempts, round_, strict=True)


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

        if self.relation == "false":
            return True
        if self.relation == "invertible":
            return instance.evaluate(self.lhs).det() == 0
        if self.trace:
            gap = instance.trace(self.lhs) - instance.trace(self.rhs)
            return {"=": gap != 0, "≠": gap == 0, "≥": gap < 0, ">": gap <= 0}[self.relation]
        difference = instance.evaluate(self.lhs) - instance.evaluate(self.rhs)
        if self.relation in ("=", "≠"):
            return (self.relation == "=") == any(x != 0 for x in difference.entries())
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


# ------------------------------------------------------------------------------------------------ plain values
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
