"""The output's spectrum as a quotient of two exact polynomials: no eigenvalue, no rounding."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, fmpq, fmpq_mat, fmpq_poly

from derive.numeric.modes import Time
from derive.numeric.normal import normal_form
from derive.numeric.plant import Plant

__all__ = ["SpectralPolynomials", "ball_of", "rational", "spectral_polynomials"]


@dataclass(frozen=True, eq=False)
class SpectralPolynomials:
    """det Phi = n(x) / d(x) of the output's spectrum Phi = C (s - F)^-1 (W - N V^-1 N') (s - F)^-* C' + V.

    Continuous: x = s^2, d = det(s - F) det(-s - F'). Discrete: x = z + 1/z, d = det(z - F) det(1/z - F').

    Attributes:
        numerator: n, of degree at most the number of states.
        denominator: d.
        feedback: det(s - F), the characteristic polynomial of F = A - N V^-1 C.
        noise: det V.
        trace: tr F.
        time: "continuous" or "discrete".
    """

    numerator: fmpq_poly
    denominator: fmpq_poly
    feedback: fmpq_poly
    noise: fmpq
    trace: fmpq
    time: Time


def rational(X: Any) -> fmpq_mat:
    """Return doubles as exact rationals."""
    rows = [[fmpq(*float(x).as_integer_ratio()) for x in row] for row in np.atleast_2d(X)]
    return fmpq_mat(rows) if np.size(X) else fmpq_mat(*np.shape(X))


def ball_of(q: fmpq) -> arb:
    """Return a rational as a ball of the working precision."""
    return arb(q.p) / arb(q.q)


def spectral_polynomials(plant: Plant) -> SpectralPolynomials:
    """Interpolate the polynomials exactly from determinants at rational points.

    n(x) = det [[s - A, -W, -N], [0, -s - A', -C'], [C, N', V]], in discrete time with the middle rows multiplied by z:
    [[z - A, -W, -N], [0, 1 - z A', -z C'], [C, N', V]] = z^n n(z + 1/z). No inverse of V is formed.
    """
    t = normal_form(plant).scaling.astype(float)
    A, C, W = (rational(X) for X in (plant.A / t[:, None] * t, plant.C * t, plant.W / np.outer(t, t)))
    V, N = rational(plant.V), rational(plant.N / t[:, None])
    n, noise = plant.n, V.det()

    def feedback(s: fmpq) -> fmpq:
        return _block([[_shifted(A, s), N * -1], [C, V]]).det() / noise

    chi = _interpolated(feedback, _points(n, 0))
    if plant.is_continuous:
        numerator = _interpolated(lambda s: _pencil(A, C, W, V, N, s).det(), _points(n, 0), lambda s: s * s)
        denominator = _even(chi * chi(fmpq_poly([0, -1])))
    else:
        points = _points(n, 1)
        numerator = _interpolated(
            lambda z: _pencil_on_the_circle(A, C, W, V, N, z).det() / z**n, points, lambda z: z + 1 / z
        )
        denominator = _interpolated(lambda z: chi(z) * chi(1 / z), points, lambda z: z + 1 / z)
    return SpectralPolynomials(numerator, denominator, chi, noise, -_coefficient(chi, n - 1), plant.time)


def _points(n: int, first: int) -> list[fmpq]:
    return [fmpq(k) for k in range(first, first + n + 1)]


def _pencil(A: fmpq_mat, C: fmpq_mat, W: fmpq_mat, V: fmpq_mat, N: fmpq_mat, s: fmpq) -> fmpq_mat:
    zero = fmpq_mat(A.nrows(), A.nrows())
    return _block(
        [
            [_shifted(A, s), W * -1, N * -1],
            [zero, _shifted(A.transpose(), -s), C.transpose() * -1],
            [C, N.transpose(), V],
        ]
    )


def _pencil_on_the_circle(A: fmpq_mat, C: fmpq_mat, W: fmpq_mat, V: fmpq_mat, N: fmpq_mat, z: fmpq) -> fmpq_mat:
    zero = fmpq_mat(A.nrows(), A.nrows())
    turned = _shifted(A.transpose() * z, fmpq(1))
    return _block([[_shifted(A, z), W * -1, N * -1], [zero, turned, C.transpose() * -z], [C, N.transpose(), V]])


def _shifted(A: fmpq_mat, s: fmpq) -> fmpq_mat:
    """Return s I - A."""
    rows = (A * -1).tolist()
    for i in range(len(rows)):
        rows[i][i] += s
    return fmpq_mat(rows)


def _block(blocks: list[list[fmpq_mat]]) -> fmpq_mat:
    rows = (parts for row in blocks for parts in zip(*(block.tolist() for block in row), strict=True))
    return fmpq_mat([[x for part in parts for x in part] for parts in rows])


def _interpolated(
    f: Callable[[fmpq], fmpq], points: list[fmpq], invariant: Callable[[fmpq], fmpq] = lambda s: s
) -> fmpq_poly:
    """Return the polynomial p with p(invariant(s)) = f(s) at the points, by Newton's divided differences."""
    x = [invariant(s) for s in points]
    c = [f(s) for s in points]
    for k in range(1, len(x)):
        for i in range(len(x) - 1, k - 1, -1):
            c[i] = (c[i] - c[i - 1]) / (x[i] - x[i - k])
    p = fmpq_poly([0])
    for value, point in zip(reversed(c), reversed(x), strict=True):
        p = p * fmpq_poly([-point, 1]) + value
    return p


def _even(p: fmpq_poly) -> fmpq_poly:
    """Return e with e(s^2) = p(s)."""
    return fmpq_poly([_coefficient(p, k) for k in range(0, p.degree() + 1, 2)])


def _coefficient(p: fmpq_poly, k: int) -> fmpq:
    return p[k] if k >= 0 else fmpq(0)
