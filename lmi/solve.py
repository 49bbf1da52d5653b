"""The one place that calls a conic solver, and that judges what it returns.

A solver's "optimal" is a claim. Every answer is judged by what can be recomputed from the numbers returned: the
eigenvalues of the matrices that should be positive semidefinite, and the equations that should hold.
"""

import os
import shutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from tempfile import TemporaryFile
from typing import Any

import cvxpy as cp
import numpy as np

from lmi.programs.program import Program

__all__ = ["TO_THE_LAST_DIGIT", "Accuracy", "Outcome", "Status", "solve_program"]

FEASIBLE = 1e-6
"""A matrix is positive semidefinite, or an equation holds, when it fails by less than this, relative to its size."""

STANDARD_ERROR = 2
"""Its file descriptor, by which compiled code writes."""

TIME_LIMIT = 60.0
"""Seconds that one call of the solver may take."""


class Status(Enum):
    """What became of a program; the value is the message."""

    SOLVED = "solved"
    INACCURATE = "inaccurate: the numbers returned do not solve the program"
    INFEASIBLE = "infeasible: no numbers satisfy the constraints"
    UNBOUNDED = "unbounded: the objective has no limit"
    STOPPED = "stopped: limit of time or iterations reached"
    FAILED = "failed: the solver returned no numbers"


@dataclass(frozen=True)
class Accuracy:
    """What is asked of the solver.

    Attributes:
        tolerance: of the duality gap and of feasibility, absolute and relative.
        regularisation: added to the diagonal of its linear systems; more is sturdier and slower.
    """

    tolerance: float
    regularisation: float


TO_THE_LAST_DIGIT = Accuracy(1e-12, 1e-8)


@dataclass(frozen=True)
class Outcome:
    """One call of the solver, judged by its numbers.

    Attributes:
        status: SOLVED only when the numbers satisfy every constraint to `FEASIBLE`.
        raw_status: the solver's own word.
        margin: smallest eigenvalue of a matrix that should be >= 0, relative to its norm; negative when it fails.
        violation: largest entry by which an equation fails, relative to the largest entry of a variable (at least 1).
        iterations: of the interior-point method.
    """

    status: Status
    raw_status: str
    margin: float = -np.inf
    violation: float = np.inf
    iterations: int = 0


def solve_program(program: Program, accuracy: Accuracy = TO_THE_LAST_DIGIT) -> Outcome:
    """Call the solver once and judge the numbers that it leaves in the program's variables.

    Clarabel's chordal decomposition is off: the programs are dense, and it would only add a transformation to trust.
    CVXPY's warnings are kept from the user; the outcome says what they would.
    """
    options: dict[str, Any] = {
        "tol_gap_abs": accuracy.tolerance,
        "tol_gap_rel": accuracy.tolerance,
        "tol_feas": accuracy.tolerance,
        "static_regularization_constant": accuracy.regularisation,
        "max_iter": 200,
        "time_limit": TIME_LIMIT,
        "chordal_decomposition_enable": False,
    }
    problem = program.problem
    try:
        with warnings.catch_warnings(), _panics_as_errors():
            warnings.simplefilter("ignore")
            problem.solve(solver=cp.CLARABEL, **options)
    except cp.SolverError as error:
        return Outcome(Status.FAILED, str(error).split(".")[0])
    return _judged(problem)


@contextmanager
def _panics_as_errors() -> Iterator[None]:
    """Turn a panic of the solver into a SolverError.

    A panic of compiled code is a BaseException that no module exports, and prints its own report to the standard error
    of the process, which is therefore held back: dropped after a panic, passed on otherwise.
    """
    with TemporaryFile() as held:
        stderr, panicked = os.dup(STANDARD_ERROR), False
        os.dup2(held.fileno(), STANDARD_ERROR)
        try:
            yield
        except BaseException as error:
            panicked = type(error).__name__ == "PanicException"
            if not panicked:
                raise
            raise cp.SolverError(f"panic: {error}") from None
        finally:
            os.dup2(stderr, STANDARD_ERROR)
            os.close(stderr)
            if not panicked:
                held.seek(0)
                with os.fdopen(STANDARD_ERROR, "wb", closefd=False) as passed_on:
                    shutil.copyfileobj(held, passed_on)


def _judged(problem: cp.Problem) -> Outcome:
    raw = str(problem.status)
    stats = problem.solver_stats
    iterations = int(stats.num_iters or 0) if stats is not None else 0
    if raw in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
        if not all(np.isfinite(np.asarray(variable.value, dtype=float)).all() for variable in problem.variables()):
            return Outcome(Status.FAILED, raw, iterations=iterations)
        margin, violation = _margin(problem), _violation(problem)
        status = Status.SOLVED if margin >= -FEASIBLE and violation <= FEASIBLE else Status.INACCURATE
        return Outcome(status, raw, margin, violation, iterations)
    return Outcome(_UNSOLVED.get(raw, Status.FAILED), raw, iterations=iterations)


_UNSOLVED = {
    cp.INFEASIBLE: Status.INFEASIBLE,
    cp.INFEASIBLE_INACCURATE: Status.INFEASIBLE,
    cp.UNBOUNDED: Status.UNBOUNDED,
    cp.UNBOUNDED_INACCURATE: Status.UNBOUNDED,
    cp.USER_LIMIT: Status.STOPPED,
}


def _margin(problem: cp.Problem) -> float:
    """Return the smallest relative eigenvalue of the matrices that should be positive semidefinite."""
    matrices = [constraint.args[0].value for constraint in problem.constraints if isinstance(constraint, cp.PSD)]
    values = [np.linalg.eigvalsh((matrix + matrix.T) / 2) for matrix in matrices]
    return float(min((value[0] / max(np.abs(value).max(), 1e-300) for value in values), default=np.inf))


def _violation(problem: cp.Problem) -> float:
    """Return the largest entry by which an equation fails, relative to the largest entry of a variable (at least 1)."""
    size = max(1.0, *(float(np.abs(np.asarray(variable.value)).max()) for variable in problem.variables()))
    equations = [constraint for constraint in problem.constraints if not isinstance(constraint, cp.PSD)]
    return float(max((np.max(equation.violation()) for equation in equations), default=0.0)) / size
