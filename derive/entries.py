"""Numbers that a square matrix has: its trace, product by product, and the entry of one with one row and column.

A determinant or trace is read of a matrix that is constant in time and depends on no scalar but s. Standard library
only.
"""

from __future__ import annotations

from derive.kernel import ANY, Poly, Rejected, parts, times
from derive.real import COMPLEX, ZERO, scalars_of
from derive.terms import MissingInverse, Reading, Term, lower


def square_of(body: Term, reading: Reading) -> Poly:
    """Read one square matrix, constant in time, of which a determinant or trace is taken."""
    grid = lower(body, reading)
    if len(grid) != 1 or len(grid[0]) != 1 or grid[0][0].rows != grid[0][0].cols:
        raise Rejected("a determinant or trace is that of one square matrix")
    if any(s[0] in "∫δ" for m, _ in grid[0][0].terms for s in m):
        raise Rejected("no determinant or trace of an integral or of white noise is read")
    if not _constant(grid[0][0], reading):
        raise Rejected("no determinant or trace of a matrix that depends on time is read")
    if hidden(grid[0][0], reading) - {COMPLEX}:
        raise Rejected("no determinant or trace of a matrix that depends on a parameter other than s is read")
    return grid[0][0]


def behind(poly: Poly, reading: Reading) -> set[str]:
    """Return the scalars on which a polynomial in matrices depends."""
    return reading.real.reached(scalars_of(poly)) | hidden(poly, reading)


def hidden(poly: Poly, reading: Reading) -> set[str]:
    """Return the scalars on which letters depend: those in what they invert, and in what defines them."""
    found, seen, waiting = set[str](), set[str](), {parts(a)[0] for _, w in poly.terms for a in w}
    names = {letter: matrix for matrix, letter in reading.inverses.items()}
    while waiting:
        seen.add(letter := waiting.pop())
        below = set(reading.real.letters.get(letter, ()))
        if letter in names:
            below |= scalars_of(names[letter]) | {parts(a)[0] for _, w in names[letter].terms for a in w}
        found |= reading.real.reached(below & reading.context.alphabet.scalars)
        waiting |= below - reading.context.alphabet.scalars - seen
    return found


def _constant(poly: Poly, reading: Reading) -> bool:
    """Tell whether no letter depends on time, inverses by what they invert."""
    names = {letter: matrix for matrix, letter in reading.inverses.items()}
    letters = {parts(a)[0] for _, w in poly.terms for a in w}
    return all(_constant(names[a], reading) if a in names else a in reading.context.constants for a in letters)


def trace_of(body: Term, reading: Reading) -> Poly:
    """Read a trace as a sum of the traces of products, each of which is declared."""
    return _traces(square_of(body, reading), reading)


def _traces(poly: Poly, reading: Reading) -> Poly:
    alphabet, result = reading.context.alphabet, ZERO
    known = {tuple(alphabet.cyclic(a.of).items()): a.name for a in reading.real.atoms.values() if a.kind == "trace"}
    for (m, w), c in poly.terms.items():
        name = known.get(tuple(alphabet.cyclic(Poly({((), w): 1}, poly.rows, poly.cols)).items()))
        if name is None:
            raise MissingInverse("a trace that is not declared")
        result = result + Poly({(times(m, (name,)), ()): c}, ANY, ANY)
    return result


def entry_of(poly: Poly, reading: Reading) -> Poly:
    """Return the entry of a matrix with one row and one column, which is its trace; that of the identity is 1."""
    rest = Poly({(m, w): c for (m, w), c in poly.terms.items() if w}, poly.rows, poly.cols)
    ones = Poly({(m, ()): c for (m, w), c in poly.terms.items() if not w}, ANY, ANY)
    return _traces(rest, reading) + ones


def single_of(body: Term, reading: Reading) -> Poly:
    """Read a matrix that is known to have one row and one column."""
    poly = square_of(body, reading)
    if not any(f.kind == "single" and f.matrix[0][0].rows == poly.rows for f in reading.context.facts.values()):
        raise MissingInverse(f"the dimension {poly.rows} is not known to be 1")
    return poly
