"""Riccati solutions in high precision: Newton's method or doubling, with more bits until a proof closes."""

from dataclasses import dataclass

from flint import arb_mat

from derive.numeric.balls import bits_for, digits_of, norm, working_bits
from derive.numeric.doubling import stabilising_start
from derive.numeric.modes import Matrix
from derive.numeric.newton import Equation, Proof, prove, refined
from derive.numeric.plant import Plant

__all__ = ["Closed", "closed_ball"]

SPARE_BITS = 64
"""Bits beyond the digits asked for, which pay for the rounding of the proof."""

ATTEMPTS = 4
"""Attempts, each with twice the bits of the one before."""


@dataclass(frozen=True, eq=False)
class Closed:
    """A centre, and what is proved about the stabilising solution near it.

    Attributes:
        equation: the equation, in its scaled states.
        P: symmetric centre (n, n), in scaled states.
        proof: the radius of a ball around P that holds the solution, or why there is none.
        digits: decimal digits of P that are proved, relative to |P|; 0 without a proof.
        bits: working precision.
    """

    equation: Equation
    P: arb_mat
    proof: Proof
    digits: int
    bits: int

    @classmethod
    def of(cls, equation: Equation, P: arb_mat, bits: int) -> "Closed":
        """Try to prove that the solution is near P, at the working precision."""
        proof, size = prove(equation, P), norm(P) / max(1, equation.n) ** 0.5
        return cls(equation, P, proof, 0 if proof.radius is None else digits_of(proof.radius, size), bits)


def closed_ball(plant: Plant, start: Matrix | None, digits: int) -> Closed:
    """Refine a start, or without a good one what doubling finds, and close a ball around it.

    Args:
        plant: V > 0, (A, C) detectable.
        start: covariance (n, n) whose closed loop is stable, or None.
        digits: decimal digits aimed at.
    """
    bits = bits_for(digits) + SPARE_BITS
    found = _attempt(plant, start, bits, in_balls=False)
    for _ in range(ATTEMPTS - 1):
        if found.digits >= digits:
            break
        bits *= 2
        proved = found.proof.radius is not None
        found = _attempt(plant, start if proved else None, bits, in_balls=not proved)
    return found


def _attempt(plant: Plant, start: Matrix | None, bits: int, in_balls: bool) -> Closed:
    with working_bits(bits):
        equation = Equation.of(plant)
        P = stabilising_start(equation) if start is None else equation.scaled(start)
        if P is None:
            return Closed(equation, equation.q, Proof(None, "doubling: expected convergence, got none"), 0, bits)
        return Closed.of(equation, refined(equation, P, in_balls), bits)
