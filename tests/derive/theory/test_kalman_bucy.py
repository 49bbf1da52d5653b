"""The Kalman-Bucy lecture against numbers: the white innovation, and spectra by quadrature of autocorrelations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad_vec, solve_ivp
from scipy.linalg import expm, solve_continuous_are, solve_continuous_lyapunov

from derive.theory import lecture

POINTS = (0.0, 0.3, 1.7, 11.0)


def plant(seed: int, m: int, p: int, stable: bool):
    """Return A, C, W, V of a random plant, observable and excited for this seed."""
    rng = np.random.default_rng(seed)
    A, C, B, D = (rng.standard_normal(shape) for shape in ((m, m), (p, m), (m, m), (p, p)))
    if stable:
        A -= (max(np.linalg.eigvals(A).real) + 0.5) * np.eye(m)
    return A, C, B @ B.T, D @ D.T + np.eye(p)


def kalman(A, C, W, V):
    P = solve_continuous_are(A.T, C.T, W, V)
    return P, P @ C.T @ np.linalg.inv(V)


def innovation_spectrum(s, A, C, W, V, L):
    """Return Phi_e(s) for any gain, as the lecture defines it for the Kalman gain."""
    eye = np.eye(len(A))
    forward, backward = (np.linalg.inv(point * eye - A + L @ C) for point in (s, -s))
    one = np.eye(len(V))
    return C @ forward @ W @ backward.T @ C.T + (one - C @ forward @ L) @ V @ (one - C @ backward @ L).T


@pytest.mark.parametrize(("seed", "m", "p", "stable"), [(1, 1, 1, True), (2, 3, 2, False), (3, 4, 1, False)])
def test_the_spectrum_of_the_innovation_is_constant(seed, m, p, stable):
    A, C, W, V = plant(seed, m, p, stable)
    _, K = kalman(A, C, W, V)
    for omega in POINTS:
        at_gain, off = (innovation_spectrum(1j * omega, A, C, W, V, L) for L in (K, 1.2 * K))
        assert abs(at_gain - V).max() < 1e-9 * abs(V).max()
        assert omega > 5 or abs(off - V).max() > 1e-3


@pytest.mark.parametrize("factor", [1.0, 1.3])
def test_the_correlation_of_error_and_integral_is_zero_for_the_kalman_gain_only(factor):
    """S' = (A-LC) S + P_L C' - L V, with P_L from its own equation; and the covariance of white noise's integral.

    The oracle integrates the covariance of (error, integral) as one linear system with correlated noise.
    """
    A, C, W, V = plant(2, 3, 2, False)
    P, K = kalman(A, C, W, V)
    L, m, p = factor * K, 3, 2
    F = np.block([[A - L @ C, np.zeros((m, p))], [C, np.zeros((p, p))]])
    G = np.block([[np.eye(m), -L], [np.zeros((p, m)), np.eye(p)]])
    noise = G @ np.block([[W, np.zeros((m, p))], [np.zeros((p, m)), V]]) @ G.T
    start = np.zeros((m + p, m + p))
    start[:m, :m] = P

    def rate(_, flat):
        X = flat.reshape(m + p, m + p)
        return (F @ X + X @ F.T + noise).ravel()

    found = solve_ivp(rate, (0, 2.0), start.ravel(), rtol=1e-10, atol=1e-12).y[:, -1].reshape(m + p, m + p)
    white = abs(found[:m, m:]).max() < 1e-7 and abs(found[m:, m:] - 2.0 * V).max() < 1e-7
    assert white == (factor == 1.0)


@pytest.mark.parametrize("seed", [4, 5])
def test_the_spectrum_is_the_transform_of_the_autocorrelation(seed):
    """The two-sided transform by quadrature, against C (jwI-A)^-1 W (-jwI-A)^-T C'; V is that of the Dirac delta."""
    A, C, W, _ = plant(seed, 3, 2, True)
    X = solve_continuous_lyapunov(A, -W)
    eye = np.eye(3)
    for omega in POINTS:
        one_sided, error = quad_vec(lambda t, w=omega: expm(A * t) @ X * np.exp(-1j * w * t), 0, 60, epsabs=1e-9)
        assert error < 1e-6
        two_sided = C @ (one_sided + one_sided.conj().T) @ C.T
        plus, minus = (np.linalg.inv(sign * 1j * omega * eye - A) for sign in (1, -1))
        assert abs(one_sided - plus @ X).max() < 1e-7 * abs(X).max()  # the limit that the lecture assumes
        assert abs(two_sided - C @ plus @ W @ minus.T @ C.T).max() < 1e-6 * abs(X).max()


def test_the_covariance_is_the_mean_of_the_spectrum():
    A, _, W, _ = plant(4, 3, 2, True)
    eye = np.eye(3)

    def integrand(angle):
        plus, minus = (np.linalg.inv(sign * 1j * np.tan(angle) * eye - A) for sign in (1, -1))
        return (plus @ W @ minus.T).real / np.cos(angle) ** 2

    half = np.pi / 2 - 1e-9
    total, _ = quad_vec(integrand, -half, half, epsabs=1e-9)
    assert abs(total / (2 * np.pi) - solve_continuous_lyapunov(A, -W)).max() < 1e-6


def test_whiteness_rests_on_the_kalman_gain_and_not_on_the_steady_state():
    used = lecture("kalman-bucy").rests_on("the innovation is white")
    assert {"optimal", "K(t)", "P_L(t0)", "v and x(0)", "E[v v']"} <= used
    assert not used & {"steady P", "steady K", "stationary"}


def test_the_output_spectrum_names_the_limit_that_it_rests_on():
    used = lecture("kalman-bucy").rests_on("spectrum of y, written out")
    assert {"stationary", "transform+", "transform-", "two-sided transform", "spectrum of y"} <= used
    assert not used & {"optimal", "V > 0", "steady P"}
