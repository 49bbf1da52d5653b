"""The convex programs against the Riccati equation, closed forms, and each other."""

from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.filter_form import filter_covariance, filter_gain
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi import covariance, residual
from lmi.covariance import covariance_error, solve_covariance
from lmi.programs.filter_form import filter_form, filter_plant
from lmi.programs.h2 import h2
from lmi.programs.information import information
from lmi.programs.observer import factor
from lmi.programs.optimal_covariance import optimal_covariance, riccati_inequality, riccati_map
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.programs.program import SymmetricMap, packed, unpacked
from lmi.residual import gain_covariance, newton_error, optimal_gain, riccati_residual
from lmi.scaling import balanced, recentred, scaled_plant
from lmi.solve import Status, solve_program

PROGRAMS = (optimal_covariance, optimal_covariance_dual, h2)
TIMES = ("continuous", "discrete")
EVERY = [(time, build) for time in TIMES for build in (*PROGRAMS, information)] + [("discrete", filter_form)]


def scalar_covariance(time, A, C, W, V):
    """Positive root of the scalar Riccati equation, written out by hand."""
    if time == "continuous":
        return (A + np.sqrt(A * A + C * C * W / V)) * V / C**2
    b = W * C * C + V * (A * A - 1)
    return (b + np.sqrt(b * b + 4 * C * C * W * V)) / (2 * C * C)


@pytest.mark.parametrize("build", PROGRAMS)
@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("A", [-0.7, 0.4, 1.5])
def test_scalar_plant_has_the_covariance_of_the_quadratic_formula(build, time, A):
    plant = plant_from_mapping({"time": time, "A": A, "C": 2.0, "W": 3.0, "V": 0.5})
    solution = solve_covariance(plant, build)
    expected = scalar_covariance(time, A, 2.0, 3.0, 0.5)
    assert solution.P is not None
    np.testing.assert_allclose(solution.P, [[expected]], rtol=1e-8)


@pytest.mark.parametrize("build", PROGRAMS)
@pytest.mark.parametrize("n", range(1, 11))
@pytest.mark.parametrize("time", TIMES)
def test_random_plant_has_the_covariance_and_gain_of_the_riccati_equation(build, time, n, random_plant):
    plant = random_plant(time, n)
    riccati = solve_riccati(plant)
    solution = solve_covariance(plant, build)
    assert solution.outcome.status is Status.SOLVED
    assert np.linalg.norm(solution.P - riccati.P) < 1e-7 * np.linalg.norm(riccati.P)
    assert np.linalg.norm(solution.gain - riccati.gain) < 1e-4 * np.linalg.norm(riccati.gain)


@pytest.mark.parametrize("time", TIMES)
def test_riccati_inequality_is_singular_with_rank_l_at_the_optimum(time, random_plant):
    plant = random_plant(time, 6)
    matrix = riccati_inequality(plant, solve_riccati(plant).P)
    sizes = np.linalg.eigvalsh(matrix)
    assert np.abs(sizes[: plant.n]).max() < 1e-12 * sizes[-1]
    assert sizes[plant.n] > 1e-3 * sizes[-1]


@pytest.mark.parametrize("time", TIMES)
def test_a_feasible_covariance_is_below_and_that_of_any_gain_above(time, random_plant):
    plant = random_plant(time, 4)
    optimum = solve_riccati(plant)
    lower = 0.5 * optimum.P
    rng = np.random.default_rng(0)
    upper = gain_covariance(plant, optimum.gain + 1e-2 * rng.standard_normal(optimum.gain.shape))
    assert np.linalg.eigvalsh(optimum.P - lower)[0] > 0
    assert upper is not None
    assert np.linalg.eigvalsh(upper - optimum.P)[0] > 0


@pytest.mark.parametrize("build", PROGRAMS)
@pytest.mark.parametrize("time", TIMES)
def test_program_without_scaling_has_the_gain_of_the_riccati_equation(build, time, random_plant):
    plant = random_plant(time, 3)
    program = build(plant)
    assert solve_program(program).status is Status.SOLVED
    P, gain = program.answer()
    riccati = solve_riccati(plant)
    assert np.linalg.norm(P - riccati.P) < 1e-6 * np.linalg.norm(riccati.P)
    assert np.linalg.norm(gain - riccati.gain) < 1e-3 * np.linalg.norm(riccati.gain)


@pytest.mark.parametrize("build", PROGRAMS)
@pytest.mark.parametrize("time", TIMES)
def test_hardly_observed_unstable_states_have_their_large_covariance(build, time):
    A = np.array([[0.6, 1.0, 0.0], [0.0, 0.3, 1.0], [0.0, 0.0, -0.3]]) + (np.eye(3) if time == "discrete" else 0.0)
    plant = plant_from_mapping({"time": time, "A": A, "C": [[1e-3, 1, 1]], "W": np.eye(3), "V": 1.0})
    P = solve_riccati(plant).P
    assert np.linalg.cond(P) > 1e4
    solution = solve_covariance(plant, build)
    assert np.linalg.norm(solution.P - P) < 1e-8 * np.linalg.norm(P)


@pytest.mark.parametrize("rate", [1e-15, 1.0, 1e12])
@pytest.mark.parametrize("build", PROGRAMS)
@pytest.mark.parametrize("time", TIMES)
def test_units_change_nothing_but_the_units(build, time, rate, random_plant):
    plant = random_plant(time, 4)
    states, outputs = 2.0 ** np.array([20.0, -13.0, 7.0, 0.0]), np.array([1e-5, 3e4])
    rate = rate if time == "continuous" else 1.0
    other = replace(
        plant,
        A=rate * states[:, None] * plant.A / states,
        C=outputs[:, None] * plant.C / states,
        W=rate * np.outer(states, states) * plant.W,
        V=np.outer(outputs, outputs) * plant.V / rate,
        N=np.outer(states, outputs) * plant.N,
    )
    before, after = solve_covariance(plant, build), solve_covariance(other, build)
    assert before.P is not None
    assert after.P is not None
    np.testing.assert_allclose(after.P / np.outer(states, states), before.P, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("time", TIMES)
def test_undetectable_plant_is_unbounded_above_and_has_no_h2_gain(time, random_plant):
    plant = replace(random_plant(time, 2), A=np.diag([1.5, 0.2]), C=np.array([[0.0, 1.0]]))
    assert solve_program(optimal_covariance(plant)).status is Status.UNBOUNDED
    assert solve_program(optimal_covariance_dual(plant)).status is Status.INFEASIBLE
    assert solve_program(h2(plant)).status is not Status.SOLVED
    for build in PROGRAMS:
        solution = solve_covariance(plant, build)
        assert solution.outcome.status is not Status.SOLVED or solution.error is None


def test_weight_may_be_singular():
    plant = example_plant()
    weighted = replace(plant, M=np.diag([1.0, 0.0, 0.0, 0.0]))
    for build in PROGRAMS:
        solution = solve_covariance(weighted, build)
        np.testing.assert_allclose(solution.P, solve_riccati(plant).P, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("time", TIMES)
def test_perturbed_covariance_is_flagged_by_its_residuals(time, random_plant):
    plant = random_plant(time, 5)
    P = solve_riccati(plant).P
    rng = np.random.default_rng(1)
    D = rng.standard_normal(P.shape)
    D = 1e-4 * np.linalg.norm(P) * (D + D.T) / np.linalg.norm(D + D.T)
    assert riccati_residual(plant, P) < 1e-13
    assert riccati_residual(plant, P + D) > 1e-6
    error = covariance_error(plant, P + D)
    assert error is not None
    np.testing.assert_allclose(error, -D, atol=1e-2 * np.linalg.norm(D))


def test_newton_steps_that_hardly_shrink_confirm_nothing(random_plant, monkeypatch):
    P = np.eye(3)
    for ratio, missing in ((0.5, 2.0), (0.9, 10.0), (0.99, None)):
        steps = iter((2 * P, (2 + ratio) * P))
        monkeypatch.setattr(residual, "gain_covariance", lambda plant, L, steps=steps: next(steps))
        error = newton_error(random_plant("continuous", 3), P)
        assert error is None if missing is None else np.allclose(error, missing * P)


def test_covariance_with_an_unstable_gain_has_no_error_estimate():
    plant = plant_from_mapping({"time": "continuous", "A": 1.0, "C": 1.0, "W": 0.0, "V": 1.0})
    assert riccati_residual(plant, np.zeros((1, 1))) == 0.0
    assert newton_error(plant, np.zeros((1, 1))) is None
    assert newton_error(plant, np.full((1, 1), 2.0)) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("time", TIMES)
def test_error_estimate_sees_slow_convergence_at_a_boundary_mode(time):
    plant = plant_from_mapping({"time": time, "A": 1.0 if time == "discrete" else 0.0, "C": 1.0, "W": 0.0, "V": 1.0})
    P = np.full((1, 1), 1e-4)
    assert newton_error(plant, P) == pytest.approx(-1e-4, rel=1e-3)


@pytest.mark.parametrize("time", TIMES)
def test_gain_covariance_solves_its_equation_and_refuses_unstable_gains(time, random_plant):
    plant = random_plant(time, 6)
    L = 1.01 * solve_riccati(plant).gain
    P = gain_covariance(plant, L)
    assert P is not None
    F = plant.A - L @ plant.C
    noise = plant.W - L @ plant.N.T - plant.N @ L.T + L @ plant.V @ L.T
    left = F @ P + P @ F.T + noise if time == "continuous" else F @ P @ F.T + noise - P
    assert np.abs(left).max() < 1e-12 * np.abs(P).max() * max(1.0, np.abs(F).max())
    unstable = replace(plant, A=2.0 * np.eye(6), C=np.zeros_like(plant.C))
    assert gain_covariance(unstable, L) is None


@pytest.mark.parametrize("time", TIMES)
def test_scaled_coordinates_are_the_same_problem(time, random_plant):
    plant = random_plant(time, 4)
    scaling = balanced(plant)
    assert np.all(np.log2(np.diag(scaling.T)) % 1 == 0)
    for coordinates in (scaling, recentred(plant, scaling, np.diag([4.0, 1.0, 1e-3, 1e-20]), 1e-6)):
        scaled = scaled_plant(plant, coordinates)
        solution = solve_riccati(scaled)
        P = coordinates.covariance(solution.P)
        assert riccati_residual(plant, P) < 1e-9
        np.testing.assert_allclose(coordinates.gain(solution.gain), optimal_gain(plant, P), rtol=1e-7, atol=1e-9)
        innovation = scaled.V if time == "continuous" else scaled.V + scaled.C @ scaled.C.T
        assert np.linalg.cond(innovation) < 1e3


def test_factor_has_the_rank_of_the_covariance():
    G = np.array([[1.0], [2.0]])
    assert factor(G @ G.T).shape == (2, 1)
    np.testing.assert_allclose(factor(G @ G.T) @ factor(G @ G.T).T, G @ G.T, atol=1e-15)
    np.testing.assert_array_equal(factor(np.zeros((2, 2))), np.zeros((2, 1)))


@pytest.mark.parametrize("n", [1, 2, 5, 8])
@pytest.mark.parametrize("time", TIMES)
def test_information_is_the_inverse_of_the_covariance(time, n, random_plant):
    plant = random_plant(time, n)
    riccati, solution = solve_riccati(plant), solve_covariance(plant, information)
    assert solution.outcome.status is Status.SOLVED
    assert np.linalg.norm(solution.P - riccati.P) < 1e-7 * np.linalg.norm(riccati.P)
    assert np.linalg.norm(solution.gain - riccati.gain) < 1e-6 * np.linalg.norm(riccati.gain)


@pytest.mark.filterwarnings("ignore:Reading from a sparse CVXPY expression")
@pytest.mark.parametrize("time", TIMES)
def test_covariances_of_gains_are_feasible_in_information_form_and_smaller_ones_are_not(time, random_plant):
    """By brute force: the inequality at P_L^-1 for random stabilising gains, and just outside of it."""
    plant = random_plant(time, 4)
    program, optimum = information(plant), solve_riccati(plant)
    rng = np.random.default_rng(0)
    (x,) = program.problem.variables()
    inequality = program.problem.constraints[0].args[0]

    def least(P):
        x.value = packed(np.linalg.inv(P))
        return np.linalg.eigvalsh(inequality.value)[0]

    for _ in range(10):
        upper = gain_covariance(plant, optimum.gain + 0.05 * rng.standard_normal(optimum.gain.shape))
        assert upper is not None
        assert least(upper) > -1e-12
    assert least(0.99 * optimum.P) < -1e-4


@pytest.mark.parametrize("time", TIMES)
def test_information_without_bound_where_the_covariance_is_singular(time):
    A = [[0.5, 0.0], [0.0, 2.0]] if time == "discrete" else [[-0.5, 0.0], [0.0, 2.0]]
    plant = plant_from_mapping({"time": time, "A": A, "C": [[1.0, 1.0]], "W": np.zeros((2, 2)), "V": 1.0})
    solution = solve_covariance(plant, information)
    assert solution.outcome.status is Status.UNBOUNDED
    assert solution.P is None


@pytest.mark.parametrize("n", [1, 2, 5, 8])
def test_filter_form_is_the_covariance_after_the_measurement(n, random_plant):
    plant = random_plant("discrete", n)
    riccati, solution = solve_riccati(plant), solve_covariance(plant, filter_form)
    assert solution.outcome.status is Status.SOLVED
    assert np.linalg.norm(solution.P - riccati.P) < 1e-7 * np.linalg.norm(riccati.P)
    assert np.linalg.norm(solution.gain - riccati.gain) < 1e-6 * np.linalg.norm(riccati.gain)
    program = filter_form(plant)
    assert solve_program(program).status is Status.SOLVED
    (x,) = program.problem.variables()
    filtered = filter_covariance(plant, riccati.P)
    assert np.linalg.norm(unpacked(x.value, n) - filtered) < 1e-5 * np.linalg.norm(filtered)


def test_predictor_of_the_filter_plant_is_the_filter(random_plant):
    plant = random_plant("discrete", 5)
    P, other = solve_riccati(plant).P, solve_riccati(filter_plant(plant))
    np.testing.assert_allclose(other.P, filter_covariance(plant, P), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(other.gain, filter_gain(plant, P), rtol=1e-9, atol=1e-11)


def test_filter_covariance_is_where_its_recursion_ends(random_plant):
    """Predict and correct, step by step, from a covariance far away."""
    plant = random_plant("discrete", 3)
    P = 50.0 * np.eye(3)
    for _ in range(300):
        innovation = plant.C @ P @ plant.C.T + plant.V
        cross = plant.A @ P @ plant.C.T + plant.N
        filtered = P - P @ plant.C.T @ np.linalg.inv(innovation) @ plant.C @ P
        P = plant.A @ P @ plant.A.T + plant.W - cross @ np.linalg.inv(innovation) @ cross.T
    np.testing.assert_allclose(solve_riccati(filter_plant(plant)).P, filtered, rtol=1e-9, atol=1e-11)


def test_filter_form_of_a_continuous_plant_is_refused():
    with pytest.raises(InputError, match='time: expected "discrete"'):
        filter_form(example_plant())


def compiled_form(program):
    """What CVXPY compiles the problem to, which it keeps as long as it is valid."""
    return program.problem.get_problem_data(cp.CLARABEL)[0]["param_prob"]


@pytest.mark.filterwarnings("ignore:Reading from a sparse CVXPY expression")
@pytest.mark.parametrize(("time", "build"), EVERY)
def test_program_takes_new_data_without_compiling_and_answers_as_a_fresh_one(time, build, random_plant):
    first, second = (random_plant(time, 4, seed) for seed in (0, 1))
    program, fresh = build(first), build(second)
    assert program.problem.is_dcp(dpp=True)
    solve_program(program)
    compiled = compiled_form(program)
    assert program.load(second)
    again, anew = solve_program(program), solve_program(fresh)
    assert compiled_form(program) is compiled
    assert again.status is anew.status is Status.SOLVED
    for ours, theirs in zip(program.answer(), fresh.answer(), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("time", "build"), EVERY)
def test_program_does_not_load_a_plant_of_another_shape(time, build, random_plant):
    plant = random_plant(time, 4)
    program = build(plant)
    other = "continuous" if time == "discrete" else "discrete"
    assert not program.load(random_plant(time, 5))
    assert not program.load(random_plant(other, 4))
    solve_program(program)
    P, known = program.answer()[0], solve_riccati(plant).P
    assert np.linalg.norm(P - known) < 1e-5 * np.linalg.norm(known)


@pytest.mark.parametrize("build", [h2, information])
def test_program_does_not_load_noise_of_another_rank(build, random_plant):
    plant = random_plant("continuous", 4)
    program = build(plant)
    assert not program.load(replace(plant, W=np.diag([1.0, 0, 0, 0]), N=np.zeros_like(plant.N)))


@pytest.mark.parametrize("time", TIMES)
def test_coefficients_are_the_map_and_its_adjoint(time, random_plant):
    plant = random_plant(time, 4)
    linear = SymmetricMap(plant, riccati_map, "F")
    linear.load(plant)
    K = linear.coefficients.value_sparse.toarray()
    rng = np.random.default_rng(0)
    P, Z = (X + X.T for X in (rng.standard_normal((4, 4)), rng.standard_normal((6, 6))))
    image = riccati_map(plant, P)
    np.testing.assert_allclose((K @ packed(P)).reshape(6, 6), image, atol=1e-13)
    np.testing.assert_allclose(packed(P) @ (K.T @ Z.ravel()), np.trace(Z @ image), atol=1e-12)


@pytest.mark.parametrize(("share", "said"), [(0.1, True), (2.0, False)])
def test_an_answer_that_lacks_more_than_itself_has_no_error_estimate(share, said, monkeypatch):
    """Far from a solution Newton steps say nothing about its distance."""
    monkeypatch.setattr(covariance, "newton_error", lambda plant, P: -share * P)
    assert (solve_covariance(example_plant(), optimal_covariance).error is not None) is said
