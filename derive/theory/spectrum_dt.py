"""The frequency domain in discrete time: Jensen's formula, and the innovation covariance by the output's spectrum.

Beyond the source, which leaves the discrete counterpart of its theorem 1 to its reference [35]: S. Fang, H. Ishii,
J. Chen, K. H. Johansson, A Frequency-Domain Characterization of Optimal Error Covariance for the Kalman-Bucy Filter,
arXiv:1807.08604, 2018. Covariances Q, R; the letter s stands for z.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Lecture
from derive.theory import (
    spectrum_circle,
    spectrum_discrete,
    spectrum_dt_matrix,
    spectrum_dt_theorem,
    spectrum_poisson,
    spectrum_roots,
)
from derive.theory.spectrum_builder import SpectrumBuilder

KEY, THEORY = "spectrum-dt", "spectrum-dt"
PARTS = (spectrum_roots, spectrum_poisson, spectrum_circle, spectrum_discrete, spectrum_dt_matrix, spectrum_dt_theorem)


@cache
def theory() -> Theory:
    """Return the theory ``spectrum-dt``: the steady predictor, generic s, eigenvalues and the unit circle."""
    t = Theory(THEORY, "Frequency domain in discrete time")
    for part in PARTS:
        part.declare(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = SpectrumBuilder(theory(), KEY, "The innovation covariance in the frequency domain", ("001",))
    for part in PARTS:
        part.derive(b)
    return b.lecture()
