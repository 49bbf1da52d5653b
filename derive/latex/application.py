r"""A letter and a group behind it: P(t) is a function of time, P(A + B) a product, P(A) has both readings.

Applied, whatever the letter: arguments that look like times, frequencies or indices - t, s, z, k, tau, omega, 0,
oo, t_0, j omega, e^{j omega}, z^{-1}, k|k-1, a dot - and their sums, differences, products and quotients; lists with
commas; rho and delta; lambda and sigma with an index or a bar; the letters that the caller names. Products: every
other sum, product or matrix in brackets. Both, so an error: a letter before a single other letter.
"""

from __future__ import annotations

from collections.abc import Collection
from enum import Enum

from derive.latex.syntax import (
    Blank,
    Digits,
    Fenced,
    Given,
    Infinite,
    Inverted,
    Listed,
    Name,
    Node,
    Over,
    Plus,
    Raised,
    Times,
    Transposed,
)
from derive.latex.vocabulary import EXPECTATIONS, MOMENTS

SPECTRAL = frozenset(("lambda", "sigma"))  # with an index or a bar they are functions of a matrix
ESTIMATED = frozenset(("hat", "tilde", "dot", "ddot"))  # accents that no time wears
BESIDE_MOMENTS = (Name("pi"), Name("d"))


class Reading(Enum):
    """What a letter and the group behind it are."""

    APPLIED = "applied"
    PRODUCT = "product"
    BOTH = "both"


def reading(head: Name, group: Fenced, functions: Collection[str] = ()) -> Reading:
    """Return what a letter and the group behind it are."""
    items = group.body.items if isinstance(group.body, Listed) else (group.body,)
    if head.letter in functions or all(map(momentary, items)):
        return Reading.APPLIED
    if group.fence == "[":
        return Reading.PRODUCT
    if len(items) > 1 or isinstance(group.body, Given) or head.letter in ("rho", "delta"):
        return Reading.APPLIED
    if head.letter in SPECTRAL and (head.sub or {"bar", "underline"} & set(head.accents)):
        return Reading.APPLIED
    single = isinstance(group.body, Name) or head.letter in SPECTRAL or head.letter in EXPECTATIONS
    return Reading.BOTH if single else Reading.PRODUCT


def momentary(node: Node) -> bool:
    """Return whether a node looks like a time, a frequency or an index."""
    match node:
        case Name(letter=letter, accents=accents):
            return letter in MOMENTS and not ESTIMATED & set(accents)
        case Digits() | Infinite() | Blank("·"):
            return True
        case Plus(addends):
            return all(momentary(addend) for _, addend in addends)
        case Times(factors):
            return all(momentary(f) or f in BESIDE_MOMENTS for f in factors)
        case Raised(Name("e"), exponent):
            return momentary(exponent)
        case Transposed(body) | Inverted(body):
            return momentary(body)
        case Raised(body, exponent) | Over(body, exponent) | Given(body, exponent):
            return momentary(body) and momentary(exponent)
        case _:
            return False
