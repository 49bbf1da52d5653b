"""Designing an observer: objective and bounds in, a gain out, with what it achieves and a proof of that.

A convex program proposes the gain. What it achieves is recomputed from the gain alone, and an exact certificate is made
for the gain as it is. Nothing that a solver says is passed on as a fact.

With a decay besides an objective, the program looks for one Lyapunov matrix that proves both. That is sufficient and
not necessary: another gain may do better. What is certified of the gain found holds all the same.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from derive.errors import InputError
from derive.numeric.plant import Plant, as_plant
from lmi.synthesis.achieved import Achieved
from lmi.synthesis.proof import Impossible, certify, hidden_mode, why_not
from lmi.synthesis.request import Request
from lmi.synthesis.search import find_gain
from lmi.synthesis.shift import radius_of

if TYPE_CHECKING:
    from lmi.certificate.design import DesignCertificate

__all__ = ["Design", "Verdict", "design"]

Matrix = NDArray[np.floating[Any]]

SMALLEST_RADIUS = 1e-9
"""Smallest modulus that modes of a discrete plant can be asked to have: beyond, rounding alone moves them outside."""


class Verdict(Enum):
    """What became of a request; the value is the message."""

    CERTIFIED = "certified"
    INFEASIBLE = "infeasible"
    NOT_CERTIFIED = "not certified"

    @property
    def exit_code(self) -> int:
        """0, 1 or 3 for the command line."""
        return {Verdict.CERTIFIED: 0, Verdict.INFEASIBLE: 1, Verdict.NOT_CERTIFIED: 3}[self]


@dataclass(frozen=True, eq=False)
class Design:
    """A gain, what it achieves, and the proof; or why there is none.

    Attributes:
        plant: of the observer's problem; for a dual request the dual plant.
        request: what was asked.
        gain: L (n, l) of the observer x' = A x + B u + L (y - C x), or K (m, n) of u = -K x when dual; None when no
            gain was found that meets the request.
        achieved: computed in floating point from the gain, or None.
        certificate: exact proof of what the gain achieves, or None.
        verdict: certified, infeasible (which is proved), or not certified.
        reason: what is not certified, or which specification fails.
    """

    plant: Plant
    request: Request
    gain: Matrix | None
    achieved: Achieved | None
    certificate: "DesignCertificate | None"
    verdict: Verdict
    reason: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Return the design as plain data, schema lmi-design/1."""
        from lmi.synthesis.file import design_dict

        return design_dict(self)


def design(
    plant: Plant | str | PathLike[str] | Mapping[str, Any],
    objective: str = "h2",
    *,
    gamma: float | None = None,
    decay: float | None = None,
    dual: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Design:
    """Find a gain for a request, recompute what it achieves, and certify it.

    Args:
        plant: V > 0, (A, C) detectable; a file, its keys and values, or a plant. With `dual` A, B, Q, R and optionally
            S, M are read instead, see `derive.numeric.dual`.
        objective: "h2" or "hinf", see `lmi.synthesis.request.Request`.
        gamma: an H-infinity norm that suffices, with "hinf" only.
        decay: least rate of decay [1/s].
        dual: whether to design state feedback.
        progress: called with the name of each stage.

    Raises:
        InputError: no such plant, or a request that makes no sense.

    Example:
        >>> plant = {"time": "continuous", "A": -1.0, "C": 1.0, "W": 1.0, "V": 1.0}
        >>> found = design(plant, "hinf")
        >>> found.verdict.value, abs(found.achieved.hinf.upper / 0.5**0.5 - 1) < 1e-4  # 1/g^2 = C^2/V + A^2/W
        ('certified', True)
    """
    request = Request.of(objective, gamma, decay, dual)
    loaded = _loaded(plant, dual)
    _require_reachable(loaded, request)
    say = progress or (lambda stage: None)
    impossible = hidden_mode(loaded, request)
    if impossible is not None:
        return _without_gain(loaded, request, impossible)
    say("gain")
    found = find_gain(loaded, request)
    if found is None or not request.is_met(found.achieved):
        say("proof that no gain meets the request")
        return _without_gain(loaded, request, why_not(loaded, request, found))
    say("certificate")
    certificate, lacking = certify(loaded, request, found)
    verdict = Verdict.NOT_CERTIFIED if lacking else Verdict.CERTIFIED
    gain = found.gain.T if dual else found.gain
    return Design(loaded, request, gain, found.achieved, certificate, verdict, lacking)


def _without_gain(plant: Plant, request: Request, impossible: Impossible) -> Design:
    verdict = Verdict.INFEASIBLE if impossible.proved else Verdict.NOT_CERTIFIED
    return Design(plant, request, None, None, None, verdict, impossible.reason)


def _require_reachable(plant: Plant, request: Request) -> None:
    if request.decay is not None and not plant.is_continuous and radius_of(plant, request.decay) < SMALLEST_RADIUS:
        most = -np.log(SMALLEST_RADIUS) / (plant.dt or 1.0)
        raise InputError(
            f"decay: expected at most {most:.4g} for this sampling period, got {request.decay:g}; lower it"
        )


def _loaded(plant: Plant | str | PathLike[str] | Mapping[str, Any], dual: bool) -> Plant:
    if not dual:
        return as_plant(plant)
    from derive.numeric.dual import dual_from_mapping, load_dual

    if isinstance(plant, Mapping):
        return dual_from_mapping(plant)
    if isinstance(plant, str | PathLike):
        return load_dual(plant)
    raise InputError(
        f"plant: expected a file or keys with values for a dual design, got {type(plant).__name__}; "
        "give A, B, Q, R by name"
    )
