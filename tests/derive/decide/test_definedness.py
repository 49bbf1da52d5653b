"""Inverses exist for a reason; where there is none, the claim is refuted with the instance where they do not."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from derive.claim import Verdict
from derive.decide.ground import Introduced, Lemma, accept, generic
from derive.decide.obligations import invert
from derive.decide.workspace import Workspace, proof_reading
from derive.kernel import Poly, Rejected, identity
from derive.rules import Fact, Positivity, Square
from tests.derive.decide.reading import DT, KB, answer, statement

UNDEFINED = [
    (r"P^{-1} P = I", DT, ()),
    (r"A^{-1} A = I", DT, ()),
    (r"(A - L C)^{-1} (A - L C) = I", DT, ()),
    (r"L = A P C^T (C P C^T - R)^{-1}", DT, ()),
    (r"(C P C^T)^{-1} = (C P C^T)^{-1}", DT, (r"P \succ 0",)),
    (r"(A P)^{-1} = P^{-1} A^{-1}", DT, (r"P \succ 0",)),
    (r"(P - Q)^{-1} = (P - Q)^{-1}", DT, ()),
    (r"A^{-1} (s I - A)^{-1} = (s I - A)^{-1} A^{-1}", KB, ()),
]


@pytest.mark.parametrize(("latex", "theory", "assume"), UNDEFINED)
def test_an_inverse_that_need_not_exist(latex, theory, assume):
    found = answer(latex, theory, assume)
    assert (found.verdict, found.method) == (Verdict.refuted, "undefined")
    assert "does not exist there" in found.notes[0]
    assert found.counterexample.relation == "invertible"


DEFINED = [
    (r"(P^{-1})^{-1} = P", DT, (r"P \succ 0",)),
    (r"(2 R)^{-1} = \frac{1}{2} R^{-1}", DT, ()),
    (r"(-R)^{-1} = -R^{-1}", DT, ()),
    (r"(P_{k-1} Q)^{-1} = Q^{-1} P_{k-1}^{-1}", DT, (r"P_{k-1} \succ 0", r"Q \succ 0")),
    (r"(P^T)^{-1} = P^{-1}", DT, (r"P \succ 0",)),
    (r"(A P A^T + I)^{-1} (I + A P A^T) = I", DT, ()),
    (r"(I + R^{-1} C P C^T)^{-1} = (C P C^T + R)^{-1} R", DT, ()),
    (r"(I + P C^T R^{-1} C)^{-1} = I - L_f C", DT, ()),
    (r"(P - P C^T (C P C^T + R)^{-1} C P)^{-1} = P^{-1} + C^T R^{-1} C", DT, (r"P \succ 0",)),
    (r"(A - s I)^{-1} = -(s I - A)^{-1}", KB, ()),
    (r"\Phi_y(s)^{-1} \Phi_y(s) = I", KB, ()),
    (r"(I + C (s I - A)^{-1} K)^{-1} (I + C (s I - A)^{-1} K) = I", KB, ()),
]


@pytest.mark.parametrize(("latex", "theory", "assume"), DEFINED)
def test_an_inverse_with_its_reason(latex, theory, assume):
    assert answer(latex, theory, assume).verdict is Verdict.proved


def test_without_reason_and_without_singular_instance_nothing_is_proved():
    found = answer(r"(I + P Q)^{-1} P = P (I + Q P)^{-1}")
    assert found.verdict is Verdict.undecided
    assert "no reason was found" in found.notes[0]


def test_what_fails_where_it_is_defined_is_refuted():
    assert answer(r"(I + P Q)^{-1} P = P (I + P Q)^{-1} Q").verdict is Verdict.refuted


# ------------------------------------------------------------------------------------------------ what is accepted
def letter(name: str, rows: str = "n", cols: str = "n") -> Poly:
    return Poly({((), (name,)): 1}, rows, cols)


@pytest.fixture
def theory():
    return statement(r"L = A P C^T (C P C^T + R)^{-1}").theory


def rejected(item, theory) -> str:
    with pytest.raises(Rejected) as error:
        accept([item], proof_reading(theory), theory.theory)
    return str(error.value)


def test_no_inverse_without_a_reason(theory):
    assert "one reason" in rejected(Introduced("X", letter("P")), theory)
    assert "no fact" in rejected(Introduced("X", letter("P"), because="P >= 0"), theory)
    assert "another matrix" in rejected(Introduced("X", letter("P"), because="In"), theory)
    assert "no fact" in rejected(Introduced("X", letter("P"), because="nothing"), theory)
    assert "not known to be invertible" in rejected(Introduced("X", letter("A"), generic="z"), theory)
    assert "remain" in rejected(Introduced("X", letter("A"), by=letter("A")), theory)
    assert "one reason" in rejected(Introduced("X", letter("R", "l", "l"), because="R > 0", generic="z"), theory)


def test_no_letter_twice(theory):
    of = letter("R", "l", "l")
    assert "taken" in rejected(Introduced("P", of, because="R > 0"), theory)
    assert "has this name" in rejected(Introduced("steady gain", of, because="R > 0"), theory)
    assert "not square" in rejected(Introduced("X", letter("C", "l", "n"), because="R > 0"), theory)


def test_no_lemma_without_its_certificate(theory):
    grid = ((letter("P"),),)
    square = Square(Fraction(1), (), ((identity("n"),),), "P >= 0")
    proof = Positivity(grid, (square,), (((),),))
    assert accept([Lemma("fine", "psd", grid, proof)], proof_reading(theory), theory.theory)
    assert "not what the certificate shows" in rejected(Lemma("fine", "pd", grid, proof), theory)
    assert "one certificate" in rejected(Lemma("fine", "psd", grid), theory)
    assert "name is taken" in rejected(Lemma("In", "psd", grid, proof), theory)
    assert "another claim" in rejected(Lemma("fine", "psd", ((letter("Q"),),), proof), theory)
    negative = replace(proof, squares=(replace(square, coefficient=Fraction(-1)),))
    assert "may be negative" in rejected(
        Lemma("fine", "psd", ((-letter("P"),),), replace(negative, claim=((-letter("P"),),))), theory
    )


def test_generic_points():
    """s I - A is invertible but at the eigenvalues of A; A (s I - A)^-1 need not be anywhere."""
    work = Workspace(statement(r"\Phi_y(s) = V", KB).theory, float("inf"))
    context, inverses = work.reading.context, work.reading.inverses
    one, A = identity("m"), letter("A", "m", "m")
    F = Poly({((), ("(sI-A)^-1",)): 1}, "m", "m")
    for matrix in (one.scale(1, ("s",)) - A, one.scale(3, ("s", "s")) + A.scale(1, ("s",)), one + A * F):
        assert generic(matrix, "s", context, inverses)
    for matrix in (A.scale(1, ("s",)), A * F, F, A + F, letter("Phi_y(s)", "l", "l"), Poly({}, "m", "m")):
        assert not generic(matrix, "s", context, inverses)
    known = replace(context, facts={**context.facts, "F": Fact("invertible", ((F,),))})
    assert not generic(F + F * F, "s", known, inverses)
    assert not generic(one.scale(1, ("s",)) - A, "z", context, inverses)
    context = replace(context, relations={**context.relations, "s = 1": one.scale(1, ("s",)) - one})
    assert not generic(one.scale(1, ("s",)) - A, "s", context, inverses)


def test_a_letter_for_an_inverse_is_found_once():
    work = Workspace(statement(r"L = A P C^T (C P C^T + R)^{-1}").theory, float("inf"))
    first = invert(letter("R", "l", "l").scale(2), work)
    assert invert(letter("R", "l", "l").scale(2), work) == first
    assert sum(isinstance(item, Introduced) for item in work.items) == 1
