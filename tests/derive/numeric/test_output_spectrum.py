"""The curve of the output's spectrum: its area is the integral, its terms are those of the enclosure."""

from dataclasses import replace

import numpy as np
import pytest

from derive.numeric.output_cost import enclose_output_cost
from derive.numeric.output_spectrum import log_det_spectrum, output_spectrum
from derive.numeric.plant import example_plant
from tests.derive.numeric.plants import EDGES, continuous, random_plant
from tests.derive.numeric.test_log_det import chain

PLANTS = {
    **EDGES,
    "example": example_plant(),
    "chain, damping 1e-2": chain(5, 1e-2),
    "chain, damping 1e-6": chain(5, 1e-6),
    "chain, discrete": chain(5, 1e-3, "discrete"),
    "cross term": random_plant("continuous", 5, 2, seed=1),
    "cross term, discrete": random_plant("discrete", 5, 2, seed=1),
}


@pytest.mark.parametrize("plant", PLANTS.values(), ids=PLANTS)
def test_the_area_under_the_curve_is_the_integral(plant):
    with np.errstate(all="raise"):
        curve = output_spectrum(plant)
    axis = np.log(curve.frequencies) if plant.is_continuous else curve.frequencies
    area = np.trapezoid(curve.heights, axis)
    assert area == pytest.approx(curve.area, rel=0.02, abs=1e-12)
    assert np.all(np.diff(curve.frequencies) > 0)
    assert len(curve.frequencies) < 400


@pytest.mark.parametrize("plant", PLANTS.values(), ids=PLANTS)
def test_the_terms_are_enclosed(plant):
    curve, proved = output_spectrum(plant), enclose_output_cost(plant)
    noise = 0.0 if plant.is_continuous else np.linalg.slogdet(plant.V)[1]
    tight = {"rel": 1e-9, "abs": 1e-9}
    assert curve.area == pytest.approx(float(proved.integral.mid()) - noise, **tight)
    assert curve.unstable_term == pytest.approx(float(proved.unstable_term.mid()), **tight)
    assert curve.cross_term == pytest.approx(float(proved.cross_term.mid()), **tight)
    assert curve.total == pytest.approx(float(proved.value.mid()) - noise, **tight)


def test_the_spectrum_of_a_scalar_plant():
    plant = continuous(A=-2, C=3, W=5, V=7, N=1)
    w = np.array([0.1, 1.0, 10.0])
    Phi = 9 * 5 / (w**2 + 4) + 2 * 3 * 2 / (w**2 + 4) + 7
    np.testing.assert_allclose(log_det_spectrum(plant, w), np.log(Phi / 7), rtol=1e-13)


def test_heights_are_frequency_times_logarithm():
    curve = output_spectrum(example_plant())
    logs = log_det_spectrum(example_plant(), curve.frequencies)
    np.testing.assert_allclose(curve.heights, curve.frequencies * logs / np.pi)
    plant = chain(2, 0.1, "discrete")
    curve = output_spectrum(plant)
    np.testing.assert_allclose(curve.heights, log_det_spectrum(plant, curve.frequencies) / np.pi)


def test_a_spectrum_that_is_nothing_is_drawn_as_zero():
    plant = replace(EDGES["C = 0"], C=np.zeros((3, 2)), V=0.7 * np.eye(3) + 0.1, N=np.zeros((2, 3)))
    curve = output_spectrum(plant)
    assert log_det_spectrum(plant, curve.frequencies).any()
    assert len(curve.frequencies) > 20
    assert not curve.heights.any()
    assert curve.total == pytest.approx(0, abs=1e-15)
