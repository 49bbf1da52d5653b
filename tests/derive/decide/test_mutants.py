"""False variants of true formulas are never proved: one edit each, shown false at exact instances first."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import cache

import pytest

from derive.claim import Verdict
from derive.decide.edits import edits, shape_of
from derive.decide.evaluate import NoValue, Point
from derive.decide.matrix import decide_matrix
from derive.decide.nearest import with_equations
from derive.decide.workspace import Workspace
from derive.interpret import Statement
from derive.kernel import Poly
from derive.matrix.exact import positive_definite, positive_semidefinite
from derive.matrix.refute import instances
from derive.terms import Dot, Equation, Expect, Gradient, Symbol, walk
from tests.derive.decide.formulas import ORDER, SOURCES, TEXTBOOK
from tests.derive.decide.reading import statement
from tests.derive.theory.mutants import mutants

EACH = 12
LEAST = 300
FORMULAS = SOURCES + TEXTBOOK + ORDER


def holds(equation: Equation, point: Point) -> bool:
    left, right = point.value(equation.lhs), point.value(equation.rhs)
    match equation.relation:
        case "⪰":
            return positive_semidefinite(left - right)
        case "≻":
            return positive_definite(left - right)
        case "≥":
            return left >= right
        case _:
            return left == right


def points(found: Statement) -> list[Point]:
    """Return exact instances of all hypotheses, evaluated without the prover."""
    work = Workspace(found.theory, float("inf"))
    problem = work.problem()
    letters = [s for s in found.symbols if not s.scalar]
    polys = [Poly({((), (s.letter,)): 1}, s.rows, s.cols) for s in letters]
    polys += [Poly({((s.name,), ()): 1}, "", "") for s in found.symbols if s.scalar]
    return [Point(i, work) for i in instances(problem, polys, 3, seconds=2.0)]


def is_false(found: Statement) -> bool:
    """Tell whether a statement fails at an instance where both sides have a value."""
    (equation,) = found.equations
    for point in points(found):
        try:
            if not holds(equation, point):
                return True
        except NoValue:
            continue
    return False


@cache
def false_variants() -> list[Statement]:
    generator, found = random.Random(7), list[Statement]()
    for latex, theory, assume in FORMULAS:
        true = statement(latex, theory, assume)
        (equation,) = true.equations
        if any(isinstance(n, (Dot, Expect, Gradient)) for side in (equation.lhs, equation.rhs) for n in walk(side)):
            continue
        sides = ("lhs", "rhs") if not isinstance(equation.lhs, Symbol) else ("rhs",)
        letters = [s for s in true.symbols if not s.scalar]
        terms = [(s, m) for s in sides for m in mutants(getattr(equation, s))]
        terms += [(s, e.term) for s in sides for e in edits(getattr(equation, s), letters, letters)]
        variants = [replace(equation, **{side: term}) for side, term in terms]
        variants = [v for v in variants if shape_of(v.lhs) and shape_of(v.lhs) == shape_of(equation.lhs)]
        variants = [v for v in variants if not any(shape_of(n) is None for n in (*walk(v.lhs), *walk(v.rhs)))]
        for variant in generator.sample(variants, min(EACH, len(variants))):
            changed = with_equations(true, (variant,))
            if is_false(changed):
                found.append(changed)
    return found


def test_there_are_many():
    assert len(false_variants()) >= LEAST


@pytest.mark.parametrize("part", range(4))
def test_no_false_variant_is_proved(part):
    chosen = false_variants()[part::4]
    verdicts = [decide_matrix(found).verdict for found in chosen]
    assert Verdict.proved not in verdicts
    assert verdicts.count(Verdict.refuted) >= 0.97 * len(verdicts)
