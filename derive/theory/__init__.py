"""Lectures: each displayed equation derived, with its certificate."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from derive.errors import InputError

if TYPE_CHECKING:
    from derive.context import Theory
    from derive.derivation import Lecture

__all__ = ["LECTURES", "OWN_PAGE", "THEORIES", "lecture", "theory"]

LECTURES = {
    "observer": "derive.theory.observer",
    "covariance": "derive.theory.covariance",
    "luenberger": "derive.theory.luenberger",
    "kalman-bucy": "derive.theory.kalman_bucy",
    "scalar": "derive.theory.scalar",
    "spectrum": "derive.theory.spectrum",
    "spectrum-dt": "derive.theory.spectrum_dt",
    "duality": "derive.theory.duality",
}
OWN_PAGE = frozenset({"kalman-bucy", "scalar", "spectrum", "spectrum-dt"})  # each has a page beside the tour's
THEORIES = {
    "observer-ct": "derive.theory.observer",
    "covariance-ct": "derive.theory.covariance",
    "luenberger-dt": "derive.theory.luenberger",
    "kalman-bucy": "derive.theory.kalman_bucy",
    "scalar": "derive.theory.scalar",
    "spectrum": "derive.theory.spectrum",
    "spectrum-dt": "derive.theory.spectrum_dt",
    "duality": "derive.theory.duality",
    "lqr-dt": "derive.theory.regulator:discrete",
    "lqr-ct": "derive.theory.regulator:continuous",
}


@cache
def lecture(key: str) -> Lecture:
    """Return a lecture by its key, every step proved while it is built."""
    return import_module(_find(key, LECTURES, "lecture")).lecture()


@cache
def theory(key: str) -> Theory:
    """Return an installed theory by its key."""
    module, _, function = _find(key, THEORIES, "theory").partition(":")
    return getattr(import_module(module), function or "theory")()


def _find(key: str, table: dict[str, str], kind: str) -> str:
    if key not in table:
        raise InputError(f"{kind} {key!r}: unknown; known are {', '.join(table)}")
    return table[key]
