"""References that share no code with the package: Newton's method with Kronecker products, and closed forms."""

import mpmath
import numpy as np
from flint import arb, arb_mat

from derive.numeric.plant import Plant

DIGITS = 80


def reference(plant: Plant, start: np.ndarray) -> arb_mat:
    """Return the Riccati solution near `start` to 70 digits, in the plant's own letters with its cross term."""
    with mpmath.workdps(DIGITS + 10):
        A, C, W, V, N = (mpmath.matrix(X.tolist()) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
        P = mpmath.matrix(start.tolist())
        for _ in range(9):
            loop, residual = (_continuous if plant.is_continuous else _discrete)(A, C, W, V, N, P)
            P = P + _lyapunov(loop, residual, plant.is_continuous)
        return arb_mat([[ball(P[i, j]) for j in range(plant.n)] for i in range(plant.n)])


def ball(x: mpmath.mpf) -> arb:
    """Return a ball of relative radius 1e-70, to be made at high precision."""
    centre = arb(mpmath.nstr(x, DIGITS))
    return centre + arb(0, (abs(centre) * arb(10) ** -70).abs_upper())


def _continuous(A, C, W, V, N, P):
    K = (P * C.T + N) * V**-1
    return A - K * C, A * P + P * A.T + W - K * V * K.T


def _discrete(A, C, W, V, N, P):
    S = C * P * C.T + V
    K = (A * P * C.T + N) * S**-1
    return A - K * C, A * P * A.T - P + W - K * S * K.T


def _lyapunov(loop, right, continuous):
    n = loop.rows
    one = mpmath.eye(n)
    big = _kron(loop, one) + _kron(one, loop) if continuous else _kron(loop, loop) - mpmath.eye(n * n)
    x = mpmath.lu_solve(big, mpmath.matrix([-right[i, j] for i in range(n) for j in range(n)]))
    return mpmath.matrix([[x[i * n + j] for j in range(n)] for i in range(n)])


def _kron(X, Y):
    n, m = X.rows, Y.rows
    Z = mpmath.matrix(n * m, n * m)
    for i in range(n * m):
        for j in range(n * m):
            Z[i, j] = X[i // m, j // m] * Y[i % m, j % m]
    return Z


def double_integrator(w: int, v: int) -> arb_mat:
    """Return P for x'' = noise of intensity w, seen through noise of intensity v, at the current precision."""
    p12 = (arb(w) * v).sqrt()
    p11 = (2 * p12 * v).sqrt()
    return arb_mat([[p11, p12], [p12, p11 * p12 / v]])


def damped_oscillator(a: float, b: float, w: float, v: float) -> arb_mat:
    """Return P for x'' + b x' + a x = noise, by the spectral factor s^2 + c1 s + c0 of the output."""
    c0 = (arb(a) ** 2 + arb(w) / v).sqrt()
    c1 = (arb(b) ** 2 - 2 * arb(a) + 2 * c0).sqrt()
    p11 = v * (c1 - b)
    p12 = p11**2 / (2 * v)
    return arb_mat([[p11, p12], [p12, a * p11 + b * p12 + p11 * p12 / v]])


def scalar_continuous(A: float, C: float, W: float, V: float) -> arb:
    return V * (A + (arb(A) ** 2 + arb(C) ** 2 * W / V).sqrt()) / arb(C) ** 2


def scalar_discrete(A: float, C: float, Q: float, R: float) -> arb:
    g = arb(C) ** 2 / R
    b = arb(A) ** 2 + g * Q - 1
    return (b + (b * b + 4 * g * Q).sqrt()) / (2 * g)
