"""The gain by nonlinear programming: agrees with the Riccati solution, whose code it does not use."""

import ast
import inspect

import numpy as np
import pytest

import derive.numeric.gain_nlp as module
from derive.numeric.gain_nlp import optimise_gain
from derive.numeric.lyapunov import error_covariance
from derive.numeric.modes import distance_to_stability
from derive.numeric.plant import Plant, example_plant
from derive.numeric.riccati import solve_riccati
from tests.derive.numeric.plants import NOTHING, STABILISING, STRONG, continuous, random_plant

TIMES = ["continuous", "discrete"]


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", range(1, 11))
def test_random_plants(time, n, capfd):
    plant = random_plant(time, n, seed=n)
    result, solution = optimise_gain(plant), solve_riccati(plant)
    assert result.status == "optimal"
    assert result.trace == pytest.approx(np.trace(solution.P), rel=1e-10)
    np.testing.assert_allclose(result.gain, solution.gain, rtol=0, atol=1e-6 * np.abs(solution.gain).max())
    assert distance_to_stability(np.linalg.eigvals(plant.A - result.gain @ plant.C), time).max() < 0
    P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, result.gain, time)
    np.testing.assert_allclose(result.P, P, rtol=1e-8, atol=1e-10 * result.trace)
    assert result.iterations > 0
    assert capfd.readouterr() == ("", "")


def test_the_example():
    plant = example_plant()
    assert optimise_gain(plant).trace == pytest.approx(np.trace(solve_riccati(plant).P), rel=1e-12)


@pytest.mark.parametrize(("plant", "P", "modes"), STRONG.values(), ids=STRONG)
def test_strong_solutions(plant, P, modes):
    result = optimise_gain(plant)
    assert result.status == "strong"
    np.testing.assert_allclose(result.P, P, atol=1e-12)


@pytest.mark.parametrize(("plant", "P"), STABILISING.values(), ids=STABILISING)
def test_stabilising_solutions(plant, P):
    result = optimise_gain(plant)
    assert result.status == "optimal"
    np.testing.assert_allclose(result.P, P, rtol=1e-12, atol=1e-300)


@pytest.mark.parametrize("time", TIMES)
def test_no_other_gain_is_better(time):
    plant = random_plant(time, 3, 2, seed=5)
    best = optimise_gain(plant)
    rng = np.random.default_rng(0)
    for size in (1e-4, 1e-2, 1e-1):
        gain = best.gain + size * rng.standard_normal(best.gain.shape)
        P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, gain, time)
        assert np.linalg.eigvalsh(P - best.P)[0] > -1e-9 * size


@pytest.mark.parametrize("time", TIMES)
def test_the_derivatives_are_those_of_the_cost(time):
    """Central differences of the cost give the gradient, of the gradient the second derivative, at a random point."""
    rng = np.random.default_rng(1)
    n, l = 3, 2  # noqa: E741
    F = 0.3 * rng.standard_normal((n, n)) - (0.8 * np.eye(n) if time == "continuous" else 0)
    S = module._symmetric_basis(n)
    solver = module._program(F, rng.standard_normal((l, n)), np.eye(n), S, time)
    X = np.eye(n) + 0.1 * np.ones((n, n))
    x = np.concatenate([S.T @ X.ravel(), 0.05 * rng.standard_normal(n * l)])
    gradient, hessian = solver.get_function("nlp_grad_f"), solver.get_function("nlp_hess_l")
    upper = np.array(hessian(x, [], 1, []))
    second = upper + np.triu(upper, 1).T
    for i, step in enumerate(1e-5 * np.eye(len(x))):
        (above, slope_above), (below, slope_below) = (map(np.array, gradient(x + s, [])) for s in (step, -step))
        slope = np.array(gradient(x, [])[1]).ravel()
        assert (above - below).item() / 2e-5 == pytest.approx(slope[i], rel=1e-7, abs=1e-8)
        np.testing.assert_allclose((slope_above - slope_below).ravel() / 2e-5, second[i], rtol=1e-6, atol=1e-6)


def test_no_riccati_code_is_used():
    names = {
        name
        for node in ast.walk(ast.parse(inspect.getsource(module)))
        if isinstance(node, ast.ImportFrom)
        for name in [node.module]
    }
    assert "derive.numeric.riccati" not in names
    assert "derive.numeric.flow" not in names


def test_a_plant_that_no_gain_stabilises_fails_without_a_crash():
    one = np.eye(1)
    hidden = Plant(time="continuous", A=one, C=0 * one, W=one, V=one, N=0 * one, M=one)
    assert optimise_gain(hidden).status == "failed"


@pytest.mark.parametrize("rate", [1e-6, 1e6])
def test_the_unit_of_time_does_not_matter(rate):
    """x' = r A x + w with W r and V/r is the same plant under another clock; without noise, P is singular besides."""
    for plant in (random_plant("continuous", 4, 2, seed=3), continuous(A=np.diag([1, -1]), C=[[1, 1]], W=NOTHING, V=1)):
        same = continuous(A=rate * plant.A, C=plant.C, W=rate * plant.W, V=plant.V / rate, N=plant.N)
        result = optimise_gain(same)
        assert result.status == "optimal"
        np.testing.assert_allclose(result.P, optimise_gain(plant).P, rtol=1e-9, atol=1e-11)


def test_units_do_not_matter():
    plant = random_plant("continuous", 4, 2, seed=3)
    T, inverse = np.diag([1e-6, 1.0, 1e3, 1e6]), np.diag([1e6, 1.0, 1e-3, 1e-6])
    W = T @ plant.W @ T
    scaled = continuous(A=T @ plant.A @ inverse, C=plant.C @ inverse, W=W, V=plant.V, N=T @ plant.N)
    np.testing.assert_allclose(optimise_gain(scaled).P, T @ optimise_gain(plant).P @ T, rtol=1e-10)
