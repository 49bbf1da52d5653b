"""Rigorous enclosure of the stabilising Riccati solution: Newton's method, then a proof in ball arithmetic."""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from derive.numeric.balls import bits_for, exact, floats, middle, working_bits
from derive.numeric.high_precision import Closed, closed_ball
from derive.numeric.modes import Matrix, distance_to_stability, format_mode
from derive.numeric.newton import Equation
from derive.numeric.plant import Plant
from derive.numeric.riccati import RiccatiSolution, solve_riccati

__all__ = ["EnclosureStatus", "RiccatiEnclosure", "enclose_riccati", "encloses", "verify_riccati"]

EnclosureStatus = Literal["verified", "boundary", "open"]

BOUNDARY_RTOL = 1e-7
"""Relative distance of the slowest mode from the boundary below which a failure is put down to it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RiccatiEnclosure:
    """What is proved about the stabilising solution P of a Riccati equation.

    Numbers that are not proved are balls that hold everything (`arb("nan")`), never guesses.

    Attributes:
        status: "verified"; "boundary" when the closed loop keeps modes on the boundary of stability, or they cannot be
            told from it; "open" when no ball could be closed.
        reason: one line that says why there is no proof, with the mode; empty when verified.
        P: balls (n, n) that hold P; None unless verified.
        gain: balls (n, l) that hold the optimal gain L; None unless verified.
        radius: bound of |P - centre|_2, with `centre` the middles of `P`.
        digits: decimal digits of P that are proved, relative to |P| in balanced coordinates.
        trace: encloses tr(P).
        cost: encloses tr(M P).
        output_cost: encloses tr(C P C' V^-1), in discrete time ln det(C P C' + R).
        closed_loop: eigenvalues of A - L C in floating point (n,).
        bits: working precision.
        solution: the solution in floating point that was started from, with its condition number and the modes near the
            boundary; None when a given P was verified.
    """

    status: EnclosureStatus
    reason: str = ""
    P: arb_mat | None = None
    gain: arb_mat | None = None
    radius: float = float("inf")
    digits: int = 0
    trace: arb = arb("nan")  # noqa: RUF009 (balls are immutable)
    cost: arb = arb("nan")  # noqa: RUF009
    output_cost: arb = arb("nan")  # noqa: RUF009
    closed_loop: NDArray[Any]
    bits: int
    solution: RiccatiSolution | None = None

    def distance(self, P: Matrix) -> float:
        """Return a proved bound of the Frobenius norm |P - P*| for any P (n, n), infinite unless verified."""
        if self.P is None:
            return float("inf")
        with working_bits(self.bits):
            sizes = [x.abs_upper() for x in (self.P - exact(P)).entries()]
            return float(sum((x * x for x in sizes), arb(0)).sqrt().abs_upper())

    @property
    def centre(self) -> Matrix:
        """The middles of P, rounded to doubles (n, n)."""
        return np.full((len(self.closed_loop),) * 2, np.nan) if self.P is None else floats(self.P)


def enclose_riccati(plant: Plant, digits: int = 30) -> RiccatiEnclosure:
    """Enclose the stabilising solution of the steady Riccati equation of the plant's doubles, taken as exact.

    Continuous: 0 = A P + P A' + W - (P C' + N) V^-1 (P C' + N)'.
    Discrete: P = A P A' + Q - (A P C' + S)(C P C' + R)^-1 (A P C' + S)'.

    Newton's method in high precision finds a centre; `prove` then closes a ball around it, in which the stabilising
    solution lies because a verified Lyapunov (Stein) witness shows the closed loop stable all over the ball.

    Args:
        plant: V > 0 and (A, C) detectable; W >= 0 is not used.
        digits: decimal digits aimed at.

    Source: L. V. Kantorovich's theorem, in the form that the Riccati operator's exact quadratic remainder gives.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> enclosure = enclose_riccati(example_plant(), digits=40)
        >>> enclosure.status, enclosure.digits >= 40
        ('verified', True)
    """
    solution = solve_riccati(plant)
    if solution.status == "stabilising":
        closed = closed_ball(plant, solution.P, digits)
        with working_bits(closed.bits):
            return replace(_enclosure(plant, closed, solution.closed_loop), solution=solution)
    return _not_started(solution, bits_for(digits))


def verify_riccati(plant: Plant, P: Matrix, bits: int = 128) -> RiccatiEnclosure:
    """Prove that the stabilising solution is near a given symmetric P (n, n), without improving P.

    The radius is what the residual of P allows. A root whose closed loop is not stable is not verified, however small
    its residual.
    """
    with working_bits(bits):
        equation = Equation.of(plant)
        centre = middle(equation.scaled(P))
        loop = np.linalg.eigvals(floats(equation.closed_loop(centre)))
        return _enclosure(plant, Closed.of(equation, centre, bits), loop)


def encloses(plant: Plant, claimed: arb_mat, digits: int = 30) -> bool:
    """Prove that the balls `claimed` hold the stabilising solution; False when they do not, or no proof is found.

    Args:
        plant: as of `enclose_riccati`.
        claimed: the matrix of balls (n, n).
        digits: decimal digits to which the solution is enclosed for the comparison.
    """
    ours = enclose_riccati(plant, digits).P
    return ours is not None and (claimed.nrows(), claimed.ncols()) == (plant.n, plant.n) and claimed.contains(ours)


def _not_started(solution: RiccatiSolution, bits: int) -> RiccatiEnclosure:
    modes = ", ".join(map(format_mode, solution.boundary_modes))
    unexcited = f"closed loop: expected stable, got {modes}, unexcited, on the boundary or too near to tell"
    return RiccatiEnclosure(
        status="boundary" if len(solution.near_boundary) else "open",
        reason=solution.reason or unexcited,
        closed_loop=solution.closed_loop,
        bits=bits,
        solution=solution,
    )


def _enclosure(plant: Plant, closed: Closed, loop: NDArray[Any]) -> RiccatiEnclosure:
    if closed.proof.radius is None:
        slow = _slowest(plant, loop)
        near = slow is not None and abs(distance_to_stability(slow, plant.time)) <= BOUNDARY_RTOL * abs(slow)
        mode = "unknown" if slow is None else f"about {format_mode(slow)}"
        reason = f"{closed.proof.reason}; the slowest mode of the closed loop is {mode}"
        status = "boundary" if near else "open"
        return RiccatiEnclosure(status=status, reason=reason, closed_loop=loop, bits=closed.bits)
    P, radius = closed.equation.unscaled(closed.P, closed.proof.radius)
    return RiccatiEnclosure(
        status="verified",
        P=P,
        gain=_gain(plant, P),
        radius=float(radius.abs_upper()),
        digits=closed.digits,
        trace=P.trace(),
        cost=_trace_of_product(exact(plant.M), P),
        output_cost=_output_cost(plant, P),
        closed_loop=loop,
        bits=closed.bits,
    )


def _gain(plant: Plant, P: arb_mat) -> arb_mat:
    """Return L = (P C' + N) V^-1, in discrete time L = (A P C' + S) (C P C' + R)^-1."""
    A, C, N, S = exact(plant.A), exact(plant.C), exact(plant.N), exact(plant.V)
    PC = P * C.transpose()
    if not plant.is_continuous:
        PC, S = A * PC, S + C * PC
    return S.solve((PC + N).transpose()).transpose()


def _slowest(plant: Plant, modes: NDArray[Any]) -> complex | None:
    if len(modes) == 0 or not np.isfinite(modes).all():
        return None
    return complex(modes[int(np.argmax(distance_to_stability(modes, plant.time)))])


def _trace_of_product(X: arb_mat, Y: arb_mat) -> arb:
    """Return tr(X Y)."""
    pairs = zip(X.entries(), Y.transpose().entries(), strict=True)
    return sum((x * y for x, y in pairs), arb(0))


def _output_cost(plant: Plant, P: arb_mat) -> arb:
    C, V = exact(plant.C), exact(plant.V)
    output = C * P * C.transpose()
    return V.solve(output).trace() if plant.is_continuous else (output + V).det().log()
