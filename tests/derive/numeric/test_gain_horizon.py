"""Gains over a finite horizon: equal to those of the difference Riccati equation."""

import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.gain_horizon import HorizonCost, covariance_recursion, optimise_horizon
from derive.numeric.plant import plant_from_mapping
from derive.numeric.riccati import solve_riccati
from tests.derive.numeric.plants import discrete, random_plant


def difference_riccati(plant, steps, P):
    """Return gains and covariances of P_{k+1} = A P_k A' + Q - L_k (C P_k C' + R) L_k'."""
    gains, found = [], [P]
    for _ in range(steps):
        cross = plant.A @ P @ plant.C.T + plant.N
        L = np.linalg.solve(plant.C @ P @ plant.C.T + plant.V, cross.T).T
        P = plant.A @ P @ plant.A.T + plant.W - L @ cross.T
        gains.append(L)
        found.append(P)
    return np.array(gains), np.array(found)


@pytest.mark.parametrize("start", [0.0, 10.0])
@pytest.mark.parametrize(("n", "l", "steps"), [(1, 1, 1), (2, 1, 20), (4, 2, 12), (3, 3, 5)])
def test_the_difference_riccati_equation(n, l, steps, start):  # noqa: E741
    plant = random_plant("discrete", n, l, seed=1)
    found = optimise_horizon(plant, steps, start * np.eye(n))
    gains, P = difference_riccati(plant, steps, start * np.eye(n))
    assert found.status == "optimal"
    np.testing.assert_allclose(found.P, P, rtol=0, atol=1e-11 * np.abs(P).max())
    np.testing.assert_allclose(found.gains, gains, rtol=0, atol=1e-6 * np.abs(gains).max())
    assert found.history[-1] <= found.history[0]
    assert len(found.history) == found.iterations + 1


def test_a_long_horizon_ends_in_the_steady_state():
    plant = random_plant("discrete", 2, 1, seed=4)
    found = optimise_horizon(plant, 40, np.zeros((2, 2)))
    np.testing.assert_allclose(found.P[-1], solve_riccati(plant).P, rtol=1e-9)


def test_no_other_gains_are_better():
    plant = random_plant("discrete", 3, 1, seed=2)
    found = optimise_horizon(plant, 6, np.eye(3))
    rng = np.random.default_rng(0)
    for size in (1e-3, 1e-1):
        others = found.gains + size * rng.standard_normal(found.gains.shape)
        for P, other in zip(found.P, covariance_recursion(plant, others, np.eye(3)), strict=True):
            assert np.linalg.eigvalsh(other - P)[0] > -1e-12


def test_modes_on_the_boundary_that_the_noise_does_not_excite():
    plant = discrete(A=[[1.0, 1.0], [0.0, 1.0]], C=[[1.0, 0.0]], Q=np.zeros((2, 2)), R=1.0)
    found = optimise_horizon(plant, 8, np.diag([1.0, 4.0]))
    _, P = difference_riccati(plant, 8, np.diag([1.0, 4.0]))
    np.testing.assert_allclose(found.P, P, rtol=0, atol=1e-11)


def test_the_start_is_that_of_the_plant_unless_given():
    data = {"time": "discrete", "A": [[0.5]], "C": [[1.0]], "Q": [[1.0]], "R": [[1.0]]}
    with pytest.raises(InputError, match=r"^P0: expected the covariance at the start, got none"):
        optimise_horizon(plant_from_mapping(data), 2)
    plant = plant_from_mapping({**data, "P0": [[3.0]]})
    assert optimise_horizon(plant, 2).P[0] == [[3.0]]
    assert optimise_horizon(plant, 2, np.array([[1.0]])).P[0] == [[1.0]]


@pytest.mark.parametrize(
    ("time", "steps", "P0", "message"),
    [
        ("continuous", 2, np.eye(2), '^time: expected "discrete"'),
        ("discrete", 0, np.eye(2), "^steps: expected at least 1, got 0"),
        ("discrete", 2, np.eye(3), r"^P0: expected shape \(2, 2\), got \(3, 3\)"),
        ("discrete", 2, -np.eye(2), "^P0: not positive semidefinite"),
    ],
)
def test_bad_input(time, steps, P0, message):
    with pytest.raises(InputError, match=message):
        optimise_horizon(random_plant(time, 2, 1), steps, P0)


def test_the_gradient_and_the_metric_are_those_of_the_cost():
    import casadi as ca

    rng = np.random.default_rng(0)
    n, l, steps = 3, 2, 4  # noqa: E741
    G = rng.standard_normal((n, n))
    cost = HorizonCost(G, rng.standard_normal((l, n)), np.eye(n), G @ G.T, steps)
    x = rng.standard_normal(n * l * steps)
    symbol = ca.MX.sym("x", len(x))
    f, _ = cost.expression(symbol)
    value, slope = ca.Function("f", [symbol], [f, ca.gradient(f, symbol)])(x)
    assert float(value) == pytest.approx(cost.value(x), rel=1e-12)
    np.testing.assert_allclose(np.array(slope).ravel(), cost.gradient(x), rtol=1e-9, atol=1e-9)
    for i, step in enumerate(1e-5 * np.eye(len(x))):
        difference = (cost.value(x + step) - cost.value(x - step)) / 2e-5
        assert difference == pytest.approx(cost.gradient(x)[i], rel=1e-6, abs=1e-4)


def test_the_second_derivative_at_the_optimum_is_the_metric():
    from scipy.linalg import block_diag

    plant = random_plant("discrete", 2, 1, seed=3, cross=False)
    gains, _ = difference_riccati(plant, 4, np.eye(2))
    root = np.sqrt(plant.V.item())
    cost = HorizonCost(plant.A, plant.C / root, plant.W, np.eye(2), 4)
    x = np.concatenate([(gain * root).ravel(order="F") for gain in gains])
    np.testing.assert_allclose(cost.gradient(x), 0, atol=1e-12)
    rows = [(cost.gradient(x + step) - cost.gradient(x - step)) / 2e-5 for step in 1e-5 * np.eye(len(x))]
    np.testing.assert_allclose(rows, block_diag(*cost.metric(x)), atol=1e-6)
