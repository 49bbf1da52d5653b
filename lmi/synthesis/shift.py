"""Prescribed degree of stability: a decay is stability of the plant with its modes moved."""

from dataclasses import replace

import numpy as np

from derive.numeric.plant import Plant

__all__ = ["radius_of", "shifted"]


def radius_of(plant: Plant, decay: float) -> float:
    """Return the modulus exp(-decay dt) of a mode that falls at a rate, in discrete time; dt = 1 without one."""
    return float(np.exp(-decay * (plant.dt or 1.0)))


def shifted(plant: Plant, decay: float | None) -> Plant:
    """Return the plant with A + a I, in discrete time A / r and C / r: a gain for it gives the plant the decay.

    Its H-infinity norm and its cost are bounds of those of the plant, by the maximum principle and by comparison.

    Source: B. D. O. Anderson and J. B. Moore, Linear system optimisation with prescribed degree of stability, Proc. IEE
        116 (1969) 2083-2087.
    """
    if decay is None:
        return plant
    if plant.is_continuous:
        return replace(plant, A=plant.A + decay * np.eye(plant.n))
    radius = radius_of(plant, decay)
    return replace(plant, A=plant.A / radius, C=plant.C / radius)
