"""Enclosures of Riccati solutions: they hold what they claim to hold, and reject what is not the stabilising one."""

import os
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from flint import arb, arb_mat
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from derive.errors import InputError
from derive.numeric.balls import (
    digits_of,
    exact,
    floats,
    identity,
    norm,
    positive_definite,
    scaled_floats,
    widened,
    working_bits,
)
from derive.numeric.doubling import stabilising_start
from derive.numeric.enclosure import enclose_riccati, encloses, verify_riccati
from derive.numeric.log_det import enclose_log_det
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import distance_to_stability, format_mode
from derive.numeric.newton import Equation, lyapunov_in_balls, prove, refined
from derive.numeric.plant import Plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from tests.benchmark.published import COLLECTIONS, published
from tests.derive.numeric import references
from tests.derive.numeric.plants import OSCILLATOR, STABILISING, STRONG, continuous, discrete, random_plant

TIMES = ["continuous", "discrete"]
HIGH = 300  # bits at which references are read


def holds(claimed, truth):
    with working_bits(HIGH):
        return all(x.overlaps(y) for x, y in zip(claimed.entries(), truth.entries(), strict=True))


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("cross", [False, True])
def test_holds_a_reference_of_seventy_digits(time, n, cross):
    plant = random_plant(time, n, seed=n, cross=cross)
    with working_bits(HIGH):
        truth = references.reference(plant, solve_riccati(plant).P)
        product = sum((x * y for x, y in zip(exact(plant.M).entries(), truth.entries(), strict=True)), arb(0))
    enclosure = enclose_riccati(plant, digits=60)
    assert (enclosure.status, enclosure.reason) == ("verified", "")
    assert enclosure.digits >= 60
    assert holds(enclosure.P, truth)
    with working_bits(HIGH):
        assert enclosure.trace.overlaps(truth.trace())
        assert enclosure.cost.overlaps(product)
        size = float(norm(truth))
    assert enclosure.radius <= 1e-58 * size


@pytest.mark.parametrize(("w", "v"), [(1, 1), (3, 5), (1000000, 7)])
def test_double_integrator(w, v):
    enclosure = enclose_riccati(continuous(A=[[0, 1], [0, 0]], C=[[1, 0]], W=np.diag([0, w]), V=v), digits=50)
    with working_bits(HIGH):
        assert holds(enclosure.P, references.double_integrator(w, v))
    assert enclosure.digits >= 50


@pytest.mark.parametrize("damping", [0.7, 1e-3, 1e-6])
def test_damped_oscillator(damping):
    plant = continuous(A=[[0, 1], [-4, -4 * damping]], C=[[1, 0]], W=np.diag([0, 3]), V=0.5)
    enclosure = enclose_riccati(plant, digits=50)
    with working_bits(HIGH):
        assert holds(enclosure.P, references.damped_oscillator(4, 4 * damping, 3, 0.5))


@pytest.mark.parametrize("A", [-2.0, 0.0, 0.3, 2.0])
def test_scalars(A):
    for plant, truth in (
        (continuous(A=A, C=3, W=0.7, V=0.1), references.scalar_continuous),
        (discrete(A=A, C=3, Q=0.7, R=0.1), references.scalar_discrete),
    ):
        enclosure = enclose_riccati(plant, digits=50)
        with working_bits(HIGH):
            assert enclosure.trace.overlaps(truth(A, 3, 0.7, 0.1))
        assert enclosure.digits >= 50


@pytest.mark.parametrize(("plant", "P"), STABILISING.values(), ids=STABILISING)
def test_degenerate_plants_with_a_stabilising_solution(plant, P):
    enclosure = enclose_riccati(plant)
    assert enclosure.status == "verified"
    np.testing.assert_allclose(enclosure.centre, P, rtol=1e-15)


@pytest.mark.parametrize(("plant", "P", "modes"), STRONG.values(), ids=STRONG)
def test_the_boundary_is_refused_by_name(plant, P, modes):
    enclosure = enclose_riccati(plant)
    assert (enclosure.status, enclosure.P, enclosure.digits) == ("boundary", None, 0)
    assert all(format_mode(mode) in enclosure.reason for mode in modes)
    assert np.isnan(enclosure.centre).all()
    assert not enclosure.trace.is_finite()


def test_a_closed_loop_on_the_boundary_is_named():
    """CAREX 2.5 (J. Abels and P. Benner, 1999): an indefinite W that puts the closed loop at j and -j."""
    plant = Plant(time="continuous", A=np.array([[3.0, 4.0], [1.0, 2.0]]), C=np.ones((1, 2)),
                  W=-np.array([[11.0, 5.0], [5.0, 2.0]]), V=np.eye(1), N=np.zeros((2, 1)), M=np.eye(2))  # fmt: skip
    enclosure = enclose_riccati(plant)
    assert (enclosure.status, enclosure.P) == ("boundary", None)
    assert "1j on the boundary or too near to tell" in enclosure.reason


@pytest.mark.parametrize("noise", [1e-12, 1e-24])
def test_slow_closed_loops_are_no_boundary(noise):
    enclosure = enclose_riccati(continuous(A=0, C=1, W=noise, V=1))
    assert enclosure.status == "verified"
    with working_bits(HIGH):
        assert enclosure.trace.overlaps(arb(noise).sqrt())


@pytest.mark.parametrize("time", TIMES)
def test_the_radius_shrinks_with_the_precision(time):
    plant = random_plant(time, 6, 2, seed=4)
    found = [enclose_riccati(plant, digits) for digits in (10, 30, 60, 120)]
    for wide, narrow in pairwise(found):
        assert narrow.radius < 1e-10 * wide.radius
        assert wide.P.contains(narrow.P)
    assert [e.digits >= d for e, d in zip(found, (10, 30, 60, 120), strict=True)] == [True] * 4


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.lists(st.integers(-3, 3), min_size=11, max_size=11), st.sampled_from(TIMES))
def test_small_integer_plants_are_enclosed_or_refused(numbers, time):
    A, G, C = np.reshape(numbers[:4], (2, 2)), np.reshape(numbers[4:8], (2, 2)), np.reshape(numbers[8:10], (1, 2))
    try:
        plant = plant_from_mapping({"time": time, "A": A, "C": C, "W": G @ G.T, "V": 1 + abs(numbers[10])})
    except InputError:
        assume(False)
    solution, spectrum = enclose_riccati(plant), enclose_log_det(plant)
    assert spectrum.status == "verified"
    assert solution.status in ("verified", "boundary")
    assert (solution.reason == "") == (solution.status == "verified")
    if solution.status == "verified":
        assert solution.output_cost.overlaps(spectrum.value)


@pytest.mark.parametrize("time", TIMES)
def test_rejects_a_perturbed_solution_and_a_radius_too_small(time):
    plant = random_plant(time, 4, 2, seed=5)
    truth = enclose_riccati(plant, digits=40)
    with working_bits(HIGH):
        off = exact(truth.centre * (1 + 1e-9))
        assert encloses(plant, widened(off, arb(1e-6)))
        assert not encloses(plant, widened(off, arb(1e-12)))
        assert not encloses(plant, truth.P.mid())
        assert not encloses(plant, exact(np.eye(3)))
        assert encloses(plant, widened(truth.P.mid(), arb(1e-20)))


@pytest.mark.parametrize("time", TIMES)
def test_what_is_verified_reaches_the_truth(time):
    plant = random_plant(time, 4, 2, seed=6)
    truth = enclose_riccati(plant, digits=40)
    for size in (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 100.0):
        found = verify_riccati(plant, truth.centre + size * np.eye(4))
        if found.status == "verified":
            assert found.radius >= size * (1 - 1e-6)
            assert found.P.contains(truth.P)
    assert verify_riccati(plant, truth.centre + 1e-9 * np.eye(4)).status == "verified"
    assert verify_riccati(plant, truth.centre + 100 * np.eye(4)).status == "open"


@pytest.mark.parametrize("time", TIMES)
def test_rejects_the_solution_of_another_plant(time):
    plant = random_plant(time, 4, 2, seed=7)
    other = replace(plant, W=plant.W + 1e-9 * np.eye(4))
    theirs = enclose_riccati(other).P
    assert encloses(other, theirs.mid() + widened(arb_mat(4, 4), arb(1e-15)))
    assert not encloses(plant, theirs.mid() + widened(arb_mat(4, 4), arb(1e-15)))


def test_rejects_roots_that_do_not_stabilise():
    for plant in (continuous(A=1, C=1, W=0, V=1), discrete(A=2, C=1, Q=0, R=1)):
        refused = verify_riccati(plant, np.zeros((1, 1)))
        assert (refused.status, refused.P) == ("open", None)
        assert "closed loop: expected stable" in refused.reason
    mixed = continuous(A=np.diag([1.0, 2.0]), C=np.eye(2), W=np.zeros((2, 2)), V=np.eye(2))
    for root, status in (([2, 4], "verified"), ([2, 0], "open"), ([0, 4], "open"), ([0, 0], "open")):
        assert verify_riccati(mixed, np.diag(root)).status == status


def test_refuses_a_ball_that_is_too_large_to_close():
    """With A = 0 the loop is 0 everywhere, so that only the size of the remainder can refuse: 2 k g rho = 0.8 > 0.6."""
    refused = verify_riccati(discrete(A=0, C=1, Q=5, R=1), np.array([[4.0]]))
    assert (refused.status, refused.reason[:5]) == ("open", "ball:")
    assert verify_riccati(discrete(A=0, C=1, Q=5, R=1), np.array([[4.9]])).P.contains(arb_mat([[5]]))


def test_the_closed_loop_is_proved_stable_all_over_a_discrete_ball():
    """A far from normal: a ball may be closed in which the witness no longer serves."""
    plant = discrete(A=[[0, 9], [0, 0.5]], C=[[0, 1]], Q=np.eye(2), R=1)
    truth = enclose_riccati(plant).centre
    reasons = {verify_riccati(plant, truth + size * np.eye(2)).reason[:40] for size in np.geomspace(1e-9, 1, 80)}
    assert "closed loop: expected stable all over th" in reasons
    assert "" in reasons


def test_rejects_a_plant_without_solution():
    hidden = Plant(time="continuous", A=np.eye(1), C=np.zeros((1, 1)), W=np.eye(1), V=np.eye(1), N=np.zeros((1, 1)),
                   M=np.eye(1))  # fmt: skip
    assert enclose_riccati(hidden).status == "open"
    assert "detectable" in enclose_riccati(hidden).reason


def test_rejects_indefinite_measurement_noise():
    plant = continuous(A=-1, C=1, W=1, V=1)
    with working_bits(128):
        equation = replace(Equation.of(plant), V=arb_mat([[-1]]))
        assert "V: expected positive definite" in prove(equation, arb_mat([[1]])).reason


@pytest.mark.parametrize("time", TIMES)
def test_units_change_nothing_but_units(time):
    plant = random_plant(time, 4, 2, seed=8)
    x, y = 2.0 ** np.arange(-30, 30, 15), np.array([2.0**-20, 2.0**20])
    scaled = replace(plant, A=x[:, None] * plant.A / x, C=y[:, None] * plant.C / x, W=x[:, None] * plant.W * x,
                     V=y[:, None] * plant.V * y, N=x[:, None] * plant.N * y)  # fmt: skip
    ours, theirs = enclose_riccati(plant), enclose_riccati(scaled)
    back = exact(np.diag(1 / x)) * theirs.P * exact(np.diag(1 / x))
    assert back.overlaps(ours.P)
    assert theirs.output_cost.overlaps(ours.output_cost)
    assert theirs.digits >= 30


@pytest.mark.parametrize("time", TIMES)
def test_lyapunov_solutions_in_balls(time):
    rng = np.random.default_rng(0)
    loop = rng.standard_normal((5, 5)) / 4 - (np.eye(5) if time == "continuous" else 0)
    with working_bits(200):
        X = lyapunov_in_balls(exact(loop), identity(5), time)
        equation = Equation.of(random_plant(time, 5))
        defect = norm(equation.derivative(exact(loop), X) + identity(5))
        assert defect < 1e-50
    np.testing.assert_allclose(floats(X), solve_lyapunov(loop, np.eye(5), time), rtol=1e-12)


@pytest.mark.parametrize("time", TIMES)
def test_newton_in_balls_needs_no_double_precision(time):
    plant = random_plant(time, 4, 2, seed=9)
    start = solve_riccati(plant).P * (1 + 1e-4)
    with working_bits(256):
        equation = Equation.of(plant)
        P = refined(equation, equation.scaled(start), in_balls=True)
        assert prove(equation, P).radius < 1e-60


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("kind", ["random", "without noise", "defective"])
def test_doubling_solves_the_equation_with_a_little_more_noise(time, kind):
    """R(P) = -e I, e small but not 0, and the closed loop is stable, whatever the noise excites."""
    plant = random_plant(time, 4, 2, seed=3)
    if kind != "random":
        plant = replace(plant, W=np.zeros((4, 4)), N=np.zeros((4, 2)))
    if kind == "defective":
        plant = replace(plant, A=1.5 * np.eye(4) + np.eye(4, k=1), C=np.eye(2, 4))
    with working_bits(256):
        equation = Equation.of(plant)
        P = stabilising_start(equation)
        residual = equation.residual(P)
        e = -residual[0, 0].mid()
        assert e > 0
        assert norm(residual + identity(4) * e) < 1e-30 * e
        loop = np.linalg.eigvals(floats(equation.closed_loop(P)))
    assert distance_to_stability(loop, time).max() < 0


def test_helpers():
    with working_bits(128):
        G = np.random.default_rng(1).standard_normal((4, 4))
        assert positive_definite(exact(G @ G.T + 0.01 * np.eye(4)))
        assert not positive_definite(exact(G @ G.T - 30 * np.eye(4)))
        assert not positive_definite(widened(identity(4), arb(2)))
        assert norm(exact(G)) >= np.linalg.norm(G, 2) * (1 - 1e-12)
        assert norm(exact(G)) <= np.linalg.norm(G) * (1 + 1e-12)
        tiny, e = scaled_floats(exact(G) * arb(2) ** -2000)
        np.testing.assert_array_equal(tiny * 2.0 ** (e + 2000), G)
        assert digits_of(arb(1e-12), arb(1)) in (11, 12)
        assert digits_of(arb(10), arb(1)) == 0
        assert digits_of(arb("nan"), arb(1)) == 0
        assert digits_of(arb(0), arb(1)) == 38
    with working_bits(2000):
        assert digits_of(arb(1) / 7, arb(10) ** 400) == 400


@pytest.mark.skipif("DERIVE_BENCH" not in os.environ, reason="set DERIVE_BENCH to a folder of CAREX and DAREX archives")
@pytest.mark.parametrize("collection", COLLECTIONS)
def test_published_collections(collection):
    for example in published(collection):
        if example.truth is None or example.plant.n > 40 or np.linalg.eigvalsh(example.plant.V)[0] < 1e-14:
            continue
        enclosure = enclose_riccati(example.plant, digits=20)
        P = enclosure.P
        assert P is not None, example.name
        with working_bits(HIGH):
            distance = norm(P.mid() - exact(example.truth) - exact(example.rest))
            assert distance <= enclosure.radius + 1e-30 * norm(P.mid()), example.name


@pytest.mark.parametrize("time", TIMES)
def test_the_gain_and_the_distance_of_any_matrix(time):
    plant = random_plant(time, 4, 2, seed=3)
    enclosure = enclose_riccati(plant)
    P = references.reference(plant, enclosure.centre)
    A, C, V, N = (exact(X) for X in (plant.A, plant.C, plant.V, plant.N))
    with working_bits(HIGH):
        PC, S = P * C.transpose(), V if time == "continuous" else C * P * C.transpose() + V
        L = ((PC if time == "continuous" else A * PC) + N) * S.inv()
        assert all(ours.overlaps(true) for ours, true in zip(enclosure.gain.entries(), L.entries(), strict=True))
    moved = enclosure.centre + 1e-3 * np.eye(4)
    assert enclosure.distance(moved) == pytest.approx(2e-3, rel=1e-9)
    assert enclosure.solution.condition > 1
    assert verify_riccati(plant, moved + 1e9).distance(moved) == np.inf


def test_oscillator_with_weak_noise():
    enclosure = enclose_riccati(continuous(A=OSCILLATOR, C=[[1, 0]], W=np.diag([0, 1e-12]), V=1))
    with working_bits(HIGH):
        assert holds(enclosure.P, references.damped_oscillator(1, 0, 1e-12, 1))
