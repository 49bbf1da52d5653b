"""Simulated errors: intervals that hold the truth as often as they say, and miss what is not the truth."""

from dataclasses import replace

import numpy as np
import pytest

from derive.numeric import simulation
from derive.numeric.lyapunov import error_covariance
from derive.numeric.plant import example_plant
from derive.numeric.riccati import solve_riccati
from derive.numeric.simulation import Estimate, error_paths, simulate_error
from tests.derive.numeric.plants import EDGES, STRONG, continuous, discrete, random_plant

TIMES = ("continuous", "discrete")


@pytest.fixture
def short(monkeypatch):
    """Few numbers, so that many samples take little time."""
    monkeypatch.setattr(simulation, "NUMBERS", 60_000)
    monkeypatch.setattr(simulation, "RUNS", (64, 64))


def standard_scores(plant, seeds):
    """Return how many standard deviations each variance and tr(M P) are off the truth, for each seed."""
    known = solve_riccati(plant)
    truth = [*np.diag(known.P), np.trace(plant.M @ known.P)]
    samples = [simulate_error(plant, known.gain, seed).sample for seed in seeds]
    return np.array(
        [
            [(x.value - y) / x.deviation for x, y in zip((*s.variances, s.cost), truth, strict=True)]
            for s in samples
        ]
    )  # fmt: skip


@pytest.mark.parametrize("n", [1, 3, 6])
@pytest.mark.parametrize("time", TIMES)
def test_the_intervals_hold_the_covariance_of_the_optimal_gain(time, n):
    plant = random_plant(time, n)
    known = solve_riccati(plant)
    sample = simulate_error(plant, known.gain).sample
    for estimate, truth in (*zip(sample.variances, np.diag(known.P), strict=True), (sample.trace, np.trace(known.P))):
        lower, upper = estimate.interval
        assert lower < truth < upper
        assert estimate.half_width < 0.1 * truth
    np.testing.assert_allclose(sample.P, known.P, atol=0.1 * np.trace(known.P))


@pytest.mark.parametrize("time", TIMES)
def test_the_scores_of_many_seeds_are_those_of_a_standard_normal_number(time, short):
    scores = standard_scores(random_plant(time, 2), range(60))
    assert 0.8 < np.sqrt(np.mean(scores**2)) < 1.25
    assert abs(scores.mean()) < 0.45


@pytest.mark.parametrize("factor", [0.7, 0.9, 1.1, 1.3])
@pytest.mark.parametrize("time", TIMES)
def test_a_wrong_covariance_is_outside(time, factor):
    plant = random_plant(time, 4)
    known = solve_riccati(plant)
    trace = simulate_error(plant, known.gain).sample.trace
    lower, upper = trace.interval
    assert not lower < factor * np.trace(known.P) < upper
    assert abs(trace.value - factor * np.trace(known.P)) > 6 * trace.deviation


@pytest.mark.parametrize("time", TIMES)
def test_any_stable_gain_has_its_own_covariance(time):
    plant = random_plant(time, 3)
    gain = 1.4 * solve_riccati(plant).gain
    truth = error_covariance(plant.A, plant.C, plant.W, plant.V, plant.N, gain, time)
    lower, upper = simulate_error(plant, gain).sample.trace.interval
    assert lower < np.trace(truth) < upper


def test_the_cross_term_is_simulated(short):
    plant = EDGES["cross term of two outputs"]
    without = replace(plant, N=0 * plant.N)
    gain = solve_riccati(plant).gain
    with_cross, uncorrelated = (simulate_error(p, gain).sample.trace.value for p in (plant, without))
    assert abs(with_cross - uncorrelated) > 0.1 * with_cross


@pytest.mark.parametrize("time", TIMES)
def test_units_change_nothing_but_units(time, short):
    plant = random_plant(time, 3)
    units = np.array([2.0**30, 1.0, 2.0**-30])
    other = replace(
        plant,
        A=plant.A * units[:, None] / units,
        C=plant.C / units,
        W=plant.W * np.outer(units, units),
        N=plant.N * units[:, None],
        M=plant.M / np.outer(units, units),
    )
    first, second = (simulate_error(p, solve_riccati(p).gain).sample for p in (plant, other))
    np.testing.assert_allclose(second.P / np.outer(units, units), first.P, rtol=1e-8, atol=1e-9)
    assert second.cost.value == pytest.approx(first.cost.value, rel=1e-8)
    assert second.cost.deviation == pytest.approx(first.cost.deviation, rel=1e-8)


def test_the_same_seed_gives_the_same_sample(short):
    plant, gain = example_plant(), solve_riccati(example_plant()).gain
    first, again, other = (simulate_error(plant, gain, *seed).sample for seed in ((), (), (7,)))
    np.testing.assert_array_equal(first.P, again.P)
    assert first.running == again.running
    assert first.trace != other.trace


def test_more_runs_narrow_the_interval():
    plant = random_plant("discrete", 2)
    running = simulate_error(plant, solve_riccati(plant).gain).sample.running
    counts = [count for count, _ in running]
    assert counts == sorted(counts)
    assert counts[0] == 8
    assert running[-1][1].half_width < 0.2 * running[0][1].half_width


@pytest.mark.parametrize(
    ("plant", "reason"),
    [
        (STRONG["constant"][0], "mode 1 of A - L C does not decay"),
        (STRONG["oscillator without noise"][0], "mode 1j of A - L C does not decay"),
        (
            EDGES["almost on the boundary, stable"],
            "slowest time constant 1e+09 s (mode -1e-09), 1e+09 times the fastest",
        ),
        (EDGES["almost on the circle"], "slowest time constant 1e+09 steps (mode 1); up to 300 are simulated"),
    ],
)
def test_what_does_not_settle_is_not_simulated_and_named(plant, reason):
    gain = solve_riccati(plant).gain
    found = simulate_error(plant, gain)
    assert found.sample is None
    assert found.status.startswith(f"not applicable: {reason}")
    assert error_paths(plant, gain, np.ones(plant.n)) is None


@pytest.mark.parametrize("gain", [[[np.nan]], [[-5.0]]])
def test_a_gain_that_does_not_stabilise_has_no_sample(gain):
    assert simulate_error(continuous(A=1, C=1, W=1, V=1), np.array(gain)).sample is None


def test_without_noise_there_is_no_error():
    plant = discrete(A=0.5, C=1, Q=0, R=1)
    sample = simulate_error(plant, np.zeros((1, 1))).sample
    assert sample.trace == Estimate(0.0, 0.0, 0.0, 0.0)


def test_what_the_start_leaves_out_widens_the_interval(monkeypatch):
    monkeypatch.setattr(simulation, "SKIPPED", 1)
    plant = EDGES["unstable Jordan block"]
    known = solve_riccati(plant)
    trace = simulate_error(plant, known.gain).sample.trace
    assert trace.bias > 0.1 * trace.value
    assert trace.interval[1] == trace.value + trace.half_width + trace.bias


@pytest.mark.parametrize("time", TIMES)
def test_paths_stay_within_three_standard_deviations(time):
    plant = random_plant(time, 3)
    known = solve_riccati(plant)
    deviations = np.sqrt(np.diag(known.P))
    paths = error_paths(plant, known.gain, deviations)
    assert paths.errors.shape == (4, len(paths.times), 3)
    np.testing.assert_array_equal(paths.errors[:, 0], 0)
    assert 0.99 < paths.inside < 1.0
    assert error_paths(plant, known.gain, deviations / 2).inside < 0.95


def test_time_is_in_seconds_where_the_plant_gives_the_period():
    plant = discrete(A=0.5, C=1, Q=1, R=1, dt=0.25)
    paths = error_paths(plant, solve_riccati(plant).gain, np.ones(1))
    assert paths.times[1] == 0.25
