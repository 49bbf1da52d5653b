"""Modes of a matrix that decide whether an estimator exists: unstable, on the boundary, seen or not seen."""

from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from derive.numeric.subspaces import RANK_RTOL, invariant_subspace, nearest, unseen_subspace

__all__ = ["Matrix", "Time", "balancing", "distance_to_stability", "format_mode", "spectral_scale", "undetectable_mode"]

Matrix = NDArray[np.floating[Any]]
Time = Literal["continuous", "discrete"]

MODE_RTOL = 1e-7
"""Largest error of a computed mode, relative to the size of A: that of a double one, sqrt(eps)."""


def balancing(A: Matrix) -> Matrix:
    """Return powers of two t that make rows and columns of A t_j / t_i alike in size; ones where A is not finite."""
    from scipy.linalg import lapack

    if not np.isfinite(A).all():
        return np.ones(len(A))
    return cast(Any, lapack).dgebal(A, scale=1, permute=0)[3]


def spectral_scale(A: Matrix, time: Time) -> float:
    """Return the size to which distances from the boundary are relative: |A|, in discrete time at least 1."""
    norm = float(np.linalg.norm(A, 2))
    return norm if time == "continuous" else max(norm, 1.0)


def distance_to_stability(modes: Any, time: Time) -> Any:
    """Return Re lambda (continuous) or |lambda| - 1 (discrete) of one mode or several: negative for stable ones."""
    return np.real(modes) if time == "continuous" else np.abs(modes) - 1.0


def format_mode(mode: complex) -> str:
    """Write an eigenvalue for a message: 0.3+2j, -1, 2j."""
    mode = complex(mode)
    tiny = 1e-12 * max(1.0, abs(mode))
    real, imag = (0.0 if abs(part) < tiny else part for part in (mode.real, mode.imag))
    if imag == 0.0:
        return f"{real:.6g}"
    return f"{imag:.6g}j" if real == 0.0 else f"{real:.6g}{imag:+.6g}j"


def undetectable_mode(A: Matrix, C: Matrix, time: Time) -> complex | None:
    """Return a mode of A that is not asymptotically stable and that C does not see, or None when (A, C) is detectable.

    On the invariant subspace of the modes that are not stable, the largest invariant subspace in the kernel of C is
    found; its modes are unobservable. The states are first scaled by powers of two that balance A, and each row of C to
    the size of A, so that the answer does not depend on units.

    Args:
        A: state matrix (n, n).
        C: output matrix (l, n).
        time: "continuous" or "discrete".
    """
    A, C = _balanced_pair(A, C)
    scale = spectral_scale(A, time)
    modes, errors = _modes_with_errors(A, scale)
    unstable = distance_to_stability(modes, time) >= -errors
    if not unstable.any():
        return None
    Z = invariant_subspace(A, lambda mode: nearest(mode, modes[unstable]) <= nearest(mode, modes[~unstable]))
    T, tol = Z.T @ A @ Z, len(A) * RANK_RTOL * scale
    K = unseen_subspace(T, C @ Z, tol, tol)
    hidden = np.linalg.eigvals(K.T @ T @ K)
    return complex(hidden[np.argmax(distance_to_stability(hidden, time))]) if len(hidden) else None


def _modes_with_errors(A: Matrix, scale: float) -> tuple[Any, Any]:
    """Return the eigenvalues and bounds on their errors, eps |A| / |y*x| with left and right eigenvectors y and x."""
    from scipy.linalg import eig

    modes, left, right = cast(tuple[Any, Any, Any], eig(A, left=True, right=True))
    angles = np.abs(np.sum(left.conj() * right, axis=0))
    rounding = len(A) * RANK_RTOL
    return modes, scale * np.minimum(MODE_RTOL, rounding / np.maximum(angles, rounding))


def _balanced_pair(A: Matrix, C: Matrix) -> tuple[Matrix, Matrix]:
    """Return T^-1 A T and C T with rows of C of the size of A."""
    scaling = balancing(A)
    balanced = A * scaling / scaling[:, None]
    C = C * scaling
    sizes = np.abs(C).max(axis=1, keepdims=True)
    size = np.linalg.norm(balanced, 2) or 1.0
    return balanced, size * np.divide(C, sizes, out=np.zeros_like(C), where=sizes > 0)
