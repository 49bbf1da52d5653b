"""The convex programs against the Riccati equation, closed forms, and each other."""

from dataclasses import replace

import numpy as np
import pytest

from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi import residual
from lmi.covariance import covariance_error, solve_covariance
from lmi.programs.h2 import h2
from lmi.programs.observer import factor
from lmi.programs.optimal_covariance import optimal_covariance, riccati_inequality
from lmi.programs.optimal_covariance_dual import optimal_covariance_dual
from lmi.residual import gain_covariance, newton_error, optimal_gain, riccati_residual
from lmi.scaling import balanced, recentred, scaled_plant
from lmi.solve import Status, solve_program

PROGRAMS = (optimal_covariance, optimal_covariance_dual, h2)
TIMES = ("continuous", "discrete")


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
