"""The optimal gain by nonlinear programming: minimise the error covariance over all stabilising gains, with IPOPT."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal, cast

import numpy as np

from derive.numeric.extended import cholesky, forward
from derive.numeric.lyapunov import error_covariance, solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant
from derive.numeric.stabilise import stabilising_gain

__all__ = ["GainResult", "optimise_gain"]

GainStatus = Literal["optimal", "strong", "inaccurate", "failed"]

ROUNDS = 6
"""Restarts in the coordinates of the last answer."""

SETTLED = 1e-12
"""Relative decrease of the cost below which no restart follows."""

STATIONARY = 1e-6
"""Relative size of the gradient at which a gain counts as optimal."""

COORDINATE_FLOOR = 1e-6
"""Variance, relative to the largest one, that the coordinates take a state to have at least."""

NOISE_FLOOR = 1e-9
"""Process noise that is added so that ln det P has a minimum even where P is singular, relative to what keeps up P.

It shifts the gain in proportion, and the covariance of that gain by the square of that."""

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "show_eval_warnings": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-11,
    "ipopt.max_iter": 200,
}


@dataclass(frozen=True, eq=False)
class GainResult:
    """The gain that the optimiser found, and what it is worth.

    Attributes:
        gain: L (n, l).
        P: error covariance (n, n) of that gain, from its Lyapunov or Stein equation.
        trace: tr P.
        status: "optimal" when A - L C is stable and the gradient vanishes; "strong" likewise, next to boundary modes
            that the noise does not excite and that stay; "inaccurate" when stable only; "failed" otherwise.
        stationarity: size of L V - P C' - N, in discrete time of L (C P C' + R) - A P C' - S, over that of its terms,
            in the normal form; it vanishes with the gradient.
        iterations: of IPOPT, in all rounds.
        seconds: time taken.
    """

    gain: Matrix
    P: Matrix
    trace: float
    status: GainStatus
    stationarity: float
    iterations: int
    seconds: float


def optimise_gain(plant: Plant) -> GainResult:
    """Minimise ln det P over the gains L with A - L C stable, without any Riccati equation.

    For a weight M > 0 the dual covariance X, (F - K C)' X + X (F - K C) + M = 0, in discrete time
    X = (F - K C)' X (F - K C) + M, gives tr(M P) = tr(W X) + tr(K' X K), and min over M of tr(M P) - ln det M is
    n + ln det P. With Z = X K the program

        min tr(W X) + tr(Z' X^-1 Z) - ln det M(X, Z)

    is convex: M = Z C + C'Z' - F'X - X F, in discrete time M = X - (X F - Z C)' X^-1 (X F - Z C). The covariance that
    is least in the sense of Loewner minimises ln det P, tr P and every tr(M P). F, C, W are those of the normal form
    (V = I, no cross term) in coordinates that make the covariance of the last gain the identity.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.

    Returns:
        The gain with P recomputed for it; in the strong case with the boundary modes left where they are.

    Source: the change of variables (X, Z) is that of J. Bernussou, P. L. D. Peres, J. C. Geromel, A linear programming
        oriented procedure for quadratic stabilization of uncertain systems, Systems Control Lett. 13 (1989) 65-72.
    """
    start = perf_counter()
    whole = normal_form(plant)
    boundary = whole.boundary()
    part = whole.without(boundary)
    K, iterations = _optimal(part)
    P = _covariance(part, K)
    stationarity = _stationarity(part, K, P)
    if len(boundary.modes):
        K, P = boundary.kept @ K, boundary.kept @ P @ boundary.kept.T
    P = whole.unscaled(P).astype(float)
    status: GainStatus = "failed"
    if np.isfinite(P).all():
        status = "inaccurate" if stationarity > STATIONARY else "strong" if len(boundary.modes) else "optimal"
    return GainResult(
        gain=_plant_gain(plant, whole, K),
        P=P,
        trace=float(np.trace(P)),
        status=status,
        stationarity=stationarity,
        iterations=iterations,
        seconds=perf_counter() - start,
    )


def _plant_gain(plant: Plant, form: NormalForm, K: Matrix) -> Matrix:
    """Return L = t K V^(-1/2) + N V^-1."""
    root = cholesky(plant.V)
    return forward(root[::-1, ::-1].T, (form.scaling[:, None] * K + forward(root, plant.N.T).T).T[::-1])[::-1].T


def _covariance(form: NormalForm, K: Matrix) -> Matrix:
    """Return P for a gain, not a number when F - K C is not stable."""
    F, C, W = form.uncorrelated()
    if np.isfinite(K).all() and np.all(distance_to_stability(np.linalg.eigvals(F - K @ C), form.time) < 0):
        P = error_covariance(F, C, W, np.eye(len(C)), np.zeros_like(K), K, form.time)
        if np.isfinite(P).all():
            return P
    return np.full(F.shape, np.nan)


def _stationarity(form: NormalForm, K: Matrix, P: Matrix) -> float:
    """Return |K - P C'|, in discrete time |K (C P C' + I) - F P C'|, relative: 0 where the gradient vanishes."""
    F, C, _ = form.uncorrelated()
    first, second = (K, P @ C.T) if form.time == "continuous" else (K @ (C @ P @ C.T + np.eye(len(C))), F @ P @ C.T)
    size = np.linalg.norm(first) + np.linalg.norm(second)
    return float(np.linalg.norm(first - second) / size) if size else 0.0


def _optimal(form: NormalForm) -> tuple[Matrix, int]:
    """Return the best gain, and the iterations of all rounds."""
    F, C, W = form.uncorrelated()
    K, iterations = stabilising_gain(F, C, form.time), 0
    P = _covariance(form, K)
    for _ in range(ROUNDS):
        if not np.trace(P) > 0:
            break
        variances, directions = np.linalg.eigh(P)
        deviations = np.sqrt(np.maximum(variances, COORDINATE_FLOOR * variances.max()))
        T, R = directions * deviations, (directions / deviations).T
        floor = NOISE_FLOOR * _decay(F - K @ C, form.time)
        found, taken = _solve(R @ F @ T, C @ T, R @ W @ R.T + floor * np.eye(len(P)), R @ K, form.time)
        better, iterations = _covariance(form, T @ found), iterations + taken
        decrease = 1 - np.trace(R @ better @ R.T) / np.trace(R @ P @ R.T)
        if decrease > 0:
            K, P = T @ found, better
        if not decrease > SETTLED:
            break
    return K, iterations


def _decay(loop: Matrix, time: Time) -> float:
    """Return the noise that keeps up unit variance of the slowest mode: -2 Re lambda, discrete 1 - |lambda|^2."""
    modes = np.linalg.eigvals(loop)
    return float(np.min(-2 * np.real(modes) if time == "continuous" else 1 - np.abs(modes) ** 2))


def _solve(F: Matrix, C: Matrix, W: Matrix, K: Matrix, time: Time) -> tuple[Matrix, int]:
    """Solve the program from the gain K, and return the gain and the number of iterations."""
    S = _symmetric_basis(len(F))
    solver = _program(F, C, W, S, time)
    X = solve_lyapunov((F - K @ C).T, np.eye(len(F)), time)
    if not np.isfinite(X).all():
        return K, 0
    first = np.concatenate([S.T @ X.ravel(order="F"), (X @ K).ravel(order="F")])
    x = np.array(solver(x0=first)["x"]).ravel()
    X = (S @ x[: S.shape[1]]).reshape(F.shape, order="F")
    found = np.linalg.solve(X, x[S.shape[1] :].reshape(K.shape, order="F"))
    return found, int(solver.stats()["iter_count"])


def _program(F: Matrix, C: Matrix, W: Matrix, S: Matrix, time: Time) -> Any:
    """Return IPOPT for the variables x = (S'vec X, vec Z), with its derivatives in closed form.

    With K = X^-1 Z, U = F - K C, D = dZ - dX K and P = M^-1 the cost changes by
    tr((W - K K') dX) + 2 tr(K'dZ) - tr(P dM), where dM is the symmetric part of 2 C'dZ' - 2 F'dX, in discrete time of
    dX - U'dX U + 2 U'D C. The second derivative is 2 tr(H D'X^-1 D) + tr(P dM P dM) with H = I, in discrete time
    H = I + C P C'.
    """
    import casadi as ca

    n, l, m = len(F), len(C), S.shape[1]  # noqa: E741 (the field's letter for the number of outputs)
    F, C, W, S, one = (cast(Any, ca.sparsify(ca.DM(matrix))) for matrix in (F, C, W, S, np.eye(n)))
    x, p, sigma = ca.MX.sym("x", m + n * l), ca.MX.sym("p", 0), ca.MX.sym("sigma")
    X, Z = ca.reshape(S @ x[:m], n, n), ca.reshape(x[m:], n, l)
    invert = _inverse(n)
    X_inverse, _ = invert(X)
    K = X_inverse @ Z
    U = F - K @ C
    dX, dZ = ca.horzcat(S, ca.DM(n * n, n * l)), ca.horzcat(ca.DM(n * l, m), ca.DM.eye(n * l))
    D = dZ - ca.kron(K.T, one) @ dX
    if time == "continuous":
        P, log_det = invert(-X @ U - U.T @ X)
        H, dM = ca.DM.eye(l), 2 * (ca.kron(C.T, one) @ dZ - ca.kron(one, F.T) @ dX)
    else:
        P, log_det = invert(X - U.T @ X @ U)
        H, dM = ca.DM.eye(l) + C @ P @ C.T, dX - ca.kron(U.T, U.T) @ dX + 2 * ca.kron(C.T, U.T) @ D
    dM = S.T @ dM
    f = ca.trace(W @ X) + ca.dot(Z, K) - log_det
    gradient = dX.T @ ca.vec(W - K @ K.T) + 2 * dZ.T @ ca.vec(K) - dM.T @ (S.T @ ca.vec(P))
    hessian = sigma * ca.triu(2 * D.T @ ca.kron(H, X_inverse) @ D + dM.T @ (S.T @ ca.kron(P, P) @ S) @ dM)
    outputs = ["triu:hess:gamma:x:x"]
    derivatives = {
        "grad_f": ca.Function("nlp_grad_f", [x, p], [f, gradient], ["x", "p"], ["f", "grad:f:x"]),
        "hess_lag": ca.Function(
            "nlp_hess_l", [x, p, sigma, ca.MX.sym("none", 0)], [hessian], ["x", "p", "lam:f", "lam:g"], outputs
        ),
    }
    return ca.nlpsol("gain", "ipopt", {"x": x, "f": f}, {**OPTIONS, **derivatives})


def _symmetric_basis(n: int) -> Matrix:
    """Return S (n^2, n(n+1)/2) with orthonormal columns that span the vec of the symmetric matrices."""
    columns = []
    for i in range(n):
        for j in range(i + 1):
            E = np.zeros((n, n))
            E[i, j] = E[j, i] = 1.0 if i == j else np.sqrt(0.5)
            columns.append(E.ravel())
    return np.array(columns).T


def _inverse(n: int) -> Any:
    """Return X -> X^-1, ln det X for X > 0; not a number for others, which makes IPOPT shorten its step."""
    import casadi as ca

    X = ca.SX.sym("X", n, n)
    T = ca.SX(n, n)
    for j in range(n):
        T[j, j] = ca.sqrt(X[j, j] - ca.sumsqr(T[j, :j]))
        for i in range(j + 1, n):
            T[i, j] = (X[i, j] - ca.dot(T[i, :j], T[j, :j])) / T[j, j]
    R = ca.SX(n, n)
    for i in range(n):
        R[i, i] = 1 / T[i, i]
        for j in range(i):
            R[i, j] = -ca.dot(T[i, j:i], R[j:i, j].T) / T[i, i]
    return ca.Function("inverse", [X], [R.T @ R, 2 * ca.sum1(ca.log(ca.diag(T)))])
