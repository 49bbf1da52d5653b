"""Gains over a finite horizon in discrete time: single shooting through the covariance recursion."""

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal

import casadi as ca
import numpy as np

from derive.errors import InputError
from derive.numeric.fields import positive_semidefinite, symmetric
from derive.numeric.gain_descent import descend
from derive.numeric.modes import Matrix
from derive.numeric.normal import normal_form, plant_gain
from derive.numeric.plant import Plant
from derive.numeric.stabilise import stabilising_gain

__all__ = ["HorizonCost", "HorizonGains", "covariance_recursion", "optimise_horizon"]

ROUNDS = 25
"""Restarts in the metric of the last gains."""

STATIONARY = 1e-6
"""Size of the gradient, in the metric and relative to the cost, at which gains count as optimal."""


@dataclass(frozen=True, eq=False)
class HorizonGains:
    """Gains L_0 ... L_{N-1} and the covariances that they lead to.

    Attributes:
        gains: L_k (N, n, l).
        P: P_0 ... P_N (N + 1, n, n), from the recursion with these gains.
        status: "optimal" when the gradient vanishes, "inaccurate" otherwise.
        stationarity: size of the gradient in units of the cost, sqrt(g' H^-1 g / cost) with the metric H.
        history: sum of tr P_1 ... tr P_N, in balanced coordinates, before the first and after each iteration.
        iterations: of IPOPT, in all rounds.
        seconds: time taken.
    """

    gains: Matrix
    P: Matrix
    status: Literal["optimal", "inaccurate"]
    stationarity: float
    history: tuple[float, ...]
    iterations: int
    seconds: float


@dataclass(frozen=True, eq=False)
class HorizonCost:
    """The sum of tr P_1 ... tr P_N of a plant with R = I and no cross term, over x = (vec K_0, ..., vec K_{N-1}).

    P_{k+1} = U P_k U' + Q + K K' with U = F - K C, K = K_k.

    Attributes:
        F: state matrix (n, n).
        C: output matrix (l, n).
        Q: process noise (n, n).
        P0: covariance at the start (n, n).
        steps: N.
    """

    F: Matrix
    C: Matrix
    Q: Matrix
    P0: Matrix
    steps: int

    def gains(self, x: Matrix) -> Matrix:
        """Return K_0 ... K_{N-1} (N, n, l)."""
        return x.reshape(self.steps, len(self.C), len(self.F)).transpose(0, 2, 1)

    def covariances(self, x: Matrix) -> list[Matrix]:
        """Return P_0 ... P_N."""
        found: list[Matrix] = [self.P0]
        for K in self.gains(x):
            U = self.F - K @ self.C
            found.append(U @ found[-1] @ U.T + self.Q + K @ K.T)
        return found

    def value(self, x: Matrix) -> float:
        """Return the sum of tr P_1 ... tr P_N."""
        value = float(sum(np.trace(P) for P in self.covariances(x)[1:]))
        return value if np.isfinite(value) else np.inf

    def gradient(self, x: Matrix) -> Matrix:
        """Return the gradient: 2 S_{k+1} (K (C P_k C' + I) - F P_k C') for each k."""
        one = np.eye(len(self.C))
        pairs = zip(self.gains(x), self.covariances(x), self._adjoints(x), strict=False)
        slopes = [2 * S @ (K @ (self.C @ P @ self.C.T + one) - self.F @ P @ self.C.T) for K, P, S in pairs]
        return np.concatenate([slope.ravel(order="F") for slope in slopes])

    def metric(self, x: Matrix) -> Sequence[Matrix]:
        """Return the second derivative with each gain, 2 (C P_k C' + I) kron S_{k+1}, as if P_k were given.

        It is, to first order, where the gains are optimal: the second derivative is block diagonal there.
        """
        one = np.eye(len(self.C))
        pairs = zip(self.covariances(x), self._adjoints(x), strict=False)
        return [2 * np.kron(self.C @ P @ self.C.T + one, S) for P, S in pairs]

    def expression(self, x: Any) -> tuple[Any, Any]:
        """Return the sum as an expression of CasADi, by a chain of calls of one step, and the step."""
        n, l = len(self.F), len(self.C)  # noqa: E741 (the field's letter for the number of outputs)
        P, K = ca.SX.sym("P", n, n), ca.SX.sym("K", n, l)
        U = ca.DM(self.F) - K @ ca.DM(self.C)
        step = ca.Function("step", [P, K], [U @ P @ U.T + ca.DM(self.Q) + K @ K.T])
        chain = step.mapaccum("chain", self.steps)
        P = chain(ca.DM(self.P0), ca.reshape(x, n, l * self.steps))
        return ca.sum(ca.vec(P * ca.repmat(ca.DM.eye(n), 1, self.steps))), chain

    def _adjoints(self, x: Matrix) -> list[Matrix]:
        """Return S_1 ... S_N: S_N = I, S_k = I + U'S_{k+1} U with the gain K_k."""
        one = np.eye(len(self.F))
        found: list[Matrix] = [one]
        for K in self.gains(x)[:0:-1]:
            U = self.F - K @ self.C
            found.append(one + U.T @ found[-1] @ U)
        return found[::-1]


def optimise_horizon(plant: Plant, steps: int, P0: Matrix | None = None) -> HorizonGains:
    """Minimise the sum of tr P_1 ... tr P_N over the gains L_0 ... L_{N-1}, without any Riccati equation.

    P_{k+1} = (A - L_k C) P_k (A - L_k C)' + Q - L_k S' - S L_k' + L_k R L_k'. Each P_k that is reached is the least in
    the sense of Loewner, so that the sum is least in all coordinates, and its gains are those of the difference Riccati
    equation. Every gain but the last one is shot through all the steps after it; the states are the gains alone.

    Args:
        plant: discrete, Q >= 0, R > 0, [[Q, S], [S', R]] >= 0.
        steps: N, at least 1.
        P0: covariance at the start (n, n), the plant's own unless given.

    Raises:
        InputError: a continuous plant, no step, no P0 or one of the wrong shape.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> walk = plant_from_mapping({"time": "discrete", "A": [[1.0]], "C": [[1.0]], "Q": [[1.0]], "R": [[1.0]]})
        >>> found = optimise_horizon(walk, steps=30, P0=[[0.0]])
        >>> found.status, bool(abs(found.P[-1, 0, 0] - (1 + 5**0.5) / 2) < 1e-9)
        ('optimal', True)
    """
    start = perf_counter()
    first = _checked(plant, steps, P0)
    form = normal_form(plant)
    F, C, Q = form.uncorrelated()
    cost = HorizonCost(F, C, Q, form.scaled(first).astype(float), steps)
    K = stabilising_gain(F, C, "discrete")
    K = K if np.isfinite(K).all() else np.zeros_like(K)
    found = descend(cost, np.tile(K.ravel(order="F"), steps), ROUNDS)
    gains = np.array([plant_gain(plant, form, K) for K in cost.gains(found.x)])
    stationarity = float(np.sqrt(2 * found.decrement))
    return HorizonGains(
        gains=gains,
        P=covariance_recursion(plant, gains, first),
        status="optimal" if stationarity <= STATIONARY else "inaccurate",
        stationarity=stationarity,
        history=tuple(cost.value(x) for x in found.points),
        iterations=found.iterations,
        seconds=perf_counter() - start,
    )


def covariance_recursion(plant: Plant, gains: Matrix, P0: Matrix) -> Matrix:
    """Return P_0 ... P_N (N + 1, n, n) for gains L_0 ... L_{N-1} (N, n, l)."""
    found = [np.asarray(P0, dtype=float)]
    for L in gains:
        U, cross = plant.A - L @ plant.C, L @ plant.N.T
        P = U @ found[-1] @ U.T + plant.W - cross - cross.T + L @ plant.V @ L.T
        found.append((P + P.T) / 2)
    return np.array(found)


def _checked(plant: Plant, steps: int, P0: Matrix | None) -> Matrix:
    """Return P_0."""
    if plant.is_continuous:
        raise InputError('time: expected "discrete", got "continuous"; gains over steps need a sampled plant')
    if steps < 1:
        raise InputError(f"steps: expected at least 1, got {steps}; give the number of gains")
    first = plant.P0 if P0 is None else np.asarray(P0, dtype=float)
    if first is None:
        raise InputError("P0: expected the covariance at the start, got none; give it with the plant or as an argument")
    if first.shape != (plant.n, plant.n):
        raise InputError(f"P0: expected shape {(plant.n, plant.n)}, got {first.shape}; one row and column a state")
    return positive_semidefinite("P0", symmetric("P0", first), "correct its entries")
