"""The convex program whose multiplier is the optimal error covariance."""

from typing import Any, cast

import casadi as ca
import numpy as np

from derive.numeric.gain_ipopt import inverse, minimise, symmetric_basis
from derive.numeric.gain_search import Found
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time

__all__ = ["solve_for_multiplier"]

GUARD = 1e-300
"""Weight of ln det M(X, Z) in the cost: no number outside of the stabilising gains, and nothing beside the cost."""

ITERATIONS = 30
"""Iterations after which new coordinates pay."""


def solve_for_multiplier(F: Matrix, C: Matrix, W: Matrix, gain: Matrix, time: Time) -> Found:
    """Find the optimal gain K = X^-1 Z, and P as the multiplier of an equation between X and Z.

        min tr(W X) + tr(Z' X^-1 Z)  subject to  X U + U'X + I = 0, in discrete time U'X U - X + I = 0, U = F - X^-1 Z C

    In continuous time X U = X F - Z C, so that the equation is linear and the program convex. In discrete time U'X U =
    (X F - Z C)' X^-1 (X F - Z C) is convex in (X, Z), and with ">=" in the place of "=" the program is convex again;
    its Lagrangian is convex where the multiplier is positive semidefinite, as P is.

    X is the dual covariance of the weight I. Stationarity in Z is K = P C', in discrete time K (C P C' + I) = F P C',
    and in X the Lyapunov or Stein equation of P. X > 0 and U'X U < X keep every iterate among the stabilising gains:
    without that guard the discrete program wanders off through the points that do not satisfy its equation.

    Args:
        F: state matrix (n, n) of a plant with V = I and no cross term.
        C: output matrix (l, n).
        W: process noise (n, n).
        gain: a stabilising K (n, l) to start from.
        time: "continuous" or "discrete".

    Source: the change of variables (X, Z) is that of J. Bernussou, P. L. D. Peres, J. C. Geromel, A linear programming
        oriented procedure for quadratic stabilization of uncertain systems, Systems Control Lett. 13 (1989) 65-72.
    """
    X = solve_lyapunov((F - gain @ C).T, np.eye(len(F)), time)
    if not np.isfinite(X).all():
        return Found(gain, (), 0)
    S = symmetric_basis(len(F))
    nlp, derivatives = program(F, C, W, S, time)
    first = np.concatenate([S.T @ X.ravel(order="F"), (X @ gain).ravel(order="F")])
    run = minimise(nlp, first, {**derivatives, "ipopt.max_iter": ITERATIONS})
    gains = tuple(_gain(x, S, gain) for x in run.points)
    multiplier = (S @ run.multipliers).reshape(F.shape, order="F")
    return Found(_gain(run.x, S, gain), gains, run.iterations, multiplier)


def _gain(x: Matrix, S: Matrix, like: Matrix) -> Matrix:
    """Return X^-1 Z, not a number when X is singular."""
    X = (S @ x[: S.shape[1]]).reshape((len(like),) * 2, order="F")
    try:
        return np.linalg.solve(X, x[S.shape[1] :].reshape(like.shape, order="F"))
    except np.linalg.LinAlgError:
        return np.full(like.shape, np.nan)


def program(F: Matrix, C: Matrix, W: Matrix, S: Matrix, time: Time) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the program in the variables x = (S'vec X, vec Z), and its derivatives in closed form.

    With K = X^-1 Z and D = dZ - dX K the cost changes by tr((W - K K') dX) + 2 tr(K'dZ), the equation by the symmetric
    part of 2 F'dX - 2 C'dZ', in discrete time of U'dX U - dX - 2 U'D C. The second derivative of the Lagrangian with
    the multiplier P is 2 tr(H D'X^-1 D) with H = I, in discrete time H = I + C P C'.
    """
    n, l, m = len(F), len(C), S.shape[1]  # noqa: E741 (the field's letter for the number of outputs)
    F, C, W, S, one = (cast(Any, ca.sparsify(ca.DM(matrix))) for matrix in (F, C, W, S, np.eye(n)))
    x, p = ca.MX.sym("x", m + n * l), ca.MX.sym("p", 0)
    sigma, multipliers = ca.MX.sym("sigma"), ca.MX.sym("multipliers", m)
    X, Z, P = ca.reshape(S @ x[:m], n, n), ca.reshape(x[m:], n, l), ca.reshape(S @ multipliers, n, n)
    invert = inverse(n)
    X_inverse, _ = invert(X)
    K = X_inverse @ Z
    U = F - K @ C
    dX, dZ = ca.horzcat(S, ca.DM(n * n, n * l)), ca.horzcat(ca.DM(n * l, m), ca.DM.eye(n * l))
    D = dZ - ca.kron(K.T, one) @ dX
    if time == "continuous":
        M, H = -(X @ U + U.T @ X), sigma * ca.DM.eye(l)
        dE = 2 * (ca.kron(one, F.T) @ dX - ca.kron(C.T, one) @ dZ)
    else:
        M, H = X - U.T @ X @ U, sigma * ca.DM.eye(l) + C @ P @ C.T
        dE = ca.kron(U.T, U.T) @ dX - dX - 2 * ca.kron(C.T, U.T) @ D
    f = ca.trace(W @ X) + ca.dot(Z, K) + GUARD * invert(M)[1]
    g = S.T @ ca.vec(one - M)
    gradient = dX.T @ ca.vec(W - K @ K.T) + 2 * dZ.T @ ca.vec(K)
    hessian = ca.triu(2 * D.T @ ca.kron(H, X_inverse) @ D)
    of_lagrangian = [x, p, sigma, multipliers], [hessian], ["x", "p", "lam:f", "lam:g"], ["triu:hess:gamma:x:x"]
    return {"x": x, "f": f, "g": g}, {
        "grad_f": ca.Function("nlp_grad_f", [x, p], [f, gradient], ["x", "p"], ["f", "grad:f:x"]),
        "jac_g": ca.Function("nlp_jac_g", [x, p], [g, S.T @ dE], ["x", "p"], ["g", "jac:g:x"]),
        "hess_lag": ca.Function("nlp_hess_l", *of_lagrangian),
    }
