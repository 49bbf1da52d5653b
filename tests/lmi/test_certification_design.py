"""Making certificates of gains: both ends within the target of the optimum, and refusals that name what fails."""

from fractions import Fraction
from math import log

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

import lmi.certification.design as module
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.certificate.design import Norm, floor_checks, proper, verify_design
from lmi.certificate.sandwich import exact_plant
from lmi.certification.design import certify_design
from lmi.certification.design_floor import certified_floor
from lmi.certification.design_infeasible import certify_infeasible
from lmi.certification.sandwich import NotCertifiedError, UnstableGainError
from lmi.synthesis.achieved import achieved

TIMES = ("continuous", "discrete")
TARGET = 3e-5


def random_plant(seed, time, n, l, noises):  # noqa: E741 (the field's letter for the number of outputs)
    rng = np.random.default_rng(seed)
    B, D = rng.standard_normal((n, noises)), rng.standard_normal((l, noises))
    A, C = rng.standard_normal((n, n)) * (1.0 if time == "continuous" else 0.7), rng.standard_normal((l, n))
    E = rng.standard_normal((n, 2))
    M = np.eye(n) if seed % 2 else E @ E.T
    N = np.zeros((n, l)) if seed % 3 else B @ D.T
    return plant_from_mapping({"time": time, "A": A, "C": C, "W": B @ B.T, "V": D @ D.T, "N": N, "M": M})


def chain():
    """Return five oscillators with damping 1e-3 and one sensor."""
    blocks = [np.array([[0.0, 1.0], [-k * k, -2e-3 * k]]) for k in range(1, 6)]
    A = np.zeros((10, 10))
    for k, block in enumerate(blocks):
        A[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
    W = np.kron(np.eye(5), np.diag([0.0, 1.0]))
    return plant_from_mapping({"time": "continuous", "A": A, "C": np.tile([1.0, 0.0], 5)[None], "W": W, "V": 1})


def of(time, A, C, W, V, **more):
    return plant_from_mapping({"time": time, "A": A, "C": C, "W": W, "V": V, **more})


UNITS = np.array([1.0, 2.0**-20, 2.0**20])
PLANTS = {
    **{f"{time} {n}": random_plant(n, time, n, 1 + n % 2, n + 2) for time in TIMES for n in (1, 2, 5, 8)},
    "low rank": random_plant(4, "continuous", 4, 1, 2),
    "low rank, discrete": random_plant(7, "discrete", 4, 1, 2),
    "damping 1e-3": chain(),
    "double integrator": of("continuous", [[0, 1], [0, 0]], [[1, 0]], np.diag([0, 1]), 1),
    "double integrator, discrete": of("discrete", [[1, 0.1], [0, 1]], [[1, 0]], np.diag([0, 1]), 1),
    "position alone counts": of("continuous", [[0, 1], [0, 0]], [[1, 0]], np.diag([0, 1]), 1, M=np.diag([1, 0])),
    "unstable without noise": of("continuous", [[1, 0.5], [0, 2]], [[1, 1]], np.zeros((2, 2)), 1),
    "stable modes without noise": of("continuous", [[1, 0.5], [0, -2]], [[1, 1]], np.diag([1, 0]), 1),
    "stable modes without noise, discrete": of("discrete", [[2, 0.5], [0, 0.5]], [[1, 1]], np.zeros((2, 2)), 1),
    "repeated outputs": of("continuous", [[1.2, 1], [0, 0.9]], [[1, 0], [1, 0]], np.eye(2), np.eye(2) * 0.01),
    "as many outputs as states": of("discrete", [[1.2, 1], [0, 0.9]], np.eye(2), np.eye(2), np.eye(2) * 0.01),
    "noise of 1e-12": of("continuous", [[0, 1], [0, 0]], [[1, 0]], np.diag([0, 1]), 1e-12),
    "units of 2^20": of(
        "continuous",
        UNITS[:, None] * np.array([[-1, 0.5, 1], [0.3, -2, 0.5], [0, 1, 0.3]]) / UNITS,
        np.array([[1, 0, 1]]) / UNITS,
        np.diag(UNITS**2),
        1,
        M=np.diag(UNITS**-2),
    ),
}


def central_gain(plant, gamma):
    """Return a gain with a norm of at most gamma, by the filtering Riccati equation."""
    units = np.sqrt(np.where(np.diag(plant.M) > 0, np.diag(plant.M), 1))
    values, vectors = np.linalg.eigh(plant.M / np.outer(units, units))
    E = units[:, None] * (vectors * np.sqrt(np.maximum(values, 0)))[:, values > 1e-12 * values[-1]]
    outputs, cross = np.vstack([plant.C, E.T]), np.hstack([plant.N, np.zeros(E.shape)])
    noise = -(gamma**2) * np.eye(len(outputs))
    noise[: plant.l, : plant.l], noise[: plant.l, plant.l :] = plant.V, 0
    if plant.is_continuous:
        P = solve_continuous_are(plant.A.T, outputs.T, plant.W, noise, s=cross)
        return np.linalg.solve(plant.V, (P @ plant.C.T + plant.N).T).T
    P = solve_discrete_are(plant.A.T, outputs.T, plant.W, noise, s=cross)
    U = P + P @ E @ np.linalg.solve(gamma**2 * np.eye(E.shape[1]) - E.T @ P @ E, E.T @ P)
    return np.linalg.solve(plant.C @ U @ plant.C.T + plant.V, (plant.A @ U @ plant.C.T + plant.N).T).T


def best_floor(plant):
    """Return the best floor that is found and proved."""
    reached = achieved(plant, solve_riccati(plant).gain).hinf.upper
    found = certified_floor(exact_plant(plant), 1e-3 * reached, reached)
    checks, squared = floor_checks(proper(exact_plant(plant))[0], found)
    assert all(check.holds for check in checks)
    return float(squared) ** 0.5


@pytest.mark.parametrize("plant", PLANTS.values(), ids=PLANTS.keys())
def test_both_ends_are_proved_within_the_target_of_the_optimum(plant):
    """The optimum lies between the best floor and the norm of a gain, so that the gap itself is the measure."""
    floor = best_floor(plant)
    gain = central_gain(plant, floor * (1 + TARGET / 2))
    certificate = certify_design(plant, gain, gamma=floor * (1 + TARGET), floor=floor * (1 - TARGET))
    checks, bounds = verify_design(certificate)
    assert bounds is not None, checks
    assert bounds.gamma <= Fraction(floor * (1 + TARGET))
    assert Fraction(floor * (1 - TARGET)) ** 2 <= bounds.floor_squared <= bounds.gamma**2
    with pytest.raises(NotCertifiedError, match="floor"):
        certify_design(plant, gain, floor=floor * (1 + 2 * TARGET))
    with pytest.raises(NotCertifiedError, match="gamma"):
        certify_design(plant, gain, gamma=floor * (1 - TARGET))


@pytest.mark.parametrize("time", TIMES)
def test_the_decay_asked_for_is_proved_or_refused(time):
    plant = plant_from_mapping(
        {"time": time, "A": [[0.5, 1.0], [-0.25, 0.75]], "C": [[1.0, 0.0]], "W": np.eye(2), "V": 1}
        | ({"dt": 0.25} if time == "discrete" else {})
    )
    gain = solve_riccati(plant).gain
    modes = np.linalg.eigvals(plant.A - gain @ plant.C)
    rate = -modes.real.max() if plant.is_continuous else -log(np.abs(modes).max()) / 0.25
    for share in (0.1, 0.9, 1 - 1e-9):
        found = certify_design(plant, gain, decay=share * rate).decay
        assert float(found.bound) == pytest.approx(rate if plant.is_continuous else np.exp(-rate / 4), rel=1e-5)
    with pytest.raises(NotCertifiedError, match="decay"):
        certify_design(plant, gain, decay=rate * (1 + 1e-6))
    assert certify_design(plant, gain).decay is not None


def test_a_mode_that_no_gain_moves_limits_the_decay_that_is_certified():
    plant = plant_from_mapping({"time": "continuous", "A": [[-1, 0], [0, 2]], "C": [[0, 1]], "W": np.eye(2), "V": 1})
    gain = np.array([[0.0], [5.0]])
    assert 1 - 1e-6 < certify_design(plant, gain, decay=1.0 - 1e-6).decay.bound < 1
    for decay in (1.0, 1.0 + 1e-9):
        with pytest.raises(NotCertifiedError, match="decay"):
            certify_design(plant, gain, decay=decay)


def test_a_gain_that_does_not_stabilise_is_refuted():
    plant = example_plant()
    with pytest.raises(UnstableGainError, match="does not stabilise"):
        certify_design(plant, -solve_riccati(plant).gain)


def test_impossible_claims_are_refused():
    plant, gain = example_plant(), solve_riccati(example_plant()).gain
    for gamma in (0.0, -1.0, 1e-9):
        with pytest.raises(NotCertifiedError, match="gamma"):
            certify_design(plant, gain, gamma=gamma)
    for floor in (0.0, -1.0, 1e9):
        with pytest.raises(NotCertifiedError, match="floor"):
            certify_design(plant, gain, floor=floor)


def test_without_weight_no_norm_is_claimed():
    plant = plant_from_mapping({"time": "discrete", "A": 2, "C": 1, "W": 1, "V": 1, "M": 0})
    assert certify_design(plant, np.array([[1.5]])).norm is None
    assert certify_design(plant, np.array([[1.5]]), gamma=0.125).norm.gamma == Fraction(1, 8)


def test_noise_that_leaves_every_slow_mode_alone_has_no_floor():
    plant = plant_from_mapping(
        {"time": "continuous", "A": [[-1, 1], [0, -2]], "C": [[1, 1]], "W": [[0, 0], [0, 0]], "V": 1}
    )
    with pytest.raises(NotCertifiedError, match="floor"):
        certify_design(plant, np.zeros((2, 1)), floor=1e-6)


def test_what_the_verifier_rejects_is_not_returned(monkeypatch):
    plant, gain = example_plant(), solve_riccati(example_plant()).gain
    certificate = certify_design(plant, gain)
    worse = Norm(certificate.norm.gamma / 2, certificate.norm.P)
    monkeypatch.setattr(module, "certified_norm", lambda cost, asked: worse)
    with pytest.raises(NotCertifiedError, match="PMP"):
        certify_design(plant, gain)


@pytest.mark.parametrize("time", TIMES)
def test_a_norm_that_no_gain_reaches_is_proved_to_be_so(time):
    plant = random_plant(3, time, 3, 1, 5)
    optimum = best_floor(plant)
    for share in (0.1, 0.9, 0.9999):
        found = certify_infeasible(plant, gamma=share * optimum)
        assert found.specification == "gamma"
        assert Fraction(share * optimum) < found.bound < Fraction(optimum * (1 + 1e-6))
        assert found.reason.startswith("every stabilising gain has an H-infinity norm of at least ")
    with pytest.raises(NotCertifiedError, match="no proof"):
        certify_infeasible(plant, gamma=optimum * (1 + 1e-4))


@pytest.mark.parametrize(("time", "rate"), [("continuous", 0.5), ("discrete", log(2) / 0.25)])
def test_a_decay_that_an_unseen_mode_prevents_is_proved_to_be_so(time, rate):
    period = {"dt": 0.25} if time == "discrete" else {}
    T = np.array([[1.0, 2.0], [0.0, 1.0]])
    A = T @ np.diag([-0.5 if time == "continuous" else 0.5, 3.0]) @ np.linalg.inv(T)
    plant = of(time, A, np.array([[0, 1]]) @ np.linalg.inv(T), np.eye(2), 1, **period)
    for share in (1 + 1e-6, 2.0, 100.0):
        found = certify_infeasible(plant, decay=rate * share)
        assert found.specification == "decay"
        assert float(found.bound) == pytest.approx(-0.5 if time == "continuous" else 0.5, rel=1e-6)
    for share in (0.5, 1.0, 1 - 1e-9):
        with pytest.raises(NotCertifiedError, match="no proof"):
            certify_infeasible(plant, decay=rate * share)


def test_a_norm_out_of_reach_says_when_the_noise_was_enlarged():
    W = [[1.0, 1.0], [1.0, 1.0 - 2.0**-53]]
    plant = of("continuous", [[0.5, 1.0], [-0.25, 0.75]], [[1.0, 0.0]], W, 0.5)
    assert certify_infeasible(plant, gamma=0.1).reason.endswith(", with noise and weight enlarged to be semidefinite")


def test_requests_that_fail_together_only_have_no_proof():
    plant = of("continuous", [[0, 1], [0, 0]], [[1, 0]], np.eye(2), 1)
    with pytest.raises(NotCertifiedError, match=r"gamma 100, decay 50: no proof"):
        certify_infeasible(plant, gamma=100.0, decay=50.0)
