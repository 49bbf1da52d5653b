"""The textbook's program: right where it is, and failing without a false claim where it is not."""

import numpy as np
import pytest

from derive.numeric.enclosure import enclose_riccati
from derive.numeric.gain_nlp import optimise_gain
from derive.numeric.modes import distance_to_stability
from tests.derive.numeric.plants import continuous, random_plant

PLANTS = [random_plant(time, n, seed=seed) for time in ("continuous", "discrete") for n in (2, 4) for seed in range(4)]


def test_it_claims_an_optimum_only_where_it_is_one():
    right, failed = {2: 0, 4: 0}, 0
    for plant in PLANTS:
        result = optimise_gain(plant, "full-space")
        if result.status == "optimal":
            assert result.trace == pytest.approx(float(enclose_riccati(plant, 20).trace), rel=1e-9)
            right[plant.n] += 1
        failed += result.status == "failed"
        stable = distance_to_stability(np.linalg.eigvals(plant.A - result.gain @ plant.C), plant.time).max() < 0
        assert stable == (result.status != "failed")
    assert right[2] > right[4]
    assert right[4] < 4 < failed


def test_the_equation_has_solutions_below_zero_beyond_the_boundary():
    """For x' = w, y = x + v and a gain L < 0, P = (1 + L^2) / (2 L) solves the equation: why the program fails."""
    plant = continuous(A=0, C=1, W=1, V=1)
    for L in (-1.0, -100.0):
        P = (1 + L**2) / (2 * L)
        assert -2 * L * P + plant.W.item() + L * plant.V.item() * L == pytest.approx(0)
        assert abs(L) / 3 < -P
