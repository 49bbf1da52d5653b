"""The closed forms, ready to be evaluated and exported: of one state, and of plants of order two."""

from __future__ import annotations

from derive.errors import InputError
from derive.scalar import second_order, steady, transient
from derive.scalar.formula import Formula

__all__ = ["CLOSED_FORMS", "FORMULAS", "closed_form", "formula"]

MAKERS = {maker.__name__: maker for maker in (*steady.FORMULAS, *transient.FORMULAS)}
FORMULAS = tuple(MAKERS)  # of one state
CLOSED_FORMS = (*FORMULAS, *second_order.FORMULAS)


def formula(name: str) -> Formula:
    """Return a closed form of one state by its name.

    Raises:
        InputError: no such formula.
    """
    if name not in MAKERS:
        raise InputError(f"formula {name!r}: unknown; known are {', '.join(FORMULAS)}")
    return MAKERS[name]()


def closed_form(name: str) -> Formula:
    """Return any closed form by its name.

    Raises:
        InputError: no such closed form.
    """
    if name not in CLOSED_FORMS:
        raise InputError(f"closed form {name!r}: unknown; known are {', '.join(CLOSED_FORMS)}")
    return formula(name) if name in FORMULAS else second_order.formula(name)
