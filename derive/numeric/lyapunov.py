"""The Lyapunov and Stein equations: the covariance that a given error matrix and noise lead to."""

import warnings

import numpy as np

from derive.numeric.modes import Matrix, Time

__all__ = ["error_covariance", "solve_lyapunov", "solves_lyapunov"]

LYAPUNOV_RTOL = 0.1
"""Relative residual above which a solution is none."""

DOUBLINGS = 64
"""Squarings of F after which |F|^(2^k) has vanished for every spectral radius below 1 - 1e-16."""


def solve_lyapunov(F: Matrix, Q: Matrix, time: Time) -> Matrix:
    """Solve F X + X F' + Q = 0 (continuous) or F X F' - X + Q = 0 (discrete) for X.

    Continuous time takes SciPy's Bartels-Stewart method, discrete time Smith's doubling X <- X + F X F', F <- F F,
    which adds only terms of the sign of Q.

    Args:
        F: asymptotically stable matrix (n, n).
        Q: symmetric matrix (n, n).
        time: "continuous" or "discrete".

    Returns:
        The symmetric X (n, n), not finite when F is not stable enough for its numbers.

    Source: R. A. Smith, Matrix equation XA + BX = C, SIAM J. Appl. Math. 16 (1968) 198-201.
    """
    if len(F) == 0:
        return np.zeros((0, 0))
    if time == "continuous":
        from scipy.linalg import solve_continuous_lyapunov

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # near the boundary: callers judge the residual
            X = solve_continuous_lyapunov(F, -Q)
        return (X + X.T) / 2
    with np.errstate(over="ignore", invalid="ignore"):
        return _doubled(F, np.array(Q, dtype=float))


def _doubled(F: Matrix, X: Matrix) -> Matrix:
    """Return the sum of F^k Q F'^k for X = Q."""
    for _ in range(DOUBLINGS):
        increment = F @ X @ F.T
        X = X + increment
        if not np.abs(increment).max() > np.finfo(float).eps / 4 * np.abs(X).max():
            break
        F = F @ F
    return (X + X.T) / 2


def solves_lyapunov(F: Matrix, X: Matrix, Q: Matrix, time: Time) -> bool:
    """Tell whether F X + X F' + Q = 0, discrete F X F' - X + Q = 0, holds within a tenth of Q.

    LAPACK moves pairs of eigenvalues whose sum it takes for zero, relative to F; the solution is then another.
    """
    FX = F @ X
    defect = FX + FX.T + Q if time == "continuous" else FX @ F.T - X + Q
    return bool(np.isfinite(defect).all() and np.linalg.norm(defect) <= LYAPUNOV_RTOL * np.linalg.norm(Q))


def error_covariance(A: Matrix, C: Matrix, W: Matrix, V: Matrix, N: Matrix, gain: Matrix, time: Time) -> Matrix:
    """Return the steady covariance P of the error under a gain L that makes A - L C stable.

    0 = (A - L C) P + P (A - L C)' + W - L N' - N L' + L V L', in discrete time P = (A - L C) P (A - L C)' + the same.
    """
    cross = gain @ N.T
    noise = W - cross - cross.T + gain @ V @ gain.T
    return solve_lyapunov(A - gain @ C, noise, time)
