"""One plant, every route to its optimal error covariance, one verdict."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from os import PathLike
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant, as_plant
from lmi.certification.outcome import CertificateOutcome, attempt_certificate
from lmi.comparison import AGREEMENT, Reference, Route, judged
from lmi.enclosure import NUMERICAL_ERRORS, Enclosure, enclose
from lmi.routes import ROUTES, Answer, RouteSpec, cost_of, nuclear_norm

__all__ = ["FilterForm", "Route", "Validation", "Verdict", "validate"]

Matrix = NDArray[np.floating[Any]]


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
class FilterForm:
    """The discrete optimum after the measurement of the same instant.

    Attributes:
        P: covariance P+ (n, n) [state]^2.
        gain: L_f (n, l) [state]/[output].
        trace: tr P+.
        cost: tr(M P+).
    """

    P: Matrix
    gain: Matrix
    trace: float
    cost: float


@dataclass(frozen=True, eq=False)
class Validation:
    """A plant, what every route says about it, and what is proved; the first route is Riccati.

    Attributes:
        plant: the plant.
        routes: the table.
        enclosure: what is proved when the plant's numbers are taken as exact.
        reads_as_boundary: whether the routes read modes as on the boundary that the exact numbers have beside it.
        certificate: an exact sandwich of the optimum, or why there is none.
        excluded: whether the certificate proves Riccati's tr P wrong.
    """

    plant: Plant
    routes: tuple[Route, ...]
    enclosure: Enclosure
    reads_as_boundary: bool
    certificate: CertificateOutcome
    excluded: bool

    def route(self, name: str) -> Route:
        """Return the route of that name."""
        return next(route for route in self.routes if route.name == name)

    @property
    def verdict(self) -> Verdict:
        """Return "agree" when the certificate holds, a route independent of Riccati confirms it and none disagrees."""
        if self.excluded or any(route.disagrees for route in self.routes):
            return Verdict.DISAGREE
        return Verdict.AGREE if self.confirming and self.certificate.certified else Verdict.UNCONFIRMED

    @property
    def confirming(self) -> tuple[Route, ...]:
        """The routes that share no computation with Riccati's and agree with it."""
        riccati = self.routes[0].name
        return tuple(route for route in self.routes if route.confirms and riccati in route.independent_of)

    @property
    def filter_form(self) -> FilterForm | None:
        """Riccati's answer in filter form; None in continuous time, or without an answer."""
        P = self.routes[0].P
        if self.plant.is_continuous or P is None or not np.isfinite(P).all():
            return None
        from derive.numeric.filter_form import filter_covariance, filter_gain

        after = filter_covariance(self.plant, P)
        cost = cost_of(self.plant, after)
        return FilterForm(after, filter_gain(self.plant, P), float(np.trace(after)), cost)

    def __str__(self) -> str:
        """Return the table, what is proved, and the verdict, as the command line prints them."""
        from io import StringIO

        from lmi.report.table import print_table

        out = StringIO()
        print_table(self, out)
        return out.getvalue().rstrip()

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        from lmi.report.notebook import as_html

        return as_html(self)

    def as_dict(self) -> dict[str, Any]:
        """Return the validation as plain data, schema lmi-validate/1."""
        from lmi.report.data import as_dict

        return as_dict(self)


def validate(
    plant: Plant | str | PathLike[str] | Mapping[str, Any], *, progress: Callable[[str], None] | None = None
) -> Validation:
    """Compute a plant's optimal error covariance by every route and compare the results, also with what is proved.

    Args:
        plant: a `Plant`, the path of a plant file, or a mapping with the keys of one.
        progress: called with the name of each route as it starts, first with "enclosure", last with "certificate".

    Returns:
        The table of routes with its verdict. A route that fails or does not apply is in it, with the reason.

    Raises:
        InputError: the plant cannot be used.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> validate(example_plant()).verdict.value
        'agree'
    """
    plant = as_plant(plant)
    progress = progress or (lambda name: None)
    progress("enclosure")
    enclosure, run = enclose(plant), _Run(plant, progress)
    first, *others = ROUTES
    answer, seconds = run(first)
    answer = _with_proved_error(plant, answer, enclosure)
    reference = Reference.of(plant, answer, enclosure)
    routes = [judged(first, answer, seconds, reference)]
    routes += [judged(spec, *run(spec), reference) for spec in others]
    progress("certificate")
    certificate = attempt_certificate(plant)
    admitted = max(AGREEMENT * reference.trace_size, answer.error if np.isfinite(answer.error) else 0.0)
    excluded = certificate.excludes(routes[0].trace, admitted) and not answer.boundary_modes
    return Validation(plant, tuple(routes), enclosure, reference.reads_as_boundary, certificate, excluded)


def _with_proved_error(plant: Plant, answer: Answer, enclosure: Enclosure) -> Answer:
    """Return Riccati's answer with the error of its cost as it is proved, where that is less than the estimate."""
    lacking = None if answer.P is None else enclosure.lacking(answer.P)
    if lacking is None:
        return answer
    return replace(answer, error=min(answer.error, nuclear_norm(plant, lacking)))


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
