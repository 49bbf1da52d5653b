"""The normal form of a plant: unit measurement noise and balanced states, with and without its cross term."""

from dataclasses import dataclass, replace

import numpy as np

from derive.numeric.boundary import Boundary, unexcited_boundary
from derive.numeric.extended import cholesky, forward
from derive.numeric.modes import Matrix, Time, balancing
from derive.numeric.plant import Plant

__all__ = ["NormalForm", "normal_form", "plant_gain"]


@dataclass(frozen=True, eq=False)
class NormalForm:
    """A plant with V = I and scaled states, in extended precision.

    Attributes:
        A: state matrix (n, n).
        C: output matrix (l, n), V^(-1/2) times the original one.
        W: process noise (n, n).
        N: cross term (n, l).
        time: "continuous" or "discrete".
        scaling: powers of two t (n,) with x = t x_scaled, so that P = t P_scaled t'.
    """

    A: Matrix
    C: Matrix
    W: Matrix
    N: Matrix
    time: Time
    scaling: Matrix

    def uncorrelated(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return F = A - N C, C and W - N N' in double precision: the plant without cross term that has the same P.

        The observer x' = A x + L (y - C x) with L = K + N has the error of F under the gain K, driven by process noise
        of intensity W - N N' that is uncorrelated with v.
        """
        F, W = self.A - self.N @ self.C, self.W - self.N @ self.N.T
        return F.astype(float), self.C.astype(float), W.astype(float)

    def scaled(self, P: Matrix) -> Matrix:
        """Return the covariance of the scaled states."""
        return P / np.outer(self.scaling, self.scaling)

    def unscaled(self, P: Matrix) -> Matrix:
        """Return the covariance of the original states."""
        return P * np.outer(self.scaling, self.scaling)

    def boundary(self, slack: float = 1.0) -> Boundary:
        """Find the boundary modes of F that the noise does not excite; see `unexcited_boundary`."""
        F, _, W = self.uncorrelated()
        rate, noise = np.linalg.norm(self.A.astype(float), 2), np.abs(self.W) + np.abs(self.N) @ np.abs(self.N.T)
        return unexcited_boundary(F, W, self.time, float(rate), noise.astype(float), slack)

    def without(self, boundary: Boundary) -> "NormalForm":
        """Return the form that is left when the boundary's subspace is removed."""
        if len(boundary.modes) == 0:
            return self
        U = boundary.kept
        return replace(self, A=U.T @ self.A @ U, C=self.C @ U, W=U.T @ self.W @ U, N=U.T @ self.N)


def normal_form(plant: Plant) -> NormalForm:
    """Make V the identity and balance the states."""
    A, C, W, V, N = (X.astype(np.longdouble) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    root = cholesky(V)
    C, N = forward(root, C), forward(root, N.T).T
    t = _balancing(A - N @ C, C, W - N @ N.T)
    return NormalForm(A / t[:, None] * t, C * t, W / np.outer(t, t), N / t[:, None], plant.time, t)


def plant_gain(plant: Plant, form: NormalForm, K: Matrix) -> Matrix:
    """Return the gain L = t K V^(-1/2) + N V^-1 (n, l) of the plant for a gain K of its normal form."""
    root = cholesky(plant.V.astype(np.longdouble))
    scaled = form.scaling[:, None] * K + forward(root, plant.N.T.astype(np.longdouble)).T
    return forward(root[::-1, ::-1].T, scaled.T[::-1])[::-1].T.astype(float)


def _balancing(F: Matrix, C: Matrix, W: Matrix) -> Matrix:
    """Return powers of two t, x = t x_scaled, that balance the Hamiltonian matrix [[F', C'C], [W, F]]."""
    n = len(F)
    hamiltonian = np.abs(np.block([[F.T, C.T @ C], [W, F]]).astype(float))
    np.fill_diagonal(hamiltonian, 0.0)
    s = balancing(hamiltonian)
    return np.exp2(np.round((np.log2(s[n:]) - np.log2(s[:n])) / 2))
