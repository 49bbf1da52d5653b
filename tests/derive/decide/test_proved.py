"""True formulas are proved, with what they rest on; false ones come with an exact counterexample."""

from __future__ import annotations

import pytest

from derive.claim import Verdict
from derive.errors import InputError
from derive.matrix.recheck import confirm
from tests.derive.decide.formulas import ORDER, SOURCES, TEXTBOOK
from tests.derive.decide.reading import KB, answer, statement


@pytest.mark.parametrize(("latex", "theory", "assume"), SOURCES + TEXTBOOK + ORDER)
def test_true_formulas_are_proved(latex, theory, assume):
    found = answer(latex, theory, assume)
    assert (found.verdict, found.method) == (Verdict.proved, "kernel")
    assert set(found.hypotheses_used) <= set(statement(latex, theory, assume).theory.theory.declared)
    assert not set(found.hypotheses_used) & set(found.hypotheses_not_needed)


REFUTED = [
    (r"L_k = P_{k-1} C^T (C P_{k-1} C^T + R)^{-1}", "left 1, right 1/2"),
    (r"e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} + w_{k-1}", ""),
    (r"P = A P A^T + Q", ""),
    (r"P \succ 0", "P = 0: left 0, right 0"),
    (r"P A = A P", ""),
    (r"\mathbb{E}[e_k w_{k-1}^T] = Q", "Q = 1: left -1, right 1"),
    (r"\operatorname{tr}(P C^T R^{-1} C) > 0", "C = 0"),
    (r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 2 L_k R", ""),
    (r"A \neq 0", "A = 0"),
]


@pytest.mark.parametrize(("latex", "shown"), REFUTED)
def test_false_formulas_are_refuted_by_an_exact_instance(latex, shown):
    found = answer(latex)
    assert (found.verdict, found.method) == (Verdict.refuted, "exact instance")
    assert shown in str(found.counterexample)


def test_a_counterexample_satisfies_every_hypothesis():
    """The steady covariance of a counterexample is stabilising: A = 2, Q = 0 has the roots 0 and 3."""
    found = answer(r"P = Q").counterexample
    (a,), (c,), (p,), (r,) = (found.values[x][0] for x in "ACPR")
    gain = a * p * c / (c * p * c + r)
    assert abs(a - gain * c) < 1
    assert p == a * p * a + found.values["Q"][0][0] - gain * c * p * a


def test_one_of_several_relations_fails():
    found = answer(r"P \succeq Q = 2 Q")
    assert found.verdict is Verdict.refuted
    assert found.notes == ("its relation number 2 fails",)


def test_the_smallest_set_of_hypotheses_is_named():
    assert answer(r"P^+ = (I - L_f C) P").notes == ()
    found = answer(r"P_k = Q + (A - L_k C) P_{k-1} (A - L_k C)^T + L_k R L_k^T")
    assert found.hypotheses_used == ("covariance recursion",)
    assert "gain" in found.hypotheses_not_needed
    assert found.notes == ("holds for every gain L_k",)
    assert answer(r"P_k = (A - L_k C) P_{k-1} A^T + Q").notes == ()


def test_what_fails_without_a_hypothesis():
    from derive.decide import decide

    found = decide(statement(r"L_k = A P_{k-1} C^T (C P_{k-1} C^T + R)^{-1}"), explain=True)
    assert str(found.needed["gain"]).endswith("left 1, right 1/2")
    found = decide(statement(r"C P_{k-1} C^T + R \succ 0"), explain=True)
    assert set(found.needed) == {"R > 0", "P_{k-1} >= 0"}
    assert found.needed["R > 0"].left[0][0] <= 0


# ------------------------------------------------------------------------------------------------ assumptions
def test_an_assumption_is_used_and_named():
    found = answer(r"P_k = A P_{k-1} A^T + Q", assume=("C = 0",))
    assert found.verdict is Verdict.proved
    assert "C = 0" in found.hypotheses_used
    assert found.assumed == ("C = 0",)


@pytest.mark.parametrize("assume", [("R = -I",), (r"P \succ 0", "P = 0"), ("A = I", r"Q \succ 0", "C = 0")])
def test_contradictory_assumptions_prove_nothing(assume):
    with pytest.raises(InputError, match="expected relations that a plant can satisfy"):
        answer(r"P = 2 P", assume=assume)


def test_an_inverse_in_an_assumption_needs_its_reason():
    assert answer(r"G P = I", assume=("G = P^{-1}", r"P \succ 0")).verdict is Verdict.proved
    found = answer(r"G P = I", assume=("G = P^{-1}",))
    assert found.verdict is Verdict.undecided


def test_a_condition_that_only_instances_know():
    assert answer(r"C = 0", assume=(r"C \neq 0",)).verdict is Verdict.refuted
    found = answer(r"L C = 0", assume=(r"C \neq 0", r"A = 0"))
    assert found.verdict is Verdict.proved


def test_the_steady_state_need_not_be_strictly_stable():
    """A - K C Hurwitz holds of every instance that is tried, and is no reason for a proof: A = W = 0 is allowed."""
    reading = statement(r"A - K C = 0", KB).theory.reading
    assert "A - K C Hurwitz" in reading.real.cases
    found = answer(r"A - K C = A - P C^T V^{-1} C", KB)
    assert "A - K C Hurwitz" not in found.hypotheses_used


def test_counterexamples_are_confirmed_by_code_of_their_own():
    from derive.decide.workspace import Workspace
    from derive.kernel import Poly

    work = Workspace(statement(r"P = Q").theory, float("inf"))
    found = answer(r"P = Q").counterexample
    P, Q = (Poly({((), (x,)): 1}, "n", "n") for x in "PQ")
    assert confirm(found, P, Q, work.problem())
    assert not confirm(found, P, P, work.problem())


@pytest.mark.parametrize("body", ["(P + Q + A + A^T)", "(P^{-1} + C^T R^{-1} C)", "(I + (P + Q + A + A^T))"])
def test_what_expands_to_too_much_is_refused(body):
    with pytest.raises(InputError, match="at most"):
        answer(f"P = {body * 12}", assume=(r"P \succ 0",))
    with pytest.raises(InputError, match="at most"):
        answer(f"P = ({body * 12})^{{-1}}", assume=(r"P \succ 0",))
