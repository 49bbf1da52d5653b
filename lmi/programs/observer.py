"""The unknowns that every synthesis of an observer shares: X > 0 and Y = X L, in which its specifications are linear.

With (w, v) = (G d, H d), [G; H] [G; H]' = [[W, N], [N', V]], for a white noise d of intensity I, the error obeys
    e' = (A - L C) e + (G - L H) d,
and X (A - L C) = X A - Y C, X (G - L H) = X G - Y H are linear in X and Y. A specification is a list of constraints on
them; several of them in one program share X, which makes the program convex and, together, sufficient only: X exists
only if one quadratic function proves all of them.

Source: C. Scherer, P. Gahinet and M. Chilali, Multiobjective output-feedback control via LMI optimization, IEEE Trans.
Automatic Control 42(7), 1997.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cvxpy as cp
import numpy as np

from derive.numeric.plant import Plant
from lmi.programs.program import Matrix

__all__ = ["Specification", "Unknowns", "factor"]

RANK_RTOL = 1e-14
"""Eigenvalues of a correlation matrix below this, relative to the largest, are rounding errors of a zero."""


def factor(covariance: Matrix) -> Matrix:
    """Return G (n, rank) with G G' = covariance >= 0; the rank is decided whatever the units of its rows."""
    variances = np.diag(covariance)
    units = np.sqrt(np.where(variances > 0, variances, 1.0))
    sizes, directions = np.linalg.eigh(covariance / np.outer(units, units))
    kept = sizes > RANK_RTOL * max(sizes[-1], np.finfo(float).tiny)
    kept[-1] = True
    return units[:, None] * directions[:, kept] * np.sqrt(np.maximum(sizes[kept], 0.0))


@dataclass(frozen=True, eq=False)
class Unknowns:
    """X and Y = X L for a plant, and the two products that specifications are made of.

    Attributes:
        plant: the plant; a program may hold the unknowns of several plants that share X and Y.
        X: symmetric (n, n).
        Y: (n, l).
        drift: X A - Y C (n, n).
        noise: X G - Y H (n, k).
    """

    plant: Plant
    X: cp.Variable
    Y: cp.Variable
    drift: cp.Expression
    noise: cp.Expression

    @classmethod
    def of(cls, plant: Plant) -> "Unknowns":
        """Return new unknowns of a plant."""
        X = cp.Variable((plant.n, plant.n), symmetric=True, name="X")
        return cls.sharing(plant, X, cp.Variable((plant.n, plant.l), name="Y"))

    @classmethod
    def sharing(cls, plant: Plant, X: cp.Variable, Y: cp.Variable) -> "Unknowns":
        """Return the unknowns of a plant with a given X and Y."""
        root = factor(np.block([[plant.W, plant.N], [plant.N.T, plant.V]]))
        return cls(plant, X, Y, X @ plant.A - Y @ plant.C, X @ root[: plant.n] - Y @ root[plant.n :])

    def answer(self) -> tuple[Matrix, Matrix]:
        """Return X^-1 (n, n), and the gain X^-1 Y (n, l), from the numbers that the solver left."""
        inverse = np.linalg.inv(np.asarray(self.X.value))
        return (inverse + inverse.T) / 2, inverse @ np.asarray(self.Y.value)


Specification = Callable[[Unknowns], list[cp.Constraint]]
"""What is asked of an observer, as constraints on its unknowns."""
