"""The output cost of the optimal estimator by four independent routes, three in floating point and one enclosed."""

from dataclasses import dataclass
from math import isfinite
from time import perf_counter
from typing import Literal

import numpy as np
from flint import arb

from derive.numeric.balls import bits_for, digits_of, working_bits
from derive.numeric.enclosure import RiccatiEnclosure, enclose_riccati
from derive.numeric.log_det import LogDetEnclosure, enclose_log_det
from derive.numeric.modes import spectral_scale
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from derive.numeric.spectrum import hamiltonian_route, output_cost, output_error_integral

__all__ = ["OutputCostRoutes", "Route", "four_routes"]

AGREEMENT_RTOL = 1e-9
"""Distance from the enclosure, relative to the scale of the plant, up to which a route agrees with it."""

RouteName = Literal["riccati", "hamiltonian", "integral"]


@dataclass(frozen=True)
class Route:
    """One floating-point value of the output cost, judged by the enclosure.

    Attributes:
        name: "riccati", "hamiltonian" or "integral".
        value: tr(C P C' V^-1), in discrete time ln det(C P C' + R); not a number when the route failed.
        error: proved bound of |value - truth| / scale; infinite when nothing is enclosed.
        correct_digits: decimal digits of `value`, relative to itself, that are proved correct.
        agrees: whether `error` is within the tolerance.
        seconds: time taken.
    """

    name: RouteName
    value: float
    error: float
    correct_digits: int
    agrees: bool
    seconds: float


@dataclass(frozen=True, eq=False)
class OutputCostRoutes:
    """The output cost by every route.

    Attributes:
        enclosure: ball that holds the truth; everything when nothing could be enclosed.
        digits: decimal digits that the ball proves.
        routes: the floating-point routes.
        scale: what errors are relative to: |truth| or, if larger, |A| (continuous) and 1 (discrete: a logarithm).
        by_solution: the enclosure by the Riccati equation.
        by_spectrum: the enclosure by the spectrum, which needs no Riccati equation.
        seconds: time that the two enclosures took.
    """

    enclosure: arb
    digits: int
    routes: tuple[Route, ...]
    scale: float
    by_solution: RiccatiEnclosure
    by_spectrum: LogDetEnclosure
    seconds: float

    @property
    def enclosed(self) -> bool:
        """Whether there is a finite ball."""
        return self.enclosure.is_finite()

    @property
    def agree(self) -> bool:
        """Whether there is a ball and every floating-point route agrees with it."""
        return self.enclosed and all(route.agrees for route in self.routes)


def four_routes(plant: Plant, digits: int = 20, rtol: float = AGREEMENT_RTOL) -> OutputCostRoutes:
    """Compute tr(C P C' V^-1), in discrete time ln det(C P C' + R), by four routes and judge three by the fourth.

    The routes are the Riccati equation, the eigenvalues of the Hamiltonian matrix (symplectic pencil), adaptive
    quadrature of the log-determinant integral, and ball arithmetic. A double cannot lie in a ball that is narrower than
    its rounding, so the check is a proved bound of the distance between the double and everything in the ball.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.
        digits: decimal digits aimed at by the enclosures.
        rtol: tolerance of `Route.agrees`.

    Raises:
        ArithmeticError: the two enclosures exclude each other, which no plant should bring about.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> result = four_routes(example_plant())
        >>> result.agree, result.digits >= 20, [route.name for route in result.routes]
        (True, True, ['riccati', 'hamiltonian', 'integral'])
    """
    start = perf_counter()
    by_solution, by_spectrum = enclose_riccati(plant, digits), enclose_log_det(plant, digits)
    seconds = perf_counter() - start
    with working_bits(bits_for(digits) + 64):
        ball = _common(by_solution, by_spectrum)
        scale = _scale(plant, ball)
        routes = tuple(_route(name, plant, ball, scale, rtol) for name in ("riccati", "hamiltonian", "integral"))
        proved = max(by_solution.digits and digits_of(ball.rad(), ball), by_spectrum.digits)
    return OutputCostRoutes(ball, proved, routes, scale, by_solution, by_spectrum, seconds)


def _common(by_solution: RiccatiEnclosure, by_spectrum: LogDetEnclosure) -> arb:
    """Return the narrower ball of the two, which must overlap."""
    one, other = by_solution.output_cost, by_spectrum.value
    if not (one.is_finite() and other.is_finite()):
        return one if one.is_finite() else other
    if not one.overlaps(other):
        raise ArithmeticError(f"output cost: expected enclosures that overlap, got {one.str(20)} and {other.str(20)}")
    return one if one.rad() < other.rad() else other


def _scale(plant: Plant, ball: arb) -> float:
    size = float(ball.abs_upper()) if ball.is_finite() else 0.0
    return max(size, spectral_scale(plant.A, plant.time) if plant.is_continuous else 1.0)


def _value(name: RouteName, plant: Plant) -> float:
    if name == "riccati":
        solution = solve_riccati(plant)
        return output_cost(plant, solution.P) if solution.status != "failed" else float("nan")
    return hamiltonian_route(plant).value if name == "hamiltonian" else output_error_integral(plant).value


def _route(name: RouteName, plant: Plant, ball: arb, scale: float, rtol: float) -> Route:
    start = perf_counter()
    with np.errstate(all="ignore"):
        value = _value(name, plant)
    seconds = perf_counter() - start
    if not (isfinite(value) and ball.is_finite()):
        return Route(name, value, float("inf"), 0, False, seconds)
    distance = abs(ball - value)
    error = float((distance / scale).abs_upper()) if scale else float(distance.abs_upper())
    return Route(name, value, error, min(17, digits_of(distance, arb(value))), error <= rtol, seconds)
