"""What every convex program hands to the solver: the problem, its data as parameters, and where its answer will be."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant

__all__ = ["Program", "SymmetricMap", "packed", "shape_of", "unpacked"]

Matrix = NDArray[np.floating[Any]]


def _not_loadable(plant: Plant) -> bool:
    return False


@dataclass(frozen=True, eq=False)
class Program:
    """A convex program whose answer is an error covariance and a gain.

    Attributes:
        name: what it computes.
        problem: the CVXPY problem; every cone is a constraint of it, so that its residuals can be recomputed.
        answer: returns P (n, n) and L (n, l) from the numbers that the solver left in the variables.
        load: puts the numbers of another plant into the problem's parameters, so that it is solved again without
            being compiled again, and returns True; or changes nothing and returns False when that plant's shape or the
            rank of its noise is another one.
        attainable: relative error of P that a solver in double precision usually stays below, in good coordinates.
    """

    name: str
    problem: cp.Problem
    answer: Callable[[], tuple[Matrix, Matrix]]
    load: Callable[[Plant], bool] = _not_loadable
    attainable: float = 1e-8


class SymmetricMap:
    """A linear map from symmetric matrices (n, n) to symmetric matrices (m, m), as a parameter of a problem.

    The map of a plant, P -> A P A' for example, is no product of one parameter with a variable, so that CVXPY would
    compile it again for every A. Its coefficients in packed coordinates are. Where they are zero for every plant of
    the shape, the solver's matrix has no entry.
    """

    def __init__(self, plant: Plant, apply: Callable[[Plant, Matrix], Matrix], name: str):
        self.apply = apply
        self.basis = [unpacked(row, plant.n) for row in np.eye(plant.n * (plant.n + 1) // 2)]
        example = self._coefficients(_full(plant))
        self.size = int(np.sqrt(len(example)))
        self.pattern = np.nonzero(example)
        self.coefficients = cp.Parameter(example.shape, name=name, sparsity=self.pattern)

    def load(self, plant: Plant) -> None:
        """Take the coefficients of a plant."""
        from scipy.sparse import coo_array

        values = self._coefficients(plant)
        self.coefficients.value_sparse = coo_array((values[self.pattern], self.pattern), shape=values.shape)

    def __call__(self, x: cp.Expression) -> cp.Expression:
        """Return the image (m, m) of a packed matrix."""
        return cp.reshape(self.coefficients @ x, (self.size, self.size), order="C")

    def adjoint(self, Z: cp.Expression) -> cp.Expression:
        """Return y with y'x = tr(Z F(x)) for every packed x: off the diagonal twice the entries of the adjoint."""
        return self.coefficients.T @ cp.vec(Z, order="C")

    def _coefficients(self, plant: Plant) -> Matrix:
        return np.array([self.apply(plant, P).ravel() for P in self.basis]).T


def _full(plant: Plant) -> Plant:
    """Return a plant of the shape without zeros and with noise of full rank, by which the pattern is found."""
    rng = np.random.default_rng(0)
    n, size = plant.n, plant.n + plant.l
    root = 1.0 + rng.random((size, size))
    noise = root @ root.T
    return replace(
        plant,
        A=1.0 + rng.random((n, n)),
        C=1.0 + rng.random((plant.l, n)),
        W=noise[:n, :n],
        V=noise[n:, n:],
        N=noise[:n, n:],
    )


def packed(P: Matrix) -> Matrix:
    """Return the upper triangle of P (n, n), row by row (n (n + 1) / 2,)."""
    return P[np.triu_indices(len(P))]


def unpacked(x: Matrix, n: int) -> Matrix:
    """Return the symmetric P (n, n) whose upper triangle is x."""
    P = np.zeros((n, n))
    rows, columns = np.triu_indices(n)
    P[rows, columns] = P[columns, rows] = x
    return P


def shape_of(plant: Plant) -> tuple[str, int, int]:
    """Return what two plants must have in common to share a compiled problem."""
    return plant.time, plant.n, plant.l
