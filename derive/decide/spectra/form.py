"""Numbers as polynomials in named quantities, negative powers allowed for those that do not vanish."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

__all__ = ["Form", "NoForm"]

Monomial = tuple[tuple[str, int], ...]


class NoForm(Exception):  # noqa: N818 - what was found about a formula
    """A formula is no polynomial in the quantities that the theorems speak of."""


@dataclass(frozen=True)
class Form:
    """A sum of products of quantities with rational coefficients."""

    terms: Mapping[Monomial, Fraction]

    @classmethod
    def number(cls, value: Fraction | int) -> Form:
        """Return a number."""
        return cls({(): Fraction(value)} if value else {})

    @classmethod
    def of(cls, name: str, power: int = 1) -> Form:
        """Return a quantity."""
        return cls({((name, power),): Fraction(1)})

    def __add__(self, other: Form) -> Form:
        total = dict(self.terms)
        for key, c in other.terms.items():
            total[key] = total.get(key, Fraction(0)) + c
        return Form({key: c for key, c in total.items() if c})

    def __neg__(self) -> Form:
        return Form({key: -c for key, c in self.terms.items()})

    def __sub__(self, other: Form) -> Form:
        return self + -other

    def __mul__(self, other: Form) -> Form:
        total = Form({})
        for a, c in self.terms.items():
            total += Form({_joined(a, b): c * d for b, d in other.terms.items()})
        return total

    def power(self, exponent: int) -> Form:
        """Return a natural power."""
        total = Form.number(1)
        for _ in range(exponent):
            total = total * self
        return total

    def reciprocal(self, nonzero: frozenset[str]) -> Form:
        """Return 1/x for a single product of quantities that do not vanish."""
        if len(self.terms) != 1:
            raise NoForm("a division by a sum")
        (((key), c),) = self.terms.items()
        if any(name not in nonzero for name, _ in key):
            raise NoForm("a division by what may be zero")
        return Form({tuple((name, -power) for name, power in key): 1 / c})

    def replaced(self, name: str, by: Form) -> Form:
        """Put a form in the place of a quantity that occurs with powers >= 0."""
        total = Form({})
        for key, c in self.terms.items():
            powers = dict(key)
            power = powers.pop(name, 0)
            if power < 0:
                raise NoForm("a division by a sum")
            total += Form({tuple(sorted(powers.items())): c}) * by.power(power)
        return total

    @property
    def is_zero(self) -> bool:
        """Whether it is zero."""
        return not self.terms

    @property
    def names(self) -> set[str]:
        """The quantities that occur."""
        return {name for key in self.terms for name, _ in key}


def _joined(a: Monomial, b: Monomial) -> Monomial:
    powers = dict(a)
    for name, power in b:
        powers[name] = powers.get(name, 0) + power
    return tuple(sorted((name, power) for name, power in powers.items() if power))
