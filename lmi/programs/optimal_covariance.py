"""The optimal error covariance as the largest P that satisfies the Riccati inequality.

    continuous:  max tr(M P)  s.t.  [[A P + P A' + W, P C' + N], [C P + N', V]] >= 0
    discrete:    max tr(M P)  s.t.  [[A P A' + W - P, A P C' + N], [C P A' + N', C P C' + V]] >= 0

Requires: V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable, M > 0. Then the set of feasible P has a greatest element in
the order of symmetric matrices, the strong solution of the Riccati equation, and every M > 0 singles it out. An
unstable mode that C does not see makes the program unbounded.

Source: J. C. Willems, Least squares stationary optimal control and the algebraic Riccati equation, IEEE Trans.
Automatic Control 16(6), 1971, for the inequality and its greatest solution (there for control, here its dual);
A. C. M. Ran and R. Vreugdenhil, Existence and comparison theorems for algebraic Riccati equations for continuous- and
discrete-time systems, Linear Algebra Appl. 99, 1988, for detectable pairs and discrete time.
"""

import cvxpy as cp
import numpy as np

from derive.numeric.plant import Plant
from lmi.programs.program import Matrix, Program, SymmetricMap, packed, shape_of, unpacked
from lmi.residual import optimal_gain

__all__ = ["joint_noise", "optimal_covariance", "riccati_inequality", "riccati_map"]


def optimal_covariance(plant: Plant) -> Program:
    """State the program max tr(M P) subject to the Riccati inequality.

    Args:
        plant: A (n, n), C (l, n), W, V, N and the weight M.

    Returns:
        The program; its gain is (P C' + N) V^-1, in discrete time (A P C' + N) (C P C' + V)^-1.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from lmi.solve import solve_program
        >>> plant = plant_from_mapping({"time": "continuous", "A": 0.0, "C": 1.0, "W": 4.0, "V": 1.0})
        >>> program = optimal_covariance(plant)
        >>> solve_program(program).status.value
        'solved'
        >>> bool(abs(program.answer()[0][0, 0] - 2.0) < 1e-9)
        True
    """
    shape, n = shape_of(plant), plant.n
    F = SymmetricMap(plant, riccati_map, "F")
    J = cp.Parameter((n + plant.l,) * 2, symmetric=True, name="J")
    weight = cp.Parameter(n * (n + 1) // 2, name="M")
    P = cp.Variable(n * (n + 1) // 2, name="P")
    problem = cp.Problem(cp.Maximize(weight @ P), [J + F(P) >> 0])
    now = [plant]

    def load(plant: Plant) -> bool:
        if shape_of(plant) != shape:
            return False
        F.load(plant)
        J.value, weight.value = joint_noise(plant), packed(2 * plant.M - np.diag(np.diag(plant.M)))
        now[0] = plant
        return True

    def answer() -> tuple[Matrix, Matrix]:
        value = unpacked(np.asarray(P.value), n)
        return value, optimal_gain(now[0], value)

    load(plant)
    return Program("largest covariance under the Riccati inequality", problem, answer, load)


def joint_noise(plant: Plant) -> Matrix:
    """Return J = [[W, N], [N', V]] (n + l, n + l), exactly symmetric."""
    J = np.block([[plant.W, plant.N], [plant.N.T, plant.V]])
    return (J + J.T) / 2


def riccati_map(plant: Plant, P: Matrix) -> Matrix:
    """Return the part of the Riccati inequality's matrix that is linear in P.

    continuous: [[A P + P A', P C'], [C P, 0]]    discrete: [[A P A' - P, A P C'], [C P A', C P C']]
    """
    A, C = plant.A, plant.C
    if plant.is_continuous:
        return np.block([[A @ P + P @ A.T, P @ C.T], [C @ P, np.zeros((plant.l, plant.l))]])
    return np.block([[A @ P @ A.T - P, A @ P @ C.T], [C @ P @ A.T, C @ P @ C.T]])


def riccati_inequality(plant: Plant, P: Matrix) -> Matrix:
    """Return the matrix (n + l, n + l), affine in P, that the Riccati inequality asks to be positive semidefinite."""
    return joint_noise(plant) + riccati_map(plant, P)
