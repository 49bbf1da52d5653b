"""Exact certificates: the width of the sandwich and its time, and how many of 300 hard plants get one."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np

from derive.errors import InputError
from derive.numeric.plant import Plant, plant_from_mapping
from lmi.certificate.sandwich import verify
from lmi.certification.sandwich import NotCertifiedError, certified
from tests.benchmark.table import Row
from tests.derive.numeric.plants import random_plant
from tests.derive.numeric.test_log_det import chain

TIMES = ("continuous", "discrete")
SECONDS = {20: 0.06, 50: 5.0}
WIDTH = 1e-29
HARD = 300
SHARE = 0.99
TIGHT = 1e-20
DAMPING = 1e-3


def certificates() -> list[Row]:
    """Return width and time at n = 20 and 50, and what becomes of the hard plants."""
    return [*(_measured(n, kind) for n in SECONDS for kind in TIMES), *_on_hard_plants()]


def _measured(n: int, kind: str) -> Row:
    plant = random_plant(kind, n, seed=1)
    start = time.process_time()
    certificate, bounds = certified(plant)
    whole = time.process_time() - start
    start = time.process_time()
    proved = verify(certificate)[1] is not None
    seconds = time.process_time() - start
    width = float(bounds.trace.width / bounds.trace.upper)
    value = f"relative width {width:.1e}, verified in {seconds:.3f} s, made in {whole - seconds:.2f} s"
    ok = proved and width <= WIDTH and seconds <= SECONDS[n] and whole <= 5.0
    return Row(f"{kind}, n = {n}", value, f"{WIDTH:g}, {SECONDS[n]:g} s, all in 5 s", ok)


def _on_hard_plants() -> list[Row]:
    found: Counter[str] = Counter()
    refused, widths = [], []
    for name, plant in hard_plants():
        try:
            bounds = certified(plant)[1]
        except NotCertifiedError as error:
            refused.append(f"{name}: {error}")
            continue
        width = float(bounds.trace.width / bounds.trace.upper) if bounds.trace.upper else 0.0
        found["certified"] += 1
        widths.append(width)
    share = found["certified"] / HARD
    tight = sum(width <= TIGHT for width in widths)
    value = f"{100 * share:.1f} % certified, {tight} within {TIGHT:g}, refused {'; '.join(refused) or 'none'}"
    return [Row(f"{HARD} hard plants, n = 1..20", value, f"{100 * SHARE:g} %, the rest named", share >= SHARE)]


def hard_plants() -> Iterator[tuple[str, Plant]]:
    """Iterate over seeded hard plants that are detectable, n = 1..20, continuous and discrete."""
    count = 0
    seed = 0
    while count < HARD:
        for n in range(1, 21):
            for kind in TIMES:
                family = list(FAMILIES)[(n + seed + (kind == "discrete")) % len(FAMILIES)]
                rng = np.random.default_rng([seed, n, kind == "discrete"])
                try:
                    plant = FAMILIES[family](rng, n, kind)
                except InputError:
                    continue  # not detectable in double precision
                if count < HARD:
                    count += 1
                    yield f"{family} {kind} n = {n} seed {seed}", plant
        seed += 1


def _random(rng: np.random.Generator, n: int, kind: str, growth: float, rank: int) -> Plant:
    """Return a plant whose noise has a rank, with some outputs, its states growing or not."""
    l = int(rng.integers(1, max(2, n // 3 + 1)))  # noqa: E741
    A = rng.standard_normal((n, n)) / np.sqrt(n)
    A = A + growth * np.eye(n) if kind == "continuous" else A * (1 + growth)
    G = rng.standard_normal((n, rank)) / np.sqrt(n)
    H = rng.standard_normal((l, l)) / np.sqrt(l)
    V = H @ H.T + 0.1 * np.eye(l)
    return plant_from_mapping({"time": kind, "A": A, "C": rng.standard_normal((l, n)), "W": G @ G.T, "V": V})


def _unstable(rng: np.random.Generator, n: int, kind: str) -> Plant:
    return _random(rng, n, kind, 0.3, n)


def _singular(rng: np.random.Generator, n: int, kind: str) -> Plant:
    return _random(rng, n, kind, -0.3, 1)


def _without_noise(rng: np.random.Generator, n: int, kind: str) -> Plant:
    return _random(rng, n, kind, 0.2, 0)


def _chain(rng: np.random.Generator, n: int, kind: str) -> Plant:
    return chain(max(1, n // 2), DAMPING, kind)


def _scaled(rng: np.random.Generator, n: int, kind: str) -> Plant:
    plant = _random(rng, n, kind, 0.1, n)
    s, r = (2.0 ** rng.integers(-bits, bits + 1, size) for bits, size in ((20, n), (10, plant.l)))
    A, C = s[:, None] * plant.A / s, r[:, None] * plant.C / s
    return plant_from_mapping(
        {"time": kind, "A": A, "C": C, "W": plant.W * np.outer(s, s), "V": plant.V * np.outer(r, r)}
    )


FAMILIES: dict[str, Callable[[np.random.Generator, int, str], Plant]] = {
    "unstable": _unstable,
    "singular W": _singular,
    "W = 0": _without_noise,
    "chain": _chain,
    "scaled": _scaled,
}
