"""Rigorous quadrature of the logarithm of the output's spectrum, given as a quotient of exact polynomials."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from flint import acb, acb_poly, arb, ctx, fmpq_poly
from numpy.typing import NDArray

from derive.numeric.balls import around, bits_for
from derive.numeric.spectral_polynomials import SpectralPolynomials, ball_of

__all__ = ["log_integral"]

EVALUATIONS = 10_000
"""Evaluations of the integrand between two cuts after which a quadrature is given up."""


def log_integral(p: SpectralPolynomials, hints: NDArray[Any], digits: int) -> arb:
    """Enclose (1/2 pi) int ln(det Phi / det V) dw over the line, in discrete time (1/2 pi) int ln det Phi dw.

    Common factors of n and d, which are the modes that the noise does not excite, are divided out exactly.

    Args:
        p: det Phi = n / d.
        hints: approximate resonances (k,): where to cut the line. No ball depends on them.
        digits: relative accuracy of the quadrature.

    Returns:
        A ball; not finite when a singularity lies on the path.
    """
    common = p.numerator.gcd(p.denominator)
    top, bottom = p.numerator // common, p.denominator // common
    over = _over_the_axis if p.time == "continuous" else _over_the_circle
    return over(top, bottom, hints, digits)


def _over_the_axis(top: fmpq_poly, bottom: fmpq_poly, hints: NDArray[Any], digits: int) -> arb:
    """Return (1/pi) int_0^inf ln(n/d) dw with n and d made monic, which divides by det V."""
    top, bottom = top / top[top.degree()], bottom / bottom[bottom.degree()]
    bound = _root_bound(top).max(_root_bound(bottom))
    end = 2 * bound.sqrt().abs_upper()
    cuts = [x for x in sorted({abs(float(h.imag)) for h in hints}) if 0 < x < float(end)]
    near = _integrated(top, bottom, lambda w: -w * w, [arb(0), *map(arb, cuts), arb(end)], digits)
    return (near + _tail(top, bottom, bound, arb(end), ctx.prec // 2 + 4)) / arb.pi()


def _over_the_circle(top: fmpq_poly, bottom: fmpq_poly, hints: NDArray[Any], digits: int) -> arb:
    """Return (1/pi) int_0^pi ln(n/d) dw."""
    cuts = [x for x in sorted({abs(float(np.angle(h))) for h in hints}) if 0 < x < np.pi]
    return _integrated(top, bottom, lambda w: 2 * w.cos(), [arb(0), *map(arb, cuts), arb.pi()], digits) / arb.pi()


def _integrated(
    top: fmpq_poly, bottom: fmpq_poly, invariant: Callable[[acb], acb], cuts: list[arb], digits: int
) -> arb:
    n, d = (acb_poly([ball_of(c) for c in p.coeffs()]) for p in (top, bottom))

    def log_det(w: acb, analytic: bool) -> acb:
        x = invariant(w)
        return (_tight(n, x) / _tight(d, x)).log(analytic=analytic)

    tolerance = arb(2) ** -(bits_for(digits) + 4)
    parts = (
        acb.integral(log_det, a, b, rel_tol=tolerance, abs_tol=tolerance * arb(0.001), eval_limit=EVALUATIONS)
        for a, b in pairwise(cuts)
    )
    return sum((part.real for part in parts), arb(0))


def _tight(p: acb_poly, x: acb) -> acb:
    """Return p(x) by Taylor's formula at the middle of x, which loses little when x is a wide ball."""
    if x.rad().is_zero():
        return p(x)
    middle = x.mid()
    return p(acb_poly([middle, 1]))(x - middle)


def _root_bound(p: fmpq_poly) -> arb:
    """Return a bound of the moduli of the roots of a monic p: 2 max |p_{n-k}|^(1/k), due to Fujiwara."""
    n = p.degree()
    bound = arb(1)
    for k in range(1, n + 1):
        if p[n - k] != 0:
            bound = bound.max(2 * abs(ball_of(p[n - k])).root(k))
    return arb(bound.abs_upper())


def _tail(top: fmpq_poly, bottom: fmpq_poly, bound: arb, end: arb, terms: int) -> arb:
    """Return int_end^inf ln(n/d) dw, x = -w^2, end^2 >= 4 bound.

    ln n(x) - ln d(x) = sum_k c_k x^-k with |c_k| <= 2 n bound^k / k, so the rest after K = `terms` of them is below
    2 n end 4^-K.
    """
    c = [x - y for x, y in zip(_log_reversed(top, terms), _log_reversed(bottom, terms), strict=True)]
    series = (x * (-1) ** k * end ** (1 - 2 * k) / (2 * k - 1) for k, x in enumerate(c, 1))
    rest = 2 * max(top.degree(), bottom.degree()) * end * arb(4) ** -terms
    return around(sum(series, arb(0)), rest)


def _log_reversed(p: fmpq_poly, terms: int) -> list[arb]:
    """Return c_1, ..., c_terms of ln(p(x) / x^n) = sum c_k x^-k for a monic p."""
    a = [ball_of(c) for c in reversed(p.coeffs())]
    c = [arb(0)]
    for k in range(1, terms + 1):
        inner = sum((j * c[j] * a[k - j] for j in range(max(1, k - len(a) + 1), k)), arb(0))
        c.append((a[k] if k < len(a) else arb(0)) - inner / k)
    return c[1:]
