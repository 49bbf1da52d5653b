"""Invariant subspaces: of chosen modes, of what an output does not see and, by duality, a noise does not excite."""

from collections.abc import Callable, Iterable
from typing import Any, cast

import numpy as np

__all__ = ["RANK_RTOL", "invariant_subspace", "nearest", "unseen_subspace"]

RANK_RTOL = 64 * np.finfo(float).eps
"""Singular value that counts as zero, relative and times n."""


def invariant_subspace(F: Any, selected: Callable[[complex], bool]) -> Any:
    """Return an orthonormal real basis Z (n, k), F Z = Z T, for the selected modes and their conjugates."""
    from scipy.linalg import schur

    _, Z, k = cast(tuple[Any, Any, int], schur(F, output="complex", sort=selected))
    basis = np.linalg.svd(np.hstack([Z[:, :k].real, Z[:, :k].imag]), full_matrices=False)[0]
    return basis[:, :k]


def unseen_subspace(F: Any, C: Any, output_tol: float, rate_tol: float) -> Any:
    """Return an orthonormal basis (n, k) of the largest F-invariant subspace in the kernel of C.

    The kernel is intersected with what F maps into it until it stays, which decides ranks one step at a time and needs
    no eigenvalue, so that multiple modes do no harm.

    Args:
        F: matrix (n, n).
        C: matrix (l, n).
        output_tol: singular value of C that counts as zero.
        rate_tol: singular value of the part of F that leaves the kernel that counts as zero.
    """
    K = _kernel(C, output_tol)
    while K.shape[1]:
        inner = _kernel(F @ K - K @ (K.T @ F @ K), rate_tol)
        if inner.shape[1] == K.shape[1]:
            return K
        K = K @ inner
    return K


def nearest(mode: complex, modes: Iterable[complex]) -> float:
    """Return the distance to the nearest of several modes, infinite without any."""
    return min((abs(mode - other) for other in modes), default=float("inf"))


def _kernel(X: Any, tol: float) -> Any:
    _, sizes, rows = np.linalg.svd(X)
    return rows[np.count_nonzero(sizes > tol) :].T
