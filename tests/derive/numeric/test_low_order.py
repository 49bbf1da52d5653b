"""The output cost of small plants in closed form, against the Riccati equation, by hand, and at equal roots."""

from __future__ import annotations

from math import log, sqrt
from typing import Any

import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.low_order import _cubic, low_order_output
from derive.numeric.plant import Plant, plant_from_mapping
from derive.numeric.riccati import solve_riccati


def _plant(time: str, **data: Any) -> Plant:
    return plant_from_mapping({"time": time, **{k: np.asarray(v).tolist() for k, v in data.items()}})


def _by_riccati(plant: Plant) -> float:
    output = plant.C @ solve_riccati(plant).P @ plant.C.T
    if plant.is_continuous:
        return float(np.trace(np.linalg.solve(plant.V, output)))
    return float(np.linalg.slogdet(output + plant.V)[1])


@pytest.mark.parametrize("time", ["continuous", "discrete"])
@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("l", [1, 2])
def test_random_plants_with_cross_terms(time: str, n: int, l: int) -> None:  # noqa: E741
    rng = np.random.default_rng(10 * n + l)
    for _ in range(20):
        G = rng.standard_normal((n + l, n + l))
        J = G @ G.T
        A, C = rng.standard_normal((n, n)), rng.standard_normal((l, n))
        plant = _plant(time, A=A, C=C, W=J[:n, :n], V=J[n:, n:], N=J[:n, n:])
        value, error = low_order_output(plant)
        assert value == pytest.approx(_by_riccati(plant), rel=1e-9, abs=1e-9)
        assert 0 <= error < 1e-20


def test_by_hand() -> None:
    """Integrators: (s^2 + 2^(1/2) q s + q^2) and (s^3 + 2 q s^2 + 2 q^2 s + q^3) are the Butterworth factors."""
    q = 3.0
    double = _plant("continuous", A=[[0, 1], [0, 0]], C=[[1, 0]], W=[[0, 0], [0, q**4]], V=[[1]])
    assert low_order_output(double)[0] == pytest.approx(sqrt(2) * q, rel=1e-15)
    triple = _plant("continuous", A=np.eye(3, k=1), C=[[1, 0, 0]], W=np.diag([0, 0, q**6]), V=[[1]])
    assert low_order_output(triple)[0] == pytest.approx(2 * q, rel=1e-15)
    unexcited = _plant("discrete", A=np.diag([2.0, 0.5, -3.0]), C=[[1, 1, 1]], W=np.zeros((3, 3)), V=[[1]])
    assert low_order_output(unexcited)[0] == pytest.approx(2 * log(6), rel=1e-15)


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_equal_roots_and_modes_on_the_boundary(time: str) -> None:
    """No process noise: the roots are those of the plant, here three times the same, or on the boundary."""
    unstable = 2.0 * np.eye(3)
    plant = _plant(time, A=unstable, C=np.eye(3), W=np.zeros((3, 3)), V=np.eye(3))
    assert low_order_output(plant)[0] == pytest.approx(12.0 if time == "continuous" else 6 * log(2), rel=1e-12)
    turning = np.array([[0.0, 1.0], [-1.0, 0.0]])
    quiet = _plant(time, A=turning, C=[[1, 0]], W=np.zeros((2, 2)), V=[[1]])
    assert low_order_output(quiet)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("roots", [(1, 2, 3), (2, 2, 5), (-1, -1, -1), (0, 0, 7), (0, 0, 0)])
def test_cubic(roots: tuple[int, int, int]) -> None:
    from flint import fmpq

    a, b, c = roots
    found = _cubic(fmpq(-a - b - c), fmpq(a * b + b * c + c * a), fmpq(-a * b * c))
    assert sorted(round(float(x.real.mid()), 6) for x in found) == sorted(roots)
    assert all(any(x.overlaps(root) for x in found) for root in roots)


def test_four_states_are_refused() -> None:
    with pytest.raises(InputError, match="expected at most 3 states, got 4"):
        low_order_output(_plant("continuous", A=-np.eye(4), C=np.eye(4), W=np.eye(4), V=np.eye(4)))
