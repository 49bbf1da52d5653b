"""Making certificates of gains: high precision proposes the matrices, `lmi.certificate.design` decides.

In coordinates in which the error covariance of the gain has about a unit diagonal, with loop = A - L C, the witness of
a decay is Y with (loop + a) Y + Y (loop + a)' = -I, in discrete time (loop / r) Y (loop / r)' - Y = -I. Nothing here is
trusted.
"""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import exp, isfinite, nextafter
from typing import Any

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

from derive.numeric.balls import floats, identity, working_bits
from derive.numeric.plant import Plant
from lmi.certificate.design import Decay, DesignCertificate, decay_checks, verify_design
from lmi.certificate.design_report import below_exp
from lmi.certificate.sandwich import Certificate
from lmi.certification.design_norm import SPARE, Coordinates, certified_norm, lyapunov_witness, plain_balls
from lmi.certification.frame import binary_logarithm, sizes
from lmi.certification.sandwich import NotCertifiedError, certified

__all__ = ["certify_design"]

Matrix = NDArray[np.floating[Any]]

PRECISION = 320
"""Working precision in bits."""

SHARES = (1e-7, 1e-4, 1e-2)
"""By how much less than the rate of the slowest mode is claimed, relative; the first that can be proved is taken."""


def certify_design(
    plant: Plant, gain: Matrix, *, gamma: float | None = None, decay: float | None = None, floor: float | None = None
) -> DesignCertificate:
    """Prove what a gain achieves: that it stabilises, its cost, its decay, its H-infinity norm, and what none can beat.

    The decay and the norm are claimed as well as they can be proved, also where none is asked for.

    Args:
        plant: V > 0, (A, C) detectable.
        gain: L (n, l) in doubles, which are taken exactly.
        gamma: the H-infinity norm of the gain has to be at most this.
        decay: every mode has to have Re <= -decay [1/s], in discrete time modulus <= exp(-decay dt), dt = 1 if none.
        floor: no stabilising gain, of whatever decay, is to have an H-infinity norm below this.

    Returns:
        A certificate that was verified and proves all that was asked for.

    Raises:
        UnstableGainError: the gain is proved not to stabilise.
        NotCertifiedError: something that was asked for was not proved; the message says what.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> from derive.numeric.riccati import solve_riccati
        >>> plant = example_plant()
        >>> certificate = certify_design(plant, solve_riccati(plant).gain, decay=0.1)
        >>> _, bounds = verify_design(certificate)
        >>> bool(bounds.decay >= 0.1)
        True
    """
    cost = certified(plant, np.asarray(gain, dtype=float)).certificate
    loop = floats(plain_balls(cost.plant.loop(cost.gain)))
    found = DesignCertificate(cost, _decay(plant, cost, loop, decay), certified_norm(cost, gamma))
    if floor is not None:
        from lmi.certification.design_floor import certified_floor

        reached = floor if found.norm is None else float(found.norm.gamma)
        found = replace(found, floor=certified_floor(cost.plant, floor, reached))
    checks, bounds = verify_design(found)
    if bounds is None:
        raise NotCertifiedError(", ".join(check.statement for check in checks if not check.holds))
    return found


def _decay(plant: Plant, cost: Certificate, loop: Matrix, asked: float | None) -> Decay | None:
    """Return the best decay that is proved, at least the one asked for."""
    for bound in _rates(plant, loop, asked) if plant.is_continuous else _radii(plant, loop, asked):
        try:
            found = _decay_witness(cost, bound)
        except (ArithmeticError, ValueError):
            continue
        if all(check.holds for check in decay_checks(cost.plant, cost.gain, found)):
            return found
    if asked is None:
        return None
    raise NotCertifiedError(f"decay {asked:g}: no proof found that every mode of A - LC falls that fast")


def _rates(plant: Plant, loop: Matrix, asked: float | None) -> Iterator[Fraction]:
    slowest = -float(np.linalg.eigvals(loop).real.max())
    rates = [slowest * (1 - share) for share in SHARES]
    yield from (Fraction(x) for x in rates if isfinite(x) and x > (asked or 0.0))
    if asked is not None:
        yield Fraction(asked)


def _radii(plant: Plant, loop: Matrix, asked: float | None) -> Iterator[Fraction]:
    largest = float(np.abs(np.linalg.eigvals(loop)).max())
    radii = [largest * (1 + share) + (1 - largest) * share * share for share in SHARES]
    exponent = Fraction(asked or 0.0) * Fraction(plant.dt or 1)
    yield from (Fraction(x) for x in radii if isfinite(x) and below_exp(Fraction(x), exponent))
    if asked is not None:
        last = exp(-float(exponent))
        while last > 0 and not below_exp(Fraction(last), exponent):
            last = nextafter(last, 0.0)
        yield Fraction(last)


def _decay_witness(cost: Certificate, bound: Fraction) -> Decay:
    coordinates = Coordinates.of_covariance(cost.P_up)
    with working_bits(PRECISION):
        loop = coordinates.balls(cost.plant.loop(cost.gain), -1, 1)
        number = arb(fmpq(bound.numerator, bound.denominator))
        loop = loop + identity(loop.nrows()) * number if cost.plant.is_continuous else loop * (1 / number)
        Y = lyapunov_witness(loop, identity(loop.nrows()), cost.plant.time)
        rate = max(binary_logarithm(Y[i, i]) for i in range(Y.nrows()))
        bits = max(0, sizes(loop) + rate) + SPARE
        return Decay(bound, coordinates.grid.covariance(Y * arb(2) ** -rate, bits))
