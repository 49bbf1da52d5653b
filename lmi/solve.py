"""The one place that calls a conic solver, and that judges what it returns.

A solver's "optimal" is a claim. Every answer is judged by what can be recomputed from the numbers returned: the
eigenvalues of the matrices that should be positive semidefinite, the equations that should hold, and the gap between
the primal and the dual value.
"""

import os
import shutil
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from tempfile import TemporaryFile
from typing import Any

import cvxpy as cp
import numpy as np

from lmi.optimality import Optimality, optimality
from lmi.programs.program import Program

__all__ = ["FALLBACKS", "TO_THE_LAST_DIGIT", "Accuracy", "Outcome", "Status", "solve_program"]

FEASIBLE = 1e-6
"""A condition of optimality holds when it fails by less than this, relative to its size."""

FALLBACKS = ("CVXOPT", "SCS")
"""Solvers to try, in this order and where they are installed, when Clarabel's answer is not good enough. CVXOPT is an
interior-point method as well, which breaks off on badly scaled programs; SCS is of first order and only ever rough."""

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
    ROUGH = "inaccurate: the solver is of first order, its numbers are only rough"
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
        status: SOLVED only when the numbers satisfy every condition of optimality to `FEASIBLE`.
        raw_status: the solver's own word.
        optimality: the conditions of optimality recomputed, or None when there are no numbers.
        iterations: of the solver.
        solver: its name.
    """

    status: Status
    raw_status: str
    optimality: Optimality | None = None
    iterations: int = 0
    solver: str = cp.CLARABEL


def solve_program(program: Program, accuracy: Accuracy = TO_THE_LAST_DIGIT, solver: str = cp.CLARABEL) -> Outcome:
    """Call the solver once and judge the numbers that it leaves in the program's variables.

    Clarabel's chordal decomposition is off: the programs are dense, and it would only add a transformation to trust.
    CVXPY's warnings are kept from the user; the outcome says what they would. A warm start would keep the scaling that
    suited the data before.

    Args:
        program: its parameters set.
        accuracy: what is asked of the solver, where it can be asked.
        solver: CLARABEL, or one of `FALLBACKS`.
    """
    problem = program.problem
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with _panics_as_errors():
                problem.solve(solver=solver, warm_start=False, **_OPTIONS[solver](accuracy))
        except cp.SolverError as error:
            return Outcome(Status.FAILED, str(error).split(".")[0], solver=solver)
        except _BREAKDOWNS as error:
            if solver == cp.CLARABEL:
                raise
            return Outcome(Status.FAILED, f"{type(error).__name__}: {error}", solver=solver)
        return _judged(problem, solver)


_BREAKDOWNS = (ArithmeticError, RuntimeError, TypeError, ValueError)
"""What CVXOPT and its preparation in CVXPY raise when their numbers run out."""

_OPTIONS: dict[str, Callable[[Accuracy], dict[str, Any]]] = {
    "CLARABEL": lambda accuracy: {
        "tol_gap_abs": accuracy.tolerance,
        "tol_gap_rel": accuracy.tolerance,
        "tol_feas": accuracy.tolerance,
        "static_regularization_constant": accuracy.regularisation,
        "max_iter": 200,
        "time_limit": TIME_LIMIT,
        "chordal_decomposition_enable": False,
    },
    "CVXOPT": lambda accuracy: {
        "abstol": max(accuracy.tolerance, 1e-10),
        "reltol": max(accuracy.tolerance, 1e-10),
        "feastol": max(accuracy.tolerance, 1e-10),
        "max_iters": 100,
    },
    "SCS": lambda accuracy: {
        "eps_abs": max(accuracy.tolerance, 1e-7),
        "eps_rel": max(accuracy.tolerance, 1e-7),
        "max_iters": 20_000,
        "time_limit_secs": TIME_LIMIT / 10,
    },
}


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


def _judged(problem: cp.Problem, solver: str) -> Outcome:
    raw = str(problem.status)
    stats = problem.solver_stats
    iterations = int(stats.num_iters or 0) if stats is not None else 0
    if raw not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
        return Outcome(_UNSOLVED.get(raw, Status.FAILED), raw, None, iterations, solver)
    if not all(np.isfinite(number).all() for number in _numbers(problem)):
        return Outcome(Status.FAILED, raw, None, iterations, solver)
    found = optimality(problem)
    status = Status.SOLVED if found.holds(FEASIBLE) else Status.INACCURATE
    if solver == cp.SCS and status is Status.SOLVED:
        status = Status.ROUGH
    return Outcome(status, raw, found, iterations, solver)


def _numbers(problem: cp.Problem) -> Iterator[np.ndarray[Any, Any]]:
    """Iterate over what the solver returned: variables and multipliers."""
    for variable in problem.variables():
        yield np.asarray(variable.value, dtype=float)
    for constraint in problem.constraints:
        yield np.asarray(constraint.dual_value, dtype=float)


_UNSOLVED = {
    cp.INFEASIBLE: Status.INFEASIBLE,
    cp.INFEASIBLE_INACCURATE: Status.INFEASIBLE,
    cp.UNBOUNDED: Status.UNBOUNDED,
    cp.UNBOUNDED_INACCURATE: Status.UNBOUNDED,
    cp.USER_LIMIT: Status.STOPPED,
}
