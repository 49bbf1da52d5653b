"""Rich display: formulas as LaTeX and SymPy, a lecture as its notes, and no verdict without a replay."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
import sympy

import derive
from derive.derivation import Derived
from derive.errors import InputError
from derive.terms import Equation, Glyph, Symbol

A, B = (Symbol(name, "n", "n", Glyph(name)) for name in "AB")


def numbers(expression):
    """Return a matrix expression with positive definite matrices of order 2 in place of its symbols."""
    rng = np.random.default_rng(0)
    sizes = {sympy.Symbol(name, integer=True, positive=True): 2 for name in ("n", "l")}
    sized = expression.subs(sizes)
    roots = {
        s: sympy.Matrix(2, 2, rng.integers(-4, 5, 4).tolist()) for s in sorted(sized.atoms(sympy.MatrixSymbol), key=str)
    }
    return sized.subs({s: root * root.T + sympy.eye(2) for s, root in roots.items()}).doit().as_explicit()


def test_a_term_and_an_equation():
    assert str(A * B.T) == "A B'"
    assert (A * B).latex() == "A B"
    assert Equation(A, "=", B)._repr_latex_() == r"$\displaystyle A = B$"
    assert (A * B)._repr_html_().startswith('<math display="block">')
    assert (A * B).sympy == sympy.MatrixSymbol("A", *A.sympy.shape) * sympy.MatrixSymbol("B", *A.sympy.shape)


@pytest.mark.parametrize("name", ["inverse from the right", "reduction", "reduced gain"])
def test_what_the_kernel_proved_holds_in_numbers_and_its_change_does_not(name):
    equation = derive.luenberger.lecture().step(name).sympy
    assert numbers(equation.lhs - equation.rhs) == sympy.zeros(2)
    assert numbers(equation.lhs - 2 * equation.rhs) != sympy.zeros(2)


def test_a_step_shows_its_statement_and_reason_but_no_verdict():
    step = derive.luenberger.gain()
    shown = step._repr_html_()
    assert step.latex() in step._repr_latex_()
    assert isinstance(step.sympy, sympy.Eq)
    assert shown.startswith('<math display="block">')
    assert "proved" not in shown
    nasty = replace(step, reason=("<script>",))._repr_html_()
    assert "<script>" not in nasty


def test_an_inequality_has_latex_but_no_sympy():
    step = next(s for s in derive.observer.lecture().steps if s.statement.relation == "⪰")
    assert r"\succeq" in step.latex()
    with pytest.raises(InputError, match="expected an equation"):
        _ = step.sympy


def test_a_chain_shows_each_link_once():
    chain = next(i for i in derive.observer.lecture().items if isinstance(i, Derived) and len(i.steps) > 2)
    assert chain._repr_html_().count("<math display") == len(chain.steps) - 1
    assert chain.latex().count(r"\\") == len(chain.steps) - 1


def test_a_lecture_shows_its_notes_with_the_verdicts_of_a_replay():
    lecture = derive.observer.lecture()
    frame = lecture._repr_html_()
    page = unescape(re.fullmatch(r'<iframe srcdoc="([^"]*)".*</iframe>', frame)[1])
    assert page.startswith("<!DOCTYPE html>")
    assert f"{len(lecture.steps)} of {len(lecture.steps)} steps proved and replayed" in page
    assert all(isinstance(e, sympy.Eq) for e in lecture.sympy)
    assert "not proved" not in page
    chain = next(i for i in lecture.items if isinstance(i, Derived))
    wrong = replace(
        chain.steps[0], statement=Equation(chain.steps[0].statement.lhs, "=", -chain.steps[0].statement.rhs)
    )
    changed = Derived((wrong, *chain.steps[1:]))
    items = tuple(changed if item is chain else item for item in lecture.items)
    assert "not proved" in replace(lecture, items=items)._repr_html_()
