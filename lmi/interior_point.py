"""A primal-dual interior-point method made for the covariance program: O(n^4) arithmetic a step.

    max tr(M P)  s.t.  S = F(P) >= 0                continuous: F(P) = J + U P E' + E P U'
    min tr(J Z)  s.t.  F*(Z) + M = 0,  Z >= 0       discrete:   F(P) = J + U P U' - E P E'

with J = [[W, N], [N', V]], U = [A; C], E = [I; 0] and F* the adjoint of the linear part. A general solver forms the
matrix of its normal equations from n (n + 1)/2 constraint matrices of size n + l, here four Kronecker products suffice.

Coordinates and start are those of `lmi.central_path`, from Lyapunov equations alone: no Riccati equation is solved on
the way, and what the method converges to is judged by its own residuals and gap.

Source: C. Helmberg, F. Rendl, R. Vanderbei, H. Wolkowicz, An interior-point method for semidefinite programming, SIAM
J. Optim. 6(2), 1996 (the direction); S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM
J. Optim. 2(4), 1992 (predictor and corrector).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.numeric.plant import Plant
from lmi.central_path import central_point, rough_covariance
from lmi.residual import optimal_gain, symmetric_part
from lmi.scaling import balanced, recentred, scaled_plant

__all__ = ["InteriorPoint", "solve_interior_point"]

Matrix = NDArray[np.floating[Any]]

TOLERANCE = 1e-13
"""Relative gap and residuals at which the method stops."""

SOLVED = 1e-10
"""Relative gap and residuals below which the answer counts as solved."""

STEPS = 40
"""Steps after which the method gives up; it takes about ten."""

SHORT = 0.3
"""Length of a predictor step below which the next one stays away from the boundary."""


@dataclass(frozen=True, eq=False)
class InteriorPoint:
    """What the method found, in the plant's units.

    Attributes:
        status: "solved", or "inaccurate", or "failed: " and why.
        P: error covariance (n, n), or None.
        gain: the optimal gain for P (n, l), or None; Z gives it to half as many digits only.
        merit: the largest of the relative gap and of the residuals relative to their terms, recomputed.
        history: the same after every step.
    """

    status: str
    P: Matrix | None
    gain: Matrix | None
    merit: float
    history: tuple[float, ...]


def solve_interior_point(plant: Plant) -> InteriorPoint:
    """Solve the covariance program of a plant and its dual.

    Args:
        plant: V > 0, (A, C) detectable, no mode on the boundary of stability that the noise leaves unexcited (there the
            dual has no solution and the path no end).

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> found = solve_interior_point(example_plant())
        >>> found.status, found.merit < 1e-12
        ('solved', True)
    """
    rough = rough_covariance(plant)
    if rough is None:
        return _failed("no start: no stabilising gain, or an unexcited boundary mode, at which the path has no end")
    common = balanced(plant)
    scaling = recentred(plant, common, common.scaled_covariance(rough), 0.0)
    scaled = scaled_plant(plant, scaling)
    try:
        P, history = _follow(_Cone.of(scaled), *central_point(scaled, scaling.scaled_covariance(rough)))
    except np.linalg.LinAlgError as error:
        return _failed(str(error))
    merit = min(history)
    status = "solved" if merit < SOLVED else "inaccurate: the path was not followed to its end"
    gain = scaling.gain(optimal_gain(scaled, P))
    return InteriorPoint(status, scaling.covariance(P), gain, merit, tuple(history))


def _failed(reason: str) -> InteriorPoint:
    return InteriorPoint(f"failed: {reason}", None, None, np.inf, ())


# ------------------------------------------------------------------------------------------------ the cone
@dataclass(frozen=True, eq=False)
class _Cone:
    """The map P -> F(P) of a plant, its adjoint, and the normal equations; M = I."""

    J: Matrix
    U: Matrix
    E: Matrix
    continuous: bool

    @classmethod
    def of(cls, plant: Plant) -> _Cone:
        """Return the cone of a plant with weight M = I."""
        J = np.block([[plant.W, plant.N], [plant.N.T, plant.V]])
        E = np.vstack([np.eye(plant.n), np.zeros((plant.l, plant.n))])
        return cls((J + J.T) / 2, np.vstack([plant.A, plant.C]), E, plant.is_continuous)

    def linear(self, P: Matrix) -> Matrix:
        """Return F(P) - J (n + l, n + l)."""
        if self.continuous:
            half = self.U @ P @ self.E.T
            return half + half.T
        return self.U @ P @ self.U.T - self.E @ P @ self.E.T

    def adjoint(self, Z: Matrix) -> Matrix:
        """Return F*(Z) (n, n)."""
        if self.continuous:
            half = self.E.T @ Z @ self.U
            return half + half.T
        return symmetric_part(self.U.T @ Z @ self.U - self.E.T @ Z @ self.E)

    def normal_matrix(self, Z: Matrix, inverse: Matrix) -> Matrix:
        """Return the matrix of P -> F*(Z F(P) S^-1), symmetrised, in packed coordinates."""
        pairs = [(self.E, self.U), (self.U, self.E)] if self.continuous else [(self.U, self.U), (self.E, self.E)]
        signs = [1.0, 1.0] if self.continuous else [1.0, -1.0]
        lefts: list[Matrix] = []
        rights: list[Matrix] = []
        for (a, b), one in zip(pairs, signs, strict=True):
            for (c, d), two in zip(pairs, signs, strict=True):
                lefts.append(one * two * (a.T @ Z @ d))
                rights.append(c.T @ inverse @ b)
        return _packed_products(np.stack(lefts), np.stack(rights))


def _packed_products(lefts: Matrix, rights: Matrix) -> Matrix:
    """Return sum_t of P -> sym(X_t P Y_t) for symmetric P, in coordinates in which tr(P P') is a sum of squares.

    Row (i, j), column (k, l): the mean of X_ik Y_lj over the exchange of i, j and of k, l, block row by block row.
    """
    n = lefts.shape[1]
    rows, columns = np.triu_indices(n)
    weight = np.where(rows == columns, 0.5, np.sqrt(0.5))
    turned = rights.transpose(0, 2, 1)  # Y'_jl
    flat, by_row = turned.reshape(len(turned), n * n), lefts.transpose(1, 2, 0)
    out = np.empty((len(rows), len(rows)))
    place = 0
    for i in range(n):
        block = (by_row[i] @ flat).reshape(n, n, n)[:, i:].transpose(1, 0, 2)  # [j, k, l] = X_ik Y'_jl
        block = block + by_row[i:] @ turned[:, i, :]  # [j, k, l] = X_jk Y'_il
        block += block.transpose(0, 2, 1).copy()
        block.reshape(n - i, n * n).take(rows * n + columns, axis=1, out=out[place : place + n - i], mode="clip")
        place += n - i
    out *= weight[:, None]
    out *= weight
    return out


# ------------------------------------------------------------------------------------------------ the path
def _follow(cone: _Cone, P: Matrix, Z: Matrix) -> tuple[Matrix, list[float]]:
    """Follow the path to its end; return the best P on the way, and the merit after each step."""
    S = symmetric_part(cone.J + cone.linear(P))
    best, history = P, list[float]()
    for _ in range(STEPS):
        merit = _merit(cone, P, Z, S)
        if not history or merit < min(history):
            best = P
        history.append(merit)
        if merit < TOLERANCE or merit > 1e4 * min(history):
            break
        try:
            P, Z, S = _Step(cone, P, Z, S).taken()
        except np.linalg.LinAlgError:
            break
    return best, history


def _merit(cone: _Cone, P: Matrix, Z: Matrix, S: Matrix) -> float:
    """Return the largest of the relative gap and the residuals relative to the sizes of their terms."""
    U, E, P_, Z_ = np.abs(cone.U), cone.E, np.abs(P), np.abs(Z)
    gap = abs(float(np.sum(S * Z))) / (1 + abs(float(np.trace(P))))
    dual, primal = (U.T @ Z_ @ E, U @ P_ @ E.T) if cone.continuous else (U.T @ Z_ @ U, U @ P_ @ U.T)
    equation = np.linalg.norm(cone.adjoint(Z) + np.eye(len(P))) / (np.sqrt(len(P)) + np.linalg.norm(dual))
    slack = np.linalg.norm(cone.J + cone.linear(P) - S) / (np.linalg.norm(cone.J) + np.linalg.norm(primal))
    return float(max(gap, equation, slack))


class _Step:
    """One step of the method: the normal equations are factored once and solved for predictor and corrector."""

    def __init__(self, cone: _Cone, P: Matrix, Z: Matrix, S: Matrix):
        from scipy.linalg import cho_factor, cho_solve

        self.cone, self.P, self.Z, self.S = cone, P, Z, S
        self.roots = np.linalg.cholesky(S), np.linalg.cholesky(Z)
        self.inverse = symmetric_part(cho_solve((self.roots[0], True), np.eye(len(S)), check_finite=False))
        normal = cone.normal_matrix(Z, self.inverse).T  # symmetric; in the order of LAPACK
        self.factor = cho_factor(normal, lower=True, overwrite_a=True, check_finite=False)
        self.lacking = -np.eye(len(P)) - cone.adjoint(Z)
        self.slack = symmetric_part(cone.J + cone.linear(P) - S)

    def taken(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return P, Z and S after the step."""
        mu = float(np.sum(self.S * self.Z)) / len(self.S)
        dP, dZ, dS = self._direction(-self.Z)
        primal, dual = self._lengths(dS, dZ, 0.98)
        reached = float(np.sum((self.S + primal * dS) * (self.Z + dual * dZ))) / len(self.S)
        centring = min(1.0, max(1e-6, reached / mu)) ** 3 if reached > 0 else 1e-6
        if min(primal, dual) < SHORT:
            centring = max(centring, 0.1)
        correction = symmetric_part(dZ @ dS @ self.inverse)
        dP, dZ, dS = self._direction(centring * mu * self.inverse - self.Z - correction)
        primal, dual = self._lengths(dS, dZ, 0.99)
        return self.P + primal * dP, symmetric_part(self.Z + dual * dZ), symmetric_part(self.S + primal * dS)

    def _direction(self, target: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Return dP, dZ, dS with dZ = sym(target - Z dS S^-1), dS = slack + F(dP) - J and F*(dZ) = what is lacking."""
        wanted = symmetric_part(target - self.Z @ self.slack @ self.inverse)
        dP = self._solve(self.cone.adjoint(wanted) - self.lacking)
        dZ = self._dual(target, dP)
        dP = dP + self._solve(self.cone.adjoint(dZ) - self.lacking)
        return dP, self._dual(target, dP), symmetric_part(self.slack + self.cone.linear(dP))

    def _dual(self, target: Matrix, dP: Matrix) -> Matrix:
        return symmetric_part(target - self.Z @ (self.slack + self.cone.linear(dP)) @ self.inverse)

    def _solve(self, rhs: Matrix) -> Matrix:
        """Solve the normal equations for a symmetric right-hand side."""
        from scipy.linalg import cho_solve

        rows, columns = np.triu_indices(len(rhs))
        weight = np.where(rows == columns, 1.0, np.sqrt(2.0))
        x = cho_solve(self.factor, rhs[rows, columns] * weight, check_finite=False) / weight
        out = np.zeros_like(rhs)
        out[rows, columns] = out[columns, rows] = x
        return out

    def _lengths(self, dS: Matrix, dZ: Matrix, share: float) -> tuple[float, float]:
        """Return how far S + a dS and Z + b dZ stay positive definite, at most 1."""
        primal, dual = (_reach(root, d) for root, d in zip(self.roots, (dS, dZ), strict=True))
        return min(1.0, share * primal), min(1.0, share * dual)


def _reach(root: Matrix, D: Matrix) -> float:
    """Return the largest a with R R' + a D >= 0, R lower triangular."""
    from scipy.linalg import solve_triangular

    half = solve_triangular(root, D, lower=True)
    least = float(np.linalg.eigvalsh(symmetric_part(solve_triangular(root, half.T, lower=True)))[0])
    return np.inf if least >= 0 else -1.0 / least
