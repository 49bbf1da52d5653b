"""The dual of the largest covariance: the covariance as the multiplier of an adjoint Lyapunov equation.

    min tr(J Z)  s.t.  Z = [[S, K], [K', Q]] >= 0,  J = [[W, N], [N', V]],  and
    continuous:  A'S + S A + K C + C'K' + M = 0
    discrete:    [A', C'] Z [A', C']' - S + M = 0

The multiplier of the equation is P and the value is tr(M P). With the gain L = -S^-1 K the optimal Z is
[I, -L]' S [I, -L], and the equation is the adjoint Lyapunov equation of A - L C.

Requires: V > 0, J >= 0, (A, C) detectable, M > 0. The minimum is attained when the solution of the Riccati equation is
stabilising; with a mode on the boundary it is only approached, S grows without bound.

Source: V. Balakrishnan and L. Vandenberghe, Semidefinite programming duality and linear time-invariant systems, IEEE
Trans. Automatic Control 48(1), 2003, where the dual of the linear quadratic regulator is derived so.
"""

import cvxpy as cp
import numpy as np

from derive.numeric.plant import Plant
from lmi.programs.optimal_covariance import joint_noise, riccati_map
from lmi.programs.program import Matrix, Program, SymmetricMap, packed, shape_of, unpacked

__all__ = ["optimal_covariance_dual"]


def optimal_covariance_dual(plant: Plant) -> Program:
    """State the program min tr(J Z) over Z >= 0 subject to the adjoint Lyapunov equation.

    Args:
        plant: A (n, n), C (l, n), W, V, N and the weight M.

    Returns:
        The program; its covariance is the multiplier P (n, n), its gain L = -S^-1 K (n, l).

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from lmi.solve import solve_program
        >>> plant = plant_from_mapping({"time": "continuous", "A": 0.0, "C": 1.0, "W": 4.0, "V": 1.0})
        >>> program = optimal_covariance_dual(plant)
        >>> solve_program(program).status.value
        'solved'
        >>> bool(abs(program.answer()[0][0, 0] - 2.0) < 1e-9)
        True
    """
    shape, n = shape_of(plant), plant.n
    F = SymmetricMap(plant, riccati_map, "F")
    J = cp.Parameter((n + plant.l,) * 2, symmetric=True, name="J")
    weight = cp.Parameter(n * (n + 1) // 2, name="M")
    Z = cp.Variable((n + plant.l,) * 2, symmetric=True, name="Z")
    equation = F.adjoint(Z) + weight == 0
    problem = cp.Problem(cp.Minimize(cp.trace(J @ Z)), [Z >> 0, equation])

    def load(plant: Plant) -> bool:
        if shape_of(plant) != shape:
            return False
        F.load(plant)
        J.value, weight.value = joint_noise(plant), packed(2 * plant.M - np.diag(np.diag(plant.M)))
        return True

    def answer() -> tuple[Matrix, Matrix]:
        S, K = np.split(np.asarray(Z.value)[:n], [n], axis=1)
        return unpacked(np.asarray(equation.dual_value).ravel(), n), -np.linalg.solve(S, K)

    load(plant)
    return Program("multiplier of the adjoint Lyapunov equation", problem, answer, load, attainable=1e-10)
