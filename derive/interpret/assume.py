"""Relations that are given: they define new letters, set dimensions, or state hypotheses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.interpret.given import occurs
from derive.interpret.names import spell
from derive.interpret.relations import compared
from derive.interpret.shapes import UNKNOWN, Misfit, NotUnderstood, Shape
from derive.latex import plain
from derive.latex import syntax as s
from derive.terms import Equation, Symbol, Term, Transpose, Zero

if TYPE_CHECKING:
    from derive.interpret.reader import Reader


class Assumptions:
    """What is given for one statement."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        self.found: list[tuple[Equation, bool]] = []  # and whether it defines a new letter

    def read(self, node: s.Related) -> None:
        """Take up one relation."""
        reader = self.reader
        reader.open = True
        try:
            ways = self._dimension, self._membership, self._rank, self._function, self._block, self._definition
            if not any(way(node) for way in ways):
                self.found += [(self._ordered(e), False) for e in compared(node, reader)]
        except Misfit as error:
            raise NotUnderstood(f"an assumption: {error}") from None
        finally:
            reader.open = False

    def _dimension(self, node: s.Related) -> bool:
        """Take up l = 1 or l = m = 1, which makes dimensions 1; where all are read as 1 it says nothing."""
        *names, last = node.sides
        if last != s.Digits(Fraction(1)) or set(node.relations) != {"="}:
            return False
        sizes = [n.letter for n in names if isinstance(n, s.Name) and not (n.accents or n.sub or n.sup)]
        if (
            len(sizes) != len(names)
            or not self.reader.theory.theory.sizes().issuperset(sizes)
            or any(self._known(n) for n in sizes)
        ):
            return False
        for size in sizes if not self.reader.scalar else ():
            self._set(size)
        return True

    def _set(self, size: str) -> None:
        self.reader.shapes.count += 1
        self.reader.shapes.known[size] = self.reader.sizes[size] = "1"

    def _known(self, spelled: str) -> Term | None:
        term = self.reader.theory.names.get(spelled)
        return term if isinstance(term, Symbol) and not term.scalar else None

    def _membership(self, node: s.Related) -> bool:
        r"""Take up G \in \mathbb{R}^{n \times l}, which introduces a letter."""
        match node:
            case s.Related((s.Name() as name, s.Raised(s.Name("R" | "ℝ"), size)), ("∈",)):
                wanted = self._sizes(size)
                known = self.reader.named(name)
                if known is None and not (symbol := self.reader.introduce(name)).scalar:
                    self.reader.shapes.agree((symbol.rows, symbol.cols), wanted)
                elif known is not None and known[1] is not None:
                    for size, given in zip(known[1], wanted, strict=True):
                        if given == "1" != self.reader.shapes.find(size):
                            self._set(size)
                return True
            case _:
                return False

    def _sizes(self, exponent: s.Node) -> tuple[str, str]:
        """Return the rows and columns in a set of matrices; a size that the theory does not know stays open."""
        match exponent:
            case s.Times((rows, cols)):
                return self._size(rows), self._size(cols)
            case rows:
                return self._size(rows), "1"

    def _size(self, node: s.Node) -> str:
        if node == s.Digits(Fraction(1)):
            return "1"
        known = (
            isinstance(node, s.Name)
            and node == s.Name(node.letter)
            and node.letter in self.reader.theory.theory.sizes()
        )
        return node.letter if known and isinstance(node, s.Name) else self.reader.shapes.fresh()

    def _rank(self, node: s.Related) -> bool:
        r"""Take up \operatorname{rank} C = m: full rank, by rows or by columns."""
        match node:
            case s.Related((s.Called("rank", (inner,)), s.Name(letter, (), "", "")), ("=",)):
                term, shape = self.reader.read(inner)
                if shape is None or letter not in shape:
                    raise NotUnderstood("a rank: expected the number of rows or columns, full rank")
                gram = Transpose(term) * term if shape[1] == letter else term * Transpose(term)
                self.found.append((Equation(gram, "≻", Zero(letter, letter)), False))
                return True
            case _:
                return False

    def _block(self, node: s.Related) -> bool:
        """Take up X = [X_ss, X_sv; X_sv', X_vv], which X stands for at every time; a new letter or one that varies."""
        match node:
            case s.Related((s.Name() as name, s.Matrix() as matrix), ("=" | ":=",)):
                known = self.reader.named(name)
                if known is not None and not (isinstance(known[0], Symbol) and known[0].args):
                    said = f"{plain(known[0])} is a constant of the theory"
                    raise NotUnderstood(f"a block matrix: {said}; expected a new letter, or one that varies")
                self.reader.blocks[spell(name, self.reader.notation)] = matrix
                return True
            case _:
                return False

    def _ordered(self, equation: Equation) -> Equation:
        """Note that a new letter in an order relation is symmetric."""
        for side in (equation.lhs, equation.rhs):
            if equation.relation in ("⪰", "≻") and isinstance(side, Symbol) and side in self.reader.new.values():
                self.reader.shapes.symmetric.add(side.name)
        return equation

    def _function(self, node: s.Related) -> bool:
        """Take up L(s) = ..., which stands for its right-hand side wherever it is applied."""
        match node:
            case s.Related((s.Applied(s.Name() as head, (s.Name(parameter, (), "", ""),)), body), ("=" | ":=",)):
                spelled = spell(head, self.reader.notation)
                if f"{spelled}({parameter})" in self.reader.theory.names or self.reader.named(head) is not None:
                    return False
                self.reader.functions[spelled] = parameter, body
                return True
            case _:
                return False

    def _definition(self, node: s.Related) -> bool:
        """Take up Z = C P C' + R, which defines a letter that the theory does not know."""
        match node:
            case s.Related((s.Name() as name, body), ("=" | ":=",)) if not name.accents or "dot" not in name.accents:
                known = self.reader.named(name)
                if name.letter == "I":
                    return False
                term, shape = self.reader.read(body)
                if known is not None and (occurs(known[0], term) or not self._shadows(known[1], shape)):
                    return False
                symbol = self.reader.introduce(name)
                if shape is None:
                    symbol = replace(symbol, rows="", cols="", scalar=True)
                else:
                    symbol = replace(symbol, rows=shape[0], cols=shape[1], scalar=False)
                self.reader.new[spell(name, self.reader.notation)] = symbol
                self.found.append((Equation(symbol, "=", term), True))
                return True
            case _:
                return False

    def _shadows(self, known: Shape, given: Shape) -> bool:
        """Tell whether a letter is given another shape than the theory's: it is a new one then."""
        if known is None or given is None:
            return False
        found = [self.reader.shapes.find(size) for size in (*known, *given)]
        return not any(UNKNOWN in size for size in found) and found[:2] != found[2:]
