"""Finding exact proofs that no gain meets a request; `lmi.certificate.design_infeasible` decides."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from derive.numeric.plant import Plant
from lmi.certificate.arithmetic import TooLargeError
from lmi.certificate.design import Floor, proper
from lmi.certificate.design_infeasible import Unseen, floor_squared, keeps_a_mode
from lmi.certificate.design_report import DIGITS, above_exp, root_below
from lmi.certificate.report import at_least
from lmi.certificate.sandwich import ExactPlant, exact_plant
from lmi.certification.boundary import unseen
from lmi.certification.design_floor import certified_floor
from lmi.certification.sandwich import NotCertifiedError

__all__ = ["Infeasible", "certify_infeasible"]

GAPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
"""By how much more than the norm asked for every gain is tried to be proved to have, relative."""

SHARES = (0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1e-1)
"""By how much less than a mode is claimed, relative."""


@dataclass(frozen=True)
class Infeasible:
    """A proof that no gain meets a request.

    Attributes:
        specification: the one that fails.
        reason: what is proved, as text.
        proof: the floor of the norm, or the states that no output sees.
        bound: the norm that every gain has at least; the real part (discrete: modulus) that a mode has at least.
    """

    specification: Literal["gamma", "decay"]
    reason: str
    proof: Floor | Unseen
    bound: Fraction


def certify_infeasible(plant: Plant, *, gamma: float | None = None, decay: float | None = None) -> Infeasible:
    """Prove that no gain stabilises with an H-infinity norm of at most gamma, or that none has a decay.

    Requests are taken one by one: that two cannot be met together is not proved here.

    Args:
        plant: V > 0.
        gamma: the H-infinity norm asked for, or None.
        decay: the decay rate asked for: every mode with Re <= -decay [1/s], in discrete time modulus
            <= exp(-decay dt), dt = 1 if none; or None.

    Raises:
        NotCertifiedError: no proof found.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> plant = plant_from_mapping({"time": "continuous", "A": 0.0, "C": 1.0, "W": 1.0, "V": 1.0})
        >>> proof = certify_infeasible(plant, gamma=0.9)
        >>> proof.specification, proof.bound > 0.99
        ('gamma', True)
    """
    exact = exact_plant(plant)
    if decay is not None:
        kept = _kept_mode(plant, exact, decay)
        if kept is not None:
            return kept
    if gamma is not None:
        above = _above(exact, gamma)
        if above is not None:
            return above
    asked = ", ".join(f"{name} {x:g}" for name, x in (("gamma", gamma), ("decay", decay)) if x is not None)
    raise NotCertifiedError(f"{asked}: no proof that a gain cannot reach it")


def _above(plant: ExactPlant, gamma: float) -> Infeasible | None:
    """Prove a floor above gamma, the highest of a few."""
    for gap in GAPS:
        target = max(gamma, 0.0) * (1 + gap)
        try:
            floor = certified_floor(plant, target, 2 * target)
        except (NotCertifiedError, TooLargeError):
            continue
        squared = floor_squared(plant, floor)
        if squared is not None and squared > Fraction(max(gamma, 0.0)) ** 2:
            bound = root_below(squared)
            enlarged = ", with noise and weight enlarged to be semidefinite" if any(proper(plant)[1]) else ""
            reason = f"every stabilising gain has an H-infinity norm of at least {at_least(bound, DIGITS)}{enlarged}"
            return Infeasible("gamma", reason, floor, bound)
    return None


def _kept_mode(plant: Plant, exact: ExactPlant, decay: float) -> Infeasible | None:
    states = unseen(exact)
    if states is None:
        return None
    basis, moved = states
    proof = Unseen(basis, moved)
    for bound in _bounds(plant, proof, decay):
        try:
            if keeps_a_mode(exact, proof, bound):
                what = "real part" if plant.is_continuous else "modulus"
                reason = f"for every gain a mode that no output sees has {what} at least {at_least(bound, DIGITS)}"
                return Infeasible("decay", reason, proof, bound)
        except TooLargeError:
            return None
    return None


def _bounds(plant: Plant, proof: Unseen, decay: float) -> Iterator[Fraction]:
    """Iterate over bounds that contradict the decay, the highest first."""
    T = np.array([[float(proof.T[i, j]) for j in range(proof.T.shape[1])] for i in range(proof.T.shape[0])])
    modes = np.linalg.eigvals(T)
    slowest = float(modes.real.max() if plant.is_continuous else np.abs(modes).max())
    for share in SHARES:
        bound = Fraction(slowest - share * abs(slowest))
        exponent = Fraction(decay) * Fraction(plant.dt or 1)
        if bound > -Fraction(decay) if plant.is_continuous else above_exp(bound, exponent):
            yield bound
