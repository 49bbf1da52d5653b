"""The closed forms of the scalar estimator and regulator, ready to be evaluated and exported."""

from __future__ import annotations

from derive.errors import InputError
from derive.scalar import steady, transient
from derive.scalar.formula import Formula

__all__ = ["FORMULAS", "formula"]

MAKERS = {maker.__name__: maker for maker in (*steady.FORMULAS, *transient.FORMULAS)}
FORMULAS = tuple(MAKERS)


def formula(name: str) -> Formula:
    """Return a closed form by its name.

    Raises:
        InputError: no such formula.
    """
    if name not in MAKERS:
        raise InputError(f"formula {name!r}: unknown; known are {', '.join(FORMULAS)}")
    return MAKERS[name]()
