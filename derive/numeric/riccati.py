"""The Riccati equations of the steady optimal estimator, continuous and discrete."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from derive.numeric.extended import divided
from derive.numeric.lyapunov import error_covariance, solve_lyapunov
from derive.numeric.modes import Matrix, distance_to_stability
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant
from derive.numeric.stabilise import stabilising_gain

__all__ = ["RiccatiSolution", "Status", "solve_riccati"]

Status = Literal["stabilising", "strong", "failed"]

NEWTON_STEPS = 10
KLEINMAN_STEPS = 60
ACCURATE = 1e-13
"""Relative residual above which a second method is tried."""

FAILED = 1e-6
"""Relative residual above which there is no solution to speak of."""

ROUNDED_SLACK = 1e3
"""Factor on the tolerances for boundary modes when nothing is found without it: data that carry earlier rounding."""


@dataclass(frozen=True, eq=False)
class RiccatiSolution:
    """The steady error covariance and the optimal gain.

    Attributes:
        P: error covariance (n, n) [state]^2, of the predicted state in discrete time.
        gain: L (n, l) of the observer x' = A x + L (y - C x), in discrete time of the predictor.
        closed_loop: eigenvalues of A - L C (n,).
        residual: |residual of the equation| / sum of the sizes of its terms, in balanced coordinates.
        status: "stabilising" when A - L C is asymptotically stable, "strong" when it keeps boundary modes that the
            noise does not excite, "failed" when neither was reached (P is then the best attempt, or not a number).
        boundary_modes: eigenvalues that the strong solution leaves on the boundary, empty when it is stabilising.
        newton_steps: accepted Newton steps.
    """

    P: Matrix
    gain: Matrix
    closed_loop: NDArray[np.complexfloating[Any, Any]]
    residual: float
    status: Status
    boundary_modes: NDArray[np.complexfloating[Any, Any]]
    newton_steps: int


def solve_riccati(plant: Plant) -> RiccatiSolution:
    """Solve A P + P A' + W - (P C' + N) V^-1 (P C' + N)' = 0, in discrete time the predictor form of the same.

    Discrete: P = A P A' + Q - (A P C' + S)(C P C' + R)^-1 (A P C' + S)', L = (A P C' + S)(C P C' + R)^-1.
    Continuous: L = (P C' + N) V^-1.

    The cross term is removed (F = A - N V^-1 C, W - N V^-1 N'), V made the identity, the states scaled by powers of
    two, and unexcited boundary modes are split off, on which P vanishes. SciPy's answer, or where that is not
    accurate the one of Kleinman's iteration, is refined by Newton steps whose residual is formed in extended precision.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.

    Returns:
        The stabilising solution; the strong one when unexcited modes lie on the boundary.

    Source: D. L. Kleinman, On an iterative technique for Riccati equation computations, IEEE Trans. Automat. Control 13
        (1968) 114-115; stated for the regulator, the dual.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> solution = solve_riccati(example_plant())
        >>> solution.status, solution.residual < 1e-14
        ('stabilising', True)
    """
    with np.errstate(all="ignore"):  # a method that leaves the numbers is not taken
        solution = _solution(plant, slack=1.0)
        return solution if solution.status != "failed" else _solution(plant, ROUNDED_SLACK)


def _solution(plant: Plant, slack: float) -> RiccatiSolution:
    whole = normal_form(plant)
    boundary = whole.boundary(slack)
    part, strong = whole.without(boundary), len(boundary.modes) > 0
    P, steps = _solved(part)
    modes = np.linalg.eigvals(_closed_loop(part, P)) if np.isfinite(P).all() else np.full(len(P), np.nan)
    P = boundary.kept @ P @ boundary.kept.T if strong else P
    residual = _residual(whole, P)[1]
    reached = residual < FAILED and bool(np.all(distance_to_stability(modes, plant.time) < 0))
    P = whole.unscaled(P)
    return RiccatiSolution(
        P=P.astype(float),
        gain=_plant_gain(plant, P).astype(float),
        closed_loop=np.concatenate([modes.astype(complex), boundary.modes]),
        residual=residual,
        status=("strong" if strong else "stabilising") if reached else "failed",
        boundary_modes=boundary.modes,
        newton_steps=steps,
    )


def _plant_gain(plant: Plant, P: Matrix) -> Matrix:
    PC = P @ plant.C.T
    if plant.is_continuous:
        return divided(PC + plant.N, plant.V.astype(P.dtype))
    return divided(plant.A @ PC + plant.N, plant.C @ PC + plant.V)


def _gain(form: NormalForm, P: Matrix) -> Matrix:
    """Return P C' + N, in discrete time (A P C' + N) (C P C' + I)^-1, in the precision of P."""
    PC = P @ form.C.T
    if form.time == "continuous":
        return PC + form.N
    return divided(form.A @ PC + form.N, form.C @ PC + np.eye(len(form.C)))


def _closed_loop(form: NormalForm, P: Matrix) -> Matrix:
    """Return A - L C in double precision."""
    return (form.A - _gain(form, P) @ form.C).astype(float)


def _residual(form: NormalForm, P: Matrix) -> tuple[Matrix, float]:
    """Return the left-hand side of the equation at P, and its size relative to that of its terms."""
    L = _gain(form, P)
    if form.time == "continuous":
        terms = (form.A @ P, P @ form.A.T, form.W, -L @ L.T)
    else:
        terms = (form.A @ P @ form.A.T, -P, form.W, -L @ (form.C @ P @ form.A.T + form.N.T))
    value = np.sum(terms, axis=0)
    size = sum(_norm(term) for term in terms)
    return (value + value.T) / 2, _norm(value) / size if size else 0.0


def _solved(form: NormalForm) -> tuple[Matrix, int]:
    """Return the best of what the methods find, refined, and the number of Newton steps that it took."""
    n = len(form.A)
    best, steps, error = np.full((n, n), np.nan), 0, np.inf
    if n == 0:
        return best, steps
    for method in (_scipy, _kleinman):
        P, taken = _refined(form, method(form))
        found = _residual(form, P)[1] if _stable(form, P) else np.inf
        if found < error:
            best, steps, error = P, taken, found
        if error <= ACCURATE:
            break
    return best, steps


def _scipy(form: NormalForm) -> Matrix:
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    F, C, W = form.uncorrelated()
    solve = solve_continuous_are if form.time == "continuous" else solve_discrete_are
    try:
        return solve(F.T, C.T, W, np.eye(len(C)))
    except (np.linalg.LinAlgError, ValueError):
        return np.full(F.shape, np.nan)


def _refined(form: NormalForm, P: Matrix) -> tuple[Matrix, int]:
    """Take Newton steps P <- P + D, (F - L C) D + D (F - L C)' + residual = 0, while the residual falls, and stably."""
    P = P.astype(np.longdouble)
    for step in range(NEWTON_STEPS):
        value, error = _residual(form, P)
        if not _stable(form, P) or error == 0.0:
            return P, step
        better = P + solve_lyapunov(_closed_loop(form, P), value.astype(float), form.time)
        if not (_residual(form, better)[1] < error and _stable(form, better)):
            return P, step
        P = better
    return P, NEWTON_STEPS


def _stable(form: NormalForm, P: Matrix) -> bool:
    loop = _closed_loop(form, P)
    return bool(np.isfinite(loop).all() and np.all(distance_to_stability(np.linalg.eigvals(loop), form.time) < 0))


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
        K = (_gain(form, P) - form.N).astype(float)
    return P


def _norm(X: Matrix) -> float:
    """Return the Frobenius norm."""
    return float(np.linalg.norm(X.astype(float)))
