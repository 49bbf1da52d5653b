"""The optimal gain as the one with the smallest bound of the H2 norm from noise to error.

The error e = xhat - x of an observer with gain L obeys de/dt = (A - L C) e - (G - L H) d for a white noise d of
intensity I with (w, v) = (G d, H d), [G; H] [G; H]' = [[W, N], [N', V]]. With X = P^-1, Y = X L and E E' = M,

    min tr(Z)  s.t.  [[Z, E'], [E, X]] >= 0  and
    continuous:  [[-(F + F'), B], [B', I]] >= 0
    discrete:    [[X, F, B], [F', X, 0], [B', 0, I]] >= 0
    where F = X A - Y C,  B = X G - Y H,

says that P is at least the error covariance of the gain L = X^-1 Y and tr(Z) >= tr(M P).

Requires: V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable, M >= 0. The minimum is attained when the optimal covariance
is positive definite; otherwise X grows without bound. (A, C) not detectable makes the program infeasible.

Source: C. Scherer, P. Gahinet and M. Chilali, Multiobjective output-feedback control via LMI optimization, IEEE Trans.
Automatic Control 42(7), 1997 (H2 performance, there in continuous time for a controller, here for an observer);
M. C. de Oliveira, J. C. Geromel and J. Bernussou, Extended H2 and H-infinity norm characterizations and controller
parametrizations for discrete-time systems, Int. J. Control 75(9), 2002 (discrete time).
"""

import cvxpy as cp
import numpy as np

from derive.numeric.plant import Plant
from lmi.programs.observer import Unknowns, factor
from lmi.programs.optimal_covariance import joint_noise
from lmi.programs.program import Matrix, Program, shape_of

__all__ = ["cost_bound", "factor", "gramian", "h2"]


def h2(plant: Plant) -> Program:
    """State the H2 synthesis program of an observer.

    Args:
        plant: A (n, n), C (l, n), W, V, N and the weight M.

    Returns:
        The program; its covariance is X^-1 (n, n), its gain X^-1 Y (n, l).

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> from lmi.solve import solve_program
        >>> plant = plant_from_mapping({"time": "continuous", "A": 0.0, "C": 1.0, "W": 4.0, "V": 1.0})
        >>> program = h2(plant)
        >>> solve_program(program).status.value
        'solved'
        >>> bool(abs(program.answer()[1][0, 0] - 2.0) < 1e-6)
        True
    """
    shape, sizes = shape_of(plant), (factor(joint_noise(plant)).shape, factor(plant.M).shape)
    A, C = cp.Parameter(plant.A.shape, name="A"), cp.Parameter(plant.C.shape, name="C")
    noise, E = (cp.Parameter(size, name=name) for size, name in zip(sizes, ("[G; H]", "E"), strict=True))
    X = cp.Variable(plant.A.shape, symmetric=True, name="X")
    Y = cp.Variable((plant.n, plant.l), name="Y")
    unknowns = Unknowns(plant, X, Y, X @ A - Y @ C, X @ noise[: plant.n] - Y @ noise[plant.n :])
    cost, bound = _factor_bound(X, E)
    problem = cp.Problem(cp.Minimize(cost), [*gramian(unknowns), *bound])

    def load(plant: Plant) -> bool:
        factors = factor(joint_noise(plant)), factor(plant.M)
        if shape_of(plant) != shape or (factors[0].shape, factors[1].shape) != sizes:
            return False
        A.value, C.value, noise.value, E.value = plant.A, plant.C, *factors
        return True

    load(plant)
    return Program("smallest H2 norm from noise to error", problem, unknowns.answer, load, attainable=5e-8)


def gramian(unknowns: Unknowns) -> list[cp.Constraint]:
    """Ask that X^-1 be at least the covariance that the gain X^-1 Y leaves."""
    F, X, B = unknowns.drift, unknowns.X, unknowns.noise
    one = np.eye(B.shape[1])
    if unknowns.plant.is_continuous:
        return [cp.bmat([[-(F + F.T), B], [B.T, one]]) >> 0]
    zero = np.zeros(B.shape)
    return [cp.bmat([[X, F, B], [F.T, X, zero], [B.T, zero.T, one]]) >> 0]


def cost_bound(unknowns: Unknowns, weight: Matrix) -> tuple[cp.Expression, list[cp.Constraint]]:
    """Return tr(Z) and the constraint that makes it at least tr(M X^-1) for a weight M (n, n)."""
    return _factor_bound(unknowns.X, factor(weight))


def _factor_bound(X: cp.Variable, E: Matrix | cp.Parameter) -> tuple[cp.Expression, list[cp.Constraint]]:
    """Return tr(Z) and the constraint Z >= E' X^-1 E."""
    Z = cp.Variable((E.shape[1], E.shape[1]), symmetric=True, name="Z")
    return cp.Expression.cast(cp.trace(Z)), [cp.bmat([[Z, E.T], [E, X]]) >> 0]
