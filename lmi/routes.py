"""The independent ways to the optimal error covariance, each run on a plant and reported in one form."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import distance_to_stability, format_mode
from derive.numeric.plant import Plant
from lmi.covariance import covariance_error, solve_covariance
from lmi.programs.h2 import h2
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.programs.program import Program
from lmi.residual import riccati_residual
from lmi.scaling import balanced, scaled_plant
from lmi.solve import Status

if TYPE_CHECKING:
    from derive.numeric.simulation import Sample

__all__ = [
    "ROUTES", "Answer", "RouteSpec", "cost_of", "nuclear_norm", "output_error", "output_of", "output_rounding",
]  # fmt: skip

Matrix = NDArray[np.floating[Any]]

EIGENVALUE_SAFETY = 100.0
"""Factor by which the estimated error of computed eigenvalues is enlarged."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a route found: a covariance with its gain, or the output error alone.

    Attributes:
        status: "solved" or what else became of it, with the reason.
        P: error covariance (n, n), or None.
        gain: observer gain (n, l), or None.
        output: tr(C P C' V^-1) [1/s], in discrete time ln det(C P C' + V), or None.
        error: estimated absolute error, of tr(M P) when there is P, else of the output; infinite when P solves nothing.
        output_error: estimated absolute error of the output.
        boundary_modes: modes that a strong solution leaves on the boundary of stability.
        sample: what P was sampled from, with its intervals; None when P was computed.
        iterations: steps that the method took, or None where it takes none.
        history: what is left to do after each step, in the method's own measure; empty when it does not tell.
    """

    status: str
    P: Matrix | None = None
    gain: Matrix | None = None
    output: float | None = None
    error: float = np.inf
    output_error: float = np.inf
    boundary_modes: tuple[complex, ...] = ()
    sample: "Sample | None" = None
    iterations: int | None = None
    history: tuple[float, ...] = ()


@dataclass(frozen=True)
class RouteSpec:
    """A route: how to run it, which routes it shares no computation with, and how large a plant it takes."""

    name: str
    run: Callable[[Plant], Answer]
    independent_of: tuple[str, ...]
    largest: int | None = None


def cost_of(plant: Plant, P: Matrix) -> float:
    """Return tr(M P)."""
    return float(np.trace(plant.M @ P))


def output_of(plant: Plant, P: Matrix) -> float:
    """Return tr(C P C' V^-1) [1/s], in discrete time ln det(C P C' + V)."""
    output = plant.C @ P @ plant.C.T
    if plant.is_continuous:
        return float(np.trace(np.linalg.solve(plant.V, output)))
    return float(np.linalg.slogdet(output + plant.V)[1])


def output_rounding(plant: Plant, P: Matrix) -> float:
    """Bound what rounding P in double precision does to `output_of`, where C P C' is small by cancellation."""
    size = np.abs(plant.C) @ np.abs(P) @ np.abs(plant.C).T
    innovation = plant.V if plant.is_continuous else plant.C @ P @ plant.C.T + plant.V
    return float(plant.n * np.finfo(float).eps * np.sum(np.abs(np.linalg.inv(innovation)) * size))


def output_error(plant: Plant, P: Matrix, error: Matrix) -> float:
    """Return what an error of P, and its rounding, do to `output_of`."""
    innovation = plant.V if plant.is_continuous else plant.C @ P @ plant.C.T + plant.V
    lacking = np.linalg.solve(innovation, plant.C @ error @ plant.C.T)
    return float(np.linalg.norm(lacking, "nuc")) + output_rounding(plant, P)


def nuclear_norm(plant: Plant, D: Matrix) -> float:
    """Return the sum of |eigenvalues| of M^(1/2) D M^(1/2): |tr(M D)| without the cancellation between its signs."""
    sizes, directions = np.linalg.eigh(plant.M)
    root = directions * np.sqrt(np.maximum(sizes, 0.0))
    return float(np.abs(np.linalg.eigvalsh(root.T @ D @ root)).sum())


def _riccati(plant: Plant) -> Answer:
    from derive.numeric.riccati import solve_riccati

    solution = solve_riccati(plant)
    if solution.status == "failed":
        return Answer(f"failed: {solution.reason}")
    P, gain = solution.P, solution.gain
    if solution.status == "stabilising":
        answer = _covariance(plant, "stabilising", P, gain, solution.error)
        return replace(answer, iterations=solution.newton_steps)
    modes = tuple(complex(mode) for mode in solution.boundary_modes)
    return _strong(plant, P, gain, solution.residual, modes)


def _program(build: Callable[[Plant], Program], largest: int) -> Callable[[Plant], Answer]:
    """Return the route that solves a convex program, for plants that a general solver takes in a second or so."""

    def run(plant: Plant) -> Answer:
        if plant.n > largest:
            return Answer(f"not attempted: {plant.n} states, above {largest} the interior-point route takes its place")
        solution = solve_covariance(plant, build)
        outcome = solution.outcome
        if solution.P is None or solution.gain is None:
            others = [solver for solver, _ in solution.tried if solver != outcome.solver]
            tried = f"; tried in vain: {', '.join(others)}" if others else ""
            return Answer(f"{outcome.status.value} ({outcome.solver}: {outcome.raw_status}{tried})")
        error = solution.error if outcome.status is Status.SOLVED else None
        answer = _covariance(plant, solution.status, solution.P, solution.gain, error)
        return replace(answer, iterations=outcome.iterations)

    return run


def _interior_point(plant: Plant) -> Answer:
    from lmi.interior_point import solve_interior_point

    found = solve_interior_point(plant)
    if found.P is None or found.gain is None:
        return Answer(found.status)
    error = covariance_error(plant, found.P) if found.status == Status.SOLVED.value else None
    answer = _covariance(plant, found.status, found.P, found.gain, error)
    return replace(answer, iterations=len(found.history) - 1, history=found.history)


def _nlp(plant: Plant) -> Answer:
    from derive.numeric.gain_nlp import optimise_gain

    result = optimise_gain(plant)
    if result.status == "failed":
        return Answer("failed: no stabilising gain was found")
    if result.status == "strong":
        return _strong(plant, result.P, result.gain, result.stationarity)
    status = "solved" if result.status == "optimal" else "inaccurate: the gradient of tr P does not vanish"
    answer = _covariance(plant, status, result.P, result.gain, covariance_error(plant, result.P))
    history = tuple((trace - result.trace) / (result.trace or 1.0) for trace in result.history)
    return replace(answer, iterations=result.iterations, history=history)


def _covariance(plant: Plant, status: str, P: Matrix, gain: Matrix, error: Matrix | None) -> Answer:
    if error is None:
        return Answer(status, P, gain, output_of(plant, P))
    return Answer(status, P, gain, output_of(plant, P), nuclear_norm(plant, error), output_error(plant, P, error))


def _strong(
    plant: Plant, P: Matrix, gain: Matrix, rtol: float, modes: tuple[complex, ...] = (), status: str = "strong"
) -> Answer:
    """Return a covariance whose relative error is that of its equation, as Newton steps need a stable closed loop."""
    error = rtol * abs(cost_of(plant, P))
    return Answer(status, P, gain, output_of(plant, P), error, output_error(plant, P, rtol * P), modes)


def _integral(plant: Plant) -> Answer:
    from derive.numeric.spectrum import output_error_integral

    result = output_error_integral(plant)
    return Answer("solved", output=result.value, error=result.error_estimate, output_error=result.error_estimate)


def _hamiltonian(plant: Plant) -> Answer:
    from derive.numeric.spectrum import hamiltonian_route

    result = hamiltonian_route(plant)
    if not np.isfinite(result.value):
        return Answer("inaccurate: computed modes do not split into stable and unstable ones")
    error = _eigenvalue_error(plant, result.modes)
    return Answer("solved", output=result.value, error=error, output_error=error)


def _eigenvalue_error(plant: Plant, modes: NDArray[Any]) -> float:
    """Estimate the error of a sum of modes that merge with their mirror images on the boundary of stability.

    A perturbation of relative size eps moves a mode at distance d from the boundary by about eps |H|^2 / d, where |H|
    is the size of the Hamiltonian matrix or of the symplectic pencil.
    """
    scaling = balanced(plant)
    scaled = scaled_plant(plant, scaling)
    G = scaled.C.T @ np.linalg.solve(scaled.V, scaled.C)
    size = max(1.0, float(np.linalg.norm(scaled.A)), float(np.sqrt(np.linalg.norm(scaled.W) * np.linalg.norm(G))))
    distances = np.maximum(-distance_to_stability(modes, plant.time) / scaling.rate, np.finfo(float).tiny)
    return float(EIGENVALUE_SAFETY * np.finfo(float).eps * scaling.rate * size * np.sum(size / distances))


def _closed_form(plant: Plant) -> Answer:
    from derive.numeric.low_order import ORDER, low_order_output
    from derive.numeric.scalar import solve_scalar

    if plant.n > ORDER:
        return Answer(f"not applicable: for at most {ORDER} states, not {plant.n}")
    if (plant.n, plant.l) != (1, 1):
        value, error = low_order_output(plant)
        error += abs(value) * np.finfo(float).eps
        return Answer("solved", output=value, error=error, output_error=error)
    solution = solve_scalar(plant)
    P, gain = np.array([[solution.P]]), np.array([[solution.gain]])
    status = "strong" if solution.status == "strong" else "solved"
    return _strong(plant, P, gain, riccati_residual(plant, P), status=status)


def _simulation(plant: Plant) -> Answer:
    """Simulate the observer with Riccati's gain: that confirms the covariance of this gain, not the gain."""
    from derive.numeric.riccati import solve_riccati
    from derive.numeric.simulation import simulate_error

    known = solve_riccati(plant)
    if known.status == "failed":
        return Answer("not applicable: there is no gain to simulate")
    if known.status == "strong":
        mode = format_mode(complex(known.boundary_modes[0]))
        return Answer(f"not applicable: mode {mode} of A - L C does not decay, so no error is steady")
    found = simulate_error(plant, known.gain)
    if found.sample is None:
        return Answer(found.status)
    return Answer(found.status, found.sample.P, error=found.sample.cost.half_width, sample=found.sample)


_CONVEX = ("lmi-primal", "lmi-dual", "lmi-h2")
_OTHERS = ("nlp", "integral", "closed-form")
_APART = (*_CONVEX, "interior-point", *_OTHERS)
_BASED = ("hamiltonian", "simulation")

ROUTES = (
    RouteSpec("riccati", _riccati, _APART),
    RouteSpec("lmi-primal", _program(optimal_covariance, 12), ("riccati", *_OTHERS, *_BASED)),
    RouteSpec("lmi-dual", _program(optimal_covariance_dual, 20), ("riccati", *_OTHERS, *_BASED)),
    RouteSpec("lmi-h2", _program(h2, 12), ("riccati", *_OTHERS, *_BASED)),
    RouteSpec("interior-point", _interior_point, ("riccati", *_OTHERS, *_BASED), largest=120),
    RouteSpec("nlp", _nlp, ("riccati", *_CONVEX, "interior-point", "integral", "closed-form", *_BASED), largest=40),
    RouteSpec("integral", _integral, ("riccati", *_CONVEX, "interior-point", "nlp", "closed-form", *_BASED)),
    RouteSpec("hamiltonian", _hamiltonian, _APART),
    RouteSpec("closed-form", _closed_form, ("riccati", *_CONVEX, "interior-point", "nlp", "integral", *_BASED)),
    RouteSpec("simulation", _simulation, _APART, largest=50),
)
"""Riccati first. The convex programs and the interior-point method share coordinates and form, Riccati
and the Hamiltonian's eigenvalues the same matrix, and the simulation runs with Riccati's gain, so that these do not
confirm each other. The interior-point method and the programs take their coordinates, and it its start, from a rough
covariance of Lyapunov equations, not from Riccati's answer. A sampled answer confirms nothing; it may disagree."""
