"""Modes of a matrix that decide whether an estimator exists: unstable, on the boundary, seen or not seen."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Matrix", "Time", "distance_to_stability", "format_mode", "spectral_scale", "undetectable_mode"]

Matrix = NDArray[np.floating[Any]]
Time = Literal["continuous", "discrete"]

UNOBSERVABLE_RTOL = 64 * np.finfo(float).eps
"""A mode is unobservable when the smallest singular value of [A - lambda I; C] is below this, relative and times n."""

BOUNDARY_RTOL = 1e-7
"""Modes this close to the boundary are asked to be seen too: a computed double mode is only good to sqrt(eps)."""


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

    Popov-Belevitch-Hautus: lambda is unobservable when rank [A - lambda I; C] < n. The states are first scaled by
    powers of two that balance A, and each row of C to the size of A, so that the answer does not depend on units.

    Args:
        A: state matrix (n, n).
        C: output matrix (l, n).
        time: "continuous" or "discrete".

    Source: M. L. J. Hautus, Controllability and observability conditions of linear autonomous systems, 1969.
    """
    n = len(A)
    balanced, C = _balanced_pair(A, C)
    modes = np.linalg.eigvals(balanced)
    scale = spectral_scale(balanced, time)
    for mode in modes[distance_to_stability(modes, time) >= -BOUNDARY_RTOL * scale]:
        pencil = np.vstack([balanced - mode * np.eye(n), C])
        if np.linalg.svd(pencil, compute_uv=False)[-1] <= n * UNOBSERVABLE_RTOL * max(scale, abs(mode)):
            return complex(mode)
    return None


def _balanced_pair(A: Matrix, C: Matrix) -> tuple[Matrix, Matrix]:
    """Return T^-1 A T and C T with rows of C of the size of A."""
    from scipy.linalg import matrix_balance

    balanced, (scaling, _) = matrix_balance(A, permute=False, separate=True)
    C = C * scaling
    sizes = np.abs(C).max(axis=1, keepdims=True)
    size = np.linalg.norm(balanced, 2) or 1.0
    return balanced, size * np.divide(C, sizes, out=np.zeros_like(C), where=sizes > 0)
