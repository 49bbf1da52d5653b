"""The output cost of the optimal estimator by four independent routes, three in floating point and one enclosed."""

from dataclasses import dataclass
from math import isfinite
from time import perf_counter
from typing import Literal

import numpy as np
from flint import arb

from derive.numeric.balls import bits_for, digits_of, exact, working_bits
from derive.numeric.enclosure import RiccatiEnclosure, enclose_riccati
from derive.numeric.log_det import LogDetEnclosure, enclose_log_det, enclose_unstable_term
from derive.numeric.modes import spectral_scale
from derive.numeric.plant import Plant
from derive.numeric.riccati import solve_riccati
from derive.numeric.spectrum import hamiltonian_route, output_cost, output_error_integral

__all__ = ["OutputCostEnclosure", "OutputCostRoutes", "Route", "enclose_output_cost", "four_routes"]

AGREEMENT_RTOL = 1e-9
"""Distance from the enclosure, relative to the scale of the plant, up to which a route agrees with it."""

DOUBLE_DIGITS = 17
"""Decimal digits that tell every double from its neighbours: no double has more that are correct."""

SPARE_BITS = 64

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


@dataclass(frozen=True, eq=False, kw_only=True)
class OutputCostEnclosure:
    """What is proved about the output cost, and the terms of its formula.

    Continuous: tr(C P C' V^-1) + tr(C N V^-1) = (1/2 pi) int ln(det Phi_y / det V) dw + 2 sum max(0, Re lambda_i(A)).
    Discrete: ln det(C P C' + R) = (1/2 pi) int ln det Phi_y dw + 2 sum max(0, ln |lambda_i(A)|).
    Phi_y = C X W X* C' + C X N + N' X* C' + V, X = (s - A)^-1, is the spectrum of y, with s = j w or e^(j w).

    Attributes:
        value: encloses tr(C P C' V^-1), in discrete time ln det(C P C' + R); everything when nothing could be closed.
        digits: decimal digits that `value` proves.
        integral: encloses the integral of Phi_y, as in the formula.
        unstable_term: encloses the sum over the modes of A.
        cross_term: encloses tr(C N V^-1); 0 in discrete time, whose formula has no such term.
        scale: what errors are relative to: |truth| or, if larger, |A| (continuous) and 1 (discrete: a logarithm).
        by_solution: the enclosure by the Riccati equation.
        by_spectrum: the enclosure by the spectrum of the plant without cross term, which needs no Riccati equation.
        bits: precision at which values are compared with the balls.
        seconds: time taken.
    """

    value: arb
    digits: int
    integral: arb
    unstable_term: arb
    cross_term: arb
    scale: float
    by_solution: RiccatiEnclosure
    by_spectrum: LogDetEnclosure
    bits: int
    seconds: float

    @property
    def enclosed(self) -> bool:
        """Whether there is a finite ball."""
        return self.value.is_finite()

    def distance(self, value: float) -> float:
        """Return a proved bound of |value - truth|, infinite when nothing is enclosed or the value is not a number."""
        if not (self.enclosed and isfinite(value)):
            return float("inf")
        with working_bits(self.bits):
            return float(abs(self.value - value).abs_upper())

    def apart(self, value: float) -> float:
        """Return a proved lower bound of |value - truth|, 0 when there is nothing to compare."""
        if not (self.enclosed and isfinite(value)):
            return 0.0
        with working_bits(self.bits):
            return float(abs(self.value - value).abs_lower())

    def correct_digits(self, value: float) -> int:
        """Return how many decimal digits of a double, relative to itself, are proved correct."""
        if not (self.enclosed and isfinite(value)):
            return 0
        with working_bits(self.bits):
            return min(DOUBLE_DIGITS, digits_of(abs(self.value - value), arb(value)))


@dataclass(frozen=True, eq=False)
class OutputCostRoutes:
    """The output cost by every route.

    Attributes:
        enclosure: what is proved.
        routes: the floating-point routes.
    """

    enclosure: OutputCostEnclosure
    routes: tuple[Route, ...]

    @property
    def agree(self) -> bool:
        """Whether there is a ball and every floating-point route agrees with it."""
        return self.enclosure.enclosed and all(route.agrees for route in self.routes)


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
        >>> result.agree, result.enclosure.digits >= 20, [route.name for route in result.routes]
        (True, True, ['riccati', 'hamiltonian', 'integral'])
    """
    enclosure = enclose_output_cost(plant, digits)
    routes = tuple(_route(name, plant, enclosure, rtol) for name in ("riccati", "hamiltonian", "integral"))
    return OutputCostRoutes(enclosure, routes)


def enclose_output_cost(plant: Plant, digits: int = 20) -> OutputCostEnclosure:
    """Enclose the output cost by the Riccati equation and by the spectrum, and the terms of its formula.

    Args:
        plant: as of `four_routes`; the doubles are taken as exact.
        digits: decimal digits aimed at.

    Raises:
        ArithmeticError: the two enclosures exclude each other.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> found = enclose_output_cost(example_plant())
        >>> (found.value + found.cross_term).overlaps(found.integral + found.unstable_term)
        True
    """
    start = perf_counter()
    by_solution, by_spectrum = enclose_riccati(plant, digits), enclose_log_det(plant, digits)
    bits = bits_for(digits) + SPARE_BITS
    with working_bits(bits):
        ball = _common(by_solution, by_spectrum)
        integral, unstable, cross = _terms(plant, by_spectrum, digits)
        proved = max(by_solution.digits and digits_of(ball.rad(), ball), by_spectrum.digits)
    return OutputCostEnclosure(
        value=ball,
        digits=proved,
        integral=integral,
        unstable_term=unstable,
        cross_term=cross,
        scale=_scale(plant, ball),
        by_solution=by_solution,
        by_spectrum=by_spectrum,
        bits=bits,
        seconds=perf_counter() - start,
    )


def _common(by_solution: RiccatiEnclosure, by_spectrum: LogDetEnclosure) -> arb:
    """Return the narrower ball of the two, which must overlap."""
    one, other = by_solution.output_cost, by_spectrum.value
    if not (one.is_finite() and other.is_finite()):
        return one if one.is_finite() else other
    if not one.overlaps(other):
        raise ArithmeticError(f"output cost: expected enclosures that overlap, got {one.str(20)} and {other.str(20)}")
    return one if one.rad() < other.rad() else other


def _terms(plant: Plant, by_spectrum: LogDetEnclosure, digits: int) -> tuple[arb, arb, arb]:
    """Return the integral of Phi_y, the sum over the modes of A, and the cross term.

    Phi_y and the spectrum Phi without cross term differ by |det(s - F) / det(s - A)|^2, F = A - N V^-1 C, whose
    logarithm integrates to the modes of either; so the integral needs the Riccati equation as little as that of Phi.
    """
    if not plant.N.any():
        return by_spectrum.integral, by_spectrum.unstable_term, arb(0)
    unstable, cross = enclose_unstable_term(plant, digits), arb(0)
    if plant.is_continuous:
        cross = exact(plant.V).solve(exact(plant.C) * exact(plant.N)).trace()
    return by_spectrum.value + cross - unstable, unstable, cross


def _scale(plant: Plant, ball: arb) -> float:
    size = float(ball.abs_upper()) if ball.is_finite() else 0.0
    return max(size, spectral_scale(plant.A, plant.time) if plant.is_continuous else 1.0)


def _value(name: RouteName, plant: Plant) -> float:
    if name == "riccati":
        solution = solve_riccati(plant)
        return output_cost(plant, solution.P) if solution.status != "failed" else float("nan")
    return hamiltonian_route(plant).value if name == "hamiltonian" else output_error_integral(plant).value


def _route(name: RouteName, plant: Plant, enclosure: OutputCostEnclosure, rtol: float) -> Route:
    start = perf_counter()
    with np.errstate(all="ignore"):
        value = _value(name, plant)
    seconds = perf_counter() - start
    error = enclosure.distance(value) / (enclosure.scale or 1.0)
    return Route(name, value, error, enclosure.correct_digits(value), error <= rtol, seconds)
