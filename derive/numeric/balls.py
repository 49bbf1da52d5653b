"""Ball arithmetic on matrices: exact conversion of doubles, bounds of norms, positivity. Every ball holds the truth."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import floor, log10
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from derive.numeric.modes import Matrix

__all__ = [
    "around", "bits_for", "digits_of", "exact", "floats", "identity", "middle", "norm", "positive_definite",
    "scaled_floats", "widened", "working_bits",
]  # fmt: skip

DOUBLE_BITS = 53
BITS_PER_DIGIT = 3.3219280948873623


@contextmanager
def working_bits(bits: int) -> Iterator[None]:
    """Compute with balls of this many bits inside the block."""
    with ctx.workprec(bits):
        yield


def bits_for(digits: int) -> int:
    """Return the bits that hold so many decimal digits."""
    return int(digits * BITS_PER_DIGIT) + 1


def exact(X: Any) -> arb_mat:
    """Return doubles as balls of radius zero."""
    return arb_mat([[float(x) for x in row] for row in np.atleast_2d(X)]) if np.size(X) else arb_mat(*np.shape(X))


def identity(n: int) -> arb_mat:
    """Return the identity (n, n)."""
    return arb_mat([[int(i == j) for j in range(n)] for i in range(n)]) if n else arb_mat(0, 0)


def floats(X: arb_mat) -> Matrix:
    """Return the centres, rounded to doubles."""
    return np.array([float(x.mid()) for x in X.entries()]).reshape(X.nrows(), X.ncols())


def middle(X: arb_mat) -> arb_mat:
    """Return the symmetrised centre as balls of radius zero."""
    M = X.mid()
    return ((M + M.transpose()) / 2).mid()


def scaled_floats(X: arb_mat) -> tuple[Matrix, int]:
    """Return doubles Y and an exponent e with X = 2^e Y approximately and max |Y| about 1: no underflow."""
    e = max((_exponent(x) for x in X.entries() if not x.mid().is_zero()), default=0)
    return floats(X * arb(2) ** -e), e


def _exponent(x: arb) -> int:
    man, exp = x.mid().man_exp()
    return int(exp) + int(abs(man)).bit_length()


def around(centre: arb, radius: arb) -> arb:
    """Return the ball of this radius about the middle of `centre`, widened by the radius of `centre`."""
    return centre + arb(0, radius.abs_upper())


def widened(X: arb_mat, radius: arb) -> arb_mat:
    """Return balls that hold every X + D with |D_ij| <= radius."""
    return arb_mat(X.nrows(), X.ncols(), [around(x, radius) for x in X.entries()])


def norm(X: arb_mat) -> arb:
    """Return an upper bound of the spectral norm: the Frobenius norm, or sqrt(|X|_1 |X|_inf) where that is less."""
    sizes = np.array([x.abs_upper() for x in X.entries()], dtype=object).reshape(X.nrows(), X.ncols())
    if sizes.size == 0:
        return arb(0)
    squares = sum((x * x for x in sizes.ravel()), arb(0))
    product = _largest(sizes.sum(axis=0)) * _largest(sizes.sum(axis=1))
    return arb(squares.min(product).sqrt().abs_upper())


def _largest(values: Any) -> arb:
    largest = arb(0)
    for value in values:
        largest = largest.max(value)
    return largest


def positive_definite(X: arb_mat) -> bool:
    """Prove X > 0 for every symmetric matrix in the balls. False proves nothing.

    Either |S X S' - I| < 1 for S about T^-1, X = T T' in doubles, or the pivots of L D L', whose balls grow with n.
    """
    S = _whitener(X)
    if S is not None and norm(S * X * S.transpose() - identity(X.nrows())) < 1:
        return True
    return _positive_pivots(X)


def _whitener(X: arb_mat) -> arb_mat | None:
    """Return about T^-1, X = T T' the Cholesky factorisation in doubles, or None where there is none."""
    Y, e = scaled_floats(X)
    try:
        return exact(np.linalg.inv(np.linalg.cholesky(np.ldexp(Y, -(e % 2))))) * arb(2) ** -((e + e % 2) // 2)
    except np.linalg.LinAlgError:
        return None


def _positive_pivots(X: arb_mat) -> bool:
    n = X.nrows()
    a = X.tolist()
    for k in range(n):
        pivot = a[k][k]
        if not pivot > 0:
            return False
        for i in range(k + 1, n):
            factor = a[i][k] / pivot
            if not factor.is_zero():
                for j in range(k + 1, i + 1):
                    a[i][j] -= factor * a[j][k]
        for i in range(k + 1, n):
            for j in range(k + 1, i):
                a[j][i] = a[i][j]
    return True


def digits_of(radius: arb, size: arb) -> int:
    """Return how many decimal digits a relative radius proves: floor(-log10(radius / size)), at least 0.

    An exact value has as many as the working precision.
    """
    most = floor(ctx.prec / BITS_PER_DIGIT)
    radius, size = arb(radius.abs_upper()), arb(size.abs_lower())
    if not (radius.is_finite() and size.is_finite()):
        return 0
    if radius.is_zero():
        return most
    if size.is_zero():
        return 0
    man, exp = (radius / size).abs_upper().man_exp()
    spare = max(0, int(man).bit_length() - DOUBLE_BITS)
    leading = (int(man) >> spare) + 1
    return int(min(most, max(0, floor(-(log10(leading) + (spare + int(exp)) * log10(2))))))
