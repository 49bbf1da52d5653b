"""Finding exact proofs that a gain does not stabilise; `lmi.certificate.stability` decides."""

from collections.abc import Iterator
from fractions import Fraction
from typing import cast

import numpy as np

from derive.numeric.modes import Matrix, Time, balancing, distance_to_stability
from derive.numeric.plant import Plant
from lmi.certificate.arithmetic import Exact, TooLargeError
from lmi.certificate.sandwich import exact_plant
from lmi.certificate.stability import proved_unstable, stabilises

__all__ = ["instability", "is_stable"]

SHARES = (0.99, 0.9, 0.7, 0.5, 0.3, 0.1)
"""Fractions of the growth of the fastest mode that are tried as the proved growth."""


def is_stable(loop: Matrix, time: Time) -> bool:
    """Tell whether computed eigenvalues are stable; that proves nothing."""
    return bool(np.all(distance_to_stability(np.linalg.eigvals(loop), time) < 0))


def instability(plant: Plant, gain: Matrix) -> str | None:
    """Prove that A - L C is not stable, and say what is proved; None when it is stable, or nothing is proved.

    Args:
        plant: the plant.
        gain: L (n, l).
    """
    exact, L = exact_plant(plant), Exact.of_floats(gain.tolist())
    for rate, Y, v in _witnesses(plant, gain):
        if proved_unstable(exact, L, rate, Y, v):
            least = float(rate)
            if plant.is_continuous:
                return f"A - LC has a mode with real part at least {least:.6g}" if least else "A - LC is not stable"
            return f"A - LC has a mode with modulus at least {least:.6g}"
    try:
        stable = stabilises(exact, L)
    except TooLargeError:
        return None
    return None if stable else "A - LC has a mode that is not inside the region of stability, by Routh's criterion"


def _witnesses(plant: Plant, gain: Matrix) -> Iterator[tuple[Fraction, Exact, list[Fraction]]]:
    """Iterate over (rate, Y, v) in the plant's coordinates, computed in balanced ones."""
    loop = plant.A - gain @ plant.C
    t = balancing(loop)
    loop = loop * t / t[:, None]
    modes = np.linalg.eigvals(loop)
    growth = float(modes.real.max()) if plant.is_continuous else float(np.abs(modes).max()) - 1.0
    if not growth > 0:
        return
    for share in SHARES:
        rate = Fraction(share * growth) + (0 if plant.is_continuous else 1)
        Y = _lyapunov(plant, loop, float(rate))
        if not np.isfinite(Y).all():
            continue
        v = np.linalg.eigh(Y)[1][:, 0]
        yield rate, Exact.of_floats((Y * np.outer(t, t)).tolist()), [Fraction(x) for x in (v / t).tolist()]


def _lyapunov(plant: Plant, loop: Matrix, rate: float) -> Matrix:
    """Return Y with (loop - rate) Y + Y (loop - rate)' = -I, in discrete time for loop / rate, or not numbers."""
    from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

    one = np.eye(len(loop))
    try:
        if plant.is_continuous:
            Y = cast(Matrix, solve_continuous_lyapunov(loop - rate * one, -one))
        else:
            Y = cast(Matrix, solve_discrete_lyapunov(loop / rate, one))
    except np.linalg.LinAlgError:
        return np.full_like(loop, np.nan)
    return (Y + Y.T) / 2
