"""The search for a gain: convex programs and Riccati equations propose, what a gain achieves decides."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from lmi.synthesis_achieved import Achieved, achieved, radius_of
from lmi.synthesis_gain import COORDINATES, Synthesis, optimal_h2_gain
from lmi.synthesis_request import Request
from lmi.synthesis_riccati import central_gain, smallest_level

__all__ = ["BACKOFF", "Judged", "cheapest", "find_gain", "shifted", "smallest_norm", "within"]

Matrix = NDArray[np.floating[Any]]

BACKOFF = 4e-5
"""The norm asked of a gain exceeds the smallest one by this, relative: the smallest itself may need infinite gains."""

INSIDE = 1e-6
"""The norm asked of a gain is below the bound by this, relative, as room for rounding."""

LARGEST = 14
"""States up to which convex programs give the gain; Riccati equations are quicker from there on."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A gain L (n, l), and what it achieves."""

    gain: Matrix
    achieved: Achieved

    @property
    def norm(self) -> float:
        """Its H-infinity norm."""
        return self.achieved.hinf.upper


def find_gain(plant: Plant, request: Request) -> Judged | None:
    """Return the best gain found that meets the request, or None.

    The gain of least covariance is best when it meets everything and no smallest norm is asked for.

    Args:
        plant: V > 0, (A, C) detectable.
        request: objective and bounds.
    """
    if request.objective == "hinf" and request.gamma is None:
        return smallest_norm(plant, request.decay)
    optimal = _judged(plant, optimal_h2_gain(plant))
    if optimal is not None and request.is_met(optimal.achieved):
        return optimal
    return cheapest(plant, request) if request.objective == "h2" else within(plant, request)


def cheapest(plant: Plant, request: Request) -> Judged | None:
    """Return a gain of small cost that meets the decay; cost and decay share their Lyapunov matrix."""
    if plant.n <= LARGEST:
        gains = (Synthesis.of(plant, request.decay, *way).cheapest_gain() for way in COORDINATES)
    else:
        gains = iter((optimal_h2_gain(shifted(plant, request.decay)),))
    return _first_that_meets(plant, request, gains)


def within(plant: Plant, request: Request) -> Judged | None:
    """Return a gain that meets gamma and the decay, with a small bound of its covariance."""
    gamma = (request.gamma or np.inf) * (1 - INSIDE)
    found = _first_that_meets(plant, request, _within(plant, gamma, request.decay))
    if found is not None:
        return found
    smallest = smallest_norm(plant, request.decay)
    return smallest if smallest is not None and request.is_met(smallest.achieved) else None


def _within(plant: Plant, gamma: float, decay: float | None) -> Iterator[Matrix | None]:
    if plant.n <= LARGEST:
        yield from (Synthesis.of(plant, decay, *way).gain_within(gamma) for way in COORDINATES)
    yield central_gain(shifted(plant, decay), gamma)


def smallest_norm(plant: Plant, decay: float | None) -> Judged | None:
    """Return the gain with the smallest H-infinity norm found that has the decay, or None.

    Args:
        plant: V > 0, (A, C) detectable.
        decay: rate, or None. With a decay the program is sufficient only, and other gains may have smaller norms.
    """
    request = Request("hinf", decay=decay)
    nothing = _judged(plant, np.zeros((plant.n, plant.l)))
    if nothing is not None and nothing.norm == 0.0 and request.is_met(nothing.achieved):
        return nothing
    best: Judged | None = None
    for way in COORDINATES if plant.n <= LARGEST else ():
        synthesis = Synthesis.of(plant, decay, *way)
        level = synthesis.smallest_level()
        if not level:
            continue
        best = _better(best, _judged(plant, synthesis.gain_within(level * (1 + BACKOFF))), request)
        if best is not None and abs(best.norm / level - 1) <= 2 * BACKOFF:
            return best
    return _better(best, _smallest_by_riccati(plant, decay, best), request)


def _smallest_by_riccati(plant: Plant, decay: float | None, best: Judged | None) -> Judged | None:
    """Return the central gain near the smallest level; with a decay, near that of the shifted plant."""
    moved = shifted(plant, decay)
    reached = best if best is not None and decay is None else _judged(moved, optimal_h2_gain(moved))
    level = None if reached is None else smallest_level(moved, reached.norm * (1 + INSIDE))
    return None if level is None else _judged(plant, central_gain(moved, level * (1 + BACKOFF)))


def shifted(plant: Plant, decay: float | None) -> Plant:
    """Return the plant with A + a I, in discrete time A / r and C / r: a gain for it gives the plant the decay.

    Its H-infinity norm and its cost are bounds of those of the plant, by the maximum principle and by comparison.

    Source: B. D. O. Anderson and J. B. Moore, Linear system optimisation with prescribed degree of stability, Proc. IEE
        116 (1969) 2083-2087.
    """
    if decay is None:
        return plant
    if plant.is_continuous:
        return replace(plant, A=plant.A + decay * np.eye(plant.n))
    radius = radius_of(plant, decay)
    return replace(plant, A=plant.A / radius, C=plant.C / radius)


def _better(best: Judged | None, other: Judged | None, request: Request) -> Judged | None:
    """Return the one with the smaller norm among those that have the decay."""
    if other is None or not request.is_met(other.achieved):
        return best
    return other if best is None or other.norm < best.norm else best


def _first_that_meets(plant: Plant, request: Request, gains: Iterator[Matrix | None]) -> Judged | None:
    found = (_judged(plant, gain) for gain in gains)
    return next((judged for judged in found if judged is not None and request.is_met(judged.achieved)), None)


def _judged(plant: Plant, gain: Matrix | None) -> Judged | None:
    """Return a gain with what it achieves, or None when it does not stabilise."""
    found = None if gain is None else achieved(plant, gain)
    return None if gain is None or found is None else Judged(gain, found)
