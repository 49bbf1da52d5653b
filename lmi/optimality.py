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
        margin: smallest eigenvalue of a G_k(x), relative to its norm or to its terms if they cancel; negative when it
            fails.
        violation: largest entry of h(x), relative to the largest entry of a variable (at least 1).
        dual_margin: smallest eigenvalue of a multiplier Z_k, relative to the largest of them.
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
    objective, *constraints = terms = list(_terms(problem))
    cones = [term for term in constraints if term.is_cone]
    equations = [constraint for constraint in problem.constraints if not isinstance(constraint, cp.PSD)]
    sizes = [float(np.abs(_column(variable.value)).max()) for variable in problem.variables()]
    largest = max((float(np.abs(term.weight).max()) for term in cones), default=0.0)
    stationarity, at_zero = _dual(problem, terms)
    value = float(objective.weight @ objective.value)
    return Optimality(
        margin=min((_least(term.value, term.size) for term in cones), default=np.inf),
        violation=float(max((np.max(x.violation()) for x in equations), default=0.0)) / max(1.0, *sizes),
        dual_margin=min((_least(-term.weight, largest) for term in cones), default=np.inf),
        stationarity=stationarity,
        gap=abs(value - at_zero) / (1.0 + abs(value)),
    )


@dataclass(frozen=True, eq=False)
class _Term:
    """A term of the Lagrangian: a weight times an affine expression, as columns, and the latter's derivatives.

    Attributes:
        weight: minus the multiplier of a matrix inequality, that of an equation, +-1 for the objective.
        value: of the expression.
        parts: derivative by each variable, and the variable.
        is_cone: whether it is a matrix inequality.
    """

    weight: Vector
    value: Vector
    parts: list[tuple[cp.Variable, Any]]
    is_cone: bool = False

    @property
    def size(self) -> float:
        """The largest entry that a variable contributes to the value."""
        sizes = [np.abs(_applied(part, _column(x.value), transposed=True)).max() for x, part in self.parts]
        return float(max(sizes, default=0.0))


def _terms(problem: cp.Problem) -> Iterator[_Term]:
    """Iterate over the terms of the Lagrangian of the minimisation, the objective first."""

    def term(weight: Vector, expression: Any, is_cone: bool = False) -> _Term:
        return _Term(weight, _column(expression.value), list(expression.grad.items()), is_cone)

    yield term(np.array([1.0 if isinstance(problem.objective, cp.Minimize) else -1.0]), problem.objective.args[0])
    for constraint in problem.constraints:
        multiplier = _column(constraint.dual_value)
        if isinstance(constraint, cp.PSD):
            yield term(-multiplier, constraint.args[0], True)
        else:
            yield term(multiplier, constraint.args[0] - constraint.args[1])


def _dual(problem: cp.Problem, terms: list[_Term]) -> tuple[float, float]:
    """Return |dL/dx| relative to its terms, and L(0), the dual value where dL/dx = 0."""
    gradients = {variable: np.zeros(variable.size) for variable in problem.variables()}
    scale = TINY
    for term in terms:
        for variable, derivative in term.parts:
            part = _applied(derivative, term.weight)
            gradients[variable] = gradients[variable] + part
            scale = max(scale, float(np.linalg.norm(_free(variable, part))))
    lagrangian = sum(float(term.weight @ term.value) for term in terms)
    at_zero = lagrangian - sum(float(gradient @ _column(x.value)) for x, gradient in gradients.items())
    return max(float(np.linalg.norm(_free(x, gradient))) for x, gradient in gradients.items()) / scale, at_zero


def _least(column: Vector, size: float) -> float:
    """Return the smallest eigenvalue, relative to the largest in size, or to a size if that is larger."""
    n = round(len(column) ** 0.5)
    matrix = column.reshape(n, n)
    eigenvalues = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    return float(eigenvalues[0] / max(np.abs(eigenvalues).max(), size, TINY))


def _applied(derivative: Any, vector: Vector, *, transposed: bool = False) -> Vector:
    """Return the product of a derivative, a number when it is 1 x 1, with a vector."""
    if not getattr(derivative, "shape", ()):
        return derivative * vector
    return (derivative.T if transposed else derivative) @ vector


def _column(value: Any) -> Vector:
    return np.asarray(value, dtype=float).ravel(order="F")


def _free(variable: cp.Variable, gradient: Vector) -> Vector:
    """Return the part of a gradient along which the variable may move: the symmetric one of a symmetric matrix."""
    if not variable.is_symmetric() or variable.ndim < 2:
        return gradient
    square = gradient.reshape(variable.shape, order="F")
    return ((square + square.T) / 2).ravel()
