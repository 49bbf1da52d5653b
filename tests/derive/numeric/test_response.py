"""The covariance over time: against closed forms, an integrator of differential equations, and the recursion itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from derive.errors import InputError
from derive.numeric.flow import flow_over, one_step
from derive.numeric.normal import normal_form
from derive.numeric.plant import example_plant
from derive.numeric.response import covariance_ellipse, covariance_response
from tests.derive.numeric.plants import NOTHING, OSCILLATOR, ROTATION, continuous, discrete, random_plant


def test_a_constant_without_noise_is_learnt_like_one_over_t():
    """P' = -P^2 gives P = P0/(1 + P0 t); in steps, P_{k+1} = P_k/(1 + P_k)."""
    smooth = covariance_response(continuous(A=0, C=1, W=0, V=1, P0=2), horizon=10)
    np.testing.assert_allclose(smooth.covariances[:, 0, 0], 2 / (1 + 2 * smooth.times), rtol=1e-13)
    steps = covariance_response(discrete(A=1, C=1, Q=0, R=1, P0=2), horizon=10)
    np.testing.assert_allclose(steps.covariances[:, 0, 0], 2 / (1 + 2 * steps.times), rtol=1e-13)


def test_an_unstable_mode_without_noise_is_mirrored():
    """A = C = V = 1, W = 0: P = 2/(1 + (2/P0 - 1) e^{-2t}) rises from any P0 > 0 to 2, and stays at P0 = 0."""
    response = covariance_response(continuous(A=1, C=1, W=0, V=1, P0=1e-6), horizon=15)
    expected = 2 / (1 + (2e6 - 1) * np.exp(-2 * response.times))
    np.testing.assert_allclose(response.covariances[:, 0, 0], expected, rtol=1e-9)
    still = covariance_response(continuous(A=1, C=1, W=0, V=1, P0=0), horizon=15)
    np.testing.assert_array_equal(still.covariances, 0)


def test_the_differential_equation_holds():
    plant = random_plant("continuous", 3, 2, seed=1)

    def rate(_, p):
        P = p.reshape(3, 3)
        K = P @ plant.C.T + plant.N
        return (plant.A @ P + P @ plant.A.T + plant.W - K @ np.linalg.solve(plant.V, K.T)).ravel()

    response = covariance_response(plant, points=20)
    start = response.covariances[0].ravel()
    dense = solve_ivp(
        rate, (0, response.times[-1]), start, t_eval=response.times, rtol=1e-10, atol=1e-13, method="DOP853"
    )
    np.testing.assert_allclose(response.covariances, dense.y.T.reshape(-1, 3, 3), rtol=1e-7, atol=1e-10)


def test_the_recursion_holds():
    plant = random_plant("discrete", 3, 2, seed=1)
    response = covariance_response(plant, horizon=5)
    for P, following in zip(response.covariances[:-1], response.covariances[1:], strict=True):
        K = plant.A @ P @ plant.C.T + plant.N
        S = plant.C @ P @ plant.C.T + plant.V
        expected = plant.A @ P @ plant.A.T + plant.W - K @ np.linalg.solve(S, K.T)
        np.testing.assert_allclose(following, expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_the_end_is_the_steady_state(time):
    plant = random_plant(time, 4, 2, seed=2)
    response = covariance_response(plant, horizon=500)
    np.testing.assert_allclose(response.covariances[-1], response.steady, rtol=1e-10)
    np.testing.assert_allclose(response.deviations[0], 2 * np.sqrt(np.diag(response.steady)), rtol=1e-12)
    np.testing.assert_array_equal(response.deviations**2 >= 0, True)
    np.testing.assert_allclose(np.poly(response.open_loop), np.poly(plant.A), rtol=1e-10, atol=1e-10)


def test_the_example_settles_in_the_time_it_chooses():
    response = covariance_response(example_plant())
    assert response.covariances.shape == (200, 4, 4)
    np.testing.assert_allclose(response.deviations[-1], np.sqrt(np.diag(response.steady)), rtol=1e-3)
    slowest = -response.closed_loop.real.max()
    assert response.times[-1] == pytest.approx(6 / slowest)


@pytest.mark.parametrize(
    "plant",
    [
        continuous(A=OSCILLATOR, C=[[1, 0]], W=NOTHING, V=1),
        discrete(A=ROTATION, C=[[1, 0]], Q=NOTHING, R=1),
        discrete(A=0, C=1, Q=1, R=1),
    ],
)
def test_without_a_slowest_mode_a_response_still_ends(plant):
    response = covariance_response(plant)
    assert 0 < response.times[-1] < 100
    assert np.trace(response.covariances[-1]) < np.trace(response.covariances[0])


def test_a_stiff_plant_takes_no_small_steps():
    plant = continuous(A=np.diag([-1e6, -1.0]), C=[[1, 1]], W=np.diag([1e6, 1]), V=1)
    response = covariance_response(plant, points=10, horizon=20)
    np.testing.assert_allclose(response.covariances[-1], response.steady, rtol=1e-9, atol=1e-12)


def test_a_fast_unstable_mode_beside_a_slow_one():
    """exp(5 h) of one step of the response, h = 80 s, is 1e174; the covariance keeps its digits."""
    plant = continuous(A=np.diag([5, -1e-4]), C=[[1, 1]], W=np.diag([0, 1e-12]), V=1, P0=np.diag([1e-3, 1e-8]))
    response = covariance_response(plant)
    assert response.times[1] == pytest.approx(80)
    np.testing.assert_allclose(response.covariances[-1, 0, 0], 10, rtol=1e-6)
    slow = 5e-9 + 5e-9 * np.exp(-2e-4 * response.times)
    np.testing.assert_allclose(response.covariances[:, 1, 1], slow, rtol=1e-3)
    with pytest.raises(InputError, match=r"at most 1.59e\+04 s for a mode that grows at 5 1/s, got 1e\+09; shorten"):
        covariance_response(plant, horizon=1e9)


def test_steps_are_counted_in_seconds_where_the_period_is_known():
    response = covariance_response(discrete(A=0.5, C=1, Q=1, R=1, dt=0.1), horizon=4)
    np.testing.assert_allclose(response.times, [0, 0.1, 0.2, 0.3, 0.4])


def test_twice_a_step_is_the_doubled_step():
    plant = random_plant("discrete", 4, 2, seed=3)
    step, P = one_step(normal_form(plant)), np.diag([1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(step.doubled().after(P), step.after(step.after(P)), rtol=1e-10)
    form = normal_form(random_plant("continuous", 4, 2, seed=3))
    np.testing.assert_allclose(flow_over(form, 2.0).after(P), flow_over(form, 1.0).doubled().after(P), rtol=1e-9)


def test_a_horizon_must_be_positive():
    with pytest.raises(InputError, match="expected 2 points or more and a positive horizon, got 200 and 0"):
        covariance_response(example_plant(), horizon=0)
    with pytest.raises(InputError, match="expected 2 points or more and a positive horizon, got 1 and None"):
        covariance_response(example_plant(), points=1)


def test_numbers_without_end_are_refused():
    plant = discrete(A=[[0, 1e40], [1e40, 0]], C=[[1e-50, 0]], Q=np.eye(2), R=1e50)
    with pytest.raises(InputError, match="expected numbers within double precision, got more; choose other units"):
        covariance_response(plant)


def test_an_ellipse_is_a_level_set():
    P = np.array([[4.0, 9.0, 1.0], [9.0, 1.0, 9.0], [1.0, 9.0, 2.0]])
    z = covariance_ellipse(P, 0, 2, size=3)
    B = P[np.ix_([0, 2], [0, 2])]
    np.testing.assert_allclose(np.einsum("ki,ij,kj->k", z, np.linalg.inv(B), z), 9, rtol=1e-12)
    np.testing.assert_allclose(z[0], z[-1], atol=1e-12)
    assert np.abs(z[:, 0]).max() == pytest.approx(3 * 2, rel=1e-3)


def test_an_ellipse_may_be_a_segment():
    z = covariance_ellipse(np.array([[1.0, 1.0], [1.0, 1.0]]))
    np.testing.assert_allclose(z[:, 0], z[:, 1], atol=1e-7)
