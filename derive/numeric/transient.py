"""The error covariance over time, from its start towards the steady solution."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import Matrix, spectral_scale
from derive.numeric.plant import Plant

__all__ = ["covariance_over_time", "start_covariance", "time_grid"]

SETTLED = 5.0
"""Time constants of the slowest error mode that a time grid covers: exp(-5) is under one percent."""


def covariance_over_time(plant: Plant, start: Matrix, times: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """Return the optimal error covariance at equidistant times.

    Continuous: P' = A P + P A' + W - (P C' + N) V^-1 (P C' + N)', stepped exactly by P -> (Y + Z P)(U + X P)^-1 with
    [[U, X], [Y, Z]] the exponential of [[-F', C'V^-1 C], [Q, F]], F = A - N V^-1 C, Q = W - N V^-1 N'.
    Discrete: P -> A P A' + Q - (A P C' + S)(C P C' + R)^-1 (A P C' + S)'.

    Args:
        plant: the plant.
        start: P at the first time (n, n) [state]^2, positive semidefinite.
        times: (m,) [s], in discrete time the steps 0, 1, ..., m - 1.

    Returns:
        The covariances (m, n, n).

    Source: W. T. Reid, Riccati differential equations, 1972, for the linear fractional solution.
    """
    step = _step(plant, float(times[1] - times[0]) if len(times) > 1 else 0.0)
    found = [np.array(start, dtype=float)]
    for _ in times[1:]:
        P = step(found[-1])
        found.append((P + P.T) / 2)
    return np.array(found)


def _step(plant: Plant, duration: float) -> Any:
    A, C, W, V, N = plant.A, plant.C, plant.W, plant.V, plant.N
    if not plant.is_continuous:

        def advance(P: Matrix) -> Matrix:
            cross = A @ P @ C.T + N
            return A @ P @ A.T + W - cross @ np.linalg.solve(C @ P @ C.T + V, cross.T)

        return advance
    from scipy.linalg import expm

    n = plant.n
    F, Q = A - N @ np.linalg.solve(V, C), W - N @ np.linalg.solve(V, N.T)
    E = expm(duration * np.block([[-F.T, C.T @ np.linalg.solve(V, C)], [Q, F]]))
    return lambda P: np.linalg.solve((E[:n, :n] + E[:n, n:] @ P).T, (E[n:, :n] + E[n:, n:] @ P).T).T


def start_covariance(plant: Plant) -> Matrix:
    """Return where the error covariance starts: the plant's P0, or what is known without a measurement.

    Without P0 it is the steady covariance of the state, if the plant is stable, else the identity.

    Returns:
        P at the first time (n, n) [state]^2.
    """
    from derive.numeric.lyapunov import solve_lyapunov

    if plant.P0 is not None:
        return plant.P0
    modes = np.linalg.eigvals(plant.A)
    stable = np.all(modes.real < 0) if plant.is_continuous else np.all(np.abs(modes) < 1)
    return solve_lyapunov(plant.A, plant.W, plant.time) if stable else np.eye(plant.n)


def time_grid(plant: Plant, error_modes: NDArray[Any], points: int = 201) -> NDArray[np.floating[Any]]:
    """Return equidistant times over which the slowest error mode settles.

    Args:
        plant: the plant.
        error_modes: eigenvalues of A - L C (n,).
        points: how many times.

    Returns:
        Times (points,) [s], in discrete time the steps 0, 1, ...
    """
    if not plant.is_continuous:
        radius = float(np.abs(error_modes).max())
        steps = SETTLED / -np.log(radius) if 0 < radius < 1 else plant.n
        return np.arange(1 + int(np.clip(np.ceil(steps), plant.n, points - 1)), dtype=float)
    slowest = float(-np.max(np.real(error_modes)))
    rate = slowest if slowest > 0 else spectral_scale(plant.A, plant.time) or 1.0
    return np.linspace(0.0, SETTLED / rate, points)
