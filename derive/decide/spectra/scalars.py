"""Is a function of ω the spectrum of a scalar plant? Decided by polynomials in commuting letters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from derive.decide.spectra.form import Form, NoForm
from derive.functions import Abs, Power, Quotient
from derive.interpret.statement import Statement
from derive.spectral import Modulus
from derive.terms import Inverse, Neg, Number, Product, Sum, Symbol, Term, Transpose

__all__ = ["recognised"]


@dataclass(frozen=True)
class Complex:
    """(re + j im) / den with polynomials in the letters and ω."""

    re: Form
    im: Form
    den: Form

    def __add__(self, other: Complex) -> Complex:
        re = self.re * other.den + other.re * self.den
        return Complex(re, self.im * other.den + other.im * self.den, self.den * other.den)

    def __mul__(self, other: Complex) -> Complex:
        re = self.re * other.re - self.im * other.im
        return Complex(re, self.re * other.im + self.im * other.re, self.den * other.den)

    def reciprocal(self) -> Complex:
        """Return 1/x."""
        size = self.re * self.re + self.im * self.im
        if size.is_zero:
            raise NoForm("a division by zero")
        return Complex(self.re * self.den, -(self.im * self.den), size)

    def squared(self) -> Complex:
        """Return |x|^2."""
        return Complex(self.re * self.re + self.im * self.im, Form({}), self.den * self.den)


def recognised(body: Term, statement: Statement) -> tuple[str, int]:
    """Return which function of ω or s a term is: 1 + C^2 W / (V (ω^2 + A^2)), or |1 + C K / (s - A)| or its inverse.

    Raises:
        NoForm: it is another one.
    """
    given = _given(statement)
    modulus = isinstance(body, Modulus | Abs)
    found = _value(body.body if isinstance(body, Modulus | Abs) else body, given)
    A, C, W, V, P = (_letter(name, given) for name in "ACWVP")
    w, s = (_letter(name, {}) for name in ("ω", "s"))
    if _same(found, _number(1) + C * C * W * (V * (w * w + A * A)).reciprocal()):
        return "spectrum", 1
    for gain in (_letter("K", given), P * C * V.reciprocal()):
        for point, along in ((_letter("j", {}) * w, False), (s, True)):
            loop = _number(1) + C * gain * (point + _number(-1) * A).reciprocal()
            for power, function in ((1, loop), (-1, loop.reciprocal())):
                if (modulus or along) and _same(found, function):
                    return "loop", power
    raise NoForm("the logarithm of another function")


def _same(one: Complex, two: Complex) -> bool:
    gap = one + _number(-1) * two
    return gap.re.is_zero and gap.im.is_zero


def _given(statement: Statement) -> Mapping[str, Term]:
    """Return the letters that are assumed to be something else."""
    found: dict[str, Term] = {}
    for c in statement.theory.conditions:
        if c.relation == "=" and isinstance(c.lhs, Symbol) and c.lhs.name not in found:
            found[c.lhs.name] = c.rhs
    return found


def _number(value: Fraction | int) -> Complex:
    return Complex(Form.number(value), Form({}), Form.number(1))


def _letter(name: str, given: Mapping[str, Term]) -> Complex:
    if name == "j":
        return Complex(Form({}), Form.number(1), Form.number(1))
    if name in given:
        return _value(given[name], {k: v for k, v in given.items() if k != name})
    return Complex(Form.of(name), Form({}), Form.number(1))


def _value(term: Term, given: Mapping[str, Term]) -> Complex:
    match term:
        case Number(value):
            return _number(value)
        case Symbol(name=name):
            return _letter(name, given)
        case Neg(body):
            return _number(-1) * _value(body, given)
        case Sum(addends):
            total = _number(0)
            for addend in addends:
                total = total + _value(addend, given)
            return total
        case Product(factors):
            total = _number(1)
            for factor in factors:
                total = total * _value(factor, given)
            return total
        case Quotient(top, bottom):
            return _value(top, given) * _value(bottom, given).reciprocal()
        case Inverse(body):
            return _value(body, given).reciprocal()
        case Transpose(body):
            return _value(body, given)
        case Power(Modulus(body) | Abs(body), 2):
            return _value(body, given).squared()
        case Power(body, exponent) if 0 <= exponent <= 4:
            total = _number(1)
            for _ in range(exponent):
                total = total * _value(body, given)
            return total
        case _:
            raise NoForm(f"{type(term).__name__} in a function of ω")
