"""What the numbers that a solver returned say about its answer: residuals, duality gap, margins of definiteness."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

__all__ = ["Optimality", "optimality"]

Vector = NDArray[np.floating[Any]]

TINY = 1e-300


@dataclass(frozen=True)
class Optimality:
    """The conditions of optimality of an affine program in the order of symmetric matrices, recomputed.

        min f(x)  s.t.  G_k(x) >= 0,  h(x) = 0,     dual:  max L(0; Z, y)  s.t.  dL/dx = 0,  Z_k >= 0
        L(x; Z, y) = f(x) - sum tr(Z_k G_k(x)) + y'h(x)

    Attributes:
        margin: smallest eigenvalue of a G_k(x) relative to its norm; negative when it fails.
        violation: largest entry of h(x), relative to the largest entry of a variable (at least 1).
        dual_margin: smallest eigenvalue of a multiplier Z_k relative to its norm.
        stationarity: |dL/dx| relative to the norms of its terms.
        gap: |f(x) - L(0; Z, y)| / (1 + |f(x)|), between the primal and the dual value; it bounds how far f(x) is from
            its optimum when the other four are zero.
    """

    margin: float
    violation: float
    dual_margin: float
    stationarity: float
    gap: float

    def holds(self, tolerance: float) -> bool:
        """Tell whether every condition holds up to a relative tolerance."""
        wrong = (-self.margin, self.violation, -self.dual_margin, self.stationarity, self.gap)
        return all(value <= tolerance for value in wrong)


def optimality(problem: cp.Problem) -> Optimality:
    """Recompute the conditions of optimality from the numbers in a problem's variables and multipliers.

    Args:
        problem: affine objective, equations and matrix inequalities, solved, all numbers finite.
    """
    cones = [constraint for constraint in problem.constraints if isinstance(constraint, cp.PSD)]
    equations = [constraint for constraint in problem.constraints if not isinstance(constraint, cp.PSD)]
    sizes = [float(np.abs(np.asarray(variable.value)).max()) for variable in problem.variables()]
    stationarity, gap = _dual_conditions(problem)
    return Optimality(
        margin=min((_least(constraint.args[0].value) for constraint in cones), default=np.inf),
        violation=float(max((np.max(x.violation()) for x in equations), default=0.0)) / max(1.0, *sizes),
        dual_margin=min((_least(np.asarray(constraint.dual_value)) for constraint in cones), default=np.inf),
        stationarity=stationarity,
        gap=gap,
    )


def _least(matrix: Vector) -> float:
    """Return the smallest eigenvalue, relative to the largest in size."""
    matrix = np.atleast_2d(matrix)
    sizes = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    return float(sizes[0] / max(np.abs(sizes).max(), TINY))


def _dual_conditions(problem: cp.Problem) -> tuple[float, float]:
    """Return |dL/dx| relative to its terms, and the relative difference of the primal and the dual value."""
    gradients = {variable: np.zeros(variable.size) for variable in problem.variables()}
    scale, values = 0.0, list[float]()
    for weight, expression in _terms(problem):
        values.append(float(weight @ _column(expression.value)))
        for variable, derivative in expression.grad.items():
            part = derivative @ weight if getattr(derivative, "shape", ()) else derivative * weight  # a number if 1 x 1
            gradients[variable] = gradients[variable] + part
            scale = max(scale, float(np.linalg.norm(_free(variable, part))))
    value = values[0]
    at_zero = sum(values) - sum(float(g @ _column(variable.value)) for variable, g in gradients.items())
    residual = max(float(np.linalg.norm(_free(variable, g))) for variable, g in gradients.items())
    return residual / max(scale, TINY), abs(value - at_zero) / (1.0 + abs(value))


def _terms(problem: cp.Problem) -> Iterator[tuple[Vector, Any]]:
    """Iterate over the terms of the Lagrangian of the minimisation, as weights and affine expressions."""
    sign = 1.0 if isinstance(problem.objective, cp.Minimize) else -1.0
    yield np.array([sign]), problem.objective.args[0]
    for constraint in problem.constraints:
        multiplier = _column(constraint.dual_value)
        if isinstance(constraint, cp.PSD):
            yield -multiplier, constraint.args[0]
        else:
            yield multiplier, constraint.args[0] - constraint.args[1]


def _column(value: Any) -> Vector:
    return np.asarray(value, dtype=float).ravel(order="F")


def _free(variable: cp.Variable, gradient: Vector) -> Vector:
    """Return the part of a gradient along which the variable may move: the symmetric one of a symmetric matrix."""
    if not variable.is_symmetric() or variable.ndim < 2:
        return gradient
    square = gradient.reshape(variable.shape, order="F")
    return ((square + square.T) / 2).ravel()
