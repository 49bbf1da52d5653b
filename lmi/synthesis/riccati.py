"""The H-infinity observer by its Riccati equation: a second way to the smallest norm, and a gain for each larger one.

    continuous: A P + P A' + W - (P C' + N) V^-1 (P C' + N)' + g^-2 P M P = 0,  L = (P C' + N) V^-1
    discrete:   P = A U A' + Q - (A U C' + S)(C U C' + R)^-1 (A U C' + S)',  U = (P^-1 - g^-2 M)^-1,
                L = (A U C' + S)(C U C' + R)^-1

Some gain has an H-infinity norm below g exactly when there is a P >= 0 whose loop A - L C + g^-2 P M is stable, in
discrete time likewise and with M^(1/2) P M^(1/2) < g^2 I; L is then such a gain, the central one. That is for plants
without modes on the boundary that the noise leaves unexcited; these have no such P.

Source: K. Nagpal and P. Khargonekar, Filtering and smoothing in an H-infinity setting, IEEE Trans. Automatic Control
36(2), 1991, theorem 2 (continuous); B. Hassibi, A. Sayed and T. Kailath, Indefinite-Quadratic Estimation and Control,
SIAM 1999, theorem 4.2.2 (discrete, a priori).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import distance_to_stability
from derive.numeric.plant import Plant
from lmi.programs.observer import factor
from lmi.synthesis.achieved import norm_of

__all__ = ["central_gain", "smallest_level"]

Matrix = NDArray[np.floating[Any]]

NEGATIVE_RTOL = 1e-9
"""Eigenvalues of P below minus this, relative to the largest, are not taken for rounding errors of zero."""

HALVINGS = 60
LEVEL_RTOL = 1e-10
"""Relative width at which the bisection stops."""


def central_gain(plant: Plant, gamma: float) -> Matrix | None:
    """Return the central gain L (n, l) for a level, or None when the equation has no suitable solution.

    Args:
        plant: V > 0, (A, C) detectable, no unexcited mode on the boundary.
        gamma: the level g that the norm stays below.
    """
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    if not gamma > 0:
        return None
    E = factor(plant.M)
    outputs = np.vstack([plant.C, E.T])
    cross = np.hstack([plant.N, np.zeros(E.shape)])
    level = np.zeros((len(outputs), len(outputs)))
    level[: plant.l, : plant.l], level[plant.l :, plant.l :] = plant.V, -(gamma**2) * np.eye(E.shape[1])
    solve = solve_continuous_are if plant.is_continuous else solve_discrete_are
    try:
        with np.errstate(all="ignore"):
            P = np.asarray(solve(plant.A.T, outputs.T, plant.W, level, s=cross))
            return _gain(plant, P, outputs, cross, level) if np.isfinite(P).all() else None
    except (np.linalg.LinAlgError, ValueError):
        return None


def _gain(plant: Plant, P: Matrix, outputs: Matrix, cross: Matrix, level: Matrix) -> Matrix | None:
    """Return the central gain for P if P is a solution of the kind that is asked for.

    SciPy returns matrices also where the equation has no such solution; then the gain's norm is not below the level.
    """
    sizes = np.linalg.eigvalsh((P + P.T) / 2)
    if sizes[0] < -NEGATIVE_RTOL * max(sizes[-1], 0.0):
        return None
    if plant.is_continuous:
        full = np.linalg.solve(level, (P @ outputs.T + cross).T).T
        gain = full[:, : plant.l]
    else:
        innovation = outputs @ P @ outputs.T + level
        if len(outputs) > plant.l and np.linalg.eigvalsh(innovation[plant.l :, plant.l :])[-1] >= 0:
            return None
        full = np.linalg.solve(innovation, (plant.A @ P @ outputs.T + cross).T).T
        U = _shrunk(P, outputs[plant.l :], innovation[plant.l :, plant.l :])
        gain = np.linalg.solve(plant.C @ U @ plant.C.T + plant.V, (plant.A @ U @ plant.C.T + plant.N).T).T
    loop = plant.A - full @ outputs
    stable = np.all(distance_to_stability(np.linalg.eigvals(loop), plant.time) < 0)
    return gain if stable and norm_of(plant, gain).lower < np.sqrt(-level[-1, -1]) else None


def _shrunk(P: Matrix, E: Matrix, inner: Matrix) -> Matrix:
    """Return (P^-1 - g^-2 E'E)^-1 = P - P E' (E P E' - g^2 I)^-1 E P."""
    U = P - P @ E.T @ np.linalg.solve(inner, E @ P)
    return (U + U.T) / 2


def smallest_level(plant: Plant, reached: float) -> float | None:
    """Return the smallest level that has a central gain, by bisection; None when the level `reached` has none.

    Args:
        plant: as for `central_gain`.
        reached: a level above the smallest, such as the norm of some gain.
    """
    if central_gain(plant, reached) is None:
        return None
    upper, lower = reached, reached / 2
    for _ in range(HALVINGS):
        if central_gain(plant, lower) is None:
            break
        upper, lower = lower, lower / 2
    for _ in range(HALVINGS):
        if upper - lower <= LEVEL_RTOL * upper:
            break
        middle = (lower + upper) / 2
        lower, upper = (lower, middle) if central_gain(plant, middle) is not None else (middle, upper)
    return upper
