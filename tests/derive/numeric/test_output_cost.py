"""Four routes to one number: they agree where they should, and a route that is off is found out."""

import re
from dataclasses import replace

import numpy as np
import pytest
from flint import arb
from scipy.integrate import quad

import derive.numeric.output_cost as module
from derive.numeric.log_det import enclose_by_eigenvalues, enclose_by_polynomials, enclose_by_quadrature
from derive.numeric.modes import distance_to_stability, format_mode
from derive.numeric.output_cost import enclose_output_cost, four_routes
from derive.numeric.plant import example_plant
from tests.derive.numeric.plants import EDGES, STABILISING, STRONG, random_plant

TIMES = ["continuous", "discrete"]
NAMES = ["riccati", "hamiltonian", "integral"]


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 5, 8])
def test_random_plants(time, n):
    result = four_routes(random_plant(time, n, seed=n + 40))
    assert (result.agree, result.enclosure.enclosed, result.enclosure.digits >= 20) == (True, True, True)
    assert [route.name for route in result.routes] == NAMES
    assert all(route.error < 1e-12 and route.correct_digits >= 11 for route in result.routes)
    assert result.enclosure.by_solution.output_cost.overlaps(result.enclosure.by_spectrum.value)


@pytest.mark.parametrize("case", [*STRONG.values(), *STABILISING.values()], ids=[*STRONG, *STABILISING])
def test_degenerate_plants(case):
    result = four_routes(case[0])
    assert result.enclosure.enclosed
    assert {route.name: route.agrees for route in result.routes} == dict.fromkeys(NAMES, True)


@pytest.mark.parametrize("name", EDGES)
def test_edges_of_the_theory(name):
    plant = EDGES[name]
    result = four_routes(plant)
    assert result.enclosure.digits >= 20
    assert {route.name: route.agrees for route in result.routes} == dict.fromkeys(NAMES, True)
    for way in (enclose_by_eigenvalues, enclose_by_polynomials, enclose_by_quadrature):
        found = way(plant)
        held = found.status == "verified" and found.value.overlaps(result.enclosure.value)
        assert held or (found.status == "open" and names_a_mode(found, plant))
    if result.enclosure.by_solution.status != "verified":
        assert result.enclosure.by_solution.status == "boundary"
        assert names_a_mode(result.enclosure.by_solution, plant)


def names_a_mode(found, plant):
    """Tell whether the reason of a refusal names a mode of A, near to the boundary, as it is printed."""
    modes = np.linalg.eigvals(plant.A - plant.N @ np.linalg.solve(plant.V, plant.C))
    nearest = modes[np.abs(distance_to_stability(modes, plant.time)).argsort()]
    return re.search(rf"(?<![\d.]){re.escape(format_mode(nearest[0]))}(?![\d.])", found.reason) is not None


def test_the_example():
    assert four_routes(example_plant()).agree


@pytest.mark.parametrize("name", NAMES)
def test_a_route_that_is_off_is_found_out(name, monkeypatch):
    honest = module._value

    def forged(route, plant):
        return honest(route, plant) * (1 + 1e-6 * (route == name))

    monkeypatch.setattr(module, "_value", forged)
    result = four_routes(random_plant("continuous", 4, seed=50))
    assert not result.agree
    assert {route.name for route in result.routes if not route.agrees} == {name}
    assert next(route for route in result.routes if route.name == name).correct_digits in (5, 6)


def test_a_failed_route_does_not_agree(monkeypatch):
    monkeypatch.setattr(module, "_value", lambda name, plant: float("nan"))
    result = four_routes(random_plant("discrete", 2, seed=51))
    assert (result.agree, result.enclosure.enclosed) == (False, True)
    assert all(np.isinf(route.error) for route in result.routes)


def test_enclosures_that_exclude_each_other_are_an_error(monkeypatch):
    honest = module.enclose_log_det
    monkeypatch.setattr(module, "enclose_log_det", lambda plant, digits: _moved(honest(plant, digits)))
    with pytest.raises(ArithmeticError, match="expected enclosures that overlap"):
        four_routes(random_plant("continuous", 2, seed=52))


def _moved(found):
    return replace(found, value=found.value + arb(1e-9))


def log_det(plant, w):
    """Return ln det of the spectrum of y at the frequency w, with its cross term."""
    s = 1j * w if plant.is_continuous else np.exp(1j * w)
    X = plant.C @ np.linalg.inv(s * np.eye(plant.n) - plant.A)
    XN = X @ plant.N
    return np.linalg.slogdet(X @ plant.W @ X.conj().T + XN + XN.conj().T + plant.V)[1]


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("cross", [False, True])
def test_the_terms_are_those_of_the_spectrum_of_y(time, cross):
    plant = random_plant(time, 4, 2, seed=53, cross=cross)
    found = enclose_output_cost(plant)
    noise = np.linalg.slogdet(plant.V)[1] if time == "continuous" else 0.0
    end = np.inf if time == "continuous" else np.pi
    value = quad(lambda w: log_det(plant, w) - noise, 0, end, limit=400, epsabs=1e-12, epsrel=1e-12)[0] / np.pi
    modes = np.linalg.eigvals(plant.A)
    sizes = np.maximum(modes.real, 0) if time == "continuous" else np.log(np.maximum(np.abs(modes), 1))
    assert float(found.integral.mid()) == pytest.approx(value, rel=1e-9)
    assert sizes.sum() > 0
    assert float(found.unstable_term.mid()) == pytest.approx(2 * sizes.sum(), rel=1e-12)
    expected = np.trace(plant.C @ plant.N @ np.linalg.inv(plant.V)) if time == "continuous" else 0.0
    assert float(found.cross_term.mid()) == pytest.approx(expected, rel=1e-12)
    assert (found.value + found.cross_term).overlaps(found.integral + found.unstable_term)
    assert found.digits >= 20


def test_what_is_said_of_a_value():
    plant = random_plant("continuous", 3, seed=54)
    found = enclose_output_cost(plant)
    truth = float(found.value.mid())
    assert found.distance(truth) < 1e-15 * truth
    assert found.correct_digits(truth) >= 15
    assert found.distance(truth + 1e-3) == pytest.approx(found.apart(truth + 1e-3)) == pytest.approx(1e-3, rel=1e-9)
    assert found.correct_digits(truth * (1 + 2e-5)) == 4
    assert (found.distance(np.nan), found.apart(np.nan), found.correct_digits(np.inf)) == (np.inf, 0.0, 0)
    wide = replace(found, value=arb(truth, 1.0))
    assert (wide.apart(truth + 0.5), wide.apart(truth + 1.5)) == (0.0, pytest.approx(0.5))
    nothing = replace(found, value=arb("nan"))
    assert not nothing.enclosed
    assert (nothing.distance(1.0), nothing.apart(1.0), nothing.correct_digits(1.0)) == (np.inf, 0.0, 0)
