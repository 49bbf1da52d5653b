"""Quasi-Newton descent in a metric that is renewed: for costs that know their gradient and their curvature in part."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca
import numpy as np

from derive.numeric.gain_ipopt import minimise
from derive.numeric.modes import Matrix

__all__ = ["Cost", "Descent", "descend", "newton"]

ROUNDS = 12
"""Restarts in the metric of the last point."""

ITERATIONS = 40
"""Iterations after which a new metric pays."""

METRIC_FLOOR = 1e-12
"""Smallest eigenvalue of the metric, relative to its largest."""

SETTLED = 1e-15
"""Relative decrease of the cost that a Newton step promises, below which no restart follows."""

OPTIONS = {
    "ipopt.hessian_approximation": "limited-memory",
    "ipopt.limited_memory_max_history": ITERATIONS,
    "ipopt.max_iter": ITERATIONS,
    "ipopt.tol": 1e-12,
}


class Cost(Protocol):
    """A positive function of a vector x (p,)."""

    def value(self, x: Matrix) -> float:
        """Return the cost, infinite where it is not defined."""
        ...

    def gradient(self, x: Matrix) -> Matrix:
        """Return the gradient (p,)."""
        ...

    def metric(self, x: Matrix) -> Sequence[Matrix]:
        """Return the blocks of a positive semidefinite matrix (p, p) near the second derivative."""
        ...

    def expression(self, x: Any) -> tuple[Any, Any]:
        """Return the cost as an expression of CasADi, and an object to keep as long as that is used."""
        ...


@dataclass(frozen=True, eq=False)
class Descent:
    """Where a descent ended.

    Attributes:
        x: the best point (p,).
        points: on the way, the first one included.
        iterations: of IPOPT, in all rounds.
        decrement: relative decrease of the cost that a Newton step in the metric still promises.
    """

    x: Matrix
    points: tuple[Matrix, ...]
    iterations: int
    decrement: float


def descend(cost: Cost, x: Matrix, rounds: int = ROUNDS) -> Descent:
    """Minimise a cost from a point where it is defined, by quasi-Newton steps of IPOPT with the exact gradient.

    Each round starts in coordinates in which the metric at its first point is the identity. Where the metric is the
    second derivative at the minimum, the last rounds take a step or two.
    """
    points, iterations = [x], 0
    value, (decrement, root) = cost.value(x), newton(cost, x)
    for _ in range(rounds):
        if not (decrement > SETTLED and 0 < value < np.inf):
            break
        z = ca.MX.sym("z", len(x))
        f, kept = cost.expression(ca.DM(x) + ca.sparsify(ca.DM(root)) @ z)
        run = minimise({"x": z, "f": f / value}, np.zeros(len(x)), OPTIONS)
        del kept
        iterations += run.iterations
        points += [x + root @ point for point in run.points[1:]]
        better = x + root @ run.x
        if not cost.value(better) < value:
            break
        x, value = better, cost.value(better)
        decrement, root = newton(cost, x)
    return Descent(x, tuple(points), iterations, decrement)


def newton(cost: Cost, x: Matrix) -> tuple[float, Matrix]:
    """Return the relative decrease that a Newton step promises, and T (p, p) with T' metric T = I."""
    from scipy.linalg import block_diag

    roots = []
    for metric in cost.metric(x):
        sizes, directions = np.linalg.eigh(metric)
        floor = max(METRIC_FLOOR * sizes.max(initial=0), np.finfo(float).tiny)
        roots.append(directions / np.sqrt(np.maximum(sizes, floor)))
    root, value = np.asarray(block_diag(*roots)), cost.value(x)
    slope = root.T @ cost.gradient(x)
    return (float(slope @ slope / 2 / value) if value > 0 else 0.0), root
