"""The search for a gain: convex programs and Riccati equations propose, what a gain achieves decides."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from lmi.synthesis.achieved import Achieved, achieved
from lmi.synthesis.gain import COORDINATES, Synthesis, optimal_h2_gain
from lmi.synthesis.request import Request
from lmi.synthesis.shift import shifted

__all__ = ["Judged", "find_gain", "smallest_norm"]

Matrix = NDArray[np.floating[Any]]

BACKOFF = 8e-5
"""The norm asked of a gain exceeds the smallest one by this, relative: the smallest itself may need infinite gains."""

BACKOFFS = (1e-2, 1e-1, 1.0)
"""The same with a decay."""

LOOSER = (1.1, 1.3, 2.0)
"""Factors on a bound that is asked for besides a decay."""

INSIDE = 1e-6
"""The norm asked of a gain is below the bound by this, relative, as room for rounding; a decay is above."""

HALVINGS = 12
"""Steps of the search for a gain between two."""

LARGEST = 12
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
    """Return the best gain found that meets the request; or the one that comes nearest, which does not; or None.

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
    found = _cheapest(plant, request) if request.objective == "h2" else _within(plant, request)
    return _towards(plant, request, found, optimal, lambda judged: judged.achieved.cost)


def _cheapest(plant: Plant, request: Request) -> Judged | None:
    """Return a gain of small cost that meets the decay; cost and decay share their Lyapunov matrix."""
    gains = (synthesis.cheapest_gain() for synthesis in _ways(plant, request.decay))
    moved = map(optimal_h2_gain, (shifted(plant, request.decay),))
    return next(_meeting(plant, request, chain(gains, moved)), None)


def _within(plant: Plant, request: Request) -> Judged | None:
    """Return a gain that meets gamma and the decay, the one of least cost among those found; or the nearest."""
    gamma = (request.gamma or np.inf) * (1 - INSIDE)
    for synthesis in _ways(plant, request.decay):
        found = list(_meeting(plant, request, _gains_within(synthesis, gamma, request.decay)))
        if found:
            return min(found, key=lambda judged: judged.achieved.cost)
    central = _judged(plant, _balanced(shifted(plant, request.decay)).central_gain(gamma))
    if central is not None and request.is_met(central.achieved):
        return central
    return smallest_norm(plant, request.decay)


def _gains_within(synthesis: Synthesis, gamma: float, decay: float | None) -> Iterator[Matrix | None]:
    """Iterate over gains for gamma, with a decay also over those for looser bounds, whose norms may be far below."""
    yield synthesis.gain_within(gamma)
    if decay is not None:
        yield synthesis.cheapest_gain()
        yield from (synthesis.gain_within(gamma * looser) for looser in LOOSER)


def _ways(plant: Plant, decay: float | None) -> Iterator[Synthesis]:
    """Iterate over coordinates in which to solve programs."""
    ways = COORDINATES if plant.n <= LARGEST else ()
    return (Synthesis.of(plant, decay, *way) for way in (ways if decay is None else ways[:1]))


def smallest_norm(plant: Plant, decay: float | None) -> Judged | None:
    """Return the gain with the smallest H-infinity norm found that has the decay, or None.

    Args:
        plant: V > 0, (A, C) detectable.
        decay: rate, or None. Where the gain of the smallest norm does not have it, other gains than those that share a
            Lyapunov matrix with the norm may have smaller norms.
    """
    free = _free(plant)
    request = Request("hinf", decay=decay)
    if free is not None and request.is_met(free.achieved):
        return free
    return _towards(plant, request, _decaying(plant, request), free, lambda judged: judged.norm)


def _free(plant: Plant) -> Judged | None:
    """Return the gain of the smallest norm: the program's, or where the Riccati equation has a better one, that."""
    nothing = _judged(plant, np.zeros((plant.n, plant.l)))
    if nothing is not None and nothing.norm == 0.0:
        return nothing
    best: Judged | None = None
    for synthesis in _ways(plant, None):
        level = synthesis.smallest_level()
        best = _better(best, _judged(plant, synthesis.gain_within(level * (1 + BACKOFF))) if level else None)
        if best is not None and level and abs(best.norm / level - 1) <= 2 * BACKOFF:
            if _balanced(plant).central_gain(best.norm * (1 - 2 * BACKOFF)) is None:
                return best
            break
    return _better(best, _central(plant, plant, best))


def _decaying(plant: Plant, request: Request) -> Judged | None:
    """Return the gain of the smallest norm among some that have the decay.

    The bound that the program gives is often above the norm, so that the gain for a looser bound may be better.
    """
    for synthesis in _ways(plant, request.decay):
        level = synthesis.smallest_level()
        gains = (synthesis.gain_within(level * (1 + backoff)) for backoff in BACKOFFS) if level else iter(())
        best = min(_meeting(plant, request, gains), key=lambda judged: judged.norm, default=None)
        if best is not None:
            return best
    moved = _central(plant, shifted(plant, request.decay), None)
    return moved if moved is not None and request.is_met(moved.achieved) else None


def _towards(
    plant: Plant, request: Request, found: Judged | None, ideal: Judged | None, value: Callable[[Judged], float]
) -> Judged | None:
    """Move a gain that meets a request towards one that is better and does not, as far as the request is met.

    What shares a Lyapunov matrix with an objective meets a request with room to spare.
    """
    if found is None or ideal is None or not request.is_met(found.achieved):
        return found
    stricter, best, low, high = request.stricter(INSIDE), found, 0.0, 1.0
    for _ in range(HALVINGS):
        share = (low + high) / 2
        judged = _judged(plant, ideal.gain + share * (found.gain - ideal.gain))
        if judged is None or not stricter.is_met(judged.achieved):
            low = share
        else:
            high, best = share, min(best, judged, key=value)
    return best


def _central(plant: Plant, moved: Plant, best: Judged | None) -> Judged | None:
    """Return the central gain near the smallest level of the plant, or of one that bounds it."""
    synthesis = _balanced(moved)
    reached = best or _judged(moved, optimal_h2_gain(moved))
    level = None if reached is None else synthesis.central_level(reached.norm * (1 + INSIDE))
    return None if level is None else _judged(plant, synthesis.central_gain(level * (1 + BACKOFF)))


def _balanced(plant: Plant) -> Synthesis:
    return Synthesis.of(plant, None, None, np.inf)


def _better(best: Judged | None, other: Judged | None) -> Judged | None:
    """Return the one with the smaller norm."""
    return other if best is None or (other is not None and other.norm < best.norm) else best


def _meeting(plant: Plant, request: Request, gains: Iterator[Matrix | None]) -> Iterator[Judged]:
    """Iterate over the gains that meet a request."""
    found = (_judged(plant, gain) for gain in gains)
    return (judged for judged in found if judged is not None and request.is_met(judged.achieved))


def _judged(plant: Plant, gain: Matrix | None) -> Judged | None:
    """Return a gain with what it achieves, or None when it does not stabilise."""
    found = None if gain is None else achieved(plant, gain)
    return None if gain is None or found is None else Judged(gain, found)
