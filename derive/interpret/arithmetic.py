"""Sums, products, powers, fractions and transposes, with the shapes of their parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.functions import Infinity, Power, Quotient, Root
from derive.interpret.shapes import NotUnderstood, Shape, Typed, misfit, rebuilt
from derive.latex import latex
from derive.latex import syntax as s
from derive.spectral import Conjugate
from derive.terms import Identity, Inverse, Neg, Number, Product, Sum, Symbol, Term, Trace, Transpose, Zero, walk

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

ONE = Number(Fraction(1))
UNIT = ("1", "1")
CONJUGATE = frozenset({"star", "*", "ast", "H", "dagger", "†"})
COMPLEX = frozenset({"s", "j", "z"})


def number(node: s.Digits, reader: Reader) -> Typed:
    """Read a number."""
    return Number(node.value), None


def infinity(node: s.Infinite, reader: Reader) -> Typed:
    """Read the point at infinity."""
    return Infinity(), None


# ------------------------------------------------------------------------------------------------ sums
def plus(node: s.Plus, reader: Reader) -> Typed:
    """Read a sum; numbers 0 and 1 beside matrices are the zero and the identity matrix."""
    parts: list[tuple[str, Typed]] = []
    for sign, addend in node.addends:
        if sign not in "+-":
            raise NotUnderstood(f"{sign} stands for two formulas; write one with + and one with -")
        parts.append((sign, reader.read(addend)))
    shape = common([typed for _, typed in parts], reader)
    terms = [adapted(typed, shape, reader) for _, typed in parts]
    signed = [Neg(term) if sign == "-" else term for (sign, _), term in zip(parts, terms, strict=True)]
    return (signed[0] if len(signed) == 1 else Sum(tuple(signed))), shape


def common(parts: list[Typed], reader: Reader) -> Shape:
    """Return the shape that all matrices among some terms have; None if all are numbers."""
    matrices = [typed for typed in parts if typed[1] is not None]
    for other in matrices[1:]:
        if not reader.shapes.agree(matrices[0][1], other[1]):  # type: ignore[arg-type]
            raise misfit(reader.shapes, "they are not added or compared", matrices[0], other)
    numbers = any(shape is None and not _is_zero(term) for term, shape in parts)
    return matrices[0][1] if matrices and not (numbers and single(matrices[0][1], reader)) else None


def _is_zero(term: Term) -> bool:
    return isinstance(term, Number) and term.value == 0


def single(shape: Shape, reader: Reader) -> bool:
    """Tell whether a shape is one row and one column."""
    return shape is not None and (reader.shapes.find(shape[0]), reader.shapes.find(shape[1])) == UNIT


def adapted(typed: Typed, shape: Shape, reader: Reader) -> Term:
    """Return a term that stands beside terms of a shape: 0 and 1 are matrices there, and 1 x 1 matrices numbers."""
    term, own = typed
    if shape is None:
        return term if own is None else Trace(term)
    if own is not None:
        return term
    shapes = reader.shapes
    if isinstance(term, Number) and term.value == 0:
        return Zero(*shape)
    if isinstance(term, Number) and term.value == 1 and shapes.same(*shape):
        return Identity(shape[0])
    said = f"{latex(term)} is a number beside a matrix of {shapes.show(shape)}"
    multiple = latex(product([term, Identity("n")]))
    raise NotUnderstood(f"shapes: {said}; write {multiple}, or read all dimensions as 1 (scalar)")


# ------------------------------------------------------------------------------------------------ products
def times(node: s.Times, reader: Reader) -> Typed:
    """Read a product in order; numbers stand where they were written."""
    return multiplied([reader.read(factor) for factor in node.factors], reader)


def multiplied(parts: list[Typed], reader: Reader) -> Typed:
    """Return a product, neighbours checked for their shapes; a matrix of one row and column may be a number."""
    done: list[Term] = []
    group: list[Term] = []
    shape: Shape = None
    last: Typed | None = None
    negative = False
    for term, own in parts:
        if own is None:
            if isinstance(term, Neg):  # a sign in brackets leaves the product
                term, negative = term.body, not negative
            (group if group else done).append(term)
            continue
        if shape is not None and not reader.shapes.same(shape[1], own[0]):
            if single(shape, reader):
                done.append(Trace(product(group)))
                group, shape = [], None
            elif single(own, reader):
                group.append(Trace(term))
                continue
            else:
                assert last is not None
                raise misfit(reader.shapes, "they are not multiplied in this order", last, (term, own))
        shape = own if shape is None else (shape[0], own[1])
        group.append(term)
        last = term, own
    found = product(without_ones(done) if reader.scalar else done + group)
    return (Neg(found) if negative else found), shape


def product(factors: list[Term]) -> Term:
    """Return a product without products in it; a single factor is itself."""
    flat: list[Term] = []
    for factor in factors:
        flat += factor.factors if isinstance(factor, Product) else (factor,)
    return flat[0] if len(flat) == 1 else Product(tuple(flat))


def without_ones(factors: list[Term]) -> list[Term]:
    """Leave out factors 1, which identity matrices are where all dimensions are 1."""
    return [f for f in factors if f != ONE] or [ONE]


def square(typed: Typed, what: str, reader: Reader) -> None:
    """Reject a matrix that is not square."""
    shape = typed[1]
    if shape is not None and not reader.shapes.same(*shape):
        raise misfit(reader.shapes, f"{what} is that of a square matrix", typed)


def over(node: s.Over, reader: Reader) -> Typed:
    """Read a fraction; one with a matrix below is two products, and neither is guessed."""
    top, bottom = reader.read(node.top), reader.read(node.bottom)
    return divided(top, bottom, reader)


def divided(top: Typed, bottom: Typed, reader: Reader) -> Typed:
    """Return a fraction of two terms."""
    (above, shape), (below, other) = top, bottom
    if other is not None:
        if not single(other, reader):
            one, two = (latex(product(list(f))) for f in ((Inverse(below), above), (above, Inverse(below))))
            raise NotUnderstood(f"a fraction of matrices: write {one} or {two}, or read all dimensions as 1 (scalar)")
        below = Trace(below)
    if isinstance(below, Number):
        if below.value == 0:
            raise NotUnderstood(f"{latex(above)} is divided by zero")
        if isinstance(above, Number):
            return Number(above.value / below.value), None
        if shape is not None:
            return product([Number(1 / below.value), above]), shape
    if shape is not None:
        return product([Quotient(ONE, below), above]), shape
    return Quotient(above, below), None


# ------------------------------------------------------------------------------------------------ powers
def raised(node: s.Raised, reader: Reader) -> Typed:
    """Read a power: natural and negative numbers, halves, and e to a number."""
    if isinstance(node.body, s.Name):
        named = reader.named(s.Name(node.body.letter, node.body.accents, node.body.sub, exponent_text(node.exponent)))
        if named is not None:
            return named
        if node.body.letter == "e" and not node.body.sub and constant(node.exponent) is None:
            return reader.call("exp", [reader.read(node.exponent)])
    exponent = constant(node.exponent)
    if exponent is None:
        raise NotUnderstood("an exponent: expected a number, T, or a letter's own mark")
    return power(reader.read(node.body), exponent, reader)


def exponent_text(node: s.Node) -> str:
    """Return an exponent that may belong to the name below it, such as the 2 of a variance or the f of a filter."""
    match node:
        case s.Digits(value):
            return str(value)
        case s.Name(letter, (), "", ""):
            return letter
        case s.Fenced(body):
            return exponent_text(body)
        case _:
            return "?"


def constant(node: s.Node) -> Fraction | None:
    """Return the number that an exponent is."""
    match node:
        case s.Digits(value):
            return value
        case s.Fenced(body):
            return constant(body)
        case s.Plus(((sign, body),)):
            value = constant(body)
            return -value if value is not None and sign == "-" else value
        case s.Over(top, bottom):
            above, below = constant(top), constant(bottom)
            return above / below if above is not None and below else None
        case _:
            return None


def power(typed: Typed, exponent: Fraction, reader: Reader) -> Typed:
    """Return a power of a number or of a square matrix."""
    term, shape = typed
    square(typed, "a power", reader)
    if exponent < 0:
        return inverse(power(typed, -exponent, reader), reader)
    if exponent.denominator == 2:
        root = (Root(term), None) if shape is None else reader.matrix_root(term)
        return power(root, exponent * 2, reader)
    if exponent.denominator != 1 or exponent > 64:
        raise NotUnderstood(f"{latex(term)} to the power {exponent}: expected a whole number up to 64, or its half")
    if exponent == 0:
        return (ONE, None) if shape is None else (Identity(shape[0]), shape)
    if shape is None:
        if isinstance(term, Number):
            return Number(term.value ** int(exponent)), None
        return (term if exponent == 1 else Power(term, int(exponent))), None
    return product([term] * int(exponent)), shape


def inverse(typed: Typed, reader: Reader) -> Typed:
    """Return the inverse of a square matrix, or one over a number."""
    term, shape = typed
    if shape is None:
        return divided((ONE, None), typed, reader)
    square(typed, "an inverse", reader)
    return Inverse(term), shape


def inverted(node: s.Inverted, reader: Reader) -> Typed:
    """Read an inverse."""
    return inverse(reader.read(node.body), reader)


def radical(node: s.Radical, reader: Reader) -> Typed:
    """Read a square root of a number."""
    if node.index is not None and constant(node.index) != 2:
        raise NotUnderstood("a root: only square roots are read")
    return power(reader.read(node.body), Fraction(1, 2), reader)


# ------------------------------------------------------------------------------------------------ transposes
def transposed(node: s.Transposed, reader: Reader) -> Typed:
    """Read a transpose; with a star it is the conjugate transpose where jω occurs."""
    return transpose(reader.read(node.body), node.mark, reader)


def transpose(typed: Typed, mark: str, reader: Reader) -> Typed:
    """Return the transpose of a term."""
    term, shape = typed
    if mark in CONJUGATE:
        root = isinstance(term, Symbol) and term.name in reader.theory.theory.families
        term = Conjugate(term) if root and isinstance(term, Symbol) else conjugated(term, reader)
    return (term, None) if shape is None else (Transpose(term), (shape[1], shape[0]))


def conjugated(term: Term, reader: Reader) -> Term:
    """Return the complex conjugate of a term with real matrices: jω becomes -jω. That of a root has its own sign.

    Raises:
        NotUnderstood: the term contains s, of which the conjugate and -s are two readings.
    """
    names = {n.name for n in walk(term) if isinstance(n, Symbol)}
    spectra = [n for n in names if n in reader.theory.theory.complex and n not in COMPLEX and n != "ω"]
    if spectra:
        raise NotUnderstood(f"a star on {spectra[0]}: write the transpose, or the value at the opposite frequency")
    if names & {"s", "z"}:
        raise NotUnderstood("a star on a function of s: the conjugate, or the value at -s transposed; write which")
    return _turned(term) if "j" in names else term


def _turned(term: Term) -> Term:
    """Return a term with -j for j."""
    match term:
        case Product(factors) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
            return Neg(Product(tuple(f if isinstance(f, Symbol) else _turned(f) for f in factors)))
        case Neg(Product(factors)) if any(isinstance(f, Symbol) and f.name == "j" for f in factors):
            return Product(tuple(f if isinstance(f, Symbol) else _turned(f) for f in factors))
        case Symbol(name="j"):
            return Neg(term)
        case _:
            return rebuilt(term, _turned)


HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {
    s.Digits: number,
    s.Infinite: infinity,
    s.Plus: plus,
    s.Times: times,
    s.Over: over,
    s.Raised: raised,
    s.Radical: radical,
    s.Inverted: inverted,
    s.Transposed: transposed,
}
