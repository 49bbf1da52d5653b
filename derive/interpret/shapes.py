"""Shapes of terms while a formula is read: dimensions are names, or unknowns that are found from their neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

from derive.errors import InputError
from derive.latex import latex
from derive.terms import Identity, Symbol, Term, Zero

Shape = tuple[str, str] | None  # None: a number, which commutes
Typed = tuple[Term, Shape]
UNKNOWN, BESIDE = "?", "|"  # an unknown dimension is ?1, ?2, ...; that of a block matrix is n|l


class NotUnderstood(InputError):  # noqa: N818 - what a reader says of a formula
    """A formula that has no meaning in the theory, or two; the message says which letter or place is the matter.

    ``span`` are the columns of the smallest piece of the formula that has none, if they are known.
    """

    span: tuple[int, int] | None = None


class Misfit(NotUnderstood):
    """A formula whose shapes do not fit: no matrices can satisfy it."""


class Shapes:
    """What is known of the dimensions in one formula."""

    def __init__(self) -> None:
        self.known: dict[str, str] = {}
        self.count = 0
        self.symmetric: set[str] = set()  # new letters that are known to be

    def fresh(self) -> str:
        """Return a dimension that is not known yet."""
        self.count += 1
        return f"{UNKNOWN}{self.count}"

    def find(self, size: str) -> str:
        """Return what is known of a dimension."""
        while size in self.known:
            size = self.known[size]
        return BESIDE.join(self.find(part) for part in size.split(BESIDE)) if BESIDE in size else size

    def same(self, one: str, two: str) -> bool:
        """Make two dimensions the same; False if they are not."""
        one, two = self.find(one), self.find(two)
        if one == two:
            return True
        if two.startswith(UNKNOWN) and BESIDE not in two:
            one, two = two, one
        if one.startswith(UNKNOWN) and BESIDE not in one:
            self.known[one] = two
            return one not in two.split(BESIDE)
        ones, twos = one.split(BESIDE), two.split(BESIDE)
        return len(ones) == len(twos) > 1 and all(self.same(a, b) for a, b in zip(ones, twos, strict=True))

    def agree(self, one: tuple[str, str], two: tuple[str, str]) -> bool:
        """Make two shapes the same; False if they are not."""
        return self.same(one[0], two[0]) and self.same(one[1], two[1])

    def show(self, shape: Shape) -> str:
        """Write a shape as n×l; what is not known is a question mark."""
        if shape is None:
            return "a number"
        return "×".join(_shown(self.find(size)) for size in shape)

    def settled_symbol(self, symbol: Symbol) -> Symbol:
        """Put the dimensions that were found into a letter."""
        return self._symbol(symbol)

    def settle(self, term: Term) -> Term:
        """Put the dimensions that were found into a term."""
        if not self.count:
            return term
        match term:
            case Identity(size):
                found = self.find(size)
                if found.startswith(UNKNOWN):
                    raise NotUnderstood("I: its size does not follow from its neighbours; write I_n")
                return Identity(found)
            case Zero(rows, cols):
                return Zero(self.find(rows), self.find(cols)) if rows else term
            case Symbol():
                return self._symbol(term)
            case _:
                return rebuilt(term, self.settle)

    def _symbol(self, symbol: Symbol) -> Symbol:
        rows, cols = self.find(symbol.rows), self.find(symbol.cols)
        symmetric = symbol.symmetric or symbol.name in self.symmetric
        if (rows, cols, symmetric) == (symbol.rows, symbol.cols, symbol.symmetric):
            return symbol
        if UNKNOWN in rows + cols:
            raise NotUnderstood(f"{latex(symbol)}: its shape does not follow from its neighbours")
        return replace(symbol, rows=rows, cols=cols, symmetric=symmetric)


def rebuilt(term: Term, change: Callable[[Term], Term]) -> Term:
    """Return a term with every term directly below it changed."""

    def within(part: object) -> object:
        if isinstance(part, Term):
            return change(part)
        return tuple(map(within, part)) if isinstance(part, tuple) else part  # type: ignore[reportUnknownVariableType]

    return replace(term, **{f.name: within(getattr(term, f.name)) for f in fields(term)})  # type: ignore[type-var]


def _shown(size: str) -> str:
    return "(" + "+".join(size.split(BESIDE)) + ")" if BESIDE in size else size[:1] if size[:1] == UNKNOWN else size


def misfit(shapes: Shapes, what: str, *sides: Typed) -> Misfit:
    """Return the error that two terms do not fit, with both shapes."""
    said = " and ".join(f"{latex(term)} is {shapes.show(shape)}" for term, shape in sides)
    return Misfit(f"shapes: {said}; {what}")
