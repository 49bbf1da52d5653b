"""Observer gains from convex programs, in coordinates that suit the solver; what they achieve is judged elsewhere."""

from dataclasses import dataclass, replace
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from lmi.covariance import solve_covariance
from lmi.programs.decay import decay as decaying
from lmi.programs.h2 import cost_bound, gramian
from lmi.programs.hinf import hinf
from lmi.programs.observer import Specification, Unknowns
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.programs.program import Program
from lmi.residual import gain_covariance, optimal_gain
from lmi.scaling import Scaling, balanced, recentred, scaled_plant
from lmi.solve import Accuracy, Outcome, Status, solve_program
from lmi.synthesis.riccati import central_gain, smallest_level
from lmi.synthesis.shift import radius_of, shifted

__all__ = ["COORDINATES", "Synthesis", "optimal_h2_gain"]

Matrix = NDArray[np.floating[Any]]

ATTEMPTS = (Accuracy(1e-9, 1e-8), Accuracy(1e-8, 1e-6))
"""Tried in this order until the numbers returned solve the program."""

COORDINATES = ((1e-4, 1e4), (1e-4, 1e2), (0.0, 4.0))
"""Ways to choose coordinates, tried in this order: noise that is added, relative to the states' size, so that every
state has a covariance to be measured by; and the bound of X there, without which X has no limit where the noise leaves
a stable mode alone."""

ANSWERED = (Status.SOLVED, Status.INACCURATE)

SLACK = 1e-6
"""The decay that a program is asked for exceeds the one wanted by this, relative, for its rounding errors."""

LIGHT = 1e-6
"""Weight of states that the cost does not see, relative to those that it does, so that their gain is determined."""

EXCITED = (1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
"""Noise added, relative to the states' size, where the optimal gain leaves modes on the boundary of stability."""

GENERAL = 20
"""States up to which a general solver solves the covariance program."""

NEWTON_STEPS = 6


@dataclass(frozen=True, eq=False)
class Synthesis:
    """A plant in coordinates in which its optimal covariance is about the identity, and what is asked of a gain.

    Attributes:
        plant: in these coordinates, its weight of norm 1.
        scaling: the coordinates.
        unit: an H-infinity norm of 1 in these coordinates is this much in the plant's.
        widest: bound of X.
        specifications: of the decay, or none.
    """

    plant: Plant
    scaling: Scaling
    unit: float
    widest: float
    specifications: tuple[Specification, ...]

    @classmethod
    def of(cls, plant: Plant, decay: float | None, faint: float | None, widest: float) -> "Synthesis":
        """Choose the coordinates.

        Args:
            plant: V > 0, (A, C) detectable.
            decay: rate [1/s] at which every mode has to fall, in discrete time [1/step] without dt, or None.
            faint: noise added for choosing them, relative to the states' size; None for balancing only.
            widest: bound of X in them.
        """
        common = balanced(plant)
        scaling = common if faint is None else _centred(shifted(plant, decay), common, faint)
        M = scaling.T.T @ plant.M @ scaling.T
        size = float(np.linalg.norm(M, 2)) or 1.0
        scaled = replace(scaled_plant(plant, scaling), M=(M + M.T) / (2 * size))
        asked = () if decay is None else (decaying(_scaled_decay(plant, scaling, decay)),)
        return cls(scaled, scaling, float(np.sqrt(size / scaling.rate)), widest, asked)

    def smallest_level(self) -> float | None:
        """Minimise the bound of the H-infinity norm, which some gain can only approach; None without an answer."""
        unknowns, level = Unknowns.of(self.plant), cp.Variable(name="gamma^2")
        program = self._program("smallest H-infinity norm", unknowns, level, hinf(level)(unknowns))
        if _solved(program).status not in ANSWERED or level.value is None:
            return None
        return self.unit * float(np.sqrt(max(float(level.value), 0.0)))

    def gain_within(self, gamma: float) -> Matrix | None:
        """Return a gain whose H-infinity norm the program bounds by gamma, with a small bound X^-1 of the covariance.

        Without a decay that is the central gain: there is then a greatest X, in the order of symmetric matrices, and
        the greatest tr(X) finds it more accurately than the smallest tr(X^-1) does.
        """
        unknowns = Unknowns.of(self.plant)
        constraints = hinf((gamma / self.unit) ** 2)(unknowns)
        if not self.specifications:
            return self._gain(self._program("central gain", unknowns, cp.trace(-unknowns.X), constraints))
        size, bound = cost_bound(unknowns, np.eye(self.plant.n))
        return self._gain(self._program("small covariance", unknowns, size, [*constraints, *bound]))

    def central_gain(self, gamma: float) -> Matrix | None:
        """Return the central gain by its Riccati equation; None where there is none. No decay is looked at."""
        gain = central_gain(self.plant, gamma / self.unit)
        return None if gain is None else self.scaling.gain(gain)

    def central_level(self, reached: float) -> float | None:
        """Return the smallest norm by the Riccati equation, below one that is reached; None where it has none."""
        level = smallest_level(self.plant, reached / self.unit)
        return None if level is None else self.unit * level

    def cheapest_gain(self) -> Matrix | None:
        """Return the gain with the smallest bound of tr(M P)."""
        unknowns = Unknowns.of(self.plant)
        weight = self.plant.M + LIGHT * np.eye(self.plant.n)
        cost, bound = cost_bound(unknowns, weight)
        return self._gain(self._program("smallest cost", unknowns, cost, [*gramian(unknowns), *bound]))

    def _program(self, name: str, unknowns: Unknowns, objective: Any, constraints: list[cp.Constraint]) -> Program:
        """Return the program with what every gain has to satisfy."""
        bounds = [unknowns.X >> 0, self.widest * np.eye(self.plant.n) - unknowns.X >> 0]
        asked = [constraint for specification in self.specifications for constraint in specification(unknowns)]
        problem = cp.Problem(cp.Minimize(objective), [*bounds, *constraints, *asked])
        return Program(name, problem, unknowns.answer)

    def _gain(self, program: Program) -> Matrix | None:
        """Return the program's gain in the plant's units, or None without one."""
        if _solved(program).status not in ANSWERED:
            return None
        try:
            gain = self.scaling.gain(program.answer()[1])
        except np.linalg.LinAlgError:
            return None
        return gain if np.isfinite(gain).all() else None


def _centred(plant: Plant, common: Scaling, faint: float) -> Scaling:
    """Return coordinates in which the optimal covariance with a little more noise is the identity."""
    scaled = scaled_plant(plant, common)
    known = solve_riccati(replace(scaled, W=scaled.W + faint * np.eye(plant.n)))
    return common if known.status == "failed" else recentred(plant, common, known.P, 0.0)


def _scaled_decay(plant: Plant, scaling: Scaling, decay: float) -> float:
    """Return the rate in the coordinates' unit of time, in discrete time the radius, a little stricter than asked."""
    if plant.is_continuous:
        return decay * (1 + SLACK) / scaling.rate
    return radius_of(plant, decay) * (1 - SLACK)


def _solved(program: Program) -> Outcome:
    """Solve a program to the best of the attempts."""
    outcome = Outcome(Status.FAILED, "not called")
    for accuracy in ATTEMPTS:
        outcome = solve_program(program, accuracy)
        if outcome.status in (Status.SOLVED, Status.INFEASIBLE):
            break
    return outcome


def optimal_h2_gain(plant: Plant) -> Matrix | None:
    """Return the gain with the least covariance: the dual program's, improved by Newton steps.

    Where that gain leaves modes on the boundary of stability, no stabilising gain is optimal; the one for a little more
    noise is returned.

    Args:
        plant: V > 0, (A, C) detectable.
    """
    common = balanced(plant)
    scaled = scaled_plant(plant, common)
    gain = _program_gain(scaled)
    gain = None if gain is None else _improved(scaled, gain)
    if gain is None:
        excited = (solve_riccati(replace(scaled, W=scaled.W + size * np.eye(plant.n))) for size in EXCITED)
        near = (solution.gain for solution in excited if solution.status == "stabilising")
        gain = next((gain for gain in near if gain_covariance(scaled, gain) is not None), None)
    return None if gain is None else common.gain(gain)


def _program_gain(plant: Plant) -> Matrix | None:
    """Return the gain of the dual program, for large plants from the method made for it."""
    if plant.n <= GENERAL:
        return solve_covariance(plant, optimal_covariance_dual).gain
    from lmi.interior_point import solve_interior_point

    return solve_interior_point(plant).gain


def _improved(plant: Plant, gain: Matrix) -> Matrix | None:
    """Take Newton steps from a stabilising gain while the covariance falls; None when the gain does not stabilise."""
    P = gain_covariance(plant, gain)
    if P is None:
        return None
    for _ in range(NEWTON_STEPS):
        better = optimal_gain(plant, P)
        covariance = gain_covariance(plant, better)
        if covariance is None or not np.trace(covariance) <= np.trace(P):
            return gain
        gain, P = better, covariance
    return gain
