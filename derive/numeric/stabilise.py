"""A stabilising observer gain without a Riccati equation: a linear equation moves only the modes that need it."""

from itertools import product

import numpy as np

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability, spectral_scale
from derive.numeric.subspaces import invariant_subspace

__all__ = ["stabilising_gain"]

MARGINS = (1e-6, 1e-10, 1e-14)
"""Modes are moved unless they are stable by more than this, relative to the size of F: a wide margin moves double modes
on the boundary whole, a narrow one spares slow modes that are not seen."""

SHIFTS = (0.3, 0.1, 0.03, 0.01, 0.001)
"""Distances inside the boundary to which modes are moved, relative to the size of F or, if larger, C, in discrete time
relative to the circle; the next one is tried when numbers do not allow the last."""


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
        The gain, not a number when none was found.

    Source: R. W. Bass; stated for the regulator by E. S. Armstrong, An extension of Bass' algorithm for stabilizing
        linear continuous constant systems, IEEE Trans. Automat. Control 20 (1975) 153-154.
    """
    with np.errstate(all="ignore"):
        for shift, rtol in product(SHIFTS, MARGINS):
            gain = _gain(F, C, time, rtol, shift)
            if np.isfinite(gain).all() and np.all(distance_to_stability(np.linalg.eigvals(F - gain @ C), time) < 0):
                return gain
    return np.full((len(F), len(C)), np.nan)


def _gain(F: Matrix, C: Matrix, time: Time, rtol: float, shift: float) -> Matrix:
    rate = max(spectral_scale(F, time), float(np.linalg.norm(C, 2)))
    try:
        basis, rows = _part_to_move(F, time, rtol)
        if basis.shape[1] == 0:
            return np.zeros((len(F), len(C)))
        return basis @ _moving_gain(rows @ F @ basis, C @ basis, shift * rate if time == "continuous" else shift, time)
    except np.linalg.LinAlgError:
        return np.full((len(F), len(C)), np.nan)


def _moving_gain(T: Matrix, G: Matrix, shift: float, time: Time) -> Matrix:
    """Return the gain that moves all modes of T, seen through G, by so much inside the boundary."""
    if time == "continuous":
        Y = solve_lyapunov(-(T + shift * np.eye(len(T))).T, 2 * G.T @ G, time)
        return np.linalg.solve(Y, G.T)
    S = np.linalg.inv(T / (1 - shift))
    Y = solve_lyapunov(S.T, S.T @ G.T @ G @ S, time)
    YG = np.linalg.solve(Y, G.T)
    return T @ YG @ np.linalg.inv(G @ YG + np.eye(len(G)))


def _part_to_move(F: Matrix, time: Time, rtol: float) -> tuple[Matrix, Matrix]:
    """Return V (n, k) and U (k, n) with F V = V T, U F = T U, U V = I for the modes that are not safely stable."""
    margin = rtol * spectral_scale(F, time) if time == "continuous" else min(rtol * spectral_scale(F, time), 0.1)

    def moved(mode: complex) -> bool:
        return bool(distance_to_stability(mode, time) >= -margin)

    right, left = invariant_subspace(F, moved), invariant_subspace(F.T, moved)
    return (right, np.linalg.solve(left.T @ right, left.T)) if right.shape[1] else (right, left.T)
