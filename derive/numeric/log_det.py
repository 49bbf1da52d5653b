"""Rigorous enclosure of the logarithmic integral of the output's spectrum, three ways that share no eigenvalue."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from flint import acb, acb_mat, arb, arb_mat, fmpq_poly

from derive.numeric.balls import bits_for, digits_of, floats, identity, working_bits
from derive.numeric.eigenvalues import enclosed_eigenvalues
from derive.numeric.log_integral import log_integral
from derive.numeric.modes import Matrix, format_mode
from derive.numeric.newton import Equation
from derive.numeric.plant import Plant
from derive.numeric.spectral_polynomials import ball_of, rational, spectral_polynomials

__all__ = [
    "LogDetEnclosure",
    "Way",
    "enclose_by_eigenvalues",
    "enclose_by_polynomials",
    "enclose_by_quadrature",
    "enclose_log_det",
    "enclose_unstable_term",
]

Way = Literal["eigenvalues", "polynomials", "quadrature"]

SPARE_BITS = 64
POLYNOMIAL_ATTEMPTS = 5
"""Attempts, each with twice the bits of the one before."""

QUADRATURE_DIGITS = 15


@dataclass(frozen=True, eq=False, kw_only=True)
class LogDetEnclosure:
    """What is proved about the output cost by the spectrum.

    Attributes:
        status: "verified", or "open" when no ball could be closed: then the numbers are balls that hold everything.
        reason: one line that names the mode in the way; empty when verified.
        way: how it was enclosed.
        value: encloses tr(C P C' V^-1), in discrete time ln det(C P C' + R), for the strong solution P.
        integral: encloses (1/2 pi) int ln(det Phi / det V) dw, in discrete time (1/2 pi) int ln det Phi dw; Phi is the
            spectrum without cross term, as of `output_error_integral`.
        unstable_term: encloses 2 sum max(0, Re lambda_i(F)), in discrete time 2 sum max(0, ln |lambda_i(F)|).
        digits: decimal digits of `value` that are proved.
    """

    status: Literal["verified", "open"]
    reason: str = ""
    way: Way
    value: arb = arb("nan")  # noqa: RUF009 (balls are immutable)
    integral: arb = arb("nan")  # noqa: RUF009
    unstable_term: arb = arb("nan")  # noqa: RUF009
    digits: int = 0


def enclose_log_det(plant: Plant, digits: int = 20) -> LogDetEnclosure:
    """Enclose the integral by eigenvalues, and where they are multiple by the roots of exact polynomials.

    Continuous: tr(C P C' V^-1) = (1/2 pi) int ln(det Phi / det V) dw + 2 sum max(0, Re lambda_i(F)).
    Discrete: ln det(C P C' + R) = (1/2 pi) int ln det Phi dw + 2 sum max(0, ln |lambda_i(F)|).

    Modes on the boundary contribute zero to either side, so they need no exception.

    Args:
        plant: W >= 0, V > 0, [[W, N], [N', V]] >= 0, (A, C) detectable; the doubles are taken as exact.
        digits: decimal digits aimed at.

    Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, arXiv:1807.08604 (2018), equation (12) and theorem 2.

    Example:
        >>> from derive.numeric.plant import example_plant
        >>> enclose_log_det(example_plant()).digits >= 20
        True
    """
    first = enclose_by_eigenvalues(plant, digits)
    if first.status == "verified" and first.digits >= digits:
        return first
    second = enclose_by_polynomials(plant, digits)
    return second if second.digits >= first.digits else first


def enclose_by_eigenvalues(plant: Plant, digits: int = 20) -> LogDetEnclosure:
    """Enclose by the eigenvalues of F and of the Hamiltonian matrix, in discrete time of the symplectic pencil.

    Continuous: tr(C P C' V^-1) = tr F + sum |Re mu_i| / 2 over the 2 n eigenvalues of [[F', -G], [-q, -F]].
    Discrete: with M(z) = [[z - F, -q], [z G, 1 - z F']] and nu_i the eigenvalues of M(a)^-1 M', |a| = 1,
    ln det(C P C' + R) = ln det V + ln |det M(a)| + sum ln max(|1 - a nu_i|, |nu_i|), by Jensen's formula.
    """
    accuracy = bits_for(digits) + 16
    with working_bits(accuracy + SPARE_BITS):
        equation = Equation.of(plant)
        loop = enclosed_eigenvalues(acb_mat(equation.F), accuracy)
        try:
            whole = _by_hamiltonian(equation, accuracy) if plant.is_continuous else _by_pencil(equation, accuracy)
        except ZeroDivisionError:
            return _open(plant, "eigenvalues", "pencil: expected regular at 1, -1 or j, got singular")
        if loop is None or whole is None:
            return _open(plant, "eigenvalues", "eigenvectors: expected independent ones, got none in double precision")
        unstable = 2 * sum((_unstable(x, plant) for x in loop), arb(0))
        return _result(plant, "eigenvalues", whole, whole - unstable, unstable)


def enclose_by_polynomials(plant: Plant, digits: int = 20) -> LogDetEnclosure:
    """Enclose by the roots of the exact numerator n of det Phi and of det(s - F), with exact multiplicities.

    Continuous: tr(C P C' V^-1) = tr F + sum Re sqrt(x_i) over the roots of n(s^2).
    Discrete: ln det(C P C' + R) = ln |leading coefficient of n| + sum ln max|z_i|, z_i + 1/z_i = x_i a root of n.
    """
    exact_ones = spectral_polynomials(plant)
    bits = bits_for(digits) + SPARE_BITS
    result = _open(plant, "polynomials", "roots: expected them isolated, got none")
    for _ in range(POLYNOMIAL_ATTEMPTS):
        with working_bits(bits):
            unstable = 2 * _summed(exact_ones.feedback, lambda x: _unstable(x, plant))
            whole = _summed(exact_ones.numerator, _re_sqrt if plant.is_continuous else _ln_outer)
            whole += ball_of(exact_ones.trace) if plant.is_continuous else abs(_leading(exact_ones.numerator)).log()
            result = _result(plant, "polynomials", whole, whole - unstable, unstable)
            if result.digits >= digits or whole.rad() < arb(10) ** (-2 * digits):
                break
        bits *= 2
    return result


def enclose_by_quadrature(plant: Plant, digits: int = QUADRATURE_DIGITS) -> LogDetEnclosure:
    """Enclose by rigorous Gauss-Legendre quadrature of ln(n/d), with the exact polynomials without common factors.

    Floating-point eigenvalues only say where to cut the line; no ball depends on them. Continuous time is integrated to
    an R of twice the largest root and then as a series in 1/w with a bound of its rest. Modes on the boundary that the
    noise excites are singularities that this way refuses.

    Source: F. Johansson, Numerical integration in arbitrary-precision ball arithmetic, 2018, which does the quadrature.
    """
    p = spectral_polynomials(plant)
    hints = np.linalg.eigvals(_feedback(plant))
    with working_bits(bits_for(digits) + 2 * SPARE_BITS + 4 * plant.n):
        integral = log_integral(p, hints, digits)
        unstable = 2 * _summed(p.feedback, lambda x: _unstable(x, plant))
        return _result(plant, "quadrature", integral + unstable, integral, unstable)


def enclose_unstable_term(plant: Plant, digits: int = 20) -> arb:
    """Enclose 2 sum max(0, Re lambda_i(A)), in discrete time 2 sum max(0, ln |lambda_i(A)|), by the exact det(s - A).

    Without cross term A = F, and this is the `unstable_term` of the plant's `LogDetEnclosure`.
    """
    with working_bits(bits_for(digits) + SPARE_BITS):
        return 2 * _summed(rational(plant.A).charpoly(), lambda x: _unstable(x, plant))


def _feedback(plant: Plant) -> Matrix:
    """Return F = A - N V^-1 C in double precision (n, n)."""
    return plant.A - plant.N @ np.linalg.solve(plant.V, plant.C)


def _result(plant: Plant, way: Way, value: arb, integral: arb, unstable: arb) -> LogDetEnclosure:
    if not value.is_finite():
        return _open(plant, way, "ball: expected finite, got none")
    digits = digits_of(value.rad(), value)
    return LogDetEnclosure(
        status="verified", way=way, value=value, integral=integral, unstable_term=unstable, digits=digits
    )


def _open(plant: Plant, way: Way, reason: str) -> LogDetEnclosure:
    modes = np.linalg.eigvals(_feedback(plant))
    distance = np.abs(modes.real) if plant.is_continuous else np.abs(np.abs(modes) - 1)
    return LogDetEnclosure(
        status="open",
        way=way,
        reason=f"{reason}; the mode nearest to the boundary is about {format_mode(modes[int(np.argmin(distance))])}",
    )


def _unstable(x: acb, plant: Plant) -> arb:
    """Return max(0, Re x), in discrete time max(0, ln |x|)."""
    if plant.is_continuous:
        return x.real.max(arb(0))
    return abs(x).max(arb(1)).log()


def _by_hamiltonian(equation: Equation, accuracy: int) -> arb | None:
    F, G = equation.F, equation.curvature(arb_mat(equation.n, equation.n))
    modes = enclosed_eigenvalues(acb_mat(_blocks(F.transpose(), G * -1, equation.q * -1, F * -1)), accuracy)
    return None if modes is None else F.trace() + sum((abs(x.real) for x in modes), arb(0)) / 2


def _by_pencil(equation: Equation, accuracy: int) -> arb | None:
    n, F, q = equation.n, equation.F, equation.q
    G, one, zero = equation.C.transpose() * equation.V.solve(equation.C), identity(n), arb_mat(n, n)
    slope: Any
    constant: Any
    slope, constant = _blocks(one, zero, G, F.transpose() * -1), _blocks(F * -1, q * -1, zero, one)
    a = _far_point(floats(slope), floats(constant))
    if a == 1j:
        slope, constant = acb_mat(slope), acb_mat(constant)
    M = constant + slope * a
    nu = enclosed_eigenvalues(acb_mat(M.solve(slope)), accuracy)
    if nu is None:
        return None
    logs = (abs(1 - a * x).max(abs(x)).log() for x in nu)
    return equation.V.det().log() + abs(M.det()).log() + sum(logs, arb(0))


def _far_point(slope: Matrix, constant: Matrix) -> int | complex:
    """Return 1, -1 or j: where the pencil is farthest from singular, preferring real arithmetic."""
    points = (1, -1, 1j)
    sizes = [np.linalg.svd(constant + a * slope, compute_uv=False)[-1] for a in points]
    return points[int(np.argmax(np.multiply(sizes, (1.0, 1.0, 1e-3))))]


def _blocks(a: arb_mat, b: arb_mat, c: arb_mat, d: arb_mat) -> arb_mat:
    top = [x + y for x, y in zip(a.tolist(), b.tolist(), strict=True)]
    bottom = [x + y for x, y in zip(c.tolist(), d.tolist(), strict=True)]
    return arb_mat(top + bottom)


def _leading(p: fmpq_poly) -> arb:
    return ball_of(p[p.degree()])


def _summed(p: fmpq_poly, f: Callable[[acb], arb]) -> arb:
    """Return the sum of f over the roots of p with multiplicity."""
    return sum((int(count) * f(acb(root)) for root, count in cast(Any, p.numer().complex_roots())), arb(0))


def _re_sqrt(x: acb) -> arb:
    return abs(x.sqrt().real)


def _ln_outer(x: acb) -> arb:
    """Return ln of the larger |z| with z + 1/z = x."""
    root = (x * x - 4).sqrt()
    return abs((x + root) / 2).max(abs((x - root) / 2)).max(arb(1)).log()
