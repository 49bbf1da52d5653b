"""What a certificate proves, as text: decimals rounded outwards, so that what is printed is true as well."""

from collections.abc import Iterator
from decimal import Context, Decimal
from fractions import Fraction
from math import ceil, floor, log10

from lmi.certificate.sandwich import Bounds, Certificate, Check, Interval

__all__ = ["above", "at_least", "at_most", "ends", "excess_line", "proved_lines", "rejected_line"]

DIGITS = 32
"""Most significant digits printed."""

FEWEST = 10
SPARE = 2
"""Digits printed beyond those in which the ends of an interval agree."""

WIDE = Context(prec=100, Emax=999_999, Emin=-999_999)
"""A decimal context that holds what is printed without rounding."""


def proved_lines(certificate: Certificate, bounds: Bounds) -> Iterator[str]:
    """Iterate over the lines that report a verified certificate."""
    plant = certificate.plant
    yield f"{plant.time} time, states {plant.n}, outputs {plant.l}: every inequality holds, decided in integers"
    if bounds.is_covariance is None:
        yield "the noise matrix is too large to decide whether it is semidefinite, and P a covariance"
    elif not bounds.is_covariance:
        yield "the noise matrix is not exactly semidefinite: P is the greatest Riccati solution, and no covariance"
    yield f"{'':8}{'every stabilising gain, at least':36}{'this gain, at most'}"
    named = [("tr P", bounds.trace), ("tr MP", bounds.cost)]
    named += [(f"P[{i}, {i}]", interval) for i, interval in enumerate(bounds.variances, start=1)]
    for name, interval in named:
        lower, upper = ends(interval)
        yield f"{name:8}{lower:36}{upper}"
    yield excess_line(bounds.cost)


def excess_line(cost: Interval) -> str:
    """Return the line that says by how much the gain's cost exceeds the least possible."""
    absolute = f"the cost tr MP of this gain exceeds the least possible by at most {at_most(cost.width, 3)}"
    return f"{absolute}, relative {at_most(cost.width / cost.lower, 3)}" if cost.lower > 0 else absolute


def rejected_line(checks: tuple[Check, ...]) -> str:
    """Return the line that names what does not hold."""
    return f"rejected: {', '.join(check.statement for check in checks if not check.holds)}: does not hold"


def ends(interval: Interval) -> tuple[str, str]:
    """Return both ends in as many digits as tell them apart."""
    digits = next((d for d in range(1, DIGITS) if at_least(interval.lower, d) != at_least(interval.upper, d)), DIGITS)
    digits = min(DIGITS, max(FEWEST, digits + SPARE))
    return at_least(interval.lower, digits), at_most(interval.upper, digits)


def above(interval: Interval) -> tuple[str, str]:
    """Return a lower end, and by how much more than that, as it is printed, the upper end may be."""
    lower = ends(interval)[0]
    return lower, at_most(interval.upper - Fraction(lower), 3)


def at_least(x: Fraction, digits: int) -> str:
    """Return a decimal that is at most x: what is at least x is at least that."""
    power = _power(x, digits)
    return _text(floor(x * Fraction(10) ** -power), power)


def at_most(x: Fraction, digits: int) -> str:
    """Return a decimal that is at least x: what is at most x is at most that."""
    power = _power(x, digits)
    return _text(ceil(x * Fraction(10) ** -power), power)


def _power(x: Fraction, digits: int) -> int:
    """Return a power of ten of which x is a multiple with about so many digits."""
    bits = abs(x.numerator).bit_length() - x.denominator.bit_length()
    return floor(bits * log10(2)) + 1 - digits


def _text(x: int, power: int) -> str:
    """Return x 10^power as a decimal."""
    if x == 0:
        return "0"
    value = Decimal(x).scaleb(power, WIDE)
    return f"{value:e}" if not -5 < value.adjusted() < DIGITS else f"{value:f}"
