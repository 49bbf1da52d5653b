"""Riccati equations in normal form: their residual, and the iterations that solve them in floating point."""

from dataclasses import dataclass

import numpy as np

from derive.numeric.extended import divided
from derive.numeric.lyapunov import error_covariance, solve_lyapunov
from derive.numeric.modes import Matrix, distance_to_stability
from derive.numeric.normal import NormalForm
from derive.numeric.stabilise import stabilising_gain

__all__ = ["Candidate", "best_candidate"]

NEWTON_STEPS = 10
KLEINMAN_STEPS = 60
ACCURATE = 1e-13
"""Relative residual above which a second method is tried."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A symmetric P tried as the solution of 0 = A P + P A' + W - L L', in discrete time A P A' - P + W - L S L'.

    Attributes:
        P: the covariance (n, n), in extended precision.
        closed_loop: A - L C (n, n) in double precision.
        value: the right-hand side (n, n).
        residual: its size relative to the sum of the sizes of its terms.
        size: that sum.
        gain_size: |L|.
        steps: Newton steps that led here.
    """

    P: Matrix
    closed_loop: Matrix
    value: Matrix
    residual: float
    size: float
    gain_size: float
    steps: int = 0

    @classmethod
    def of(cls, form: NormalForm, P: Matrix, steps: int = 0) -> "Candidate":
        """Form the residual in the precision of P."""
        PC = P @ form.C.T
        if form.time == "continuous":
            L = PC + form.N
            AP = form.A @ P
            terms = (AP, AP.T, form.W, -L @ L.T)
        else:
            APC, S = form.A @ PC + form.N, form.C @ PC + np.eye(len(form.C))
            L = divided(APC, S)
            terms = (form.A @ P @ form.A.T, -P, form.W, -L @ APC.T)
        value = np.sum(terms, axis=0)
        size = sum(_norm(term) for term in terms)
        residual = _norm(value) / size if size else 0.0
        loop = (form.A - L @ form.C).astype(float)
        return cls(P, loop, (value + value.T) / 2, residual, size, _norm(L), steps)

    @property
    def finite(self) -> bool:
        """Whether it is numbers at all."""
        return bool(np.isfinite(self.closed_loop).all() and np.isfinite(self.residual))

    def is_stable(self, form: NormalForm) -> bool:
        """Whether the computed eigenvalues of the closed loop are stable."""
        if not self.finite:
            return False
        return bool(np.all(distance_to_stability(np.linalg.eigvals(self.closed_loop), form.time) < 0))


def best_candidate(form: NormalForm) -> Candidate:
    """Return the best of what SciPy's method and, where that is not accurate, Kleinman's iteration find, refined.

    The residual of a candidate that is not stable is infinite.
    """
    if len(form.A) == 0:
        return Candidate.of(form, np.zeros((0, 0), np.longdouble))
    best = None
    for method in (_scipy, _kleinman):
        found = _refined(form, method(form))
        if best is None or found.residual < best.residual:
            best = found
        if best.residual <= ACCURATE:
            break
    assert best is not None
    return best


def _refined(form: NormalForm, P: Matrix) -> Candidate:
    """Take Newton steps P <- P + D, (F - L C) D + D (F - L C)' + residual = 0, while the residual falls, and stably."""
    best = Candidate.of(form, P.astype(np.longdouble))
    if not best.is_stable(form):
        return Candidate(best.P, best.closed_loop, best.value, np.inf, best.size, best.gain_size)
    for step in range(1, NEWTON_STEPS + 1):
        if best.residual == 0.0:
            break
        D = solve_lyapunov(best.closed_loop, best.value.astype(float), form.time)
        better = Candidate.of(form, best.P + D, step)
        if not (better.residual < best.residual and better.is_stable(form)):
            break
        best = better
    return best


def _scipy(form: NormalForm) -> Matrix:
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    F, C, W = form.uncorrelated()
    solve = solve_continuous_are if form.time == "continuous" else solve_discrete_are
    try:
        return solve(F.T, C.T, W, np.eye(len(C)))
    except (np.linalg.LinAlgError, ValueError):
        return np.full(F.shape, np.nan)


def _kleinman(form: NormalForm) -> Matrix:
    """Return the limit of P = covariance of K, K = optimal gain for P: from a stabilising start P falls steadily."""
    F, C, W = form.uncorrelated()
    K, P = stabilising_gain(F, C, form.time), np.full(F.shape, np.nan)
    best = np.inf
    for _ in range(KLEINMAN_STEPS):
        if not np.isfinite(K).all() or np.any(distance_to_stability(np.linalg.eigvals(F - K @ C), form.time) >= 0):
            break
        better = error_covariance(F, C, W, np.eye(len(C)), np.zeros_like(K), K, form.time)
        if not np.trace(better) < best:
            break
        P, best = better, np.trace(better)
        PC = P @ C.T
        K = PC if form.time == "continuous" else divided(F @ PC, C @ PC + np.eye(len(C)))
    return P


def _norm(X: Matrix) -> float:
    """Return the Frobenius norm."""
    return float(np.linalg.norm(X.astype(float)))
