"""Coordinates in which a plant's convex programs are well conditioned, chosen from the plant's data alone."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant

__all__ = ["Scaling", "balanced", "recentred", "scaled_plant"]

Matrix = NDArray[np.floating[Any]]

FLOOR_RTOL = 1e-8
"""Directions in which a covariance is smaller than this, relative, are not magnified further."""


@dataclass(frozen=True, eq=False)
class Scaling:
    """New coordinates x = T z, y = R q, and in continuous time t = s / rate.

    Covariance and gain return as P = T P_z T' and L = sqrt(rate) T L_z R^-1 (rate = 1 in discrete time).

    Attributes:
        T: states (n, n), invertible.
        R: outputs (l, l), lower triangular, R R' = V, in discrete time V + C P C' for an approximate P.
        rate: [1/s], a power of two.
    """

    T: Matrix
    R: Matrix
    rate: float

    def covariance(self, P_z: Matrix) -> Matrix:
        """Return P = T P_z T' (n, n) in the plant's units."""
        P = self.T @ P_z @ self.T.T
        return (P + P.T) / 2

    def scaled_covariance(self, P: Matrix) -> Matrix:
        """Return P_z = T^-1 P T^-T (n, n), the inverse of `covariance`."""
        P_z = np.linalg.solve(self.T, np.linalg.solve(self.T, P).T)
        return (P_z + P_z.T) / 2

    def gain(self, L_z: Matrix) -> Matrix:
        """Return L = sqrt(rate) T L_z R^-1 (n, l) in the plant's units."""
        return np.sqrt(self.rate) * np.linalg.solve(self.R.T, (self.T @ L_z).T).T


def balanced(plant: Plant) -> Scaling:
    """Balance the states, whiten the outputs, and measure time in units of the fastest rate.

    The outputs' noise becomes the identity, in discrete time that of the innovation for P = W. T is a diagonal of
    powers of two that balances [[A, W], [C'C, -A']] under diag(T, T^-1), so that the answer does not depend on the
    units of states, outputs and time. No Riccati equation is solved.

    Args:
        plant: with V > 0.

    Returns:
        Coordinates in which the entries of A, W, C'C are of comparable size.

    Source: P. Benner, Symplectic balancing of Hamiltonian matrices, SIAM J. Sci. Comput. 22(5), 2001 (the idea).
    """
    from scipy.linalg import matrix_balance

    R = _output_root(plant, plant.W)
    C = np.linalg.solve(R, plant.C)
    hamiltonian = np.block([[plant.A, plant.W], [C.T @ C, -plant.A.T]])
    np.fill_diagonal(hamiltonian, 0.0)
    with np.errstate(invalid="ignore"):  # SciPy also casts the sizes to integers, for a permutation not asked for
        _, (sizes, _) = matrix_balance(hamiltonian, permute=False, separate=True)
    exponents = np.round((np.log2(sizes[: plant.n]) - np.log2(sizes[plant.n :])) / 2)
    scaling = Scaling(np.diag(2.0**exponents), R, 1.0)
    return replace(scaling, rate=_rate(scaled_plant(plant, scaling)))


def recentred(plant: Plant, scaling: Scaling, P_z: Matrix, uncertainty: float) -> Scaling:
    """Return coordinates in which a covariance known so far becomes the identity.

    Args:
        plant: the plant.
        scaling: the coordinates of P_z.
        P_z: an approximate covariance (n, n).
        uncertainty: its error; directions in which P_z is smaller are not magnified.
    """
    sizes, directions = np.linalg.eigh(P_z)
    floor = max(FLOOR_RTOL * sizes[-1], uncertainty)
    if not floor > 0:
        return scaling
    T = scaling.T @ directions * np.sqrt(np.maximum(sizes, floor))
    return replace(scaling, T=T, R=_output_root(plant, T @ T.T))


def scaled_plant(plant: Plant, scaling: Scaling) -> Plant:
    """Return the plant in the coordinates z, q, s, with weight M = I.

    The covariance sought is the greatest (smallest) one in the order of symmetric matrices, so that every positive
    definite weight has the same answer; the identity of well-chosen coordinates is the best conditioned.
    """
    T, R, rate = scaling.T, scaling.R, scaling.rate
    W = np.linalg.solve(T, np.linalg.solve(T, plant.W).T) / rate
    V = np.linalg.solve(R, np.linalg.solve(R, plant.V).T)
    return replace(
        plant,
        A=np.linalg.solve(T, plant.A @ T) / rate,
        C=np.linalg.solve(R, plant.C @ T) / np.sqrt(rate),
        W=(W + W.T) / 2,
        V=(V + V.T) / 2,
        N=np.linalg.solve(T, np.linalg.solve(R, plant.N.T).T) / np.sqrt(rate),
        M=np.eye(plant.n),
    )


def _output_root(plant: Plant, P: Matrix) -> Matrix:
    """Return the Cholesky factor of V, in discrete time of V + C P C'."""
    return np.linalg.cholesky(plant.V if plant.is_continuous else plant.V + plant.C @ P @ plant.C.T)


def _rate(plant: Plant) -> float:
    """Return the power of two nearest the largest of |A|, |W|, |C|^2, in discrete time 1."""
    if not plant.is_continuous:
        return 1.0
    fastest = max(np.linalg.norm(plant.A, 2), np.linalg.norm(plant.W, 2), np.linalg.norm(plant.C, 2) ** 2)
    return float(2.0 ** np.round(np.log2(fastest))) if fastest > 0 else 1.0
