"""What every convex program hands to the solver: the problem, and where its answer will be."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

__all__ = ["Program"]

Matrix = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Program:
    """A convex program whose answer is an error covariance and a gain.

    Attributes:
        name: what it computes.
        problem: the CVXPY problem; every cone is a constraint of it, so that its residuals can be recomputed.
        answer: returns P (n, n) and L (n, l) from the numbers that the solver left in the variables.
    """

    name: str
    problem: cp.Problem
    answer: Callable[[], tuple[Matrix, Matrix]]
