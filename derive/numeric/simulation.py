"""Simulated estimation errors: their sample covariance with confidence intervals, and paths to look at.

What is simulated is the error e = x - x_o of the observer with a given gain L, driven by seeded white noise:

    continuous: e' = (A - L C) e + w - L v          discrete: e_{k+1} = (A - L C) e_k + w_k - L v_k

The steady covariance is used nowhere. Every run starts at e = 0 and its beginning is left out, so what comes out tests
whether a covariance belongs to the gain; whether the gain is optimal it does not tell.
"""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from derive.numeric.extended import cholesky
from derive.numeric.modes import Matrix, distance_to_stability, format_mode
from derive.numeric.normal import NormalForm, normal_form
from derive.numeric.plant import Plant

__all__ = ["LEVEL", "Estimate", "Paths", "Sample", "Simulation", "error_paths", "simulate_error"]

SEED = 20250321
LEVEL = 0.999
"""Probability with which an interval holds the covariance that it estimates."""

RESOLUTION = 32
"""Steps to the slowest time constant, continuous time."""

SKIPPED = 10
"""Slowest time constants that are left out at the start: what is missing there has decayed by exp(-20)."""

SAMPLED = 20
"""Slowest time constants over which a run is averaged."""

SPACING = 4
"""Samples to the slowest time constant."""

NUMBERS = 3_000_000
"""Normal numbers drawn, about 0.1 s."""

RUNS = 64, 2000
"""Fewest and most runs."""

LONGEST = 300
"""Slowest time constant of a discrete plant in steps, up to which it is simulated."""

STIFFEST = 1e6
"""Ratio of the slowest to the fastest time constant of a continuous plant, up to which it is simulated."""


@dataclass(frozen=True)
class Estimate:
    """A mean over independent runs.

    Attributes:
        value: the mean.
        deviation: its standard deviation, estimated from the runs.
        half_width: of the confidence interval at `LEVEL`, by Student's distribution.
        bias: by how much the mean may be too small, as the runs started at 0.
    """

    value: float
    deviation: float
    half_width: float
    bias: float = 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """The confidence interval, its upper end moved up by the bias."""
        return self.value - self.half_width, self.value + self.half_width + self.bias


@dataclass(frozen=True, eq=False)
class Sample:
    """The sample covariance of simulated errors.

    Attributes:
        P: sample covariance (n, n).
        trace: estimate of tr P.
        cost: estimate of tr(M P).
        variances: estimates of the n variances.
        runs: number of independent runs.
        steps: steps of each run, the skipped ones included.
        skipped: steps left out at the start.
        step: duration of a step [s]; in discrete time 1 step.
        running: estimates of tr(M P) from 8, 16, 32, ... runs, and from all of them.
    """

    P: Matrix
    trace: Estimate
    cost: Estimate
    variances: tuple[Estimate, ...]
    runs: int
    steps: int
    skipped: int
    step: float
    running: tuple[tuple[int, Estimate], ...]


@dataclass(frozen=True, eq=False)
class Simulation:
    """What became of a simulation: its sample, or None with the reason in the status."""

    status: str
    sample: Sample | None = None


@dataclass(frozen=True, eq=False)
class Paths:
    """A few simulated errors over time, from e = 0.

    Attributes:
        times: (k,) [s], in discrete time numbers of steps, times dt where the plant gives it.
        errors: (runs, k, n).
        inside: share of the errors within three of the given standard deviations, over many runs and after the start;
            0.9973 for normal errors that have these deviations.
    """

    times: Matrix
    errors: Matrix
    inside: float


@dataclass(frozen=True, eq=False)
class _Recursion:
    """e <- Phi e + B u with u standard normal: the error from one instant to the next, in the normal form.

    Attributes:
        Phi: (n, n).
        B: (n, q).
        slowest: the slowest time constant in steps.
        step: duration of a step [s], or 1.
    """

    Phi: Matrix
    B: Matrix
    slowest: float
    step: float


def simulate_error(plant: Plant, gain: Matrix, seed: int = SEED) -> Simulation:
    """Estimate the steady error covariance of a gain from independent simulated runs.

    Discrete time runs the error's recursion as it is, with (w, v) drawn from [[W, N], [N', V]]. Continuous time takes
    it from instant to instant exactly: e(t + h) = exp(F h) e(t) + noise of covariance int_0^h exp(F s) S exp(F' s) ds
    with F = A - L C and S = W - L N' - N L' + L V L'; h is a small part of the slowest time constant. Each run is
    averaged over time; the runs are independent, so that the spread of these averages gives the error of their mean,
    however correlated the errors within a run are.

    Args:
        plant: the plant.
        gain: L (n, l), with A - L C asymptotically stable.
        seed: of the noise; the same seed gives the same sample.

    Returns:
        The sample; none, with the reason, when A - L C is not stable, or too slow to be simulated.

    Source: C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Automat. Control 23 (1978)
        395-404, for the noise over a step.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> from derive.numeric.riccati import solve_riccati
        >>> plant, known = example_plant(), solve_riccati(example_plant())
        >>> lower, upper = simulate_error(plant, known.gain).sample.trace.interval
        >>> lower < known.P.trace() < upper
        True
    """
    form, F, reason = _closed_loop(plant, gain)
    if reason:
        return Simulation(reason)
    recursion = _recursion(plant, form, F, gain)
    return Simulation("sampled", _sample(plant, form, recursion, np.random.default_rng(seed)))


def error_paths(plant: Plant, gain: Matrix, deviations: Matrix, runs: int = 4, seed: int = SEED) -> Paths | None:
    """Simulate a few errors from e = 0 over some slow time constants, and count how many are where they should be.

    Args:
        plant: the plant.
        gain: L (n, l).
        deviations: steady standard deviations of the errors (n,).
        runs: how many to return.
        seed: of the noise.

    Returns:
        The errors; None where `simulate_error` gives no sample.
    """
    form, F, reason = _closed_loop(plant, gain)
    if reason:
        return None
    recursion = _recursion(plant, form, F, gain)
    steps = max(40, int(np.ceil(SKIPPED * recursion.slowest)))
    rng = np.random.default_rng(seed)
    many = max(runs, RUNS[0])
    e, course = np.zeros((plant.n, many)), [np.zeros((plant.n, many))]
    for _ in range(steps):
        e = recursion.Phi @ e + recursion.B @ rng.standard_normal((recursion.B.shape[1], many))
        course.append(e)
    errors = np.array(course).transpose(2, 0, 1) * form.scaling.astype(float)
    inside = float(np.mean(np.abs(errors[:, steps // 2 :]) <= 3 * deviations))
    duration = recursion.step * (1.0 if plant.is_continuous else plant.dt or 1.0)
    return Paths(np.arange(steps + 1) * duration, errors[:runs], inside)


# ------------------------------------------------------------------------------------------------ one step
def _closed_loop(plant: Plant, gain: Matrix) -> tuple[NormalForm, Matrix, str]:
    """Return the normal form, A - L C in it, and why it is not simulated, if so."""
    form = normal_form(plant)
    F = (form.A - _scaled_gain(plant, form, gain) @ form.C).astype(float)
    if not np.isfinite(F).all():
        return form, F, "not applicable: the gain is not a matrix of numbers"
    modes = np.linalg.eigvals(F)
    worst = modes[np.argmax(distance_to_stability(modes, plant.time))]
    if distance_to_stability(worst, plant.time) >= 0:
        return form, F, f"not applicable: mode {format_mode(worst)} of A - L C does not decay, so no error is steady"
    return form, F, _too_slow(plant, modes)


def _scaled_gain(plant: Plant, form: NormalForm, gain: Matrix) -> Matrix:
    """Return the gain on the outputs of unit noise, for the scaled states."""
    return gain @ cholesky(plant.V.astype(np.longdouble)) / form.scaling[:, None]


def _too_slow(plant: Plant, modes: NDArray[Any]) -> str:
    """Return why the modes cannot be simulated, or nothing."""
    slowest = _time_constant(plant, modes)
    mode = format_mode(modes[np.argmax(distance_to_stability(modes, plant.time))])
    if not plant.is_continuous:
        return "" if slowest <= LONGEST else (
            f"not applicable: slowest time constant {slowest:.2g} steps (mode {mode}); up to {LONGEST} are simulated"
        )  # fmt: skip
    ratio = slowest * float(np.abs(modes).max())
    return "" if ratio <= STIFFEST else (
        f"not applicable: slowest time constant {slowest:.2g} s (mode {mode}), {ratio:.0e} times the fastest; "
        f"up to {STIFFEST:.0e} is simulated"
    )  # fmt: skip


def _time_constant(plant: Plant, modes: NDArray[Any]) -> float:
    """Return the slowest time constant in seconds or steps."""
    rates = -np.real(modes) if plant.is_continuous else -np.log(np.maximum(np.abs(modes), np.finfo(float).tiny))
    return 1.0 / float(rates.min())


def _recursion(plant: Plant, form: NormalForm, F: Matrix, gain: Matrix) -> _Recursion:
    slowest = _time_constant(plant, np.linalg.eigvals(F))
    joint = np.block([[form.W, form.N], [form.N.T, np.eye(plant.l)]]).astype(float)
    B = np.hstack([np.eye(plant.n), -_scaled_gain(plant, form, gain).astype(float)]) @ _root(joint)
    if not plant.is_continuous:
        return _Recursion(F, B, slowest, 1.0)
    step = slowest / RESOLUTION
    Phi, noise = _over_a_step(F, B @ B.T, step)
    return _Recursion(Phi, _root(noise), float(RESOLUTION), step)


def _root(X: Matrix) -> Matrix:
    """Return a root R of X = R R' >= 0, with as many columns as X has rank; rows and columns may differ in size."""
    sizes = np.sqrt(np.maximum(np.diag(X), 0.0))
    sizes = np.where(sizes > 0, sizes, 1.0)
    variances, directions = np.linalg.eigh(X / np.outer(sizes, sizes))
    kept = variances > len(X) * np.finfo(float).eps * max(float(variances.max()), 0.0)
    return sizes[:, None] * directions[:, kept] * np.sqrt(variances[kept])


def _over_a_step(F: Matrix, S: Matrix, step: float) -> tuple[Matrix, Matrix]:
    """Return exp(F h) and int_0^h exp(F s) S exp(F' s) ds: over a short time by one exponential, then doubled."""
    from scipy.linalg import expm

    n = len(F)
    doublings = max(0, int(np.ceil(np.log2(max(2 * np.linalg.norm(F) * step, 1.0)))))
    block = expm(np.block([[-F, S], [np.zeros_like(F), F.T]]) * (step / 2**doublings))
    Phi = block[n:, n:].T
    noise = Phi @ block[:n, n:]
    for _ in range(doublings):
        noise = noise + Phi @ noise @ Phi.T
        Phi = Phi @ Phi
    return Phi, (noise + noise.T) / 2


# ------------------------------------------------------------------------------------------------ many runs
def _sample(plant: Plant, form: NormalForm, recursion: _Recursion, rng: np.random.Generator) -> Sample:
    n, q = recursion.B.shape
    skipped = max(n, int(np.ceil(SKIPPED * recursion.slowest)))
    spacing = max(1, int(recursion.slowest / SPACING))
    taken = SPACING * SAMPLED
    steps = skipped + taken * spacing
    runs = int(np.clip(NUMBERS // (steps * max(q, 1)), *RUNS))
    squares, P = _averages(recursion, (runs, skipped, taken, spacing), _weight(plant, form), rng)
    unit = form.scaling.astype(float)
    missing = _missing(recursion.Phi, skipped, P)
    biases = np.append(np.diag(missing) * unit**2, np.trace(plant.M @ form.unscaled(missing)))
    values = np.vstack([squares[:n] * unit[:, None] ** 2, squares[n]])
    *variances, cost = (_estimate(row, float(bias)) for row, bias in zip(values, biases, strict=True))
    counts = [count for count in 2 ** np.arange(3, 12) if count < runs]
    running = tuple((int(count), _estimate(values[n, :count])) for count in counts)
    trace = _estimate(values[:n].sum(axis=0), float(biases[:n].sum()))
    covariance = form.unscaled(P).astype(float)
    settings = (runs, steps, skipped, recursion.step, (*running, (runs, cost)))
    return Sample(covariance, trace, cost, tuple(variances), *settings)


def _weight(plant: Plant, form: NormalForm) -> Matrix:
    """Return a root of the weight of the scaled states."""
    unit = form.scaling.astype(float)
    return _root(plant.M * np.outer(unit, unit)).T


def _averages(
    recursion: _Recursion, counts: tuple[int, int, int, int], weight: Matrix, rng: np.random.Generator
) -> tuple[Matrix, Matrix]:
    """Return averages over time of e_i^2 and of |weight e|^2 (n + 1, runs), and of e e' over all runs (n, n)."""
    runs, skipped, taken, spacing = counts
    Phi, B = recursion.Phi, recursion.B
    n, q = B.shape
    e, squares, P = np.zeros((n, runs)), np.zeros((n + 1, runs)), np.zeros((n, n))
    for k in range(1, skipped + taken * spacing + 1):
        e = Phi @ e + B @ rng.standard_normal((q, runs))
        if k > skipped and (k - skipped) % spacing == 0:
            squares[:n] += e**2
            squares[n] += ((weight @ e) ** 2).sum(axis=0)
            P += e @ e.T
    return squares / taken, P / (taken * runs)


def _missing(Phi: Matrix, skipped: int, P: Matrix) -> Matrix:
    """Return Phi^k P Phi'^k, by which the covariance is too small after k steps from 0."""
    power = np.linalg.matrix_power(Phi, skipped)
    return power @ P @ power.T


def _estimate(averages: Matrix, bias: float = 0.0) -> Estimate:
    """Return the mean of independent averages with its interval."""
    from scipy.special import stdtrit

    runs = len(averages)
    deviation = float(np.std(averages, ddof=1) / np.sqrt(runs))
    quantile = float(cast(Any, stdtrit)(runs - 1, (1 + LEVEL) / 2))
    return Estimate(float(np.mean(averages)), deviation, quantile * deviation, bias)
