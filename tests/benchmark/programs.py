"""The convex programs and the interior-point method: hard plants against their enclosures, sizes, and other tools."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

import numpy as np

from derive.numeric.balls import floats
from derive.numeric.enclosure import enclose_riccati
from derive.numeric.plant import Plant
from lmi.enclosure import NUMERICAL_ERRORS
from lmi.interior_point import solve_interior_point
from lmi.programs.h2 import h2
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.routes import ROUTES, Answer, RouteSpec, nuclear_norm
from lmi.scaling import balanced, scaled_plant
from lmi.solve import solve_program
from tests.benchmark.certificates import hard_plants
from tests.benchmark.table import Row, best_of
from tests.derive.numeric.plants import random_plant

TIMES = ("continuous", "discrete")
DIGITS = 25
TRUSTED = 1e-7  # relative error up to which a route's own estimate lets it confirm another one
UNEXPLAINED = 10.0
ROUNDING = 1e-12
SHARE = 0.98
GOOD = {"lmi-dual": 1e-10, "interior-point": 1e-12}
EVERY = {"lmi-h2": 3}  # the slow one runs on every third plant only
SECONDS = {50: 2.0, 100: 60.0}
PEERS = {"PICOS with CVXOPT": 5.0, "plain cvxpy": 10.0}
PEER_SIZE = 50


def programs() -> list[Row]:
    """Return what the routes make of the hard plants, what a second solve costs, and times at n = 50 and 100."""
    return [*_on_hard_plants(), *(_again(n, build) for n in (4, 10) for build in BUILDS), *_large(), *_peers()]


# ------------------------------------------------------------------------------------------------ hard plants
@dataclass
class _Tally:
    """Errors of one route, of tr(M P) without cancellation and relative to it, and the plants where they are large."""

    errors: list[float] = field(default_factory=list)
    beyond: list[str] = field(default_factory=list)
    silent: list[str] = field(default_factory=list)
    trusted: int = 0


def _on_hard_plants() -> list[Row]:
    specs = [spec for spec in ROUTES if spec.name in ("riccati", "lmi-primal", "lmi-dual", "lmi-h2", "interior-point")]
    tallies = {spec.name: _Tally() for spec in specs}
    open_ = []
    for count, (name, plant) in enumerate(hard_plants()):
        enclosure = enclose_riccati(plant, DIGITS)
        if enclosure.P is None:
            open_.append(name)
            continue
        truth = floats(enclosure.P)
        for spec in specs:
            if count % EVERY.get(spec.name, 1) == 0:
                _judge(tallies[spec.name], spec, name, plant, truth)
    rows = [row for name, tally in tallies.items() for row in _rows(name, tally)]
    return [*rows, Row("plants without an enclosure", ", ".join(open_) or "none", "named", True)]


def _judge(tally: _Tally, spec: RouteSpec, name: str, plant: Plant, truth: np.ndarray[Any, Any]) -> None:
    answer = _answer(spec, plant)
    if answer.status.startswith("not "):
        return
    size = nuclear_norm(plant, truth) or nuclear_norm(plant, _unit(plant))
    error = np.inf if answer.P is None else nuclear_norm(plant, answer.P - truth) / size
    admitted = answer.error / size
    tally.errors.append(error)
    tally.trusted += admitted <= TRUSTED
    if admitted <= TRUSTED and error > UNEXPLAINED * admitted + ROUNDING:
        tally.silent.append(f"{name}: error {error:.0e}, admitted {admitted:.0e}")
    if error > GOOD.get(spec.name, np.inf):
        tally.beyond.append(f"{name}: {error:.0e}, {answer.status.partition(':')[0]}")


def _answer(spec: RouteSpec, plant: Plant) -> Answer:
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return spec.run(plant)
    except NUMERICAL_ERRORS as error:
        return Answer(f"failed: {error}")


def _unit(plant: Plant) -> np.ndarray[Any, Any]:
    """Return the natural size of a covariance that is zero."""
    T = balanced(plant).T
    return T @ T.T


def _rows(name: str, tally: _Tally) -> Iterator[Row]:
    errors = np.array(tally.errors)
    median, most = np.quantile(errors, [0.5, SHARE], method="lower")
    each = f", every {EVERY[name]}rd plant" if name in EVERY else ""
    value = f"{len(tally.silent)} silent {'; '.join(tally.silent)}".strip()
    value += f", trusted {tally.trusted} of {len(errors)}{each}, error median {median:.0e}, 98 % {most:.0e}"
    yield Row(f"{name} on hard plants", value, "0 silent failures", not tally.silent)
    if name in GOOD:
        share = float(np.mean(errors <= GOOD[name]))
        value = f"{100 * share:.1f} % within {GOOD[name]:g}, beyond: {'; '.join(tally.beyond) or 'none'}"
        yield Row(
            f"{name}, accuracy", value, f"{100 * SHARE:g} % within {GOOD[name]:g}, the rest named", share >= SHARE
        )


# ------------------------------------------------------------------------------------------------ data anew
COMPILED = 4  # states up to which compiling takes longer than solving

BUILDS = (optimal_covariance, optimal_covariance_dual, h2)


def _again(n: int, build: Callable[[Plant], Any]) -> Row:
    """Compare a program stated, compiled and solved with one that only takes new data."""
    plants = [_scaled(random_plant("continuous", n, n // 2, seed=seed)) for seed in (1, 2)]
    program = build(plants[0])
    solve_program(program)
    anew, fresh = _processor_time(lambda: _solved(build(plants[1])))
    again, loaded = _processor_time(lambda: _solved(program, plants[1]))
    same = all(np.allclose(x, y, rtol=1e-9, atol=1e-12) for x, y in zip(fresh, loaded, strict=True))
    value = f"{anew:.3f} s anew, {again:.3f} s with new data, {anew / again:.1f} times"
    name, small = f"{build.__name__}, n = {n}, solved again", n <= COMPILED
    return Row(name, value, "same answer, faster" if small else "same answer", same and (again < anew or not small))


def _processor_time(function: Callable[[], Any]) -> tuple[float, Any]:
    """Return the shortest of three runs, in a time that other work on the machine leaves alone, and its result."""
    runs = []
    for _ in range(3):
        start = time.process_time()
        found = function()
        runs.append((time.process_time() - start, found))
    return min(runs, key=lambda run: run[0])


def _scaled(plant: Plant) -> Plant:
    return scaled_plant(plant, balanced(plant))


def _solved(program: Any, plant: Plant | None = None) -> Any:
    if plant is not None:
        assert program.load(plant)
    solve_program(program)
    return program.answer()


# ------------------------------------------------------------------------------------------------ size, and peers
def _large() -> Iterator[Row]:
    for n, limit in SECONDS.items():
        for kind in TIMES:
            plant = random_plant(kind, n, n // 3, seed=1)
            seconds, found = best_of(3 if n == PEER_SIZE else 1, lambda plant=plant: solve_interior_point(plant))
            error = _error(plant, found.P)
            value = f"{found.status}, {seconds:.2f} s, error {error:.0e}, {len(found.history) - 1} steps"
            ok = error <= GOOD["interior-point"] and seconds <= limit
            yield Row(f"interior point, {kind}, n = {n}", value, f"1e-12, {limit:g} s", ok)


def _error(plant: Plant, P: Any) -> float:
    truth = enclose_riccati(plant, DIGITS)
    if P is None or truth.P is None:
        return np.inf
    return float(np.linalg.norm(P - floats(truth.P)) / np.linalg.norm(floats(truth.P)))


def _peers() -> Iterator[Row]:
    """Compare on one continuous plant, each peer called once: they take from seconds to minutes."""
    plant = random_plant("continuous", PEER_SIZE, PEER_SIZE // 3, seed=1)
    ours = best_of(3, lambda: solve_interior_point(plant))[0]
    for name, peer in (("PICOS with CVXOPT", _picos), ("plain cvxpy", _plain_cvxpy)):
        where = f"interior point against {name}, n = {PEER_SIZE}, one run"
        if name.startswith("PICOS") and not (find_spec("picos") and find_spec("cvxopt")):
            yield Row(where, "not installed", f"{PEERS[name]:g} times faster", True)
            continue
        start = time.perf_counter()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                error = _error(plant, peer(plant))
            word = f"error {error:.0e}"
        except Exception as failure:  # whatever a peer raises is its result
            word = f"failed: {type(failure).__name__}"
        seconds = time.perf_counter() - start
        value = f"{ours:.2f} s, they {seconds:.1f} s, {word}: {seconds / ours:.0f} times faster"
        yield Row(where, value, f"{PEERS[name]:g} times faster", seconds >= PEERS[name] * ours)


def _plain_cvxpy(plant: Plant) -> Any:
    """Solve the program as one would write it down: no scaling, default solver."""
    import cvxpy as cp

    P = cp.Variable((plant.n, plant.n), symmetric=True)
    A, C = plant.A, plant.C
    inequality = cp.bmat([[A @ P + P @ A.T + plant.W, P @ C.T + plant.N], [C @ P + plant.N.T, plant.V]])
    cp.Problem(cp.Maximize(cp.trace(P)), [inequality >> 0]).solve(solver=cp.CLARABEL)
    return P.value


def _picos(plant: Plant) -> Any:
    """Solve the same program, as one would write it down for PICOS."""
    import picos

    problem = picos.Problem()
    P = picos.SymmetricVariable("P", (plant.n, plant.n))
    A, C = picos.Constant("A", plant.A), picos.Constant("C", plant.C)
    W, V, N = picos.Constant("W", plant.W), picos.Constant("V", plant.V), picos.Constant("N", plant.N)
    problem.add_constraint(((A * P + P * A.T + W & P * C.T + N) // (C * P + N.T & V)) >> 0)
    problem.set_objective("max", picos.trace(P))
    problem.solve(solver="cvxopt")
    return np.array(P.value)
