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
from lmi.programs.program import Matrix, Program

__all__ = ["factor", "h2"]

RANK_RTOL = 1e-14
"""Eigenvalues of a covariance below this, relative to the largest, are rounding errors of a zero."""


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
    n, l = plant.n, plant.l  # noqa: E741 (the field's letter for the number of outputs)
    E = factor(plant.M)
    X = cp.Variable((n, n), symmetric=True, name="X")
    Y = cp.Variable((n, l), name="Y")
    Z = cp.Variable((E.shape[1], E.shape[1]), symmetric=True, name="Z")
    bound = cp.bmat([[Z, E.T], [E, X]])
    problem = cp.Problem(cp.Minimize(cp.trace(Z)), [_gramian_inequality(plant, X, Y) >> 0, bound >> 0])

    def answer() -> tuple[Matrix, Matrix]:
        inverse = np.linalg.inv(np.asarray(X.value))
        return (inverse + inverse.T) / 2, inverse @ np.asarray(Y.value)

    return Program("smallest H2 norm from noise to error", problem, answer)


def factor(covariance: Matrix) -> Matrix:
    """Return G (n, rank) with G G' = covariance >= 0."""
    sizes, directions = np.linalg.eigh(covariance)
    kept = sizes > RANK_RTOL * max(sizes[-1], np.finfo(float).tiny)
    kept[-1] = True
    return directions[:, kept] * np.sqrt(np.maximum(sizes[kept], 0.0))


def _gramian_inequality(plant: Plant, X: cp.Variable, Y: cp.Variable) -> cp.Expression:
    """Return the matrix that is >= 0 when X^-1 is at least the covariance that the gain X^-1 Y leaves."""
    noise = factor(np.block([[plant.W, plant.N], [plant.N.T, plant.V]]))
    G, H = noise[: plant.n], noise[plant.n :]
    F, B, identity = X @ plant.A - Y @ plant.C, X @ G - Y @ H, np.eye(noise.shape[1])
    if plant.is_continuous:
        return cp.bmat([[-(F + F.T), B], [B.T, identity]])
    zero = np.zeros((plant.n, noise.shape[1]))
    return cp.bmat([[X, F, B], [F.T, X, zero], [B.T, zero.T, identity]])
