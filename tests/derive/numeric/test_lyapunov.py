"""Lyapunov and Stein equations against the dense Kronecker system; gains that stabilise without a Riccati equation."""

import numpy as np
import pytest

from derive.numeric.lyapunov import error_covariance, solve_lyapunov
from derive.numeric.modes import distance_to_stability, format_mode
from derive.numeric.normal import normal_form
from derive.numeric.stabilise import stabilising_gain
from tests.derive.numeric.plants import OSCILLATOR, ROTATION, random_plant

TIMES = ["continuous", "discrete"]


def dense(F, Q, time):
    """Return X from (I x F + F x I) vec X = -vec Q, in discrete time (F x F - I) vec X = -vec Q."""
    one = np.eye(len(F))
    system = np.kron(one, F) + np.kron(F, one) if time == "continuous" else np.kron(F, F) - np.kron(one, one)
    return np.linalg.solve(system, -Q.ravel()).reshape(F.shape)


def stable(n, time, rng):
    F = rng.standard_normal((n, n))
    modes = np.linalg.eigvals(F)
    return F - (modes.real.max() + 0.1) * np.eye(n) if time == "continuous" else 0.95 * F / np.abs(modes).max()


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 5, 8])
def test_the_dense_system_agrees(time, n):
    rng = np.random.default_rng(n)
    F, Q = stable(n, time, rng), rng.standard_normal((n, n))
    Q = Q + Q.T
    np.testing.assert_allclose(solve_lyapunov(F, Q, time), dense(F, Q, time), rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("modes", [[1 - 1e-9], [-1 + 1e-9], [0.0]])
def test_stein_holds_next_to_the_unit_circle(modes):
    F = np.diag(modes)
    X = solve_lyapunov(F, np.eye(1), "discrete")
    np.testing.assert_allclose(X, 1 / (1 - F**2), rtol=1e-6)


@pytest.mark.parametrize("time", TIMES)
def test_the_error_covariance_is_that_of_the_augmented_noise(time):
    plant = random_plant(time, 4, 2, seed=1)
    gain = stabilising_gain(plant.A, plant.C, time)
    joint = np.block([[plant.W, plant.N], [plant.N.T, plant.V]])
    inputs = np.hstack([np.eye(4), -gain])
    expected = dense(plant.A - gain @ plant.C, inputs @ joint @ inputs.T, time)
    P = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, gain, time)
    np.testing.assert_allclose(P, expected, rtol=1e-9)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", range(1, 11))
def test_the_start_is_stable(time, n):
    form = normal_form(random_plant(time, n, max(1, n // 3), seed=n))
    F, C, _ = form.uncorrelated()
    F = F + 0.5 * np.eye(n) if time == "continuous" else 1.5 * F
    gain = stabilising_gain(F, C, time)
    assert distance_to_stability(np.linalg.eigvals(F - gain @ C), time).max() < 0


@pytest.mark.parametrize(
    ("A", "time"),
    [
        ([[0.0]], "continuous"),
        (OSCILLATOR, "continuous"),
        ([[0, 1], [0, 0]], "continuous"),
        ([[1.0]], "discrete"),
        (ROTATION, "discrete"),
        ([[1, 1], [0, 1]], "discrete"),
    ],
)
def test_the_start_moves_modes_off_the_boundary(A, time):
    A = np.array(A, float)
    C = np.eye(1, len(A))
    gain = stabilising_gain(A, C, time)
    assert distance_to_stability(np.linalg.eigvals(A - gain @ C), time).max() < -0.01
    if len(A) > 1:
        T = np.linalg.qr(np.random.default_rng(1).standard_normal(A.shape))[0]
        gain = stabilising_gain(T @ A @ T.T, C @ T.T, time)
        assert distance_to_stability(np.linalg.eigvals(T @ A @ T.T - gain @ C @ T.T), time).max() < -0.01


def test_what_is_stable_already_is_left_alone():
    gain = stabilising_gain(np.diag([-1.0, 2.0, -3.0]), np.ones((1, 3)), "continuous")
    modes = np.linalg.eigvals(np.diag([-1.0, 2.0, -3.0]) - gain @ np.ones((1, 3)))
    np.testing.assert_allclose(np.sort(modes.real)[[0, 2]], [-3.0, modes.real.max()])
    assert np.min(np.abs(modes + 1)) < 1e-12


@pytest.mark.parametrize(
    ("mode", "text"),
    [(0.3 + 2j, "0.3+2j"), (0.3 - 2j, "0.3-2j"), (-1, "-1"), (2j, "2j"), (1e-17 + 2j, "2j"), (0, "0"), (0.1, "0.1")],
)
def test_a_mode_reads_like_a_number(mode, text):
    assert format_mode(mode) == text


def test_slow_modes_that_are_not_seen_are_spared():
    for A, time in (([-1e-3, 1e6], "continuous"), ([0.999999, 1e6], "discrete")):
        F, C = np.diag(A), np.array([[0.0, 1.0]])
        gain = stabilising_gain(F, C, time)
        assert distance_to_stability(np.linalg.eigvals(F - gain @ C), time).max() < 0


def test_no_gain_stabilises_what_is_not_seen():
    for A, time in (([[1.0]], "continuous"), ([[2.0]], "discrete")):
        assert np.isnan(stabilising_gain(np.array(A), np.zeros((1, 1)), time)).all()
