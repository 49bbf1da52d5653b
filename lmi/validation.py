"""One plant, every route to its optimal error covariance, one verdict."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from os import PathLike
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import format_mode
from derive.numeric.plant import Plant, load_plant, plant_from_mapping
from lmi.routes import ROUTES, Answer, RouteSpec, cost_of, output_of, output_rounding
from lmi.scaling import balanced

__all__ = ["AGREEMENT", "TRUSTED", "Route", "Validation", "Verdict", "validate"]

Matrix = NDArray[np.floating[Any]]

AGREEMENT = 1e-6
"""Routes agree when their results differ by at most this, relative."""

TRUSTED = 1e-7
"""A route confirms only when the error that its own numbers admit is at most this, relative."""

UNEXPLAINED = 10.0
"""A route disagrees when it differs by more than this many times the errors that it and Riccati admit."""

VANISHING = 1e-9
"""A result smaller than this, relative to the natural size of the plant's coordinates, is zero: differences are then
relative to that natural size."""

NUMERICAL_ERRORS = (ArithmeticError, RuntimeError, ValueError, MemoryError)
"""What a route may raise when its numbers run out; NumPy's LinAlgError is a ValueError, CasADi raises RuntimeError."""


class Verdict(Enum):
    """What the routes say together."""

    AGREE = "agree"
    DISAGREE = "disagree"
    UNCONFIRMED = "unconfirmed"

    @property
    def exit_code(self) -> int:
        """Return 0, 1 or 3 for the command line."""
        return {Verdict.AGREE: 0, Verdict.DISAGREE: 1, Verdict.UNCONFIRMED: 3}[self]


@dataclass(frozen=True, eq=False)
class Route:
    """One row of the table.

    Attributes:
        name: riccati, lmi-primal, lmi-dual, lmi-h2, nlp, integral, hamiltonian or closed-form.
        trace: tr P, or None.
        cost: tr(M P), or None.
        output: tr(C P C' V^-1), in discrete time ln det(C P C' + V), or None.
        gain: observer gain (n, l), or None.
        status: "solved", "stabilising", "strong", or what went wrong or does not apply, with the reason.
        relative_difference: against Riccati, in tr P and tr(M P) if it gives P, else in the output; None if nothing.
        residual: relative error that the route's own numbers admit, or None. For a covariance it is estimated by Newton
            steps from it, for the integral it is the quadrature's estimate.
        seconds: wall time.
        independent_of: names of the routes with which it shares no computation but the plant's data.
        agrees: whether its result and Riccati's are both accurate, and equal.
        disagrees: whether its result differs from Riccati's by more than the errors that both admit.
    """

    name: str
    trace: float | None
    cost: float | None
    output: float | None
    gain: Matrix | None
    status: str
    relative_difference: float | None
    residual: float | None
    seconds: float
    independent_of: tuple[str, ...]
    agrees: bool
    disagrees: bool

    @property
    def trusted(self) -> bool:
        """Whether the route's own numbers show that its result is accurate."""
        return self.residual is not None and self.residual <= TRUSTED


@dataclass(frozen=True, eq=False)
class Validation:
    """A plant and what every route says about it; the first route is Riccati."""

    plant: Plant
    routes: tuple[Route, ...]

    def route(self, name: str) -> Route:
        """Return the route of that name."""
        return next(route for route in self.routes if route.name == name)

    @property
    def verdict(self) -> Verdict:
        """Return "agree" when a route independent of Riccati confirms it and none disagrees."""
        if any(route.disagrees for route in self.routes):
            return Verdict.DISAGREE
        riccati = self.routes[0]
        if any(route.agrees and riccati.name in route.independent_of for route in self.routes):
            return Verdict.AGREE
        return Verdict.UNCONFIRMED

    def as_dict(self) -> dict[str, Any]:
        """Return the validation as plain data, schema lmi-validate/1."""
        return {
            "schema": "lmi-validate/1",
            "plant": _plant_dict(self.plant),
            "routes": [_route_dict(route) for route in self.routes],
            "certificate": None,
            "verdict": self.verdict.value,
        }


def validate(
    plant: Plant | str | PathLike[str] | Mapping[str, Any], *, progress: Callable[[str], None] | None = None
) -> Validation:
    """Compute a plant's optimal error covariance by every route and compare the results.

    Args:
        plant: a `Plant`, the path of a plant file, or a mapping with the keys of one.
        progress: called with the name of each route as it starts.

    Returns:
        The table of routes with its verdict. A route that fails or does not apply is in it, with the reason.

    Raises:
        InputError: the plant cannot be used.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> validate(example_plant()).verdict.value
        'agree'
    """
    plant = _as_plant(plant)
    run = _Run(plant, progress or (lambda name: None))
    first, *others = ROUTES
    answer, seconds = run(first)
    reference = _Reference.of(plant, answer)
    routes = [_route(first, answer, seconds, reference)]
    routes += [_route(spec, *run(spec), reference) for spec in others]
    return Validation(plant, tuple(routes))


def _as_plant(plant: Plant | str | PathLike[str] | Mapping[str, Any]) -> Plant:
    if isinstance(plant, Plant):
        return plant
    return plant_from_mapping(plant) if isinstance(plant, Mapping) else load_plant(plant)


@dataclass(frozen=True, eq=False)
class _Run:
    """Run a route; what goes wrong becomes its status, and warnings are left to the residual."""

    plant: Plant
    progress: Callable[[str], None]

    def __call__(self, spec: RouteSpec) -> tuple[Answer, float]:
        if spec.largest is not None and self.plant.n > spec.largest:
            return Answer(f"not attempted: {self.plant.n} states, this route takes up to {spec.largest}"), 0.0
        self.progress(spec.name)
        start = perf_counter()
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                answer = spec.run(self.plant)
        except NUMERICAL_ERRORS as error:
            answer = Answer(f"failed: {' '.join(str(error).split()) or type(error).__name__}")
        return answer, perf_counter() - start


@dataclass(frozen=True, eq=False)
class _Reference:
    """Riccati's results and the sizes to which differences from them are relative."""

    plant: Plant
    answer: Answer
    trace_size: float
    cost_size: float
    output_size: float

    @classmethod
    def of(cls, plant: Plant, answer: Answer) -> "_Reference":
        scaling = balanced(plant)
        unit = scaling.T @ scaling.T.T
        sizes = float(np.trace(unit)), cost_of(plant, unit), scaling.rate * plant.l
        if answer.P is None:
            return cls(plant, answer, *sizes)
        results = float(np.trace(answer.P)), cost_of(plant, answer.P), _output_excess(plant, answer.P)
        return cls(plant, answer, *(_size(value, natural) for value, natural in zip(results, sizes, strict=True)))

    def difference(self, answer: Answer) -> float | None:
        """Return the relative difference of an answer from Riccati's."""
        riccati = self.answer
        if riccati.P is None or riccati.output is None:
            return None
        if answer.P is not None:
            cost = abs(cost_of(self.plant, answer.P - riccati.P)) / self.cost_size
            trace = abs(float(np.trace(answer.P - riccati.P))) / self.trace_size
            return max(cost, trace)
        return None if answer.output is None else abs(answer.output - riccati.output) / self.output_size

    def residual(self, answer: Answer) -> float | None:
        """Return the relative error that an answer admits."""
        if answer.P is None and answer.output is None:
            return None
        return answer.error / (self.output_size if answer.P is None else self.cost_size)

    def error(self, answer: Answer) -> float:
        """Return the relative error of Riccati's result with which an answer is compared."""
        error = self.residual(self.answer) or 0.0
        if answer.P is not None or self.answer.P is None:
            return error
        return max(error, output_rounding(self.plant, self.answer.P) / self.output_size)


def _output_excess(plant: Plant, P: Matrix) -> float:
    """Return tr(C P C' V^-1), in discrete time ln det(C P C' + V) - ln det V: zero when P is, whatever the units."""
    return output_of(plant, P) - (0.0 if plant.is_continuous else float(np.linalg.slogdet(plant.V)[1]))


def _size(value: float, natural: float) -> float:
    return abs(value) if abs(value) > VANISHING * natural else natural or 1.0


def _route(spec: RouteSpec, answer: Answer, seconds: float, reference: _Reference) -> Route:
    P, plant = answer.P, reference.plant
    difference, residual = reference.difference(answer), reference.residual(answer)
    agrees = disagrees = False
    if difference is not None and residual is not None:
        errors = max(residual, reference.error(answer))
        agrees = errors <= TRUSTED and difference <= AGREEMENT
        disagrees = not difference <= max(AGREEMENT, UNEXPLAINED * errors)
    return Route(
        name=spec.name,
        trace=None if P is None else float(np.trace(P)),
        cost=None if P is None else cost_of(plant, P),
        output=answer.output,
        gain=answer.gain,
        status=_judged(answer, difference, residual, disagrees, reference.answer.boundary_modes),
        relative_difference=difference,
        residual=residual,
        seconds=seconds,
        independent_of=spec.independent_of,
        agrees=agrees,
        disagrees=disagrees,
    )


def _judged(
    answer: Answer,
    difference: float | None,
    residual: float | None,
    disagrees: bool,
    boundary_modes: tuple[complex, ...],
) -> str:
    """Return the status of a route, in which a doubtful result is called so."""
    if disagrees:
        return f"disagrees: differs from riccati by {difference:.1e}, more than the errors of both explain"
    if residual is None or residual <= TRUSTED:
        return answer.status
    if boundary_modes:
        modes = ", ".join(dict.fromkeys(format_mode(mode) for mode in boundary_modes))
        return f"not applicable: boundary mode {modes}, reached only in the limit"
    if not np.isfinite(residual):
        doubted = answer.status.startswith("inaccurate")
        return answer.status if doubted else "inaccurate: Newton steps do not confirm its covariance"
    return f"inaccurate: its own numbers admit a relative error of {residual:.1e}"


def _route_dict(route: Route) -> dict[str, Any]:
    return {
        "name": route.name,
        "trace": _finite(route.trace),
        "cost": _finite(route.cost),
        "output": _finite(route.output),
        "gain": None if route.gain is None else route.gain.tolist(),
        "status": route.status,
        "relative_difference": _finite(route.relative_difference),
        "residual": _finite(route.residual),
        "seconds": route.seconds,
        "independent_of": list(route.independent_of),
    }


def _finite(value: float | None) -> float | None:
    return value if value is not None and np.isfinite(value) else None


def _plant_dict(plant: Plant) -> dict[str, Any]:
    """Return the keys of a plant file."""
    data: dict[str, Any] = {"name": plant.name, "time": plant.time}
    data |= {key: getattr(plant, key).tolist() for key in ("A", "C", "W", "V", "N", "M")}
    return data
