"""How well a covariance and a gain solve the estimation problem, recomputed from the numbers alone."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import distance_to_stability
from derive.numeric.plant import Plant

__all__ = ["gain_covariance", "newton_error", "optimal_gain", "riccati_residual", "symmetric_part"]

Matrix = NDArray[np.floating[Any]]

SLOWEST = 0.95
"""Ratio of successive Newton steps from which on they are no longer taken to converge."""

NEGLIGIBLE = 1e-12
"""Negative variance, relative to the largest, that is put down to rounding."""

ROUNDING = 1e-10
"""Relative size of a Newton step that may be rounding, so that the ratio to the next means nothing."""


def symmetric_part(P: Any) -> Matrix:
    """Return (P + P') / 2."""
    P = np.atleast_2d(np.asarray(P, dtype=float))
    return (P + P.T) / 2


def optimal_gain(plant: Plant, P: Matrix) -> Matrix:
    """Return L = (P C' + N) V^-1, in discrete time L = (A P C' + N) (C P C' + V)^-1, shape (n, l)."""
    if plant.is_continuous:
        return np.linalg.solve(plant.V, (P @ plant.C.T + plant.N).T).T
    innovation = plant.C @ P @ plant.C.T + plant.V
    return np.linalg.solve(innovation, (plant.A @ P @ plant.C.T + plant.N).T).T


def gain_covariance(plant: Plant, L: Matrix) -> Matrix | None:
    """Return the steady error covariance that a gain leaves, or None when A - L C is not stable.

    continuous:  (A - L C) P + P (A - L C)' + W - L N' - N L' + L V L' = 0
    discrete:    P = (A - L C) P (A - L C)' + W - L N' - N L' + L V L'

    Args:
        plant: A (n, n), C (l, n), W, V, N.
        L: gain (n, l).
    """
    modes = np.linalg.eigvals(plant.A - L @ plant.C)
    if np.max(distance_to_stability(modes, plant.time)) >= 0:
        return None
    return error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, L, plant.time)


def newton_error(plant: Plant, P: Matrix) -> Matrix | None:
    """Estimate the error of P as a solution of the Riccati equation from two Newton steps.

    A Newton step takes P to the covariance N(P) of the gain that is optimal for P. Steps that shrink by the factor r
    sum to (N(P) - P) / (1 - r). Near a stabilising solution r is almost 0; at a mode on the boundary 1/2 or more.

    Returns:
        The matrix (n, n) that is missing to the solution, or None when P is no solution: a gain does not stabilise, or
        the steps hardly shrink.

    Source: D. Kleinman, On an iterative technique for Riccati equation computations, IEEE Trans. Automatic Control
    13(1), 1968; G. Hewer, An iterative technique for the computation of the steady state gains for the discrete optimal
    regulator, ibid. 16(4), 1971.
    """
    first = gain_covariance(plant, optimal_gain(plant, P))
    if first is None or np.any(np.diag(first) < -NEGLIGIBLE * (np.linalg.norm(P) + np.linalg.norm(first))):
        return None  # LAPACK moves eigenvalues that it takes for zero
    second = gain_covariance(plant, optimal_gain(plant, first))
    if second is None:
        return None
    step = float(np.linalg.norm(first - P))
    if step <= ROUNDING * np.linalg.norm(P):
        return first - P
    ratio = float(np.linalg.norm(second - first)) / step
    return (first - P) / (1 - ratio) if ratio < SLOWEST else None


def riccati_residual(plant: Plant, P: Matrix) -> float:
    """Return |A P + P A' + W - L V L'|, discrete |A P A' + W - L (C P C' + V) L' - P|, relative to its largest term."""
    A, L = plant.A, optimal_gain(plant, P)
    if plant.is_continuous:
        terms = [A @ P, P @ A.T, plant.W, -L @ plant.V @ L.T]
    else:
        terms = [A @ P @ A.T, plant.W, -L @ (plant.C @ P @ plant.C.T + plant.V) @ L.T, -P]
    scale = max(np.linalg.norm(term) for term in terms)
    return float(np.linalg.norm(sum(terms)) / scale) if scale > 0 else 0.0
