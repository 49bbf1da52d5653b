"""`lmi design`: are the smallest H-infinity norms certified from both sides, and the least costs; the time it takes."""

from __future__ import annotations

import statistics
import time

from lmi.certificate.design import verify_design
from lmi.synthesis.designs import Design, Verdict, design
from tests.benchmark.table import Row
from tests.derive.numeric.plants import random_plant

TIMES = ("continuous", "discrete")
SIZES = range(1, 11)
GAP = 1e-4
EXCESS = 1e-10


def designs() -> list[Row]:
    """Return, for both objectives, how many of 20 plants are certified, the largest gap, and the time."""
    design(random_plant("continuous", 2, seed=0), "hinf")  # the first call imports
    return [_smallest_norms(), _least_costs()]


def _smallest_norms() -> Row:
    found, seconds = _found("hinf")
    gaps = [_gap(one) for one in found]
    certified = sum(one.verdict is Verdict.CERTIFIED for one in found)
    value = f"{certified} of {len(found)} certified, largest gap {max(gaps):.1e}, {_times(seconds)}"
    ok = certified == len(found) and max(gaps) <= GAP
    return Row("smallest H-infinity norm, n = 1..10", value, f"all, gap {GAP:g}", ok)


def _least_costs() -> Row:
    found, seconds = _found("h2")
    excess = [_excess(one) for one in found]
    certified = sum(one.verdict is Verdict.CERTIFIED for one in found)
    value = f"{certified} of {len(found)} certified, largest excess {max(excess):.1e}, {_times(seconds)}"
    ok = certified == len(found) and max(excess) <= EXCESS
    return Row("least cost, n = 1..10", value, f"all, excess {EXCESS:g}", ok)


def _found(objective: str) -> tuple[list[Design], list[float]]:
    found, seconds = [], []
    for n in SIZES:
        for kind in TIMES:
            start = time.perf_counter()
            found.append(design(random_plant(kind, n, seed=n), objective))
            seconds.append(time.perf_counter() - start)
    return found, seconds


def _gap(one: Design) -> float:
    """Return by how much the proved norm of the gain exceeds the proved floor of every gain, relative."""
    bounds = None if one.certificate is None else verify_design(one.certificate)[1]
    if bounds is None or bounds.gamma is None or not bounds.floor_squared:
        return float("inf")
    return float(bounds.gamma**2 / bounds.floor_squared) ** 0.5 - 1


def _excess(one: Design) -> float:
    """Return by how much the proved cost of the gain exceeds the least possible, relative."""
    bounds = None if one.certificate is None else verify_design(one.certificate)[1]
    return float("inf") if bounds is None else float(bounds.cost.cost.width / bounds.cost.cost.upper)


def _times(seconds: list[float]) -> str:
    return f"{statistics.median(seconds):.2f} s in the median, {max(seconds):.2f} s at most"
