"""Terms about real numbers as fractions of polynomials, read with somebody who answers for what they need.

A fraction N/(f1^e1 f2^e2 ...) keeps its denominator in factors. Whatever is not always defined, or looks different in
two cases, is asked for: that a divisor is not zero, the sign within |.|, how a radicand splits into a square and a
rest. Who answers proves it (search) or checks the proof (replay); the reading is the same. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any, Protocol

from derive.functions import Abs, Exp, Max, Power, Quotient, Root
from derive.kernel import ANY, Poly
from derive.real import TIME
from derive.spectral import Det, Entry, RealPart
from derive.terms import Block, Dot, Identity, Inverse, Neg, Number, Product, Sum, Symbol, Term, Trace, Transpose, Zero

__all__ = ["Answers", "Beyond", "KernelRing", "Numbers", "Ratio", "Ring", "name_of", "plain", "rate", "upright"]

LARGEST = 1_000  # addends of a polynomial
HIGHEST = 24  # exponent that is written out


class Beyond(Exception):  # noqa: N818 - what cannot be read as a fraction, no fault of the statement
    """A term is no algebraic function of real numbers; the message says which."""


class Ring(Protocol):
    """What makes polynomials; they have + - * and ==, and are written as kernel polynomials."""

    def constant(self, value: Fraction) -> Any:
        """Return a rational number."""
        ...

    def letter(self, name: str) -> Any:
        """Return a letter."""
        ...

    def of(self, poly: Poly) -> Any:
        """Return a polynomial of the kernel as one of this ring."""
        ...

    def poly(self, value: Any) -> Poly:
        """Return a polynomial of this ring as one of the kernel."""
        ...

    def size(self, value: Any) -> int:
        """Return the number of addends."""
        ...

    def divided(self, value: Any, factor: Any) -> Any:
        """Return the quotient, None if there is a remainder."""
        ...


class KernelRing:
    """Polynomials of the kernel, for replay."""

    def constant(self, value: Fraction) -> Poly:
        """Return a rational number."""
        return Poly({((), ()): value}, ANY, ANY)

    def letter(self, name: str) -> Poly:
        """Return a letter."""
        return Poly({((name,), ()): 1}, ANY, ANY)

    def of(self, poly: Poly) -> Poly:
        """Return a polynomial of the kernel as one of this ring."""
        return poly

    def poly(self, value: Poly) -> Poly:
        """Return a polynomial of this ring as one of the kernel."""
        return value

    def size(self, value: Poly) -> int:
        """Return the number of addends."""
        return len(value.terms)

    def divided(self, value: Poly, factor: Poly) -> Poly | None:
        """Return the quotient, None if there is a remainder: the largest product of letters goes first."""
        if not factor.terms:
            return None
        rest, found = value, Poly({}, ANY, ANY)
        lead = max(factor.terms, key=_order)
        while rest.terms:
            top = max(rest.terms, key=_order)
            names = list(top[0])
            for name in lead[0]:
                if name not in names:
                    return None
                names.remove(name)
            addend = Poly({(tuple(names), ()): rest.terms[top] / factor.terms[lead]}, ANY, ANY)
            rest, found = rest - addend * factor, found + addend
        return found


def _order(key: tuple[tuple[str, ...], tuple[str, ...]]) -> tuple[int, tuple[str, ...]]:
    """Order products of letters by degree, then by name: an order that multiplication keeps."""
    return len(key[0]), key[0]


@dataclass(frozen=True)
class Ratio:
    """top over the product of the factors to their powers, each of which is different from zero."""

    top: Any
    bottom: tuple[tuple[Any, int], ...] = ()


class Answers(Protocol):
    """Who answers for what a term needs; polynomials are those of the ring."""

    def nonzero(self, poly: Any) -> None:
        """Make sure that a divisor is not zero."""
        ...

    def sign(self, poly: Any) -> int:
        """Return s = 1 or -1 with s * poly >= 0."""
        ...

    def positive(self, poly: Any) -> bool:
        """Tell whether a factor is known to be positive at sight."""
        ...

    def square(self, poly: Any) -> tuple[Any, Any]:
        """Make sure that poly >= 0, and return q and s with poly = q^2 s and s >= 0."""
        ...

    def root(self, poly: Any) -> Any:
        """Return the root of s >= 0, not negative: a new letter, or the one of the same s."""
        ...

    def exponential(self, argument: Ratio) -> Ratio:
        """Return a letter for exp of a number, or a power of one."""
        ...


class Numbers:
    """Reads terms, with the letters that others stand for replaced."""

    def __init__(self, ring: Ring, values: Mapping[str, Ratio], answers: Answers):
        self.ring, self.values, self.answers = ring, values, answers
        self.rules: Mapping[type[Term], Callable[[Any], Ratio]] = {
            Root: self._root, Abs: self._absolute, Max: self._part, Inverse: self._inverse, Quotient: self._quotient,
            Power: self._power, Dot: lambda term: self.read(rate(term.body)), Block: self._block,
            Exp: lambda term: self.answers.exponential(self.read(term.body)),
        }  # fmt: skip

    # -------------------------------------------------------------------------------------------- arithmetic
    def number(self, value: Fraction | int) -> Ratio:
        """Return a rational number."""
        return Ratio(self.ring.constant(Fraction(value)))

    def letter(self, name: str) -> Ratio:
        """Return what a letter stands for, or the letter."""
        found = self.values.get(name)
        return found if found is not None else Ratio(self.ring.letter(name))

    def product_of(self, factors: tuple[tuple[Any, int], ...]) -> Any:
        """Multiply powers of polynomials out."""
        total = self.ring.constant(Fraction(1))
        for factor, exponent in factors:
            for _ in range(exponent):
                total = total * factor
        return total

    def add(self, a: Ratio, b: Ratio) -> Ratio:
        """Add two fractions over the common multiple of their denominators."""
        bottom = _union(a.bottom, b.bottom)
        one, two = (x.top * self.product_of(_missing(bottom, x.bottom)) for x in (a, b))
        return self._bounded(Ratio(one + two, bottom))

    def negative(self, a: Ratio) -> Ratio:
        """Return -a."""
        return Ratio(-a.top, a.bottom)

    def multiply(self, a: Ratio, b: Ratio) -> Ratio:
        """Multiply two fractions."""
        if self.ring.size(a.top) * self.ring.size(b.top) > 200 * LARGEST:
            raise Beyond("a product that is too large to be written out")
        return self._bounded(Ratio(a.top * b.top, _together(a.bottom, b.bottom)))

    def over(self, a: Ratio, b: Ratio) -> Ratio:
        """Divide, once the divisor is known not to be zero."""
        self.answers.nonzero(b.top)
        number, factors = self._factors(b.top)
        turned = Ratio(self.product_of(b.bottom) * self.ring.constant(1 / number), factors)
        return self.multiply(a, turned)

    def _factors(self, poly: Any) -> tuple[Fraction, tuple[tuple[Any, int], ...]]:
        """Write a polynomial as number times factors: the letters of a single product, or itself."""
        terms = self.ring.poly(poly).terms
        if len(terms) != 1:
            return Fraction(1), ((poly, 1),)
        (((names, _), number),) = terms.items()
        return number, tuple((self.ring.letter(x), names.count(x)) for x in dict.fromkeys(names))

    def _bounded(self, a: Ratio) -> Ratio:
        """Cancel the factors of the denominator that divide the numerator, and bound what is left."""
        top, bottom = a.top, list[tuple[Any, int]]()
        for factor, exponent in a.bottom:
            left = exponent
            while left and (quotient := self.ring.divided(top, factor)) is not None and self.ring.size(top):
                top, left = quotient, left - 1
            bottom += [(factor, left)] if left else []
        if self.ring.size(top) > LARGEST:
            raise Beyond("a polynomial that is too large")
        return Ratio(top, tuple(bottom))

    def same_sign(self, a: Ratio) -> Any:
        """Return a polynomial with the sign of a fraction."""
        odd = tuple((f, 1) for f, e in a.bottom if e % 2 and not self.answers.positive(f))
        return a.top * self.product_of(odd)

    def evaluate(self, poly: Poly) -> Ratio:
        """Return the value of a polynomial in letters."""
        total = self.number(0)
        for (names, _), c in poly.terms.items():
            product = self.number(c)
            for name in names:
                product = self.multiply(product, self.letter(name))
            total = self.add(total, product)
        return total

    # -------------------------------------------------------------------------------------------- terms
    def read(self, term: Term) -> Ratio:
        """Return a term as a fraction.

        Raises:
            Beyond: the term is about something else than real numbers, or is too large.
        """
        match term:
            case Symbol():
                return self.letter(name_of(term))
            case Number(value):
                return self.number(value)
            case Identity():
                return self.number(1)
            case Zero():
                return self.number(0)
            case Neg(body):
                return self.negative(self.read(body))
            case Sum(addends):
                total = self.read(addends[0])
                for addend in addends[1:]:
                    total = self.add(total, self.read(addend))
                return total
            case Product(factors):
                total = self.read(factors[0])
                for factor in factors[1:]:
                    total = self.multiply(total, self.read(factor))
                return total
            case Transpose(body) | Trace(body) | Det(body) | Entry(body) | RealPart(body):
                return self.read(body)
            case _ if type(term) in self.rules:
                return self.rules[type(term)](term)
            case _:
                raise Beyond(f"{type(term).__name__} is not decided between numbers")

    def _power(self, term: Power) -> Ratio:
        if abs(term.exponent) > HIGHEST:
            raise Beyond(f"the exponent {term.exponent} is too large")
        base, total = self.read(term.body), self.number(1)
        for _ in range(abs(term.exponent)):
            total = self.multiply(total, base)
        return total if term.exponent >= 0 else self.over(self.number(1), total)

    def _inverse(self, term: Inverse) -> Ratio:
        return self.over(self.number(1), self.read(term.body))

    def _quotient(self, term: Quotient) -> Ratio:
        return self.over(self.read(term.top), self.read(term.bottom))

    def _block(self, term: Block) -> Ratio:
        if len(term.rows) != 1 or len(term.rows[0]) != 1:
            raise Beyond("a block matrix is no number")
        return self.read(term.rows[0][0])

    def _absolute(self, term: Abs) -> Ratio:
        body = self.read(term.body)
        return body if self.answers.sign(self.same_sign(body)) > 0 else self.negative(body)

    def _part(self, term: Max) -> Ratio:
        body = self.read(term.body)
        return body if self.answers.sign(self.same_sign(body)) > 0 else self.number(0)

    def _root(self, term: Root) -> Ratio:
        """Return |q| sqrt(s)/|D| of the root of N/F, where N F' = q^2 s and F F' = D^2."""
        body = self.read(term.body)
        odd = tuple((f, 1) for f, e in body.bottom if e % 2)
        below = tuple((f, (e + 1) // 2) for f, e in body.bottom)
        q, s = self.answers.square(body.top * self.product_of(odd))
        found = Ratio(q, below)
        turned = found if self.answers.sign(self.same_sign(found)) > 0 else self.negative(found)
        return self.multiply(turned, Ratio(self.answers.root(s)))


def upright(poly: Poly) -> bool:
    """Tell which of q and -q is written: the one whose first coefficient is positive."""
    return not poly.terms or poly.terms[min(poly.terms)] > 0


def plain(poly: Poly) -> Poly:
    """Return the positive or negative multiple that is written: whole numbers without common factor, upright."""
    if not poly.terms:
        return poly
    whole = lcm(*(c.denominator for c in poly.terms.values()))
    size = Fraction(gcd(*(int(c * whole) for c in poly.terms.values())), whole)
    return poly.scale(1 / size if upright(poly) else -1 / size)


def name_of(symbol: Symbol) -> str:
    """Return the letter of a symbol; one that varies with time is written without t."""
    name = symbol.name if symbol.args in ((), ("t",)) else symbol.letter
    if name[:1] in ("∫", "δ"):
        raise Beyond(f"{name} is no number")
    return name


def rate(term: Term) -> Term:
    """Return the time derivative by sum and product rule, in letters that stand for those of letters."""
    match term:
        case Symbol(args=()) | Number() | Identity() | Zero():
            return Number(Fraction(isinstance(term, Symbol) and term.name == TIME))
        case Symbol(args=(single,)):
            return Symbol("d/dt " + name_of(term), scalar=True) if single == TIME else Number(Fraction(0))
        case Neg(body):
            return Neg(rate(body))
        case Transpose(body) | Trace(body):
            return rate(body)
        case Sum(addends):
            return Sum(tuple(map(rate, addends)))
        case Product(factors):
            parts = enumerate(factors)
            return Sum(tuple(Product((*factors[:i], rate(f), *factors[i + 1 :])) for i, f in parts))
        case Power(body, exponent) if exponent > 0:
            return Product((Number(Fraction(exponent)), Power(body, exponent - 1), rate(body)))
        case Inverse(body):
            return Neg(Product((rate(body), Inverse(body), Inverse(body))))
        case Quotient(top, bottom):
            return Quotient(Sum((Product((rate(top), bottom)), Neg(Product((top, rate(bottom)))))), Power(bottom, 2))
        case Root(body):
            return Quotient(rate(body), Product((Number(Fraction(2)), term)))
        case Exp(body):
            return Product((rate(body), term))
        case _:
            raise Beyond(f"the derivative of a {type(term).__name__.lower()} is not decided between numbers")


# ------------------------------------------------------------------------------------------------ powers of factors
Factors = tuple[tuple[Any, int], ...]


def _exponent(factor: Any, factors: Factors) -> int:
    return next((e for f, e in factors if f == factor), 0)


def _union(a: Factors, b: Factors) -> Factors:
    return (*((f, max(e, _exponent(f, b))) for f, e in a), *((f, e) for f, e in b if not _exponent(f, a)))


def _together(a: Factors, b: Factors) -> Factors:
    return (*((f, e + _exponent(f, b)) for f, e in a), *((f, e) for f, e in b if not _exponent(f, a)))


def _missing(whole: Factors, part: Factors) -> Factors:
    return tuple((f, e - _exponent(f, part)) for f, e in whole if e > _exponent(f, part))
