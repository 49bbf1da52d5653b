"""The kernel accepts what its certificates say and rejects every change to them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from derive.kernel import (
    ANY,
    Alphabet,
    Certificate,
    Letter,
    Poly,
    Rejected,
    Term,
    at_time,
    identity,
    parts,
    replay,
    sample,
    times,
)

LETTERS = Alphabet(
    {
        "A": Letter("A", "n", "n"),
        "B": Letter("B", "n", "n"),
        "C": Letter("C", "m", "n"),
        "P": Letter("P", "n", "n", symmetric=True),
        "Phi": Letter("Phi", "n", "n"),
        "T": Letter("T", "n", "n"),
        "I": Letter("I", "n", "n"),
    },
    frozenset({"s", "z", "zi"}),
)


def poly(rows, cols, *terms):
    """Build a polynomial from (coefficient, letters, scalars)."""
    return Poly({(tuple(s.split()), tuple(w.split())): c for c, w, s in terms}, rows, cols)


def square(*terms):
    return poly("n", "n", *((c, w, "") for c, w in terms))


def term(relation, left="", right="", coefficient=1, scalars="", transposed=False):
    return Term(
        Fraction(coefficient), tuple(scalars.split()), tuple(left.split()), relation, transposed, tuple(right.split())
    )


# A B = I, and P = A P A' read from left to right
RELATIONS = {
    "inverse": square((1, "A B"), (-1, "")),
    "stein": square((1, "A P A'"), (-1, "P")),
    "ct": poly("m", "n", (1, "C A", ""), (-1, "C", "")),
    "circle": poly(ANY, ANY, (1, "", "z zi"), (-1, "", "")),
    "scaled": poly("n", "n", (1, "A", "s"), (-1, "B", "")),
}
CLAIM = square((2, "A A B P"), (-2, "A P"), (1, "P A P A'"), (-1, "P P"))
PROOF = (term("inverse", "A", "P", 2), term("stein", "P"))


def accepts(claim, *terms, trace=False, relations=RELATIONS):
    replay(Certificate(claim, terms, trace), claim, relations, LETTERS)


def rejects(match, claim, *terms, trace=False, relations=RELATIONS):
    with pytest.raises(Rejected, match=match):
        accepts(claim, *terms, trace=trace, relations=relations)


def test_a_combination_of_relations_is_accepted():
    accepts(CLAIM, *PROOF)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"coefficient": Fraction(3)}, "do not make up the claim"),
        ({"left": ("B",)}, "do not make up the claim"),
        ({"left": ("P",), "right": ("A",)}, "do not make up the claim"),
        ({"left": ("C",)}, "ill-typed cofactors of inverse: m x n"),
        ({"left": ("C'",)}, "cannot multiply"),
        ({"left": ("A", "C")}, "ill-typed product A C"),
        ({"left": ("A''",)}, "unknown letter A''"),
        ({"left": ("X",)}, "unknown letter X"),
        ({"relation": "identity"}, "undeclared relation identity"),
        ({"relation": "stein"}, "do not make up the claim"),
        ({"transposed": True}, "do not make up the claim"),
        ({"scalars": ("s",)}, "do not make up the claim"),
        ({"scalars": ("q",)}, "ill-typed term"),
    ],
)
def test_a_changed_addend_is_rejected(change, match):
    rejects(match, CLAIM, replace(PROOF[0], **change), PROOF[1])


def test_a_missing_or_surplus_addend_is_rejected():
    rejects("2 terms remain", CLAIM, PROOF[0])
    rejects("2 terms remain", CLAIM, *PROOF, PROOF[1])


def test_a_certificate_proves_its_own_claim_only():
    with pytest.raises(Rejected, match="another claim"):
        replay(Certificate(CLAIM, PROOF), CLAIM.scale(2), RELATIONS, LETTERS)


def test_transposed_relation():
    accepts(square((1, "B' A'"), (-1, "")), term("inverse", transposed=True))
    rejects("remain", square((1, "B' A'"), (-1, "")), term("inverse"))


@pytest.mark.parametrize(
    "claim",
    [
        square((1, "A C'")),
        square((1, "X")),
        square((1, "C")),
        poly("n", "n", (1, "A", "q")),
        poly("n", "m", (1, "", "")),
        poly("n", "n", (1, "A", "zi z")),
        poly("n", "n", (1, "A", "∫t")),
    ],
)
def test_an_ill_typed_claim_is_rejected(claim):
    rejects("ill-typed|unknown letter|bound twice", claim)


# ------------------------------------------------------------------------------------------------ central scalars
def test_central_relation_fits_anywhere():
    claim = poly("n", "n", (1, "A P", "s z zi"), (-1, "A P", "s"))
    for left, right in (("", "A P"), ("A", "P"), ("A P", "")):
        accepts(claim, term("circle", left, right, scalars="s"))
    accepts(poly("m", "m", (1, "", "z zi"), (-1, "", "")), term("circle"))


def test_central_relation_holds_no_letters():
    relations = {"bad": poly(ANY, ANY, (1, "A", ""), (-1, "", "")), "half": poly(ANY, "n", (1, "", ""))}
    rejects("contains letters", square((1, "A"), (-1, "")), term("bad"), relations=relations)
    rejects("contains letters", square((1, "")), term("half"), relations=relations)


def test_scalars_commute_and_letters_do_not():
    accepts(poly("n", "n", (1, "A B", "s"), (-1, "B B", "")), term("scaled", "", "B"))
    rejects("remain", poly("n", "n", (1, "B A", "s"), (-1, "B B", "")), term("scaled", "", "B"))


# ------------------------------------------------------------------------------------------------ traces
def test_words_under_a_trace_turn():
    accepts(square((1, "A B P"), (-1, "P A B")), trace=True)
    accepts(square((1, "A B"), (-1, "B' A'")), trace=True)
    rejects("remain", square((1, "A B P"), (-1, "B A P")), trace=True)
    rejects("remain", square((1, "A B P"), (-1, "P A B")))
    rejects("ill-typed", poly("m", "n", (1, "C", "")), trace=True)


def test_addends_under_a_trace_may_have_another_size():
    claim = poly("n", "n", (1, "C' C A", ""), (-1, "C' C", ""))
    accepts(claim, term("ct", "", "C'"), trace=True)
    accepts(claim, term("ct", "C'", ""), trace=True)


def test_identities_of_different_size_are_different_under_a_trace():
    relations = {"unit": square((1, "A"), (-1, ""))}
    accepts(square((1, "A"), (-1, "")), term("unit"), trace=True, relations=relations)
    rejects("remain", poly("m", "m", (1, "A", ""), (-1, "", "")), term("unit"), trace=True, relations=relations)


def test_the_trace_of_the_identity_is_no_letter():
    rejects("remain", poly("n", "n", (1, "I", ""), (-1, "", "")), trace=True)


# ------------------------------------------------------------------------------------------------ integrals and deltas
INTEGRAL = {
    "length": poly("n", "n", (1, "", "∫τ"), (-1, "T", "")),
    "moves": poly("n", "n", (1, "Phi@t,τ", ""), (-1, "A Phi@t,τ", "")),
}


def test_a_relation_may_be_integrated():
    claim = poly("n", "n", (1, "Phi@t,τ B", "∫τ"), (-1, "A Phi@t,τ B", "∫τ"))
    accepts(claim, term("moves", "", "B", scalars="∫τ"), relations=INTEGRAL)


@pytest.mark.parametrize(
    ("addend", "match"),
    [
        (term("length", "", "Phi@t,τ"), "captured"),
        (term("length", "Phi@t,τ", ""), "captured"),
        (term("length", scalars="δ(τ,σ)"), "captured"),
        (term("length", scalars="δ(σ,τ)"), "captured"),
        (term("length", scalars="∫τ"), "captured"),
        (term("length", scalars="∫t"), "a limit"),
        (term("length", scalars="∫σ ∫σ"), "bound twice"),
    ],
)
def test_nothing_is_captured_by_an_integral(addend, match):
    rejects(match, square((1, "")), addend, relations=INTEGRAL)


def test_other_scalars_may_be_squared():
    assert poly("n", "n", (1, "A", "s")) * poly("n", "n", (1, "B", "s z")) == poly("n", "n", (1, "A B", "s s z"))
    assert poly("n", "n", (1, "A", "z")).scale(2, ("s",)) == poly("n", "n", (2, "A", "s z"))


def test_a_variable_is_bound_once():
    with pytest.raises(Rejected, match="captured"):
        poly("n", "n", (1, "A", "∫τ")) * poly("n", "n", (1, "B", "∫τ"))
    with pytest.raises(Rejected, match="bound twice"):
        times(("∫τ",), ("s", "∫τ"))
    with pytest.raises(Rejected, match="a limit"):
        square((1, "A")).scale(1, ("∫t0",))


def test_sampling_of_a_delta():
    claim = poly("n", "n", (1, "Phi@t,τ", "δ(t,τ)"), (-1, "Phi@t,t", "δ(t,τ)"))
    accepts(claim)
    rejects("remain", poly("n", "n", (1, "Phi@t,τ", "δ(t,τ)"), (-1, "Phi@t,σ", "δ(t,τ)")))
    rejects("remain", poly("n", "n", (1, "Phi@t,τ", ""), (-1, "Phi@t,t", "")))
    assert sample(square((1, "Phi@t,τ"))) == square((1, "Phi@t,τ"))


def test_addends_with_and_without_a_delta():
    relations = {**RELATIONS, "white": poly("n", "n", (1, "T@t,τ", ""), (-1, "P", "δ(t,τ)"))}
    claim = poly("n", "n", (1, "T@t,τ A", ""), (-1, "P A", "δ(t,τ)"), (1, "A B", ""), (-1, "", ""))
    accepts(claim, term("white", "", "A"), term("inverse"), relations=relations)
    rejects("remain", claim.scale(2), term("white", "", "A"), term("inverse"), relations=relations)


def test_setting_a_time_moves_letters_and_deltas():
    before = poly("n", "n", (1, "A Phi@t,τ", "s δ(τ,σ)"), (2, "A Phi@t,t0", "s δ(t0,σ)"))
    assert at_time(before, "τ", "t0") == poly("n", "n", (3, "A Phi@t,t0", "s δ(t0,σ)"))


# ------------------------------------------------------------------------------------------------ polynomials
def test_types_of_sums_and_products():
    with pytest.raises(Rejected, match="cannot add n x n and m x n"):
        square((1, "A")) + poly("m", "n", (1, "C", ""))
    with pytest.raises(Rejected, match="cannot multiply n x n and m x n"):
        square((1, "A")) * poly("m", "n", (1, "C", ""))


def test_arithmetic():
    a, b = square((1, "A")), square((1, "B"))
    assert (a + b) * (a - b) == square((1, "A A"), (-1, "A B"), (1, "B A"), (-1, "B B"))
    assert -a == a.scale(-1) == Poly({((), ("A",)): -1}, "n", "n")
    assert a * identity("n") == a
    assert a - a == Poly({}, "n", "n")
    assert a != "A"
    assert all(type(c) is Fraction for c in (a + b).terms.values())
    one = poly(ANY, ANY, (1, "", "s"))
    assert one * a == a * one == poly("n", "n", (1, "A", "s"))
    assert len({a, square((1, "A")), b}) == 2


def test_transposes():
    assert LETTERS.transpose(poly("m", "n", (1, "C A P", "s"))) == poly("n", "m", (1, "P A' C'", "s"))
    assert LETTERS.flip("Phi@t,τ") == "Phi'@t,τ"
    assert LETTERS.flip("Phi'@t,τ") == "Phi@t,τ"
    assert LETTERS.flip("P@t") == "P@t"
    assert parts("Phi'@t,τ") == ("Phi", True, ("t", "τ"))
    assert LETTERS.shape("C'") == ("n", "m")
