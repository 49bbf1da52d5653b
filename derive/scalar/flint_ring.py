"""Polynomials over the rational numbers by FLINT: fast arithmetic, factors, values at points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from derive.kernel import ANY, Poly

__all__ = ["FlintRing", "fraction", "rational"]


LARGE = 300  # addends of a polynomial that is factored


def rational(value: Fraction | int) -> Any:
    """Return a rational number of FLINT."""
    return fmpq(value.numerator, value.denominator)


def fraction(value: Any) -> Fraction:
    """Return a rational number of Python."""
    return Fraction(int(value.p), int(value.q))


class FlintRing:
    """Polynomials in some letters."""

    def __init__(self, names: Sequence[str]):
        self.names = tuple(names)
        self.index = {name: i for i, name in enumerate(self.names)}
        self.context = fmpq_mpoly_ctx.get([f"x{i}" for i in range(len(self.names))], Ordering.lex)
        self.gens = self.context.gens()

    def constant(self, value: Fraction) -> Any:
        """Return a rational number."""
        return self.context.constant(rational(value))

    def letter(self, name: str) -> Any:
        """Return a letter."""
        return self.gens[self.index[name]]

    def of(self, poly: Poly) -> Any:
        """Return a polynomial of the kernel as one of this ring."""
        found: dict[tuple[int, ...], Any] = {}
        for (names, _), c in poly.terms.items():
            powers = [0] * len(self.names)
            for name in names:
                powers[self.index[name]] += 1
            found[tuple(powers)] = rational(c)
        return self.context.from_dict(found)

    def poly(self, value: Any) -> Poly:
        """Return a polynomial of this ring as one of the kernel."""
        return Poly({(tuple(sorted(m)), ()): c for m, c in self.terms(value)}, ANY, ANY)

    def terms(self, value: Any) -> Iterator[tuple[tuple[str, ...], Fraction]]:
        """Iterate over the products of letters and their coefficients."""
        for powers, c in value.to_dict().items():
            m = tuple(self.names[i] for i, e in enumerate(powers) if e for _ in range(int(e)))
            yield m, fraction(c)

    def size(self, value: Any) -> int:
        """Return the number of addends."""
        return len(value)

    def letters(self, value: Any) -> set[str]:
        """Return the letters that occur."""
        return {self.names[i] for i, d in enumerate(value.degrees()) if d > 0}

    def divided(self, value: Any, factor: Any) -> Any:
        """Return the quotient, None if there is a remainder."""
        if not len(factor):
            return None
        quotient, rest = divmod(value, factor)
        return quotient if not len(rest) else None

    def factors(self, value: Any) -> tuple[Fraction, list[tuple[Any, int]]]:
        """Return number and irreducible factors with their powers; a large polynomial is left whole."""
        if len(value) > LARGE:
            return Fraction(1), [(value, 1)]
        content, found = value.factor()
        return fraction(content), [(f, int(e)) for f, e in found]

    def at(self, value: Any, point: Mapping[str, Any]) -> Any:
        """Return the value at a point; letters that do not occur need none."""
        zero = fmpq(0)
        return value(*(point.get(name, zero) for name in self.names))
