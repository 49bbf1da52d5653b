"""The replay of a proof accepts nothing but what follows; each rule with the nearest that it must not accept."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from derive.decide.certificate import replayed
from derive.decide.equations import prove_equation
from derive.decide.gradient import dependent
from derive.decide.parts import Part, oriented
from derive.decide.traces import TraceOrder, TraceProduct
from derive.decide.workspace import Workspace, proof_reading
from derive.derivation import Proof
from derive.kernel import Certificate, Poly, Rejected, Term
from derive.rules import Comparison
from derive.terms import Equation, Neg, Number, Symbol, Trace, Zero
from tests.derive.decide.reading import DT, KB, statement

GRADIENT = r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 0"


def proved(latex: str, theory: str = DT, assume: tuple[str, ...] = ()):
    found = statement(latex, theory, assume)
    work = Workspace(found.theory, float("inf"), found.equations)
    part = prove_equation(oriented(found.equations[0], work.reading), work)
    replayed(found, work.items, [part])
    return found, work.items, part


def rejection(found, items, *parts: Part) -> str:
    with pytest.raises(Rejected) as error:
        replayed(found, items, parts)
    return str(error.value)


def letter(name: str, rows: str = "n", cols: str = "n") -> Poly:
    return Poly({((), (name,)): 1}, rows, cols)


def test_every_equation_needs_its_proof():
    found, items, part = proved(r"L = A P C^T (C P C^T + R)^{-1}")
    assert "every equation" in rejection(found, items)
    assert "every equation" in rejection(found, items, part, part)


def test_an_identity_is_no_inequality():
    found, items, part = proved(r"L = A P C^T (C P C^T + R)^{-1}")
    for rule in ("trace", "positivity", "comparison", "gradient", "expectation", "trace order", "chain"):
        rejection(found, items, replace(part, rule=rule))
    rejection(found, items, replace(part, image=letter("A")))
    other = replace(found, equations=(replace(found.equations[0], relation="≠"),))
    assert "proves equations" in rejection(other, items, part)


def test_a_weak_inequality_is_not_a_strict_one():
    found, items, part = proved(r"P \succeq 0")
    strict = replace(found, equations=(replace(found.equations[0], relation="≻"),))
    assert "not what the certificate shows" in rejection(strict, items, part)


def test_a_comparison_needs_stability_that_is_no_case():
    """A - L C Schur holds of every instance, and is no reason for a proof."""
    found = statement(r"P \succeq 0")
    assert "A - L C Schur" in found.theory.reading.context.facts
    assert "A - L C Schur" not in proof_reading(found.theory).context.facts
    closed = letter("A") - letter("L", "n", "l") * letter("C", "l", "n")
    proof = Comparison("stein", letter("P"), closed, "A - L C Schur", "Q >= 0", ())
    assert "no fact A - L C Schur" in rejection(found, [], Part("comparison", Proof(comparison=proof)))


# ------------------------------------------------------------------------------------------------ gradients
def test_what_changes_with_the_gain():
    assert dependent("L_k", statement(GRADIENT).theory) == {"P_k"}
    assert not dependent("A", statement(r"P_k = P_{k-1}").theory) & {"Q", "R", "P_{k-1}"}
    theory = statement(r"\dot P_e = A_e P_e + P_e A_e^T + \sigma_\xi^2", "observer-ct").theory
    assert {"A_e", "P_e"} <= dependent("L", theory)


def test_an_equation_with_the_gain_leaves_no_letter_free():
    found = statement(r"\frac{\partial \operatorname{tr}(G R)}{\partial L_k} = 0", assume=("G R = C L_k",))
    assert {"G", "R", "C"} <= dependent("L_k", found.theory)


def test_a_letter_that_changes_with_the_gain_has_no_zero_gradient():
    found, items, part = proved(GRADIENT)
    nothing = Certificate(Poly({}, "n", "n"), trace=True), Certificate(Poly({}, "l", "l"), trace=True)
    naive = Part("gradient", Proof(nothing), image=letter("P_k"))
    assert "changes with the gain" in rejection(found, items, naive)
    rejection(found, items, replace(part, image=None))
    rejection(found, items, replace(part, image=letter("Q")))


def test_what_holds_at_the_optimum_is_not_differentiated():
    """P_k = A P_{k-1} A' + Q - ... holds for the optimal gain only, and does not contain it."""
    found, items, part = proved(GRADIENT)
    under, after = part.proof.identities
    optimal = Term(Fraction(1), (), (), "gain", False, ("L_k'",))
    changed = replace(under, terms=(*under.terms, optimal))
    assert "undeclared relation gain" in rejection(found, items, replace(part, proof=Proof((changed, after))))


# ------------------------------------------------------------------------------------------------ expectations
def test_an_expectation_needs_both_identities():
    found, items, part = proved(r"\mathbb{E}[e_k v_{k-1}^T] = L_k R")
    under, after = part.proof.identities
    for wrong in ((under,), (after, under), (under, under), (replace(under, terms=()), after)):
        rejection(found, items, replace(part, proof=Proof(wrong)))
    rejection(found, items, replace(part, image=letter("A")))
    rejection(found, items, replace(part, image=part.image.scale(2)))


def test_a_random_signal_is_not_its_expectation():
    found = statement(r"\mathbb{E}[e_k e_k^T] = P_k")
    (equation,) = found.equations
    signals = replace(found, equations=(replace(equation, rhs=equation.lhs.body),))
    zero = Certificate(Poly({}, "n", "n"))
    part = Part("expectation", Proof((zero, zero)), image=Poly({}, "n", "n"))
    assert "random signal" in rejection(signals, [], part)


# ------------------------------------------------------------------------------------------------ traces
def test_a_trace_of_two_positive_matrices():
    found, items, part = proved(r"\operatorname{tr}(P C^T R^{-1} C) \ge 0")
    (product,) = part.order.products

    def order(*products: TraceProduct) -> Part:
        return replace(part, order=TraceOrder(products, part.order.terms))

    assert "coefficient" in rejection(found, items, order(replace(product, coefficient=Fraction(-1))))
    assert "no fact" in rejection(found, items, order(replace(product, one="nothing")))
    assert "different sizes" in rejection(found, items, order(replace(product, one="R > 0")))
    assert "remain" in rejection(found, items, order(product, product))
    strict = replace(found, equations=(replace(found.equations[0], relation=">"),))
    assert "definite" in rejection(strict, items, part)
    turned = replace(found, equations=(replace(found.equations[0], lhs=Neg(found.equations[0].lhs)),))
    assert "remain" in rejection(turned, items, part)


def test_only_symmetric_matrices_count():
    """tr(M H) may be negative if M is not symmetric, whatever M + M' is."""
    _, items, part = proved(r"\operatorname{tr} P \ge 0")
    assert part.order.products[0].one == "P >= 0"
    _, items, part = proved(r"\operatorname{tr}(K C) \ge 0", KB)
    names = {n for p in part.order.products for n in (p.one, p.two)}
    assert names <= {*(i.name for i in items if hasattr(i, "name")), "P >= 0", "Im", "Il"}


# ------------------------------------------------------------------------------------------------ orientation
def test_a_zero_stands_on_the_right():
    reading = statement(r"P = Q").theory.reading
    P, zero = Symbol("P", "n", "n", symmetric=True), Zero("", "")
    assert oriented(Equation(zero, "=", P), reading) == Equation(P, "=", zero)
    assert oriented(Equation(zero, "⪰", P), reading) == Equation(Neg(P), "⪰", zero)
    assert oriented(Equation(P, ":=", zero), reading).relation == "="
    plain = oriented(Equation(Number(Fraction(0)), "≥", Trace(P)), reading)
    assert plain == Equation(Neg(Trace(P)), "≥", Trace(Zero("n", "n")))
