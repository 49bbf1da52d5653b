"""The reduced program: the error covariance as a function of the gain alone, minimised by its exact gradient."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from derive.numeric.gain_descent import descend
from derive.numeric.gain_lyapunov import Lyapunov
from derive.numeric.gain_search import Found
from derive.numeric.lyapunov import error_covariance, solve_lyapunov
from derive.numeric.modes import Matrix, Time, distance_to_stability, spectral_scale

__all__ = ["ReducedCost", "free_cost", "solve_reduced", "stabilised"]

STEPS = 60
"""Largest number of steps of the homotopy."""

MARGIN = 1e-3
"""Distance from the boundary of stability at which a step of the homotopy starts, relative to the size of A."""

STALL = 1e-2
"""Part of the margin by which a step has to move the closed loop, lest the homotopy ends."""


@dataclass(frozen=True, eq=False)
class ReducedCost:
    """The cost tr(M P) of a gain L, with P from its Lyapunov or Stein equation, over the gain's free entries x (p,).

    Attributes:
        A: state matrix (n, n).
        C: output matrix (l, n).
        W: process noise (n, n).
        V: measurement noise (l, l).
        N: cross term (n, l).
        M: weight (n, n).
        time: "continuous" or "discrete".
        fixed: gain (n, l) whose entries hold where `free` does not.
        free: entries of L that vary (n, l), of type bool.
    """

    A: Matrix
    C: Matrix
    W: Matrix
    V: Matrix
    N: Matrix
    M: Matrix
    time: Time
    fixed: Matrix
    free: Any

    @cached_property
    def basis(self) -> Matrix:
        """The matrix (n l, p) that puts x into vec L."""
        return np.eye(self.free.size)[:, self.free.ravel(order="F")]

    def gain(self, x: Matrix) -> Matrix:
        """Return L (n, l)."""
        rest = np.where(self.free, 0.0, self.fixed).ravel(order="F")
        return (rest + self.basis @ x).reshape(self.free.shape, order="F")

    def entries(self, gain: Matrix) -> Matrix:
        """Return the free entries x (p,) of a matrix (n, l)."""
        return self.basis.T @ gain.ravel(order="F")

    def distance(self, x: Matrix) -> float:
        """Return the distance of the slowest mode of A - L C from the boundary of stability, negative inside."""
        if not np.isfinite(x).all():
            return np.inf
        modes = np.linalg.eigvals(self.A - self.gain(x) @ self.C)
        return float(np.max(distance_to_stability(modes, self.time)))

    def is_stable(self, x: Matrix) -> bool:
        """Tell whether A - L C is asymptotically stable."""
        return self.distance(x) < 0

    def covariance(self, gain: Matrix) -> Matrix:
        """Return P (n, n) of a stabilising gain."""
        return error_covariance(self.A, self.C, self.W, self.V, self.N, gain, self.time)

    def value(self, x: Matrix) -> float:
        """Return tr(M P), infinite for a gain that does not stabilise."""
        return float(np.trace(self.M @ self.covariance(self.gain(x)))) if self.is_stable(x) else np.inf

    def gradient(self, x: Matrix) -> Matrix:
        """Return the gradient (p,): the free entries of 2 S (L X - Y)."""
        L = self.gain(x)
        X, Y = self._innovation(self.covariance(L))
        return self.entries(2 * self._adjoint(L) @ (L @ X - Y))

    def metric(self, x: Matrix) -> tuple[Matrix]:
        """Return the second derivative 2 (X kron S) over the free entries (p, p), as if P did not change with L.

        It does not at the optimum of a gain that is free everywhere.
        """
        L = self.gain(x)
        X, _ = self._innovation(self.covariance(L))
        return (2 * self.basis.T @ np.kron(X, self._adjoint(L)) @ self.basis,)

    def expression(self, x: Any) -> tuple[Any, Any]:
        """Return tr(M P), P by a call of the Lyapunov equation's function, and that function."""
        A, C, W, V, N, M = (ca.DM(X) for X in (self.A, self.C, self.W, self.V, self.N, self.M))
        rest = np.where(self.free, 0.0, self.fixed).ravel(order="F")
        L = ca.reshape(ca.DM(rest) + ca.sparsify(ca.DM(self.basis)) @ x, *self.free.shape)
        lyapunov = Lyapunov(len(self.A), self.time)
        noise = W - L @ N.T - N @ L.T + L @ V @ L.T
        return ca.trace(M @ lyapunov(A - L @ C, noise)), lyapunov

    def _adjoint(self, gain: Matrix) -> Matrix:
        """Return S (n, n): (A - L C)'S + S (A - L C) + M = 0, discrete (A - L C)'S (A - L C) - S + M = 0."""
        return solve_lyapunov((self.A - gain @ self.C).T, self.M, self.time)

    def _innovation(self, P: Matrix) -> tuple[Matrix, Matrix]:
        """Return X = V and Y = P C' + N, in discrete time X = C P C' + V and Y = A P C' + N."""
        if self.time == "continuous":
            return self.V, P @ self.C.T + self.N
        return self.C @ P @ self.C.T + self.V, self.A @ P @ self.C.T + self.N


def solve_reduced(F: Matrix, C: Matrix, W: Matrix, gain: Matrix, time: Time) -> Found:
    """Minimise tr P over the gains K of a plant with V = I and no cross term, from a stabilising one.

    The arguments are those of `derive.numeric.gain_multiplier.solve_for_multiplier`. The program is not convex, but
    each of its stationary points is the optimum: there K = P C' makes P a solution of the Riccati equation that
    stabilises, which is the only one.
    """
    cost = free_cost(F, C, W, time)
    found = descend(cost, cost.entries(gain))
    return Found(cost.gain(found.x), tuple(map(cost.gain, found.points)), found.iterations)


def free_cost(F: Matrix, C: Matrix, W: Matrix, time: Time) -> ReducedCost:
    """Return the cost tr P of a plant with V = I and no cross term, over all entries of the gain."""
    one, zero = np.eye(len(F)), np.zeros((len(F), len(C)))
    return ReducedCost(F, C, W, np.eye(len(C)), zero, one, time, zero, np.ones(zero.shape, bool))


def stabilised(cost: ReducedCost, x: Matrix) -> Matrix:
    """Return the free entries (p,) of a stabilising gain, not a number when none was found.

    For a large enough the given gain stabilises A - a I, for r small enough r A with r C (discrete). Minimising tr P of
    that plant with W = I moves its closed loop inwards, which leaves room to decrease a, or to increase r, until a = 0,
    r = 1. A mode that the gain has begun to move is moved twice as far by the next step.
    """
    n = len(cost.A)
    regular = replace(cost, W=np.eye(n), N=np.zeros_like(cost.N), M=np.eye(n))
    margin, last = MARGIN * spectral_scale(cost.A, cost.time), np.inf
    for _ in range(STEPS):
        distance = cost.distance(x)
        if distance < 0:
            return x
        if not last - distance > STALL * margin:
            break
        last = distance
        x = descend(_relaxed(regular, distance + margin), x, rounds=1).x
    return np.full_like(x, np.nan)


def _relaxed(cost: ReducedCost, shift: float) -> ReducedCost:
    """Return the cost for A - a I, in discrete time for r A and r C, with modes moved inwards by the shift."""
    if cost.time == "continuous":
        return replace(cost, A=cost.A - shift * np.eye(len(cost.A)))
    r = 1 / (1 + shift)
    return replace(cost, A=r * cost.A, C=r * cost.C)
