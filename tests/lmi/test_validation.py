"""One plant, every route, one verdict: agreement, disagreement, and what is neither."""

import json
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import lmi
import lmi.routes as routes_module
import lmi.validation as validation_module
from derive.errors import InputError
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati
from lmi.certification.outcome import CertificateOutcome
from lmi.comparison import AGREEMENT
from lmi.covariance import solve_covariance
from lmi.enclosure import Enclosure
from lmi.report.table import verdict_line
from lmi.routes import ROUTES, Answer, cost_of, output_rounding
from lmi.solve import Status
from lmi.validation import Verdict, validate

TIMES = ("continuous", "discrete")
CONVEX = ("lmi-primal", "lmi-dual", "lmi-h2", "interior-point")
NAMES = ("riccati", *CONVEX, "nlp", "integral", "hamiltonian", "closed-form", "simulation")


def run_only(monkeypatch, **runs):
    """Run Riccati and the named routes, these as given instead of as they are."""
    routes = [
        replace(spec, run=runs[spec.name.replace("-", "_")]) for spec in ROUTES if spec.name.replace("-", "_") in runs
    ]
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], *routes))


def test_every_route_agrees_on_the_aircraft():
    validation = validate(example_plant())
    assert tuple(route.name for route in validation.routes) == NAMES
    assert validation.verdict is Verdict.AGREE
    for route in validation.routes[:-2]:
        assert route.trusted, route
        assert route.relative_difference < AGREEMENT, route
        assert route.difference_from == "enclosure"
        assert route.difference < AGREEMENT, route
    assert validation.route("closed-form").status == "not applicable: for at most 3 states, not 4"


@pytest.mark.parametrize("n", range(1, 11))
@pytest.mark.parametrize("time", TIMES)
def test_every_route_agrees_on_random_plants(time, n, random_plant):
    plant = random_plant(time, n)
    validation = validate(plant)
    expected = solve_riccati(plant).P
    assert validation.verdict is Verdict.AGREE
    for route in validation.routes:
        if route.name != "closed-form" or n <= 3:
            assert route.agrees, route
        if route.name == "simulation":
            lower, upper = route.sample.trace.interval
            assert lower < np.trace(expected) < upper
            continue
        if route.trace is not None:
            assert route.trace == pytest.approx(np.trace(expected), rel=AGREEMENT)
            assert route.cost == pytest.approx(np.trace(plant.M @ expected), rel=AGREEMENT)
        if route.output is not None:
            assert route.output == pytest.approx(validation.routes[0].output, rel=AGREEMENT)
        if route.gain is not None:
            np.testing.assert_allclose(route.gain, solve_riccati(plant).gain, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize(("A", "W"), [(0.5, 0.0), (-0.3, 1e-12), (0.3, 1e8)])
def test_small_zero_and_large_covariances_are_confirmed(time, A, W):
    A = A - 1.0 if time == "continuous" else A
    assert validate({"time": time, "A": A, "C": 2.0, "W": W, "V": 1e-3}).verdict is Verdict.AGREE


@pytest.mark.parametrize(
    "plant",
    [
        {"time": "continuous", "A": 0.0, "C": 1.0, "W": 0.0, "V": 1.0},
        {"time": "continuous", "A": [[0, 1], [0, 0]], "C": [[1, 0]], "W": [[0, 0], [0, 0]], "V": 1.0},
        {
            "time": "continuous",
            "A": [[0, 1, 0], [-1, 0, 0], [0, 0, -1]],
            "C": [[1, 0, 1]],
            "W": np.diag([0, 0, 2]),
            "V": 1,
        },
        {"time": "discrete", "A": 1.0, "C": 1.0, "W": 0.0, "V": 1.0},
        {"time": "discrete", "A": [[1, 0], [0, 0.5]], "C": [[1, 1]], "W": np.diag([0, 1]), "V": 1.0},
    ],
)
def test_unexcited_boundary_mode_gives_the_strong_solution_confirmed(plant):
    validation = validate(plant)
    assert validation.routes[0].status == "strong"
    assert validation.verdict is Verdict.AGREE
    assert "riccati (strong solution)" in verdict_line(validation)
    for route in validation.routes:
        assert not route.disagrees
        if not route.trusted and route.trace is not None:
            assert route.status.startswith("not applicable: boundary mode")


def test_chain_of_integrators_at_the_boundary_is_no_disagreement():
    A = np.diag([1.0, 1.0, 1.0], 1)
    validation = validate({"time": "continuous", "A": A, "C": [[1, 0, 0, 0]], "W": np.zeros((4, 4)), "V": 1.0})
    assert validation.routes[0].status == "strong"
    assert validation.verdict is Verdict.AGREE


def test_sharp_sensors_are_confirmed_and_an_ill_conditioned_pencil_is_called_inaccurate():
    plant = {"time": "discrete", "A": [[0.5, 1], [0, 0.3]], "C": [[1, 1]], "W": 1e10 * np.eye(2), "V": 1e-10}
    validation = validate(plant)
    assert validation.verdict is Verdict.AGREE
    assert all(validation.route(name).agrees for name in ("lmi-primal", "lmi-dual", "lmi-h2", "nlp", "integral"))
    assert validation.route("hamiltonian").status.startswith("inaccurate")


def test_cancellation_in_the_output_of_a_large_covariance_is_neither(monkeypatch):
    P = 1e12 * np.ones((2, 2)) + np.eye(2)
    plant = replace(example_plant(), A=-np.eye(2), C=np.array([[1.0, -1.0]]), W=np.eye(2), V=np.eye(1))
    plant = replace(plant, N=np.zeros((2, 1)), M=np.eye(2))
    rounded = output_rounding(plant, P)
    assert 1e-4 < rounded < 1e-2
    riccati = replace(ROUTES[0], run=lambda plant: Answer("stabilising", P, np.zeros((2, 1)), 2.0, error=0.0))
    integral = replace(ROUTES[6], run=lambda plant: Answer("solved", output=2.0 + rounded, error=0.0))
    monkeypatch.setattr(validation_module, "ROUTES", (riccati, integral))
    validation = validate(plant)
    assert not validation.route("integral").agrees
    assert not validation.route("integral").disagrees


def garbage(plant):
    """An answer that is wrong by a percent and sure of itself."""
    solution = solve_riccati(plant)
    return Answer("solved", 1.01 * solution.P, solution.gain, 1.0, error=0.0)


@pytest.mark.parametrize("time", TIMES)
def test_a_confident_wrong_covariance_is_a_disagreement(time, random_plant, monkeypatch):
    run_only(monkeypatch, nlp=garbage, integral=ROUTES[6].run)
    validation = validate(random_plant(time, 3))
    assert validation.verdict is Verdict.DISAGREE
    assert validation.verdict.exit_code == 1
    assert validation.route("integral").agrees
    assert validation.route("nlp").status.startswith("disagrees: differs from riccati by 1.0e-02")
    assert verdict_line(validation) == "disagree: tolerance 1e-06, nlp differs from riccati by 1e-02"


@pytest.mark.parametrize("output", [7.0, float("nan")])
def test_a_confident_wrong_output_is_a_disagreement(output, monkeypatch):
    run_only(monkeypatch, integral=lambda plant: Answer("solved", output=output, error=0.0))
    assert validate(example_plant()).verdict is Verdict.DISAGREE


def test_a_wrong_riccati_solution_is_a_disagreement(monkeypatch):
    wrong = replace(ROUTES[0], run=lambda plant: replace(ROUTES[0].run(plant), P=1.001 * ROUTES[0].run(plant).P))
    monkeypatch.setattr(validation_module, "ROUTES", (wrong, ROUTES[2]))
    assert validate(example_plant()).verdict is Verdict.DISAGREE


def test_a_wrong_covariance_that_admits_its_error_is_neither(monkeypatch):
    run_only(monkeypatch, nlp=lambda plant: replace(garbage(plant), error=0.1))
    validation = validate(example_plant())
    assert validation.verdict is Verdict.UNCONFIRMED
    assert validation.verdict.exit_code == 3
    assert validation.route("nlp").status.startswith("inaccurate: its own numbers admit a relative error of")


def test_a_right_covariance_that_admits_a_large_error_confirms_nothing(monkeypatch):
    run_only(monkeypatch, nlp=lambda plant: replace(ROUTES[0].run(plant), error=0.1))
    validation = validate(example_plant())
    assert validation.route("nlp").relative_difference == 0.0
    assert validation.verdict is Verdict.UNCONFIRMED


def test_a_covariance_from_numbers_that_break_their_constraints_confirms_nothing(monkeypatch):
    def solve(plant, build):
        solution = solve_covariance(plant, build)
        return replace(solution, outcome=replace(solution.outcome, status=Status.INACCURATE))

    monkeypatch.setattr(routes_module, "solve_covariance", solve)
    run_only(monkeypatch, lmi_dual=ROUTES[2].run)
    validation = validate(example_plant())
    assert validation.route("lmi-dual").status == Status.INACCURATE.value
    assert validation.verdict is Verdict.UNCONFIRMED


def test_an_error_that_does_not_explain_the_difference_is_a_disagreement(monkeypatch):
    run_only(monkeypatch, integral=lambda plant: Answer("solved", output=4.0, error=1e-5))
    assert validate(example_plant()).verdict is Verdict.DISAGREE


@pytest.mark.parametrize(
    "error", [RuntimeError("out of\nluck"), np.linalg.LinAlgError("singular"), ZeroDivisionError(), MemoryError()]
)
def test_a_route_that_raises_is_named_with_its_reason(error, monkeypatch):
    def fail(plant):
        raise error

    run_only(monkeypatch, nlp=fail, integral=ROUTES[6].run)
    validation = validate(example_plant())
    assert validation.verdict is Verdict.AGREE
    route = validation.route("nlp")
    assert route.status == f"failed: {' '.join(str(error).split()) or type(error).__name__}"
    assert route.trace is route.relative_difference is route.residual is None


def test_without_an_independent_route_nothing_is_confirmed(monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", tuple(ROUTES[i] for i in (0, 7)))
    validation = validate(example_plant())
    assert validation.route("hamiltonian").agrees
    assert validation.verdict is Verdict.UNCONFIRMED


def test_without_riccati_nothing_is_confirmed(monkeypatch):
    failed = replace(ROUTES[0], run=lambda plant: Answer("failed: no solution"))
    monkeypatch.setattr(validation_module, "ROUTES", (failed, ROUTES[6]))
    validation = validate(example_plant())
    assert validation.verdict is Verdict.UNCONFIRMED
    assert validation.route("integral").relative_difference is None


def test_a_plant_too_large_for_a_route_is_said_to_be(monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], replace(ROUTES[3], largest=3), ROUTES[6]))
    assert validate(example_plant()).route("lmi-h2").status == "not attempted: 4 states, this route takes up to 3"


@pytest.mark.parametrize("M", [np.zeros((4, 4)), np.diag([1.0, 0.0, 0.0, 0.0])])
def test_a_singular_weight_hides_no_wrong_covariance(M, monkeypatch):
    plant = replace(example_plant(), M=M)
    run_only(monkeypatch, lmi_dual=ROUTES[2].run)
    assert validate(plant).verdict is Verdict.AGREE

    def wrong(plant):
        answer = ROUTES[2].run(plant)
        return replace(answer, P=answer.P + np.diag([0.0, 0.0, 0.0, 0.01]))

    run_only(monkeypatch, lmi_dual=wrong)
    assert validate(plant).verdict is Verdict.DISAGREE


def test_routes_name_each_other_as_independent_both_ways():
    independent = {spec.name: spec.independent_of for spec in ROUTES}
    assert tuple(independent) == NAMES
    for name, others in independent.items():
        assert name not in others
        assert all(name in independent[other] for other in others)


def test_json_has_the_keys_of_the_schema_and_the_plant_can_be_read_back():
    data = json.loads(json.dumps(validate(example_plant()).as_dict(), allow_nan=False))
    old = ["schema", "plant", "routes", "enclosure", "certificate", "certificate_status", "verdict"]
    assert set(data) == {*old, "covariance", "filter", "bounds", "reason"}
    assert data["schema"] == "lmi-validate/1"
    assert (data["certificate"]["schema"], data["certificate_status"]) == ("lmi-certificate/1", "certified")
    assert data["verdict"] == "agree"
    keys = {"name", "trace", "cost", "gain", "status", "relative_difference", "seconds", "independent_of"}
    keys |= {"output", "residual", "output_error", "output_digits", "difference", "difference_from"}
    for route in data["routes"]:
        assert keys | {"interval", "sample", "iterations", "history"} == set(route)
        assert (route["interval"] is None) == (route["name"] != "simulation")
    assert [route["name"] for route in data["routes"]] == list(NAMES)
    again = plant_from_mapping(data["plant"])
    np.testing.assert_array_equal(again.A, example_plant().A)
    np.testing.assert_array_equal(again.W, example_plant().W)


def test_numbers_that_json_lacks_become_null(monkeypatch):
    nothing = np.full((4, 2), np.nan)
    run_only(monkeypatch, nlp=lambda plant: replace(garbage(plant), error=np.inf, output=float("nan"), gain=nothing))
    route = validate(example_plant()).as_dict()["routes"][1]
    assert route["output"] is None
    assert route["gain"] is None
    assert route["residual"] is None


def test_cost_is_weighted():
    plant = replace(example_plant(), M=np.diag([1.0, 2.0, 0.0, 0.0]))
    P = np.arange(16.0).reshape(4, 4)
    assert cost_of(plant, P) == 0.0 + 2 * 5.0


@pytest.mark.parametrize("work", [lmi.validate, lmi.design, lmi.certify, lambda plant: lmi.design(plant, dual=True)])
@pytest.mark.parametrize("other", [None, 3, np.eye(2)])
def test_what_is_no_plant_is_refused_in_one_line(work, other):
    with pytest.raises(InputError, match=r"^plant: expected a file.* got .*; give A, ") as caught:
        work(other)
    assert "\n" not in str(caught.value)


def test_a_system_without_noise_is_told_where_to_go():
    from scipy.signal import StateSpace

    with pytest.raises(InputError, match=r"got StateSpaceDiscrete; a system lacks the noise: .*plant_from_system"):
        lmi.validate(StateSpace([[0.5]], [[1.0]], [[1.0]], [[0.0]], dt=0.1))


def test_a_plant_comes_as_plant_mapping_or_path(tmp_path):
    mapping = {"time": "continuous", "A": -1.0, "C": 1.0, "W": 1.0, "V": 1.0}
    path = tmp_path / "plant.toml"
    path.write_text('time = "continuous"\nA = [[-1.0]]\nC = [[1.0]]\nW = [[1.0]]\nV = [[1.0]]\n')
    names: list[str] = []
    for plant in (mapping, path, str(path), plant_from_mapping(mapping)):
        names.clear()
        validation = lmi.validate(plant, progress=names.append)
        assert validation.routes[0].trace == pytest.approx(np.sqrt(2) - 1)
    assert names == ["enclosure", *NAMES, "certificate"]
    with pytest.raises(InputError):
        lmi.validate({"time": "continuous"})


def test_function_wins_over_any_module_of_that_name():
    code = "import lmi.validation, lmi.cli, lmi; assert callable(lmi.validate), lmi.validate; from lmi import validate"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("module", ["lmi", "lmi.cli"])
def test_import_loads_no_numerical_package(module):
    heavy = ["numpy", "scipy", "sympy", "cvxpy", "casadi", "z3", "flint", "matplotlib", "rich"]
    code = f"import sys, {module}; print([name for name in {heavy} if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert result.stdout.strip() == "[]"


# ------------------------------------------------------------------------------------------------ simulation
def with_covariance(factor):
    """Riccati's route with its covariance, but not its gain, multiplied."""

    def run(plant):
        answer = ROUTES[0].run(plant)
        return replace(answer, P=factor * answer.P)

    return replace(ROUTES[0], run=run)


@pytest.mark.parametrize("time", TIMES)
def test_a_wrong_covariance_of_the_right_gain_is_seen_by_simulation_alone(time, random_plant, monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (with_covariance(1.3), ROUTES[-1]))
    validation = validate(random_plant(time, 3))
    simulation = validation.route("simulation")
    assert simulation.disagrees
    assert not simulation.agrees
    assert re.match(r"disagrees: differs from riccati by \d+\.\d standard deviations", simulation.status)
    assert validation.verdict is Verdict.DISAGREE


def test_the_verdict_says_how_far_off_a_sample_is(monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (with_covariance(1.3), ROUTES[-1]))
    monkeypatch.setattr(validation_module, "attempt_certificate", lambda plant: CertificateOutcome("none"))
    validation = validate(example_plant())
    assert re.search(r"simulation differs from riccati by \d+\.\d standard deviations", verdict_line(validation))


def test_a_sample_confirms_nothing(monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], ROUTES[-1]))
    validation = validate(example_plant())
    simulation = validation.route("simulation")
    assert (simulation.agrees, simulation.confirms, simulation.status) == (True, False, "sampled")
    assert simulation.residual > 1e-3
    assert validation.confirming == ()
    assert validation.verdict is Verdict.UNCONFIRMED


def test_even_an_independent_sample_confirms_nothing(monkeypatch):
    independent = replace(ROUTES[-1], independent_of=("riccati",))
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], independent))
    assert validate(example_plant()).verdict is Verdict.UNCONFIRMED


@pytest.mark.parametrize(
    ("half_widths", "agrees", "disagrees", "status"),
    [
        (0.5, True, False, "sampled"),
        (1.15, False, False, "sampled: ... standard deviations from riccati, outside its 99.9% interval"),
        (2.2, False, True, "disagrees: differs from riccati by ... standard deviations"),
    ],
)
def test_a_sample_says_how_far_riccati_is_from_its_interval(half_widths, agrees, disagrees, status, monkeypatch):
    trace = ROUTES[-1].run(example_plant()).sample.trace
    factor = (trace.value + half_widths * trace.half_width) / ROUTES[0].run(example_plant()).P.trace()
    monkeypatch.setattr(validation_module, "ROUTES", (with_covariance(factor), ROUTES[-1]))
    simulation = validate(example_plant()).route("simulation")
    assert (simulation.agrees, simulation.disagrees) == (agrees, disagrees)
    score = re.search(r"\d+\.\d(?= standard)", simulation.status)
    assert simulation.status == status.replace("...", score[0] if score else "")
    assert score is None or 3.3 * half_widths - 0.2 < float(score[0]) < 3.3 * half_widths + 3


def test_one_wrong_variance_does_not_hide_behind_the_trace(monkeypatch):
    def run(plant):
        answer = ROUTES[0].run(plant)
        return replace(answer, P=answer.P + np.diag([0.3, 0.0, 0.0, -0.3]))

    monkeypatch.setattr(validation_module, "ROUTES", (replace(ROUTES[0], run=run), ROUTES[-1]))
    assert validate(example_plant()).route("simulation").disagrees


def test_what_riccati_is_not_sure_of_is_no_disagreement(monkeypatch):
    doubtful = replace(ROUTES[0], run=lambda plant: replace(with_covariance(1.3).run(plant), error=np.inf))
    monkeypatch.setattr(validation_module, "ROUTES", (doubtful, ROUTES[-1]))
    monkeypatch.setattr(validation_module, "enclose", lambda plant: Enclosure("not attempted"))
    simulation = validate(example_plant()).route("simulation")
    assert (simulation.agrees, simulation.disagrees) == (False, False)


def test_the_sample_is_in_the_data():
    data = json.loads(json.dumps(validate(example_plant()).as_dict(), allow_nan=False))
    route = data["routes"][-1]
    lower, upper = route["interval"]
    assert lower < data["routes"][0]["trace"] < upper
    assert route["sample"]["level"] == 0.999
    assert route["sample"]["cost_interval"] == pytest.approx(route["interval"])
    assert len(route["sample"]["variance_intervals"]) == 4
    assert route["sample"]["running"][-1]["interval"] == pytest.approx(route["sample"]["cost_interval"])
    assert validate(example_plant()).as_dict()["routes"][-1]["interval"] == route["interval"]


def test_solvers_say_how_they_converged():
    routes = {route["name"]: route for route in validate(example_plant()).as_dict()["routes"]}
    merits = routes["interior-point"]["history"]
    assert merits[0] > 1e3 * merits[-1] > 0
    assert routes["interior-point"]["iterations"] == len(merits) - 1
    assert all(routes[name]["iterations"] > 0 for name in ("riccati", *CONVEX, "nlp"))
    assert all(routes[name]["iterations"] is None for name in ("integral", "hamiltonian", "simulation"))
