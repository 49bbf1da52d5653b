"""What is proved about a plant, and what that says about the routes."""

import json
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from flint import arb

import derive.numeric.output_cost as output_cost_module
import lmi.enclosure as enclosure_module
import lmi.validation as validation_module
from derive.numeric.modes import distance_to_stability, format_mode
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.comparison import AGREEMENT
from lmi.covariance import covariance_error
from lmi.enclosure import enclose, number_of
from lmi.report.table import proved_lines, verdict_line
from lmi.routes import ROUTES, Answer
from lmi.validation import Verdict, validate
from tests.derive.numeric.plants import EDGES, random_plant

TIMES = ("continuous", "discrete")
THIRD = arb(1) / 3
BALLS = {
    "2 proved exactly": arb(2),
    "2.5 proved exactly": arb(2.5),
    "100 proved exactly": arb(100),
    "0 proved exactly": arb(0),
    "0 proved to within 1.01e-40": arb(0, 1e-40),
    "0.3333333333333 proved to 13 digits": THIRD + arb(0, 2e-14),
    "-3.333333333333e+39 proved to 13 digits": (THIRD + arb(0, 2e-14)) * -(arb(10) ** 40),
}


@pytest.mark.parametrize(("text", "ball"), BALLS.items(), ids=BALLS)
def test_a_ball_as_decimals_holds_the_ball(text, ball):
    number = number_of(ball)
    assert str(number) == text
    claimed = arb(number.value) + arb(0, arb(number.radius).abs_upper())
    assert claimed.contains(ball)
    assert number.as_dict() == {"value": number.value, "radius": number.radius, "digits": number.digits}


def test_a_ball_that_holds_everything_is_no_number():
    assert number_of(arb("nan")) is None
    assert number_of(arb(0, "inf")) is None


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("cross", [False, True])
def test_the_numbers_are_those_of_the_formula(time, cross):
    plant = random_plant(time, 4, 2, seed=60, cross=cross)
    data = json.loads(json.dumps(validate(plant).as_dict(), allow_nan=False))["enclosure"]
    assert (data["status"], data["reason"]) == ("verified", "")
    number = {key: Decimal(data[key]["value"]) for key in ("output", "integral", "unstable_term", "cross_term")}
    output, integral, unstable, cross = number.values()
    assert abs(output + cross - integral - unstable) < Decimal("1e-27")
    assert (cross != 0) == (cross and time == "continuous")
    assert all(data[key]["digits"] >= 28 for key in ("output", "trace", "cost"))
    P = solve_riccati(plant).P
    assert float(data["trace"]["value"]) == pytest.approx(np.trace(P), rel=1e-12)
    assert float(data["cost"]["value"]) == pytest.approx(np.trace(plant.M @ P), rel=1e-12)
    assert 0 < float(data["output"]["radius"]) < 1e-27


def test_the_proved_digits_of_every_route():
    validation = validate(example_plant())
    *computed, closed_form, simulation = validation.routes
    for route in computed:
        assert route.output_error == pytest.approx(validation.enclosure.distance(route.output))
        assert route.output_digits >= (13 if route.name in ("riccati", "integral", "hamiltonian") else 8)
        assert not route.excluded
    for route in (closed_form, simulation):
        assert (route.output_digits, route.output_error) == (None, None)


def test_the_report_says_what_is_proved():
    lines = list(proved_lines(validate(example_plant())))
    assert lines == [
        "tr(CPC'V^-1) = 2.80389428847232845776017144108 proved to 30 digits",
        "  = 2.80389 (integral) + 0 (unstable modes)",
        "tr P = 7.20739784853077421551928464929 proved to 30 digits",
        "condition: P changes by up to 13 times a relative change of A, W, C'V^-1 C",
    ]
    plant = plant_from_mapping({"time": "discrete", "A": 2, "C": 1, "Q": 1, "R": 1, "M": 2})
    assert list(proved_lines(validate(plant))) == [
        "ln det(CPC'+R) = 1.65557083067915220441274994831 proved to 30 digits",
        "  = 0.269276 (integral) + 1.38629 (unstable modes)",
        "tr(MP) = 8.47213595499957939281834733746 proved to 30 digits",
        "condition: P changes by up to 2.8 times a relative change of A, Q, C'R^-1 C",  # 1.789 + 0.276 + 0.724
    ]
    data = {"time": "continuous", "A": 1, "C": 1, "W": 1, "V": 1}
    for N, line in (
        (-0.5, "  = 0.732051 (integral) + 2 (unstable modes) + 0.5 (tr CNV^-1)"),
        (0.2, "  = 0.264911 (integral) + 2 (unstable modes) - 0.2 (tr CNV^-1)"),
    ):
        assert list(proved_lines(validate({**data, "N": N})))[1] == line


def run_only(monkeypatch, *routes):
    monkeypatch.setattr(validation_module, "ROUTES", routes)


def off(plant, factor=1 + 1e-3):
    """Return an answer with the right covariance and an output that is off and sure of itself."""
    answer = ROUTES[0].run(plant)
    return replace(answer, output=answer.output * factor, output_error=0.0)


def test_an_output_that_is_proved_wrong_is_a_disagreement(monkeypatch):
    run_only(monkeypatch, ROUTES[0], replace(ROUTES[5], run=off), ROUTES[6])
    validation = validate(example_plant())
    assert validation.route("nlp").excluded
    assert not validation.route("nlp").agrees
    assert validation.route("nlp").status.startswith("disagrees: its output is proved to be wrong")
    assert validation.verdict is Verdict.DISAGREE
    assert verdict_line(validation) == "disagree: tolerance 1e-06, nlp is proved wrong"
    assert validation.route("integral").agrees


def test_routes_that_agree_on_a_wrong_number_are_found_out(monkeypatch):
    run_only(monkeypatch, replace(ROUTES[0], run=off), replace(ROUTES[5], run=off))
    validation = validate(example_plant())
    assert [route.excluded for route in validation.routes] == [True, True]
    assert validation.verdict is Verdict.DISAGREE


@pytest.mark.parametrize("change", [{"output_error": np.inf}, {"output": np.nan}, {"output": None}])
def test_what_admits_its_error_or_is_no_number_is_not_proved_wrong(change, monkeypatch):
    run_only(monkeypatch, ROUTES[0], replace(ROUTES[5], run=lambda plant: replace(off(plant), **change)))
    assert not validate(example_plant()).route("nlp").excluded


def test_a_small_difference_is_no_disagreement(monkeypatch):
    run_only(monkeypatch, ROUTES[0], replace(ROUTES[5], run=lambda plant: off(plant, 1 + AGREEMENT / 2)))
    assert not validate(example_plant()).route("nlp").excluded


def test_without_an_enclosure_the_routes_are_compared_all_the_same(monkeypatch):
    def fail(plant, digits):
        raise ArithmeticError("balls\nthat exclude each other")

    monkeypatch.setattr(output_cost_module, "enclose_output_cost", fail)
    validation = validate(example_plant())
    assert validation.verdict is Verdict.AGREE
    assert validation.enclosure.status == "failed: balls that exclude each other"
    assert validation.enclosure.as_dict()["output"] is None
    assert all(route.output_digits is None and not route.excluded for route in validation.routes)
    assert list(proved_lines(validation)) == ["tr(CPC'V^-1): not enclosed: failed: balls that exclude each other"]


def test_a_plant_too_large_is_not_enclosed(monkeypatch):
    monkeypatch.setattr(enclosure_module, "LARGEST", 3)
    assert enclose(example_plant()).status == "not attempted: 4 states, the enclosure takes up to 3"


def test_the_error_of_riccati_is_the_proved_one():
    """Beside the boundary Newton steps in double precision say nothing; the bound comes from balls."""
    plant = EDGES["almost on the circle"]
    validation = validate(plant)
    assert covariance_error(plant, solve_riccati(plant).P) is None
    assert validation.routes[0].residual < 1e-12
    assert validation.verdict is Verdict.AGREE


def test_a_proved_error_that_is_large_confirms_nothing(monkeypatch):
    def off_by_little(plant):
        answer = ROUTES[0].run(plant)
        return replace(answer, P=(1 + 3e-6) * answer.P, error=np.inf, output_error=np.inf)

    run_only(monkeypatch, replace(ROUTES[0], run=off_by_little), ROUTES[5])
    validation = validate(replace(example_plant(), M=2 * np.eye(4)))
    assert validation.routes[0].residual == pytest.approx(3e-6, rel=1e-3)
    assert validation.verdict is Verdict.UNCONFIRMED


def test_what_a_covariance_lacks():
    plant = random_plant("continuous", 3, seed=61)
    change = np.array([[0.0, 1e-3, 0.0], [1e-3, 0.0, -2e-3], [0.0, -2e-3, 3e-3]])
    lacking = enclose(plant).lacking(solve_riccati(plant).P - change)
    np.testing.assert_allclose(lacking, change, atol=1e-11)
    assert enclose(EDGES["uncontrollable boundary mode"]).lacking(np.zeros((3, 3))) is None


def test_modes_read_as_on_the_boundary_are_said_to_be():
    T = np.linalg.qr(np.random.default_rng(4).standard_normal((4, 4)))[0]
    A, C = np.eye(4, k=1), np.eye(1, 4)
    validation = validate({"time": "continuous", "A": T @ A @ T.T, "C": C @ T.T, "W": np.zeros((4, 4)), "V": 1.0})
    assert validation.reads_as_boundary
    assert validation.verdict is Verdict.AGREE
    assert not any(route.excluded for route in validation.routes)
    assert "  for the plant's numbers as they are; the routes read modes beside the boundary as on it" in list(
        proved_lines(validation)
    )
    exact = validate({"time": "continuous", "A": A, "C": C, "W": np.zeros((4, 4)), "V": 1.0})
    assert not exact.reads_as_boundary


@pytest.mark.parametrize("name", EDGES)
def test_edges_of_the_theory_give_the_answer_or_name_the_mode(name):
    plant = EDGES[name]
    validation = validate(plant)
    assert validation.verdict is Verdict.AGREE
    truth = float(validation.enclosure.output.value)
    modes = np.linalg.eigvals(plant.A)
    beside = modes[np.abs(distance_to_stability(modes, plant.time)) < 1e-6]
    for route in validation.routes:
        if route.confirms:
            assert route.output == pytest.approx(truth, rel=AGREEMENT, abs=1e-6)
        elif not route.agrees and (route.name != "closed-form" or plant.n == 1):
            assert len(beside) > 0, route
            assert any(mode_in(mode, route.status) for mode in beside), route.status


def mode_in(mode, text):
    return any(format_mode(sign * mode.real + 1j * mode.imag) in text for sign in (1, -1))


def test_a_riccati_equation_without_a_solution_names_the_mode(monkeypatch):
    plant = replace(EDGES["unseen stable mode"], A=np.diag([-1.0, 0.5]))
    (route,) = (r for r in validate(plant).routes if r.name == "riccati")
    assert route.status == "failed: (A, C): expected detectable, got mode 0.5 unobservable"


def test_an_answer_that_is_no_number_has_no_digits():
    found = enclose(example_plant())
    assert (found.distance(None), found.correct_digits(None), found.apart(None)) == (None, None, 0.0)
    assert (found.distance(np.nan), found.correct_digits(np.nan), found.apart(np.nan)) == (None, 0, 0.0)
    assert Answer("solved").output_error == np.inf
