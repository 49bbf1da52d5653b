"""The Riccati flow: where an error covariance goes in a given time, as one map that can be doubled."""

from dataclasses import dataclass

import numpy as np

from derive.numeric.modes import Matrix
from derive.numeric.normal import NormalForm

__all__ = ["Flow", "flow_over", "one_step"]


@dataclass(frozen=True, eq=False)
class Flow:
    """The map P -> H + E P (I + G P)^-1 E' of the optimal error covariance over a time.

    Attributes:
        E: transition matrix of the error (n, n) from P = 0.
        G: information gathered in that time (n, n).
        H: covariance reached from P = 0 (n, n).
    """

    E: Matrix
    G: Matrix
    H: Matrix

    def after(self, P: Matrix) -> Matrix:
        """Return the covariance that P leads to."""
        return self.H + _parallel(P, self.G, self.E)

    def doubled(self) -> "Flow":
        """Return the map over twice the time: E (I + H G)^-1 E, G + E'(I + G H)^-1 G E, H + E H (I + G H)^-1 E'.

        Source: B. D. O. Anderson, Second-order convergent algorithms for the steady-state Riccati equation, Int. J.
            Control 28 (1978) 295-306.
        """
        E = self.E @ np.linalg.solve(np.eye(len(self.E)) + self.H @ self.G, self.E)
        return Flow(E, self.G + _parallel(self.G, self.H, self.E.T), self.after(self.H))


def _parallel(P: Matrix, G: Matrix, E: Matrix) -> Matrix:
    """Return E (P^-1 + G)^-1 E' = E Y (I + Y'G Y)^-1 Y'E' with P = Y Y', a sum of squares for P, G >= 0."""
    variances, directions = np.linalg.eigh((P + P.T) / 2)
    root = directions * np.sqrt(np.maximum(variances, 0.0))
    sizes, axes = np.linalg.eigh(root.T @ G @ root)
    factor = E @ root @ axes / np.sqrt(1 + np.maximum(sizes, 0.0))
    return factor @ factor.T


def one_step(form: NormalForm) -> Flow:
    """Return the map of one time step of a discrete plant: E = F, G = C'C, H = W."""
    F, C, W = form.uncorrelated()
    return Flow(F, C.T @ C, W)


def flow_over(form: NormalForm, duration: float) -> Flow:
    """Return the map of a continuous plant over a duration [s].

    exp(h [[-F', C'C], [W, F]]) = [[a, b], [c, d]] gives E = a'^-1, G = a^-1 b, H = c a^-1 for a step h too short for
    the exponential to lose digits; the map is then doubled.
    """
    from scipy.linalg import expm

    F, C, W = form.uncorrelated()
    n = len(F)
    generator = np.block([[-F.T, C.T @ C], [W, F]])
    doublings = max(0, int(np.ceil(np.log2(max(np.linalg.norm(generator) * duration, 1.0)))))
    Phi = expm(generator * (duration / 2**doublings))
    inverse = np.linalg.inv(Phi[:n, :n])
    G, H = inverse @ Phi[:n, n:], Phi[n:, :n] @ inverse
    flow = Flow(inverse.T, (G + G.T) / 2, (H + H.T) / 2)
    for _ in range(doublings):
        flow = flow.doubled()
    return flow
