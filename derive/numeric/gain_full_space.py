"""The textbook's program in gain and covariance, which fails from a few states on; for teaching."""

import casadi as ca
import numpy as np

from derive.numeric.gain_ipopt import minimise, symmetric_basis
from derive.numeric.gain_search import Found
from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import Matrix, Time

__all__ = ["solve_full_space"]


def solve_full_space(F: Matrix, C: Matrix, W: Matrix, gain: Matrix, time: Time) -> Found:
    """Minimise tr P over gains K and symmetric P.

        min tr P  subject to  (F - K C) P + P (F - K C)' + W + K K' = 0

    in discrete time (F - K C) P (F - K C)' - P + W + K K' = 0. The equation says nothing about stability. Where
    F - K C is unstable it has a solution P too, which is not positive semidefinite and whose trace can be as far below
    zero as one likes: the program has no minimum, and the optimal gain is but a local one. The set of points that
    satisfy the equation falls apart where two modes of F - K C add up to zero; IPOPT's iterates, which satisfy it in
    the end only, step across and do not come back. A constraint P >= 0 does not help, as the iterates of an
    interior-point method satisfy the equation too late for it to mean stability. The number of such steps grows with
    that of the states: two states often go well, four seldom.

    The arguments are those of `derive.numeric.gain_multiplier.solve_for_multiplier`.
    """
    n, S = len(F), symmetric_basis(len(F))
    m = S.shape[1]
    x = ca.SX.sym("x", m + gain.size)
    P, K = ca.reshape(ca.DM(S) @ x[:m], n, n), ca.reshape(x[m:], *gain.shape)
    loop, noise = ca.DM(F) - K @ ca.DM(C), ca.DM(W) + K @ K.T
    E = (loop @ P + P @ loop.T if time == "continuous" else loop @ P @ loop.T - P) + noise
    first = error_covariance(F, C, W, np.eye(len(C)), np.zeros_like(gain), gain, time)
    start = np.concatenate([S.T @ first.ravel(order="F"), gain.ravel(order="F")])
    run = minimise({"x": x, "f": ca.trace(P), "g": ca.DM(S).T @ ca.vec(E)}, start, {"ipopt.max_cpu_time": 30.0})
    gains = tuple(point[m:].reshape(gain.shape, order="F") for point in run.points)
    return Found(run.x[m:].reshape(gain.shape, order="F"), gains, run.iterations)
