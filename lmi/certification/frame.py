"""Coordinates in which certificates are computed, and the grid of rationals that their matrices are rounded to."""

from dataclasses import dataclass, replace
from fractions import Fraction
from math import frexp
from typing import Any

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from derive.numeric.balls import exact, floats, middle, norm
from derive.numeric.newton import Equation
from derive.numeric.plant import Plant
from lmi.certificate.arithmetic import Exact

__all__ = ["Frame", "Grid", "binary_logarithm", "unit_variances"]

Matrix = NDArray[np.floating[Any]]

SMALLEST_VARIANCE = 2.0**-100
"""Variances below this, relative to the largest, count as this when the coordinates are chosen."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A plant in balls, in coordinates x = s x_scaled with s powers of two.

    Attributes:
        equation: the Riccati equation without cross term there; s is its `scaling`.
        A: state matrix (n, n).
        C: output matrix (l, n).
        W: process noise (n, n).
        N: cross term (n, l).
        V: measurement noise (l, l).
    """

    equation: Equation
    A: arb_mat
    C: arb_mat
    W: arb_mat
    N: arb_mat
    V: arb_mat

    @classmethod
    def of(cls, plant: Plant, equation: Equation) -> "Frame":
        """Scale the plant's matrices as the equation is scaled."""
        A, C, W, V, N = (exact(X) for X in (plant.A, plant.C, plant.W, plant.V, plant.N))
        T, inverse = exact(np.diag(equation.scaling)), exact(np.diag(1 / equation.scaling))
        return cls(equation, inverse * A * T, C * T, inverse * W * inverse, inverse * N, V)

    def gain(self, P: arb_mat) -> arb_mat:
        """Return the optimal gain for P."""
        PC = P * self.C.transpose()
        if self.equation.time == "continuous":
            return self.V.solve((PC + self.N).transpose()).transpose().mid()
        return (self.V + self.C * PC).solve((self.A * PC + self.N).transpose()).transpose().mid()

    def loop(self, L: arb_mat) -> arb_mat:
        """Return A - L C."""
        return (self.A - L * self.C).mid()

    def noise(self, L: arb_mat) -> arb_mat:
        """Return W - L N' - N L' + L V L'."""
        cross = L * self.N.transpose()
        return middle(self.W - cross - cross.transpose() + L * self.V * L.transpose())


@dataclass(frozen=True)
class Grid:
    """Rationals in the plant's coordinates from balls in scaled ones: multiples of 2^-bits s_i s_j."""

    exponents: tuple[int, ...]

    @classmethod
    def of(cls, scaling: Matrix) -> "Grid":
        """Take the scaling's powers of two."""
        return cls(tuple(frexp(float(x))[1] - 1 for x in scaling))

    def covariance(self, X: arb_mat, bits: int) -> Exact:
        """Round the middles of a symmetric matrix and bring it to the plant's coordinates."""
        lower = [[_integer(x, bits) for x in row[: i + 1]] for i, row in enumerate(X.tolist())]
        s = self.exponents
        entries = range(len(lower))
        return Exact.of([[_shifted(lower[max(i, j)][min(i, j)], s[i] + s[j] - bits) for j in entries] for i in entries])

    def gain(self, L: arb_mat, bits: int | None) -> Exact:
        """Bring a gain to the plant's coordinates, rounded to doubles or to multiples of 2^-bits s_i."""
        rows = zip(L.tolist(), self.exponents, strict=True)
        if bits is None:
            return Exact.of([[_shifted(Fraction(float(x.mid())), s) for x in row] for row, s in rows])
        return Exact.of([[_shifted(_integer(x, bits), s - bits) for x in row] for row, s in rows])

    def scaled_gain(self, L: Exact) -> arb_mat:
        """Bring a gain of the plant to scaled coordinates."""
        rows = zip(L.numerators, self.exponents, strict=True)
        return arb_mat([[arb(x) / L.denominator * arb(2) ** -s for x in row] for row, s in rows])


def _integer(x: arb, bits: int) -> int:
    """Return the middle of x times 2^bits, rounded to the nearest integer."""
    man, exp = x.mid().man_exp()
    shift = int(exp) + bits
    return int(man) << shift if shift >= 0 else (int(man) + (1 << (-shift - 1))) >> -shift


def _shifted(x: int | Fraction, bits: int) -> Fraction:
    return Fraction(x) * (1 << bits) if bits >= 0 else Fraction(x) / (1 << -bits)


def unit_variances(equation: Equation, P: arb_mat) -> tuple[Equation, arb_mat]:
    """Scale the states of an equation by powers of two that make the diagonal of P about 1."""
    diagonal = np.maximum(np.diag(floats(P)), 0.0)
    if not diagonal.any():
        return equation, P
    size = np.maximum(diagonal, SMALLEST_VARIANCE * diagonal.max())
    d = np.exp2(np.round(np.log2(size) / 2))
    T, inverse = exact(np.diag(d)), exact(np.diag(1 / d))
    scaled = replace(
        equation,
        F=inverse * equation.F * T,
        C=equation.C * T,
        q=inverse * equation.q * inverse,
        scaling=equation.scaling * d,
    )
    return scaled, middle(inverse * P * inverse)


def binary_logarithm(x: arb) -> int:
    """Return an integer just above log2 x; that of 0 counts as 0."""
    man, exp = x.abs_upper().man_exp()
    return int(exp) + int(man).bit_length()


def sizes(loop: arb_mat) -> int:
    """Return log2 of n (1 + a + a^2), a = |loop|: what loop D + D loop' and loop D loop' - D make of a unit error."""
    a = norm(loop)
    return binary_logarithm(loop.nrows() * (1 + a + a * a))
