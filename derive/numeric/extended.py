"""Linear algebra in extended precision for small matrices: what LAPACK offers in double precision only."""

import numpy as np

from derive.numeric.modes import Matrix

__all__ = ["cholesky", "divided", "forward"]


def cholesky(V: Matrix) -> Matrix:
    """Return the lower triangular T with T T' = V > 0, in the precision of V."""
    T = np.zeros_like(V)
    for j in range(len(V)):
        T[j, j] = np.sqrt(V[j, j] - T[j, :j] @ T[j, :j])
        T[j + 1 :, j] = (V[j + 1 :, j] - T[j + 1 :, :j] @ T[j, :j]) / T[j, j]
    return T


def forward(T: Matrix, X: Matrix) -> Matrix:
    """Return T^-1 X for lower triangular T."""
    Y = np.zeros_like(X)
    for i in range(len(T)):
        Y[i] = (X[i] - T[i, :i] @ Y[:i]) / T[i, i]
    return Y


def divided(X: Matrix, V: Matrix) -> Matrix:
    """Return X V^-1 for V > 0."""
    T = cholesky(V)
    Y = forward(T, X.T)
    return forward(T[::-1, ::-1].T, Y[::-1])[::-1].T
