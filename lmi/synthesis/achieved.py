"""What a gain achieves, recomputed from the gain alone: no program's word enters."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.modes import distance_to_stability, spectral_scale
from derive.numeric.norms import HInfNorm, h2_norm, hinf_norm
from derive.numeric.plant import Plant
from lmi.programs.observer import factor
from lmi.scaling import balanced, scaled_plant

__all__ = ["Achieved", "achieved", "norm_of"]

Matrix = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Achieved:
    """What a stabilising gain achieves, in floating point.

    Attributes:
        cost: tr(M P) with P the error covariance, the square of the H2 norm from noise to M^(1/2) e.
        hinf: the H-infinity norm of the same.
        decay: the rate [1/s] at which the slowest mode falls, in discrete time -ln|lambda| / dt (dt = 1 without one).
        modes: of A - L C, the slowest first.
    """

    cost: float
    hinf: HInfNorm
    decay: float
    modes: tuple[complex, ...]

    @property
    def h2(self) -> float:
        """The H2 norm, sqrt(tr(M P))."""
        return float(np.sqrt(self.cost))


def achieved(plant: Plant, gain: Matrix) -> Achieved | None:
    """Compute what a gain achieves: H2 by a Lyapunov equation, H-infinity by a Hamiltonian matrix's eigenvalues.

    Both are computed in balanced coordinates, so that they do not depend on the units of states, outputs and time.

    Args:
        plant: A (n, n), C (l, n), W, V, N and the weight M.
        gain: L (n, l).

    Returns:
        The values, or None when A - L C is not asymptotically stable by more than rounding.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> from derive.numeric.riccati import solve_riccati
        >>> solution = solve_riccati(example_plant())
        >>> found = achieved(example_plant(), solution.gain)
        >>> bool(abs(found.cost - solution.P.trace()) < 1e-9 * found.cost)
        True
    """
    scaling = balanced(plant)
    scaled = replace(scaled_plant(plant, scaling), M=scaling.T.T @ plant.M @ scaling.T)
    moved = np.linalg.solve(scaling.T, gain @ scaling.R) / np.sqrt(scaling.rate)
    loop = scaled.A - moved @ scaled.C
    modes = np.linalg.eigvals(loop)
    distance = distance_to_stability(modes, plant.time)
    if not np.all(distance < -plant.n * np.finfo(float).eps * spectral_scale(loop, plant.time)):
        return None
    cost = h2_norm(*_noise_to_error(scaled, moved), plant.time) ** 2
    ordered = tuple(complex(mode) * scaling.rate for mode in modes[np.argsort(-distance, kind="stable")])
    return Achieved(cost, _in_units_of(norm_of(scaled, moved), scaling.rate), _decay_of(plant, ordered[0]), ordered)


def _in_units_of(norm: HInfNorm, rate: float) -> HInfNorm:
    """Return a norm that was computed with time in units of 1 / rate."""
    unit = rate**-0.5
    return HInfNorm(norm.lower * unit, norm.upper * unit, norm.frequency * rate)


def norm_of(plant: Plant, gain: Matrix) -> HInfNorm:
    """Return the norm of M^(1/2) (sI - A + L C)^-1 [I, -L] [[W, N], [N', V]]^(1/2), in discrete time with z for s."""
    return hinf_norm(*_noise_to_error(plant, gain), plant.time)


def _noise_to_error(plant: Plant, gain: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return A - L C, [I, -L] J^(1/2) and M^(1/2)."""
    root = factor(np.block([[plant.W, plant.N], [plant.N.T, plant.V]]))
    return plant.A - gain @ plant.C, root[: plant.n] - gain @ root[plant.n :], factor(plant.M).T


def _decay_of(plant: Plant, mode: complex) -> float:
    """Return the rate at which a mode falls: -Re lambda, in discrete time -ln|lambda| / dt."""
    if plant.is_continuous:
        return -mode.real
    return -float(np.log(abs(mode))) / (plant.dt or 1.0) if mode else np.inf
