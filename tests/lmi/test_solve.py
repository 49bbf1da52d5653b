"""A solver's answer is judged by its numbers, not by its word."""

import os
import warnings

import cvxpy as cp
import numpy as np
import pytest
from scipy.sparse.linalg import ArpackNoConvergence

from derive.numeric.plant import example_plant, plant_from_mapping
from lmi import covariance
from lmi.covariance import solve_covariance
from lmi.optimality import optimality
from lmi.programs.h2 import h2
from lmi.programs.optimal_covariance import optimal_covariance
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.programs.program import Program
from lmi.solve import Accuracy, Status, solve_program
from lmi.validation import validate

PROGRAMS = (optimal_covariance, optimal_covariance_dual, h2)


@pytest.fixture
def lying_solver(monkeypatch):
    """Replaces the solver by one that enlarges its answer and still says optimal."""
    honest = cp.Problem.solve

    def solve(self, *args, **kwargs):
        value = honest(self, *args, **kwargs)
        for variable in self.variables():
            variable.save_value(1.001 * variable.value)
        for constraint in self.constraints:
            for dual in constraint.dual_variables:
                dual.save_value(1.001 * np.asarray(dual.value))
        return value

    monkeypatch.setattr(cp.Problem, "solve", solve)


@pytest.mark.parametrize("build", PROGRAMS)
def test_honest_answer_is_solved(build):
    outcome = solve_program(build(example_plant()))
    assert outcome.status is Status.SOLVED
    assert outcome.optimality is not None
    assert outcome.optimality.holds(1e-8)
    assert outcome.optimality.gap < 1e-9
    assert outcome.iterations > 0


@pytest.mark.usefixtures("lying_solver")
@pytest.mark.parametrize("build", [optimal_covariance, optimal_covariance_dual])
def test_answer_that_breaks_its_constraints_is_inaccurate_though_optimal(build):
    outcome = solve_program(build(example_plant()))
    assert outcome.raw_status in ("optimal", "optimal_inaccurate")
    assert outcome.status is Status.INACCURATE


@pytest.mark.usefixtures("lying_solver")
@pytest.mark.parametrize("build", PROGRAMS)
def test_false_answer_is_seen_by_its_newton_error(build):
    solution = solve_covariance(example_plant(), build)
    assert solution.error is None or np.linalg.norm(solution.error) > 1e-4 * np.linalg.norm(solution.P)


def test_infeasible_and_unbounded_are_told_apart():
    X = cp.Variable((2, 2), symmetric=True)
    infeasible = cp.Problem(cp.Minimize(cp.trace(X)), [X >> 0, cp.trace(X) == -1])
    assert solve_program(Program("infeasible", infeasible, lambda: NotImplemented)).status is Status.INFEASIBLE
    unbounded = cp.Problem(cp.Maximize(cp.trace(X)), [X >> 0])
    assert solve_program(Program("unbounded", unbounded, lambda: NotImplemented)).status is Status.UNBOUNDED


def test_solver_that_gives_up_is_a_status_not_an_exception(monkeypatch):
    def solve(self, *args, **kwargs):
        raise cp.SolverError("Solver 'CLARABEL' failed.\nTry another.")

    monkeypatch.setattr(cp.Problem, "solve", solve)
    solution = solve_covariance(example_plant(), h2)
    assert solution.outcome.status is Status.FAILED
    assert solution.outcome.raw_status == "Solver 'CLARABEL' failed"
    assert solution.P is None
    assert [solver for solver, _ in solution.tried[:3]] == ["CLARABEL"] * 3
    assert {status for _, status in solution.tried} == {Status.FAILED}


def test_numbers_that_are_not_finite_are_a_failure(monkeypatch):
    honest = cp.Problem.solve

    def solve(self, *args, **kwargs):
        honest(self, *args, **kwargs)
        for variable in self.variables():
            variable.save_value(np.full(variable.shape, np.nan))

    monkeypatch.setattr(cp.Problem, "solve", solve)
    assert solve_program(optimal_covariance(example_plant())).status is Status.FAILED


def test_warnings_of_the_modelling_layer_do_not_reach_the_user():
    plant = plant_from_mapping({"time": "continuous", "A": [[0, 1], [0, 0]], "C": [[1, 0]], "W": 0 * np.eye(2), "V": 1})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for build in PROGRAMS:
            solve_program(build(plant), Accuracy(1e-15, 1e-8))
    assert caught == []


class PanicException(BaseException):
    """As raised by a panic of compiled code: no Exception, and its report is printed by the process."""


def test_a_panic_of_the_solver_is_a_failure_and_prints_nothing(monkeypatch, capfd):
    def solve(self, *args, **kwargs):
        os.write(2, b"thread panicked\n")
        raise PanicException("Eigval error")

    monkeypatch.setattr(cp.Problem, "solve", solve)
    outcome = solve_program(h2(example_plant()))
    assert (outcome.status, outcome.raw_status) == (Status.FAILED, "panic: Eigval error")
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("error", [None, KeyboardInterrupt()])
def test_what_else_is_written_meanwhile_is_passed_on(error, monkeypatch, capfd):
    honest = cp.Problem.solve

    def solve(self, *args, **kwargs):
        os.write(2, b"progress\n")
        if error is not None:
            raise error
        return honest(self, *args, **kwargs)

    monkeypatch.setattr(cp.Problem, "solve", solve)
    if error is None:
        assert solve_program(h2(example_plant())).status is Status.SOLVED
    else:
        with pytest.raises(KeyboardInterrupt):
            solve_program(h2(example_plant()))
    assert capfd.readouterr().err == "progress\n"


def scaled_multipliers(problem, factor):
    for constraint in problem.constraints:
        for dual in constraint.dual_variables:
            dual.save_value(factor * np.asarray(dual.value))


@pytest.mark.filterwarnings("ignore:Reading from a sparse CVXPY expression")
@pytest.mark.parametrize("build", PROGRAMS)
def test_gap_and_stationarity_are_of_the_returned_numbers(build):
    program = build(example_plant())
    solve_program(program)
    assert optimality(program.problem).holds(1e-8)
    scaled_multipliers(program.problem, 1.01)
    found = optimality(program.problem)
    assert found.stationarity > 1e-4
    assert found.gap > 1e-4


def test_gap_bounds_what_is_missing_to_the_optimum():
    """min x + 2 y, x >= 1, y = 3, and a maximisation: by hand, away from the optimum."""
    x, y = cp.Variable((1, 1), symmetric=True), cp.Variable()
    problem = cp.Problem(cp.Minimize(x[0, 0] + 2 * y), [x - 1 >> 0, y == 3])
    assert solve_program(Program("by hand", problem, lambda: NotImplemented)).status is Status.SOLVED
    assert optimality(problem).gap < 1e-8
    x.save_value(np.array([[2.0]]))
    assert optimality(problem).gap == pytest.approx(1 / 9, rel=1e-6)
    X = cp.Variable((2, 2), symmetric=True)
    most = cp.Problem(cp.Maximize(X[0, 1]), [X >> 0, cp.trace(X) == 2])
    assert solve_program(Program("most", most, lambda: NotImplemented)).status is Status.SOLVED
    assert optimality(most).stationarity < 1e-8
    X.save_value(np.eye(2))
    assert optimality(most).gap == pytest.approx(1.0, rel=1e-6)


@pytest.fixture
def broken_clarabel(monkeypatch):
    """Clarabel returns no numbers; the other solvers work."""
    honest = cp.Problem.solve

    def solve(self, *args, **kwargs):
        if kwargs["solver"] == "CLARABEL":
            raise cp.SolverError("Solver 'CLARABEL' failed.")
        return honest(self, *args, **kwargs)

    monkeypatch.setattr(cp.Problem, "solve", solve)


@pytest.mark.usefixtures("broken_clarabel")
@pytest.mark.skipif("CVXOPT" not in cp.installed_solvers(), reason="CVXOPT is not installed")
def test_cvxopt_takes_over_and_is_named():
    solution = solve_covariance(example_plant(), optimal_covariance)
    assert [solver for solver, _ in solution.tried] == ["CLARABEL"] * 3 + ["CVXOPT"]
    assert solution.status == "solved: by CVXOPT, as CLARABEL did not reach 1e-07"
    assert np.linalg.norm(solution.error) < 1e-7 * np.linalg.norm(solution.P)


@pytest.mark.usefixtures("broken_clarabel")
def test_scs_is_rough_and_never_trusted(monkeypatch):
    monkeypatch.setattr(covariance, "FALLBACKS", ("SCS",))
    solution = solve_covariance(example_plant(), optimal_covariance)
    assert solution.outcome.status in (Status.ROUGH, Status.INACCURATE)
    assert solution.status.startswith("inaccurate: ")
    assert "by SCS" in solution.status
    row = validate(example_plant()).route("lmi-primal")
    assert "SCS" in row.status
    assert not row.trusted
    assert not row.agrees


@pytest.mark.parametrize("error", [ZeroDivisionError("by zero"), ArpackNoConvergence("none", [], [])], ids=type)
def test_a_breakdown_of_cvxopt_is_a_failure(error, monkeypatch):
    def solve(self, *args, **kwargs):
        raise error

    monkeypatch.setattr(cp.Problem, "solve", solve)
    outcome = solve_program(h2(example_plant()), solver="CVXOPT")
    assert (outcome.status, outcome.raw_status) == (Status.FAILED, f"{type(error).__name__}: {error}")
    with pytest.raises(type(error)):
        solve_program(h2(example_plant()))


def test_coordinates_without_a_rough_covariance_come_from_the_cheapest_program(monkeypatch):
    monkeypatch.setattr(covariance, "rough_covariance", lambda plant: None)
    solution = solve_covariance(example_plant(), optimal_covariance_dual)
    assert solution.status == "solved"
    assert np.linalg.norm(solution.error) < 1e-9 * np.linalg.norm(solution.P)
