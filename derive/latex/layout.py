"""Layout of terms: order, signs, parentheses, accents and scripts, decided once for every printer.

``layout`` turns a term or equation into boxes. A printer (tex.py, mathml.py, plain.py) knows the nine kinds of box.
Parentheses follow the precedence sum < open operator < product < power < atom, and appear only where they are needed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from fractions import Fraction

from derive.functions import Abs, Arctan, Definite, Exp, Infinity, Limit, Log, Max, Power, Quotient, Rate, Root, Start
from derive.latex.alphabet import GREEK
from derive.latex.boxes import (
    APPLY,
    BESIDE,
    INTEGRAL,
    SCRIPT,
    THIN,
    TIMES,
    TOP,
    Accented,
    Box,
    Digits,
    Fenced,
    Letter,
    Op,
    Over,
    Radical,
    Scripted,
    Table,
    label,
    row,
)
from derive.presentation import Named
from derive.spectral import (
    At,
    Conjugate,
    Det,
    Distance,
    Entry,
    Growth,
    ImaginaryPart,
    Modulus,
    RealPart,
    Roots,
    TimesArctan,
    TimesLog,
    Total,
)
from derive.terms import (
    Block,
    Delta,
    Dot,
    Equation,
    Expect,
    Glyph,
    Gradient,
    Identity,
    Image,
    Integral,
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
)

# ------------------------------------------------------------------------------------------------ precedence
SUM, OPEN, PRODUCT, POWER, ATOM = range(5)


def level(term: Term) -> int:
    """Return how tightly a term holds together; 'open' is an operator whose operand is not closed on the right."""
    if isinstance(term, Sum) or signed(term)[0]:
        return SUM
    match term:
        case Product((only,)):
            return level(only)
        case Named(shows=shows):
            return level(shows)
        case Product():
            return PRODUCT
        case Dot(Symbol() as symbol):
            return level(symbol)
        case Dot() | Integral() | Gradient() | Definite() | Rate() | Limit() | Log() | Arctan():
            return OPEN
        case Det(body) if not isinstance(body, (Symbol, At)):
            return POWER
        case Roots():
            return PRODUCT
        case Det() | Total() | RealPart() | ImaginaryPart():
            return OPEN
        case Distance():
            return POWER
        case TimesLog() | TimesArctan():
            return PRODUCT
        case At() | Entry():
            return level(_placed(term) if isinstance(term, At) else term.body)
        case Quotient():
            return PRODUCT
        case Number(value):
            return ATOM if value.denominator == 1 else PRODUCT
        case Transpose() | Inverse() | Power() | Exp():
            return POWER
        case Symbol(glyph=Glyph(sup=sup)):
            return POWER if sup else ATOM
        case _:
            return ATOM


def signed(term: Term) -> tuple[bool, Term]:
    """Split off a leading minus sign: of a Neg, a negative number, or a product that starts with one."""
    match term:
        case Neg(body):
            return True, body
        case Number(value) if value < 0:
            return True, Number(-value)
        case Product((first, *rest)):
            negative, stripped = signed(first)
            return negative, Product((stripped, *rest)) if negative else term
        case _:
            return False, term


def at_least(term: Term, wanted: int) -> Box:
    """Lay out a term, in parentheses if it holds together less tightly than wanted."""
    return layout(term) if level(term) >= wanted else Fenced(layout(term))


# ------------------------------------------------------------------------------------------------ terms
def layout(term: Term | Equation) -> Box:
    """Lay out a term or an equation in the order in which it was written."""
    match term:
        case Equation(lhs, relation, rhs):
            return row((layout(lhs), Op(relation), layout(rhs)))
        case Named(shows=shows):
            return layout(shows)
        case Symbol():
            return _symbol(term)
        case Identity():
            return Letter("I")
        case Zero():
            return Digits("0")
        case Sum(addends):
            return _sum(addends)
        case Transpose(Inverse(body)):
            return _power(body, row((Op("−", "prefix"), Op(TOP, "tight"))))
        case Transpose(body):
            return _power(body, Op(TOP, "tight"))
        case Inverse(body):
            return _power(body, row((Op("−", "prefix"), Digits("1"))))
        case Block(rows):
            return Table(tuple(tuple(layout(t) for t in r) for r in rows))
        case Delta(one, two):
            difference = row((label(one), Op("−"), label(two)))
            return row((Letter("δ"), Op(APPLY, "tight"), Fenced(difference)))
        case Neg() | Number() | Product():
            return _product(term)
        case Root(body):
            return Radical(layout(body))
        case Quotient(top, bottom):
            return Over(layout(top), layout(bottom))
        case Power(body, exponent):
            return _power(body, Digits(str(exponent)))
        case Infinity():
            return Letter("∞")
        case Abs() | Max() | Exp() | Log() | Arctan() | Rate() | Start() | Limit() | Definite():
            return _function(term)
        case Det() | Roots() | Total() | RealPart() | ImaginaryPart() | Modulus() | TimesLog() | TimesArctan():
            return _spectral(term)
        case Conjugate() | Distance() | Growth():
            return _spectral(term)
        case Entry(body):
            return layout(body)
        case At():
            return layout(_placed(term))
        case _:
            return _operator(term)


def _symbol(symbol: Symbol, *accents: str) -> Box:
    glyph = symbol.glyph if symbol.glyph.letter else Glyph(symbol.name)
    text = glyph.letter.lstrip("\\")
    text = GREEK.get(text, text)
    box: Box = Digits(text) if text[0].isdigit() else Letter(text, glyph.upright or len(text) > 1)
    for accent in (glyph.accent, *accents):
        box = Accented(box, accent) if accent else box
    if glyph.sub or glyph.sup:
        box = Scripted(box, label(glyph.sub) if glyph.sub else None, label(glyph.sup) if glyph.sup else None)
    times = symbol.args if symbol.show_args is None else symbol.show_args
    return _applied(box, [label(t) for t in times]) if times else box


def _applied(function: Box, arguments: list[Box], left: str = "(", right: str = ")") -> Box:
    commas = [b for a in arguments for b in (Op(",", "tight"), a)][1:]
    return row((function, Op(APPLY, "tight"), Fenced(row(commas), left, right)))


def _sum(addends: tuple[Term, ...]) -> Box:
    items: list[Box] = []
    for addend in _flat(addends):
        negative, body = signed(addend)
        items.append(Op("−", "infix" if items else "prefix") if negative else Op("+"))
        items.append(at_least(body, OPEN))
    return row(items[1:] if items[0] == Op("+") else items)


def _flat(addends: Iterable[Term]) -> Iterator[Term]:
    for addend in addends:
        yield from _flat(addend.addends) if isinstance(addend, Sum) else (addend,)


# set off from the factor before them
NAMED = (Log, Arctan, Limit, Max, Growth, Det, Total, Roots, RealPart, ImaginaryPart)


def _product(term: Term) -> Box:
    negative, body = signed(term)
    if negative:
        return row((Op("−", "prefix"), at_least(body, OPEN)))
    if isinstance(body, Number):
        return _number(body.value)
    assert isinstance(body, Product)
    factors = list(_factors(body))
    items: list[Box] = []
    for i, factor in enumerate(factors):
        if i:
            named = isinstance(factor, NAMED)
            items.append(Op("⋅") if isinstance(factor, Number) else Op(BESIDE if named else TIMES, "tight"))
        items.append(at_least(factor, OPEN if i == len(factors) - 1 else PRODUCT))
    return row(items)


def _factors(product: Product) -> Iterator[Term]:
    """Dissolve products inside a product, unless one starts with a minus sign."""
    for factor in product.factors:
        yield from _factors(factor) if isinstance(factor, Product) and not signed(factor)[0] else (factor,)


def _number(value: Fraction) -> Box:
    top, bottom = Digits(str(value.numerator)), Digits(str(value.denominator))
    return top if value.denominator == 1 else Over(top, bottom, small=True)


def _map(name: str) -> Box:
    """Lay out the name of a map by its initial; that of a qualifier ("... in continuous time") is its subscript."""
    word, _, qualifier = name.partition(" in ")
    letter = Letter(SCRIPT[ord(word[0].upper()) - ord("A")], upright=True)
    return Scripted(letter, Letter(qualifier[0])) if qualifier else letter


def _power(body: Term, exponent: Box) -> Box:
    """Raise a term; the exponent joins the subscript that a symbol carries."""
    base = at_least(body, ATOM)
    if isinstance(base, Scripted):
        return Scripted(base.base, base.sub, exponent)
    return Scripted(base, None, exponent)


def _function(term: Term) -> Box:
    """Lay out a function, limit or integral of real analysis."""
    match term:
        case Abs(body):
            return Fenced(layout(body), "|", "|")
        case Max(body):
            return _applied(Letter("max", upright=True), [Digits("0"), layout(body)])
        case Exp(body):
            return Scripted(Letter("e", upright=True), None, layout(body))
        case Log(body) | Arctan(body):
            name = Letter("ln" if isinstance(term, Log) else "arctan", upright=True)
            closed = layout(body) if level(body) >= POWER else Fenced(layout(body))
            return row((name, Op(BESIDE if level(body) == POWER else APPLY, "tight"), closed))
        case Rate(body, symbol):
            d, closed = Letter("d", upright=True), at_least(body, POWER)
            return row((Over(d, row((d, layout(symbol)))), Op(APPLY, "tight"), closed))
        case Start(body, symbol):
            where = row((layout(symbol), Op("=", "tight"), Digits("0")))
            return Scripted(Fenced(layout(body), "[", "]"), where)
        case Limit(body, symbol, point):
            where = row((layout(symbol), Op("→", "tight"), layout(point)))
            closed = at_least(body, PRODUCT)
            between = Op(APPLY if isinstance(closed, Fenced) else BESIDE, "tight")
            return row((Scripted(Letter("lim", upright=True), where), between, closed))
        case Definite(body, symbol, lower, upper):
            sign = Scripted(Op(INTEGRAL, "prefix"), layout(lower), layout(upper))
            differential = row((Op(THIN, "tight"), Letter("d", upright=True), layout(symbol)))
            return row((sign, at_least(body, OPEN), differential))
        case _:
            raise TypeError(f"no layout for {type(term).__name__}")


def _spectral(term: Term) -> Box:
    """Lay out a term of the frequency domain."""
    match term:
        case Det(body):
            name, simple = Letter("det", upright=True), isinstance(body, (Symbol, At))
            return row((name, Op(BESIDE, "tight"), layout(body)) if simple else (name, Fenced(layout(body), "[", "]")))
        case RealPart(root) | ImaginaryPart(root):
            name = Letter("Re" if isinstance(term, RealPart) else "Im", upright=True)
            return row((name, Op(BESIDE, "tight"), layout(root)))
        case Conjugate(root):
            return _symbol(root, "bar")
        case Distance(point, root):
            return Scripted(Fenced(row((layout(point), Op("−"), layout(root))), "|", "|"), None, Digits("2"))
        case Modulus(body):
            return Fenced(layout(body), "|", "|")
        case Growth(root):
            return layout(Max(Log(Modulus(root))))
        case Total(body, index, count) | Roots(body, _, index, count):
            large = Op("∑" if isinstance(term, Total) else "∏", "prefix")
            start = row((layout(index), Op("=", "tight"), Digits("1")))
            difference = Fenced(row((layout(body), Op("−"), layout(term.root)))) if isinstance(term, Roots) else None
            return row((Scripted(large, start, layout(count)), difference or at_least(body, OPEN)))
        case TimesLog(x, Zero()):
            return layout(Product((x, Log(Power(x, 2)))))
        case TimesLog(x, a):
            return layout(Product((x, Log(Sum((Power(x, 2), Power(a, 2)))))))
        case TimesArctan(x, a):
            return layout(Product((Abs(a), Arctan(Quotient(x, Abs(a))))))
        case _:
            raise TypeError(f"no layout for {type(term).__name__}")


def _written(point: Term) -> str:
    """Write a point of the complex plane as a label."""
    match point:
        case Symbol(name=name):
            return name
        case Product(factors):
            return "".join(map(_written, factors))
        case Sum((first, Neg(second))):
            return f"{_written(first)}-{_written(second)}"
        case Sum(addends):
            return "+".join(map(_written, addends))
        case Number(value):
            return str(value)
        case Quotient(top, bottom):
            return f"({_written(top)})/({_written(bottom)})"
        case Exp(body):
            return f"e^{_written(body)}"
        case _:
            raise TypeError(f"no label for {type(point).__name__}")


def _placed(term: At) -> Term:
    """Write a function at a point: the point for its variable; a spectrum at jω is one at ω."""

    def within(part: object) -> object:
        if part == term.symbol:
            return term.point
        if isinstance(part, Symbol):
            name = "ω" if part.glyph.letter == "Φ" and isinstance(term.point, Product) else _written(term.point)
            shown = part.show_args and tuple(name if a == term.symbol.name else a for a in part.show_args)
            return replace(part, show_args=shown)
        if isinstance(part, Term):
            return replace(part, **{f.name: within(getattr(part, f.name)) for f in fields(part)})  # type: ignore[type-var]
        return tuple(map(within, part)) if isinstance(part, tuple) else part

    placed = within(term.body)
    assert isinstance(placed, Term)
    return placed


def _operator(term: Term) -> Box:
    match term:
        case Dot(Symbol() as symbol):
            return _symbol(symbol, "dot")
        case Dot(body):
            d = Letter("d", upright=True)
            closed = layout(body) if level(body) in (OPEN, POWER, ATOM) else Fenced(layout(body))
            return row((Over(d, row((d, Letter("t")))), Op(APPLY, "tight"), closed))
        case Gradient(body, symbol):
            closed = layout(body) if isinstance(body, Trace) else Fenced(layout(body))
            return row((Over(Op("∂", "tight"), row((Op("∂", "tight"), layout(symbol)))), Op(APPLY, "tight"), closed))
        case Integral(body, variable):
            limits = Scripted(Op(INTEGRAL, "prefix"), label("t0"), Letter("t"))
            differential = row((Op(THIN, "tight"), Letter("d", upright=True), label(variable)))
            return row((limits, at_least(body, OPEN), differential))
        case Expect(body):
            return _applied(Letter("𝔼", upright=True), [layout(body)], "[", "]")
        case Trace(body):
            return _applied(Letter("tr", upright=True), [layout(body)])
        case Image(name, body):
            return _applied(_map(name), [layout(body)], "[", "]")
        case _:
            raise TypeError(f"no layout for {type(term).__name__}")
