"""Gains with a structure: stationary over the entries that vary, and honest about what that means."""

import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.gain_descent import descend
from derive.numeric.gain_nlp import optimise_gain
from derive.numeric.gain_structured import _random_start, _scaled, _spread, optimise_structured_gain
from derive.numeric.lyapunov import error_covariance
from derive.numeric.plant import Plant
from tests.derive.numeric.plants import continuous, discrete, random_plant

TIMES = ["continuous", "discrete"]
HALF = np.array([[1, 0], [1, 0], [0, 1], [0, 1]])


def cost_of(plant, gain):
    P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, gain, plant.time)
    return np.trace(plant.M @ P), P


@pytest.mark.parametrize("time", TIMES)
def test_without_structure_it_is_the_optimum(time):
    plant = random_plant(time, 4, 2, seed=1)
    found, best = optimise_structured_gain(plant, np.ones((4, 2)), starts=2), optimise_gain(plant)
    assert found.status == "stationary"
    assert found.cost == pytest.approx(best.trace, rel=1e-12)
    np.testing.assert_allclose(found.P, best.P, rtol=0, atol=1e-6 * best.trace)


@pytest.mark.parametrize("time", TIMES)
def test_a_decentralised_gain_is_stationary(time):
    plant = random_plant(time, 4, 2, seed=1)
    found = optimise_structured_gain(plant, HALF)
    assert found.status == "stationary"
    assert (found.gain[HALF == 0] == 0).all()
    cost, P = cost_of(plant, found.gain)
    assert found.cost == pytest.approx(cost, rel=1e-10)
    np.testing.assert_allclose(found.P, P, rtol=0, atol=1e-9 * cost)
    assert found.cost > 1.01 * optimise_gain(plant).trace
    assert found.cost == pytest.approx(min(found.starts), rel=1e-15)
    assert len(found.starts) == 4
    assert found.gradient_norm == np.linalg.norm(found.gradient) < 1e-6 * cost
    for i, j in np.argwhere(HALF):
        E = np.zeros((4, 2))
        E[i, j] = 1e-3
        assert min(cost_of(plant, found.gain + step)[0] for step in (E, -E)) > cost


@pytest.mark.parametrize("time", TIMES)
def test_the_gradient_is_in_the_units_of_the_plant(time):
    """At fixed values that leave nothing to vary but one entry, cut off before it settles."""
    plant = random_plant(time, 4, 2, seed=1)
    found = optimise_structured_gain(plant, HALF, starts=1)
    cost, scale = _scaled(plant, HALF.astype(bool), np.zeros((4, 2)))
    gain = found.gain + 0.01 * HALF
    slope = _spread(cost, cost.gradient(cost.entries(gain / scale))) / scale
    for i, j in np.argwhere(HALF):
        E = np.zeros((4, 2))
        E[i, j] = 1e-6
        above, below = (cost_of(plant, gain + step)[0] for step in (E, -E))
        assert slope[i, j] == pytest.approx((above - below) / 2e-6, rel=1e-4, abs=1e-5)


def test_fixed_values_stay():
    plant = random_plant("continuous", 4, 2, seed=1)
    fixed = np.full((4, 2), 0.3)
    found = optimise_structured_gain(plant, HALF, fixed, starts=1)
    assert (found.gain[HALF == 0] == 0.3).all()
    assert found.status == "stationary"


def test_one_entry_against_a_grid():
    """Of x_1' = -x_1 + w_1, x_2' = -x_2 + w_2, y = x_1 + x_2 + v only x_1 is corrected."""
    plant = continuous(A=-np.eye(2), C=[[1.0, 1.0]], W=np.eye(2), V=1.0)
    found = optimise_structured_gain(plant, [[1], [0]])
    grid = np.linspace(-0.5, 1.5, 20001)
    costs = [cost_of(plant, np.array([[g], [0.0]]))[0] for g in grid[::200]]
    assert found.cost <= min(costs)
    best = grid[::200][int(np.argmin(costs))]
    assert found.gain[0, 0] == pytest.approx(best, abs=0.02)


def test_the_weight_counts():
    plant = random_plant("discrete", 4, 2, seed=1)
    data = {name: getattr(plant, name) for name in "ACWVN"}
    first = Plant(time="discrete", **data, M=np.diag([1.0, 0.01, 0.01, 0.01]))
    found, other = optimise_structured_gain(first, HALF, starts=1), optimise_structured_gain(plant, HALF, starts=1)
    assert found.P[0, 0] < other.P[0, 0] * (1 - 1e-4)


def test_seeds_repeat_and_starts_differ():
    plant = random_plant("continuous", 4, 2, seed=1)
    first, again = (optimise_structured_gain(plant, HALF, starts=2, seed=5) for _ in range(2))
    assert (first.starts, first.iterations) == (again.starts, again.iterations)
    cost, scale = _scaled(plant, HALF.astype(bool), np.zeros((4, 2)))
    answer = descend(cost, cost.entries(first.gain / scale))
    points = [_random_start(cost, answer, np.random.default_rng(seed)) for seed in (5, 6)]
    assert all(map(cost.is_stable, points))
    assert np.abs(points[0] - points[1]).max() > 0.01 * np.abs(answer.x).max()


def test_a_structure_that_cannot_stabilise_fails_without_a_claim():
    plant = continuous(A=np.eye(2), C=np.eye(2), W=np.eye(2), V=np.eye(2))
    found = optimise_structured_gain(plant, [[1, 0], [0, 0]], starts=2)
    assert found.status == "failed"
    assert found.starts == (np.inf, np.inf)
    assert np.isnan(found.gain).all()


def test_units_do_not_matter():
    plant = discrete(A=[[0.9, 0.2], [0.0, 1.1]], C=np.eye(2), Q=np.eye(2), R=np.eye(2))
    T, D = np.diag([1e-5, 1e4]), np.diag([1e3, 1e-4])
    scaled = discrete(
        A=T @ plant.A @ np.linalg.inv(T), C=D @ plant.C @ np.linalg.inv(T), Q=T @ T, R=D @ D
    )  # fmt: skip
    mask = [[1, 0], [0, 1]]
    found, other = optimise_structured_gain(plant, mask), optimise_structured_gain(scaled, mask)
    weighted = Plant(
        time="discrete", A=scaled.A, C=scaled.C, W=scaled.W, V=scaled.V, N=scaled.N, M=np.linalg.inv(T @ T)
    )
    assert other.status == "stationary"
    assert optimise_structured_gain(weighted, mask).cost == pytest.approx(found.cost, rel=1e-12)


@pytest.mark.parametrize(
    ("structure", "options", "message"),
    [
        (np.ones((2, 4)), {}, r"^structure: expected shape \(4, 2\), got \(2, 4\)"),
        (np.full((4, 2), 0.5), {}, r"^structure: expected 0 and 1"),
        (HALF, {"fixed": np.zeros((2, 2))}, r"^fixed: expected shape \(4, 2\), got \(2, 2\)"),
        (HALF, {"fixed": np.full((4, 2), np.nan)}, r"^fixed: expected finite numbers"),
        (HALF, {"starts": 0}, r"^starts: expected at least 1, got 0"),
    ],
)
def test_bad_input(structure, options, message):
    with pytest.raises(InputError, match=message):
        optimise_structured_gain(random_plant("continuous", 4, 2), structure, **options)
