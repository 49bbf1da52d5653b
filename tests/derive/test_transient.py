"""The error covariance over time: against the differential equation, the recursion and the steady solution."""

import numpy as np
import pytest

from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from derive.numeric.transient import covariance_over_time, start_covariance, time_grid


def discrete_plant():
    """Return a discrete plant with an unstable mode and correlated noises."""
    return plant_from_mapping(
        {"time": "discrete", "A": [[1.1, 0.3], [0.0, 0.5]], "C": [[1.0, 0.0]], "Q": [[1.0, 0.2], [0.2, 0.5]],
         "R": [[2.0]], "S": [[0.3], [0.1]]}
    )  # fmt: skip


def rate(plant, P):
    """Return dP/dt by the Riccati equation."""
    gain = np.linalg.solve(plant.V, (P @ plant.C.T + plant.N).T).T
    return plant.A @ P + P @ plant.A.T + plant.W - gain @ plant.V @ gain.T


@pytest.mark.parametrize("plant", [example_plant(), discrete_plant()], ids=["continuous", "discrete"])
def test_it_starts_where_it_should_and_settles_at_the_steady_solution(plant):
    steady = solve_riccati(plant)
    times = time_grid(plant, steady.closed_loop)
    P = covariance_over_time(plant, start_covariance(plant), times)
    assert P.shape == (len(times), plant.n, plant.n)
    assert np.array_equal(P[0], start_covariance(plant))
    excess = np.linalg.norm(P[0] - steady.P)
    assert np.linalg.norm(P[-1] - steady.P) < 1e-3 * excess
    assert np.all(np.linalg.eigvalsh(P) > -1e-12 * excess)
    again = covariance_over_time(plant, steady.P, times)
    assert np.allclose(again, steady.P, rtol=1e-10)


def test_it_solves_the_differential_equation():
    plant = example_plant()
    times = np.linspace(0, 1e-3, 11)
    P = covariance_over_time(plant, start_covariance(plant), times)
    difference = (P[2:] - P[:-2]) / (times[2] - times[0])
    exact = np.array([rate(plant, p) for p in P[1:-1]])
    assert np.allclose(difference, exact, rtol=0, atol=1e-4 * np.abs(exact).max())


def test_it_is_the_scalar_recursion():
    plant = plant_from_mapping({"time": "discrete", "A": [[2.0]], "C": [[1.0]], "Q": [[1.0]], "R": [[1.0]]})
    P = covariance_over_time(plant, np.eye(1), np.arange(4.0))[:, 0, 0]
    assert np.allclose(P[1:], 4 * P[:-1] + 1 - 4 * P[:-1] ** 2 / (P[:-1] + 1))


def test_where_it_starts():
    stable, given = example_plant(), {"time": "continuous", "A": [[1.0]], "C": [[1.0]], "W": [[1.0]], "V": [[1.0]]}
    prior = start_covariance(stable)
    assert np.allclose(stable.A @ prior + prior @ stable.A.T, -stable.W)
    assert start_covariance(plant_from_mapping(given)) == np.eye(1)
    assert start_covariance(plant_from_mapping({**given, "P0": [[3.0]]})) == 3 * np.eye(1)


def test_the_grid_of_a_plant_with_a_mode_on_the_boundary():
    plant = plant_from_mapping({"time": "continuous", "A": [[0.0]], "C": [[1.0]], "W": [[0.0]], "V": [[1.0]]})
    assert np.all(np.diff(time_grid(plant, np.array([0.0]))) > 0)
    plant = plant_from_mapping({"time": "discrete", "A": [[1.0]], "C": [[1.0]], "Q": [[0.0]], "R": [[1.0]]})
    assert list(time_grid(plant, np.array([1.0]))) == [0.0, 1.0]
