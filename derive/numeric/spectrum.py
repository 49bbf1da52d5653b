"""The cost of the optimal estimator from the spectrum of the output: log-determinant integral, Hamiltonian modes."""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import Matrix, Time, distance_to_stability
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant
from derive.numeric.quadrature import Quadrature, integrate

__all__ = ["HamiltonianResult", "IntegralResult", "hamiltonian_route", "output_cost", "output_error_integral"]

INTEGRAL_RTOL = 1e-13
BLOCK = 16
"""Columns that are solved for together."""

CHUNK = 512
"""Frequencies evaluated at a time, which bounds the memory."""


@dataclass(frozen=True)
class IntegralResult:
    """The output cost by the integral.

    Attributes:
        value: tr(C P C' V^-1), in discrete time ln det(C P C' + R).
        unstable_term: 2 sum max(0, Re lambda_i), in discrete time 2 sum max(0, ln |lambda_i|), contained in `value`.
        error_estimate: estimated absolute error of the quadrature.
        evaluations: number of frequencies at which the spectrum was evaluated.
    """

    value: float
    unstable_term: float
    error_estimate: float
    evaluations: int


@dataclass(frozen=True, eq=False)
class HamiltonianResult:
    """The output cost by eigenvalues.

    Attributes:
        value: as of `IntegralResult`; not a number when the eigenvalues do not split.
        modes: stable eigenvalues of the Hamiltonian matrix or the symplectic pencil: those of the optimal A - L C,
            without the unexcited boundary modes.
    """

    value: float
    modes: NDArray[Any]


def output_cost(plant: Plant, P: Matrix) -> float:
    """Return tr(C P C' V^-1), in discrete time ln det(C P C' + R), for a given covariance P (n, n)."""
    if plant.is_continuous:
        return float(np.trace(np.linalg.solve(plant.V, plant.C @ P @ plant.C.T)))
    return float(np.linalg.slogdet(plant.C @ P @ plant.C.T + plant.V)[1])


def output_error_integral(plant: Plant) -> IntegralResult:
    """Integrate the logarithm of the output's spectrum.

    Continuous: tr(C P C' V^-1) = (1/2 pi) int ln(det Phi / det V) dw + 2 sum max(0, Re lambda_i(F)).
    Discrete: ln det(C P C' + R) = (1/2 pi) int_{-pi}^{pi} ln det Phi dw + 2 sum max(0, ln |lambda_i(F)|).

    Here F = A - N V^-1 C, and Phi = C (s - F)^-1 (W - N V^-1 N') (s - F)^-* C' + V is the spectrum of the output of the
    plant whose cross term was removed by feeding N V^-1 y back, which changes neither P nor the innovation. Without
    cross term F = A and Phi is the spectrum of y. With it, the spectrum Phi_y of y itself gives
    tr(C P C' V^-1) + tr(C N V^-1) = (1/2 pi) int ln(det Phi_y / det V) dw + 2 sum max(0, Re lambda_i(A)).
    Modes of F on the boundary make logarithmic singularities, which are integrated; those that the noise does not
    excite are not seen by Phi and are removed first.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable.

    Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, arXiv:1807.08604 (2018), equation (12). Discrete time follows
        in the same way from Jensen's formula.
    """
    form = _excited(plant)
    spectrum = _Spectrum.of(form)
    modes = spectrum.modes
    if plant.is_continuous:
        unstable = 2 * float(np.maximum(distance_to_stability(modes, plant.time), 0.0).sum())
        parts = _over_the_axis(spectrum)
    else:
        unstable = 2 * float(np.log(np.maximum(np.abs(modes), 1.0)).sum())
        parts = _over_the_circle(spectrum)
    noise = 0.0 if plant.is_continuous else float(np.linalg.slogdet(plant.V)[1])
    return IntegralResult(
        value=sum(part.value for part in parts) / np.pi + unstable + noise,
        unstable_term=unstable,
        error_estimate=sum(part.error for part in parts) / np.pi,
        evaluations=sum(part.evaluations for part in parts),
    )


def hamiltonian_route(plant: Plant) -> HamiltonianResult:
    """Take the cost from the stable modes p_i of the Hamiltonian matrix, in discrete time of the symplectic pencil.

    Continuous: tr(C P C' V^-1) = tr F - sum p_i, the p_i being the eigenvalues of F - P C'V^-1 C, F = A - N V^-1 C.
    Discrete: ln det(C P C' + R) = ln det Phi(z) + sum ln |z - lambda_i(F)|^2 - sum ln |z - p_i|^2 for any |z| = 1.

    Source: the spectral factorisation Phi = (I + G) V (I + G~); continuous time: arXiv:1807.08604 (2018), theorem 2.
    """
    form = _excited(plant)
    F, C, W = form.uncorrelated()
    G = C.T @ C
    zero, one = np.zeros_like(F), np.eye(len(F))
    if plant.is_continuous:
        modes = np.linalg.eigvals(np.block([[F.T, -G], [-W, -F]]))
        modes = modes[np.argsort(modes.real)][: len(F)]
        value = float(np.trace(F) - modes.real.sum())
    else:
        from scipy.linalg import eigvals

        pencil = np.block([[F.T, zero], [-W, one]]), np.block([[one, G], [zero, F]])
        numerator, denominator = np.asarray(eigvals(*pencil, homogeneous_eigvals=True))
        stable = np.argsort(np.arctan2(np.abs(numerator), np.abs(denominator)))[: len(F)]
        with np.errstate(divide="ignore", invalid="ignore"):
            modes = numerator[stable] / denominator[stable]
        value = _log_det_by_modes(_Spectrum.of(form), modes) + float(np.linalg.slogdet(plant.V)[1])
    split = np.isfinite(value) and bool(np.all(distance_to_stability(modes, plant.time) < 0))
    return HamiltonianResult(value if split else float("nan"), modes)


def _excited(plant: Plant) -> NormalForm:
    form = normal_form(plant)
    return form.without(form.boundary())


def _log_det_by_modes(spectrum: "_Spectrum", modes: NDArray[Any]) -> float:
    """Return ln det(I + C P C') from one frequency, the one farthest from all modes."""
    angles = np.linspace(0.0, np.pi, 33)
    points = np.exp(1j * angles)
    every = np.concatenate([modes, spectrum.modes])
    far = int(np.argmax(np.abs(points[:, None] - every).min(axis=1, initial=2.0)))
    log = np.log(np.abs(points[far] - spectrum.modes)).sum() - np.log(np.abs(points[far] - modes)).sum()
    return float(spectrum(np.array([angles[far]]), np.zeros(1))[0] + 2 * log)


@dataclass(frozen=True, eq=False)
class _Spectrum:
    """The function w -> ln det(I + H H*), H = C (s - F)^-1 G with W = G G', by the complex Schur form of F."""

    T: NDArray[Any]
    C: NDArray[Any]
    G: NDArray[Any]
    time: Time
    rate: float

    @classmethod
    def of(cls, form: NormalForm) -> "_Spectrum":
        from scipy.linalg import schur

        F, C, W = form.uncorrelated()
        sizes, vectors = np.linalg.eigh(W) if len(W) else (np.zeros(0), np.zeros((0, 0)))
        excited = sizes > 0
        T, Z = cast(tuple[Any, Any], schur(F, output="complex")) if len(F) else (F.astype(complex), F.astype(complex))
        G = vectors[:, excited] * np.sqrt(sizes[excited])
        rate = max(float(np.linalg.norm(F)), float(np.linalg.norm(C) * np.linalg.norm(G)))
        return cls(T, C @ Z, Z.conj().T @ G, form.time, rate)

    @property
    def modes(self) -> NDArray[np.complexfloating[Any, Any]]:
        """Eigenvalues of F."""
        return np.diag(self.T)

    def __call__(self, centre: Matrix, offset: Matrix) -> Matrix:
        """Return ln det(I + H H*) at s = j w or e^(j w), w = centre + offset."""
        chunks = [slice(i, i + CHUNK) for i in range(0, len(offset), CHUNK)]
        return np.concatenate([self._chunk(centre[chunk], offset[chunk]) for chunk in chunks])

    def _chunk(self, centre: Matrix, offset: Matrix) -> Matrix:
        if self.G.shape[1] == 0:
            return np.zeros(len(offset))
        if len(self.C) <= self.G.shape[1]:
            H = self._rows(self._poles(centre, offset)) @ self.G
        else:
            H = self.C @ self._columns(self._poles(centre, offset))
        small = H @ H.conj().swapaxes(1, 2) if H.shape[1] <= H.shape[2] else H.conj().swapaxes(1, 2) @ H
        return np.log1p(np.maximum(np.linalg.eigvalsh(small), 0.0)).sum(axis=1)

    def _poles(self, centre: Matrix, offset: Matrix) -> NDArray[Any]:
        """Return 1 / (s - lambda_i) (k, n), accurate for s near a boundary mode at the centre."""
        if self.time == "continuous":
            gap = 1j * (offset[:, None] + (centre[:, None] - self.modes.imag)) - self.modes.real
            return 1 / gap
        turn = np.exp(1j * centre)[:, None]
        gap = np.exp(1j * offset)[:, None] - self.modes / turn
        return 1 / (turn * gap)

    def _rows(self, poles: NDArray[Any]) -> NDArray[Any]:
        """Return C (s - T)^-1 (k, l, n) column by column, each block of them from the columns before it at once."""
        k, (l, n) = len(poles), self.C.shape  # noqa: E741
        X = np.empty((n, l * k), complex)
        for first in range(0, n, BLOCK):
            last = min(first + BLOCK, n)
            X[first:last] = self.T[:first, first:last].T @ X[:first] + np.repeat(self.C[:, first:last].T, k, axis=1)
            for j in range(first, last):
                X[j] += self.T[first:j, j] @ X[first:j]
                X[j] *= np.tile(poles[:, j], l)
        return X.reshape(n, l, k).transpose(2, 1, 0)

    def _columns(self, poles: NDArray[Any]) -> NDArray[Any]:
        """Return (s - T)^-1 G (k, n, q) row by row."""
        X = np.empty((len(poles), *self.G.shape), complex)
        for i in range(len(self.T) - 1, -1, -1):
            X[:, i, :] = (self.G[i] + self.T[i, i + 1 :] @ X[:, i + 1 :, :]) * poles[:, i, None]
        return X


def _over_the_axis(spectrum: _Spectrum) -> list[Quadrature]:
    """Integrate from 0 to infinity: panels around the resonances, then a tail w = end / v."""
    modes = spectrum.modes
    resonances = _distinct(np.abs(modes.imag))
    rate = spectrum.rate or 1.0
    last = float(resonances[-1])
    panels = _panels(resonances, last + rate)

    def tail(_: Matrix, v: Matrix) -> Matrix:
        return spectrum(np.full(len(v), last), rate / v) * rate / v**2

    near = integrate(spectrum, panels, INTEGRAL_RTOL)
    return [near, integrate(tail, np.array([[0.0, 0.0, 1.0]]), INTEGRAL_RTOL, known=near.value)]


def _over_the_circle(spectrum: _Spectrum) -> list[Quadrature]:
    """Integrate from 0 to pi."""
    resonances = _distinct(np.append(np.abs(np.angle(spectrum.modes)), np.pi))
    return [integrate(spectrum, _panels(resonances, np.pi), INTEGRAL_RTOL)]


def _distinct(values: Matrix) -> Matrix:
    """Return 0 and the values, sorted, without repetitions."""
    return np.unique(np.append(values, 0.0))


def _panels(resonances: Matrix, end: float) -> Matrix:
    """Return rows (resonance, from, to): each half-way to the next resonance, the last up to `end`."""
    rows = []
    for i, centre in enumerate(resonances):
        if i > 0:
            rows.append((centre, (resonances[i - 1] - centre) / 2, 0.0))
        if i + 1 < len(resonances):
            rows.append((centre, 0.0, (resonances[i + 1] - centre) / 2))
        elif end > centre:
            rows.append((centre, 0.0, end - centre))
    return np.array(rows)
