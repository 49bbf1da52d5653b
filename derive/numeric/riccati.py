"""The Riccati equations of the steady optimal estimator, continuous and discrete."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from derive.numeric.boundary import unexcited_boundary
from derive.numeric.extended import cholesky, divided, forward
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability
from derive.numeric.plant import Plant

__all__ = ["RiccatiSolution", "Status", "solve_riccati"]

Status = Literal["stabilising", "strong", "failed"]

NEWTON_STEPS = 10
DOUBLINGS = 60
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


@dataclass(frozen=True, eq=False)
class _Equation:
    """F P + P F' + W - P C'C P = 0, in discrete time F P F' - P + W - F P C' (C P C' + I)^-1 C P F' = 0."""

    F: Matrix
    C: Matrix
    W: Matrix
    time: Time

    def double(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return F, C, W in double precision."""
        return self.F.astype(float), self.C.astype(float), self.W.astype(float)

    def gain(self, P: Matrix) -> Matrix:
        """Return P C', in discrete time F P C' (C P C' + I)^-1, in the precision of P."""
        PC = P @ self.C.T
        if self.time == "continuous":
            return PC
        return divided(self.F @ PC, self.C @ PC + np.eye(len(self.C)))

    def residual(self, P: Matrix) -> tuple[Matrix, float]:
        """Return the left-hand side at P and its size relative to that of its terms."""
        L = self.gain(P)
        if self.time == "continuous":
            terms = (self.F @ P, P @ self.F.T, self.W, -L @ L.T)
        else:
            terms = (self.F @ P @ self.F.T, -P, self.W, -L @ (self.C @ P @ self.F.T))
        value = np.sum(terms, axis=0)
        value = (value + value.T) / 2
        size = sum(_norm(term) for term in terms)
        return value, _norm(value) / size if size else 0.0

    def closed_loop(self, P: Matrix) -> Matrix:
        """Return F - L C in double precision."""
        return (self.F - self.gain(P) @ self.C).astype(float)


def solve_riccati(plant: Plant) -> RiccatiSolution:
    """Solve A P + P A' + W - (P C' + N) V^-1 (P C' + N)' = 0, in discrete time the predictor form of the same.

    Discrete: P = A P A' + Q - (A P C' + S)(C P C' + R)^-1 (A P C' + S)', L = (A P C' + S)(C P C' + R)^-1.
    Continuous: L = (P C' + N) V^-1.

    The cross term is removed (F = A - N V^-1 C, W - N V^-1 N'), V made the identity, the states scaled by powers of
    two, and unexcited boundary modes are split off, on which P vanishes. SciPy's answer, or the doubling algorithm's
    where that is better, is refined by Newton steps whose residual is formed in extended precision.

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
    solution = _solution(plant, slack=1.0)
    return solution if solution.status != "failed" else _solution(plant, ROUNDED_SLACK)


def _solution(plant: Plant, slack: float) -> RiccatiSolution:
    whole, scaling, noise_size = _normal_form(plant)
    F, _, W = whole.double()
    split = unexcited_boundary(F, W, plant.time, noise_size, slack)
    U, strong = split.kept, len(split.modes) > 0
    part = _Equation(U.T @ whole.F @ U, whole.C @ U, U.T @ whole.W @ U, plant.time) if strong else whole
    P, steps = _solved(part)
    modes = np.linalg.eigvals(part.closed_loop(P)) if np.isfinite(P).all() else np.full(len(P), np.nan)
    P = U @ P @ U.T if strong else P
    residual = whole.residual(P)[1]
    reached = residual < FAILED and bool(np.all(distance_to_stability(modes, plant.time) < 0))
    P = P * np.outer(scaling, scaling)
    return RiccatiSolution(
        P=P.astype(float),
        gain=_gain(plant, P).astype(float),
        closed_loop=np.concatenate([modes.astype(complex), split.modes]),
        residual=residual,
        status=("strong" if strong else "stabilising") if reached else "failed",
        boundary_modes=split.modes,
        newton_steps=steps,
    )


def _gain(plant: Plant, P: Matrix) -> Matrix:
    PC = P @ plant.C.T
    if plant.is_continuous:
        return divided(PC + plant.N, plant.V.astype(P.dtype))
    return divided(plant.A @ PC + plant.N, plant.C @ PC + plant.V)


def _normal_form(plant: Plant) -> tuple[_Equation, Matrix, float]:
    """Return the equation with V = I, no cross term and balanced states, that scaling, and the size of W under it."""
    A, C, W, V, N = (X.astype(np.longdouble) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    root = cholesky(V)
    C, N = forward(root, C), forward(root, N.T).T
    F, rest = A - N @ C, W - N @ N.T
    t = _balancing(F, C, rest)
    equation = _Equation(F / t[:, None] * t, C * t, rest / np.outer(t, t), plant.time)
    return equation, t, _norm(W / np.outer(t, t))


def _balancing(F: Matrix, C: Matrix, W: Matrix) -> Matrix:
    """Return powers of two t, x = t x_balanced, that balance the Hamiltonian matrix [[F', C'C], [W, F]]."""
    from scipy.linalg import matrix_balance

    n = len(F)
    hamiltonian = np.abs(np.block([[F.T, C.T @ C], [W, F]]).astype(float))
    np.fill_diagonal(hamiltonian, 0.0)
    _, (s, _) = matrix_balance(hamiltonian, separate=True, permute=False)
    return np.exp2(np.round((np.log2(s[n:]) - np.log2(s[:n])) / 2))


def _solved(equation: _Equation) -> tuple[Matrix, int]:
    """Return the best of what the methods find, refined, and the number of Newton steps that it took."""
    n = len(equation.F)
    best, steps, error = np.full((n, n), np.nan), 0, np.inf
    if n == 0:
        return best, steps
    for method in (_scipy, _doubling):
        P, taken = _refined(equation, method(equation))
        found = equation.residual(P)[1] if _stable(equation, P) else np.inf
        if found < error:
            best, steps, error = P, taken, found
        if error <= ACCURATE:
            break
    return best, steps


def _scipy(equation: _Equation) -> Matrix:
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    F, C, W = equation.double()
    solve = solve_continuous_are if equation.time == "continuous" else solve_discrete_are
    try:
        return solve(F.T, C.T, W, np.eye(len(C)))
    except (np.linalg.LinAlgError, ValueError):
        return np.full(F.shape, np.nan)


def _refined(equation: _Equation, P: Matrix) -> tuple[Matrix, int]:
    """Take Newton steps P <- P + D, (F - L C) D + D (F - L C)' + residual = 0, while the residual falls, and stably."""
    P = P.astype(np.longdouble)
    for step in range(NEWTON_STEPS):
        value, error = equation.residual(P)
        if not _stable(equation, P) or error == 0.0:
            return P, step
        better = P + solve_lyapunov(equation.closed_loop(P), value.astype(float), equation.time)
        if not (equation.residual(better)[1] < error and _stable(equation, better)):
            return P, step
        P = better
    return P, NEWTON_STEPS


def _stable(equation: _Equation, P: Matrix) -> bool:
    loop = equation.closed_loop(P)
    return bool(np.isfinite(loop).all() and np.all(distance_to_stability(np.linalg.eigvals(loop), equation.time) < 0))


def _doubling(equation: _Equation) -> Matrix:
    """Return the limit of E <- E (I + G H)^-1 E, G <- G + E (I + G H)^-1 G E', H <- H + E' H (I + G H)^-1 E.

    Source: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, A structure-preserving doubling algorithm for continuous-time algebraic
        Riccati equations, Linear Algebra Appl. 396 (2005) 55-80.
    """
    F, C, W = equation.double()
    E, G, H = F.T, C.T @ C, W
    one = np.eye(len(F))
    with np.errstate(all="ignore"):
        try:
            if equation.time == "continuous":
                E, G, H = _cayley(E, G, H)
            for _ in range(DOUBLINGS):
                inverse = np.linalg.solve(one + G @ H, np.hstack([E, G]))
                increment = E.T @ H @ inverse[:, : len(F)]
                G = G + E @ inverse[:, len(F) :] @ E.T
                E = E @ inverse[:, : len(F)]
                G, H = (G + G.T) / 2, H + (increment + increment.T) / 2
                if not _norm(increment) > np.finfo(float).eps * _norm(H):
                    break
        except np.linalg.LinAlgError:
            return np.full(F.shape, np.nan)
    return H


def _cayley(A: Matrix, G: Matrix, H: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return the start of the doubling for A'X + X A - X G X + H = 0, by the Cayley transform with shift |A|."""
    one = np.eye(len(A))
    shift = 2 * max(_norm(A), np.sqrt(_norm(G) * _norm(H))) or 1.0
    shifted = A - shift * one
    inverse = np.linalg.inv(shifted)
    core = np.linalg.inv(shifted.T + H @ inverse @ G)
    E = one + 2 * shift * core.T
    return E, 2 * shift * inverse @ G @ core, 2 * shift * core @ H @ inverse


def _norm(X: Matrix) -> float:
    """Return the Frobenius norm."""
    return float(np.linalg.norm(X.astype(float)))
