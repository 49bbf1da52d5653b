"""The gain by nonlinear programming: errors of its forms against enclosures, and their times."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable

import numpy as np

from derive.numeric.enclosure import enclose_riccati
from derive.numeric.gain_horizon import optimise_horizon
from derive.numeric.gain_nlp import GainForm, GainResult, optimise_gain
from derive.numeric.gain_structured import optimise_structured_gain
from derive.numeric.plant import Plant
from tests.benchmark.certificates import TIMES, hard_plants
from tests.benchmark.table import Row
from tests.derive.numeric.plants import random_plant

ACCURATE = 1e-10
"""Relative error of tr P asked of the convex form."""

STATES = 16
"""States up to which the convex form is measured."""

LARGE = 30
"""States of the plants for the reduced form."""

OUTPUTS = (1, 10)
"""Their numbers of outputs."""

LARGE_ACCURATE = 1e-8
"""Relative error asked of the reduced form, and of single shooting."""

SECONDS = {4: 0.2, 10: 1.0, LARGE: 10.0}
"""Processor time allowed by the number of states."""

TEXTBOOK = {2: 20, 4: 20, 6: 20}
"""Plants of each size on which the textbook's program is tried."""


def gain() -> list[Row]:
    """Return errors and times of every form, and of gains with a structure and over a finite horizon."""
    hard = [(name, plant) for name, plant in hard_plants() if plant.n <= STATES]
    random = [(f"random {kind} n = {n}", random_plant(kind, n, seed=n)) for n in range(1, STATES + 1) for kind in TIMES]
    rows = [_convex("hard", hard), _convex("random", random)]
    rows += [_timed(random_plant(kind, n, seed=1), "automatic", ACCURATE) for n in (4, 10) for kind in TIMES]
    large = [random_plant(kind, LARGE, l, seed=1) for l in OUTPUTS for kind in TIMES]  # noqa: E741
    rows += [_timed(plant, "reduced", LARGE_ACCURATE) for plant in large]
    rows += [_textbook(n, count) for n, count in TEXTBOOK.items()]
    return [*rows, *(_structured(kind) for kind in TIMES), _horizon()]


def _convex(family: str, plants: Iterable[tuple[str, Plant]]) -> Row:
    """Return the worst error of the convex form, and of its multiplier, over plants."""
    errors, multipliers, missed = [], [], []
    for name, plant in plants:
        result = optimise_gain(plant, "convex")
        error = _error(plant, result)
        errors.append(error)
        if result.multiplier is not None and result.trace:
            multipliers.append(np.linalg.norm(result.multiplier - result.P) / np.linalg.norm(result.P))
        if not (error <= ACCURATE and result.status in ("optimal", "strong")):
            missed.append(f"{name} ({result.status}, {error:.0e})")
    right, middle, worst = len(errors) - len(missed), np.median(multipliers), max(multipliers)
    value = f"{right} of {len(errors)}, worst {max(errors):.0e}; multiplier {middle:.0e} (median), {worst:.0e} (worst)"
    value += f"; missed {'; '.join(missed)}" if missed else ""
    return Row(f"convex form, {family} plants, n <= {STATES}", value, f"all within {ACCURATE:g}", not missed)


def _error(plant: Plant, result: GainResult) -> float:
    """Return the error of tr P relative to its enclosure, infinite when there is no number."""
    truth = float(enclose_riccati(plant, 20).trace.mid())
    error = abs(result.trace - truth)
    return float(error / truth if truth > 0 else error) if np.isfinite(error) else np.inf


def _timed(plant: Plant, form: GainForm, accuracy: float) -> Row:
    optimise_gain(random_plant(plant.time, 2), form)  # CasADi loads its solvers when they are first used
    start = time.process_time()
    result = optimise_gain(plant, form)
    seconds, error = time.process_time() - start, _error(plant, result)
    return Row(
        f"{result.form} form, {plant.time}, n = {plant.n}, l = {plant.l}",
        f"error {error:.0e}, {seconds:.2f} s, {result.iterations} iterations",
        f"{accuracy:g}, {SECONDS[plant.n]:g} s",
        error <= accuracy and seconds <= SECONDS[plant.n],
    )


def _textbook(n: int, count: int) -> Row:
    """Return on how many plants the textbook's program is right; it must not claim an optimum where it is not."""
    ends: Counter[str] = Counter()
    for i in range(count):
        plant = random_plant(TIMES[i % 2], n, seed=i // 2)
        result = optimise_gain(plant, "full-space")
        wrong = _error(plant, result) > ACCURATE
        ends["claimed in error" if wrong and result.status == "optimal" else "missed" if wrong else "right"] += 1
    value = ", ".join(f"{ends[name]} {name}" for name in ("right", "missed", "claimed in error"))
    return Row(f"full-space form, {count} random plants, n = {n}", value, "none in error", not ends["claimed in error"])


def _structured(kind: str) -> Row:
    """Return how a gain with one block for each output ends from several starts."""
    n, l = 12, 4  # noqa: E741
    found = optimise_structured_gain(random_plant(kind, n, l, seed=2), np.kron(np.eye(l), np.ones((n // l, 1))))
    spread = (max(found.starts) - min(found.starts)) / found.cost
    value = f"{found.status} to {found.stationarity:.0e}, starts differ by {spread:.0e}, {found.seconds:.1f} s"
    return Row(f"gain with a structure, {kind}, n = {n}, l = {l}", value, "stationary", found.status == "stationary")


def _horizon() -> Row:
    """Return the distance from the difference Riccati equation over a horizon."""
    n, steps = 8, 20
    plant = random_plant("discrete", n, 2, seed=1)
    found, worst = optimise_horizon(plant, steps, 10 * np.eye(n)), 0.0
    P = 10 * np.eye(n)
    for other in found.P[1:]:
        cross = plant.A @ P @ plant.C.T + plant.N
        P = plant.A @ P @ plant.A.T + plant.W - cross @ np.linalg.solve(plant.C @ P @ plant.C.T + plant.V, cross.T)
        worst = max(worst, float(np.linalg.norm(other - P) / np.linalg.norm(P)))
    value = f"{found.status}, error {worst:.0e}, {found.seconds:.1f} s"
    return Row(f"{steps} gains by single shooting, n = {n}", value, f"{LARGE_ACCURATE:g}", worst <= LARGE_ACCURATE)
