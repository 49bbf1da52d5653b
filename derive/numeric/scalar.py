"""The scalar estimator in closed form: one state, one output, no iteration and no cancellation."""

from dataclasses import dataclass
from fractions import Fraction
from math import hypot, sqrt
from typing import Literal

from derive.errors import InputError
from derive.numeric.plant import Plant

__all__ = ["ScalarSolution", "solve_scalar"]


@dataclass(frozen=True)
class ScalarSolution:
    """The steady error variance of a scalar plant and its optimal gain.

    Attributes:
        P: variance [state]^2, of the predicted state in discrete time.
        gain: L.
        closed_loop: A - L C.
        status: "stabilising", or "strong" when A - L C stays on the boundary because no noise excites the state.
    """

    P: float
    gain: float
    closed_loop: float
    status: Literal["stabilising", "strong"]


def solve_scalar(plant: Plant) -> ScalarSolution:
    """Solve the scalar Riccati equation for its stabilising (strong) root.

    With F = A - N C/V, q = W - N^2/V and g = C^2/V:
    continuous: g P^2 - 2 F P - q = 0, s = sqrt(F^2 + g q), P = (F + s)/g if F > 0, else q/(s - F); A - L C = -s.
    discrete: g P^2 - b P - q = 0, b = F^2 + g q - 1, s = sqrt(b^2 + 4 g q), P = (b + s)/(2 g) if b > 0, else
    2 q/(s - b), 0 if q = 0; A - L C = F/(1 + g P).

    F, q, g and b are formed exactly and rounded once; neither quotient subtracts nearly equal numbers.

    Args:
        plant: n = l = 1, V > 0, W V >= N^2, C != 0 unless A is stable.

    Raises:
        InputError: the plant is not scalar.

    Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, arXiv:1807.08604 (2018), corollary 2, for N = 0 and C != 0 in
        continuous time.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> plant = plant_from_mapping({"time": "continuous", "A": 1, "C": 1, "W": 0, "V": 1})
        >>> solve_scalar(plant)
        ScalarSolution(P=2.0, gain=2.0, closed_loop=-1.0, status='stabilising')
    """
    if (plant.n, plant.l) != (1, 1):
        raise InputError(f"plant: expected one state and one output, got {plant.n} and {plant.l}; use solve_riccati")
    A, C, W, V, N = (Fraction(float(X[0, 0])) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
    F, q, g = A - N * C / V, max(W - N**2 / V, Fraction(0)), C**2 / V
    P, loop = _continuous(F, q, g) if plant.is_continuous else _discrete(F, q, g)
    p = Fraction(P)
    gain = (p * C + N) / V if plant.is_continuous else (A * p * C + N) / (C * p * C + V)
    stable = loop < 0 if plant.is_continuous else abs(loop) < 1
    return ScalarSolution(P, float(gain), loop, "stabilising" if stable else "strong")


def _continuous(F: Fraction, q: Fraction, g: Fraction) -> tuple[float, float]:
    """Return P and A - L C."""
    s = hypot(float(F), sqrt(float(g * q)))
    P = (float(F) + s) / float(g) if F > 0 else float(q) / (s - float(F)) if q else 0.0
    return P, -s


def _discrete(F: Fraction, q: Fraction, g: Fraction) -> tuple[float, float]:
    b = float(F**2 + g * q - 1)
    s = hypot(b, 2 * sqrt(float(g * q)))
    P = (b + s) / (2 * float(g)) if b > 0 else 2 * float(q) / (s - b) if q else 0.0
    return P, float(F) / (1 + float(g) * P)
