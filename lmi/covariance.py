"""The optimal error covariance of a plant from any of the convex programs, in coordinates that suit the solver."""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.program import Program
from lmi.residual import newton_error, riccati_residual
from lmi.scaling import Scaling, balanced, recentred, scaled_plant
from lmi.solve import TO_THE_LAST_DIGIT, Accuracy, Outcome, Status, solve_program

__all__ = ["Solution", "covariance_error", "solve_covariance"]

Matrix = NDArray[np.floating[Any]]

GOOD = 1e-8
"""Relative error below which no further attempt is made to improve an answer."""

ROUGH = 0.5
"""Relative error below which an answer is good enough to choose better coordinates by."""

ROUGHLY = Accuracy(1e-6, 1e-7)
"""Enough to choose coordinates by."""

ATTEMPTS = (TO_THE_LAST_DIGIT, Accuracy(1e-12, 1e-7), Accuracy(1e-9, 1e-6))
"""Tried in this order until an answer is `GOOD`: to the last digit, then sturdier."""


@dataclass(frozen=True, eq=False)
class Solution:
    """An error covariance from a convex program, in the plant's units.

    Attributes:
        outcome: of the call of the solver that gave it, or of the last one when none did.
        P: error covariance (n, n), or None.
        gain: observer gain (n, l), or None.
        error: what P lacks (n, n), estimated by Newton steps, or None when P belongs to no stabilising gain.
        residual: of the Riccati equation at P, relative, in the coordinates of the solver.
        attempts: calls of the solver in the coordinates chosen.
        seconds: in all.
    """

    outcome: Outcome
    P: Matrix | None
    gain: Matrix | None
    error: Matrix | None
    residual: float
    attempts: int
    seconds: float


@dataclass(frozen=True, eq=False)
class _Answer:
    """An answer in the coordinates in which it was computed.

    Attributes:
        error: what P lacks, estimated by Newton steps, or None.
        distance: norm of that error in the balanced coordinates common to all attempts, infinite without one.
        size: norm of P there.
    """

    outcome: Outcome
    scaling: Scaling
    P: Matrix
    gain: Matrix
    error: Matrix | None
    residual: float
    distance: float
    size: float


def solve_covariance(plant: Plant, build: Callable[[Plant], Program]) -> Solution:
    """Solve a program for a plant's optimal error covariance, in coordinates that suit it.

    The plant is balanced; a rough answer of the cheapest program gives coordinates in which the covariance is near the
    identity; there the program is solved, and again with sturdier settings if need be. The answer with the smallest
    estimated error is returned. The Riccati equation is solved nowhere; it only judges.

    Args:
        plant: V > 0, (A, C) detectable.
        build: states the program for a plant, for example `lmi.programs.h2.h2`.

    Returns:
        The solution, its residuals recomputed from the numbers returned.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> from lmi.programs.h2 import h2
        >>> solution = solve_covariance(example_plant(), h2)
        >>> solution.outcome.status.value, solution.residual < 1e-6
        ('solved', True)
    """
    start = perf_counter()
    common = balanced(plant)
    coordinates = _coordinates(plant, common)
    best: _Answer | None = None
    outcome, attempts = Outcome(Status.FAILED, "not called"), 0
    for accuracy in ATTEMPTS:
        attempts += 1
        outcome, answer = _attempt(plant, build, accuracy, coordinates, common)
        if answer is not None and (best is None or answer.distance < best.distance):
            best = answer
        if best is not None and best.distance <= GOOD * best.size:
            break
    return _solution(best, outcome, attempts, perf_counter() - start)


def covariance_error(plant: Plant, P: Matrix) -> Matrix | None:
    """Return what P (n, n) lacks to the optimal covariance, by Newton steps in the coordinates of P, or None."""
    common = balanced(plant)
    scaling = recentred(plant, common, common.scaled_covariance(P), 0.0)
    error = newton_error(scaled_plant(plant, scaling), scaling.scaled_covariance(P))
    return None if error is None else scaling.covariance(error)


def _coordinates(plant: Plant, common: Scaling) -> Scaling:
    """Return coordinates in which a rough largest covariance is the identity, or the balanced ones if that failed."""
    _, rough = _attempt(plant, optimal_covariance, ROUGHLY, common, common)
    if rough is None or rough.distance > ROUGH * rough.size:
        return common
    return recentred(plant, common, rough.P, rough.distance)


def _attempt(
    plant: Plant, build: Callable[[Plant], Program], accuracy: Accuracy, scaling: Scaling, common: Scaling
) -> tuple[Outcome, _Answer | None]:
    """Solve once in given coordinates; the answer is None when the solver left no numbers, or X is singular."""
    scaled = scaled_plant(plant, scaling)
    program = build(scaled)
    outcome = solve_program(program, accuracy)
    if outcome.status not in (Status.SOLVED, Status.INACCURATE):
        return outcome, None
    try:
        P, gain = program.answer()
    except np.linalg.LinAlgError:
        return outcome, None
    error = newton_error(scaled, P)
    back = np.linalg.solve(common.T, scaling.T)
    distance = np.inf if error is None else float(np.linalg.norm(back @ error @ back.T))
    size = float(np.linalg.norm(back @ P @ back.T))
    return outcome, _Answer(outcome, scaling, P, gain, error, riccati_residual(scaled, P), distance, size)


def _solution(best: _Answer | None, last: Outcome, attempts: int, seconds: float) -> Solution:
    if best is None:
        return Solution(last, None, None, None, np.inf, attempts, seconds)
    scaling = best.scaling
    return Solution(
        outcome=best.outcome,
        P=scaling.covariance(best.P),
        gain=scaling.gain(best.gain),
        error=None if best.error is None else scaling.covariance(best.error),
        residual=best.residual,
        attempts=attempts,
        seconds=seconds,
    )
