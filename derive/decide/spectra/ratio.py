"""Rational functions of s with coefficients a + jb, exact: what determinants on the imaginary axis are made of."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import acb, fmpq, fmpq_poly

__all__ = ["OMEGA", "Fractional", "J", "Undefined", "determinant", "inverted", "roots"]

Matrix = list[list["Fractional"]]
DEGREE = 60  # of a numerator or denominator


class Undefined(Exception):  # noqa: N818 - what was found about a formula
    """A formula has no value at an instance: a division by zero, a logarithm of no positive number."""


@dataclass(frozen=True)
class Fractional:
    """(re + j im) / den with polynomials in s; constants are numbers."""

    re: fmpq_poly
    im: fmpq_poly
    den: fmpq_poly

    @classmethod
    def of(cls, value: Fraction | fmpq | int) -> Fractional:
        """Return a number."""
        number = fmpq(value.numerator, value.denominator) if isinstance(value, Fraction) else value
        return cls(fmpq_poly([number]), fmpq_poly(), fmpq_poly([1]))

    @classmethod
    def make(cls, re: fmpq_poly, im: fmpq_poly, den: fmpq_poly) -> Fractional:
        """Return the fraction in lowest terms, its denominator monic."""
        if not den:
            raise Undefined("a division by zero")
        common = re.gcd(im).gcd(den) if re or im else den
        if common.degree() > 0:
            re, im, den = re // common, im // common, den // common
        lead = den[den.degree()]
        if max(re.degree(), im.degree(), den.degree()) > DEGREE:
            raise ValueError("a rational function of too high a degree")
        return cls(re / lead, im / lead, den / lead)

    def __add__(self, other: Fractional) -> Fractional:
        return Fractional.make(
            self.re * other.den + other.re * self.den, self.im * other.den + other.im * self.den, self.den * other.den
        )

    def __neg__(self) -> Fractional:
        return Fractional(-self.re, -self.im, self.den)

    def __sub__(self, other: Fractional) -> Fractional:
        return self + -other

    def __mul__(self, other: Fractional) -> Fractional:
        return Fractional.make(
            self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re, self.den * other.den
        )

    def reciprocal(self) -> Fractional:
        """Return 1/x."""
        size = self.re * self.re + self.im * self.im
        return Fractional.make(self.re * self.den, -(self.im * self.den), size)

    def mirrored(self) -> Fractional:
        """Return the complex conjugate on the axis: s becomes -s, j becomes -j."""
        back = fmpq_poly([0, -1])
        return Fractional.make(self.re(back), -self.im(back), self.den(back))

    @property
    def is_zero(self) -> bool:
        """Whether it is the zero function."""
        return not self.re and not self.im

    @property
    def is_real(self) -> bool:
        """Whether its coefficients are real."""
        return not self.im

    def number(self) -> fmpq | None:
        """Return its value if it is a real constant."""
        if self.im or self.re.degree() > 0 or self.den.degree() > 0:
            return None
        return self.re[0] if self.re else fmpq(0)


J = Fractional(fmpq_poly(), fmpq_poly([1]), fmpq_poly([1]))
OMEGA = Fractional(fmpq_poly(), fmpq_poly([0, -1]), fmpq_poly([1]))  # ω = -j s on the axis


def roots(p: fmpq_poly) -> list[acb]:
    """Return the complex roots of a polynomial as balls, each as often as it counts."""
    found: list[tuple[acb, int]] = p.numer().complex_roots()  # type: ignore[reportAssignmentType]
    return [root for root, multiplicity in found for _ in range(multiplicity)]


def inverted(matrix: Matrix) -> Matrix:
    """Return the inverse of a square matrix by elimination."""
    n = len(matrix)
    work = [[*row, *(Fractional.of(int(i == j)) for j in range(n))] for i, row in enumerate(matrix)]
    _eliminate(work, n)
    return [row[n:] for row in work]


def determinant(matrix: Matrix) -> Fractional:
    """Return the determinant of a square matrix."""
    if not matrix:
        return Fractional.of(1)
    try:
        return _eliminate([list(row) for row in matrix], len(matrix))
    except Undefined:
        return Fractional.of(0)


def _eliminate(work: Matrix, n: int) -> Fractional:
    """Reduce the first n columns to the identity in place; return their determinant."""
    total = Fractional.of(1)
    for k in range(n):
        pivot = next((i for i in range(k, n) if not work[i][k].is_zero), None)
        if pivot is None:
            raise Undefined("the inverse of a singular matrix")
        if pivot != k:
            work[k], work[pivot], total = work[pivot], work[k], -total
        total = total * work[k][k]
        scale = work[k][k].reciprocal()
        work[k] = [x * scale for x in work[k]]
        for i in range(n):
            if i != k and not work[i][k].is_zero:
                factor = work[i][k]
                work[i] = [x - factor * y for x, y in zip(work[i], work[k], strict=True)]
    return total
