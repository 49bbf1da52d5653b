"""Operators: expectation, derivatives, integrals, sums over eigenvalues, block matrices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from derive.functions import Definite
from derive.interpret.arithmetic import ONE, adapted, square
from derive.interpret.functions import as_number
from derive.interpret.shapes import BESIDE, Misfit, NotUnderstood, Typed, rebuilt
from derive.interpret.times import time_of
from derive.latex import latex
from derive.latex import syntax as s
from derive.spectral import Total
from derive.terms import Block, Delta, Dot, Expect, Gradient, Identity, Integral, Symbol, Term, Trace, walk

if TYPE_CHECKING:
    from derive.interpret.reader import Reader


def expected(node: s.Expected, reader: Reader) -> Typed:
    """Read an expectation."""
    term, shape = reader.read(node.body)
    return Expect(term), shape


def dotted(node: s.Dotted, reader: Reader) -> Typed:
    """Read a dot over a group."""
    return derivative(reader.read(node.body), node.order, reader)


def derivative(typed: Typed, order: int, reader: Reader) -> Typed:
    """Return d/dt of a term."""
    term, shape = typed
    for _ in range(order):
        term = Dot(term)
    return term, shape


def differentiated(node: s.Differentiated, reader: Reader) -> Typed:
    """Read d/dt, or the gradient of a trace with respect to a gain."""
    if isinstance(node.variable, s.Name) and node.variable.letter == "t" and not node.variable.sub:
        return derivative(reader.read(node.body), node.order, reader)
    (body, shape), (symbol, own) = reader.read(node.body), reader.read(node.variable)
    if node.order != 1 or not isinstance(symbol, Symbol) or own is None:
        raise NotUnderstood("a derivative: expected one in t, or the gradient with respect to a matrix")
    if shape is not None:
        square((body, shape), "a gradient", reader)
        body = Trace(body)
    return Gradient(body, symbol), own


def integrated(node: s.Integrated, reader: Reader) -> Typed:
    """Read an integral over a time from t0 to t, or over the frequency."""
    body, shape = reader.read(node.body)
    if node.lower is None or node.upper is None:
        raise NotUnderstood("an integral: expected its limits")
    lower, upper = time_of(node.lower), time_of(node.upper)
    variable = time_of(node.variable)
    if variable is not None and lower == "t0" and upper == "t" and shape is not None:
        free = {a for n in walk(body) for a in times_in(n)}
        if "τ" not in free:  # the name of the variable says nothing; the theory writes τ
            body, variable = retimed(body, variable, "τ"), "τ"
        return Integral(body, variable), shape
    symbol, _ = reader.read(node.variable)
    if not isinstance(symbol, Symbol):
        raise NotUnderstood("an integral: expected a variable")
    ends = reader.read(node.lower)[0], reader.read(node.upper)[0]
    return Definite(body, symbol, *ends), shape


def times_in(term: Term) -> tuple[str, ...]:
    """Return the times of a letter, a delta or an integral."""
    if isinstance(term, Integral):
        return (term.variable,)
    return term.args if isinstance(term, Symbol) else (term.one, term.two) if isinstance(term, Delta) else ()


def retimed(term: Term, old: str, new: str) -> Term:
    """Return a term at another time."""
    match term:
        case Symbol(args=args):
            return replace(term, args=tuple(new if a == old else a for a in args), show_args=None) if args else term
        case Delta(one, two):
            return Delta(new if one == old else one, new if two == old else two)
        case _:
            return rebuilt(term, lambda t: retimed(t, old, new))


def summed(node: s.Summed, reader: Reader) -> Typed:
    """Read a sum over the eigenvalues, or the zeros or poles; where all dimensions are 1, it is its only term."""
    body, shape = reader.read(node.body)
    value = as_number((body, shape), "a sum", reader)
    known, count = reader.theory.theory, reader.theory.names.get("m")
    whole = node.upper is None or (count is not None and reader.read(node.upper)[0] == count)
    families = [n for n in walk(body) if isinstance(n, Symbol) and n.name in known.families]
    if node.sign != "sum" or not whole or count is None:
        raise NotUnderstood("a sum: expected one over all eigenvalues, as in \\sum_{i=1}^{m} \\Re[\\lambda_i(A)]")
    if families:
        family = known.families[families[0].name]
        return Total(value, known.symbols[family.index], known.symbols[family.count]), None
    if reader.scalar and node.upper is not None:
        return value, None
    raise NotUnderstood("a sum: nothing in it depends on its index")


# ------------------------------------------------------------------------------------------------ block matrices
def matrix(node: s.Matrix, reader: Reader) -> Typed:
    """Read a block matrix; 0 and I take the size of what stands beside and below them."""
    rows = [[reader.read(cell) for cell in row] for row in node.rows]
    if len({len(row) for row in rows}) != 1:
        raise Misfit("shapes: the rows of a block matrix have different lengths")
    if len(rows) == 1 == len(rows[0]):
        return rows[0][0]
    if all(shape is None for row in rows for _, shape in row):
        raise NotUnderstood("a matrix of numbers: blocks are expected to be letters of the theory")
    shapes = reader.shapes
    heights, widths = [shapes.fresh() for _ in rows], [shapes.fresh() for _ in rows[0]]
    for i, row in enumerate(rows):
        for j, (term, shape) in enumerate(row):
            if shape is not None and not shapes.agree((heights[i], widths[j]), shape):
                wanted = shapes.show((heights[i], widths[j]))
                raise Misfit(f"shapes: {latex(term)} is {shapes.show(shape)} in a place of {wanted}")
    cells = tuple(
        tuple(adapted(typed, (heights[i], widths[j]), reader) for j, typed in enumerate(row))
        for i, row in enumerate(rows)
    )
    return Block(cells), (BESIDE.join(heights), BESIDE.join(widths))


def identity(reader: Reader) -> Typed:
    """Return the identity matrix, of a size that follows from its neighbours."""
    if reader.scalar:
        return ONE, None
    size = reader.shapes.fresh()
    return Identity(size), (size, size)


HANDLERS: Mapping[type[s.Node], Callable[..., Typed]] = {
    s.Expected: expected,
    s.Dotted: dotted,
    s.Differentiated: differentiated,
    s.Integrated: integrated,
    s.Summed: summed,
    s.Matrix: matrix,
}
