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
    from lmi.validation import Validation

__all__ = ["__version__", "validate"]


def validate(
    plant: "Plant | str | PathLike[str] | Mapping[str, Any]", *, progress: Callable[[str], None] | None = None
) -> "Validation":
    """Compute a plant's optimal error covariance by every route and compare; see `lmi.validation.validate`."""
    from lmi.validation import validate as run

    return run(plant, progress=progress)
