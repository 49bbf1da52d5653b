"""What the certificate of a design proves, as text, and whether that is what the file states. Standard library only."""

from collections.abc import Iterator
from decimal import Context, Decimal
from fractions import Fraction
from math import ceil, isqrt

from lmi.certificate.design import DesignBounds
from lmi.certificate.design_file import Design
from lmi.certificate.report import at_least, at_most, ends, excess_line
from lmi.certificate.sandwich import Interval

__all__ = ["DIGITS", "above_exp", "below_exp", "decay_rate", "design_lines", "root_below", "unproved"]

DIGITS = 10

ROOT_BITS = 200
"""Bits to which a square root is taken."""

PLACES = 60
EXACTLY = Context(prec=PLACES + 20)
"""Its exp and ln are rounded correctly, to the last digit."""

LARGEST_EXPONENT = 10**5

SLACK = Fraction(1, 10**PLACES)


def design_lines(design: Design, bounds: DesignBounds) -> Iterator[str]:
    """Iterate over the lines that report a verified design."""
    plant = design.certificate.plant
    what = "inputs" if design.dual else "outputs"
    yield f"{plant.time} time, states {plant.n}, {what} {plant.l}: every inequality holds, decided in integers"
    if design.dual:
        yield "state feedback u = -Kx, proved as the observer of A', B', Q, R, S with the gain L = K'"
    yield from _notes(bounds)
    yield f"{'':12}{'every stabilising gain, at least':36}{'this gain, at most'}"
    for name, interval in (("tr P", bounds.cost.trace), ("tr MP", bounds.cost.cost)):
        lower, upper = ends(interval)
        yield f"{name:12}{lower:36}{upper}"
    if bounds.gamma is not None or bounds.floor_squared is not None:
        yield _norm_row(bounds)
    yield excess_line(bounds.cost.cost)
    if bounds.gamma is not None and bounds.floor_squared:
        ratio = bounds.gamma / root_below(bounds.floor_squared) - 1
        yield f"the H-infinity norm of this gain exceeds the least possible by at most {at_most(ratio, 3)}, relative"
    if bounds.decay is not None:
        yield _decay_line(design, bounds.decay)


def _notes(bounds: DesignBounds) -> Iterator[str]:
    if bounds.cost.is_covariance is None:
        yield "the noise matrix is too large to decide whether it is semidefinite, and P a covariance"
    elif not bounds.cost.is_covariance:
        yield "the noise matrix is not exactly semidefinite: P is the greatest Riccati solution, and no covariance"
    for name, share in zip(("noise matrix", "weight"), bounds.enlarged, strict=True):
        if share:
            yield (
                f"the {name} is not exactly semidefinite: H-infinity norms are those with its diagonal enlarged "
                f"by a relative {at_most(share, 2)}"
            )


def _norm_row(bounds: DesignBounds) -> str:
    lower, upper = (None if bounds.floor_squared is None else root_below(bounds.floor_squared)), bounds.gamma
    if lower is not None and upper is not None:
        left, right = ends(Interval(lower, upper))
    else:
        left = "not proved" if lower is None else at_least(lower, DIGITS)
        right = "not proved" if upper is None else at_most(upper, DIGITS)
    return f"{'H-infinity':12}{left:36}{right}"


def _decay_line(design: Design, bound: Fraction) -> str:
    loop = "A - BK" if design.dual else "A - LC"
    if design.certificate.plant.is_continuous:
        return f"every mode of {loop} has real part at most {at_most(-bound, DIGITS)}"
    line = f"every mode of {loop} has modulus at most {at_most(bound, DIGITS)}"
    if bound >= 1:
        return line
    return f"{line}: a decay rate of at least {at_least(decay_rate(bound, design.period), DIGITS)}"


def unproved(design: Design, bounds: DesignBounds) -> list[str]:
    """Return a line for each request that the file states and that its certificate does not prove."""
    found: list[str] = []
    gamma, decay = design.gamma, design.decay
    if gamma is not None and (bounds.gamma is None or bounds.gamma > gamma):
        proved = "none" if bounds.gamma is None else f"at most {at_most(bounds.gamma, DIGITS)}"
        found.append(f"the file states an H-infinity norm of at most {float(gamma):.10g}, proved is {proved}")
    if decay is not None and (bounds.decay is None or not _decays(design, bounds.decay, decay)):
        found.append(f"the file states a decay rate of at least {float(decay):.10g}, which is not proved")
    return found


def _decays(design: Design, bound: Fraction, decay: Fraction) -> bool:
    """Tell whether the bound proves the decay rate: rate >= decay, in discrete time radius <= exp(-decay dt)."""
    if design.certificate.plant.is_continuous:
        return bound >= decay
    return below_exp(bound, decay * design.period)


def below_exp(r: Fraction, x: Fraction) -> bool:
    """Tell whether r <= exp(-x); False where they are closer than 60 digits."""
    if x == 0:
        return r <= 1
    return abs(x) < LARGEST_EXPONENT and r <= Fraction(EXACTLY.exp(_decimal_above(x).copy_negate())) * (1 - SLACK)


def above_exp(r: Fraction, x: Fraction) -> bool:
    """Tell whether r > exp(-x); False where they are closer than 60 digits."""
    if x == 0:
        return r > 1
    return abs(x) < LARGEST_EXPONENT and r > Fraction(EXACTLY.exp(_decimal_above(-x))) * (1 + SLACK)


def _decimal_above(x: Fraction) -> Decimal:
    """Return a decimal that is at least x, and hardly more."""
    return Decimal(ceil(x / SLACK)).scaleb(-PLACES, EXACTLY)


def decay_rate(radius: Fraction, period: Fraction) -> Fraction:
    """Return a number just below -ln(radius) / period, 0 < radius < 1."""
    logarithm = Fraction(EXACTLY.ln(EXACTLY.divide(Decimal(radius.numerator), Decimal(radius.denominator))))
    return (-logarithm * (1 - SLACK) - SLACK) / period


def root_below(x: Fraction) -> Fraction:
    """Return a rational just below the square root of x >= 0."""
    shift = max(0, ROOT_BITS - (x.numerator.bit_length() - x.denominator.bit_length()) // 2)
    return Fraction(isqrt((x.numerator << 2 * shift) // x.denominator), 1 << shift)
