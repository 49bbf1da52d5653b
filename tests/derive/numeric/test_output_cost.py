"""Four routes to one number: they agree where they should, and a route that is off is found out."""

import numpy as np
import pytest
from flint import arb

import derive.numeric.output_cost as module
from derive.numeric.output_cost import four_routes
from derive.numeric.plant import example_plant
from tests.derive.numeric.plants import STABILISING, STRONG, random_plant

TIMES = ["continuous", "discrete"]
NAMES = ["riccati", "hamiltonian", "integral"]


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [1, 2, 5, 8])
def test_random_plants(time, n):
    result = four_routes(random_plant(time, n, seed=n + 40))
    assert (result.agree, result.enclosed, result.digits >= 20) == (True, True, True)
    assert [route.name for route in result.routes] == NAMES
    assert all(route.error < 1e-12 and route.correct_digits >= 11 for route in result.routes)
    assert result.by_solution.output_cost.overlaps(result.by_spectrum.value)


@pytest.mark.parametrize("case", [*STRONG.values(), *STABILISING.values()], ids=[*STRONG, *STABILISING])
def test_degenerate_plants(case):
    result = four_routes(case[0])
    assert result.enclosed
    assert {route.name: route.agrees for route in result.routes} == dict.fromkeys(NAMES, True)


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
    assert (result.agree, result.enclosed) == (False, True)
    assert all(np.isinf(route.error) for route in result.routes)


def test_enclosures_that_exclude_each_other_are_an_error(monkeypatch):
    from dataclasses import replace

    honest = module.enclose_log_det
    monkeypatch.setattr(module, "enclose_log_det", lambda plant, digits: _moved(honest(plant, digits), replace))
    with pytest.raises(ArithmeticError, match="expected enclosures that overlap"):
        four_routes(random_plant("continuous", 2, seed=52))


def _moved(found, replace):
    return replace(found, value=found.value + arb(1e-9))
