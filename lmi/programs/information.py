"""The optimal error covariance in information form: the greatest X = P^-1 under the inverse Riccati inequality.

With F = A - N V^-1 C and G G' = W - N V^-1 N',

    max tr(X)  s.t.  X >= 0  and
    continuous:  [[C'V^-1 C - X F - F'X, X G], [G'X, I]] >= 0
    discrete:    [[X + C'V^-1 C, 0], [0, I]] - [F, G]' X [F, G] >= 0

The optimum is P*^-1, in discrete time of the predictor; the information after a measurement, P+^-1, is X + C'V^-1 C.

Why: for X > 0 and P = X^-1, a Schur complement and a congruence with P turn the inequality into F P + P F' + G G' -
P C'V^-1 C P <= 0, in discrete time F (X + C'V^-1 C)^-1 F' + G G' <= P. Let L be the gain of that P. Then P > 0 solves
the Lyapunov (Stein) inequality of F - L C with G G' + L V L', so that no mode of F - L C is outside the region of
stability, and x*(F - L C) = lambda x* on its boundary needs x*G = 0 and x*L = 0: an unexcited boundary mode of F, which
P* > 0 excludes. So F - L C is stable, P is at least the covariance of L, hence P >= P* and X <= P*^-1. A singular
feasible X is the limit of X + t (P*^-1 - X), which are feasible and > 0.

Requires: V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable, P* > 0. P* is singular exactly when G leaves a stable or
boundary mode of F unexcited; then X grows without bound, and the program is unbounded.

Source: B. D. O. Anderson and J. B. Moore, Optimal Filtering, 1979, chapter 6 (the information filter); J. C. Willems,
1971, for the inequality.
"""

import cvxpy as cp
import numpy as np

from derive.numeric.plant import Plant
from lmi.programs.observer import factor
from lmi.programs.program import Matrix, Program, SymmetricMap, shape_of, unpacked
from lmi.residual import optimal_gain

__all__ = ["information"]


def information(plant: Plant) -> Program:
    """State the program max tr(X) under the inverse Riccati inequality.

    Args:
        plant: A (n, n), C (l, n), W, V, N; every weight M > 0 has the same answer.

    Returns:
        The program; its covariance is X^-1 (n, n), its gain the optimal one for it (n, l).

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from lmi.solve import solve_program
        >>> plant = plant_from_mapping({"time": "continuous", "A": 0.0, "C": 1.0, "W": 4.0, "V": 1.0})
        >>> program = information(plant)
        >>> solve_program(program).status.value
        'solved'
        >>> bool(abs(program.answer()[0][0, 0] - 2.0) < 1e-8)
        True
    """
    shape, n = shape_of(plant), plant.n
    G = _uncorrelated(plant)[1]
    k = G.shape[1]
    linear = SymmetricMap(plant, lambda plant, X: _linear(plant, X, k), "F")
    seen = cp.Parameter((n + k, n + k), symmetric=True, name="C'V^-1 C")
    trace = np.eye(n)[np.triu_indices(n)]
    x = cp.Variable(n * (n + 1) // 2, name="X")
    X = cp.reshape(_unpacking(n) @ x, (n, n), order="C")
    problem = cp.Problem(cp.Maximize(trace @ x), [seen + linear(x) >> 0, X >> 0])
    now = [plant]

    def load(plant: Plant) -> bool:
        if shape_of(plant) != shape or _uncorrelated(plant)[1].shape[1] != k:
            return False
        linear.load(plant)
        seen.value = _constant(plant, k)
        now[0] = plant
        return True

    def answer() -> tuple[Matrix, Matrix]:
        inverse = np.linalg.inv(unpacked(np.asarray(x.value), n))
        P = (inverse + inverse.T) / 2
        return P, optimal_gain(now[0], P)

    load(plant)
    return Program("greatest information under the inverse Riccati inequality", problem, answer, load)


def _uncorrelated(plant: Plant) -> tuple[Matrix, Matrix]:
    """Return F = A - N V^-1 C and G with G G' = W - N V^-1 N'."""
    shift = np.linalg.solve(plant.V, plant.N.T).T
    noise = plant.W - shift @ plant.N.T
    return plant.A - shift @ plant.C, factor((noise + noise.T) / 2)


def _linear(plant: Plant, X: Matrix, k: int) -> Matrix:
    """Return the part (n + k, n + k) of the inequality that is linear in X, G brought to k columns."""
    F, G = _uncorrelated(plant)
    G = np.pad(G, ((0, 0), (0, max(0, k - G.shape[1]))))[:, :k]
    if plant.is_continuous:
        return np.block([[-X @ F - F.T @ X, X @ G], [G.T @ X, np.zeros((k, k))]])
    moved = np.hstack([F, G])
    image = -moved.T @ X @ moved
    image[: plant.n, : plant.n] += X
    return image


def _constant(plant: Plant, k: int) -> Matrix:
    """Return blkdiag(C'V^-1 C, I)."""
    seen = plant.C.T @ np.linalg.solve(plant.V, plant.C)
    n = plant.n
    return np.block([[(seen + seen.T) / 2, np.zeros((n, k))], [np.zeros((k, n)), np.eye(k)]])


def _unpacking(n: int) -> Matrix:
    """Return the matrix (n^2, n (n + 1) / 2) that takes a packed matrix to its entries."""
    return np.array([unpacked(row, n).ravel() for row in np.eye(n * (n + 1) // 2)]).T
