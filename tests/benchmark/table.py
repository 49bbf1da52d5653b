"""What a section of the benchmark returns, and how a function is timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

Result = TypeVar("Result")


@dataclass(frozen=True)
class Row:
    """One measurement: its name, what was measured, what is asked for, and whether that is met."""

    name: str
    value: str
    target: str
    ok: bool


def best_of(times: int, function: Callable[[], Result]) -> tuple[float, Result]:
    """Return the shortest of several runs in seconds, and what the last one returned."""
    shortest = float("inf")
    while True:
        start = time.perf_counter()
        result = function()
        shortest = min(shortest, time.perf_counter() - start)
        times -= 1
        if times <= 0:
            return shortest, result
