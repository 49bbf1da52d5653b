"""Norms of transfer matrices against closed forms, frequency grids, quadrature and python-control."""

import numpy as np
import pytest

from derive.numeric.norms import h2_norm, hinf_norm, largest_gain

TIMES = ("continuous", "discrete")


def system(time, seed):
    """Return a stable A, B, C whose slowest mode is at a seeded distance from the boundary."""
    rng = np.random.default_rng([seed, time == "discrete"])
    n, m, p = rng.integers(1, 8), rng.integers(1, 4), rng.integers(1, 4)
    A, distance = rng.standard_normal((n, n)), 10.0 ** rng.uniform(-4, 0)
    modes = np.linalg.eigvals(A)
    A = (
        A - (modes.real.max() + distance) * np.eye(n)
        if time == "continuous"
        else A / np.abs(modes).max() / (1 + distance)
    )
    return A, rng.standard_normal((n, m)), rng.standard_normal((p, n))


def grid(A, time):
    """Return frequencies: everywhere, and densely around the modes."""
    modes = np.linalg.eigvals(A)
    near = np.concatenate([[0.0], np.geomspace(1e-7, 1.0, 300)])
    if time == "continuous":
        around = np.abs(modes.imag)[:, None] + np.abs(modes.real)[:, None] * np.linspace(-3, 3, 301)
        return np.unique(np.concatenate([near, np.geomspace(1e-3, 1e3, 2000), np.abs(around.ravel())]))
    around = np.abs(np.angle(modes))[:, None] + (1 - np.abs(modes))[:, None] * np.linspace(-3, 3, 301)
    return np.unique(np.concatenate([np.linspace(0, np.pi, 2000), np.abs(around.ravel())]))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("time", TIMES)
def test_hinf_norm_is_the_largest_value_on_a_grid(time, seed):
    A, B, C = system(time, seed)
    norm = hinf_norm(A, B, C, time)
    on_grid = largest_gain(A, B, C, time, grid(A, time)).max()
    assert norm.upper <= norm.lower * (1 + 2e-9)
    assert on_grid <= norm.upper
    assert on_grid > norm.lower * (1 - 1e-3)
    at_peak = largest_gain(A, B, C, time, np.array([norm.frequency]))[0]
    assert at_peak == pytest.approx(norm.lower, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("time", TIMES)
def test_norms_are_those_of_python_control(time, seed):
    control = pytest.importorskip("control")
    pytest.importorskip("slycot")
    A, B, C = system(time, seed)
    theirs = control.ss(A, B, C, np.zeros((len(C), B.shape[1])), *([True] if time == "discrete" else []))
    assert hinf_norm(A, B, C, time).lower == pytest.approx(control.linfnorm(theirs, tol=1e-10)[0], rel=1e-8)
    assert h2_norm(A, B, C, time) == pytest.approx(control.system_norm(theirs, 2), rel=1e-9)


@pytest.mark.parametrize("damping", [1e-3, 0.1, 0.5])
def test_hinf_norm_of_an_oscillator_is_its_resonance(damping):
    A, B, C = np.array([[0.0, 1.0], [-4.0, -4.0 * damping]]), np.array([[0.0], [4.0]]), np.array([[1.0, 0.0]])
    norm = hinf_norm(A, B, C, "continuous")
    assert norm.upper == pytest.approx(1 / (2 * damping * np.sqrt(1 - damping**2)), rel=1e-8)
    assert norm.frequency == pytest.approx(2 * np.sqrt(1 - 2 * damping**2), rel=1e-3)


@pytest.mark.parametrize("a", [0.9, -0.9])
def test_hinf_norm_of_a_discrete_lag_is_at_either_end(a):
    norm = hinf_norm(np.array([[a]]), np.eye(1), np.eye(1), "discrete")
    assert norm.upper == pytest.approx(1 / (1 - abs(a)), rel=1e-8)
    assert norm.frequency == pytest.approx(0.0 if a > 0 else np.pi)


@pytest.mark.parametrize("time", TIMES)
def test_h2_norm_is_the_integral_over_frequency(time):
    A, B, C = system(time, 3)
    A = A - 0.5 * np.eye(len(A)) if time == "continuous" else 0.7 * A
    t = np.linspace(-np.pi, np.pi, 40_001)[1:-1]
    omega, weight = (np.tan(t / 2), 0.5 / np.cos(t / 2) ** 2) if time == "continuous" else (t, np.ones(len(t)))
    points = 1j * omega if time == "continuous" else np.exp(1j * omega)
    responses = C @ np.linalg.solve(points[:, None, None] * np.eye(len(A)) - A, B.astype(complex))
    density = np.sum(np.abs(responses) ** 2, axis=(1, 2)) * weight
    assert h2_norm(A, B, C, time) ** 2 == pytest.approx(density.mean(), rel=1e-3)


@pytest.mark.parametrize("time", TIMES)
def test_norms_do_not_depend_on_units_of_the_states(time):
    A, B, C = system(time, 5)
    t = 2.0 ** np.random.default_rng(0).integers(-20, 21, len(A))
    scaled = A * t / t[:, None], B / t[:, None], C * t
    assert hinf_norm(*scaled, time).upper == pytest.approx(hinf_norm(A, B, C, time).upper, rel=1e-8)
    assert h2_norm(*scaled, time) == pytest.approx(h2_norm(A, B, C, time), rel=1e-8)


@pytest.mark.parametrize("time", TIMES)
def test_the_norm_of_an_unstable_system_is_infinite(time):
    A = np.array([[1.5]])
    assert hinf_norm(A, np.eye(1), np.eye(1), time).upper == np.inf
    assert h2_norm(A, np.eye(1), np.eye(1), time) == np.inf


@pytest.mark.parametrize("time", TIMES)
def test_the_norm_of_nothing_is_zero(time):
    A = np.diag([-0.5, -0.3])
    assert hinf_norm(A, np.zeros((2, 1)), np.eye(2), time).upper == 0.0
    unreachable = hinf_norm(A, np.array([[1.0], [0.0]]), np.array([[0.0, 1.0]]), time)
    assert (unreachable.lower, unreachable.upper) == (0.0, 0.0)
    assert h2_norm(A, np.zeros((2, 1)), np.eye(2), time) == 0.0
