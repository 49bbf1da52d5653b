"""Adaptive Gauss-Legendre quadrature whose panels remember their centre: for integrands with poles near the line."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.numeric.modes import Matrix

__all__ = ["Quadrature", "integrate"]

FINE, FINE_WEIGHTS = np.polynomial.legendre.leggauss(20)
COARSE, COARSE_WEIGHTS = np.polynomial.legendre.leggauss(15)

ROUNDING = 4 * np.finfo(float).eps
"""Relative difference of the two rules on one panel that is put down to rounding."""

BISECTIONS = 60
"""Bisections of one panel. A logarithmic singularity at its centre loses half its error with each."""

PANELS = 4096
"""Panels in one sweep beyond which the differences are rounding errors of f, which no bisection removes."""


@dataclass(frozen=True)
class Quadrature:
    """An integral, the sum of the differences of the two rules, and the number of points."""

    value: float
    error: float
    evaluations: int


def integrate(f: Callable[[Matrix, Matrix], Matrix], panels: Matrix, rtol: float, known: float = 0.0) -> Quadrature:
    """Integrate f(centre, offset) over panels of offsets, bisecting those where 20 and 15 points disagree.

    Points near a centre keep their relative accuracy because centre and offset are never added before f does it.

    Args:
        f: vectorised integrand of centre and offset, both (k,), returns (k,).
        panels: rows (centre, first offset, last offset).
        rtol: error that is aimed at, relative to the integral of a positive f and what is known beside it.
        known: the part of the whole integral that is known already.
    """
    value = error = 0.0
    size = known
    evaluations = 0
    for step in range(BISECTIONS):
        centre, middle, half = panels[:, 0], (panels[:, 1] + panels[:, 2]) / 2, (panels[:, 2] - panels[:, 1]) / 2
        fine = _rule(f, centre, middle, half, FINE, FINE_WEIGHTS)
        difference = np.abs(fine - _rule(f, centre, middle, half, COARSE, COARSE_WEIGHTS))
        evaluations += len(panels) * (len(FINE) + len(COARSE))
        size = max(size, known + value + fine.sum())
        done = difference <= np.maximum(rtol * size / 64, ROUNDING * np.abs(fine))
        if step == BISECTIONS - 1 or len(panels) > PANELS:
            done[:] = True
        value, error = value + fine[done].sum(), error + difference[done].sum()
        left, right = panels[~done].copy(), panels[~done].copy()
        if len(left) == 0:
            break
        left[:, 2] = right[:, 1] = middle[~done]
        panels = np.concatenate([left, right])
    return Quadrature(float(value), float(error + ROUNDING * size), evaluations)


def _rule(
    f: Callable[[Matrix, Matrix], Matrix], centre: Matrix, middle: Matrix, half: Matrix, nodes: Matrix, weights: Matrix
) -> Matrix:
    offsets = middle[:, None] + half[:, None] * nodes
    values = f(np.repeat(centre, len(nodes)), offsets.ravel())
    return values.reshape(offsets.shape) @ weights * half
