"""The norm of a certificate: a solution of the bounded real inequality in high precision.

P = P_g + h D, where with loop = A - L C and g = gamma^-2, P_g solves G_L(P) + g P M P = 0, in discrete time
P = loop U loop' + J_L, U = (P^-1 - g M)^-1, and D is such that the left side falls by h I. P_g comes from Newton's
method started at 0, which rises to it whenever the norm is below gamma. Nothing here is trusted.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import frexp, isfinite
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpq
from numpy.typing import NDArray

from derive.numeric.balls import exact, floats, identity, middle, norm, positive_definite, working_bits
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Time
from derive.numeric.newton import lyapunov_in_balls
from derive.numeric.norms import hinf_norm
from lmi.certificate.arithmetic import Exact
from lmi.certificate.design import Norm, norm_checks, proper
from lmi.certificate.sandwich import Certificate, ExactPlant
from lmi.certification.frame import Grid, binary_logarithm, sizes
from lmi.certification.instability import is_stable
from lmi.certification.sandwich import NotCertifiedError

__all__ = ["SPARE", "Coordinates", "certified_norm", "lyapunov_witness", "plain_balls"]

Matrix = NDArray[np.floating[Any]]

ATTEMPTS = ((160, 8), (320, 40), (640, 120))
"""Working precision in bits, and bits by which h is smaller than its second order asks for."""

SPARE = 24
"""Bits by which the grid is finer than the inequalities need."""

STEPS = 60
"""Newton steps: where the norm is close to gamma, each gains one bit until the last few."""

ROUGH_RTOL = 1e-6
"""Steps smaller than this, relative, are not taken in floating point when they stop getting smaller."""

SHARES = (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2)
"""By how much more than the computed norm is claimed, relative; the first that can be proved is taken."""

SMALLEST_VARIANCE = 2.0**-100
"""Variances below this, relative to the largest, count as this when the coordinates are chosen."""


def certified_norm(cost: Certificate, asked: float | None) -> Norm | None:
    """Return the least norm that is proved, at most the one asked for."""
    plant, _, semidefinite = proper(cost.plant)
    failing = [check.statement for check in semidefinite if not check.holds]
    problem = f"{failing[0]} does not hold" if failing else "no proof found"
    if not failing:
        for gamma in _levels(plant, cost.gain, asked):
            for bits, margin in ATTEMPTS:
                try:
                    found = _norm_witness(plant, cost, gamma, bits, margin)
                except (ArithmeticError, ValueError):
                    break
                if all(check.holds for check in norm_checks(plant, cost.gain, found)):
                    return found
    if asked is None:
        return None
    raise NotCertifiedError(
        f"gamma {asked:g}: the H-infinity norm of the gain was not proved to be at most that: {problem}"
    )


@dataclass(frozen=True)
class Coordinates:
    """Coordinates x = s x_scaled with s powers of two, in balls.

    Attributes:
        exponents: of s.
    """

    exponents: tuple[int, ...]

    @classmethod
    def of_covariance(cls, P: Exact) -> "Coordinates":
        """Make the diagonal of P about 1."""
        diagonal = [float(P[i, i]) for i in range(P.shape[0])]
        largest = max(diagonal, default=0.0)
        if not (isfinite(largest) and largest > 0):
            return cls((0,) * len(diagonal))
        return cls(tuple((frexp(max(x, SMALLEST_VARIANCE * largest))[1] - 1) // 2 for x in diagonal))

    def balls(self, X: Exact, left: int, right: int) -> arb_mat:
        """Return s^left X s^right."""
        s = self.exponents
        rows = enumerate(X.numerators)
        return arb_mat(
            [
                [arb(fmpq(x, X.denominator)) * arb(2) ** (left * s[i] + right * s[j]) for j, x in enumerate(row)]
                for i, row in rows
            ]
        )

    def loop(self, X: arb_mat, bits: int) -> Exact:
        """Return s X s^-1, X rounded to multiples of 2^-bits."""
        n = len(self.exponents)
        inverse = [[Fraction(2) ** -self.exponents[i] if i == j else 0 for j in range(n)] for i in range(n)]
        return self.grid.gain(X, bits) @ Exact.of(inverse)

    @property
    def grid(self) -> Grid:
        """Rationals in the plant's coordinates from balls in these."""
        return Grid(self.exponents)


def plain_balls(X: Exact) -> arb_mat:
    """Return a rational matrix in balls."""
    return Coordinates((0,) * max(X.shape)).balls(X, 0, 0)


def lyapunov_witness(loop: arb_mat, S: arb_mat, time: Time) -> arb_mat:
    """Return Y > 0 with loop Y + Y loop' + S = 0, in discrete time loop Y loop' - Y + S = 0.

    Raises:
        NotCertifiedError: the loop is not stable, or too nearly so.
    """
    if not is_stable(floats(loop), time):
        raise NotCertifiedError("a matrix that ought to be stable is not")
    Y = middle(lyapunov_in_balls(loop.mid(), S, time))
    if not (all(x.is_finite() for x in Y.entries()) and positive_definite(Y)):
        raise NotCertifiedError("no positive definite solution of a Lyapunov equation found")
    return Y


def _levels(plant: ExactPlant, gain: Exact, asked: float | None) -> Iterator[Fraction]:
    estimate = _estimated_norm(plant, gain)
    levels = [estimate * (1 + share) for share in SHARES]
    yield from (Fraction(x) for x in levels if isfinite(x) and x > 0 and (asked is None or x < asked))
    if asked is not None and asked > 0:
        yield Fraction(asked)


def _estimated_norm(plant: ExactPlant, gain: Exact) -> float:
    """Return the H-infinity norm in floating point."""
    loop, noise, weight = (floats(plain_balls(X)) for X in (plant.loop(gain), _noise(plant, gain), plant.M))
    with np.errstate(all="ignore"):
        return hinf_norm(loop, _root(noise), _root(weight).T, plant.time).upper


def _root(X: Matrix) -> Matrix:
    """Return B with B B' = X >= 0, in coordinates in which the diagonal of X is 1."""
    d = np.sqrt(np.maximum(np.diag(X), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(X / np.outer(d, d))
    return d[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))


def _noise(plant: ExactPlant, gain: Exact) -> Exact:
    """Return W - L N' - N L' + L V L'."""
    cross = gain @ plant.N.T
    return plant.W - cross - cross.T + gain @ plant.V @ gain.T


def _norm_witness(plant: ExactPlant, cost: Certificate, gamma: Fraction, bits: int, margin: int) -> Norm:
    coordinates = Coordinates.of_covariance(cost.P_up)
    with working_bits(bits):
        equation = BoundedReal(
            coordinates.balls(plant.loop(cost.gain), -1, 1),
            coordinates.balls(_noise(plant, cost.gain), -1, -1),
            coordinates.balls(plant.M * (1 / gamma**2), 1, 1),
            plant.time,
        )
        P = equation.solution()
        loop = equation.closed_loop(P)
        D = lyapunov_witness(loop, identity(P.nrows()), plant.time)
        size = binary_logarithm(norm(D))
        k = margin + max(size, 2 * size + binary_logarithm(norm(equation.second_order(P, loop))), 0)
        G = None if plant.is_continuous else coordinates.loop(loop, k + SPARE)
        return Norm(gamma, coordinates.grid.covariance(P + D * arb(2) ** -k, k + sizes(loop) + SPARE), G)


@dataclass(frozen=True, eq=False)
class BoundedReal:
    """loop P + P loop' + G + P M P = 0, in discrete time P = loop U loop' + G with U = (P^-1 - M)^-1.

    Attributes:
        loop: A - L C (n, n).
        G: noise of the gain (n, n).
        M: the weight over gamma^2 (n, n).
        time: "continuous" or "discrete".
    """

    loop: arb_mat
    G: arb_mat
    M: arb_mat
    time: Time

    def residual(self, P: arb_mat) -> arb_mat:
        """Return the left side, in discrete time less the other."""
        if self.time == "continuous":
            half = self.loop * P
            return half + half.transpose() + self.G + P * self.M * P
        return self.closed_loop(P) * P * self.loop.transpose() + self.G - P

    def closed_loop(self, P: arb_mat) -> arb_mat:
        """Return loop + P M, in discrete time loop (I - P M)^-1."""
        if self.time == "continuous":
            return (self.loop + P * self.M).mid()
        return (self.loop * (identity(P.nrows()) - P * self.M).inv()).mid()

    def second_order(self, P: arb_mat, loop: arb_mat) -> arb_mat:
        """Return what the residual's second order consists of, between D and D: M, in discrete time with loops."""
        if self.time == "continuous":
            return self.M
        return loop * loop.transpose() * norm(self.M * (identity(P.nrows()) - P * self.M).inv())

    def solution(self) -> arb_mat:
        """Return the stabilising solution by Newton's method from 0, at first in floating point.

        Raises:
            NotCertifiedError: there is none, or too nearly so.
        """
        try:
            return self._newton(exact(self._approximate()))
        except NotCertifiedError:
            return self._newton(arb_mat(self.loop.nrows(), self.loop.nrows()))

    def _newton(self, P: arb_mat) -> arb_mat:
        before = None
        for _ in range(STEPS):
            D = _lyapunov(self.closed_loop(P), middle(self.residual(P)), self.time)
            P, step = middle(P + D), norm(D)
            if step <= norm(P) * arb(2) ** (16 - ctx.prec):
                break
            if before is not None and not step < before and step < norm(P) * arb(2) ** -60:
                break
            before = step
        return P

    def _approximate(self) -> Matrix:
        loop, G, M = (exact(floats(X)) for X in (self.loop, self.G, self.M))
        rough = BoundedReal(loop, G, M, self.time)
        P, before = np.zeros((self.loop.nrows(),) * 2), np.inf
        for _ in range(STEPS):
            loop = floats(rough.closed_loop(exact(P)))
            if not is_stable(loop, self.time):
                break
            D = solve_lyapunov(loop, floats(middle(rough.residual(exact(P)))), self.time)
            step = float(np.linalg.norm(D))
            if not step < before and step <= ROUGH_RTOL * np.linalg.norm(P):
                break
            P, before = P + (D + D.T) / 2, step
        return P


def _lyapunov(loop: arb_mat, S: arb_mat, time: Time) -> arb_mat:
    """Solve loop Y + Y loop' + S = 0, in discrete time loop Y loop' - Y + S = 0, for a stable loop."""
    if not is_stable(floats(loop), time):
        raise NotCertifiedError("the norm is not below gamma")
    return middle(lyapunov_in_balls(loop, S, time))
