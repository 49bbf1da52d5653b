"""The spectrum integral and the Hamiltonian modes against the Riccati solution; quadrature against known integrals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from derive.numeric.plant import example_plant
from derive.numeric.quadrature import integrate
from derive.numeric.riccati import solve_riccati
from derive.numeric.spectrum import hamiltonian_route, output_cost, output_error_integral
from tests.derive.numeric.plants import OSCILLATOR, ROTATION, STABILISING, STRONG, continuous, discrete, random_plant

TIMES = ["continuous", "discrete"]


def by_riccati(plant):
    return output_cost(plant, solve_riccati(plant).P)


def assert_both_routes_agree(plant, rtol=1e-11):
    expected = by_riccati(plant)
    integral, hamiltonian = output_error_integral(plant), hamiltonian_route(plant)
    assert integral.value == pytest.approx(expected, rel=rtol, abs=1e-13)
    assert hamiltonian.value == pytest.approx(expected, rel=rtol, abs=1e-12)
    assert integral.error_estimate <= 1e-11 * max(abs(expected), 1)
    return integral, hamiltonian


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", range(1, 11))
def test_random_plants(time, n):
    plant = random_plant(time, n, seed=n)
    _, hamiltonian = assert_both_routes_agree(plant)
    modes = solve_riccati(plant).closed_loop
    np.testing.assert_allclose(np.poly(hamiltonian.modes), np.poly(modes), rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("plant", [case[0] for case in STRONG.values()], ids=STRONG)
def test_strong_solutions(plant):
    assert_both_routes_agree(plant)


@pytest.mark.parametrize("plant", [case[0] for case in STABILISING.values()], ids=STABILISING)
def test_stabilising_solutions(plant):
    assert_both_routes_agree(plant)


SINGULAR = {
    "integrator": continuous(A=0, C=1, W=1, V=1),
    "oscillator": continuous(A=5 * np.array(OSCILLATOR), C=[[1, 0]], W=np.diag([0, 1e-4]), V=1),
    "double integrator": continuous(A=[[0, 1], [0, 0]], C=[[1, 0]], W=np.diag([0, 1]), V=1),
    "constant": discrete(A=1, C=1, Q=0.3, R=2),
    "alternation": discrete(A=-1, C=1, Q=0.3, R=2),
    "rotation": discrete(A=ROTATION, C=[[1, 0]], Q=np.diag([0, 1]), R=1),
}


@pytest.mark.parametrize("plant", SINGULAR.values(), ids=SINGULAR)
def test_logarithmic_singularities_are_integrated(plant):
    integral, _ = assert_both_routes_agree(plant)
    assert integral.unstable_term == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("damping", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("masses", [1, 5])
def test_lightly_damped_chains(masses, damping):
    """Masses between springs, the last one driven, the first one measured: resonances as narrow as the damping."""
    K = 2 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
    A = np.block([[np.zeros((masses, masses)), np.eye(masses)], [-K, -damping * K]])
    W = np.zeros((2 * masses, 2 * masses))
    W[-1, -1] = 1.0
    integral, _ = assert_both_routes_agree(continuous(A=A, C=np.eye(1, 2 * masses), W=W, V=0.01))
    assert integral.evaluations < 50000


@pytest.mark.parametrize("n", [20, 40])
def test_larger_plants(n):
    integral, _ = assert_both_routes_agree(random_plant("continuous", n, 4, seed=1))
    assert integral.evaluations < 20000


def test_the_unstable_modes_are_paid_for():
    plant = continuous(A=np.diag([3.0, -1.0, 0.5]), C=[[1, 1, 1]], W=np.zeros((3, 3)), V=1)
    integral = output_error_integral(plant)
    assert integral.unstable_term == pytest.approx(7, rel=1e-15)
    assert integral.value == pytest.approx(7, rel=1e-15)
    steps = output_error_integral(discrete(A=np.diag([2.0, 0.5]), C=[[1, 1]], Q=np.zeros((2, 2)), R=1))
    assert steps.value == steps.unstable_term == pytest.approx(2 * np.log(2), rel=1e-15)


def test_the_formula_with_the_spectrum_of_y_itself():
    """tr(C P C' V^-1) + tr(C N V^-1) = (1/2 pi) int ln(det Phi_y / det V) dw + 2 sum max(0, Re lambda_i(A)), N != 0."""
    plant = random_plant("continuous", 3, 2, seed=4)
    assert np.abs(plant.N).max() > 0.01

    def log_det(w):
        H = plant.C @ np.linalg.inv(1j * w * np.eye(3) - plant.A)
        Phi = H @ plant.W @ H.conj().T + H @ plant.N + (H @ plant.N).conj().T + plant.V
        return np.linalg.slogdet(Phi)[1] - np.linalg.slogdet(plant.V)[1]

    near, far = quad(log_det, 0, 10, limit=500, epsrel=1e-11)[0], quad(lambda v: log_det(10 / v) * 10 / v**2, 0, 1)[0]
    unstable = 2 * np.maximum(np.linalg.eigvals(plant.A).real, 0).sum()
    cross = np.trace(np.linalg.solve(plant.V, plant.C @ plant.N))
    assert output_error_integral(plant).value + cross == pytest.approx((near + far) / np.pi + unstable, rel=1e-8)


def test_the_discrete_formula_with_the_spectrum_of_y_itself():
    plant = random_plant("discrete", 3, 2, seed=4)
    angles = 2 * np.pi * (np.arange(4096) + 0.5) / 4096
    H = np.array([plant.C @ np.linalg.inv(np.exp(1j * w) * np.eye(3) - plant.A) for w in angles])
    cross = H @ plant.N
    Phi = H @ plant.W @ H.conj().swapaxes(1, 2) + cross + cross.conj().swapaxes(1, 2) + plant.V
    unstable = 2 * np.log(np.maximum(np.abs(np.linalg.eigvals(plant.A)), 1)).sum()
    expected = np.linalg.slogdet(Phi)[1].mean() + unstable
    assert output_error_integral(plant).value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("time", TIMES)
def test_units_of_states_do_not_matter(time):
    plant = random_plant(time, 4, 2, seed=6)
    t = 10.0 ** np.array([-8, -3, 4, 9])
    T, inverse = np.diag(t), np.diag(1 / t)
    scaled = replace(plant, A=T @ plant.A @ inverse, C=plant.C @ inverse, W=T @ plant.W @ T, N=T @ plant.N)
    for route in (output_error_integral, hamiltonian_route):
        assert route(scaled).value == pytest.approx(route(plant).value, rel=1e-10)


def test_the_example():
    assert_both_routes_agree(example_plant(), rtol=1e-13)


def test_time_units_scale_the_continuous_cost():
    plant = random_plant("continuous", 3, 1, seed=2)
    faster = replace(plant, A=10 * plant.A, W=10 * plant.W, V=plant.V / 10)
    assert output_error_integral(faster).value == pytest.approx(10 * output_error_integral(plant).value, rel=1e-11)


KNOWN = {
    "logarithm": (lambda c, u: -np.log(np.abs(u)), [(0.0, 0.0, 1.0)], 1.0),
    "logarithm away from zero": (lambda c, u: -np.log(np.abs(u)), [(1e6, -1.0, 0.0), (1e6, 0.0, 1.0)], 2.0),
    "narrow peak": (lambda c, u: 1e-8 / (u**2 + 1e-16), [(3.0, -1.0, 0.0), (3.0, 0.0, 1.0)], np.pi - 2e-8),
    "polynomial": (lambda c, u: (c + u) ** 7, [(1.0, -1.0, 0.0), (1.0, 0.0, 1.0)], 2.0**8 / 8),
    "nothing": (lambda c, u: 0 * u, [(0.0, 0.0, 1.0)], 0.0),
}


@pytest.mark.parametrize(("f", "panels", "expected"), KNOWN.values(), ids=KNOWN)
def test_quadrature(f, panels, expected):
    found = integrate(f, np.array(panels), 1e-13)
    assert found.value == pytest.approx(expected, rel=1e-13)
    assert abs(found.value - expected) <= max(found.error, 1e-15)
    assert found.evaluations < 20000


def test_quadrature_of_rounding_noise_ends():
    rng = np.random.default_rng(0)
    found = integrate(lambda c, u: 1 + 1e-6 * rng.standard_normal(u.shape), np.array([(0.0, 0.0, 1.0)]), 1e-13)
    assert found.value == pytest.approx(1, abs=1e-6)
    assert found.error > 1e-8
    assert found.evaluations < 10**6
