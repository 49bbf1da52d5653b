"""The optimal error covariance of a plant from any of the convex programs, in coordinates that suit the solver."""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from lmi.central_path import rough_covariance
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.program import Program
from lmi.residual import newton_error, riccati_residual
from lmi.scaling import Scaling, balanced, recentred, scaled_plant
from lmi.solve import FALLBACKS, TO_THE_LAST_DIGIT, Accuracy, Outcome, Status, solve_program

__all__ = ["Solution", "covariance_error", "solve_covariance"]

Matrix = NDArray[np.floating[Any]]

TRUSTED = 1e-7
"""Relative error above which the fallback solvers are asked."""

ROUGH = 0.5
"""Relative error below which an answer is good enough to choose better coordinates by."""

ROUGHLY = Accuracy(1e-6, 1e-7)
"""Enough to choose coordinates by."""

ATTEMPTS = (TO_THE_LAST_DIGIT, Accuracy(1e-12, 1e-7), Accuracy(1e-9, 1e-6))
"""Of Clarabel, in this order until an answer is as good as its program can be: to the last digit, then sturdier."""


@dataclass(frozen=True, eq=False)
class Solution:
    """An error covariance from a convex program, in the plant's units.

    Attributes:
        outcome: of the call of the solver that gave it, or of Clarabel's last one when none did.
        P: error covariance (n, n), or None.
        gain: observer gain (n, l), or None.
        error: what P lacks (n, n), estimated by Newton steps, or None when P belongs to no stabilising gain, or lacks
            more than half of itself.
        residual: of the Riccati equation at P, relative, in the coordinates of the solver.
        tried: the calls of solvers in the coordinates chosen, by solver and by what became of each.
        seconds: in all.
    """

    outcome: Outcome
    P: Matrix | None
    gain: Matrix | None
    error: Matrix | None
    residual: float
    tried: tuple[tuple[str, Status], ...]
    seconds: float

    @property
    def status(self) -> str:
        """What became of it, with the solver's name if it is not Clarabel."""
        said, solver = self.outcome.status.value, self.outcome.solver
        if solver == cp.CLARABEL:
            return said
        return f"{said}{',' if ':' in said else ':'} by {solver}, as CLARABEL did not reach {TRUSTED:.0e}"


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

    @property
    def rank(self) -> tuple[bool, float]:
        """By what answers are compared: first whether they solve their program, then the estimated error."""
        return self.outcome.status is not Status.SOLVED, self.distance

    @property
    def is_near(self) -> bool:
        """Whether the estimated error is small enough for the estimate to mean anything."""
        return self.distance <= ROUGH * max(self.size, 1.0)


def solve_covariance(plant: Plant, build: Callable[[Plant], Program]) -> Solution:
    """Solve a program for a plant's optimal error covariance, in coordinates that suit it.

    The plant is balanced, and a rough covariance from Lyapunov equations gives coordinates in which the optimal one is
    near the identity; where no stabilising gain is found that way, a rough answer of the cheapest program does. There
    the program is solved; if its answer is not yet as good as its form can be, again in the coordinates of that answer
    and with sturdier settings, then by other solvers (`lmi.solve.FALLBACKS`). Of the answers that solve the program, or
    else of all, the one with the smallest estimated error is returned. The Riccati equation is solved nowhere; it only
    judges.

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
    search = _Search(plant, build, balanced(plant))
    search.run()
    return search.solution(perf_counter() - start)


class _Search:
    """Calls of solvers for one plant and one program, compiled once, and the best answer so far."""

    def __init__(self, plant: Plant, build: Callable[[Plant], Program], common: Scaling):
        self.plant, self.build, self.common = plant, build, common
        self.program: Program | None = None
        self.best: _Answer | None = None
        self.last = Outcome(Status.FAILED, "not called")
        self.tried: list[tuple[str, Status]] = []

    def run(self) -> None:
        """Try solvers and coordinates until the answer is good, or there is nothing left to try."""
        coordinates = _coordinates(self.plant, self.common)
        for accuracy in ATTEMPTS:
            self.call(accuracy, coordinates)
            if self.program is not None and self.reached(self.program.attainable):
                return
            coordinates = self.improved(coordinates)
        if {status for _, status in self.tried} <= {Status.UNBOUNDED, Status.INFEASIBLE}:
            return
        for solver in FALLBACKS:
            if self.reached(TRUSTED):
                return
            if solver in cp.installed_solvers():
                self.call(ATTEMPTS[-1], coordinates, solver)

    def call(self, accuracy: Accuracy, scaling: Scaling, solver: str = cp.CLARABEL) -> None:
        """Call a solver once and keep its answer if it is the best so far."""
        scaled = scaled_plant(self.plant, scaling)
        if self.program is None or not self.program.load(scaled):
            self.program = self.build(scaled)
        outcome, answer = _called(self.program, scaled, accuracy, (scaling, self.common), solver)
        self.tried.append((solver, outcome.status))
        if solver == cp.CLARABEL:
            self.last = outcome
        if answer is not None and (self.best is None or answer.rank < self.best.rank):
            self.best = answer

    def reached(self, tolerance: float) -> bool:
        """Tell whether the best answer's estimated error is at most a relative tolerance."""
        return self.best is not None and self.best.distance <= tolerance * self.best.size

    def improved(self, coordinates: Scaling) -> Scaling:
        """Return coordinates in which the best answer so far is the identity, if it is good enough for that."""
        if self.best is None or not self.reached(ROUGH):
            return coordinates
        P = self.common.scaled_covariance(self.best.scaling.covariance(self.best.P))
        return recentred(self.plant, self.common, P, self.best.distance)

    def solution(self, seconds: float) -> Solution:
        """Return the best answer in the plant's units."""
        best, tried = self.best, tuple(self.tried)
        if best is None:
            return Solution(self.last, None, None, None, np.inf, tried, seconds)
        scaling = best.scaling
        error = scaling.covariance(best.error) if best.error is not None and best.is_near else None
        P, gain = scaling.covariance(best.P), scaling.gain(best.gain)
        return Solution(best.outcome, P, gain, error, best.residual, tried, seconds)


def covariance_error(plant: Plant, P: Matrix) -> Matrix | None:
    """Return what P (n, n) lacks to the optimal covariance, by Newton steps in the coordinates of P, or None."""
    common = balanced(plant)
    scaling = recentred(plant, common, common.scaled_covariance(P), 0.0)
    error = newton_error(scaled_plant(plant, scaling), scaling.scaled_covariance(P))
    return None if error is None else scaling.covariance(error)


def _coordinates(plant: Plant, common: Scaling) -> Scaling:
    """Return coordinates in which a rough covariance is the identity, or the balanced ones if there is none."""
    rough = rough_covariance(plant)
    if rough is not None:
        return recentred(plant, common, common.scaled_covariance(rough), 0.0)
    scaled = scaled_plant(plant, common)
    _, answer = _called(optimal_covariance(scaled), scaled, ROUGHLY, (common, common), cp.CLARABEL)
    if answer is None or answer.distance > ROUGH * answer.size:
        return common
    return recentred(plant, common, answer.P, answer.distance)


def _called(
    program: Program, scaled: Plant, accuracy: Accuracy, scalings: tuple[Scaling, Scaling], solver: str
) -> tuple[Outcome, _Answer | None]:
    """Solve once, the plant scaled by the first of two scalings; errors are measured in the second.

    The answer is None when the solver left no numbers, or X is singular.
    """
    outcome = solve_program(program, accuracy, solver)
    if outcome.optimality is None:
        return outcome, None
    try:
        P, gain = program.answer()
    except np.linalg.LinAlgError:
        return outcome, None
    scaling, common = scalings
    error = newton_error(scaled, P)
    back = np.linalg.solve(common.T, scaling.T)
    distance = np.inf if error is None else float(np.linalg.norm(back @ error @ back.T))
    size = float(np.linalg.norm(back @ P @ back.T))
    return outcome, _Answer(outcome, scaling, P, gain, error, riccati_residual(scaled, P), distance, size)
