"""Numbers, sums, products and fractions, with the shapes of their parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING

from derive.functions import Infinity, Quotient
from derive.interpret.shapes import NotUnderstood, Shape, Typed, misfit
from derive.interpret.times import time_of
from derive.latex import latex
from derive.latex import syntax as s
from derive.terms import Identity, Inverse, Neg, Number, Product, Sum, Term, Trace, Zero

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

ONE = Number(Fraction(1))
UNIT = ("1", "1")
FACTORS = 1000  # of a product, written out


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
    if len(parts) > 1 and any(isinstance(term, Infinity) for term, _ in parts):
        raise NotUnderstood("∞ is no number: it stands in limits, bounds and indices")
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
    """Read a product in order; numbers stand where they were written.

    Raises:
        NotUnderstood: a group at a time, which is no product with it: (A P)(t).
    """
    for group, argument in pairwise(node.factors):
        match group, argument:
            case s.Dotted() | s.Fenced(), s.Fenced(s.Name() as time) if time_of(time) is not None:
                raise NotUnderstood("a group at a time: write the time at each of its letters, as in A P(t)")
            case _:
                continue
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
            if isinstance(term, Infinity):
                raise NotUnderstood("∞ is no number: it stands in limits, bounds and indices")
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
    if len(flat) > FACTORS:
        raise NotUnderstood(f"a product of {len(flat)} factors; expected at most {FACTORS}")
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


HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {
    s.Digits: number,
    s.Infinite: infinity,
    s.Plus: plus,
    s.Times: times,
    s.Over: over,
}
