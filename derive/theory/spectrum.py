"""The frequency domain: the error covariance of the Kalman-Bucy filter by the spectrum of its input.

Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, A Frequency-Domain Characterization of Optimal Error Covariance for
the Kalman-Bucy Filter, arXiv:1807.08604, 2018: propositions 1 and 2, theorems 1 and 2, corollary 1 and the special
cases; (1) to (4) are in the lecture on the filter, corollary 2 in that on the scalar estimator. Intensities W, V.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Lecture
from derive.theory import (
    spectrum_bode,
    spectrum_bounds,
    spectrum_cross,
    spectrum_filter,
    spectrum_half_plane,
    spectrum_jensen,
    spectrum_poisson,
    spectrum_poles,
    spectrum_roots,
    spectrum_special,
)
from derive.theory.spectrum_builder import SpectrumBuilder

KEY, THEORY = "spectrum", "spectrum"
PARTS = (
    spectrum_roots,
    spectrum_jensen,
    spectrum_poisson,
    spectrum_half_plane,
    spectrum_filter,
    spectrum_bode,
    spectrum_poles,
    spectrum_bounds,
    spectrum_special,
    spectrum_cross,
)


@cache
def theory() -> Theory:
    """Return the theory ``spectrum``: the steady filter, generic s, roots of real polynomials."""
    t = Theory(THEORY, "Frequency domain of the filter")
    for part in PARTS:
        part.declare(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = SpectrumBuilder(theory(), KEY, "The error covariance in the frequency domain", ("001",))
    for part in PARTS:
        part.derive(b)
    return b.lecture()
