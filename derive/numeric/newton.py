"""Newton's method for Riccati equations in balls, and the proof that the stabilising solution is near its result."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from derive.numeric.balls import exact, floats, identity, middle, norm, positive_definite, scaled_floats, widened
from derive.numeric.lyapunov import solve_lyapunov
from derive.numeric.modes import Matrix, Time
from derive.numeric.normal import normal_form
from derive.numeric.plant import Plant

__all__ = ["Equation", "Proof", "lyapunov_in_balls", "prove", "refined"]

STEPS = 80
"""Newton steps; each with a Lyapunov solution in double precision gains some of its digits."""

SHRINKING = 0.75
"""Ratio of successive steps above which they no longer converge; far from the solution they halve."""

DOUBLINGS = 256
"""Squarings of the closed loop before a Lyapunov solution is given up."""

WITNESS_STEPS = 3
"""Improvements of a witness in double precision."""


@dataclass(frozen=True, eq=False)
class Equation:
    """The Riccati equation without cross term, x = t x_scaled: F = A - N V^-1 C, q = W - N V^-1 N'.

    Continuous: R(P) = F P + P F' + q - P G P, G = C'V^-1 C.
    Discrete: R(P) = F (P - P G P) F' + q - P, G = C'(C P C' + V)^-1 C.

    Attributes:
        F: balls (n, n).
        C: balls (l, n).
        q: balls (n, n).
        V: balls (l, l).
        time: "continuous" or "discrete".
        scaling: powers of two t (n,), so that the scaling is exact.
    """

    F: arb_mat
    C: arb_mat
    q: arb_mat
    V: arb_mat
    time: Time
    scaling: Matrix

    @classmethod
    def of(cls, plant: Plant) -> "Equation":
        """Remove the cross term and balance the states; the plant's doubles are exact."""
        t = normal_form(plant).scaling.astype(float)
        A, C, W, V, N = (exact(X) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
        W, V = (W + W.transpose()) / 2, (V + V.transpose()) / 2
        T, inverse = exact(np.diag(t)), exact(np.diag(1 / t))
        gain = V.solve(N.transpose()).transpose()
        F, q = A - gain * C, W - gain * N.transpose()
        return cls(inverse * F * T, C * T, inverse * q * inverse, V, plant.time, t)

    @property
    def n(self) -> int:
        """Number of states."""
        return self.F.nrows()

    def scaled(self, P: Matrix | arb_mat) -> arb_mat:
        """Return a covariance of the plant's states in the coordinates of the equation."""
        inverse = exact(np.diag(1 / self.scaling))
        return inverse * (P if isinstance(P, arb_mat) else exact(P)) * inverse

    def unscaled(self, P: arb_mat, radius: arb) -> tuple[arb_mat, arb]:
        """Return balls for every P + D, |D|_2 <= radius, in the plant's states, and the radius there."""
        T = exact(np.diag(self.scaling))
        return T * widened(P, radius) * T, radius * arb(float(np.max(self.scaling))) ** 2

    def curvature(self, P: arb_mat) -> arb_mat:
        """Return G = C'V^-1 C, in discrete time C'(C P C' + V)^-1 C."""
        S = self.V if self.time == "continuous" else self.V + self.C * P * self.C.transpose()
        return self.C.transpose() * S.solve(self.C)

    def closed_loop(self, P: arb_mat) -> arb_mat:
        """Return F - P G, in discrete time F (I - P G)."""
        PG = P * self.curvature(P)
        return self.F - PG if self.time == "continuous" else self.F - self.F * PG

    def residual(self, P: arb_mat) -> arb_mat:
        """Return R(P)."""
        PGP = P * self.curvature(P) * P
        if self.time == "continuous":
            FP = self.F * P
            return FP + FP.transpose() + self.q - PGP
        return self.F * (P - PGP) * self.F.transpose() + self.q - P

    def derivative(self, loop: arb_mat, D: arb_mat) -> arb_mat:
        """Return loop D + D loop', in discrete time loop D loop' - D: the derivative of R where the loop is closed."""
        if self.time == "continuous":
            X = loop * D
            return X + X.transpose()
        return loop * D * loop.transpose() - D


@dataclass(frozen=True, eq=False)
class Proof:
    """A bound of |P* - P|_2 for the stabilising P*, or None and the reason why there is none."""

    radius: arb | None
    reason: str = ""


def refined(equation: Equation, P: arb_mat, in_balls: bool = False) -> arb_mat:
    """Take Newton steps P <- P + D, R'(P) D = -R(P), until they stop getting smaller.

    Args:
        equation: the equation.
        P: a stabilising start (n, n).
        in_balls: whether D is computed in high precision, for closed loops that double precision takes for unstable.
    """
    P, before = middle(P), None
    for _ in range(STEPS):
        D = _correction(equation, P, in_balls)
        step = norm(D)
        if not step.is_finite() or (before is not None and not step < before * SHRINKING):
            return P
        P, before = middle(P + D), step
        if step <= norm(P) * arb(2) ** (12 - ctx.prec):
            return P
    return P


def _correction(equation: Equation, P: arb_mat, in_balls: bool) -> arb_mat:
    return middle(_lyapunov(equation.closed_loop(P), middle(equation.residual(P)), equation.time, in_balls))


def _lyapunov(loop: arb_mat, S: arb_mat, time: Time, in_balls: bool) -> arb_mat:
    """Solve derivative(loop, D) + S = 0 approximately."""
    if in_balls:
        return lyapunov_in_balls(loop, S, time)
    right, e = scaled_floats(S)
    with np.errstate(all="ignore"):  # a loop that is not stable is found out by the proof
        D = solve_lyapunov(floats(loop), right, time)
    return exact(_finite(D)) * arb(2) ** e


def _finite(X: Any) -> Matrix:
    return np.where(np.isfinite(X), X, 0.0)


def lyapunov_in_balls(loop: arb_mat, S: arb_mat, time: Time) -> arb_mat:
    """Solve loop D + D loop' + S = 0, in discrete time loop D loop' - D + S = 0, to the working precision, unproved.

    Smith's doubling D <- D + M D M', M <- M M; continuous time is first turned into discrete time by
    M = (loop - a)^-1 (loop + a) and S <- 2 a (loop - a)^-1 S (loop - a)^-*, with a > |loop|.
    """
    M, D = loop.mid(), S.mid()
    if time == "continuous":
        n = loop.nrows()
        a = (norm(M) * 1.0625).mid()
        inverse = (M - identity(n) * a).inv().mid()
        M, D = (identity(n) + inverse * (2 * a)).mid(), (inverse * D * inverse.transpose() * (2 * a)).mid()
    for _ in range(DOUBLINGS):
        increment = M * D * M.transpose()
        D = (D + increment).mid()
        if not norm(increment) > norm(D) * arb(2) ** (-ctx.prec):
            break
        M = (M * M).mid()
    return D


def prove(equation: Equation, P: arb_mat) -> Proof:
    """Bound the distance from P to the stabilising solution.

    Write L D for the derivative at P. The remainder of Newton's method is exact:
    R(P + D) = R(P) + L D - D G D, in discrete time R(P) + L D - loop E loop', E = D G D (I + G D)^-1.
    A witness X > 0 with L X = -(I - Delta), |Delta| <= d < 1, shows the loop stable and, with k = |X| / (1 - d),
    |L^-1 Y| <= k |Y| and |L^-1 (loop Y loop')| <= k |Y|. For r = |R(P)| and g = |G|, the map D -> -L^-1(R(P) - rest)
    takes |D| <= rho = 2 k r into itself when 2 k g rho <= 1 - g rho (continuous: 1), so that a root lies there
    (Brouwer); the witness still serves for the loop of that root, which is therefore the one stabilising solution.

    Args:
        equation: the equation.
        P: symmetric centre (n, n), radius zero.
    """
    if not positive_definite(equation.V):
        return Proof(None, "V: expected positive definite, not proved at this precision")
    loop = equation.closed_loop(P)
    k = _witness(equation, loop)
    if k is None:
        return Proof(None, "closed loop: expected stable, found no Lyapunov witness for it")
    r, g = norm(equation.residual(P)), norm(equation.curvature(P))
    rho = arb((2 * k * r).abs_upper())
    slack = 1 if equation.time == "continuous" else 1 - g * rho
    if not 2 * k * g * rho < slack:
        return Proof(None, f"ball: expected 4 k^2 r g < 1, got residual r = {_show(r)} with k = {_show(k)}")
    if not _still_stable(equation, loop, g * rho, k):
        return Proof(None, "closed loop: expected stable all over the ball, not proved")
    return Proof(rho)


def _witness(equation: Equation, loop: arb_mat) -> arb | None:
    """Return k for a verified witness X, improved or recomputed until it is one."""
    one = identity(equation.n)
    X = middle(_lyapunov(loop, one, equation.time, in_balls=False))
    for step in range(WITNESS_STEPS + 1):
        defect = one + equation.derivative(loop, X)
        d = norm(defect)
        if d < arb(0.5) and positive_definite(X):
            return arb((norm(X) / (1 - d)).abs_upper())
        last = step == WITNESS_STEPS - 1
        X = middle(lyapunov_in_balls(loop, one, equation.time)) if last else _improved(equation, loop, X, defect)
    return None


def _improved(equation: Equation, loop: arb_mat, X: arb_mat, defect: arb_mat) -> arb_mat:
    return middle(X + _lyapunov(loop, middle(defect), equation.time, in_balls=False))


def _still_stable(equation: Equation, loop: arb_mat, z: arb, k: arb) -> bool:
    """Tell whether the witness X at P serves all over the ball, z = |G| rho.

    Continuous: the loop changes by D G, so L X <= -(1 - d) + 2 |X| z < 0 if 2 k z < 1.
    Discrete: the loop is multiplied by (I + D G)^-1 = I + Z, |Z| <= y = z / (1 - z), so that L X <= -(1 - d) +
    |loop|^2 |X| (2 y + y^2) < 0.
    """
    if equation.time == "continuous":
        return bool(2 * k * z < 1)
    y = z / (1 - z)
    return bool(z < 1) and bool(norm(loop) ** 2 * k * (2 * y + y * y) < 1)


def _show(x: arb) -> str:
    return f"{float(x.abs_upper()):.1e}"
