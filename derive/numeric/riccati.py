"""The Riccati equations of the steady optimal estimator, continuous and discrete."""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from derive.numeric.extended import divided
from derive.numeric.modes import Matrix, distance_to_stability, format_mode, spectral_scale, undetectable_mode
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant
from derive.numeric.riccati_iterations import Candidate, best_candidate
from derive.numeric.sensitivity import sensitivity

__all__ = ["RiccatiSolution", "Status", "solve_riccati"]

Modes = NDArray[np.complexfloating[Any, Any]]
Status = Literal["stabilising", "strong", "failed"]

FAILED = 1e-6
"""Relative residual above which there is no solution to speak of."""

ROUNDED_SLACK = 1e3
"""Factor on the tolerances for boundary modes when nothing is found without it: data that carry earlier rounding."""

INACCURATE = 1e-13
"""Relative error above which the solution is computed again in high precision."""

DIGITS = 20
"""Decimal digits that high precision aims at."""

LARGEST = 64
"""States up to which it takes a second or so."""

NAMED = 4
"""Modes named in a reason."""

NEAR_RTOL = 1e-6
"""Distance of a mode from the boundary, relative to A, within which it is named as near."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RiccatiSolution:
    """The steady error covariance and the optimal gain.

    Attributes:
        P: error covariance (n, n) [state]^2, of the predicted state in discrete time.
        gain: L (n, l) of the observer x' = A x + L (y - C x), in discrete time of the predictor.
        closed_loop: eigenvalues of A - L C (n,): half of those of the Hamiltonian matrix (symplectic pencil), of which
            the others are the mirror images.
        residual: |residual of the equation| / sum of the sizes of its terms, in balanced coordinates.
        status: "stabilising" when A - L C is asymptotically stable, "strong" when it keeps boundary modes that the
            noise does not excite, "failed" when neither was reached (P is then the best attempt, or not a number).
        reason: why it failed, in one line; empty when it did not.
        error: estimated bound of |P - P*|_ij (n, n) [state]^2, infinite when it failed. `enclose_riccati` proves one.
        condition: relative change of P for a relative change of A, W, C'V^-1 C in balanced coordinates, to first order
            and at most; 0 when P = 0, infinite when it failed.
        near_boundary: those of `closed_loop` on the boundary of stability, or nearer to it than 1e-6 of the size of A.
        boundary_modes: eigenvalues that the strong solution leaves on the boundary, empty when it is stabilising.
        newton_steps: accepted Newton steps in extended precision.
    """

    P: Matrix
    gain: Matrix
    closed_loop: Modes
    residual: float
    status: Status
    reason: str = ""
    error: Matrix
    condition: float
    near_boundary: Modes
    boundary_modes: Modes
    newton_steps: int

    def is_stable(self, plant: Plant) -> bool:
        """Whether the computed eigenvalues of A - L C are stable."""
        return bool(np.all(distance_to_stability(self.closed_loop, plant.time) < 0))

    @property
    def relative_error(self) -> float:
        """Estimated bound of |P - P*| / |P|, Frobenius norms; 0 when there is no error, infinite when P = 0 has one."""
        error, size = float(np.linalg.norm(self.error)), float(np.linalg.norm(self.P))
        if not error:
            return 0.0
        return error / size if size else np.inf


def solve_riccati(plant: Plant) -> RiccatiSolution:
    """Solve A P + P A' + W - (P C' + N) V^-1 (P C' + N)' = 0, in discrete time the predictor form of the same.

    Discrete: P = A P A' + Q - (A P C' + S)(C P C' + R)^-1 (A P C' + S)', L = (A P C' + S)(C P C' + R)^-1.
    Continuous: L = (P C' + N) V^-1.

    The cross term is removed (F = A - N V^-1 C, W - N V^-1 N'), V made the identity, the states scaled by powers of
    two, and unexcited boundary modes are split off, on which P vanishes. SciPy's answer, or where that is not
    accurate the one of Kleinman's iteration, is refined by Newton steps whose residual is formed in extended precision.
    Where the estimated error is more than rounding or stability is in doubt, all is done again in high precision, which
    ends in a proof or in the status "failed".

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.

    Returns:
        The stabilising solution; the strong one when unexcited modes lie on the boundary.

    Source: D. L. Kleinman, On an iterative technique for Riccati equation computations, IEEE Trans. Automat. Control 13
        (1968) 114-115; stated for the regulator, the dual.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> solution = solve_riccati(example_plant())
        >>> solution.status, solution.residual < 1e-14, solution.relative_error < 1e-14
        ('stabilising', True, True)
    """
    with np.errstate(all="ignore"):  # a method that leaves the numbers is not taken
        whole = normal_form(plant)
        if not all(np.isfinite(X).all() for X in (whole.A, whole.C, whole.W, whole.N)):
            return _without_normal_form(plant)
        first = _in_extended_precision(plant, whole, slack=1.0)
        if first.status != "failed" or first.is_stable(plant):
            return _checked(plant, whole, first)
        second = _in_extended_precision(plant, whole, ROUNDED_SLACK)
        return _checked(plant, whole, first if second.status == "failed" else second)


def _checked(plant: Plant, whole: NormalForm, solution: RiccatiSolution) -> RiccatiSolution:
    """Return a solution that is accurate, or what high precision makes of it."""
    if solution.status == "strong" or solution.relative_error <= INACCURATE or plant.n > LARGEST:
        return solution
    return _in_high_precision(plant, whole, solution)


def _in_extended_precision(plant: Plant, whole: NormalForm, slack: float) -> RiccatiSolution:
    boundary = whole.boundary(slack)
    part = whole.without(boundary)
    found = best_candidate(part)
    sense = sensitivity(part, found, _correlation(plant))
    U = boundary.kept if len(boundary.modes) else np.eye(len(part.A))
    P = U @ found.P @ U.T
    residual = Candidate.of(whole, P).residual if len(boundary.modes) else found.residual
    modes = np.linalg.eigvals(found.closed_loop) if found.finite else np.full(len(part.A), np.nan)
    modes = np.concatenate([modes.astype(complex), boundary.modes])
    covariance = whole.unscaled(P)
    solution = RiccatiSolution(
        P=covariance.astype(float),
        gain=_plant_gain(plant, covariance).astype(float),
        closed_loop=modes,
        residual=residual,
        status="strong" if len(boundary.modes) else "stabilising",
        error=_entries(U @ sense.error @ U.T, whole) + _rounding(covariance),
        condition=sense.condition,
        near_boundary=_near(modes, whole),
        boundary_modes=boundary.modes,
        newton_steps=found.steps,
    )
    return solution if found.is_stable(part) and residual < FAILED and sense.doubt < 1 else _failed(plant, solution)


def _in_high_precision(plant: Plant, whole: NormalForm, start: RiccatiSolution) -> RiccatiSolution:
    """Return the solution with a proved error, or the start, failed."""
    from derive.numeric.balls import exact, floats, norm, working_bits
    from derive.numeric.high_precision import closed_ball

    closed = closed_ball(plant, start.P if start.is_stable(plant) else None, DIGITS)
    if closed.proof.radius is None:
        return _failed(plant, start)
    with working_bits(closed.bits):
        scaled = floats(closed.P) + floats(closed.P - exact(floats(closed.P))).astype(np.longdouble)
        loop = floats(closed.equation.closed_loop(closed.P))
        radius, residual = (
            float(x.abs_upper()) for x in (closed.proof.radius, norm(closed.equation.residual(closed.P)))
        )
    P, found = whole.unscaled(scaled), Candidate.of(whole, scaled)
    modes = np.linalg.eigvals(loop).astype(complex)
    return replace(
        start,
        P=P.astype(float),
        gain=_plant_gain(plant, P).astype(float),
        closed_loop=modes,
        residual=residual / found.size if residual else 0.0,
        status="stabilising",
        reason="",
        error=_entries(radius * np.eye(plant.n), whole) + _rounding(P),
        condition=sensitivity(whole, found, _correlation(plant)).condition,
        near_boundary=_near(modes, whole),
        boundary_modes=np.zeros(0, complex),
    )


def _failed(plant: Plant, solution: RiccatiSolution) -> RiccatiSolution:
    """Return the solution with its status and the reason why it is none."""
    near = list(dict.fromkeys(map(format_mode, solution.near_boundary)))
    modes = ", ".join(near[:NAMED]) + (f" and {len(near) - NAMED} more" if len(near) > NAMED else "")
    hidden = undetectable_mode(plant.A, plant.C, plant.time)
    if hidden is not None:
        reason = f"(A, C): expected detectable, got mode {format_mode(hidden)} unobservable"
    elif modes:
        reason = f"closed loop: expected stable, got {modes} on the boundary or too near to tell"
    else:
        reason = "closed loop: expected stable, found no gain that makes it so within the precision"
    return replace(
        solution,
        status="failed",
        reason=reason,
        error=np.full(solution.P.shape, np.inf),
        condition=np.inf,
        boundary_modes=np.zeros(0, complex),
    )


def _without_normal_form(plant: Plant) -> RiccatiSolution:
    n, l = plant.n, plant.l  # noqa: E741
    return RiccatiSolution(
        P=np.full((n, n), np.nan),
        gain=np.full((n, l), np.nan),
        closed_loop=np.full(n, np.nan + 0j),
        residual=np.inf,
        status="failed",
        reason="V: expected positive definite beyond rounding, got a singular or indefinite matrix",
        error=np.full((n, n), np.inf),
        condition=np.inf,
        near_boundary=np.zeros(0, complex),
        boundary_modes=np.zeros(0, complex),
        newton_steps=0,
    )


def _plant_gain(plant: Plant, P: Matrix) -> Matrix:
    PC = P @ plant.C.T
    if plant.is_continuous:
        return divided(PC + plant.N, plant.V.astype(P.dtype))
    return divided(plant.A @ PC + plant.N, plant.C @ PC + plant.V)


def _correlation(plant: Plant) -> float:
    """Return the condition number of the measurement noise's correlation matrix."""
    size = np.sqrt(np.diag(plant.V))
    return float(np.linalg.cond(plant.V / np.outer(size, size)))


def _entries(E: Matrix, form: NormalForm) -> Matrix:
    """Return the bounds sqrt(E_ii E_jj) of the entries of every D with -E <= D <= E, in the plant's states."""
    deviations = np.sqrt(np.maximum(np.diag(E), 0.0)) * form.scaling.astype(float)
    return np.outer(deviations, deviations)


def _rounding(P: Matrix) -> Matrix:
    """Return what rounding to doubles does to the entries."""
    return float(np.finfo(float).eps) * np.abs(P.astype(float))


def _near(modes: Modes, form: NormalForm) -> Modes:
    """Return the modes on the boundary of stability or near to it."""
    size = spectral_scale(form.A.astype(float), form.time)
    return modes[np.abs(distance_to_stability(modes, form.time)) <= NEAR_RTOL * size]
