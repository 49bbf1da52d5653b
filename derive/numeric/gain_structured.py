"""Gains with a structure: some entries vary, the others keep their values."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal

import numpy as np

from derive.errors import InputError
from derive.numeric.gain_descent import Descent, descend, newton
from derive.numeric.gain_reduced import ReducedCost, stabilised
from derive.numeric.modes import Matrix
from derive.numeric.normal import normal_form
from derive.numeric.plant import Plant

__all__ = ["StructuredGain", "StructuredStatus", "optimise_structured_gain"]

StructuredStatus = Literal["stationary", "inaccurate", "failed"]

STATIONARY = 1e-6
"""Size of the gradient, in the metric and relative to the cost, at which a gain counts as stationary."""

SPREAD = 1.0
"""Size of the step to a random start, as the relative growth of the cost that the metric predicts."""

HALVINGS = 30
"""How often the step to a random start is halved until it stabilises."""


@dataclass(frozen=True, eq=False)
class StructuredGain:
    """The best stationary gain of a structure that was found.

    Attributes:
        gain: L (n, l), with the fixed entries as given.
        P: error covariance (n, n) of that gain, from its Lyapunov or Stein equation.
        cost: tr(M P).
        status: "stationary" when A - L C is stable and the gradient over the free entries vanishes: no claim that no
            other gain of the structure is better, as the program is not convex; "inaccurate" when A - L C is stable
            only; "failed" when no stabilising gain of the structure was found, which does not prove that there is none.
        gradient: change of tr(M P) with the entries of L (n, l), 0 at the fixed ones.
        gradient_norm: size of the gradient, the Frobenius norm in the plant's units.
        stationarity: size of the gradient in units of the cost, sqrt(g' H^-1 g / tr(M P)) with the metric H.
        starts: tr(M P) where the descent from each start ended, infinite where it found no stabilising gain.
        history: tr(M P) along the best descent.
        iterations: of IPOPT, in all descents to the end; without the search for stabilising gains.
        seconds: time taken.
    """

    gain: Matrix
    P: Matrix
    cost: float
    status: StructuredStatus
    gradient: Matrix
    gradient_norm: float
    stationarity: float
    starts: tuple[float, ...]
    history: tuple[float, ...]
    iterations: int
    seconds: float


def optimise_structured_gain(
    plant: Plant, structure: Any, fixed: Matrix | None = None, starts: int = 4, seed: int = 0
) -> StructuredGain:
    """Look for a gain of a structure at which tr(M P) is stationary, from several starts.

    0 = (A - L C) P + P (A - L C)' + W - L N' - N L' + L V L', in discrete time P = (A - L C) P (A - L C)' + the same.

    The gradient over the free entries is exact: 2 S (L V - P C' - N), in discrete time 2 S (L (C P C' + R) - A P C' -
    S_qr), with the adjoint S of the weight M. The first start comes from the fixed entries alone, by homotopy from
    A - a I; the others are random steps from the first one's answer.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.
        structure: entries that may vary (n, l), true or 1; the others are fixed.
        fixed: values (n, l) for the fixed entries, 0 unless given.
        starts: number of starts.
        seed: of the random numbers.

    Returns:
        The best answer of all starts.

    Raises:
        InputError: shapes that do not fit, no start.

    Source: for the gradient W. S. Levine, M. Athans, On the determination of the optimal constant output feedback
        gains for linear multivariable systems, IEEE Trans. Automat. Control 15 (1970) 44-48.
    """
    begin = perf_counter()
    free, values = _checked(plant, structure, fixed, starts)
    cost, scale = _scaled(plant, free, values)
    descents = _descents(cost, starts, np.random.default_rng(seed))
    costs = tuple(cost.value(descent.x) if descent else np.inf for descent in descents)
    best = descents[int(np.argmin(costs))]
    iterations = sum(descent.iterations for descent in descents if descent)
    if best is None:
        nan = np.full(values.shape, np.nan)
        P = np.full(plant.A.shape, np.nan)
        spent = perf_counter() - begin
        return StructuredGain(nan, P, np.nan, "failed", nan, np.nan, np.nan, costs, (), iterations, spent)
    gain = np.where(free, cost.gain(best.x) * scale, values)
    gradient = _spread(cost, cost.gradient(best.x)) / scale
    P, t = cost.covariance(cost.gain(best.x)), normal_form(plant).scaling.astype(float)
    stationarity = float(np.sqrt(2 * best.decrement))
    return StructuredGain(
        gain=gain,
        P=P * np.outer(t, t),
        cost=cost.value(best.x),
        status="stationary" if stationarity <= STATIONARY else "inaccurate",
        gradient=gradient,
        gradient_norm=float(np.linalg.norm(gradient)),
        stationarity=stationarity,
        starts=costs,
        history=tuple(cost.value(x) for x in best.points),
        iterations=iterations,
        seconds=perf_counter() - begin,
    )


def _checked(plant: Plant, structure: Any, fixed: Matrix | None, starts: int) -> tuple[Any, Matrix]:
    """Return the free entries, of type bool, and the values of the others."""
    free = np.asarray(structure)
    shape = (plant.n, plant.l)
    if free.shape != shape:
        raise InputError(f"structure: expected shape {shape}, got {free.shape}; one row a state, one column an output")
    if not np.isin(free, (0, 1)).all():
        raise InputError("structure: expected 0 and 1, or false and true, got others; 1 marks an entry that may vary")
    values = np.zeros(shape) if fixed is None else np.asarray(fixed, dtype=float)
    if values.shape != shape:
        raise InputError(f"fixed: expected shape {shape}, got {values.shape}; one row a state, one column an output")
    if not np.isfinite(values).all():
        raise InputError("fixed: expected finite numbers, got others; entries that vary may be 0")
    if starts < 1:
        raise InputError(f"starts: expected at least 1, got {starts}; give the number of starts")
    return free.astype(bool), np.where(free, 0.0, values)


def _scaled(plant: Plant, free: Any, fixed: Matrix) -> tuple[ReducedCost, Matrix]:
    """Return the cost with states and outputs scaled by powers of two, which keep the structure, and L / L_scaled."""
    t = normal_form(plant).scaling.astype(float)
    r = np.exp2(np.round(np.log2(np.diag(plant.V)) / 2))
    scale = np.outer(t, 1 / r)
    A, C = plant.A / t[:, None] * t, plant.C / r[:, None] * t
    W, V, N = plant.W / np.outer(t, t), plant.V / np.outer(r, r), plant.N / np.outer(t, r)
    return ReducedCost(A, C, W, V, N, plant.M * np.outer(t, t), plant.time, fixed / scale, free), scale


def _descents(cost: ReducedCost, starts: int, rng: np.random.Generator) -> list[Descent | None]:
    """Return the descent from every start, None where no stabilising gain was found."""
    descents: list[Descent | None] = []
    for _ in range(starts):
        first = next((descent for descent in descents if descent), None)
        x = np.zeros(cost.basis.shape[1]) if not descents else _random_start(cost, first, rng)
        x = stabilised(cost, x)
        descents.append(descend(cost, x) if np.isfinite(x).all() else None)
    return descents


def _random_start(cost: ReducedCost, first: Descent | None, rng: np.random.Generator) -> Matrix:
    """Return free entries at random, a step away from an answer if there is one."""
    p = cost.basis.shape[1]
    direction = rng.standard_normal(p)
    if first is None:
        return direction
    step = newton(cost, first.x)[1] @ direction * np.sqrt(2 * SPREAD * cost.value(first.x) / p)
    for _ in range(HALVINGS):
        if cost.is_stable(first.x + step):
            break
        step = step / 2
    return first.x + step


def _spread(cost: ReducedCost, entries: Matrix) -> Matrix:
    """Return the matrix (n, l) with the free entries, 0 elsewhere."""
    return (cost.basis @ entries).reshape(cost.free.shape, order="F")
