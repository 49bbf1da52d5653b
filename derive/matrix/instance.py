"""Exact instances: the value of a polynomial when every letter is a rational matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from derive.kernel import Alphabet, Poly, parts
from derive.rules import Fact, Grid

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mat

__all__ = ["Instance", "base", "unknowns"]


def base(letter: str) -> str:
    """Return a letter without its transposition mark; its times stay."""
    name, _, arguments = parts(letter)
    return name + ("@" + ",".join(arguments) if arguments else "")


def unknowns(poly: Poly) -> set[str]:
    """Return the letters of a polynomial, without transposition marks."""
    return {base(a) for _, w in poly.terms for a in w}


@dataclass
class Instance:
    """Values of letters and central scalars at given sizes; different times are apart, where a Dirac delta is 0."""

    alphabet: Alphabet
    sizes: Mapping[str, int]
    values: dict[str, fmpq_mat] = field(default_factory=dict)
    scalars: dict[str, fmpq] = field(default_factory=dict)

    def size(self, dimension: str) -> int:
        """Return a dimension; a number is its own value."""
        return int(dimension) if dimension.isdigit() else self.sizes[dimension]

    def shape(self, letter: str) -> tuple[int, int]:
        """Return the shape of a letter."""
        rows, cols = self.alphabet.shape(letter)
        return self.size(rows), self.size(cols)

    def evaluate(self, poly: Poly) -> fmpq_mat:
        """Return the value of a polynomial."""
        from flint import fmpq_mat

        total = fmpq_mat(self.size(poly.rows), self.size(poly.cols))
        for (m, w), c in poly.terms.items():
            total += self._word(w, poly.rows) * self._coefficient(c, m)
        return total

    def trace(self, poly: Poly) -> fmpq:
        """Return the trace of a polynomial, whose words may have different sizes."""
        from flint import fmpq

        total = fmpq(0)
        for (m, w), c in poly.terms.items():
            value = self._word(w, poly.rows)
            total += sum((value[i, i] for i in range(value.nrows())), fmpq(0)) * self._coefficient(c, m)
        return total

    def central(self, poly: Poly) -> fmpq:
        """Return the value of a polynomial in central scalars only."""
        from flint import fmpq

        return sum((self._coefficient(c, m) for (m, _), c in poly.terms.items()), fmpq(0))

    def block(self, grid: Grid) -> fmpq_mat:
        """Return the value of a block matrix."""
        rows = [[self.evaluate(p) for p in row] for row in grid]
        return stack([r for row in rows for r in beside(row)])

    def holds(self, fact: Fact) -> bool:
        """Decide a fact at this instance; facts about an initial time say nothing here."""
        from derive.matrix.exact import PROPERTIES

        return fact.kind not in PROPERTIES or PROPERTIES[fact.kind](self.block(fact.matrix))

    def _word(self, word: Sequence[str], dimension: str) -> fmpq_mat:
        if not word:
            return one(self.size(dimension))
        product = self._letter(word[0])
        for letter in word[1:]:
            product = product * self._letter(letter)
        return product

    def _letter(self, letter: str) -> fmpq_mat:
        found = self.values.get(letter)
        if found is None:
            found = self.values[base(letter)].transpose()
        return found

    def _coefficient(self, c, m: Sequence[str]) -> fmpq:
        from flint import fmpq

        value = fmpq(c.numerator, c.denominator)
        for s in m:
            value *= 0 if s.startswith("δ") else self.scalars[s]
        return value


def one(size: int) -> fmpq_mat:
    """Return the identity matrix."""
    from flint import fmpq_mat

    return fmpq_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])


def beside(blocks: Sequence[fmpq_mat]) -> list[list[fmpq]]:
    """Return the rows of blocks that stand side by side."""
    return [[b[i, j] for b in blocks for j in range(b.ncols())] for i in range(blocks[0].nrows())]


def stack(rows: Sequence[Sequence[fmpq]]) -> fmpq_mat:
    """Return the matrix with these rows."""
    from flint import fmpq_mat

    return fmpq_mat(len(rows), len(rows[0]), [x for row in rows for x in row])
