"""Designs against closed forms, the filtering Riccati equation and SciPy; bounds against both; what cannot be met."""

from dataclasses import replace
from fractions import Fraction

import cvxpy as cp
import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

import lmi
import lmi.certification.design as making
from derive.errors import InputError
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.certificate.design import verify_design
from lmi.certification.sandwich import NotCertifiedError
from lmi.programs.decay import decay
from lmi.programs.h2 import cost_bound
from lmi.programs.hinf import hinf
from lmi.programs.observer import Unknowns
from lmi.residual import gain_covariance
from lmi.synthesis.achieved import achieved
from lmi.synthesis.designs import Verdict, design
from lmi.synthesis.gain import COORDINATES, Synthesis
from lmi.synthesis.proof import certify
from lmi.synthesis.request import Request
from lmi.synthesis.riccati import central_gain, smallest_level
from lmi.synthesis.search import Judged, smallest_norm
from lmi.synthesis.shift import shifted

TIMES = ("continuous", "discrete")
HIDDEN = {"A": np.diag([1.2, 0.5]), "C": [[1, 0]], "W": np.eye(2), "V": 1.0}
"""A plant whose second mode no output sees; it is stable in discrete time."""


def proved(found):
    """Return what the certificate of a design proves, decided anew."""
    assert found.certificate is not None, found.reason
    bounds = verify_design(found.certificate)[1]
    assert bounds is not None
    return bounds


def smallest_by_hand(time, A, C, W, V, N, M):
    """Return the infimum over L of the norm of a plant with one state, worked out by calculus.

    With k = L - N/V the noise is w + V k^2, w = W - N^2/V, and the loop f - C k, f = A - C N/V, peaks at frequency 0 or
    pi: the squared norm is M (w + V k^2) / (C k - f)^2, in discrete time M (w + V k^2) / (1 - |f - C k|)^2.
    """
    w, f = W - N * N / V, A - C * N / V
    if time == "continuous":
        return np.sqrt(M / (C * C / V + f * f / w) if f < 0 else M * V / C**2)
    size = abs(f)
    loop = max(size - w * C * C / (V * (1 - size)), 0.0) if size < 1 else 0.0
    return np.sqrt(M * (w + V * (size - loop) ** 2 / C**2)) / (1 - loop)


@pytest.mark.parametrize("A", [-0.7, 0.4, 1.5])
@pytest.mark.parametrize("time", TIMES)
def test_smallest_norm_of_one_state_is_the_one_worked_out_by_hand(time, A):
    numbers = {"A": A, "C": 2.0, "W": 3.0, "V": 0.5, "N": 0.3, "M": 1.7}
    found = design({"time": time, **numbers}, "hinf")
    expected = smallest_by_hand(time, **numbers)
    bounds = proved(found)
    assert found.verdict is Verdict.CERTIFIED
    assert float(bounds.floor_squared) ** 0.5 <= expected * (1 + 1e-12)
    assert expected <= float(bounds.gamma) <= expected * (1 + 1e-4)
    assert float(bounds.gamma) ** 2 <= float(bounds.floor_squared) * (1 + 1e-4) ** 2


@pytest.mark.parametrize("n", [2, 3, 5])
@pytest.mark.parametrize("time", TIMES)
def test_smallest_norm_is_certified_and_that_of_the_riccati_equation(time, n, random_plant):
    plant = random_plant(time, n, seed=1)
    found = design(plant, "hinf")
    level = smallest_level(plant, 2 * found.achieved.hinf.upper)
    bounds = proved(found)
    assert found.verdict is Verdict.CERTIFIED
    assert found.achieved.hinf.lower <= float(bounds.gamma)
    assert float(bounds.floor_squared) ** 0.5 <= level <= float(bounds.gamma) <= level * (1 + 1e-4)


@pytest.mark.parametrize("time", TIMES)
def test_the_program_has_the_level_of_the_riccati_equation_and_its_central_gain(time, random_plant):
    plant = random_plant(time, 4, seed=2)
    synthesis = Synthesis.of(plant, None, *COORDINATES[0])
    level = synthesis.smallest_level()
    assert smallest_level(plant, 2 * level) == pytest.approx(level, rel=1e-5)
    expected = central_gain(plant, 1.2 * level)
    np.testing.assert_allclose(
        synthesis.gain_within(1.2 * level), expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max()
    )


@pytest.mark.parametrize("time", TIMES)
def test_a_level_has_a_central_gain_just_when_it_is_above_the_smallest(time, random_plant):
    plant = random_plant(time, 3, seed=4)
    level = smallest_level(plant, 100.0)
    assert central_gain(plant, level * (1 - 1e-6)) is None
    assert smallest_level(plant, level * (1 - 1e-6)) is None
    for above in (1.0001, 1.3, 10.0):
        assert achieved(plant, central_gain(plant, above * level)).hinf.upper < above * level


def test_no_gain_tried_has_a_norm_below_the_floor(random_plant):
    plant = random_plant("discrete", 3, seed=1)
    found = design(plant, "hinf")
    floor = float(proved(found).floor_squared) ** 0.5
    rng = np.random.default_rng(0)
    for size in (1e-3, 1e-2, 1e-1):
        for _ in range(20):
            other = achieved(plant, found.gain + size * rng.standard_normal(found.gain.shape))
            assert other is None or other.hinf.lower >= floor


DEGENERATE = {
    "weight of one state": {"M": np.diag([1.0, 0.0, 0.0])},
    "one noise for all": {"W": np.outer([1, 2, 3], [1, 2, 3]), "N": 0.5 * np.array([[1], [2], [3]]), "V": 0.5},
    "unstable": {"A": [[0.5, 1, 0], [0, 1.3, 1], [0, 0, -0.4]]},
}


@pytest.mark.parametrize("change", DEGENERATE.values(), ids=DEGENERATE.keys())
@pytest.mark.parametrize("time", TIMES)
def test_singular_weights_and_noises_are_certified(time, change):
    plain = {"A": [[0.4, 1, 0], [-0.5, 0.2, 1], [0, 0, -0.4]], "C": [[1, 0, 0]], "W": np.diag([0, 1, 0.5]), "V": 0.3}
    found = design({"time": time, **plain, **change}, "hinf")
    bounds = proved(found)
    assert found.verdict is Verdict.CERTIFIED
    assert float(bounds.gamma**2 / bounds.floor_squared) <= (1 + 1e-4) ** 2


@pytest.mark.parametrize("time", TIMES)
def test_the_gain_of_least_cost_is_that_of_the_riccati_equation(time, random_plant):
    for n in (1, 4, 7):
        plant = random_plant(time, n, seed=3)
        found, expected = design(plant), solve_riccati(plant)
        assert found.verdict is Verdict.CERTIFIED
        np.testing.assert_allclose(found.gain, expected.gain, rtol=1e-8, atol=1e-9 * np.abs(expected.gain).max())
        cost = float(np.trace(plant.M @ expected.P))
        assert found.achieved.cost == pytest.approx(cost, rel=1e-10)
        assert found.achieved.h2 == pytest.approx(np.sqrt(cost), rel=1e-10)
        bounds = proved(found).cost.cost
        assert float(bounds.lower) * (1 - 1e-10) <= cost <= float(bounds.upper) * (1 + 1e-10)
        assert bounds.width <= Fraction(1, 10**12) * bounds.upper


@pytest.mark.parametrize("time", TIMES)
def test_a_level_asked_for_is_reached_at_less_cost_than_the_smallest(time, random_plant):
    plant = random_plant(time, 3, seed=1)
    smallest, cheapest = design(plant, "hinf"), design(plant)
    gamma = np.sqrt(smallest.achieved.hinf.upper * cheapest.achieved.hinf.upper)
    between = design(plant, "hinf", gamma=gamma)
    assert between.verdict is Verdict.CERTIFIED
    assert proved(between).gamma <= Fraction(gamma)
    assert cheapest.achieved.cost <= between.achieved.cost <= smallest.achieved.cost
    loose = design(plant, "hinf", gamma=2 * cheapest.achieved.hinf.upper)
    np.testing.assert_array_equal(loose.gain, cheapest.gain)


@pytest.mark.parametrize("objective", ["h2", "hinf"])
@pytest.mark.parametrize("time", TIMES)
def test_every_mode_has_the_decay_asked_for(time, objective, random_plant):
    plant = replace(random_plant(time, 3, seed=1), dt=None if time == "continuous" else 0.5)
    free = design(plant, objective)
    asked = 1.5 * free.achieved.decay
    found = design(plant, objective, decay=asked)
    assert found.verdict is Verdict.CERTIFIED
    modes = np.linalg.eigvals(plant.A - found.gain @ plant.C)
    if time == "continuous":
        assert modes.real.max() <= -asked
        assert proved(found).decay >= Fraction(asked)
    else:
        assert np.abs(modes).max() <= np.exp(-0.5 * asked)
        assert float(proved(found).decay) <= np.exp(-0.5 * asked)
    if objective == "h2":
        assert free.achieved.cost <= found.achieved.cost
    else:
        assert free.achieved.hinf.lower <= found.achieved.hinf.upper


@pytest.mark.parametrize("time", TIMES)
def test_a_program_gives_the_decay_asked_for_and_little_more(time, random_plant):
    plant = replace(random_plant(time, 3, seed=1), dt=None if time == "continuous" else 0.5)
    optimal = achieved(plant, solve_riccati(plant).gain)
    asked = 1.5 * optimal.decay
    synthesis = Synthesis.of(plant, asked, *COORDINATES[0])
    for gain in (synthesis.cheapest_gain(), synthesis.gain_within(3 * optimal.hinf.upper)):
        found = achieved(plant, gain)
        assert asked <= found.decay <= 1.8 * asked
        assert found.hinf.upper <= 3 * optimal.hinf.upper


@pytest.mark.parametrize("time", TIMES)
def test_a_gain_is_moved_towards_the_best_one_as_far_as_its_decay_allows(time, random_plant):
    plant = random_plant(time, 2, seed=1)
    optimal = achieved(plant, solve_riccati(plant).gain)
    asked = 1.5 * optimal.decay
    program = achieved(plant, Synthesis.of(plant, asked, *COORDINATES[0]).cheapest_gain())
    found = design(plant, decay=asked)
    assert asked <= found.achieved.decay <= 1.01 * asked < program.decay
    assert optimal.cost < found.achieved.cost < program.cost


def test_a_decay_that_the_best_gain_has_changes_nothing(random_plant):
    plant = random_plant("continuous", 3, seed=1)
    for objective in ("h2", "hinf"):
        free = design(plant, objective)
        np.testing.assert_array_equal(design(plant, objective, decay=free.achieved.decay / 2).gain, free.gain)


@pytest.mark.parametrize("time", TIMES)
def test_what_holds_for_the_shifted_plant_holds_for_the_plant(time, random_plant):
    plant = random_plant(time, 3, seed=1)
    moved = shifted(plant, 0.3)
    gain = solve_riccati(moved).gain
    ours, theirs = achieved(plant, gain), achieved(moved, gain)
    assert ours.decay > 0.3
    assert ours.cost <= theirs.cost
    assert ours.hinf.lower <= theirs.hinf.upper


@pytest.mark.parametrize("time", TIMES)
def test_specifications_hold_for_the_matrices_that_satisfy_them(time, random_plant):
    plant = random_plant(time, 3, seed=5)
    gamma = 3 * smallest_level(plant, 100.0)
    asked = 1.5 * achieved(plant, solve_riccati(plant).gain).decay
    rate = asked if time == "continuous" else np.exp(-asked)
    unknowns = Unknowns.of(plant)
    constraints = [*hinf(gamma**2)(unknowns), *decay(rate)(unknowns)]
    cost, bound = cost_bound(unknowns, plant.M)
    problem = cp.Problem(cp.Minimize(cost), [*constraints, *bound])
    problem.solve(solver=cp.CLARABEL)
    covariance, gain = unknowns.answer()
    found = achieved(plant, gain)
    assert found.hinf.lower <= gamma * (1 + 1e-5)
    assert asked * (1 - 1e-4) <= found.decay <= 1.5 * asked
    assert np.linalg.eigvalsh(covariance - gain_covariance(plant, gain))[0] >= -1e-5 * np.linalg.norm(covariance)


@pytest.mark.parametrize("time", TIMES)
def test_values_do_not_depend_on_units(time, random_plant):
    plant = random_plant(time, 5, seed=1)
    gain = solve_riccati(plant).gain
    rng = np.random.default_rng(1)
    s, r = 2.0 ** rng.integers(-30, 31, plant.n), 2.0 ** rng.integers(-10, 11, plant.l)
    scaled = replace(
        plant,
        A=s[:, None] * plant.A / s,
        C=r[:, None] * plant.C / s,
        W=plant.W * np.outer(s, s),
        V=plant.V * np.outer(r, r),
        N=plant.N * np.outer(s, r),
        M=plant.M / np.outer(s, s),
    )
    ours, theirs = achieved(plant, gain), achieved(scaled, s[:, None] * gain / r)
    assert theirs.cost == pytest.approx(ours.cost, rel=1e-9)
    assert theirs.hinf.upper == pytest.approx(ours.hinf.upper, rel=1e-9)
    assert theirs.decay == pytest.approx(ours.decay, rel=1e-6)


# ------------------------------------------------------------------------------------------------ the dual problem
REGULATOR = {"A": [[0.5, 1.0], [2.0, -1.0]], "B": [[0.0], [1.0]], "Q": [[2.0, 0.3], [0.3, 1.0]], "R": 0.5}


@pytest.mark.parametrize("time", TIMES)
def test_dual_design_is_the_linear_quadratic_regulator(time):
    S = np.array([[0.1], [0.2]])
    A, B, Q, R = (np.array(REGULATOR[key], ndmin=2) for key in ("A", "B", "Q", "R"))
    P = (solve_continuous_are if time == "continuous" else solve_discrete_are)(A, B, Q, R, s=S)
    K = (B.T @ P + S.T) / R if time == "continuous" else np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + S.T)
    found = lmi.design({"time": time, **REGULATOR, "S": S}, dual=True)
    assert found.verdict is Verdict.CERTIFIED
    np.testing.assert_allclose(found.gain, K, rtol=1e-9)
    assert found.achieved.cost == pytest.approx(np.trace(P), rel=1e-10)


@pytest.mark.parametrize("time", TIMES)
def test_dual_design_is_the_transposed_design_of_the_transposed_plant(time):
    M = np.diag([1.0, 0.0])
    dual = design({"time": time, **REGULATOR, "M": M}, "hinf", dual=True)
    A, B = np.array(REGULATOR["A"]), np.array(REGULATOR["B"])
    own = {"time": time, "A": A.T, "C": B.T, "W": REGULATOR["Q"], "V": REGULATOR["R"], "M": M}
    found = design(own, "hinf")
    np.testing.assert_array_equal(dual.gain, found.gain.T)
    assert dual.achieved == found.achieved
    assert dual.verdict is Verdict.CERTIFIED


# ------------------------------------------------------------------------------------------------ what cannot be met
def test_a_norm_below_the_floor_is_refused_with_the_proved_floor(random_plant):
    plant = random_plant("continuous", 3, seed=1)
    smallest = design(plant, "hinf").achieved.hinf.upper
    found = design(plant, "hinf", gamma=0.99 * smallest)
    assert (found.verdict, found.gain, found.certificate) == (Verdict.INFEASIBLE, None, None)
    assert found.reason.startswith("gamma ")
    floor = float(found.reason.rpartition(" ")[2])
    assert 0.999 * smallest < floor < smallest


@pytest.mark.parametrize("time", TIMES)
def test_a_decay_that_no_gain_gives_is_refused_with_the_mode(time):
    change = {"A": np.diag([1.2, -0.5])} if time == "continuous" else {}
    plant = {"time": time, **HIDDEN, **change}
    found = design(plant, decay=0.9)
    assert (found.verdict, found.gain) == (Verdict.INFEASIBLE, None)
    mode = "-0.5" if time == "continuous" else "0.5"
    assert found.reason.startswith(f"decay 0.9 fails: mode {mode} is unobservable and stays with every gain; proved: ")
    assert design(plant, decay=0.4).verdict is Verdict.CERTIFIED


def test_what_fails_only_together_is_said_and_not_called_proved(random_plant):
    plant = random_plant("continuous", 2, seed=2)
    gamma = 1.01 * design(plant, "hinf").achieved.hinf.upper
    found = design(plant, "hinf", gamma=gamma, decay=50.0)
    assert (found.verdict, found.gain) == (Verdict.NOT_CERTIFIED, None)
    assert found.reason.startswith(f"gamma {gamma:g} and decay 50 fail together: ")
    assert found.reason.endswith("not proved")


def test_a_smallest_norm_that_is_too_large_is_not_certified_as_the_smallest(random_plant):
    plant = random_plant("continuous", 3, seed=1)
    gain = solve_riccati(plant).gain
    certificate, lacking = certify(plant, Request("hinf"), Judged(gain, achieved(plant, gain)))
    assert lacking
    bounds = verify_design(certificate)[1]
    assert bounds is not None
    assert bounds.floor_squared is None


def test_a_gain_that_misses_the_request_gets_no_certificate(random_plant):
    plant = random_plant("continuous", 3, seed=1)
    gain = solve_riccati(plant).gain
    found = achieved(plant, gain)
    with pytest.raises(NotCertifiedError):
        making.certify_design(plant, gain, gamma=found.hinf.lower * (1 - 1e-6))
    with pytest.raises(NotCertifiedError):
        making.certify_design(plant, gain, decay=found.decay * (1 + 1e-6))
    with pytest.raises(NotCertifiedError):
        making.certify_design(plant, gain, floor=smallest_norm(plant, None).norm * (1 + 1e-3))


def test_without_a_certificate_the_design_says_so(monkeypatch):
    def refused(*args, **kwargs):
        raise NotCertifiedError("too hard")

    monkeypatch.setattr(making, "certify_design", refused)
    found = design(example_plant())
    assert (found.verdict, found.reason, found.certificate) == (Verdict.NOT_CERTIFIED, "too hard", None)
    assert found.as_dict()["reason"] == "too hard"


@pytest.mark.parametrize("objective", ["h2", "hinf"])
def test_where_no_gain_is_best_the_one_found_is_not_called_best(objective):
    integrator = {"time": "continuous", "A": [[0, 1], [0, 0]], "C": [[1, 0]], "W": np.zeros((2, 2)), "V": 1.0}
    found = design(integrator, objective)
    assert found.verdict is Verdict.NOT_CERTIFIED
    assert found.achieved is not None
    assert found.reason
    assert proved(found).cost.cost.upper > 0


def test_what_is_not_disturbed_needs_no_gain():
    found = design({"time": "continuous", "A": -1.0, "C": 1.0, "W": 0.0, "V": 1.0}, "hinf")
    assert (found.verdict, found.achieved.hinf.upper) == (Verdict.CERTIFIED, 0.0)
    np.testing.assert_array_equal(found.gain, [[0.0]])


REQUESTS = {
    "objective": ({"objective": "h1"}, 'objective: expected "h2" or "hinf", got \'h1\''),
    "gamma with h2": ({"gamma": 1.0}, "gamma: expected with the objective hinf"),
    "gamma negative": ({"objective": "hinf", "gamma": -1.0}, "gamma: expected a positive number, got -1"),
    "gamma NaN": ({"objective": "hinf", "gamma": float("nan")}, "gamma: expected a finite number"),
    "gamma a text": ({"objective": "hinf", "gamma": "1"}, "gamma: expected a real number"),
    "decay zero": ({"decay": 0.0}, "decay: expected a positive number, got 0"),
    "dual of a plant": (
        {"dual": True},
        "plant: expected a file or keys with values for a dual design, got Plant; give A, B, Q, R",
    ),
}


@pytest.mark.parametrize(("request_", "message"), REQUESTS.values(), ids=REQUESTS.keys())
def test_a_request_that_makes_no_sense_is_refused_in_one_line(request_, message):
    with pytest.raises(InputError, match=f"^{message}") as error:
        design(example_plant(), **request_)
    assert "\n" not in str(error.value)


def test_a_decay_beyond_double_precision_is_refused():
    plant = plant_from_mapping({"time": "discrete", "dt": 2.0, "A": 1.1, "C": 1.0, "W": 1.0, "V": 1.0})
    with pytest.raises(InputError, match=r"^decay: expected at most 10\.36 for this sampling period, got 20"):
        design(plant, decay=20.0)
