"""Claims made to deceive the decision: misread, under contradictory assumptions, or without hypotheses in force."""

from __future__ import annotations

import pytest

from derive.claim import Verdict
from derive.decide import decide
from derive.errors import InputError
from derive.interpret import NotUnderstood, understand
from derive.latex.grammar import read
from derive.theory.claims import claim_theory

KB, CT, DT = "kalman-bucy", "lqr-ct", "lqr-dt"


def verdict(theory: str, latex: str, *assume: str, scalar: bool = False) -> Verdict:
    given = [read(a) for a in assume]
    statement = understand(read(latex), claim_theory(theory), assume=given, scalar=scalar)
    return decide(statement, seconds=5, near=False).verdict


@pytest.mark.parametrize("scalar", [False, True])
@pytest.mark.parametrize(
    ("theory", "latex", "assume"),
    [
        (KB, r"A^T A + C^T C \succ 0", ()),
        (CT, r"A A^T + B B^T \succ 0", ()),
        (DT, r"(A - I) (A - I)^T + B B^T \succ 0", ()),
        (KB, r"\operatorname{tr} A \le 0", ("C = 0",)),
    ],
)
def test_a_plant_that_is_not_detectable_refutes_nothing(theory: str, latex: str, assume: tuple[str, ...], scalar: bool):
    assert verdict(theory, latex, *assume, scalar=scalar) is not Verdict.refuted


@pytest.mark.parametrize("scalar", [False, True])
@pytest.mark.parametrize(
    ("theory", "hidden"), [(KB, "C = 0"), (CT, "B = 0"), (DT, "B = 0")], ids=["kalman-bucy", "lqr-ct", "lqr-dt"]
)
def test_nothing_is_proved_of_a_plant_that_cannot_be_stabilised(theory: str, hidden: str, scalar: bool):
    try:
        found = verdict(theory, "A = 2 I", "A = 2 I", hidden, scalar=scalar)
    except InputError:
        return
    assert found is Verdict.undecided


@pytest.mark.parametrize("word", ["or", "if", "unless", "iff"])
def test_words_that_join_formulas_are_not_read_as_and(word: str):
    with pytest.raises(NotUnderstood, match=word):
        verdict(KB, rf"P \succeq 0 \text{{ {word} }} K = 0")


def test_words_between_formulas_are_read():
    assert verdict(KB, r"P \succeq 0 \quad\text{and}\quad W \succeq 0") is Verdict.proved


@pytest.mark.parametrize(
    "latex",
    [r"\dot{P^2}(t) = P(t) \dot P(t) + \dot P(t) P(t)", r"\dot{(A P)}(t) = A \dot P(t)", r"(P C^T V^{-1})(t) = K(t)"],
)
def test_a_group_at_a_time_is_no_product_with_the_time(latex: str):
    with pytest.raises(NotUnderstood, match="at a time"):
        verdict(KB, latex)


@pytest.mark.parametrize(
    ("theory", "latex"), [(KB, r"\dot K = \dot P C^T V^{-1}"), (CT, r"\dot K = R^{-1} B^T \dot S")]
)
@pytest.mark.parametrize("scalar", [False, True])
def test_the_rate_of_a_gain_is_no_free_number(theory: str, latex: str, scalar: bool):
    assert verdict(theory, latex, scalar=scalar) is not Verdict.refuted


@pytest.mark.parametrize("scalar", [False, True])
@pytest.mark.parametrize(
    ("theory", "latex", "assume"), [(KB, r"\dot P = 0", "P(t) = P"), (CT, r"\dot S = 0", "S(t) = S")]
)
def test_what_holds_at_every_time_is_not_refuted_at_one(theory: str, latex: str, assume: str, scalar: bool):
    assert verdict(theory, latex, assume, scalar=scalar) is not Verdict.refuted


@pytest.mark.parametrize("scalar", [False, True])
def test_a_rate_is_refuted_at_one_instant_otherwise(scalar: bool):
    assert verdict(KB, r"\dot P = 0", scalar=scalar) is Verdict.refuted


@pytest.mark.parametrize(
    "latex", [r"\det(A + P) = \det A + \det P", r"\det(2 A) = 2 \det A", r"\det A = \operatorname{tr} A"]
)
def test_plants_of_order_one_alone_do_not_support_a_claim(latex: str):
    assert verdict(KB, latex) is Verdict.refuted


@pytest.mark.parametrize("point", [r"-\infty", "0"])
def test_the_covariance_tends_to_the_steady_one_in_the_future_only(point: str):
    assert verdict(KB, rf"\lim_{{t \to {point}}} P(t) = P") is not Verdict.proved
    assert verdict(KB, r"\lim_{t \to \infty} P(t) = P") is Verdict.proved


def test_a_limit_that_is_attained_by_nothing_is_not_strict():
    assert verdict(KB, r"\lim_{t \to \infty} P(t) \succ P") is not Verdict.proved


@pytest.mark.parametrize("point", ["0", r"-\infty", r"\infty"])
def test_a_trace_of_a_limit_is_taken_where_it_says(point: str):
    found = verdict(
        KB, rf"\operatorname{{tr}}(\lim_{{s \to {point}}} s C (s I - A)^{{-1}} K) = \operatorname{{tr}}(C K)"
    )
    assert (found is Verdict.proved) <= (point == r"\infty")


@pytest.mark.parametrize("log", [r"\log_{10}", r"\log_2", r"\log_b"])
def test_a_logarithm_with_a_base_is_not_the_natural_one(log: str):
    integral = rf"\frac{{1}}{{2\pi}} \int_{{-\infty}}^{{\infty}} {log} \frac{{\det \Phi_y(\omega)}}{{\det V}} d\omega"
    poles = r"\sum_{i=1}^{m} \max\{0, \Re[\lambda_i(A)]\}"
    with pytest.raises(NotUnderstood, match="index"):
        verdict(KB, rf"{integral} = \operatorname{{tr}}(C P C^T V^{{-1}}) - 2 {poles}")


def test_an_eigenvalue_of_another_matrix_is_no_product():
    with pytest.raises(NotUnderstood, match="alone"):
        verdict(KB, r"\lambda_i(A P) = \lambda_i(A) A P")


def test_a_real_number_for_j_refutes_nothing():
    assert verdict(KB, r"\Phi_y(\omega) \succeq V") is not Verdict.refuted
    wrong = r"\Phi_y(\omega) = C (j\omega I - A)^{-1} W (j\omega I - A^T)^{-1} C^T + V"
    assert verdict(KB, wrong) is Verdict.refuted


def test_an_eigenvalue_of_a_plant_is_no_free_number():
    assert verdict(KB, r"\lambda_i(A) I = A", "m = 1") is not Verdict.refuted


def test_a_strict_inequality_is_not_supported_where_its_sides_may_be_equal():
    poles = r"2 \sum_{i=1}^{m} \max\{0, \Re[\lambda_i(A)]\}"
    cost = r"\operatorname{tr}(C P C^T V^{-1})"
    assert verdict(KB, rf"{cost} \ge {poles}") is Verdict.supported
    assert verdict(KB, rf"{cost} > {poles}") is Verdict.undecided
    assert verdict(KB, r"\lambda_{\min}(P) > 0") is Verdict.undecided
