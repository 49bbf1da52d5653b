"""Relations that are given: they define new letters, add hypotheses, or override what the theory declares."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.context import Declared, DeclaredFact, DeclaredInverse, Theory, terms_of
from derive.interpret.names import spell
from derive.interpret.shapes import UNKNOWN, Misfit, NotUnderstood, Shape, rebuilt
from derive.latex import plain
from derive.latex import syntax as s
from derive.terms import Dot, Equation, Expect, Identity, Number, Symbol, Term, Transpose, Zero, walk
from derive.theory.claims.base import ClaimTheory, add_indexed, copy

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

OF_MATRICES = ("=", "⪰", "≻")


class Assumptions:
    """What is given for one statement."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        self.found: list[tuple[Equation, bool]] = []  # and whether it defines a new letter
        self.names: tuple[str, ...] = ()
        self.cache: list[Equation] | None = None

    def read(self, node: s.Related) -> None:
        """Take up one relation."""
        reader = self.reader
        reader.open = True
        try:
            ways = self._dimension, self._membership, self._rank, self._function, self._block, self._definition
            if not any(way(node) for way in ways):
                from derive.interpret.meaning import compared

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
                sizes = [x.letter for x in s.walk(size) if isinstance(x, s.Name)]
                wanted = sizes[0] if sizes else "1", sizes[1] if len(sizes) == 2 else "1"
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
                if known is not None and (_occurs(known[0], term) or not self._shadows(known[1], shape)):
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

    # -------------------------------------------------------------------------------------------- result
    def settled(self) -> list[Equation]:
        """Return the given equations with all dimensions found."""
        if self.cache is None:
            settle = self.reader.shapes.settle
            self.cache = [Equation(settle(e.lhs), e.relation, settle(e.rhs)) for e, _ in self.found]
        return self.cache

    def within(self) -> list[Term]:
        """Return what letters for roots and extreme eigenvalues stand for."""
        reader = self.reader
        extremes = [reader.shapes.settle(term) for _, term, _ in reader.eigenvalues.values()]
        return [*(of for _, of in reader.roots.values()), *extremes]

    def extend(self, theory: ClaimTheory) -> ClaimTheory:
        """Return the theory with what is given."""
        reader = self.reader
        if not (self.found or reader.new or reader.roots or reader.eigenvalues or reader.sizes):
            return theory
        made = copy(theory.theory)
        letters = theory.outline.letters if theory.outline else made
        if reader.sizes:
            resize(made, reader.sizes)
        for symbol in self.reader.new.values():
            _add(made, self.reader.shapes.settled_symbol(symbol))
        for root, of in self.reader.roots.values():
            _add_root(made, root, of)
        for symbol, term, kind in reader.eigenvalues.values():
            _add_extreme(made, symbol, reader.shapes.settle(term), kind)
        new = {symbol.name for symbol in reader.new.values()}
        made.nonnegative |= {name for e in self.settled() if (name := _signed(e)) in new}
        names: list[str] = []
        conditions: list[Equation] = []
        for (_, defines), equation in zip(self.found, self.settled(), strict=True):
            for symbol in (n for t in (equation.lhs, equation.rhs) for n in walk(t) if isinstance(n, Symbol)):
                if symbol.name not in made.symbols:
                    add_indexed(made, letters, symbol.name)
            name = _fresh(plain(equation), made)
            names.append(name)
            if self._is_of_matrices(equation):
                self._declare(name, equation, defines, made)
            else:
                conditions.append(equation)
        self.names = tuple(names)
        optimal, proved = theory.optimal & made.declared.keys(), theory.proved_by
        kept = {k: v for k, v in proved.items() if k in made.declared}
        return replace(theory, theory=made, optimal=optimal, proved_by=kept,
                       conditions=(*theory.conditions, *conditions))  # fmt: skip

    def _is_of_matrices(self, equation: Equation) -> bool:
        return equation.relation in OF_MATRICES and not self.reader.scalar and not _is_number(equation)

    def _declare(self, name: str, equation: Equation, defines: bool, made: Theory) -> None:
        if defines and isinstance(equation.lhs, Symbol):
            made.define(name, equation.lhs, equation.rhs, "given")
            return
        for old in overridden(equation, made):
            del made.declared[old]
        made.assume(name, equation.lhs, equation.relation, equation.rhs, "given")


def _signed(equation: Equation) -> str:
    """Return the name of a number that is said to be not negative, or nothing."""
    match equation:
        case Equation(Symbol(scalar=True, name=name), "≥" | ">", Number(value)) if value >= 0:
            return name
        case _:
            return ""


def _is_number(equation: Equation) -> bool:
    from derive.functions import is_scalar

    return is_scalar(equation)


def _add(made: Theory, symbol: Symbol) -> None:
    made.symbols[symbol.name] = symbol
    if not symbol.scalar:
        made.constant.add(symbol.name)
        made.parameters.add(symbol.name)


def _add_root(made: Theory, root: Symbol, of: Symbol) -> None:
    """Declare the root of a matrix, positive definite if that is known to be."""
    _add(made, root)
    strict = any(
        isinstance(d, Declared) and (d.statement.lhs, d.statement.relation) == (of, "≻") for d in made.declared.values()
    )
    made.define(f"{root.name} squared", root * root, of, "the root of a positive matrix")
    made.assume(f"{root.name} positive", root, "≻" if strict else "⪰", text="the root is the positive one")
    if strict:
        made.inverse(f"{root.name} inverse", root, root.rows, symmetric=True, because=f"{root.name} positive")


def _add_extreme(made: Theory, symbol: Symbol, of: Term, kind: str) -> None:
    """Declare what an extreme eigenvalue bounds; that it is attained is known to who evaluates it."""
    made.symbols[symbol.name] = symbol
    size = Identity(_rows(of, made))
    gap = of - symbol * size if kind == "least" else symbol * size - of
    made.assume(f"{kind} eigenvalue of {plain(of)}", gap, "⪰", text="an extreme eigenvalue")


def _rows(term: Term, made: Theory) -> str:
    while not isinstance(term, Symbol):
        if isinstance(term, Transpose) and isinstance(term.body, Symbol):
            return term.body.cols
        term = next(
            t for t in term.children() if not (isinstance(t, Symbol) and t.scalar) and not isinstance(t, Number)
        )
    return term.rows


def resize(made: Theory, sizes: Mapping[str, str]) -> None:
    """Make dimensions of a theory 1."""
    for name, symbol in made.symbols.items():
        rows, cols = sizes.get(symbol.rows, symbol.rows), sizes.get(symbol.cols, symbol.cols)
        if (rows, cols) != (symbol.rows, symbol.cols):
            made.symbols[name] = replace(symbol, rows=rows, cols=cols)

    def resized(term: Term) -> Term:
        match term:
            case Symbol():
                return replace(term, rows=sizes.get(term.rows, term.rows), cols=sizes.get(term.cols, term.cols))
            case Identity(size):
                return Identity(sizes.get(size, size))
            case Zero(rows, cols):
                return Zero(sizes.get(rows, rows), sizes.get(cols, cols))
            case _:
                return rebuilt(term, resized)

    for name, item in made.declared.items():
        match item:
            case Declared(statement=e):
                made.declared[name] = replace(item, statement=Equation(resized(e.lhs), e.relation, resized(e.rhs)))
            case DeclaredFact(matrix=matrix):
                made.declared[name] = replace(item, matrix=resized(matrix))
            case DeclaredInverse(of=of):
                made.declared[name] = replace(item, of=resized(of))
            case _:
                pass


def _fresh(name: str, made: Theory) -> str:
    while name in made.declared:
        name += " (given)"
    return name


def overridden(equation: Equation, theory: Theory) -> list[str]:
    """Return the declarations that a given equation takes the place of.

    These are the definition of the same letter, moment or rate, and what was assumed of the letter's optimum. An
    equation that a letter solves (P in the Riccati equation) stays.
    """
    lhs = equation.lhs
    defines = equation.relation == "=" and isinstance(lhs, (Symbol, Dot, Expect)) and not _occurs(lhs, equation.rhs)
    if not defines:
        return []
    found = [
        name for name, item in theory.declared.items()
        if isinstance(item, Declared) and item.statement.relation in ("=", ":=") and _same(item.statement.lhs, lhs)
        and not _occurs(lhs, item.statement.rhs)
    ]  # fmt: skip
    cases = [
        name for name, item in theory.declared.items()
        if found and isinstance(lhs, Symbol) and isinstance(item, DeclaredFact) and item.case
        and any(_occurs(lhs, t) for t in terms_of(item))
    ]  # fmt: skip
    return found + cases


def _same(one: Term, two: Term) -> bool:
    if isinstance(one, Symbol) and isinstance(two, Symbol):
        return one.letter == two.letter
    return one == two


def _occurs(part: Term, whole: Term) -> bool:
    if isinstance(part, Symbol):
        return any(isinstance(n, Symbol) and n.name == part.name for n in walk(whole))
    return any(n == part for n in walk(whole))
