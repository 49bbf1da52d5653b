"""The reduced program: its derivatives, by hand and by CasADi, and stabilising gains by homotopy."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from derive.numeric.gain_lyapunov import Lyapunov
from derive.numeric.gain_reduced import ReducedCost, free_cost, solve_reduced, stabilised
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.normal import normal_form
from derive.numeric.stabilise import stabilising_gain
from tests.derive.numeric.plants import random_plant

TIMES = ["continuous", "discrete"]


def cost_of(plant, free):
    fixed = np.arange(plant.n * plant.l).reshape(plant.n, plant.l) / 100
    M = np.diag(np.arange(1.0, plant.n + 1))
    return ReducedCost(plant.A, plant.C, plant.W, plant.V, plant.N, M, plant.time, fixed, free)


@pytest.mark.parametrize("time", TIMES)
def test_the_lyapunov_function_and_its_derivative(time):
    rng = np.random.default_rng(0)
    F, Q, B = rng.standard_normal((3, 4, 4))
    F = F - 4 * np.eye(4) if time == "continuous" else F / 4
    Q, B = Q + Q.T, B + B.T
    lyapunov = Lyapunov(4, time)
    f, q = ca.MX.sym("F", 4, 4), ca.MX.sym("Q", 4, 4)
    value = ca.trace(ca.DM(B) @ lyapunov(f, q))
    found = ca.Function("found", [f, q], [value, ca.gradient(value, f), ca.gradient(value, q)])
    value, of_F, of_Q = map(np.array, found(F, Q))
    assert value.item() == pytest.approx(np.trace(B @ solve_lyapunov(F, Q, time)), rel=1e-13)
    for i in range(4):
        for j in range(4):
            E = np.zeros((4, 4))
            E[i, j] = 1e-6
            above, below = (np.trace(B @ solve_lyapunov(F + step, Q, time)) for step in (E, -E))
            assert of_F[i, j] == pytest.approx((above - below) / 2e-6, rel=1e-6, abs=1e-7)
            E = (E + E.T) / 2
            above, below = (np.trace(B @ solve_lyapunov(F, Q + step, time)) for step in (E, -E))
            assert (of_Q[i, j] + of_Q[j, i]) / 2 == pytest.approx((above - below) / 2e-6, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("time", TIMES)
def test_the_lyapunov_function_has_no_value_beyond_the_boundary(time):
    lyapunov = Lyapunov(2, time)
    assert np.isfinite(np.array(lyapunov(np.diag([-0.5, -0.1]), np.eye(2)))).all()
    for F in (np.diag([1.5, -0.5]), np.full((2, 2), np.nan)):
        assert np.isnan(np.array(lyapunov(F, np.eye(2)))).all()


@pytest.mark.parametrize("time", TIMES)
def test_the_gradient_is_that_of_the_cost(time):
    rng = np.random.default_rng(1)
    plant = random_plant(time, 4, 2, seed=1)
    free = rng.random((4, 2)) < 0.7
    cost = cost_of(plant, free)
    x = cost.entries(stabilising_gain(plant.A, plant.C, time))
    cost = replace(cost, fixed=stabilising_gain(plant.A, plant.C, time))
    assert cost.is_stable(x)
    symbol = ca.MX.sym("x", len(x))
    f, _kept = cost.expression(symbol)
    value, slope = ca.Function("f", [symbol], [f, ca.gradient(f, symbol)])(x)
    assert float(value) == pytest.approx(cost.value(x), rel=1e-12)
    np.testing.assert_allclose(np.array(slope).ravel(), cost.gradient(x), rtol=1e-8, atol=1e-9 * cost.value(x))
    for i, step in enumerate(1e-6 * np.eye(len(x))):
        difference = (cost.value(x + step) - cost.value(x - step)) / 2e-6
        assert difference == pytest.approx(cost.gradient(x)[i], rel=1e-5, abs=1e-6 * cost.value(x))


@pytest.mark.parametrize("time", TIMES)
def test_the_metric_is_the_second_derivative_at_the_optimum(time):
    plant = random_plant(time, 3, 2, seed=2, cross=False)
    F, C = plant.A, np.linalg.solve(np.linalg.cholesky(plant.V), plant.C)
    found = solve_reduced(F, C, plant.W, stabilising_gain(F, C, time), time)
    cost = free_cost(F, C, plant.W, time)
    x = cost.entries(found.gain)
    (metric,) = cost.metric(x)
    rows = [(cost.gradient(x + step) - cost.gradient(x - step)) / 2e-5 for step in 1e-5 * np.eye(len(x))]
    np.testing.assert_allclose(rows, metric, rtol=0, atol=1e-6 * np.abs(metric).max())


def test_fixed_entries_stay():
    plant = random_plant("continuous", 3, 2, seed=1)
    free = np.array([[1, 0], [0, 1], [1, 1]], bool)
    cost = cost_of(plant, free)
    gain = cost.gain(np.array([7.0, 8.0, 9.0, 10.0]))
    np.testing.assert_array_equal(gain[~free], cost.fixed[~free])
    np.testing.assert_array_equal(cost.entries(gain), [7.0, 8.0, 9.0, 10.0])


@pytest.mark.parametrize("time", TIMES)
def test_homotopy_finds_a_stabilising_gain(time):
    for seed in range(2):
        plant = random_plant(time, 4, 2, seed=seed)
        A = plant.A + np.eye(4) if time == "continuous" else 2 * plant.A
        cost = free_cost(A, plant.C, plant.W, time)
        zero = np.zeros(8)
        assert not cost.is_stable(zero)
        assert cost.is_stable(stabilised(cost, zero))


def test_many_unstable_modes_seen_by_one_output():
    """Moving them far is beyond double precision; moving them a little is not."""
    plant = random_plant("continuous", 24, 1, seed=1)
    F, C, _ = normal_form(plant).uncorrelated()
    assert np.linalg.eigvals(F).real.max() > 0.5
    assert np.linalg.eigvals(F - stabilising_gain(F, C, "continuous") @ C).real.max() < 0


def test_homotopy_says_when_it_finds_none():
    """Two unstable modes and one entry that moves one of them."""
    cost = ReducedCost(
        np.eye(2), np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2)), np.eye(2), "continuous", np.zeros((2, 2)),
        np.array([[True, False], [False, False]]),
    )  # fmt: skip
    assert np.isnan(stabilised(cost, np.zeros(1))).all()


def test_a_search_starts_by_homotopy_where_the_linear_equation_gives_no_gain(monkeypatch):
    from derive.numeric import gain_search
    from derive.numeric.gain_nlp import optimise_gain

    plant = random_plant("continuous", 4, 2, seed=1)
    expected = optimise_gain(plant)
    monkeypatch.setattr(gain_search, "stabilising_gain", lambda F, C, time: np.full((4, 2), np.nan))
    found = optimise_gain(plant)
    assert (found.status, found.trace) == ("optimal", pytest.approx(expected.trace, rel=1e-13))
    assert found.history[0] != expected.history[0]
