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

from derive.numeric.plant import Plant
from lmi.programs.program import Matrix, Program
from lmi.residual import symmetric_part

__all__ = ["optimal_covariance", "riccati_inequality"]


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
    from lmi.residual import optimal_gain

    P = cp.Variable((plant.n, plant.n), symmetric=True, name="P")
    problem = cp.Problem(cp.Maximize(cp.trace(plant.M @ P)), [riccati_inequality(plant, P) >> 0])

    def answer() -> tuple[Matrix, Matrix]:
        value = symmetric_part(P.value)
        return value, optimal_gain(plant, value)

    return Program("largest covariance under the Riccati inequality", problem, answer)


def riccati_inequality(plant: Plant, P: cp.Expression) -> cp.Expression:
    """Return the matrix (n + l, n + l), affine in P, that the Riccati inequality asks to be positive semidefinite."""
    A, C = plant.A, plant.C
    if plant.is_continuous:
        state, cross, output = A @ P + P @ A.T, P @ C.T, 0.0
    else:
        state, cross, output = A @ P @ A.T - P, A @ P @ C.T, C @ P @ C.T
    return cp.bmat([[state + plant.W, cross + plant.N], [(cross + plant.N).T, output + plant.V]])
