"""A stabilising observer gain without a Riccati equation: a linear equation moves only the modes that need it."""

from typing import Any, cast

import numpy as np

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability, spectral_scale

__all__ = ["stabilising_gain"]

SLOW_RTOL = 1e-6
"""Modes are moved unless they are stable by more than this, relative to the size of F."""

SHIFT = 0.3
"""Distance inside the boundary to which modes are moved, relative to the size of F or, if larger, C (continuous)."""

RADIUS = 0.7
"""Radius within which modes are moved (discrete)."""


def stabilising_gain(F: Matrix, C: Matrix, time: Time) -> Matrix:
    """Return a gain K (n, l) that makes F - K C asymptotically stable.

    With V a basis of the invariant subspace of the modes to move, F V = V T, and G = C V, Bass's equation is linear:
    (T + b I)' Y + Y (T + b I) = 2 G'G, K = V Y^-1 G' gives (T - Y^-1 G'G)' Y + Y (T - Y^-1 G'G) = -2 b Y, so the moved
    modes have real part -b and the others stay. In discrete time, with T scaled by 1/r, Y = T^-T (Y + G'G) T^-1 and
    K = V r T Y^-1 G' (G Y^-1 G' + I)^-1 puts them within the radius r.

    Args:
        F: state matrix (n, n).
        C: output matrix (l, n), (F, C) detectable.
        time: "continuous" or "discrete".

    Returns:
        The gain, not a number when a mode to move is not seen.

    Source: R. W. Bass; stated for the regulator by E. S. Armstrong, An extension of Bass' algorithm for stabilizing
        linear continuous constant systems, IEEE Trans. Automat. Control 20 (1975) 153-154.
    """
    basis, rows = _unstable_part(F, time)
    if basis.shape[1] == 0:
        return np.zeros((len(F), len(C)))
    rate = max(spectral_scale(F, time), float(np.linalg.norm(C, 2)))
    try:
        return basis @ _moving_gain(rows @ F @ basis, C @ basis, rate, time)
    except np.linalg.LinAlgError:
        return np.full((len(F), len(C)), np.nan)


def _moving_gain(T: Matrix, G: Matrix, rate: float, time: Time) -> Matrix:
    """Return the gain that moves all modes of T, seen through G."""
    if time == "continuous":
        Y = solve_lyapunov(-(T + SHIFT * rate * np.eye(len(T))).T, 2 * G.T @ G, time)
        return np.linalg.solve(Y, G.T)
    S = np.linalg.inv(T / RADIUS)
    Y = solve_lyapunov(S.T, S.T @ G.T @ G @ S, time)
    YG = np.linalg.solve(Y, G.T)
    return T @ YG @ np.linalg.inv(G @ YG + np.eye(len(G)))


def _unstable_part(F: Matrix, time: Time) -> tuple[Matrix, Matrix]:
    """Return V (n, k) and U (k, n) with F V = V T, U F = T U, U V = I for the modes that are not safely stable."""
    from scipy.linalg import schur

    scale = spectral_scale(F, time)

    def moved(mode: complex) -> bool:
        return bool(distance_to_stability(mode, time) >= -SLOW_RTOL * scale)

    right, left = (_leading(cast(tuple[Any, Any, int], schur(X, output="complex", sort=moved))) for X in (F, F.T))
    return (right, np.linalg.solve(left.T @ right, left.T)) if right.shape[1] else (right, left.T)


def _leading(ordered: tuple[Any, Any, int]) -> Matrix:
    _, Z, k = ordered
    return np.linalg.svd(np.hstack([Z[:, :k].real, Z[:, :k].imag]), full_matrices=False)[0][:, :k]
