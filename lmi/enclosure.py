"""What is proved about a plant's optimum: the balls of `derive.numeric.output_cost`, in the form of the report."""

import warnings
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant

if TYPE_CHECKING:
    from flint import arb

    from derive.numeric.output_cost import OutputCostEnclosure

__all__ = ["NUMERICAL_ERRORS", "Enclosure", "Number", "enclose", "number_of"]

NUMERICAL_ERRORS = (ArithmeticError, RuntimeError, ValueError, MemoryError)
"""What a route may raise when its numbers run out; NumPy's LinAlgError is a ValueError, CasADi raises RuntimeError."""

DIGITS = 30
"""Decimal digits aimed at."""

LARGEST = 50
"""States up to which the enclosures take seconds."""


@dataclass(frozen=True)
class Number:
    """A number that is proved to lie within `radius` of `value`, both decimal.

    `digits` of `value` are proved, all of those printed; none when the number may be 0.
    """

    value: str
    radius: str
    digits: int

    def as_dict(self) -> dict[str, Any]:
        """Return the number as plain data."""
        return {"value": self.value, "radius": self.radius, "digits": self.digits}

    def __str__(self) -> str:
        if self.radius == "0":
            return f"{self.value} proved exactly"
        return f"{self.value} proved to {f'{self.digits} digits' if self.digits else f'within {self.radius}'}"


@dataclass(frozen=True, eq=False)
class Enclosure:
    """What is proved about a plant, each number None when nothing is.

    Attributes:
        status: "verified", or why nothing is proved about the output.
        reason: why nothing is proved about P, with the mode in the way; empty when something is.
        found: the balls, or None when the enclosure was not attempted or failed.
        seconds: time taken.
    """

    status: str
    reason: str = ""
    found: "OutputCostEnclosure | None" = None
    seconds: float = 0.0

    @property
    def output(self) -> Number | None:
        """tr(C P C' V^-1) [1/s], in discrete time ln det(C P C' + V)."""
        return None if self.found is None else number_of(self.found.value)

    @property
    def trace(self) -> Number | None:
        """tr P."""
        return None if self.found is None else number_of(self.found.by_solution.trace)

    @property
    def cost(self) -> Number | None:
        """tr(M P)."""
        return None if self.found is None else number_of(self.found.by_solution.cost)

    @property
    def terms(self) -> dict[str, Number | None]:
        """The terms of output + cross_term = integral + unstable_term, the integral being that of the spectrum of y."""
        names = ("integral", "unstable_term", "cross_term")
        return {name: None if self.found is None else number_of(getattr(self.found, name)) for name in names}

    @property
    def condition(self) -> float | None:
        """Relative change of P for a relative change of A, W, C'V^-1 C, to first order; None when it is not known."""
        solution = None if self.found is None else self.found.by_solution.solution
        return None if solution is None or not np.isfinite(solution.condition) else float(solution.condition)

    @property
    def near_boundary(self) -> tuple[complex, ...]:
        """Modes of A - L C on the boundary of stability or beside it, as the Riccati equation's pencil has them."""
        solution = None if self.found is None else self.found.by_solution.solution
        return () if solution is None else tuple(complex(mode) for mode in solution.near_boundary)

    def lacking(self, P: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]] | None:
        """Return what P (n, n) lacks to the truth, each entry as large as it may be, or None when nothing is proved."""
        if self.found is None or self.found.by_solution.P is None:
            return None
        from derive.numeric.balls import exact, floats, working_bits

        with working_bits(self.found.bits):
            apart = self.found.by_solution.P - exact(P)
            sizes = np.array([float(x.abs_upper()) for x in apart.entries()]).reshape(P.shape)
            return np.copysign(sizes, floats(apart))

    def distance(self, output: float | None) -> float | None:
        """Return a proved bound of |output - truth|, or None when nothing is proved."""
        if self.found is None or output is None:
            return None
        distance = self.found.distance(output)
        return distance if np.isfinite(distance) else None

    def covariance_distances(self, trace: float, cost: float) -> tuple[float, float] | None:
        """Return proved bounds of |tr P - truth| and |tr(M P) - truth|, or None when nothing is proved about P."""
        if self.found is None or not np.isfinite([trace, cost]).all():
            return None
        from derive.numeric.balls import working_bits

        with working_bits(self.found.bits):
            proved = self.found.by_solution
            bounds = tuple(float(abs(x - y).abs_upper()) for x, y in ((proved.trace, trace), (proved.cost, cost)))
        return (bounds[0], bounds[1]) if np.isfinite(bounds).all() else None

    def correct_digits(self, output: float | None) -> int | None:
        """Return how many decimal digits of an output are proved correct, or None when nothing is proved."""
        if self.found is None or output is None or not self.found.enclosed:
            return None
        return self.found.correct_digits(output)

    def apart(self, output: float | None) -> float:
        """Return how far an output is from the truth at least, 0 when nothing is known."""
        return 0.0 if self.found is None or output is None else self.found.apart(output)

    def as_dict(self) -> dict[str, Any]:
        """Return the enclosure as plain data."""
        numbers = {"output": self.output, "trace": self.trace, "cost": self.cost, **self.terms}
        data = {name: None if number is None else number.as_dict() for name, number in numbers.items()}
        near = [[mode.real, mode.imag] for mode in self.near_boundary]
        sense = {"condition": self.condition, "near_boundary": near}
        return {"status": self.status, "reason": self.reason, **data, **sense, "seconds": self.seconds}


def enclose(plant: Plant) -> Enclosure:
    """Enclose tr P, tr(M P) and tr(C P C' V^-1), in discrete time ln det(C P C' + V), in ball arithmetic."""
    if plant.n > LARGEST:
        return Enclosure(f"not attempted: {plant.n} states, the enclosure takes up to {LARGEST}")
    from derive.numeric.output_cost import enclose_output_cost

    start = perf_counter()
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = enclose_output_cost(plant, DIGITS)
    except NUMERICAL_ERRORS as error:
        status = f"failed: {' '.join(str(error).split()) or type(error).__name__}"
        return Enclosure(status, seconds=perf_counter() - start)
    status = "verified" if found.enclosed else f"open: {found.by_spectrum.reason}"
    return Enclosure(status, found.by_solution.reason, found, perf_counter() - start)


def number_of(ball: "arb") -> Number | None:
    """Return a ball as decimals, rounded outwards, or None when it holds everything."""
    from derive.numeric.balls import bits_for, digits_of, working_bits

    if not ball.is_finite():
        return None
    with working_bits(2 * bits_for(DIGITS)):
        digits = min(DIGITS, digits_of(ball.rad(), ball))
        text = ball.str(max(digits, 1))
    if not text.startswith("["):
        return Number(text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text, "0", digits)
    value, _, radius = text.strip("[]").rpartition("+/-")
    return Number(value.strip() or "0", radius.strip(), digits)
