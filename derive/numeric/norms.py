"""The H2 and H-infinity norms of a stable transfer matrix C (sI - A)^-1 B, in discrete time C (zI - A)^-1 B."""

from dataclasses import dataclass

import numpy as np

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time, balancing, distance_to_stability

__all__ = ["HInfNorm", "h2_norm", "hinf_norm", "largest_gain"]

RTOL = 1e-9
"""Relative distance between the two sides of the H-infinity norm."""

CROSSING_RTOL = 1e-7
"""Eigenvalues nearer to the boundary than this, relative to the size of the matrix, are looked at as crossings: a
double one there has an error of the square root of the rounding errors."""

STEPS = 60


@dataclass(frozen=True)
class HInfNorm:
    """Both sides of an H-infinity norm.

    Attributes:
        lower: the largest singular value at `frequency`: the norm is at least that, but for rounding.
        upper: a level that no frequency was found to reach.
        frequency: where the largest singular value is: omega [1/s], in discrete time theta with z = exp(i theta).
    """

    lower: float
    upper: float
    frequency: float


def h2_norm(A: Matrix, B: Matrix, C: Matrix, time: Time) -> float:
    """Return sqrt(tr(C P C')) with A P + P A' + B B' = 0, in discrete time P = A P A' + B B'.

    Args:
        A: state matrix (n, n).
        B: input matrix (n, m).
        C: output matrix (p, n).
        time: "continuous" or "discrete".

    Returns:
        The norm, infinite when A is not asymptotically stable.

    Example:
        >>> import numpy as np
        >>> one = np.eye(1)
        >>> abs(h2_norm(-one, one, one, "continuous") ** 2 - 1 / 2) < 1e-15
        True
    """
    if not _stable(A, time):
        return np.inf
    A, B, C = _balanced(A, B, C)
    return float(np.sqrt(max(np.trace(C @ solve_lyapunov(A, B @ B.T, time) @ C.T), 0.0)))


def hinf_norm(A: Matrix, B: Matrix, C: Matrix, time: Time) -> HInfNorm:
    """Return the largest singular value of C (sI - A)^-1 B over s = i omega, in discrete time over |z| = 1.

    A level g is a singular value at omega exactly when i omega is an eigenvalue of the Hamiltonian matrix
    [[A, B B'/g], [-C'C/g, -A']], in discrete time z one of the symplectic pencil
    z [[I, -B B'/g], [0, A']] - [[A, 0], [-C'C/g, I]]. The level is raised to the largest value found between such
    frequencies, until a level a little higher has none.

    Args:
        A: state matrix (n, n).
        B: input matrix (n, m).
        C: output matrix (p, n).
        time: "continuous" or "discrete".

    Returns:
        The norm from both sides, infinite when A is not asymptotically stable.

    Source: N. A. Bruinsma and M. Steinbuch, A fast algorithm to compute the H-infinity norm of a transfer function
        matrix, Systems & Control Letters 14 (1990) 287-293.

    Example:
        >>> import numpy as np
        >>> A, B, C = np.array([[0.0, 1.0], [-1.0, -0.2]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
        >>> norm = hinf_norm(A, B, C, "continuous")
        >>> peak = 1 / (0.2 * np.sqrt(1 - 0.1**2))  # 1/(2 d sqrt(1 - d^2)) for the damping d = 0.1
        >>> norm.lower * (1 - 1e-12) <= peak <= norm.upper, norm.upper - norm.lower < 1e-8 * peak
        (True, True)
    """
    if not _stable(A, time):
        return HInfNorm(np.inf, np.inf, float("nan"))
    try:
        return _hinf_norm(*_balanced(A, B, C), time)
    except np.linalg.LinAlgError:  # a mode on the boundary but for rounding
        return HInfNorm(np.inf, np.inf, float("nan"))


def _hinf_norm(A: Matrix, B: Matrix, C: Matrix, time: Time) -> HInfNorm:
    sizes = float(np.linalg.norm(B)), float(np.linalg.norm(C))
    if min(sizes) == 0.0:
        return HInfNorm(0.0, 0.0, 0.0)
    B, C, size = B / sizes[0], C / sizes[1], sizes[0] * sizes[1]
    lower, frequency = _largest(A, B, C, time, _first_frequencies(A, time))
    level = lower
    for _ in range(STEPS if lower > 0 else 0):
        level = lower * (1 + RTOL)
        found = _crossings(A, B, C, time, level)
        candidates = np.concatenate([found, (found[1:] + found[:-1]) / 2])
        better, where = _largest(A, B, C, time, candidates) if len(found) else (0.0, 0.0)
        if better > lower:
            lower, frequency = better, where
        if better <= level:
            break
    else:
        level = np.inf if lower > 0 else 0.0
    return HInfNorm(size * lower, size * level, frequency)


def largest_gain(A: Matrix, B: Matrix, C: Matrix, time: Time, frequencies: Matrix) -> Matrix:
    """Return the largest singular value of the transfer matrix at each frequency omega or theta (k,)."""
    points = 1j * frequencies if time == "continuous" else np.exp(1j * frequencies)
    responses = C @ np.linalg.solve(points[:, None, None] * np.eye(len(A)) - A, B.astype(complex))
    return np.linalg.norm(responses, 2, axis=(1, 2))


def _largest(A: Matrix, B: Matrix, C: Matrix, time: Time, frequencies: Matrix) -> tuple[float, float]:
    """Return the largest singular value at some frequencies, and at which."""
    gains = largest_gain(A, B, C, time, frequencies)
    best = int(np.argmax(gains))
    return float(gains[best]), float(frequencies[best])


def _first_frequencies(A: Matrix, time: Time) -> Matrix:
    """Return frequencies near resonances: of the modes, zero and, in discrete time, pi."""
    modes = np.linalg.eigvals(A)
    if time == "continuous":
        return np.unique(np.concatenate([[0.0], np.abs(modes), np.abs(modes.imag)]))
    return np.unique(np.concatenate([[0.0, 1.0, np.pi], np.abs(np.angle(modes))]))


def _crossings(A: Matrix, B: Matrix, C: Matrix, time: Time, level: float) -> Matrix:
    """Return the frequencies at which the level may be a singular value, in rising order."""
    from scipy.linalg import eigvals

    n = len(A)
    noise, weight, zero, identity = B @ B.T / level, C.T @ C / level, np.zeros((n, n)), np.eye(n)
    if time == "continuous":
        hamiltonian = np.block([[A, noise], [-weight, -A.T]])
        modes = np.linalg.eigvals(hamiltonian)
        near = np.abs(modes.real) <= CROSSING_RTOL * np.linalg.norm(hamiltonian)
        return np.unique(np.abs(modes[near].imag))
    left = np.block([[A, zero], [-weight, identity]])
    right = np.block([[identity, -noise], [zero, A.T]])
    with np.errstate(all="ignore"):  # modes at infinity
        modes = np.asarray(eigvals(left, right))
        near = np.abs(np.abs(modes) - 1) <= CROSSING_RTOL * max(np.linalg.norm(left), np.linalg.norm(right))
    return np.unique(np.abs(np.angle(modes[near & np.isfinite(modes)])))


def _stable(A: Matrix, time: Time) -> bool:
    return bool(np.all(distance_to_stability(np.linalg.eigvals(A), time) < 0))


def _balanced(A: Matrix, B: Matrix, C: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Scale the states by powers of two that balance A."""
    t = balancing(A)
    return A * t / t[:, None], B / t[:, None], C * t
