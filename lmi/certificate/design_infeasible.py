"""Exact proofs that no gain meets a request. Standard library only.

An H-infinity norm: by a floor above it (`lmi.certificate.design`). A decay: by a mode that the outputs do not see,
which every gain leaves as it is.
"""

# pyright: strict

from dataclasses import dataclass
from fractions import Fraction

from lmi.certificate.arithmetic import Exact, TooLargeError, is_definite
from lmi.certificate.design import Floor, floor_checks, proper
from lmi.certificate.sandwich import ExactPlant
from lmi.certificate.stability import LARGEST, characteristic_polynomial, is_hurwitz, moved_to_the_half_plane

__all__ = ["Unseen", "floor_squared", "keeps_a_mode"]


@dataclass(frozen=True)
class Unseen:
    """States that the outputs do not see: A U = U T and C U = 0, the columns of U (n, m) independent.

    Attributes:
        U: basis (n, m).
        T: how they move (m, m); its modes are modes of A - L C for every L, as (A - L C) U = U T.
    """

    U: Exact
    T: Exact


def keeps_a_mode(plant: ExactPlant, unseen: Unseen, bound: Fraction) -> bool:
    """Prove that A - L C has for every L a mode with Re >= bound, in discrete time modulus >= bound > 0.

    False proves nothing.

    Raises:
        TooLargeError: more than `LARGEST` modes.
    """
    U, T = unseen.U, unseen.T
    if U.shape != (plant.n, T.shape[0]) or T.shape[0] != T.shape[1]:
        return False
    if not (plant.is_continuous or bound > 0):
        return False
    if not (plant.A @ U).equals(U @ T) or any(any(row) for row in (plant.C @ U).numerators):
        return False
    if not is_definite(U.T @ U):
        return False
    m = T.shape[0]
    if m > LARGEST:
        raise TooLargeError(f"{m} modes are too many for Routh's criterion, which takes up to {LARGEST}")
    if plant.is_continuous:
        return not is_hurwitz(characteristic_polynomial(T - Exact.identity(m) * bound))
    return not is_hurwitz(moved_to_the_half_plane(characteristic_polynomial(T * (1 / bound))))


def floor_squared(plant: ExactPlant, floor: Floor) -> Fraction | None:
    """Return a number that the squared H-infinity norm of every stabilising gain is at least, or None."""
    plant, _, semidefinite = proper(plant)
    checks, squared = floor_checks(plant, floor)
    return squared if all(check.holds for check in (*semidefinite, *checks)) else None
