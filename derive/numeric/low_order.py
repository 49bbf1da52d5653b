"""The output cost of plants of order one to three in closed form: the roots of a cubic by radicals, no iteration.

The zeros of det Phi_y are those of a polynomial n of degree at most three in x = s^2, in discrete time x = z + 1/z, of
exact coefficients. With F = A - N V^-1 C and x_i the roots of n:

    continuous: tr(C P C' V^-1) = sum_i Re sqrt(x_i) + tr F            (-sqrt(x_i) are the modes of A - L C)
    discrete:   det(C P C' + R) = |leading coefficient of n| prod_i |zeta_i|,   zeta_i + 1/zeta_i = x_i, |zeta_i| >= 1
"""

from __future__ import annotations

from flint import acb, arb, ctx, fmpq, fmpq_poly

from derive.errors import InputError
from derive.numeric.plant import Plant
from derive.numeric.spectral_polynomials import SpectralPolynomials, ball_of, spectral_polynomials

__all__ = ["ORDER", "low_order_output"]

ORDER = 3
BITS = 400
"""Working precision: equal roots of a cubic cost two thirds of it."""


def low_order_output(plant: Plant) -> tuple[float, float]:
    """Return tr(C P C' V^-1), in discrete time ln det(C P C' + R), and a bound on its error before rounding.

    Args:
        plant: n <= 3, V > 0, (A, C) detectable, any l.

    Raises:
        InputError: the plant has more than three states.

    Source: G. Cardano, Ars magna, 1545; for the cost S. Fang, H. Ishii, J. Chen, K. H. Johansson, arXiv:1807.08604
        (2018), theorem 2.

    Example:
        >>> from derive.numeric.plant import plant_from_mapping
        >>> double = {"time": "continuous", "A": [[0, 1], [0, 0]], "C": [[1, 0]], "W": [[0, 0], [0, 4]], "V": 1}
        >>> low_order_output(plant_from_mapping(double))[0]
        2.0
    """
    if plant.n > ORDER:
        raise InputError(f"plant: expected at most {ORDER} states, got {plant.n}; use solve_riccati")
    before, ctx.prec = ctx.prec, BITS
    try:
        p = spectral_polynomials(plant)
        value = _continuous(p) if p.time == "continuous" else _discrete(p)
        return float(value.mid()), float(value.rad())
    finally:
        ctx.prec = before


def _continuous(p: SpectralPolynomials) -> arb:
    return sum((_root(x).real for x in _roots(p.numerator)), ball_of(p.trace))


def _discrete(p: SpectralPolynomials) -> arb:
    total = abs(ball_of(p.numerator[p.numerator.degree()])).log()
    for x in _roots(p.numerator):
        spread = _root(x * x - 4)
        one, two = abs((x + spread) / 2), abs((x - spread) / 2)
        total += one.max(two).log()
    return total


def _root(x: acb) -> acb:
    """Return a square root with real part >= 0; a ball around zero has one around zero."""
    if x.contains(0):
        return acb(arb(0, abs(x).abs_upper().sqrt()))
    return x.sqrt()


def _roots(p: fmpq_poly) -> list[acb]:
    """Return the complex roots of a polynomial of degree at most three."""
    degree = p.degree()
    monic = p / p[degree]
    if degree < 1:
        return []
    if degree == 1:
        return [acb(ball_of(-monic[0]))]
    if degree == 2:
        half, spread = acb(ball_of(-monic[1] / 2)), _exact_root(monic[1] * monic[1] / 4 - monic[0])
        return [half + spread, half - spread]
    return _cubic(monic[2], monic[1], monic[0])


def _cubic(b: fmpq, c: fmpq, d: fmpq) -> list[acb]:
    """Return the roots of x^3 + b x^2 + c x + d: x = -(b + u + v/u)/3 for the cube roots u."""
    v, w = b * b - 3 * c, 2 * b * b * b - 9 * b * c + 27 * d
    middle = acb(ball_of(-b / 3))
    if v == 0 and w == 0:
        return [middle] * 3
    spread = _exact_root(w * w - 4 * v * v * v)
    cube = (acb(ball_of(w)) + (spread if w >= 0 else -spread)) / 2
    first = (cube.log() / 3).exp()
    turn = acb(arb(-1), arb(3).sqrt()) / 2
    return [middle - (u + ball_of(v) / u) / 3 for u in (first, first * turn, first * turn * turn)]


def _exact_root(q: fmpq) -> acb:
    """Return the root of a rational number, imaginary where it is negative."""
    return acb(ball_of(q).sqrt()) if q >= 0 else acb(0, ball_of(-q).sqrt())
