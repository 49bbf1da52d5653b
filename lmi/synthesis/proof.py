"""Proofs about a request: that a gain meets it and is best, or that no gain can meet it."""

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.numeric.modes import format_mode, undetectable_mode
from derive.numeric.plant import Plant
from lmi.certificate.arithmetic import TooLargeError
from lmi.certification.sandwich import NotCertifiedError
from lmi.synthesis.request import Request
from lmi.synthesis.search import Judged, smallest_norm
from lmi.synthesis.shift import radius_of, shifted

if TYPE_CHECKING:
    from lmi.certificate.design import DesignCertificate

__all__ = ["Impossible", "certify", "hidden_mode", "why_not"]

GAP = 9.5e-5
"""The floor that is certified for every gain is below the norm of the gain found by this, relative."""

MARGIN = 1e-6
"""The certified bound of a norm exceeds the computed one by this, relative, as room for the certificate's rounding."""


NOTHING = 1e-12
"""The norm that is certified where the computed one is 0: rounding may have left noise out, so that 0 is no proof."""

EXCESS = 1e-4
"""Part of the cost by which it may exceed the least possible, where the least is asked for."""

SHARP = 2.2e-4
"""A floor is looked for from here below the smallest norm found, relative."""


@dataclass(frozen=True)
class Impossible:
    """Which specification fails and why, and whether that is proved."""

    reason: str
    proved: bool


def certify(plant: Plant, request: Request, found: Judged) -> tuple["DesignCertificate | None", str]:
    """Make the certificate of a gain.

    Returns:
        The certificate or None, and what it fails to prove, empty when it proves all that was asked.
    """
    gamma = request.gamma or found.norm * (1 + MARGIN) or NOTHING
    problems = []
    for norm, floor in _claims(gamma, _floor(plant, request, found)):
        try:
            certificate = _certified(plant, found, request, norm, floor)
        except (NotCertifiedError, TooLargeError) as error:
            problems.append(str(error))
            continue
        if request.objective == "hinf":
            return certificate, problems[-1] if problems else ""
        return certificate, "" if request.decay is not None else _excess(certificate, found)
    return None, problems[-1]


def _excess(certificate: "DesignCertificate", found: Judged) -> str:
    """Say by how much the cost may exceed the least possible, if that is not negligible."""
    from lmi.certificate.design import verify_design
    from lmi.certificate.report import at_most

    bounds = verify_design(certificate)[1]
    cost = None if bounds is None else bounds.cost.cost
    if cost is None or found.achieved.cost == 0.0 or cost.width <= Fraction(EXCESS) * cost.upper:
        return ""
    return f"the cost may exceed the least possible by the relative {at_most(cost.width / cost.upper, 3)}"


def _floor(plant: Plant, request: Request, found: Judged) -> float | None:
    """Return what is to be proved to be no more than the norm of every stabilising gain, whatever its decay."""
    if request.objective == "h2" or request.gamma is not None:
        return None
    free = found if request.decay is None else smallest_norm(plant, None)
    return None if free is None else free.achieved.hinf.lower * (1 - GAP)


def _claims(gamma: float, floor: float | None) -> list[tuple[float | None, float | None]]:
    """Return pairs of a norm and a floor to prove, the strongest first."""
    return [*([(gamma, floor)] if floor else []), (gamma, None), (None, None)]


def _certified(
    plant: Plant, found: Judged, request: Request, gamma: float | None, floor: float | None
) -> "DesignCertificate":
    from lmi.certification.design import certify_design

    return certify_design(plant, found.gain, gamma=gamma, decay=request.decay, floor=floor)


# ------------------------------------------------------------------------------------------------ impossible requests
def hidden_mode(plant: Plant, request: Request) -> Impossible | None:
    """Tell whether a mode that no gain moves decays too slowly."""
    if request.decay is None:
        return None
    moved = shifted(plant, request.decay)
    hidden = undetectable_mode(moved.A, moved.C, plant.time)
    if hidden is None:
        return None
    mode = hidden - request.decay if plant.is_continuous else hidden * radius_of(plant, request.decay)
    word = "uncontrollable" if request.dual else "unobservable"
    reason = f"decay {request.decay:g} fails: mode {format_mode(mode)} is {word} and stays with every gain"
    decided = _decided(plant, reason, decay=request.decay)
    return decided if decided.proved else None


def why_not(plant: Plant, request: Request, nearest: Judged | None) -> Impossible:
    """Tell which specification of a request fails.

    Args:
        plant: the plant.
        request: what no gain was found for.
        nearest: the gain of the smallest norm found that has the decay, or None.
    """
    if request.gamma is None:
        return Impossible("no gain was found that stabilises" + _with_decay(request), False)
    free = nearest if request.decay is None else smallest_norm(plant, None)
    if request.decay is not None and free is not None and free.norm <= request.gamma:
        return _together(request, nearest)
    near = "no gain was found" if free is None else f"the smallest norm found is {free.norm:.8g}"
    least = 0.0 if free is None else free.norm * (1 - SHARP)
    return _decided(plant, f"gamma {request.gamma:g} fails: {near}", gamma=max(least, request.gamma))


def _together(request: Request, nearest: Judged | None) -> Impossible:
    reach = "" if nearest is None else f", at the decay the smallest norm found is {nearest.norm:.6g}"
    reason = f"gamma {request.gamma:g} and decay {request.decay:g} fail together: each alone can be met{reach}"
    return Impossible(f"{reason}; not proved", False)


def _with_decay(request: Request) -> str:
    return "" if request.decay is None else f" and has decay {request.decay:g}"


def _decided(plant: Plant, reason: str, gamma: float | None = None, decay: float | None = None) -> Impossible:
    """Say whether it is proved that no gain has an H-infinity norm of at most gamma, or the decay."""
    from lmi.certification.design_infeasible import certify_infeasible

    try:
        proof = certify_infeasible(plant, gamma=gamma, decay=decay)
    except (NotCertifiedError, TooLargeError):
        return Impossible(f"{reason}; not proved", False)
    return Impossible(f"{reason}; proved: {proof.reason}", True)
