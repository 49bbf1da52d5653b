"""Times and digits of the enclosures, and the error of the adaptive quadrature against them."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from derive.numeric.balls import exact, norm, working_bits
from derive.numeric.enclosure import RiccatiEnclosure, enclose_riccati
from derive.numeric.log_det import LogDetEnclosure, enclose_by_eigenvalues, enclose_log_det
from derive.numeric.plant import Plant
from derive.numeric.spectrum import output_error_integral
from tests.benchmark.published import COLLECTIONS, Collection, Example, published
from tests.benchmark.table import Row
from tests.derive.numeric.plants import random_plant
from tests.derive.numeric.test_log_det import chain

SECONDS = {20: 0.5, 50: 5.0}
QUADRATURE = 1e-13
DIGITS = 20
NEAR = 1e-19
COLLECTED = 60  # states of the largest plant taken from a collection


def enclosures() -> list[Row]:
    """Return times at n = 20 and 50, errors of the quadrature, and what becomes of the published collections."""
    plants = [(f"random {time}, n = {n}", random_plant(time, n, seed=1)) for n in SECONDS for time in TIMES]
    chains = [
        (f"chain {time}, n = {n}, damping {damping:g}", chain(n // 2, damping, time))
        for n in SECONDS
        for time in TIMES
        for damping in (1e-3, 1e-6)
    ]
    rows = [row for name, plant in plants + chains for row in _measured(name, plant)]
    return rows + _collections()


TIMES = ("continuous", "discrete")


def _measured(name: str, plant: Plant) -> list[Row]:
    limit = SECONDS[plant.n]
    solution, spectrum = (_timed(f, plant) for f in (enclose_riccati, enclose_by_eigenvalues))
    overlap = solution[1].output_cost.overlaps(spectrum[1].value)
    truth = solution[1].output_cost
    error = float((abs(truth - output_error_integral(plant).value) / abs(truth)).abs_upper())
    return [
        _row(f"Riccati, {name}", *solution, limit, True),
        _row(f"log-det integral, {name}", *spectrum, limit, overlap),
        Row(f"adaptive quadrature, {name}", f"error {error:.1e}", f"{QUADRATURE:g}", error <= QUADRATURE),
    ]


Result = RiccatiEnclosure | LogDetEnclosure


def _timed(function: Callable[[Plant, int], Result], plant: Plant) -> tuple[float, Result]:
    """Return the shortest of three runs in seconds of processor time, which other work on the machine leaves alone."""
    runs = []
    for _ in range(3):
        start = time.process_time()
        found = function(plant, DIGITS)
        runs.append((time.process_time() - start, found))
    return min(runs, key=lambda run: run[0])


def _row(name: str, seconds: float, found: Result, limit: float, holds: bool) -> Row:
    value = f"{found.status}, {found.digits} digits, {seconds:.3f} s{'' if holds else ', contradicts Riccati'}"
    ok = holds and found.status == "verified" and found.digits >= DIGITS and seconds <= limit
    return Row(name, value, f"{DIGITS} digits, {limit:g} s", ok)


def _collections() -> list[Row]:
    """Return one row a collection, if the environment variable DERIVE_BENCH names a folder of them."""
    return [_collection(name) for name in COLLECTIONS if any(published(name))]


def _collection(name: Collection) -> Row:
    verified, wrong, refused, start = 0, [], [], time.perf_counter()
    for example in published(name):
        plant = example.plant
        if plant.n > COLLECTED or np.linalg.eigvalsh(plant.V)[0] < 1e-14:
            continue
        found = enclose_riccati(plant, DIGITS)
        if found.P is None:
            refused.append(example.name)
        elif _near(found, example) and found.output_cost.overlaps(enclose_log_det(plant, DIGITS).value):
            verified += 1
        else:
            wrong.append(example.name)
    seconds = time.perf_counter() - start
    known = [other for other in refused if other != "carex_2_5"]  # its closed loop is on the boundary
    value = f"{verified} verified, refused {refused or 'none'}, wrong {wrong or 'none'}, {seconds:.0f} s"
    return Row(f"{name}, n <= {COLLECTED}", value, "all but carex_2_5, none wrong", not wrong and not known)


def _near(found: RiccatiEnclosure, example: Example) -> bool:
    """Tell whether the enclosure is where the collection's double-double solution is."""
    assert found.P is not None
    if example.truth is None or example.rest is None:
        return True
    with working_bits(300):
        distance = norm(found.P.mid() - exact(example.truth) - exact(example.rest))
        return bool(distance <= NEAR * norm(found.P.mid()))
