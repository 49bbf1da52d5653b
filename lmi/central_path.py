"""Where the interior-point method starts: a rough covariance, and a point on the central path near it.

Both come from Lyapunov equations alone. From a stabilising gain (Bass), Kleinman's iteration L -> covariance of L ->
its optimal gain falls towards the optimal covariance, about halving its excess at each step until it is near; it is
stopped there, and gives coordinates. The central path F(P) = mu Z^-1 is known in closed form: with a gain L and
Z = [I, -L]' X [I, -L] + mu blkdiag(0, G^-1), it says

    continuous: (A - L C)'X + X (A - L C) + I = 0,  G = V,             P solves the Riccati equation of W - mu X^-1
    discrete:   (A - L C)'X (A - L C) - X + mu C'G^-1 C + I = 0,  G = V + C P C',  likewise,

where the same iteration, with less noise, gives P.

Source: D. Kleinman, On an iterative technique for Riccati equation computations, IEEE Trans. Automatic Control 13(1),
1968; the closed form of the path follows from S Z = mu I and the block form of Z.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.normal import normal_form
from derive.numeric.plant import Plant
from derive.numeric.stabilise import stabilising_gain
from lmi.residual import gain_covariance, optimal_gain, symmetric_part

__all__ = ["central_point", "rough_covariance"]

Matrix = NDArray[np.floating[Any]]

STEPS = 60
"""Steps of Kleinman's iteration, each of which about halves the excess of a bad gain's covariance."""

ROUGH = 0.1
"""Relative fall of the trace in one step below which a covariance is rough no more than coordinates can bear."""

SETTLED = 1e-6
"""Relative change of P below which a point counts as one of the path."""

START = 0.1
"""mu (n + l) / tr(M P) at the start, n in the place of the trace when P = 0."""

SMALLEST = 1e-3
"""Share of that mu below which a point would be the end of the path, found by Kleinman's iteration alone."""

SHORTER = 0.3
"""Factor by which mu falls when the path does not reach it."""

ROUNDS = 40
CENTRED = 0.05
"""Relative change of X at which the start counts as central."""


def rough_covariance(plant: Plant) -> Matrix | None:
    """Return the covariance (n, n) of a stabilising gain that is not far from the best, or None if none was found.

    Args:
        plant: V > 0, (A, C) detectable.
    """
    form = normal_form(plant)
    F, C, W = form.uncorrelated()
    gain = stabilising_gain(F, C, plant.time)
    if not np.isfinite(gain).all():
        return None
    P = _kleinman(replace(plant, A=F, C=C, W=W, V=np.eye(plant.l), N=np.zeros_like(gain)), gain, ROUGH)
    return None if P is None else form.unscaled(P).astype(float)


def central_point(plant: Plant, P: Matrix) -> tuple[Matrix, Matrix]:
    """Return P (n, n) and Z (n + l, n + l) near the central path, both strictly feasible up to rounding.

    Args:
        plant: with weight M = I, in coordinates in which P is near the identity.
        P: a rough covariance whose gain stabilises.

    Raises:
        LinAlgError: no such point was found, so that the path is short or has no inside.
    """
    mu = START * (float(np.trace(P)) or plant.n) / (plant.n + plant.l)
    smallest = SMALLEST * mu
    gain, X = optimal_gain(plant, P), _adjoint_solution(plant, P, 0.0)
    found: Matrix | None = None
    for _ in range(ROUNDS):
        candidate = _kleinman(replace(plant, W=symmetric_part(plant.W - mu * np.linalg.inv(X))), gain, SETTLED)
        if candidate is None:
            if found is not None or SHORTER * mu < smallest:
                break
            mu *= SHORTER
            continue
        found, before = candidate, X
        gain, X = optimal_gain(plant, found), _adjoint_solution(plant, found, mu)
        if np.linalg.norm(X - before) < CENTRED * np.linalg.norm(X):
            break
    if found is None:
        raise np.linalg.LinAlgError(
            "no point inside the cone was found, as with a boundary mode that is hardly excited"
        )
    gap = np.vstack([np.eye(plant.n), -gain.T])
    Z = gap @ X @ gap.T
    Z[plant.n :, plant.n :] += mu * np.linalg.inv(_innovation(plant, found))
    return found, symmetric_part(Z)


def _kleinman(plant: Plant, gain: Matrix, rtol: float) -> Matrix | None:
    """Return the covariance that the iteration reaches from a stabilising gain, or None when it loses stability."""
    P = gain_covariance(plant, gain)
    for _ in range(STEPS):
        if P is None or not np.isfinite(P).all():
            return None
        better = gain_covariance(plant, optimal_gain(plant, P))
        if better is None or np.linalg.norm(better - P) <= rtol * np.linalg.norm(better):
            return better
        P = better
    return None


def _innovation(plant: Plant, P: Matrix) -> Matrix:
    """Return V, in discrete time C P C' + V."""
    return plant.V if plant.is_continuous else plant.V + plant.C @ P @ plant.C.T


def _adjoint_solution(plant: Plant, P: Matrix, mu: float) -> Matrix:
    """Return X of the adjoint Lyapunov equation of A - L C, L the gain for P."""
    forcing = np.eye(plant.n)
    if not plant.is_continuous:
        forcing = forcing + mu * plant.C.T @ np.linalg.solve(_innovation(plant, P), plant.C)
    loop = plant.A - optimal_gain(plant, P) @ plant.C
    return symmetric_part(solve_lyapunov(loop.T, forcing, plant.time))
