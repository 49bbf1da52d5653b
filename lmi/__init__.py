"""Convex programs that reproduce the optimal error covariance.

>>> import lmi
>>> from derive.numeric.plant import example_plant
>>> lmi.validate(example_plant()).verdict.value
'agree'
"""

from collections.abc import Callable, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any

from derive._version import __version__

if TYPE_CHECKING:
    from derive.numeric.plant import Plant
    from lmi.certification.sandwich import Certified
    from lmi.synthesis.designs import Design
    from lmi.validation import Validation

__all__ = ["__version__", "certify", "design", "validate"]


def validate(
    plant: "Plant | str | PathLike[str] | Mapping[str, Any]", *, progress: Callable[[str], None] | None = None
) -> "Validation":
    """Compute a plant's optimal error covariance by every route and compare; see `lmi.validation.validate`."""
    from lmi.validation import validate as run

    return run(plant, progress=progress)


def certify(plant: "Plant | str | PathLike[str] | Mapping[str, Any]", gain: Any = None) -> "Certified":
    """Prove bounds on a plant's optimal error covariance, and on a gain if one is given; see `lmi.certification`."""
    from derive.numeric.plant import as_plant
    from lmi.certification.command import as_gain
    from lmi.certification.sandwich import certified

    plant = as_plant(plant)
    return certified(plant, None if gain is None else as_gain("gain", gain, plant))


def design(
    plant: "Plant | str | PathLike[str] | Mapping[str, Any]",
    objective: str = "h2",
    *,
    gamma: float | None = None,
    decay: float | None = None,
    dual: bool = False,
    progress: Callable[[str], None] | None = None,
) -> "Design":
    """Find a gain, of an observer or of state feedback, and prove what it achieves; see `lmi.synthesis.designs`."""
    from lmi.synthesis.designs import design as run

    return run(plant, objective, gamma=gamma, decay=decay, dual=dual, progress=progress)
