"""What the tables of formulas share: the letters of the scalar lecture, and short names."""

from __future__ import annotations

from derive.derivation import Lecture
from derive.terms import Equation, Symbol, Term, Zero

__all__ = ["NOTHING", "compare", "scalar_lecture", "symbols"]

NOTHING = Zero("", "")


def scalar_lecture() -> Lecture:
    """Return the lecture that proves the formulas."""
    from derive.theory import lecture

    return lecture("scalar")


def symbols(names: str) -> tuple[Symbol, ...]:
    """Return letters of the scalar theory by their names, separated by spaces."""
    from derive.theory import theory

    return tuple(theory("scalar").symbols[name] for name in names.split())


def compare(left: Term, relation: str, right: Term = NOTHING) -> Equation:
    """Return a condition of a branch."""
    return Equation(left, relation, right)
