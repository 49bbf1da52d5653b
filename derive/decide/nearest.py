"""The nearest true formula to a refuted one: a single edit, proved before it is suggested.

Most edits fail at a random exact instance of the theory's equations, in microseconds; the rest are proved, the smallest
first. For mistakes that are often made there is a sentence that explains them.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from derive.claim import Nearest
from derive.decide.edits import Edit, edits
from derive.decide.evaluate import NoValue, Point
from derive.decide.explain import sentence
from derive.decide.matrix import prove_statement
from derive.decide.workspace import Workspace
from derive.interpret.statement import Statement
from derive.kernel import Poly, Rejected
from derive.latex import latex
from derive.matrix.instance import Instance
from derive.matrix.refute import instances
from derive.matrix.sample import sample
from derive.terms import Dot, Equation, Expect, Gradient, Symbol, Term, Trace, Transpose, lower, walk
from derive.theory.claims.base import ClaimTheory

__all__ = ["Surroundings", "nearest", "with_equations"]

SECONDS = 4.0  # in all; the numbers below are what bounds the search
EDITS = 6000  # that are tried at random instances
TRIED = 12  # that are proved or not, after the random instances
POINTS = 2
CROSS = ("N", "S")  # without this letter in a claim the noises are uncorrelated


@dataclass(frozen=True)
class Surroundings:
    """The letters that a claim might have been written with, and exact instances at which formulas are tried."""

    statement: Statement
    letters: tuple[Symbol, ...]
    points: tuple[Point, ...]

    @classmethod
    def of(cls, statement: Statement, more: Iterable[Symbol] = ()) -> Surroundings:
        """Return the surroundings of a statement; ``more`` are letters that have to have a value."""
        letters = tuple(_letters(statement))
        everything = list(dict.fromkeys([*letters, *statement.symbols, *more]))
        theory = _theory(statement, everything)
        return cls(statement, letters, tuple(_points(theory, everything, statement.equations)))

    def holds(self, equations: Iterable[Equation]) -> bool:
        """Tell whether equations and inequalities hold at every instance."""
        return bool(self.points) and all(_holds(e, self.points) for e in equations)


def nearest(around: Surroundings, seconds: float = SECONDS) -> tuple[Nearest, str] | None:
    """Search for the nearest true formula.

    Returns:
        The formula and a sentence that explains the mistake, or "" if there is none; None if no single edit is true.
    """
    statement, deadline = around.statement, time.monotonic() + seconds
    if len(statement.equations) != 1 or not around.points:
        return None
    (equation,) = statement.equations
    tried: set[Equation] = set()
    for edit, changed in islice(_ordered(equation, around.letters), EDITS):
        if time.monotonic() > deadline or len(tried) >= TRIED:
            return None
        if changed in tried or _trivial(changed) or not around.holds((changed,)):
            continue
        tried.add(changed)
        if prove_statement(with_equations(statement, (changed,)), deadline - time.monotonic()):
            return Nearest(latex(changed), edit.text), sentence(edit, statement.theory.key)
    return None


def _ordered(equation: Equation, letters: Sequence[Symbol]) -> Iterator[tuple[Edit, Equation]]:
    """Iterate over edited equations, the smallest edit first; the side that is not a letter alone comes first."""
    found: list[tuple[int, int, Edit, Equation]] = []
    sides = ("rhs", "lhs") if _is_plain(equation.lhs) else ("lhs", "rhs")
    order, addends = equation.relation in ("⪰", "≻", "≥", ">"), _addends(letters)
    for late, side in enumerate(sides):
        for edit in edits(getattr(equation, side), letters, addends):
            if late and not _is_plain(edit.term) and _is_plain(getattr(equation, side)):
                continue  # a formula for 2 X is no formula for X
            if not (order and edit.kind in ("plus", "minus", "factor 2")):
                found.append((edit.cost + 2 * late, len(found), edit, replace(equation, **{side: edit.term})))
    for edit, changed in _other_orders(equation) if order else ():
        found.append((edit.cost, len(found), edit, changed))
    for _, _, edit, changed in sorted(found, key=lambda item: item[:2]):
        yield edit, changed


def _other_orders(equation: Equation) -> Iterator[tuple[Edit, Equation]]:
    turned = Equation(equation.rhs, equation.relation, equation.lhs)
    yield Edit(equation.lhs, ("the other way round",), 1, "order"), turned
    if equation.relation in ("≻", ">"):
        weak = replace(equation, relation={"≻": "⪰", ">": "≥"}[equation.relation])
        yield Edit(equation.lhs, ("not strict",), 0, "strict"), weak


def _is_plain(term: Term) -> bool:
    """Tell whether a side is a letter, its transpose, derivative or trace, an expectation or a gradient."""
    if isinstance(term, (Transpose, Dot, Trace)):
        return _is_plain(term.body)
    return isinstance(term, (Symbol, Expect, Gradient))


def _trivial(changed: Equation) -> bool:
    """Tell whether an edit says nothing: both sides are alike."""
    return changed.lhs == changed.rhs


# ------------------------------------------------------------------------------------------------ what may be put in
def _letters(statement: Statement) -> list[Symbol]:
    """Return the matrices that people write in this theory, signals left out unless the claim has some."""
    theory = statement.theory.theory
    own = [s for s in statement.symbols if not s.scalar]
    named = [t for t in statement.theory.names.values() if isinstance(t, Symbol) and not t.scalar]
    random = theory.random | theory.uncentred
    signals = any(s.name in random for s in own)
    indexed = [n for s in own for n in _siblings(s, statement.theory)]
    usual = [s for s in named if not s.name.endswith("#") and (signals or s.cols != "1") and "@" not in s.letter]
    known = [s for s in [*own, *indexed, *usual] if signals or s.name not in random]
    moving = any(s.args for s in own)
    unreal = statement.theory.theory.complex
    kept = [s for s in known if s in own or (not (s.args and not moving) and s.name not in unreal.union(CROSS))]
    return list({s.letter: s for s in kept if s.rows and s.cols}.values())


def _siblings(symbol: Symbol, theory: ClaimTheory) -> list[Symbol]:
    """Return the letters with the same index, and the same letter at indices that the theory uses."""
    from derive.theory.claims.base import split_index

    stem, index = split_index(symbol.name)
    if not index:
        return []
    return [
        s for name, s in theory.theory.symbols.items() if split_index(name)[1] == index or split_index(name)[0] == stem
    ]


def _addends(letters: Sequence[Symbol]) -> list[Term]:
    """Return what a sum may lack: a letter, or a letter between another and its transpose, such as L V L'."""
    around = [x * h * x.T for h in letters if h.symmetric for x in letters if x.cols == h.rows and x.letter != h.letter]
    return [*letters, *around]


# ------------------------------------------------------------------------------------------------ instances
def _theory(statement: Statement, letters: Sequence[Symbol]) -> ClaimTheory:
    """Return what may be used when the claim has other letters; assumptions stay as they are."""
    about = statement.theory.about({s.name for s in letters})
    introduced = any(s.name not in about.theory.symbols for s in statement.symbols)
    return statement.theory if statement.assumed or introduced else about


def with_equations(statement: Statement, equations: tuple[Equation, ...]) -> Statement:
    """Return a statement of other equations, read in what bears on their letters."""
    sides = [side for e in equations for side in (e.lhs, e.rhs)]
    symbols = tuple(dict.fromkeys(n for t in sides for n in walk(t) if isinstance(n, Symbol)))
    return replace(statement, equations=equations, symbols=symbols, theory=_theory(statement, symbols))


def _points(theory: ClaimTheory, letters: Sequence[Symbol], equations: tuple[Equation, ...]) -> list[Point]:
    """Return instances at which edits are tried: of the equations, or of everything for an inequality."""
    work = Workspace(theory, time.monotonic() + SECONDS, equations)
    problem = work.problem()
    if problem is None:
        return []
    known = problem.alphabet.letters
    polys = [Poly({((), (s.letter,)): 1}, s.rows, s.cols) for s in letters if s.name in known and not s.scalar]
    scalars = sorted({s.name for s in letters if s.scalar})
    polys += [Poly({((s,), ()): 1}, "", "") for s in scalars]
    nodes = [n for e in equations for side in (e.lhs, e.rhs) for n in walk(side)]
    for node in (n for n in nodes if isinstance(n, (Dot, Expect))):
        try:
            polys += [p for row in lower(node, work.reading) for p in row]
        except Rejected:
            continue
    plain, order = replace(problem, facts={}), any(e.relation not in ("=", ":=") for e in equations)
    found: list[Instance] = (
        instances(problem, polys, POINTS, seconds=SECONDS) if order else sample(plain, polys, POINTS)
    )
    return [Point(i, work) for i in found]


def _holds(equation: Equation, points: Sequence[Point]) -> bool:
    """Tell whether an edited equation holds at every instance."""
    from derive.matrix.exact import positive_definite, positive_semidefinite

    for point in points:
        try:
            left, right = (point.value(side) for side in (equation.lhs, equation.rhs))
            if equation.relation == "=":
                good = left == right
            elif equation.relation in ("⪰", "≻"):
                good = (positive_definite if equation.relation == "≻" else positive_semidefinite)(left - right)
            else:
                good = left > right or (equation.relation == "≥" and left == right)
        except (NoValue, TypeError, AttributeError):
            return False
        if not good:
            return False
    return True
