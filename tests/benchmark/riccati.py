"""Forward errors of Riccati solutions on published and hard plants, ours and those of SciPy and python-control."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from derive.numeric.enclosure import RiccatiEnclosure, enclose_riccati
from derive.numeric.modes import Matrix
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from lmi.validation import validate
from tests.benchmark.certificates import HARD, hard_plants
from tests.benchmark.published import COLLECTIONS, Collection, Example, published
from tests.benchmark.table import Row
from tests.derive.numeric.plants import random_plant

Solver = Callable[[Plant], Matrix]

ACCURATE = 1e-10
"""Largest relative forward error asked of our solution, in the coordinates of the collection."""

SILENT = 1e-6
"""Relative error above which an answer without exception or warning is a silent failure."""

BITS = 20
"""States are scaled by up to 2^20 either way."""

LARGEST = 100
"""States up to which solutions are enclosed."""

SECONDS = 60.0
"""Time allowed for several hundred states."""


def riccati() -> list[Row]:
    """Return what becomes of the collections, as they are and with scaled states, and of the hard plants."""
    rows = [row for name in COLLECTIONS if any(published(name)) for row in _collection(name)]
    if not rows:
        rows = [Row("CAREX and DAREX", "not measured: DERIVE_BENCH names no folder of them", "set DERIVE_BENCH", True)]
    return rows + _on_hard_plants() + [_two_hundred(kind) for kind in ("continuous", "discrete")]


@dataclass
class Tally:
    """Relative errors by name, and names with the reason why there is no answer."""

    errors: dict[str, float] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    doubted: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def worst(self) -> str:
        """The largest error and whose it is."""
        if not self.errors:
            return "none answered"
        name = max(self.errors, key=lambda name: self.errors[name])
        return f"worst error {self.errors[name]:.1e} ({name})"

    @property
    def silent(self) -> list[str]:
        """Names of answers that are wrong without a word."""
        return [name for name, error in self.errors.items() if not error <= SILENT and name not in self.doubted]


def _collection(name: Collection) -> list[Row]:
    examples = [example for example in published(name) if example.plant.n <= LARGEST]
    ours = _ours((example.name, example.plant, _truth(example)) for example in examples)
    scaled = [_scaled(example, seed) for seed, example in enumerate(examples) if example.truth is not None]
    rows = [_our_row(f"{name}, {len(examples)} examples", ours)]
    rows.append(_our_row(f"{name}, states scaled by 2^+-{BITS}", _ours(scaled)))
    for peer, solver in _peers():
        for kind, plants in (("", _answered(examples, ours)), (f", states scaled by 2^+-{BITS}", scaled)):
            rows.append(_peer_row(f"{name}{kind}, {peer}", _theirs(solver, plants)))
    return rows + [_large(example) for example in published(name) if example.plant.n > LARGEST]


Distance = Callable[[Matrix], float]
Case = tuple[str, Plant, Distance | None]


def _truth(example: Example) -> Distance | None:
    return None if example.truth is None else example.error


def _answered(examples: list[Example], ours: Tally) -> list[Case]:
    return [(x.name, x.plant, x.error) for x in examples if x.name in ours.errors and x.truth is not None]


def _scaled(example: Example, seed: int) -> Case:
    """Scale the states by powers of two; the error is taken in the states as they were."""
    plant = example.plant
    s = 2.0 ** np.random.default_rng(seed).integers(-BITS, BITS + 1, plant.n)
    scaled = replace(
        plant, A=s[:, None] * plant.A / s, C=plant.C / s, W=plant.W * np.outer(s, s), N=s[:, None] * plant.N
    )
    return example.name, scaled, lambda P: example.error(P / np.outer(s, s))


def _ours(cases: Iterator[Case] | list[Case]) -> Tally:
    """Tally our errors; `doubted` are those that a bound does not hold for, the stated one or the proved one."""
    tally = Tally()
    for name, plant, error in cases:
        start = time.process_time()
        solution = solve_riccati(plant)
        tally.seconds += time.process_time() - start
        if solution.status == "failed":
            tally.refused[name] = solution.reason
            continue
        enclosure = enclose_riccati(plant)
        if enclosure.P is None:
            tally.refused[name] = enclosure.reason
            continue
        proved = enclosure.distance(solution.P)
        if not proved <= np.linalg.norm(solution.error) or not _holds(enclosure, error):
            tally.doubted.append(name)
        size = float(np.linalg.norm(solution.P)) or 1.0
        tally.errors[name] = proved / size if error is None else error(solution.P)
    return tally


def _holds(enclosure: RiccatiEnclosure, error: Distance | None) -> bool:
    """Tell whether the proved radius agrees with the collection's solution, as far as doubles show it."""
    return error is None or error(enclosure.centre) <= 2 * np.finfo(float).eps


def _our_row(name: str, tally: Tally) -> Row:
    refused = "; ".join(f"{key}: {reason}" for key, reason in tally.refused.items()) or "none"
    value = (
        f"{tally.worst}, {len(tally.errors)} answered, bounds that do not hold: {tally.doubted or 'none'}, "
        f"{tally.seconds:.1f} s, refused {refused}"
    )
    ok = all(error <= ACCURATE for error in tally.errors.values()) and not tally.doubted
    named = all(tally.refused.values())
    return Row(name, value, f"{ACCURATE:g}, bounds hold, refusals named", ok and named and bool(tally.errors))


def _peers() -> list[tuple[str, Solver]]:
    """Return the other solvers that are installed."""
    import scipy

    peers = [(f"SciPy {scipy.__version__}", _scipy)]
    try:
        import control
    except ImportError:
        return peers
    try:
        import slycot
    except ImportError:
        return [*peers, (f"python-control {control.__version__}", _control)]
    return [*peers, (f"python-control {control.__version__} with slycot {slycot.__version__}", _control)]


def _scipy(plant: Plant) -> Matrix:
    from scipy.linalg import solve_continuous_are, solve_discrete_are

    solve = solve_continuous_are if plant.is_continuous else solve_discrete_are
    return solve(plant.A.T, plant.C.T, plant.W, plant.V, s=plant.N if plant.N.any() else None)


def _control(plant: Plant) -> Matrix:
    import control

    solve = control.care if plant.is_continuous else control.dare
    return np.asarray(solve(plant.A.T, plant.C.T, plant.W, plant.V, plant.N if plant.N.any() else None)[0])


def _theirs(solver: Solver, cases: list[Case]) -> Tally:
    """Tally the errors of a peer; `doubted` are answers that came with a warning."""
    tally = Tally()
    for name, plant, error in cases:
        assert error is not None
        start = time.process_time()
        try:
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                P = solver(plant)
        except (ArithmeticError, ValueError, RuntimeError, Warning) as failure:
            tally.refused[name] = type(failure).__name__
            continue
        finally:
            tally.seconds += time.process_time() - start
        tally.errors[name] = error(P)
        if said:
            tally.doubted.append(name)
    return tally


def _peer_row(name: str, tally: Tally) -> Row:
    silent = tally.silent
    value = (
        f"{tally.worst}, {len(silent)} silently wrong by more than {SILENT:g}: {', '.join(silent[:6]) or 'none'}, "
        f"{len(tally.refused)} without an answer, {tally.seconds:.1f} s"
    )
    return Row(name, value, "for comparison", True)


def _large(example: Example) -> Row:
    """Solve an example of several hundred states once."""
    start = time.process_time()
    solution = solve_riccati(example.plant)
    seconds = time.process_time() - start
    found = solution.reason or f"{solution.status}, stated error {solution.relative_error:.1e}"
    value = f"{found}, condition {solution.condition:.1e}, {seconds:.0f} s"
    name = f"{example.name}, n = {example.plant.n}"
    return Row(name, value, f"an answer with its error, or a named refusal, in {SECONDS:g} s", seconds <= SECONDS)


def _on_hard_plants() -> list[Row]:
    plants = list(hard_plants())
    ours = _ours([(name, plant, None) for name, plant in plants])
    cases: list[Case] = []
    for name, plant in plants:
        enclosure = enclose_riccati(plant)
        size = float(np.linalg.norm(enclosure.centre)) or 1.0
        cases.append((name, plant, lambda P, enclosure=enclosure, size=size: enclosure.distance(P) / size))
    named = f"{HARD} hard plants, n = 1..20"
    return [_our_row(named, ours), *(_peer_row(f"{named}, {peer}", _theirs(f, cases)) for peer, f in _peers())]


def _two_hundred(kind: str) -> Row:
    """Validate a plant of 200 states, of which the routes that answer have to agree."""
    start = time.process_time()
    validation = validate(random_plant(kind, 200, 20, seed=1))
    seconds = time.process_time() - start
    agreeing = [route.name for route in validation.routes if route.agrees]
    others = {route.status for route in validation.routes if not route.agrees}
    value = f"{', '.join(agreeing)} agree, certificate {validation.certificate.status}, {seconds:.0f} s"
    named = all(status.startswith("not ") for status in others)
    ok = {"riccati", "integral"} <= set(agreeing) and named and seconds <= SECONDS
    return Row(f"lmi validate, {kind}, n = 200", value, f"Riccati and the integral, the rest named, {SECONDS:g} s", ok)
