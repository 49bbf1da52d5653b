"""One state, one output: every quantity of the filter in closed form, with its degenerate cases.

Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, A Frequency-Domain Characterization of Optimal Error Covariance for
the Kalman-Bucy Filter, arXiv:1807.08604, 2018, corollary 2, for the integral; the other formulas go beyond it. With one
state and one output every letter is a real number; W and V are intensities, Q and R covariances.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Lecture
from derive.theory import (
    scalar_bounds,
    scalar_continuous,
    scalar_cross,
    scalar_discrete,
    scalar_instances,
    scalar_integral,
    scalar_limits,
    scalar_recursion,
    scalar_regulator,
    scalar_second,
    scalar_third,
    scalar_transient,
)
from derive.theory.scalar_builder import ScalarBuilder

KEY, THEORY = "scalar", "scalar"
PARTS = (
    scalar_continuous, scalar_transient, scalar_discrete, scalar_recursion, scalar_bounds, scalar_cross,
    scalar_regulator, scalar_limits, scalar_integral, scalar_second, scalar_instances, scalar_third,
)  # fmt: skip


@cache
def theory() -> Theory:
    """Return the theory ``scalar``: real parameters, W >= 0, V > 0, Q >= 0, R > 0."""
    t = Theory(THEORY, "Scalar estimator")
    for part in PARTS:
        part.declare(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = ScalarBuilder(theory(), KEY, "The scalar estimator in closed form", ("001",))
    for part in PARTS:
        part.derive(b)
    return b.lecture()
