"""Theories as claims are read in them, by key."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from derive.errors import InputError

if TYPE_CHECKING:
    from derive.theory.claims.base import ClaimTheory

__all__ = ["THEORIES", "claim_theory"]

THEORIES = {
    "observer-ct": "observer",
    "covariance-ct": "covariance",
    "kalman-bucy": "kalman_bucy",
    "luenberger-dt": "luenberger",
    "lqr-ct": "regulator_ct",
    "lqr-dt": "regulator_dt",
}


@cache
def claim_theory(key: str) -> ClaimTheory:
    """Return the theory in which claims with this key are read.

    Raises:
        InputError: unknown key.

    Example:
        >>> claim_theory("luenberger-dt").theory.symbols["P"].rows
        'n'
    """
    if key not in THEORIES:
        raise InputError(f"theory: expected {', '.join(THEORIES)}, got {key!r}")
    return import_module(f"derive.theory.claims.{THEORIES[key]}").outline().claims()
