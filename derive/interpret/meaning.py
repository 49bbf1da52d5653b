"""From the syntax of a display to a statement: equations between typed terms, under what is assumed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache

from derive.interpret.assume import Assumptions
from derive.interpret.given import extended
from derive.interpret.names import derivatives, spell
from derive.interpret.powers import exponent_text
from derive.interpret.reader import Reader
from derive.interpret.relations import compared, relations, settled
from derive.interpret.shapes import Misfit, NotUnderstood
from derive.interpret.statement import Statement
from derive.interpret.times import time_of
from derive.latex import latex
from derive.latex import syntax as s
from derive.latex.alphabet import ACCENTS, GREEK
from derive.terms import Equation, Symbol, Term, walk
from derive.theory.claims.base import SCALAR, ClaimTheory

WORDS = frozenset(
    {*GREEK, *ACCENTS, "check", "overline", "widehat", "widetilde", "underline"}
)  # names of letters and accents


def understand(
    display: s.Display,
    theory: ClaimTheory,
    *,
    assume: Sequence[s.Display] = (),
    scalar: bool = False,
    notation: Mapping[str, str] | None = None,
) -> Statement:
    """Return what a display says in a theory.

    Args:
        display: the formula as it was read.
        theory: what its letters are read in.
        assume: relations that are given; they add to the theory's declarations, or take the place of those that define
            the same letter.
        scalar: read every dimension as 1, where factors commute.
        notation: letters that the formula uses for those of the theory, {"F": "A", "H": "C"}.

    Raises:
        NotUnderstood: a letter or a form that has no meaning in the theory, or two.
        Misfit: shapes that do not fit.
    """
    reader = Reader(theory, scalar=scalar, notation=roles(notation or {}))
    reader.moving = _moving((display, *assume), reader)
    reader.times = [t for n in s.walk(display) if isinstance(n, s.Applied) for a in n.arguments if (t := time_of(a))]
    given = Assumptions(reader)
    for relation in (r for d in assume for r in relations(d)):
        given.read(relation)
    if not scalar and theory.outline and theory.outline.sizes <= reader.sizes.keys():
        return understand(display, theory, assume=assume, scalar=True, notation=notation)
    try:
        equations = [e for relation in relations(display) for e in compared(relation, reader)]
    except Misfit as error:
        if reader.blocks:  # letters that are given as blocks stand beside others that are not
            raise NotUnderstood(str(error)) from None
        raise
    equations = [settled(e, reader) for e in equations]
    found = [(settled(e, reader), defines) for e, defines in given.found]
    letters = _letters([*equations, *(e for e, _ in found)], _within(reader)) | ({SCALAR} if scalar else set())
    claims, assumed = extended(theory.about(letters), found, reader)
    return Statement(tuple(equations), symbols_of(equations), claims, scalar, assumed)


def roles(notation: Mapping[str, str]) -> dict[str, str]:
    r"""Return a notation by the spelling of its letters, {"\hat x": "\bar x"} as {"hat x": "bar x"}."""
    return {spelling(mine): spelling(role) for mine, role in notation.items()}


@lru_cache(maxsize=256)
def spelling(letter: str) -> str:
    r"""Return how a letter is spelled that is written in LaTeX, with its backslashes or without: \hat{x} or hat{x}.

    Raises:
        NotUnderstood: it is no letter.
    """
    from derive.latex.grammar import read

    if "\\" not in letter:
        letter = re.sub(r"[A-Za-z]{2,}", lambda m: rf"\{m[0]}" if m[0] in WORDS else m[0], letter)
    match read(letter).statements:
        case (s.Name() as name,):
            return spell(name, {})
        case (s.Raised(s.Name() as name, exponent),):
            return f"{spell(name, {})}^{exponent_text(exponent)}"
        case _:
            raise NotUnderstood(f"a notation: expected a letter such as P or \\hat{{x}}_k, got {letter}")


def _within(reader: Reader) -> list[Term]:
    """Return what the letters for roots and extreme eigenvalues stand for."""
    extremes = [reader.shapes.settle(term) for _, term, _ in reader.eigenvalues.values()]
    return [*(of for _, of in reader.roots.values()), *extremes]


def _letters(equations: Sequence[Equation], within: Sequence[Term]) -> set[str]:
    """Return the names of the letters in equations and terms, and the times at which they are used as "@τ"."""
    terms = (*(side for e in equations for side in (e.lhs, e.rhs)), *within)
    found = [n for term in terms for n in walk(term) if isinstance(n, Symbol)]
    return {x for n in found for x in (n.name, n.letter, *(f"@{time}" for time in n.args))}


def _moving(displays: Sequence[s.Display], reader: Reader) -> frozenset[str]:
    """Return the names that stand for functions of time: where \\dot P or a signal occurs, P and K mean P(t) and K(t).

    In a limit of time they are steady.
    """
    names, theory = reader.theory.names, reader.theory.theory
    found = frozenset(name.removesuffix("()") for name in names if name.endswith("()") and "_" not in name)
    if found.isdisjoint("PKS"):
        return frozenset()
    nodes = [n for d in displays for n in s.walk(d)]
    if any(isinstance(n, s.Called) and n.function == "lim" for n in nodes):
        return frozenset()
    applied = {id(n.head) for n in nodes if isinstance(n, s.Applied)}
    for node in nodes:
        rate = node.body if isinstance(node, s.Differentiated) else node
        if not isinstance(rate, s.Name) or id(rate) in applied:
            continue
        spelled = spell(rate, reader.notation)
        known = names.get(spelled)
        moves = rate is not node or derivatives(rate) > 0
        signal = isinstance(known, Symbol) and known.name in theory.random | theory.uncentred
        if signal or (moves and spelled in found):
            return found
    return frozenset()


# ------------------------------------------------------------------------------------------------ showing
def symbols_of(equations: Sequence[Equation]) -> tuple[Symbol, ...]:
    """Return the letters of equations in the order of their first appearance."""
    found = (n for e in equations for side in (e.lhs, e.rhs) for n in walk(side) if isinstance(n, Symbol))
    return tuple(dict.fromkeys(found))


def echo(statement: Statement) -> str:
    """Return the statement in canonical LaTeX, as it was understood."""
    return r", \quad ".join(latex(equation) for equation in statement.equations)


def shapes(statement: Statement) -> dict[str, str]:
    """Return the shape of every letter, L: n×l."""
    return {latex(symbol): shape_of(symbol, statement.scalar) for symbol in statement.symbols}


def shape_of(symbol: Symbol, scalar: bool) -> str:
    """Return a shape as it is shown: n×l, or a number."""
    return "number" if symbol.scalar or scalar else f"{symbol.rows}×{symbol.cols}"
