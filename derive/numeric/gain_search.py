"""The search for a gain: a program is solved again and again, each time in the coordinates of the last answer."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.numeric.gain_frame import Frame
from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import Matrix, Time
from derive.numeric.stabilise import stabilising_gain

__all__ = ["ROUNDS", "Answer", "Found", "Method", "search"]

ROUNDS = 12
"""Restarts in the coordinates of the last answer."""

SETTLED = 1e-13
"""Relative decrease of the cost below which no restart follows."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a program returned for a plant with V = I and no cross term.

    Attributes:
        gain: K (n, l).
        gains: of the points on the way.
        iterations: of IPOPT.
        multiplier: of the program's equation (n, n), if it has one.
    """

    gain: Matrix
    gains: tuple[Matrix, ...]
    iterations: int
    multiplier: Matrix | None = None


Method = Callable[[Matrix, Matrix, Matrix, Matrix, Time], Found]
"""F, C, W, a stabilising gain, and the time."""


@dataclass(frozen=True, eq=False)
class Answer:
    """The best gain of a search, in the frame's original coordinates, in extended precision.

    Attributes:
        gain: K (n, l).
        P: its error covariance (n, n), not a number when there is no stabilising gain.
        stationarity: size of K - P C', in discrete time of K (C P C' + I) - F P C', over that of its terms, in the
            coordinates in which P is the identity.
        history: tr(G P) of the gains on the way, infinite for those that do not stabilise.
        iterations: of IPOPT, in all rounds.
        multiplier: of the last program's equation (n, n), if it has one.
    """

    gain: Matrix
    P: Matrix
    stationarity: float
    history: tuple[float, ...]
    iterations: int
    multiplier: Matrix | None


def search(frame: Frame, G: Matrix, method: Method, rounds: int = ROUNDS) -> Answer:
    """Solve a program from a stabilising gain until the cost settles.

    Args:
        frame: the plant.
        G: weight (n, n) of the history's entries, in the frame's original coordinates.
        method: the program.
        rounds: how many times it may be solved. Of several answers the best is kept; a single one is taken as it is.
    """
    K = _start(frame)
    P, multiplier = frame.covariance(K), None
    history, iterations = [float(np.trace(G @ P))], 0
    for _ in range(rounds):
        if not np.trace(P) > 0:
            break
        sharper = frame.sharpened(P)
        moved = sharper.R @ frame.T @ K
        covariance = sharper.covariance(moved)
        if not np.trace(covariance) > 0:
            break
        frame, K, P = sharper, moved, covariance
        found = method(*frame.matrices(), K.astype(float), frame.time)
        iterations, multiplier = iterations + found.iterations, found.multiplier
        costs = _costs(frame, G, found.gains[1:])
        history += costs
        gain, better = found.gain, frame.covariance(found.gain)
        if costs and rounds > 1 and not np.trace(better) < np.trace(P):
            gain = found.gains[1:][int(np.argmin(costs))]
            better = frame.covariance(gain)
        decrease = 1 - np.trace(better) / np.trace(P)
        if decrease > 0 or rounds == 1:
            K, P = gain, better
        if not decrease > SETTLED:
            break
    T, stationarity = frame.T, _stationarity(frame, K, P)
    original = None if multiplier is None else T @ multiplier @ T.T
    return Answer(T @ K, T @ P @ T.T, stationarity, tuple(history), iterations, original)


def _start(frame: Frame) -> Matrix:
    """Return a stabilising gain: by a linear equation, or by homotopy where that finds none."""
    from derive.numeric.gain_reduced import free_cost, stabilised

    F, C, W = frame.matrices()
    K = stabilising_gain(F, C, frame.time)
    if np.isfinite(K).all():
        return K
    cost = free_cost(F, C, W, frame.time)
    return cost.gain(stabilised(cost, np.zeros(K.size)))


def _stationarity(frame: Frame, K: Matrix, P: Matrix) -> float:
    """Return 0 where the gradient vanishes, at most 1."""
    F, C, _ = frame.matrices()
    P, K = P.astype(float), K.astype(float)
    first, second = (K, P @ C.T)
    if frame.time == "discrete":
        first, second = K @ (C @ P @ C.T + np.eye(len(C))), F @ P @ C.T
    size = np.linalg.norm(first) + np.linalg.norm(second)
    return float(np.linalg.norm(first - second) / size) if size else 0.0


def _costs(frame: Frame, G: Matrix, gains: tuple[Matrix, ...]) -> list[float]:
    """Return tr(G P) of gains, infinite for those that do not stabilise."""
    F, C, W = frame.matrices()
    V, N, weight = np.eye(len(C)), np.zeros((len(F), len(C))), (frame.T.T @ G @ frame.T).astype(float)
    costs = []
    with np.errstate(over="ignore", invalid="ignore"):
        for K in gains:
            stable = frame.is_stable(F - K @ C)
            costs.append(float(np.trace(weight @ error_covariance(F, C, W, V, N, K, frame.time))) if stable else np.inf)
    return costs
