"""Single edits of a formula, the smallest first, each with its description.

A letter, a transpose, an inverse, a sign, a factor 2, a factor or addend more or less, two factors swapped. Only edits
whose shapes fit are made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction

from derive.latex.plain import plain
from derive.terms import (
    Block,
    Dot,
    Expect,
    Gradient,
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
)

__all__ = ["Edit", "Shape", "edits", "shape_of", "tidy"]

Shape = tuple[str, str]


@dataclass(frozen=True)
class Edit:
    """The edited formula, what was done, how large a change that is, and the kind and the piece for an explanation."""

    term: Term
    words: tuple[str | Term, ...]
    cost: int
    kind: str
    about: Term | None = None

    @property
    def text(self) -> str:
        """What was done, in words."""
        return "".join(w if isinstance(w, str) else plain(w) for w in self.words)

    @property
    def piece(self) -> str:
        """The piece of the formula that the edit is about."""
        return plain(self.about) if self.about is not None else ""


def shape_of(term: Term) -> Shape | None:
    """Return (rows, cols) of a matrix, () for a number, or None if shapes do not fit."""
    match term:
        case Symbol(scalar=True) | Number():
            return ("", "")
        case Symbol(rows=rows, cols=cols):
            return rows, cols
        case Identity(size):
            return size, size
        case Neg(body) | Dot(body) | Expect(body):
            return shape_of(body)
        case Transpose(body):
            found = shape_of(body)
            return found and (found[1], found[0])
        case Inverse(body):
            found = shape_of(body)
            return found if found and found[0] == found[1] else None
        case Trace(body):
            found = shape_of(body)
            return ("", "") if found and found[0] == found[1] else None
        case Sum(addends):
            shapes = {shape_of(a) for a in addends}
            return shapes.pop() if len(shapes) == 1 else None
        case Product(factors):
            total: Shape = ("", "")
            for factor in factors:
                found = shape_of(factor)
                if found is None or (total != ("", "") and found != ("", "") and total[1] != found[0]):
                    return None
                total = found if total == ("", "") else total if found == ("", "") else (total[0], found[1])
            return total
        case _:
            return getattr(term, "rows", ""), getattr(term, "cols", "")


def edits(term: Term, letters: Sequence[Symbol], addends: Sequence[Term]) -> Iterator[Edit]:
    """Iterate over the edits of a term at one place, or at all places where the same piece stands.

    Args:
        term: the formula.
        letters: the letters that may be put in.
        addends: the terms that may be added to a sum.
    """
    wanted = shape_of(term)
    for edit in (*_at(term, letters, addends, True), *_everywhere(term, letters)):
        if shape_of(edit.term) == wanted and edit.term != term:
            yield edit


def _at(term: Term, letters: Sequence[Symbol], addends: Sequence[Term], whole: bool) -> Iterator[Edit]:
    """Iterate over the edits of a term; ``whole`` if it is no factor, so that it may become a sum."""
    yield from _here(term, letters, addends, whole)
    for rebuild, child in _places(term):
        inner = not isinstance(term, (Product, Transpose, Sum))
        for edit in _at(child, letters, addends, inner):
            yield replace(edit, term=rebuild(edit.term))


def _everywhere(term: Term, letters: Sequence[Symbol]) -> Iterator[Edit]:
    """Iterate over edits of a piece that stands at several places, made at all of them."""
    counts: dict[Term, int] = {}
    for piece in walk(term):
        counts[piece] = counts.get(piece, 0) + 1
    for piece in (p for p, count in counts.items() if count > 1 and isinstance(p, (Symbol, Sum, Transpose))):
        for edit in _here(piece, letters, (), False):
            if edit.kind in ("letter", "transpose", "inverse", "plus", "minus", "swap"):
                yield replace(edit, term=_replaced(term, piece, edit.term), words=(*edit.words, " everywhere"))
        if isinstance(piece, Sum):
            turned = _replaced(term, piece, piece.T)
            yield Edit(turned, ("the transpose of ", piece, " everywhere"), 3, "transpose", piece.T)


def _replaced(term: Term, piece: Term, new: Term) -> Term:
    """Put another term in the place of a piece, wherever it stands."""
    if term == piece:
        return new
    if isinstance(term, Block):
        return Block(tuple(tuple(_replaced(t, piece, new) for t in row) for row in term.rows))
    values = {f.name: getattr(term, f.name) for f in fields(term)}  # type: ignore[arg-type]
    for name, value in values.items():
        if isinstance(value, Term):
            values[name] = _replaced(value, piece, new)
        elif isinstance(value, tuple):
            values[name] = tuple(_replaced(v, piece, new) if isinstance(v, Term) else v for v in value)
    return tidy(replace(term, **values))  # type: ignore[type-var]


def tidy(term: Term) -> Term:
    """Leave out what cancels: two transposes or signs, a factor 1, brackets around a product in a product."""
    match term:
        case Transpose(Transpose(body)) | Neg(Neg(body)) | Inverse(Inverse(body)):
            return body
        case Product(factors):
            flat = [g for f in factors for g in (f.factors if isinstance(f, Product) else (f,))]
            kept = [f for f in flat if f != Number(Fraction(1))] or flat[:1]
            return kept[0] if len(kept) == 1 else Product(tuple(kept))
        case Sum(addends):
            flat = tuple(g for a in addends for g in (a.addends if isinstance(a, Sum) else (a,)))
            return flat[0] if len(flat) == 1 else Sum(flat)
        case _:
            return term


def _places(term: Term) -> Iterator[tuple[Callable[[Term], Term], Term]]:
    """Iterate over the terms directly below, each with the function that puts another in its place."""
    if isinstance(term, (Symbol, Number, Identity)):
        return
    if isinstance(term, Block):
        for i, row in enumerate(term.rows):
            for j, entry in enumerate(row):
                yield (lambda new, i=i, j=j: Block(_changed(term.rows, i, _changed(term.rows[i], j, new)))), entry
        return
    for f in fields(term):  # type: ignore[arg-type]
        value = getattr(term, f.name)
        if isinstance(value, Term):
            yield (lambda new, name=f.name: tidy(replace(term, **{name: new}))), value  # type: ignore[type-var]
        elif isinstance(value, tuple) and value and isinstance(value[0], Term):
            for i, child in enumerate(value):
                yield (lambda new, name=f.name, v=value, i=i: _with(term, name, _changed(v, i, new))), child


def _with(term: Term, name: str, values: tuple[Term, ...]) -> Term:
    return tidy(replace(term, **{name: values}))  # type: ignore[type-var]


def _changed(values: tuple, at: int, new) -> tuple:
    return (*values[:at], new, *values[at + 1 :])


def _here(term: Term, letters: Sequence[Symbol], addends: Sequence[Term], whole: bool) -> Iterator[Edit]:
    match term:
        case Symbol(scalar=False):
            yield from _letter(term, letters)
        case Transpose(body):
            yield Edit(body, (body, " for ", term), 2, "transpose", body)
        case Inverse(body):
            yield Edit(body, ("without the inverse of ", body), 2, "inverse", body)
        case Number(value):
            yield Edit(Number(2 * value), ("twice the factor",), 2, "factor 2")
            yield Edit(Number(value / 2), ("half the factor",), 2, "factor 2")
            yield Edit(Number(-value), ("the other sign of the factor",), 2, "plus")
        case Sum(parts):
            yield from _sum(parts, addends)
        case Product(factors):
            yield from _product(factors, letters)
        case _:
            pass
    if isinstance(term, (Symbol, Transpose, Inverse)) and not getattr(term, "scalar", False):
        yield from _around(term, letters)
    found = shape_of(term)
    if found and found[0] and not isinstance(term, (Sum, Zero, Gradient)):
        yield from _alone(term, found, addends, whole)


def _alone(term: Term, shape: Shape, addends: Sequence[Term], whole: bool) -> Iterator[Edit]:
    """Add to what is no sum, double or halve it, turn its sign."""
    for addend in addends:
        if shape_of(addend) == shape and addend != term and (whole or _is_innovation(addend, term)):
            yield Edit(Sum((term, addend)), ("with the addend ", addend), 4 if whole else 5, "addend", addend)
    if isinstance(term, (Product, Symbol)):
        for number in (Fraction(2), Fraction(1, 2)):
            twice = _times(number, term)
            yield Edit(twice, (twice, " for ", term), 3, "factor 2")
        yield Edit(Neg(term), ("the other sign of ", term), 2, "minus", term)
    if isinstance(term, Neg):
        yield Edit(term.body, ("the other sign of ", term.body), 2, "plus", term.body)


def _is_innovation(addend: Term, term: Term) -> bool:
    """Tell whether C P C' is added to the covariance of a measurement."""
    return (
        isinstance(term, Symbol)
        and isinstance(addend, Product)
        and isinstance(addend.factors[0], Symbol)
        and (addend.factors[0].glyph.letter == "C")
    )


def _times(number: Fraction, term: Term) -> Term:
    factors = term.factors if isinstance(term, Product) else (term,)
    return Product((Number(number), *factors))


def _letter(term: Symbol, letters: Sequence[Symbol]) -> Iterator[Edit]:
    for other in letters:
        if other.letter == term.letter:
            continue
        same = other.glyph.letter == term.glyph.letter
        if (other.rows, other.cols) == (term.rows, term.cols):
            yield Edit(other, (other, " for ", term), 1 if same else 2, "letter", other)
        if (other.cols, other.rows) == (term.rows, term.cols) and other.rows != other.cols:
            yield Edit(other.T, (other.T, " for ", term), 2, "letter", other)
    if not term.symmetric:
        yield Edit(term.T, (term.T, " for ", term), 2, "transpose", term.T)
    if term.rows == term.cols:
        yield Edit(term.inv, (term.inv, " for ", term), 2, "inverse", term)


def _around(term: Term, letters: Sequence[Symbol]) -> Iterator[Edit]:
    """Put a factor before or after a factor."""
    shape = shape_of(term)
    if not shape:
        return
    for factor in _factors(letters):
        size = shape_of(factor)
        if size and size[1] == shape[0]:
            yield Edit(Product((factor, term)), ("with ", factor, " in front of ", term), 3, "factor", factor)
        if size and size[0] == shape[1]:
            yield Edit(Product((term, factor)), ("with ", factor, " after ", term), 3, "factor", factor)


def _factors(letters: Sequence[Symbol]) -> Iterator[Term]:
    for letter in letters:
        yield letter
        if not letter.symmetric:
            yield letter.T
        if letter.rows == letter.cols:
            yield letter.inv


def _sum(parts: tuple[Term, ...], addends: Sequence[Term]) -> Iterator[Edit]:
    shape = shape_of(parts[0])
    for i, part in enumerate(parts):
        rest = (*parts[:i], *parts[i + 1 :])
        body = part.body if isinstance(part, Neg) else part
        flipped = body if isinstance(part, Neg) else Neg(part)
        sign = "plus" if isinstance(part, Neg) else "minus"
        yield Edit(Sum(_changed(parts, i, flipped)), ("the other sign of ", body), 2 if i else 3, sign, body)
        yield Edit(rest[0] if len(rest) == 1 else Sum(rest), ("without ", body), 4, "drop", body)
    for addend in addends:
        if shape_of(addend) == shape:
            yield Edit(Sum((*parts, addend)), ("with the addend ", addend), 4, "addend", addend)
            yield Edit(Sum((*parts, Neg(addend))), ("less ", addend), 4, "addend", addend)


def _product(factors: tuple[Term, ...], letters: Sequence[Symbol]) -> Iterator[Edit]:
    for i, factor in enumerate(factors):
        rest = (*factors[:i], *factors[i + 1 :])
        if rest:
            shorter = rest[0] if len(rest) == 1 else Product(rest)
            yield Edit(shorter, ("without the factor ", factor), 3, "drop", factor)
        if i + 1 < len(factors):
            swapped = (*factors[:i], factors[i + 1], factor, *factors[i + 2 :])
            yield Edit(Product(swapped), (factor, " and ", factors[i + 1], " swapped"), 2, "swap")
    term, ends = Product(factors), (factors[0], factors[-1])
    if len(factors) > 1 and (ends[0] == Transpose(ends[1]) or Transpose(ends[0]) == ends[1]):
        turned = (tidy(ends[0].T), *factors[1:-1], tidy(ends[1].T))
        yield Edit(Product(turned), ("the two transposes of ", term, " exchanged"), 3, "transpose", Product(turned))
    for letter in letters:
        for x in (letter, letter.T):
            yield Edit(
                tidy(Product((x, term, tidy(x.T)))), ("with ", x, " and its transpose around ", term), 4, "around"
            )
