"""Coordinates for a search among gains: those in which the covariance of the last gain is the identity."""

from dataclasses import dataclass

import numpy as np

from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability
from derive.numeric.normal import NormalForm

__all__ = ["Frame"]

FLOOR = 1e-6
"""Variance, relative to the largest one, that new coordinates take a state to have at least."""

CORRECTIONS = 4
"""Corrections of a covariance by its residual in extended precision."""


@dataclass(frozen=True, eq=False)
class Frame:
    """The plant of a normal form (V = I, no cross term) in coordinates x = T z, in extended precision.

    Where variances span many orders of magnitude the Riccati equation is ill-conditioned in x and well-conditioned
    in z: T^-1 F T has moderate entries left after cancellation, which extended precision pays for.

    Attributes:
        F: A - N C (n, n).
        C: output matrix (l, n).
        W: process noise W - N N' (n, n).
        time: "continuous" or "discrete".
        T: coordinates (n, n), z the new ones.
        R: T^-1.
    """

    F: Matrix
    C: Matrix
    W: Matrix
    time: Time
    T: Matrix
    R: Matrix

    @classmethod
    def of(cls, form: NormalForm) -> "Frame":
        """Return the frame of the normal form's own coordinates."""
        one = np.eye(len(form.A), dtype=np.longdouble)
        F, W = form.A - form.N @ form.C, form.W - form.N @ form.N.T
        return cls(F, form.C, W, form.time, one, one)

    def matrices(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return T^-1 F T, C T and T^-1 W T^-T in double precision."""
        W = self.R @ self.W @ self.R.T
        return (self.R @ self.F @ self.T).astype(float), (self.C @ self.T).astype(float), ((W + W.T) / 2).astype(float)

    def covariance(self, gain: Matrix) -> Matrix:
        """Return the error covariance of a gain (n, l), both in z; not a number when the gain does not stabilise.

        Its residual is taken in extended precision, and a correction kept only when the residual falls.
        """
        nowhere = np.full(self.F.shape, np.nan)
        if not np.isfinite(gain.astype(float)).all():
            return nowhere
        F, C, W = self.R @ self.F @ self.T, self.C @ self.T, self.R @ self.W @ self.R.T
        K = gain.astype(np.longdouble)
        loop, noise = F - K @ C, W + K @ K.T
        if not self.is_stable(loop.astype(float)):
            return nowhere
        P, residual, size = np.zeros_like(F), noise, np.inf
        for _ in range(CORRECTIONS):
            if not np.abs(residual).max(initial=0) < size / 2:
                break
            best, size = P, np.abs(residual).max(initial=0)
            P = P + solve_lyapunov(loop.astype(float), residual.astype(float), self.time)
            if not np.isfinite(P).all():
                return nowhere
            moved = loop @ P + P @ loop.T if self.time == "continuous" else loop @ P @ loop.T - P
            residual = moved + noise
        return best if np.abs(residual).max(initial=0) > size else P

    def is_stable(self, loop: Matrix) -> bool:
        """Tell whether F - K C is asymptotically stable."""
        if not np.isfinite(loop).all():
            return False
        return bool(np.all(distance_to_stability(np.linalg.eigvals(loop), self.time) < 0))

    def sharpened(self, P: Matrix) -> "Frame":
        """Return the coordinates in which the covariance P of z is the identity, but for the floor."""
        variances, directions = np.linalg.eigh(P.astype(float))
        deviations = np.sqrt(np.maximum(variances, FLOOR * variances.max()))
        T = self.T @ (directions * deviations)
        R = (directions / deviations).T @ self.R
        for _ in range(2):  # the directions are orthogonal to double precision only
            R = R + (np.eye(len(R)) - R @ T) @ R
        return Frame(self.F, self.C, self.W, self.time, T, R)
