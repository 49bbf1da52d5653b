"""Whether a route's result confirms or contradicts Riccati's, judged by the errors that both admit."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import distance_to_stability, format_mode, spectral_scale
from derive.numeric.plant import Plant
from derive.numeric.simulation import Sample
from lmi.enclosure import Enclosure
from lmi.routes import Answer, RouteSpec, cost_of, output_of, output_rounding
from lmi.sampling import SampleReading, read_sample
from lmi.scaling import balanced

__all__ = ["AGREEMENT", "TRUSTED", "Reference", "Route", "judged"]

Matrix = NDArray[np.floating[Any]]

AGREEMENT = 1e-6
"""Routes agree when their results differ by at most this, relative."""

TRUSTED = 1e-7
"""A route confirms only when the error that its own numbers admit is at most this, relative."""

UNEXPLAINED = 10.0
"""A route disagrees when it differs by more than this many times the errors that it and Riccati admit."""

NEAR = 1e-6
"""Distance of a mode of A - L C from the boundary of stability, relative to A, within which it is named as the cause of
what goes wrong."""

VANISHING = 1e-9
"""A result smaller than this, relative to the natural size of the plant's coordinates, is zero unless its own error is
far smaller: differences are then relative to that natural size."""


@dataclass(frozen=True, eq=False)
class Route:
    """One row of the table.

    Attributes:
        name: riccati, lmi-primal, lmi-dual, lmi-h2, interior-point, nlp, integral, hamiltonian, closed-form or
            simulation.
        trace: tr P, or None.
        cost: tr(M P), or None.
        P: error covariance (n, n), or None.
        output: tr(C P C' V^-1), in discrete time ln det(C P C' + V), or None.
        gain: observer gain (n, l), or None.
        status: "solved", "stabilising", "strong", "sampled", or what went wrong or does not apply, with the reason.
        relative_difference: against Riccati, in tr P and tr(M P) if it gives P, else in the output; None if nothing.
        difference: the same against the enclosure, a proved bound, or against Riccati where nothing is enclosed.
        difference_from: "enclosure" or "riccati", or None when there is nothing to compare.
        residual: relative error that the route's own numbers admit, or None. For a covariance it is estimated by Newton
            steps from it, for the integral it is the quadrature's estimate, for a sample its interval's half width.
        seconds: wall time.
        independent_of: names of the routes with which it shares no computation but the plant's data.
        output_error: proved bound of the error of `output`, absolute, or None when nothing is proved.
        output_digits: decimal digits of `output` that are proved correct, or None.
        agrees: whether its result and Riccati's are both accurate, and equal; of a sample, whether its intervals hold
            Riccati's result.
        disagrees: whether its result differs from Riccati's by more than the errors that both admit, or is proved to;
            of a sample, whether it is farther from Riccati's than chance can be.
        excluded: whether its output is proved to be wrong by more than the error that it admits.
        sample: what P was sampled from, with the intervals; None for routes that compute.
        iterations: steps that the method took, or None.
        history: what was left to do after each step, in the method's own measure.
    """

    name: str
    trace: float | None
    cost: float | None
    P: Matrix | None
    output: float | None
    gain: Matrix | None
    status: str
    relative_difference: float | None
    difference: float | None
    difference_from: str | None
    residual: float | None
    seconds: float
    independent_of: tuple[str, ...]
    output_error: float | None
    output_digits: int | None
    agrees: bool
    disagrees: bool
    excluded: bool
    sample: Sample | None
    iterations: int | None
    history: tuple[float, ...]

    @property
    def trusted(self) -> bool:
        """Whether the route's own numbers show that its result is accurate."""
        return self.residual is not None and self.residual <= TRUSTED

    @property
    def confirms(self) -> bool:
        """Whether it agrees to the accuracy of a computed answer; no sample does."""
        return self.agrees and self.sample is None


@dataclass(frozen=True, eq=False)
class Reference:
    """Riccati's answer, the sizes to which differences from it are relative, and what is proved."""

    plant: Plant
    answer: Answer
    trace_size: float
    cost_size: float
    output_size: float
    enclosure: Enclosure

    @classmethod
    def of(cls, plant: Plant, answer: Answer, enclosure: Enclosure) -> "Reference":
        """Take Riccati's answer; its results set the sizes, or where they vanish the balanced coordinates do."""
        scaling = balanced(plant)
        unit = scaling.T @ scaling.T.T
        sizes = float(np.trace(unit)), cost_of(plant, unit), scaling.rate * plant.l
        if answer.P is None:
            return cls(plant, answer, *sizes, enclosure)
        results = float(np.trace(answer.P)), cost_of(plant, answer.P), _output_excess(plant, answer.P)
        errors = answer.error, answer.error, answer.output_error
        trace, cost, output = map(_size, results, sizes, errors)
        return cls(plant, answer, trace, cost, output, enclosure)

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

    def proved_difference(self, answer: Answer) -> float | None:
        """Return a proved bound of an answer's relative error, or None when nothing is proved."""
        if answer.P is None:
            distance = self.enclosure.distance(answer.output)
            return None if distance is None else distance / self.output_size
        distances = self.enclosure.covariance_distances(float(np.trace(answer.P)), cost_of(self.plant, answer.P))
        return None if distances is None else max(distances[0] / self.trace_size, distances[1] / self.cost_size)

    def reading(self, answer: Answer) -> SampleReading | None:
        """Return how a sampled answer stands to Riccati's, None when it is computed or Riccati's is worth nothing."""
        errors = AGREEMENT + UNEXPLAINED * self.error(answer)
        if answer.sample is None or self.answer.P is None or not np.isfinite(errors):
            return None
        T = balanced(self.plant).T
        slack = VANISHING * np.diag(T @ T.T) + errors * np.abs(np.diag(self.answer.P))
        return read_sample(answer.sample, self.answer.P, self.plant.M, slack)

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

    def modes_in_the_way(self) -> tuple[complex, ...]:
        """Return the modes of Riccati's A - L C on the boundary of stability or beside it."""
        plant, gain = self.plant, self.answer.gain
        if self.answer.boundary_modes or gain is None or not np.isfinite(gain).all():
            return self.answer.boundary_modes
        modes = np.linalg.eigvals(plant.A - gain @ plant.C)
        distance = np.abs(distance_to_stability(modes, plant.time))
        return tuple(complex(x) for x in modes[distance <= NEAR * spectral_scale(plant.A, plant.time)])

    def excludes(self, answer: Answer) -> bool:
        """Tell whether an answer's output is proved to be wrong by more than the error that it admits.

        Nothing is wrong about modes that Riccati reads as on the boundary and the exact numbers have beside it.
        """
        return self._apart(answer) and not self.answer.boundary_modes

    @property
    def reads_as_boundary(self) -> bool:
        """Whether Riccati's strong solution is another than that of the plant's numbers taken as exact."""
        return self._apart(self.answer) and bool(self.answer.boundary_modes)

    def _apart(self, answer: Answer) -> bool:
        apart, admitted = (x / self.output_size for x in (self.enclosure.apart(answer.output), answer.output_error))
        return apart > max(AGREEMENT, UNEXPLAINED * admitted)


def _output_excess(plant: Plant, P: Matrix) -> float:
    """Return tr(C P C' V^-1), in discrete time ln det(C P C' + V) - ln det V: zero when P is, whatever the units."""
    return output_of(plant, P) - (0.0 if plant.is_continuous else float(np.linalg.slogdet(plant.V)[1]))


def _size(value: float, natural: float, error: float) -> float:
    """Return the size of a result, or where that is zero within its error the natural size."""
    accurate = abs(value) > 0 and error <= TRUSTED * abs(value)
    return abs(value) if accurate or abs(value) > VANISHING * natural else natural or 1.0


def judged(spec: RouteSpec, answer: Answer, seconds: float, reference: Reference) -> Route:
    """Return the row of the table for what a route answered, compared with Riccati's answer."""
    P, plant = answer.P, reference.plant
    difference, residual = reference.difference(answer), reference.residual(answer)
    proved, reading = reference.proved_difference(answer), reference.reading(answer)
    excluded = reference.excludes(answer)
    agrees, disagrees = _verdict(answer, reading, difference, reference)
    return Route(
        name=spec.name,
        trace=None if P is None else float(np.trace(P)),
        cost=None if P is None else cost_of(plant, P),
        P=P,
        output=answer.output,
        gain=answer.gain,
        status=reading.status if reading else _status(answer, difference, residual, (disagrees, excluded), reference),
        relative_difference=difference,
        difference=difference if proved is None else proved,
        difference_from="enclosure" if proved is not None else None if difference is None else "riccati",
        residual=residual,
        seconds=seconds,
        independent_of=spec.independent_of,
        output_error=reference.enclosure.distance(answer.output),
        output_digits=reference.enclosure.correct_digits(answer.output),
        agrees=agrees and not excluded,
        disagrees=disagrees or excluded,
        excluded=excluded,
        sample=answer.sample,
        iterations=answer.iterations,
        history=answer.history,
    )


def _verdict(
    answer: Answer, reading: SampleReading | None, difference: float | None, reference: Reference
) -> tuple[bool, bool]:
    """Return whether an answer agrees with Riccati's, and whether it disagrees; neither where it is not accurate."""
    residual = reference.residual(answer)
    if reading is not None:
        return reading.holds and not reading.disagrees and reference.error(answer) <= TRUSTED, reading.disagrees
    if difference is None or residual is None:
        return False, False
    errors = max(residual, reference.error(answer))
    return errors <= TRUSTED and difference <= AGREEMENT, not difference <= max(AGREEMENT, UNEXPLAINED * errors)


def _status(
    answer: Answer, difference: float | None, residual: float | None, wrong: tuple[bool, bool], reference: Reference
) -> str:
    """Return the status of a route, in which a doubtful result is called so, and one that is `wrong` first of all."""
    disagrees, excluded = wrong
    if excluded:
        return "disagrees: its output is proved to be wrong by more than its own error explains"
    if disagrees:
        return f"disagrees: differs from riccati by {difference:.1e}, more than the errors of both explain"
    if answer.status.startswith("not ") or answer.sample is not None or (residual is not None and residual <= TRUSTED):
        return answer.status
    modes = ", ".join(dict.fromkeys(map(format_mode, reference.modes_in_the_way())))
    if residual is not None and reference.answer.boundary_modes:
        return f"not applicable: boundary mode {modes}, reached only in the limit"
    refusal = _refusal(answer, residual)
    return f"{refusal}; mode {modes} of A - L C is on the boundary or beside it" if modes else refusal


def _refusal(answer: Answer, residual: float | None) -> str:
    """Return why a result is not taken."""
    if residual is None:
        return answer.status
    if not np.isfinite(residual):
        doubted = answer.status.startswith("inaccurate")
        return answer.status if doubted else "inaccurate: Newton steps do not confirm its covariance"
    return f"inaccurate: its own numbers admit a relative error of {residual:.1e}"
