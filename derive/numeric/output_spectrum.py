"""The spectrum of the output as a curve whose area is the integral in the formula of the output cost."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import Matrix
from derive.numeric.plant import Plant
from derive.numeric.spectrum import hamiltonian_route, output_error_integral

__all__ = ["OutputSpectrum", "log_det_spectrum", "output_spectrum"]

POINTS = 100
"""Frequencies spread evenly over the axis, to which those around the resonances are added."""

AROUND = 14
"""Frequencies on either side of a resonance, at distances in geometric progression."""

REACH = 0.5
"""Distance from a resonance of the farthest of them, relative to its frequency, in discrete time in rad."""

NARROWEST = 1e-5
"""Distance of the nearest, likewise, where the resonance is narrower."""

MARGIN = 1e3
"""How far the axis is sampled beyond the slowest and the fastest mode."""

CUT = 1e-3
"""Part of the area that is cut off with either end of the curve."""

ROUNDING = 1e-13
"""Logarithm of a spectrum that is nothing but rounding."""


@dataclass(frozen=True, eq=False)
class OutputSpectrum:
    """A curve over frequency and the terms of the output cost.

    Continuous: area + unstable_term = tr(C P C' V^-1) + tr(C N V^-1), and `heights` is (w / pi) ln(det Phi_y / det V)
    over ln w: over that axis (w / pi) ln(...) d(ln w) = (1 / pi) ln(...) dw, and the negative frequencies count as much
    as the positive ones. Discrete: area + unstable_term = ln det(C P C' + R) - ln det R, and `heights` is
    (1 / pi) ln(det Phi_y / det R) over w.

    Attributes:
        frequencies: w (k,) [rad/s], in discrete time [rad] from 0 to pi.
        heights: (k,) [1/s], in discrete time without unit.
        area: (1/2 pi) int ln(det Phi_y / det V) dw over all frequencies, by quadrature.
        unstable_term: 2 sum max(0, Re lambda_i(A)), in discrete time 2 sum max(0, ln |lambda_i(A)|).
        cross_term: tr(C N V^-1); 0 in discrete time.
    """

    frequencies: Matrix
    heights: Matrix
    area: float
    unstable_term: float
    cross_term: float

    @property
    def total(self) -> float:
        """tr(C P C' V^-1), in discrete time ln det(C P C' + R) - ln det R."""
        return self.area + self.unstable_term - self.cross_term


def output_spectrum(plant: Plant) -> OutputSpectrum:
    """Sample the spectrum of the output where it matters, and integrate it.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.

    Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, arXiv:1807.08604 (2018), equation (12), and its counterparts
        with cross term and in discrete time.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> curve = output_spectrum(example_plant())
        >>> round(curve.total, 6)
        2.803894
    """
    modes = np.linalg.eigvals(plant.A)
    w = _frequencies(plant, modes)
    logs = log_det_spectrum(plant, w)
    heights = np.where(np.abs(logs) > ROUNDING, logs, 0.0) * (w if plant.is_continuous else 1.0) / np.pi
    if plant.is_continuous:
        unstable = 2 * float(np.maximum(np.real(modes), 0.0).sum())
        cross, noise = float(np.trace(np.linalg.solve(plant.V, plant.C @ plant.N))), 0.0
        shown = _shown(w, heights)
    else:
        unstable = 2 * float(np.log(np.maximum(np.abs(modes), 1.0)).sum())
        cross, noise = 0.0, float(np.linalg.slogdet(plant.V)[1])
        shown = slice(None)
    area = output_error_integral(plant).value - noise + cross - unstable
    return OutputSpectrum(w[shown], heights[shown], area, unstable, cross)


def log_det_spectrum(plant: Plant, frequencies: Matrix) -> Matrix:
    """Return ln(det Phi_y / det V) at frequencies w (k,), Phi_y = C X W X* C' + C X N + N' X* C' + V.

    X = (s - A)^-1 with s = j w, in discrete time s = e^(j w).
    """
    s = 1j * frequencies if plant.is_continuous else np.exp(1j * frequencies)
    resolvent = np.linalg.inv(s[:, None, None] * np.eye(plant.n) - plant.A)
    CX = plant.C @ resolvent
    cross = CX @ plant.N
    Phi = CX @ plant.W @ CX.conj().swapaxes(1, 2) + cross + cross.conj().swapaxes(1, 2) + plant.V
    return np.linalg.slogdet(np.linalg.solve(plant.V, Phi))[1]


def _shown(w: Matrix, heights: Matrix) -> slice:
    """Return where the curve is to be seen, or the middle of the axis when it is nowhere."""
    panels = np.abs(heights[1:] + heights[:-1]) / 2 * np.diff(np.log(w))
    below = np.append(0.0, np.cumsum(panels))
    if below[-1] > 0:
        inside = (below >= CUT * below[-1]) & (below <= (1 - CUT) * below[-1])
    else:
        inside = (w > w[0] * MARGIN / 10) & (w < w[-1] / MARGIN * 10)
    seen = np.flatnonzero(inside)
    return slice(max(seen[0] - 1, 0), seen[-1] + 2)


def _frequencies(plant: Plant, modes: NDArray[Any]) -> Matrix:
    """Return frequencies over all that the modes of A and of A - L C tell apart, denser around the resonances."""
    if plant.is_continuous:
        rates = np.abs(np.concatenate([modes, hamiltonian_route(plant).modes]))
        rates = rates[rates > 0] if np.any(rates > 0) else np.ones(1)
        spread = np.geomspace(rates.min() / MARGIN, rates.max() * MARGIN, 2 * POINTS)
        resonances, widths = np.abs(np.imag(modes)), np.abs(np.real(modes))
        reach = REACH * resonances
    else:
        spread = np.linspace(NARROWEST, np.pi - NARROWEST, POINTS)
        resonances = np.abs(np.angle(modes))
        widths, reach = np.abs(np.abs(modes) - 1), np.full(len(modes), REACH)
    nearest = np.clip(widths / 4, NARROWEST * reach, reach)
    steps = np.linspace(0.0, 1.0, AROUND)
    distances = nearest[:, None] ** (1 - steps) * reach[:, None] ** steps
    around = np.concatenate([resonances[:, None] - distances, resonances[:, None] + distances]).ravel()
    end = spread[-1] if plant.is_continuous else np.pi
    return np.unique(np.concatenate([spread, around[(around > 0) & (around < end)]]))
