"""What a claim says once it is read in a theory."""

from __future__ import annotations

from dataclasses import dataclass

from derive.terms import Equation, Symbol
from derive.theory.claims.base import ClaimTheory


@dataclass(frozen=True)
class Statement:
    """The typed meaning of one displayed formula.

    ``equations`` hold all at once (a chain a = b ⪰ c gives two); relations are = ⪰ ≻ between matrices and = ≥ > ≠
    between numbers, lhs and rhs swapped where the page has ≤. ``symbols`` in the order of their first appearance.
    ``scalar`` says that every dimension is 1, where factors commute; a letter keeps the type that its theory gives it.
    ``theory`` holds what bears on the letters of the statement, extended by what is assumed: as declarations, or as
    ``theory.conditions`` where the kernel has no word for it. ``assumed`` names these in the order in which they were
    given.
    """

    equations: tuple[Equation, ...]
    symbols: tuple[Symbol, ...]
    theory: ClaimTheory
    scalar: bool = False
    assumed: tuple[str, ...] = ()
