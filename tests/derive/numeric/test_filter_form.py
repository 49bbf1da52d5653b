"""The filter form against the conditional covariance of jointly normal numbers, and against the predictor."""

from dataclasses import replace

import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.filter_form import filter_covariance, filter_gain, predicted_covariance, predictor_gain
from derive.numeric.riccati import solve_riccati
from tests.derive.numeric.plants import random_plant

STEPS = 60


def dense_conditional_covariances(plant, steps):
    """Return Cov(x_k | y_0..y_k-1) and Cov(x_k | y_0..y_k), from the joint covariance of everything, k the last."""
    n, l = plant.n, plant.l  # noqa: E741
    size = n + l
    joint = np.block([[plant.W, plant.N], [plant.N.T, plant.V]])
    noise = np.kron(np.eye(steps + 1), joint)
    start = np.eye(n)
    source = np.block([[start, np.zeros((n, len(noise)))], [np.zeros((len(noise), n)), noise]])
    state = np.hstack([np.eye(n), np.zeros((n, len(noise)))])
    outputs = []
    for k in range(steps + 1):
        w, v = (np.zeros((m, n + len(noise))) for m in (n, l))
        w[:, n + k * size : n + k * size + n] = np.eye(n)
        v[:, n + k * size + n : n + (k + 1) * size] = np.eye(l)
        outputs.append(plant.C @ state + v)
        last, state = state, plant.A @ state + w
    return tuple(_conditional(source, last, np.vstack(seen)) for seen in (outputs[:-1], outputs))


def _conditional(source, wanted, seen):
    cross, size = wanted @ source @ seen.T, seen @ source @ seen.T
    return wanted @ source @ wanted.T - cross @ np.linalg.solve(size, cross.T)


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("cross", [False, True])
def test_filter_and_predictor_are_the_conditional_covariances(n, cross):
    plant = random_plant("discrete", n, 1, seed=3, cross=cross)
    P = solve_riccati(plant).P
    predicted, filtered = dense_conditional_covariances(plant, STEPS)
    np.testing.assert_allclose(P, predicted, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(filter_covariance(plant, P), filtered, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("n", [1, 3, 6])
@pytest.mark.parametrize("cross", [False, True])
def test_prediction_of_the_filter_is_the_predictor(n, cross):
    plant = random_plant("discrete", n, seed=1, cross=cross)
    solution = solve_riccati(plant)
    filtered = filter_covariance(plant, solution.P)
    gain = filter_gain(plant, solution.P)
    np.testing.assert_allclose(predicted_covariance(plant, filtered), solution.P, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(predictor_gain(plant, solution.P), solution.gain, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(gain, filtered @ plant.C.T @ np.linalg.inv(plant.V), rtol=1e-10, atol=1e-12)


def test_accurate_measurement_leaves_a_covariance_that_is_not_negative():
    plant = random_plant("discrete", 5, 5, seed=0)
    P = solve_riccati(plant).P
    sharp = replace(plant, V=1e-14 * plant.V)
    assert np.linalg.eigvalsh(filter_covariance(sharp, P))[0] >= 0


def test_continuous_plant_is_refused():
    plant = random_plant("continuous", 2)
    for function in (filter_covariance, filter_gain, predicted_covariance, predictor_gain):
        with pytest.raises(InputError, match='time: expected "discrete"'):
            function(plant, np.eye(2))
