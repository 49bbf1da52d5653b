"""Exact proofs that a gain does or does not stabilise. Standard library only.

Two ways: a witness Y that cannot exist for a stable A - L C, at any size; and Routh's criterion on the characteristic
polynomial, which decides every case, also modes on the boundary, while there are few states.
"""

# pyright: strict

from collections.abc import Sequence
from fractions import Fraction
from math import gcd

from lmi.certificate.arithmetic import Exact, TooLargeError, is_definite
from lmi.certificate.sandwich import ExactPlant

__all__ = [
    "LARGEST",
    "characteristic_polynomial",
    "is_hurwitz",
    "moved_to_the_half_plane",
    "proved_unstable",
    "stabilises",
]

LARGEST = 30
"""States up to which Routh's criterion takes seconds."""


def proved_unstable(plant: ExactPlant, gain: Exact, rate: Fraction, Y: Exact, v: Sequence[Fraction]) -> bool:
    """Prove that A - L C has a mode with Re >= rate >= 0, in discrete time with modulus >= rate >= 1.

    With loop = A - L C - rate I (discrete: (A - L C) / rate), loop Y + Y loop' < 0 (loop Y loop' - Y < 0) and
    v'Y v <= 0 for some v: were the loop stable, Y would be the integral (sum) of positive definite terms, so Y > 0.
    False proves nothing.

    Args:
        plant: the plant.
        gain: L (n, l).
        rate: of the mode.
        Y: symmetric (n, n).
        v: nonzero (n,).
    """
    if not Y.is_symmetric or not any(v) or rate < (0 if plant.is_continuous else 1):
        return False
    loop, column = plant.loop(gain), Exact.of([v]).T
    loop = loop - Exact.identity(plant.n) * rate if plant.is_continuous else loop * (1 / rate)
    return (column.T @ Y @ column)[0, 0] <= 0 and is_definite(-plant.drift(loop, Y))


def stabilises(plant: ExactPlant, gain: Exact) -> bool:
    """Decide whether A - L C is stable, by Routh's criterion; in discrete time after z = (s + 1) / (s - 1).

    Raises:
        TooLargeError: more than `LARGEST` states.
    """
    if plant.n > LARGEST:
        raise TooLargeError(f"{plant.n} states are too many for Routh's criterion, which takes up to {LARGEST}")
    polynomial = characteristic_polynomial(plant.loop(gain))
    return is_hurwitz(polynomial if plant.is_continuous else moved_to_the_half_plane(polynomial))


def characteristic_polynomial(X: Exact) -> list[int]:
    """Return a positive multiple of det(s - X), its highest coefficient first.

    By Faddeev and LeVerrier: with B the integers of X, M_1 = I, c_k = -tr(B M_k) / k and M_(k+1) = B M_k + c_k I; every
    division is exact. The roots of s^n + c_1 s^(n-1) + ... are those of X times its denominator d.
    """
    n, B, d = X.shape[0], Exact(X.numerators), X.denominator
    identity = Exact.identity(n)
    power, coefficients = identity, [1]
    for k in range(1, n + 1):
        moved = B @ power
        c = -sum(moved.numerators[i][i] for i in range(n)) // k
        coefficients.append(c)
        power = moved + identity * Fraction(c)
    return [c * d ** (n - k) for k, c in enumerate(coefficients)]


def is_hurwitz(polynomial: Sequence[int]) -> bool:
    """Decide whether all roots of a polynomial, its highest coefficient first, have negative real parts.

    By Routh's array with positive common factors of a row removed: all entries of its first column are positive. The
    numbers of roots with Re > 0 are not counted; the first entry that is not positive decides.
    """
    sign = 1 if polynomial[0] > 0 else -1
    above, row = ([sign * x for x in polynomial[start::2]] for start in (0, 1))
    for _ in range(len(polynomial) - 1):
        if not row or row[0] <= 0:
            return False
        padded = [*row[1:], *[0] * (len(above) - len(row))]
        below = [row[0] * x - above[0] * y for x, y in zip(above[1:], padded, strict=False)]
        common = gcd(*below) or 1
        above, row = row, [x // common for x in below]
    return polynomial[0] != 0


def moved_to_the_half_plane(polynomial: Sequence[int]) -> list[int]:
    """Return (s - 1)^n p((s + 1) / (s - 1)): its roots have Re s < 0 where those of p have |z| < 1.

    When p(1) = 0 its highest coefficient is 0.
    """
    result, power = [0], [1]  # power: (s - 1)^k, in Horner's scheme for p(u / v) v^n with u = s + 1, v = s - 1
    for coefficient in polynomial:
        result = _sum(_times(result, 1), [coefficient * x for x in power])
        power = _times(power, -1)
    return result[1:]


def _times(polynomial: Sequence[int], constant: int) -> list[int]:
    """Return the polynomial times s + constant."""
    return _sum([*polynomial, 0], [0, *(constant * x for x in polynomial)])


def _sum(p: Sequence[int], q: Sequence[int]) -> list[int]:
    n = max(len(p), len(q))
    return [x + y for x, y in zip([*[0] * (n - len(p)), *p], [*[0] * (n - len(q)), *q], strict=True)]
