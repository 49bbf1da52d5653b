"""What the notes show of an estimator: its error covariance over time, its modes, its ellipses."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.errors import InputError
from derive.numeric.flow import Flow, flow_over, one_step
from derive.numeric.modes import Matrix
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant
from derive.numeric.riccati import RiccatiSolution, solve_riccati

__all__ = ["Response", "covariance_ellipse", "covariance_response"]

SETTLING = 6.0
"""Time constants of the slowest mode that a response covers unless told otherwise."""

GROWTH = 4.0
"""An unstable mode grows by exp(GROWTH) at most in one application of the flow, which loses that factor squared."""

SUBSTEPS = 100
"""Most applications of the flow between two points."""

STEPS = 10, 400
"""Least and largest number of steps of a discrete response."""


@dataclass(frozen=True, eq=False)
class Response:
    """The optimal error covariance from its start to the steady state.

    Attributes:
        times: (k,) [s], in discrete time numbers of steps, times dt where the plant gives it.
        covariances: P at these times (k, n, n).
        deviations: standard deviations (k, n), the roots of the diagonals.
        steady: the steady covariance (n, n).
        open_loop: eigenvalues of A (n,).
        closed_loop: eigenvalues of A - L C (n,) with the steady gain.
    """

    times: Matrix
    covariances: Matrix
    deviations: Matrix
    steady: Matrix
    open_loop: NDArray[Any]
    closed_loop: NDArray[Any]


def covariance_response(plant: Plant, points: int = 200, horizon: float | None = None) -> Response:
    """Solve P' = A P + P A' + W - (P C' + N) V^-1 (P C' + N)', in discrete time the recursion of the predictor.

    Every point is reached from the one before by the exact map over the step, so that none depends on a step size.

    Args:
        plant: with P0, or without: then the standard deviations start at twice the steady ones, or at one where those
            vanish, without correlation.
        points: number of times, continuous time only.
        horizon: last time [s], or number of steps; unless given, six time constants of the slowest mode, or what the
            fastest unstable mode allows.

    Raises:
        InputError: the horizon is not positive, or too long for an unstable mode; there are fewer than two points;
            the covariance leaves double precision.

    Source: A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, chapter 12, for the equations.
    """
    if points < 2 or (horizon is not None and not horizon > 0):
        raise InputError(f"response: expected 2 points or more and a positive horizon, got {points} and {horizon}")
    solution = solve_riccati(plant)
    form = normal_form(plant)
    try:
        with np.errstate(all="ignore"):  # an overflow is answered below
            times, flow, substeps = _course(plant, form, solution, points, horizon)
            path = _path(flow, form.scaled(_start(plant, solution)), times, substeps)
    except np.linalg.LinAlgError:
        times, path = np.zeros(1), np.full((1, plant.n, plant.n), np.nan)
    covariances = form.unscaled(path)
    if not np.isfinite(covariances).all():
        raise InputError("response: expected numbers within double precision, got more; choose other units")
    return Response(
        times=times,
        covariances=covariances,
        deviations=np.sqrt(np.maximum(np.diagonal(covariances, axis1=1, axis2=2), 0.0)),
        steady=solution.P,
        open_loop=np.linalg.eigvals(plant.A),
        closed_loop=solution.closed_loop,
    )


def _course(
    plant: Plant, form: NormalForm, solution: RiccatiSolution, points: int, horizon: float | None
) -> tuple[Matrix, Flow, int]:
    """Return the times, the flow from one to the next or a part of it, and the number of parts."""
    last = _settling(solution, plant) if horizon is None else horizon
    if not plant.is_continuous:
        steps = int(np.clip(np.ceil(last), *STEPS)) if horizon is None else int(np.ceil(last))
        return np.arange(steps + 1) * (plant.dt or 1.0), one_step(form), 1
    growth = max(0.0, float(np.linalg.eigvals(form.uncorrelated()[0]).real.max()))
    longest = (points - 1) * SUBSTEPS * GROWTH / growth if growth else np.inf
    if horizon is not None and horizon > longest:
        raise InputError(
            f"response: expected a horizon of at most {longest:.3g} s for a mode that grows at {growth:.3g} 1/s, "
            f"got {horizon:.3g}; shorten it or ask for more points"
        )
    times = np.linspace(0.0, min(last, longest), points)
    substeps = int(np.ceil(max(1.0, times[1] * growth / GROWTH)))
    return times, flow_over(form, times[1] / substeps), substeps


def _path(flow: Flow, P: Matrix, times: Matrix, substeps: int) -> Matrix:
    """Return the covariances at all times (k, n, n)."""
    path = [P]
    for _ in times[1:]:
        for _ in range(substeps):
            P = flow.after(P)
        path.append(P)
    return np.array(path)


def _start(plant: Plant, solution: RiccatiSolution) -> Matrix:
    """Return P0, or four times the steady variances, one where they vanish."""
    if plant.P0 is not None:
        return plant.P0
    variances = np.diag(solution.P)
    return np.diag(np.where(variances > 0, 4 * variances, 1.0))


def covariance_ellipse(P: Matrix, first: int = 0, second: int = 1, size: float = 1.0, points: int = 181) -> Matrix:
    """Return points z (points, 2) with z' B^-1 z = size^2, B the block of P for two states; a segment if B is singular.

    Args:
        P: covariance (n, n).
        first: index of the state along the first axis.
        second: index of the state along the second axis.
        size: standard deviations from the centre.
        points: number of points; the last is the first again.
    """
    pair = [first, second]
    variances, directions = np.linalg.eigh(P[np.ix_(pair, pair)])
    angle = np.linspace(0.0, 2 * np.pi, points)
    axes = directions * np.sqrt(np.maximum(variances, 0.0))
    return size * np.stack([np.cos(angle), np.sin(angle)], axis=1) @ axes.T


def _settling(solution: RiccatiSolution, plant: Plant) -> float:
    """Return six time constants of the slowest mode that decays, in seconds or steps."""
    modes = solution.closed_loop[: plant.n - len(solution.boundary_modes)]
    rates = -modes.real if plant.is_continuous else -np.log(np.maximum(np.abs(modes), np.finfo(float).tiny))
    slowest = rates.min(initial=np.inf)
    if not np.isfinite(slowest):
        size = np.linalg.norm(plant.A)
        slowest = size if plant.is_continuous and size > 0 else 1.0
    return float(SETTLING / slowest)
