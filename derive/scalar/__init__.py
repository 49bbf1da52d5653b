"""Closed forms of the scalar estimator: formulas with their proofs, and code exported from them.

>>> from derive.scalar import closed_form
>>> covariance = closed_form("care_covariance").to_numpy()
>>> float(covariance(1, 1, 0, 1))
2.0
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derive.scalar.formula import Formula
    from derive.scalar.library import CLOSED_FORMS, closed_form
    from derive.theory.scalar import lecture

__all__ = ["CLOSED_FORMS", "Formula", "closed_form", "lecture"]

_PLACES = {
    "CLOSED_FORMS": "derive.scalar.library", "Formula": "derive.scalar.formula",
    "closed_form": "derive.scalar.library", "lecture": "derive.theory.scalar",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(import_module(_PLACES[name]), name)
    raise AttributeError(f"module 'derive.scalar' has no attribute {name!r}")
