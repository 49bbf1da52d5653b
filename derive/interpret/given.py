"""A theory extended by what is given for one statement: new letters, further hypotheses, other definitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from derive.analysis import is_scalar
from derive.context import Declared, DeclaredFact, DeclaredInverse, Theory, terms_of
from derive.interpret.shapes import NotUnderstood, rebuilt
from derive.kernel import Rejected
from derive.latex import plain
from derive.terms import Dot, Equation, Expect, Identity, Number, Symbol, Term, Transpose, Zero, walk
from derive.theory.claims.base import ClaimTheory, add_indexed, copy

if TYPE_CHECKING:
    from derive.interpret.reader import Reader

OF_MATRICES = ("=", "⪰", "≻")
Given = Sequence[tuple[Equation, bool]]  # and whether it defines a new letter


def extended(theory: ClaimTheory, given: Given, reader: Reader) -> tuple[ClaimTheory, tuple[str, ...]]:
    """Return a theory with what is given, and the names of that in order; all dimensions are found by now.

    Raises:
        NotUnderstood: something is given that no rule reads.
    """
    if not (given or reader.new or reader.roots or reader.eigenvalues or reader.sizes):
        return theory, ()
    made = copy(theory.theory)
    if reader.sizes:
        resize(made, reader.sizes)
    _introduce(made, given, reader)
    names: list[str] = []
    conditions: list[Equation] = []
    for equation, defines in given:
        _add_letters(made, theory, equation)
        names.append(_fresh(plain(equation), made))
        if reader.scalar or equation.relation not in OF_MATRICES or is_scalar(equation):
            conditions.append(equation)
        else:
            _declare(names[-1], equation, defines, made, theory.optimal)
    kept = {k: v for k, v in theory.proved_by.items() if k in made.declared}
    optimal, found = theory.optimal & made.declared.keys(), (*theory.conditions, *conditions)
    claims = replace(theory, theory=made, optimal=optimal, proved_by=kept, conditions=found)
    try:
        _ = claims.reading
    except Rejected as error:
        raise NotUnderstood(f"an assumption that no rule reads: {error}") from None
    return claims, tuple(names)


def _introduce(made: Theory, given: Given, reader: Reader) -> None:
    """Declare new letters, roots and extreme eigenvalues."""
    for symbol in reader.new.values():
        _add(made, reader.shapes.settled_symbol(symbol))
    for root, of in reader.roots.values():
        _add_root(made, root, of)
    for symbol, term, kind in reader.eigenvalues.values():
        _add_extreme(made, symbol, reader.shapes.settle(term), kind)
    new = {symbol.name for symbol in reader.new.values()}
    made.nonnegative |= {name for e, _ in given if (name := _signed(e)) in new}


def _add_letters(made: Theory, theory: ClaimTheory, equation: Equation) -> None:
    """Declare letters with an index that only what is given mentions."""
    letters = theory.outline.letters if theory.outline else made
    for symbol in (n for t in (equation.lhs, equation.rhs) for n in walk(t) if isinstance(n, Symbol)):
        if symbol.name not in made.symbols:
            add_indexed(made, letters, symbol.name)


def _declare(name: str, equation: Equation, defines: bool, made: Theory, optimal: frozenset[str]) -> None:
    if defines:
        made.define(name, equation.lhs, equation.rhs, "given")
        return
    for old in overridden(equation, made, optimal):
        del made.declared[old]
    made.assume(name, equation.lhs, equation.relation, equation.rhs, "given")


def _signed(equation: Equation) -> str:
    """Return the name of a number that is said to be not negative, or nothing."""
    match equation:
        case Equation(Symbol(scalar=True, name=name), "≥" | ">", Number(value)) if value >= 0:
            return name
        case _:
            return ""


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


def overridden(equation: Equation, theory: Theory, optimal: frozenset[str]) -> list[str]:
    """Return the declarations that a given equation takes the place of.

    These are the definition of the same letter, moment or rate; of a gain, also what was said of its optimum. An
    equation that a letter solves (P in the Riccati equation) stays, and so does what defines a letter that is given a
    value without letters: W = 0 is a special case, L = 0 another gain.
    """
    lhs, names = equation.lhs, [n for n in walk(equation.rhs) if isinstance(n, Symbol)]
    if equation.relation != "=" or not isinstance(lhs, (Symbol, Dot, Expect)) or occurs(lhs, equation.rhs):
        return []
    found = [
        name for name, item in theory.declared.items()
        if isinstance(item, Declared) and item.statement.relation in ("=", ":=") and _same(item.statement.lhs, lhs)
        and not occurs(lhs, item.statement.rhs) and (names or name in optimal)
    ]  # fmt: skip
    cases = [
        name for name, item in theory.declared.items()
        if found and isinstance(lhs, Symbol) and isinstance(item, DeclaredFact) and item.case
        and any(occurs(lhs, t) for t in terms_of(item))
    ]  # fmt: skip
    return found + cases


def _same(one: Term, two: Term) -> bool:
    if isinstance(one, Symbol) and isinstance(two, Symbol):
        return one.letter == two.letter
    return one == two


def occurs(part: Term, whole: Term) -> bool:
    """Tell whether a term is part of another; a letter is, at whatever time."""
    if isinstance(part, Symbol):
        return any(isinstance(n, Symbol) and n.name == part.name for n in walk(whole))
    return any(n == part for n in walk(whole))
