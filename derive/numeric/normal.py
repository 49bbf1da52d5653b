"""The normal form of a plant: unit measurement noise, no cross term, balanced states. P in it is P scaled, no more."""

from dataclasses import dataclass, replace

import numpy as np

from derive.numeric.boundary import Boundary, unexcited_boundary
from derive.numeric.extended import cholesky, forward
from derive.numeric.modes import Matrix, Time
from derive.numeric.plant import Plant

__all__ = ["NormalForm", "normal_form"]


@dataclass(frozen=True, eq=False)
class NormalForm:
    """A plant with V = I and N = 0, whose Riccati equation has the solution of the original one, scaled.

    Continuous: F P + P F' + W - P C'C P = 0. Discrete: F P F' - P + W - F P C' (C P C' + I)^-1 C P F' = 0.

    Attributes:
        F: A - N V^-1 C (n, n), scaled, in extended precision like C and W.
        C: V^(-1/2) C (l, n), scaled.
        W: W - N V^-1 N' (n, n), scaled.
        time: "continuous" or "discrete".
        scaling: powers of two t (n,) with x = t x_scaled, so that P = t P_scaled t'.
        noise_size: Frobenius norm of the scaled W before the cross term went, to which rounding in W is relative.
    """

    F: Matrix
    C: Matrix
    W: Matrix
    time: Time
    scaling: Matrix
    noise_size: float

    def double(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return F, C, W in double precision."""
        return self.F.astype(float), self.C.astype(float), self.W.astype(float)

    def unscaled(self, P: Matrix) -> Matrix:
        """Return the covariance of the original states."""
        return P * np.outer(self.scaling, self.scaling)

    def boundary(self, slack: float = 1.0) -> Boundary:
        """Find the boundary modes that the noise does not excite; see `unexcited_boundary`."""
        F, _, W = self.double()
        return unexcited_boundary(F, W, self.time, self.noise_size, slack)

    def without(self, boundary: Boundary) -> "NormalForm":
        """Return the form that is left when the boundary's subspace is removed."""
        if len(boundary.modes) == 0:
            return self
        U = boundary.kept
        return replace(self, F=U.T @ self.F @ U, C=self.C @ U, W=U.T @ self.W @ U)


def normal_form(plant: Plant) -> NormalForm:
    """Remove the cross term, make V the identity and balance the states.

    The observer x' = A x + L (y - C x) with L = K + N V^-1 has the error of F = A - N V^-1 C under the gain K, driven
    by noise of intensity W - N V^-1 N' that is uncorrelated with v.
    """
    A, C, W, V, N = (X.astype(np.longdouble) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    root = cholesky(V)
    C, N = forward(root, C), forward(root, N.T).T
    F, rest = A - N @ C, W - N @ N.T
    t = _balancing(F, C, rest)
    scales = np.outer(t, t)
    size = float(np.linalg.norm((W / scales).astype(float)))
    return NormalForm(F / t[:, None] * t, C * t, rest / scales, plant.time, t, size)


def _balancing(F: Matrix, C: Matrix, W: Matrix) -> Matrix:
    """Return powers of two t, x = t x_scaled, that balance the Hamiltonian matrix [[F', C'C], [W, F]]."""
    from scipy.linalg import matrix_balance

    n = len(F)
    hamiltonian = np.abs(np.block([[F.T, C.T @ C], [W, F]]).astype(float))
    np.fill_diagonal(hamiltonian, 0.0)
    _, (s, _) = matrix_balance(hamiltonian, separate=True, permute=False)
    return np.exp2(np.round((np.log2(s[n:]) - np.log2(s[:n])) / 2))
