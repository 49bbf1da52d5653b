"""How far a computed Riccati solution may be from the true one, and how sensitive the true one is to its data."""

from dataclasses import dataclass

import numpy as np

from derive.numeric.lyapunov import solve_lyapunov, solves_lyapunov
from derive.numeric.modes import Matrix
from derive.numeric.normal import NormalForm
from derive.numeric.riccati_iterations import Candidate

__all__ = ["Sensitivity", "sensitivity"]


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """First-order sensitivity of the stabilising P, in the coordinates of the normal form.

    Attributes:
        condition: largest relative change of P for small relative changes of F, W and G = C'C, at most; 0 when P = 0.
        error: estimated E >= 0 (n, n) with -E <= P - P* <= E, to first order.
        doubt: 4 |R| |H| |C H C'| for the residual R: where it is less than 1, a solution is within 2 |R| H of P, as
            Newton's remainder D G D is at most 4 |R|^2 |C H C'| H for every such D.
    """

    condition: float
    error: Matrix
    doubt: float


def sensitivity(form: NormalForm, found: Candidate, correlation: float) -> Sensitivity:
    """Estimate how far a stable candidate is from the solution, from its residual and from rounding.

    With K the closed loop, Omega(S) solves K X + X K' + S = 0 (discrete: K X K' - X + S = 0). A change of the data
    moves P by dP = Omega(dW + dF Y' + Y dF' - Y dG Y'), Y = P (discrete: K P). Omega keeps signs, so that with
    H = Omega(I) and J = Omega(Y Y') the residual R contributes at most |R| H, dG at most |dG| J and dF at most
    |dF| (a H + J / a), least for a^2 = |J| / |H|.

    Args:
        form: the equation.
        found: a candidate whose closed loop is stable.
        correlation: condition number of the correlation matrix of the measurement noise, by which the rounding of the
            normal form is enlarged.

    Returns:
        The sensitivity, infinite when the closed loop is not stable enough for its numbers.

    Source: C. Kenney and G. Hewer, The sensitivity of the algebraic and differential Riccati equations, SIAM J. Control
        Optim. 28 (1990) 50-69, in a form that also holds for the discrete equation.
    """
    if len(found.P) == 0:
        return Sensitivity(0.0, np.zeros((0, 0)), 0.0)
    if not found.is_stable(form):
        return _unknown(len(found.P))
    K, P, n = found.closed_loop, found.P.astype(float), len(found.P)
    Y = P if form.time == "continuous" else K @ P
    H, J = (solve_lyapunov(K, S, form.time) for S in (np.eye(n), Y @ Y.T))
    F, C, W = form.uncorrelated()
    h, j, p, f, c, w, cross = map(_norm, (H, J, P, F, C, W, form.N))
    if not (solves_lyapunov(K, H, np.eye(n), form.time) and solves_lyapunov(K, J, Y @ Y.T, form.time)):
        return _unknown(n)
    moved = h * w + 2 * f * np.sqrt(h * j) + j * c**2
    eps = float(np.finfo(np.longdouble).eps) * (n + 8)
    defect, rounded = _norm(found.value) + eps * found.size, eps * correlation
    a = np.sqrt(j / h)
    E = (defect + rounded * cross * (cross + c * a)) * H
    if j:
        E = E + rounded * c * (c + cross / a) * J
    seen = _norm(C @ H @ C.T)
    return Sensitivity(moved / p if p else 0.0, E, 4 * h * seen * defect)


def _unknown(n: int) -> Sensitivity:
    return Sensitivity(np.inf, np.full((n, n), np.inf), np.inf)


def _norm(X: Matrix) -> float:
    """Return the spectral norm, or where there are no finite numbers infinity."""
    X = X.astype(float)
    return float(np.linalg.norm(X, 2)) if np.isfinite(X).all() else np.inf
