"""Terms of the frequency domain: determinants, roots of polynomials, sums over roots, values on the axis.

A polynomial is given by its roots, each with a real and an imaginary part; a family of roots is numbered by an index.
``functions.value`` reads these terms, and roots.py has the rules. Standard library only.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.terms import Symbol, Term


@dataclass(frozen=True)
class Det(Term):
    """The determinant of a square matrix."""

    body: Term


@dataclass(frozen=True)
class Entry(Term):
    """The only entry of a matrix with one row and one column: its trace, and its determinant."""

    body: Term


@dataclass(frozen=True)
class Roots(Term):
    """The product of (point - root) over a family of roots, a monic polynomial."""

    point: Term
    root: Symbol
    index: Symbol
    count: Symbol


@dataclass(frozen=True)
class RealPart(Term):
    """The real part of the roots of a family."""

    root: Symbol


@dataclass(frozen=True)
class ImaginaryPart(Term):
    """The imaginary part of the roots of a family."""

    root: Symbol


@dataclass(frozen=True)
class Conjugate(Term):
    """The complex conjugates of the roots of a family."""

    root: Symbol


@dataclass(frozen=True)
class Distance(Term):
    """The squared distance of a point to the roots of a family, or to their conjugates."""

    point: Term
    root: Term


@dataclass(frozen=True)
class Total(Term):
    """The sum over an index from 1 to a count."""

    body: Term
    index: Symbol
    count: Symbol


@dataclass(frozen=True)
class Growth(Term):
    """max(0, ln |λ|) for the roots λ of a family, and 0 where λ = 0: half of ln max(1, |λ|^2)."""

    root: Symbol


@dataclass(frozen=True)
class Modulus(Term):
    """The absolute value of a complex number."""

    body: Term


@dataclass(frozen=True)
class At(Term):
    """A function of a symbol at a point: on the imaginary axis, on the unit circle, or at a large real number."""

    body: Term
    symbol: Symbol
    point: Term


@dataclass(frozen=True)
class TimesLog(Term):
    """x ln(x^2 + a^2), and 0 where x = a = 0: continuous in x for every a."""

    factor: Term
    width: Term


@dataclass(frozen=True)
class TimesArctan(Term):
    """|a| arctan(x/|a|), and 0 where a = 0: continuous in x for every a."""

    factor: Term
    width: Term
