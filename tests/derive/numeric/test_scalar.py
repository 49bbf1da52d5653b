"""The closed form of the scalar estimator: exact residuals, every degenerate case, agreement with the matrix code."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from derive.errors import InputError
from derive.numeric.plant import Plant, example_plant
from derive.numeric.riccati import solve_riccati
from derive.numeric.scalar import solve_scalar
from tests.derive.numeric.plants import STABILISING, STRONG, continuous, discrete

TIMES = {"continuous": continuous, "discrete": discrete}


def grid():
    """Return plants (time, A, C, W, V, N) with every sign, zeros, and cross terms up to the largest."""
    for time, A, C, W, V, rho in product(
        TIMES, (-2, -1, -0.5, 0, 0.5, 1, 3), (0, 1, -2), (0, 1e-12, 1), (1e-8, 1), (0, 0.5, 1, -1)
    ):
        N = rho * np.sqrt(W * V)
        F = A - N * C / V
        if C != 0 or (F < 0 if time == "continuous" else abs(F) < 1):
            yield time, A, C, W, V, N


def residual(plant, P):
    """Return the exact residual of the equation at P, relative to its terms."""
    A, C, W, V, N = (Fraction(float(X[0, 0])) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    P = Fraction(P)
    if plant.is_continuous:
        terms = (2 * A * P, W, -((P * C + N) ** 2) / V)
    else:
        terms = (A * A * P, -P, W, -((A * P * C + N) ** 2) / (C * P * C + V))
    return float(abs(sum(terms)) / (sum(map(abs, terms)) or 1))


def test_every_case_solves_its_equation_and_agrees_with_the_matrix_code():
    cases = 0
    for time, A, C, W, V, N in grid():
        plant = TIMES[time](A=A, C=C, W=W, V=V, N=N)
        scalar, matrix = solve_scalar(plant), solve_riccati(plant)
        assert residual(plant, scalar.P) < 1e-15
        assert scalar.status == matrix.status
        assert pytest.approx(matrix.P[0, 0], rel=1e-12, abs=1e-12 * W) == scalar.P
        assert scalar.gain == pytest.approx(matrix.gain[0, 0], rel=1e-9, abs=1e-12)
        assert scalar.closed_loop == pytest.approx(A - scalar.gain * C, rel=1e-7, abs=1e-11)
        cases += 1
    assert cases > 800


@pytest.mark.parametrize("name", list({**STRONG, **STABILISING}))
def test_known_answers(name):
    plant, P, *_ = {**STRONG, **STABILISING}[name]
    if plant.n == 1:
        solution = solve_scalar(plant)
        assert pytest.approx(P[0][0], rel=1e-15, abs=0) == solution.P
        assert solution.status == ("strong" if name in STRONG else "stabilising")


@pytest.mark.parametrize("A", [-1e8, -1e4])
def test_no_digit_is_lost_to_a_stable_pole(A):
    """sqrt(A^2 + W) + A cancels; P = W/(|A| + sqrt(A^2 + W)) does not."""
    solution = solve_scalar(continuous(A=A, C=1, W=1, V=1))
    assert pytest.approx(1 / (-A + np.hypot(A, 1)), rel=1e-15) == solution.P
    assert solution.P > 0


def test_no_digit_is_lost_to_a_large_cross_term():
    """W - N^2/V is about 2^-53 here, and double precision evaluates it with no correct digit."""
    W, V = 0.1, 0.7
    N = np.sqrt(W * V)
    exact = Fraction(W) - Fraction(N) ** 2 / Fraction(V)
    assert abs((W - N**2 / V) / float(exact) - 1) > 0.1
    letters = {"A": -1.0, "C": 0.0, "W": W, "V": V, "N": N, "M": 1.0}
    plant = Plant(time="continuous", **{letter: np.array([[number]]) for letter, number in letters.items()})
    assert pytest.approx(float(exact) / 2, rel=1e-15, abs=0) == solve_scalar(plant).P


def test_only_scalars_are_solved():
    with pytest.raises(InputError, match="expected one state and one output, got 4 and 2; use solve_riccati"):
        solve_scalar(example_plant())
