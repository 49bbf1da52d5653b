"""Random plants with their Riccati solutions by SciPy, as values of the letters of each theory.

The functions by which the corpus writes both sides of a claim also take the letters of SymPy, which the benchmark asks
for its opinion.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import block_diag, solve_continuous_are, solve_discrete_are


class M(np.ndarray):
    """A matrix whose * is the matrix product."""

    def __mul__(self, other: Any) -> Any:
        return self @ other if isinstance(other, np.ndarray) and other.ndim == 2 else np.multiply(self, other)

    def __rmul__(self, other: Any) -> Any:
        return np.multiply(self, other)


def matrix(value: Any) -> M:
    """Return an array as a matrix."""
    return np.asarray(value, dtype=float).view(M)


def inv(value: Any) -> Any:
    """Return the inverse."""
    return matrix(np.linalg.inv(value)) if isinstance(value, np.ndarray) else value.inverse()


def sqrt(value: Any) -> Any:
    """Return the square root."""
    if isinstance(value, (float, np.ndarray)):
        return np.sqrt(value)
    import sympy

    return sympy.sqrt(value)


def larger(one: float, two: Any) -> Any:
    """Return the maximum of two numbers."""
    if isinstance(two, (float, np.ndarray)):
        return np.maximum(one, two)
    import sympy

    return sympy.Max(one, two)


def eye(n: int) -> M:
    """Return the identity matrix."""
    return matrix(np.eye(n))


def tr(value: Any) -> Any:
    """Return the trace."""
    return float(np.trace(value)) if isinstance(value, np.ndarray) else value.trace()


def _square(rng: np.random.Generator, n: int, rank: int | None = None) -> M:
    factor = rng.standard_normal((n, rank or n))
    return matrix(factor @ factor.T)


def discrete(seed: int, n: int = 3, l: int = 2) -> dict[str, Any]:
    """Return a plant of luenberger-dt: P steady, Pm = P_{k-1}, Pk, Lk transient, Pp, Lf of the filter form."""
    rng = np.random.default_rng(seed)
    A, C, B = (matrix(rng.standard_normal(shape)) for shape in ((n, n), (l, n), (n, 1)))
    Q, R, Pm = _square(rng, n, rank=n - 1 if n > 1 else 1), _square(rng, l) + 0.1 * eye(l), _square(rng, n)
    P = matrix(solve_discrete_are(A.T, C.T, Q, R))
    L = A * P * C.T * inv(C * P * C.T + R)
    Lk = A * Pm * C.T * inv(C * Pm * C.T + R)
    Pk = A * Pm * A.T + Q - Lk * C * Pm * A.T
    Lf = P * C.T * inv(C * P * C.T + R)
    return {
        "A": A,
        "B": B,
        "C": C,
        "Q": Q,
        "R": R,
        "Pm": Pm,
        "P": P,
        "L": L,
        "Lk": Lk,
        "Pk": Pk,
        "Lf": Lf,
        "Pp": P - Lf * C * P,
        "I": eye(n),
        "E": eye(l),
    }


def continuous(seed: int, n: int = 3, l: int = 2) -> dict[str, Any]:
    """Return a plant of kalman-bucy: P, K steady."""
    rng = np.random.default_rng(seed)
    A, C = (matrix(rng.standard_normal(shape)) for shape in ((n, n), (l, n)))
    W, V = _square(rng, n, rank=n - 1 if n > 1 else 1), _square(rng, l) + 0.1 * eye(l)
    P = matrix(solve_continuous_are(A.T, C.T, W, V))
    return {
        "A": A,
        "C": C,
        "W": W,
        "V": V,
        "P": P,
        "K": P * C.T * inv(V),
        "I": eye(n),
        "E": eye(l),
        "Pt": _square(rng, n),
    }


def regulator(seed: int, time: str, n: int = 3, p: int = 2) -> dict[str, Any]:
    """Return a plant of lqr-ct or lqr-dt: S the solution of the Riccati equation, K the gain."""
    rng = np.random.default_rng(seed)
    A, B = (matrix(rng.standard_normal(shape)) for shape in ((n, n), (n, p)))
    Q, R = _square(rng, n, rank=n - 1 if n > 1 else 1), _square(rng, p) + 0.1 * eye(p)
    if time == "ct":
        S = matrix(solve_continuous_are(A, B, Q, R))
        K = inv(R) * B.T * S
    else:
        S = matrix(solve_discrete_are(A, B, Q, R))
        K = inv(B.T * S * B + R) * B.T * S * A
    return {"A": A, "B": B, "Q": Q, "R": R, "S": S, "K": K, "I": eye(n), "E": eye(p)}


def observer(seed: int) -> dict[str, Any]:
    """Return a plant of observer-ct: general noise inputs, any gain."""
    rng = np.random.default_rng(seed)
    n, l, d, r = 3, 2, 2, 2
    shapes = {"A": (n, n), "Bd": (n, d), "C": (l, n), "Dd": (l, d), "Dr": (l, r), "L": (n, l)}
    letters = {k: matrix(rng.standard_normal(s)) for k, s in shapes.items()}
    joint = _square(rng, d + r) + block_diag(0.1 * np.eye(d), 0.1 * np.eye(r))
    blocks = {"Sdd": joint[:d, :d], "Sdr": joint[:d, d:], "Srd": joint[d:, :d], "Srr": joint[d:, d:]}
    return {**letters, **{k: matrix(v) for k, v in blocks.items()}}


PLANTS = {
    "luenberger-dt": discrete,
    "kalman-bucy": continuous,
    "lqr-ct": lambda seed: regulator(seed, "ct"),
    "lqr-dt": lambda seed: regulator(seed, "dt"),
    "observer-ct": observer,
}
SCALAR_PLANTS = {
    "luenberger-dt": lambda seed: discrete(seed, 1, 1),
    "kalman-bucy": lambda seed: continuous(seed, 1, 1),
    "lqr-ct": lambda seed: regulator(seed, "ct", 1, 1),
    "lqr-dt": lambda seed: regulator(seed, "dt", 1, 1),
}
