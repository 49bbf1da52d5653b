"""The value of a formula of the frequency domain at an exact plant, as an exact number or a ball that holds it.

What depends on s is a rational function with exact coefficients; an integral of its logarithm over the axis follows
from its zeros and poles, a limit from its leading coefficients:

    (1/2 pi) int ln |f(jω)| dω = (1/2) sum |Re zeros| - (1/2) sum |Re poles|,   f -> 1
    (1/pi) int σ/(σ^2 + (ω - ω0)^2) ln |f(jω)| dω = sum ln |s0 + |Re z| - j Im z| - the same over the poles
    lim s ln |f(s)| = sum Re poles - sum Re zeros,   f -> 1
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq, fmpq_mat, fmpq_poly

from derive.decide.spectra.numbers import (
    NoValue,
    Scalar,
    Value,
    add,
    as_scalar,
    ball,
    complex_ball,
    exact,
    mapped,
    modulus,
    multiply,
    nonzero,
    positive,
    power,
    real_root,
    reciprocal,
    square,
    total_of,
)  # fmt: skip
from derive.decide.spectra.ratio import OMEGA, Fractional, J, Undefined, determinant, inverted, roots
from derive.functions import PI, Abs, Definite, Exp, Infinity, Limit, Log, Max, Power, Quotient, Root  # fmt: skip
from derive.spectral import At, Conjugate, Det, Entry, ImaginaryPart, Modulus, RealPart, Total
from derive.terms import (
    Identity,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
    walk,
)  # fmt: skip

__all__ = ["Place", "value"]

S = Fractional(fmpq_poly([0, 1]), fmpq_poly(), fmpq_poly([1]))


@dataclass(frozen=True)
class Place:
    """An exact plant: values of letters and sizes, and the families of roots that stand for those of a function.

    ``functions`` are rational functions of s by their letter, ``families`` the roots by theirs; ``root`` is the one
    that a sum is at.
    """

    sizes: Mapping[str, int]
    letters: Mapping[str, fmpq_mat]
    numbers: Mapping[str, Scalar] = field(default_factory=dict[str, Scalar])
    families: Mapping[str, list[acb]] = field(default_factory=dict[str, list[acb]])
    functions: Mapping[str, Fractional] = field(default_factory=dict[str, Fractional])
    definitions: Mapping[str, Term] = field(default_factory=dict[str, Term])
    root: tuple[str, acb] | None = None

    def size(self, dimension: str) -> int:
        """Return a dimension."""
        return int(dimension) if dimension.isdigit() else self.sizes.get(dimension, 1)


def value(term: Term, place: Place) -> Value:
    """Return the value of a term.

    Raises:
        Undefined: it has none at this plant.
        NoValue: it has a form that is not evaluated.
    """
    match term:
        case Number(number):
            return Fractional.of(number)
        case Symbol():
            return _symbol(term, place)
        case Identity(size):
            n = place.size(size)
            return [[Fractional.of(int(i == j)) for j in range(n)] for i in range(n)]
        case Zero(rows, cols):
            if not rows:
                return Fractional.of(0)
            return [[Fractional.of(0)] * place.size(cols) for _ in range(place.size(rows))]
        case Neg(body):
            return mapped(lambda x: -x, value(body, place))
        case Sum(addends):
            total = value(addends[0], place)
            for addend in addends[1:]:
                total = add(total, value(addend, place))
            return total
        case Product(factors):
            total = value(factors[0], place)
            for factor in factors[1:]:
                total = multiply(total, value(factor, place))
            return total
        case Transpose(body):
            matrix = value(body, place)
            return [list(column) for column in zip(*matrix, strict=True)] if isinstance(matrix, list) else matrix
        case Inverse(body):
            matrix = value(body, place)
            return inverted(exact(matrix)) if isinstance(matrix, list) else reciprocal(matrix)
        case Trace(body) | Entry(body):
            matrix = square(value(body, place))
            return total_of([matrix[i][i] for i in range(len(matrix))])
        case Det(body):
            return determinant(exact(square(value(body, place))))
        case Quotient(top, bottom):
            return multiply(value(top, place), reciprocal(as_scalar(value(bottom, place))))
        case Power(body, exponent):
            return power(value(body, place), exponent)
        case _:
            return _analytic(term, place)


def _symbol(symbol: Symbol, place: Place) -> Value:
    if symbol.scalar:
        known: dict[str, Scalar] = {PI.name: arb.pi(), "s": S, "j": J, "ω": OMEGA}
        if symbol.name in place.functions:
            return place.functions[symbol.name]
        if place.root and place.root[0] == symbol.name:
            return place.root[1]
        found = place.numbers.get(symbol.name, known.get(symbol.name))
        if found is None:
            raise NoValue(f"{symbol.name} has no value")
        return found
    if symbol.name in place.letters:
        matrix = place.letters[symbol.name]
        return [[Fractional.of(matrix[i, j]) for j in range(matrix.ncols())] for i in range(matrix.nrows())]
    if symbol.name in place.definitions:
        return value(place.definitions[symbol.name], place)
    raise NoValue(f"{symbol.name} has no value")


def _analytic(term: Term, place: Place) -> Value:
    match term:
        case _Conjugated(body):
            x = as_scalar(value(body, place))
            return x * x.mirrored() if isinstance(x, Fractional) else abs(x) ** 2
        case At(body, _, point):
            return _at(as_scalar(value(body, place)), point, place)
        case RealPart(root):
            return _root(root, place).real
        case ImaginaryPart(root):
            return _root(root, place).imag
        case Conjugate(root):
            return _root(root, place).conjugate()
        case Max(body):
            return ball(value(body, place)).max(arb(0))
        case Abs(body) | Modulus(body):
            return modulus(as_scalar(value(body, place)))
        case Root(body):
            return real_root(value(body, place))
        case Exp(body):
            return ball(value(body, place)).exp()
        case Log(Modulus(body) | Abs(body)):
            return abs(complex_ball(nonzero(as_scalar(value(body, place))))).log()
        case Log(body):
            return positive(ball(value(body, place))).log()
        case Total(body, index, count):
            return _total(body, index, count, place)
        case Limit(body, symbol, Infinity()) if symbol.name == "s":
            return _limit(body, place)
        case Definite(body, symbol, Neg(Infinity()), Infinity()) if symbol.name == "ω":
            return _integral(body, place)
        case _:
            raise NoValue(f"{type(term).__name__} is not evaluated")


def _root(symbol: Symbol | Term, place: Place) -> acb:
    if isinstance(symbol, Symbol) and place.root and place.root[0] == symbol.name:
        return place.root[1]
    if isinstance(symbol, Symbol) and symbol.name in place.numbers:
        return complex_ball(place.numbers[symbol.name])
    raise NoValue("the part of a root that is not summed over")


def _total(body: Term, index: Symbol, count: Symbol, place: Place) -> Value:
    names = {n.name for n in walk(body) if isinstance(n, Symbol) and n.name in place.families}
    if len(names) != 1:
        raise NoValue("a sum over no family of roots, or over two")
    (name,) = names
    values = [value(body, replace(place, root=(name, root))) for root in place.families[name]]
    return total_of([Fractional.of(0), *values])


def _at(x: Scalar, point: Term, place: Place) -> Scalar:
    """Return a function of s at a point; s and jω are the variable itself."""
    if not isinstance(x, Fractional):
        return x
    where = as_scalar(value(point, place))
    if isinstance(where, Fractional) and where == S:
        return x
    z = complex_ball(where)
    top, bottom = (p(z) for p in (_balls(x.re), _balls(x.den)))
    if not x.is_real or bottom.contains(0):
        raise Undefined("a pole of the function")
    return top / bottom


def _balls(p: fmpq_poly) -> Any:
    from flint import acb_poly

    return acb_poly([arb(c.p) / arb(c.q) for c in p.coeffs()])


# ------------------------------------------------------------------------------------------------ functions of s
@dataclass(frozen=True)
class Logarithm:
    """weight ln |f|: f a real rational function, the weight a rational function of s."""

    weight: Fractional
    of: Fractional


def _logarithms(term: Term, place: Place) -> tuple[list[Logarithm], Value]:
    """Write a term as a sum of weights times logarithms of functions, and the rest."""
    zero = Fractional.of(0)
    match term:
        case Sum(addends):
            parts = [_logarithms(a, place) for a in addends]
            return [x for logs, _ in parts for x in logs], total_of([rest for _, rest in parts])
        case Neg(body):
            logs, rest = _logarithms(body, place)
            return [Logarithm(-x.weight, x.of) for x in logs], mapped(lambda r: -r, rest)
        case Product(factors) if any(isinstance(n, Log) for f in factors for n in walk(f)):
            inner = [f for f in factors if any(isinstance(n, Log) for n in walk(f))]
            if len(inner) > 1:
                raise NoValue("a product of logarithms")
            logs, rest = _logarithms(inner[0], place)
            weight: Value = Fractional.of(1)
            for f in factors:
                weight = weight if f is inner[0] else multiply(weight, value(f, place))
            scalar = as_scalar(weight)
            if not isinstance(scalar, Fractional):
                raise NoValue("a logarithm with a weight that is not exact")
            return [Logarithm(scalar * x.weight, x.of) for x in logs], multiply(scalar, rest)
        case Quotient(top, bottom) if any(isinstance(n, Log) for n in walk(top)):
            return _logarithms(Product((Inverse(bottom), top)), place)
        case Log(body):
            inner, power = _inside(body, place)
            if inner.is_zero or not inner.is_real:
                raise Undefined("the logarithm of zero, or of no real function")
            return [Logarithm(Fractional.of(power), inner)], zero
        case _:
            return [], value(term, place)


def _inside(body: Term, place: Place) -> tuple[Fractional, Fraction]:
    """Return a function f and a power p with |body| = f^p on the axis and along the reals."""
    if isinstance(body, Modulus | Abs):
        x = as_scalar(value(body.body, place))
        if not isinstance(x, Fractional):
            raise NoValue("the logarithm of a ball in a function")
        return (x, Fraction(1)) if x.is_real else (x * x.mirrored(), Fraction(1, 2))
    x = as_scalar(value(_squared(body), place))
    if not isinstance(x, Fractional):
        raise NoValue("the logarithm of a ball in a function")
    return x, Fraction(1)


def _squared(term: Term) -> Term:
    """Replace |x|^2 by x times its conjugate, which is its value on the axis."""
    from derive.interpret.shapes import rebuilt

    def change(node: Term) -> Term:
        match node:
            case Power(Modulus(body) | Abs(body), 2):
                return _Conjugated(body)
            case _:
                return rebuilt(node, change)

    return change(term)


@dataclass(frozen=True)
class _Conjugated(Term):
    """x times its conjugate on the axis."""

    body: Term


def _integral(body: Term, place: Place) -> arb:
    logs, rest = _logarithms(body, place)
    if not _is_zero(rest):
        raise NoValue("an integrand that is no sum of logarithms")
    total = arb(0)
    for x in _gathered(logs):
        weight = x.weight.number()
        total += ball(Fractional.of(weight)) * _plain(x.of) if weight is not None else _poisson(x)
    return total


def _is_zero(x: Value) -> bool:
    x = as_scalar(x)
    return x.is_zero if isinstance(x, Fractional) else bool(x.contains(0) and x.rad().is_zero())


def _gathered(logs: list[Logarithm]) -> list[Logarithm]:
    """Join the logarithms of one weight, up to whole factors, so that their limits cancel."""
    found: list[Logarithm] = []
    for x in logs:
        for i, y in enumerate(found):
            if x.weight == y.weight:
                found[i] = Logarithm(y.weight, y.of * x.of)
                break
            if x.weight == -y.weight:
                found[i] = Logarithm(y.weight, y.of * x.of.reciprocal())
                break
        else:
            found.append(x)
    return found


def _limit_is_one(f: Fractional) -> bool:
    n, d = f.re, f.den
    return n.degree() == d.degree() and abs(n[n.degree()]) == 1


def _plain(f: Fractional) -> arb:
    """Return int ln |f(jω)| dω over the axis."""
    if not _limit_is_one(f):
        raise Undefined("the integral diverges, as the integrand does not tend to zero")
    size = sum((abs(z.real) for z in roots(f.re)), arb(0)) - sum((abs(z.real) for z in roots(f.den)), arb(0))
    return arb.pi() * size


def _poisson(x: Logarithm) -> arb:
    """Return int w ln |f| dω for w = c σ/(σ^2 + (ω - ω0)^2)."""
    weight = x.weight.reciprocal()
    if weight.den.degree() > 0 or weight.re.degree() > 2:
        raise NoValue("a weight that is not Poisson's")
    # c (σ^2 + (ω - ω0)^2)/σ with ω = -j s: -(c/σ) s^2 + j (2 c ω0/σ) s + c (σ^2 + ω0^2)/σ
    a, b = -weight.re[2], weight.im[1] / 2 if weight.im.degree() >= 1 else fmpq(0)
    if not a or weight.im[0] or weight.re[1]:
        raise NoValue("a weight that is not Poisson's")
    w0 = b / a
    square = weight.re[0] / a - w0 * w0
    if square <= 0:
        raise NoValue("a weight that is not Poisson's")
    width = (arb(square.p) / arb(square.q)).sqrt()
    s0 = acb(width, arb(w0.p) / arb(w0.q))
    if not _limit_is_one(x.of):
        raise NoValue("Poisson's formula for a function that does not tend to 1")
    total = arb(0)
    for sign, p in ((1, x.of.re), (-1, x.of.den)):
        for z in roots(p):
            total += sign * abs(s0 + abs(z.real) - acb(0, z.imag)).log()
    return arb.pi() / width / (arb(a.p) / arb(a.q)) * total


def _limit(body: Term, place: Place) -> Value:
    logs, rest = _logarithms(body, place)
    total: Value = mapped(_end, rest)
    for x in _gathered(logs):
        total = add(total, _decay(x))
    return total


def _end(x: Scalar) -> Scalar:
    """Return the limit of a rational function far out."""
    if not isinstance(x, Fractional):
        return x
    if not x.is_real:
        raise NoValue("the limit of a complex function")
    n, d = x.re.degree(), x.den.degree()
    if x.is_zero or n < d:
        return Fractional.of(0)
    if n > d:
        raise Undefined("the limit is not finite")
    return Fractional.of(x.re[n] / x.den[d])


def _decay(x: Logarithm) -> Scalar:
    """Return the limit of weight ln |f| for a weight c s^k."""
    f, w = x.of, x.weight
    n, d = f.re, f.den
    k = n.degree()
    if k != d.degree() or not w.is_real or w.den.degree() > 0 or w.re.degree() > 1:
        raise NoValue("the limit of a logarithm of another form")
    lead = n[k] / d[k]
    if abs(lead) != 1:
        if w.re.degree() == 1:
            raise Undefined("the limit is not finite")
        return multiply(w, (arb(abs(lead).p) / arb(abs(lead).q)).log())  # type: ignore[return-value]
    if w.re.degree() < 1:
        return Fractional.of(0)
    first = (n[k - 1] / n[k] if k else fmpq(0)) - (d[k - 1] / d[k] if k else fmpq(0))
    return Fractional.of(w.re[1] * first)
