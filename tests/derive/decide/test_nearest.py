"""A refuted formula comes with the nearest true one, and with the convention in which it holds; both proved."""

from __future__ import annotations

import pytest

from derive.claim import Verdict
from derive.decide import decide
from derive.decide.edits import edits, shape_of, tidy
from derive.decide.misfit import nearest_fitting
from derive.interpret import Misfit, understand
from derive.latex.grammar import read
from derive.terms import Identity, Neg, Product, Sum, Symbol
from derive.theory.claims import claim_theory
from tests.derive.decide.reading import DT, KB, answer, statement

S = r"(C P C^\top + R)^{-1}"
NEAREST = [
    (rf"L = P C^\top {S}", DT, rf"L = A P C^\top {S}", "with A in front of P", "A stands in front"),
    (r"L = A P C^\top (C P C^\top - R)^{-1}", DT, rf"L = A P C^\top {S}", "the other sign of R", ""),
    (r"K = P C^\top", KB, r"K = P C^\top V^{-1}", "with V^-1 after C'", "inverse intensity"),
    (r"K = P C^\top V", KB, r"K = P C^\top V^{-1}", "V^-1 for V", "inverse intensity"),
    (r"K = 2 P C^\top V^{-1}", KB, r"K = P C^\top V^{-1}", "half the factor", "factor 2"),
    (r"K = -P C^\top V^{-1}", KB, r"K = P C^\top V^{-1}", "the other sign of P C' V^-1", ""),
    (
        r"A P + P A^\top + W + P C^\top V^{-1} C P = 0",
        KB,
        r"A P + P A^\top + W - P C^\top V^{-1} C P = 0",
        "the other sign of P C' V^-1 C P",
        "minus sign",
    ),
    (
        r"P_k = (A - L_k C) P_{k-1} (A - L_k C)^\top + Q",
        DT,
        r"P_k = (A - L_k C) P_{k-1} (A - L_k C)^\top + Q + L_k R L_k^\top",
        "with the addend L_k R L_k'",
        "feeds measurement noise",
    ),
    (
        r"P = (A + L C) P (A + L C)^\top + Q + L R L^\top",
        DT,
        r"P = (A - L C) P (A - L C)^\top + Q + L R L^\top",
        "the other sign of L C everywhere",
        "error matrix",
    ),
    (
        r"L_k = A P_k C^\top (C P_k C^\top + R)^{-1}",
        DT,
        r"L_k = A P_{k-1} C^\top (C P_{k-1} C^\top + R)^{-1}",
        "P_{k-1} for P_k everywhere",
        "",
    ),
    (r"P \succ 0", DT, r"P \succeq 0", "not strict", "Equality"),
    (r"Q \succeq P", DT, r"P \succeq Q", "the other way round", "other way"),
    (
        r"\mathbb{E}[e_k v_{k-1}^\top] = -L_k R",
        DT,
        r"\mathbb{E}[e_k v_{k-1}^\top] = L_k R",
        "the other sign of L_k R",
        "",
    ),
]


@pytest.mark.parametrize(("false", "theory", "true", "edit", "why"), NEAREST, ids=[n[0] for n in NEAREST])
def test_the_nearest_true_formula(false, theory, true, edit, why):
    found = decide(statement(false, theory))
    assert found.verdict is Verdict.refuted
    assert (found.nearest.latex, found.nearest.edit) == (true, edit)
    assert any(why in note for note in found.notes) or not why
    assert decide(understand(read(found.nearest.latex), claim_theory(theory))).verdict is Verdict.proved


CONVENTIONS = [
    (rf"L = P C^T {S}", DT, "true for the filter gain L_f, not the predictor gain L"),
    (rf"L_f = A P C^T {S}", DT, "true for the predictor gain L, not the filter gain L_f"),
    (r"A^T P + P A + W - P C^T V^{-1} C P = 0", KB, "true for the control Riccati equation"),
    (r"A S + S A^T + Q - S B R^{-1} B^T S = 0", "lqr-ct", "true for the filter's Riccati equation"),
    (r"e_k = x_k - \hat x_k", DT, "true for the error e = x - xhat, of the other sign"),
    (r"e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} + w_{k-1}", DT, "true for process noise of the other sign"),
    (r"L_f = P C^T R^{-1}", DT, "true for the covariance P+ of the filtered estimate"),
]


@pytest.mark.parametrize(("latex", "theory", "said"), CONVENTIONS)
def test_the_convention_in_which_it_holds(latex, theory, said):
    assert any(note.startswith(said) for note in decide(statement(latex, theory)).notes)


@pytest.mark.parametrize(("latex", "theory"), [(r"P A = A P", DT), (r"P_k = P", DT), (r"C K = 0", KB)])
def test_where_no_edit_is_true_none_is_suggested(latex, theory):
    found = decide(statement(latex, theory))
    assert (found.verdict, found.nearest) == (Verdict.refuted, None)
    assert not any(note.startswith("true for") for note in found.notes)


def test_nothing_is_suggested_for_what_is_true():
    found = decide(statement(rf"L = A P C^T {S}"))
    assert (found.verdict, found.nearest, found.notes) == (Verdict.proved, None, ())


def test_the_search_can_be_left_out():
    assert answer(rf"L = P C^T {S}").nearest is None


# ------------------------------------------------------------------------------------------------ edits
def test_edits_keep_the_shape_and_change_the_term():
    A, B, x = Symbol("A", "n", "n"), Symbol("B", "n", "m"), Symbol("x", "m", "1")
    term = Sum((Product((A, B, x)), Neg(Product((B, x)))))
    found = list(edits(term, (A, B, x), (A, Product((B, x)))))
    assert {e.kind for e in found} >= {"factor", "drop", "minus", "plus", "inverse", "transpose", "factor 2"}
    assert all(shape_of(e.term) == ("n", "1") and e.term != term for e in found)
    assert all(e.text for e in found)


def test_what_cancels_is_left_out():
    A = Symbol("A", "n", "n")
    assert tidy(A.T.T) == tidy(Neg(Neg(A))) == tidy(A.inv.inv) == A
    assert tidy(Product((A, Product((A, Identity("n")))))) == Product((A, A, Identity("n")))
    assert shape_of(Product((A, Symbol("B", "m", "n")))) is None


# ------------------------------------------------------------------------------------------------ shapes
FITTING = [
    (r"L = A P C (C P C^\top + R)^{-1}", DT, rf"L = A P C^\top {S}", "C' for C"),
    (r"A P + P A^\top + W - P C V^{-1} C P = 0", KB, r"A P + P A^\top + W - P C^\top V^{-1} C P = 0", "C' for C"),
    (r"K = C^\top P V^{-1}", KB, r"K = P C^\top V^{-1}", "C' and P swapped"),
    (r"L_f = P C^\top (C^\top P C + R)^{-1}", DT, rf"L_f = P C^\top {S}", "the two transposes of C' P C exchanged"),
    (r"L^\top = A P C^\top (C P C^\top + R)^{-1}", DT, rf"L = A P C^\top {S}", "L for L'"),
]


@pytest.mark.parametrize(("latex", "theory", "true", "edit"), FITTING)
def test_what_fits_instead(latex, theory, true, edit):
    with pytest.raises(Misfit):
        statement(latex, theory)
    nearest, why = nearest_fitting(read(latex), claim_theory(theory))
    assert (nearest.latex, nearest.edit) == (true, edit)
    assert ("C leads from the state" in why) == (edit == "C' for C")


def test_a_formula_that_fits_and_is_false_is_not_suggested():
    assert nearest_fitting(read(r"K = P C V"), claim_theory(KB)) is None
