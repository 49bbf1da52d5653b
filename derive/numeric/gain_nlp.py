"""The optimal gain by nonlinear programming: minimise the error covariance over all stabilising gains, with IPOPT."""

from dataclasses import dataclass
from time import perf_counter
from typing import Literal

import numpy as np

from derive.errors import InputError
from derive.numeric.gain_frame import Frame
from derive.numeric.gain_search import ROUNDS, Answer, Method, search
from derive.numeric.modes import Matrix
from derive.numeric.normal import normal_form, plant_gain
from derive.numeric.plant import Plant

__all__ = ["GainForm", "GainResult", "optimise_gain"]

GainStatus = Literal["optimal", "strong", "inaccurate", "failed"]
GainForm = Literal["automatic", "convex", "reduced", "full-space"]

CONVEX_STATES = 16
"""Most states for which the convex form is chosen: its variables are n (n + 1) / 2 + n l, those of the other n l."""

STATIONARY = 1e-6
"""Relative size of the gradient at which a gain counts as optimal."""


@dataclass(frozen=True, eq=False)
class GainResult:
    """The gain that the optimiser found, and what it is worth.

    Attributes:
        gain: L (n, l).
        P: error covariance (n, n) of that gain, from its Lyapunov or Stein equation.
        trace: tr P.
        status: "optimal" when A - L C is stable and the gradient vanishes; "strong" likewise, next to boundary modes
            that the noise does not excite and that stay; "inaccurate" when stable only; "failed" otherwise.
        form: "convex", "reduced" or "full-space".
        stationarity: size of L V - P C' - N, in discrete time of L (C P C' + R) - A P C' - S, over that of its terms,
            in coordinates in which V and P are the identity; it vanishes with the gradient.
        history: tr P of the gains on the way, from the start on, infinite for a gain that does not stabilise.
        iterations: of IPOPT, in all rounds.
        multiplier: P (n, n) as the convex form's multiplier, otherwise None.
        seconds: time taken.
    """

    gain: Matrix
    P: Matrix
    trace: float
    status: GainStatus
    form: GainForm
    stationarity: float
    history: tuple[float, ...]
    iterations: int
    multiplier: Matrix | None
    seconds: float


def optimise_gain(plant: Plant, form: GainForm = "automatic") -> GainResult:
    """Minimise tr P over the gains L with A - L C stable, without any Riccati equation.

    0 = (A - L C) P + P (A - L C)' + W - L N' - N L' + L V L', in discrete time P = (A - L C) P (A - L C)' + the same.

    Each form is solved in the normal form (V = I, no cross term), in coordinates that make the covariance of the last
    gain the identity, until the cost settles; the P of least trace there is the least in the sense of Loewner, in all
    coordinates. The start is a stabilising gain from a linear equation, or by homotopy from A - a I where that gives
    none.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.
        form: "convex", the program with P as multiplier (`derive.numeric.gain_multiplier`); "reduced", in L alone with
            its exact gradient (`derive.numeric.gain_reduced`); "full-space", the textbook's program in L and P, which
            fails from a few states on (`derive.numeric.gain_full_space`); "automatic", the first for up to 16 states,
            the second for more and where the first is inaccurate.

    Returns:
        The gain with P recomputed for it; in the strong case with the boundary modes left where they are.

    Raises:
        InputError: no such form.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> result = optimise_gain(example_plant())
        >>> result.status, result.form
        ('optimal', 'convex')
    """
    if form != "automatic":
        return _optimise(plant, form)
    if plant.n <= CONVEX_STATES:
        result = _optimise(plant, "convex")
        if result.status != "inaccurate":
            return result
    return _optimise(plant, "reduced")


def _optimise(plant: Plant, form: GainForm) -> GainResult:
    """Solve one form."""
    start = perf_counter()
    method, rounds = _method(form)
    whole = normal_form(plant)
    boundary = whole.boundary()
    kept = boundary.kept
    part = whole.without(boundary)
    found = search(Frame.of(part), kept.T * whole.scaling**2 @ kept, method, rounds)
    P = whole.unscaled(kept @ found.P @ kept.T).astype(float)
    multiplier = found.multiplier
    return GainResult(
        gain=plant_gain(plant, whole, kept @ found.gain),
        P=P,
        trace=float(np.trace(P)),
        status=_status(found, len(boundary.modes)),
        form=form,
        stationarity=found.stationarity,
        history=found.history,
        iterations=found.iterations,
        multiplier=None if multiplier is None else whole.unscaled(kept @ multiplier @ kept.T).astype(float),
        seconds=perf_counter() - start,
    )


def _method(form: GainForm) -> tuple[Method, int]:
    """Return the program of a form and how often it may be solved."""
    if form == "convex":
        from derive.numeric.gain_multiplier import solve_for_multiplier

        return solve_for_multiplier, ROUNDS
    if form == "reduced":
        from derive.numeric.gain_reduced import solve_reduced

        return solve_reduced, ROUNDS
    if form == "full-space":
        from derive.numeric.gain_full_space import solve_full_space

        return solve_full_space, 1
    raise InputError(f'form: expected "automatic", "convex", "reduced" or "full-space", got {form!r}; choose one')


def _status(found: Answer, boundary_modes: int) -> GainStatus:
    if not np.isfinite(found.P.astype(float)).all():
        return "failed"
    if not found.stationarity <= STATIONARY:
        return "inaccurate"
    return "strong" if boundary_modes else "optimal"
