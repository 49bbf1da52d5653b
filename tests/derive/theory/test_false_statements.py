"""Statements that are false in some model of a theory: no certificate carries them, whatever its rule."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.context import Theory
from derive.derivation import Proof, Step, claims, verify
from derive.kernel import Certificate, Poly, Rejected, identity
from derive.rules import Positivity, Square
from derive.terms import Delta, Dot, Equation, Gradient, Identity, Integral, Product, Trace, Zero
from derive.theory import theory

NOTHING = Zero("", "")
OBSERVER, BUCY, COVARIANCE, LUENBERGER = map(theory, ("observer-ct", "kalman-bucy", "covariance-ct", "luenberger-dt"))


def step(name, statement, proof, rule="identity", lemma=False):
    return Step(name, statement, rule, (), proof, lemma=lemma)


def congruence(matrix, factor, fact):
    """Return the proof that F H F' >= 0 for the letter H of a fact."""
    symbol = factor.rows
    square = Square(Fraction(1), (), ((factor,),), fact)
    return Proof(positivity=Positivity(((Poly(matrix, symbol, symbol),),), (square,), (((),),)))


@pytest.mark.parametrize("factor", [(("j",), ()), ((), ("(sI-A)^-1",)), (("s",), ("A",))])
def test_a_square_of_complex_numbers_need_not_be_positive(factor):
    (scalars, word), s = factor, BUCY.symbols
    turned = tuple(BUCY.alphabet().flip(a) for a in reversed(word))
    proof = congruence({(scalars * 2, (*word, "W", *turned)): 1}, Poly({factor: 1}, "m", "m"), "W >= 0")
    meaning = {"(sI-A)^-1": (Product((s["s"], Identity("m"))) - s["A"]).inv, "A": s["A"]}
    left = Product((*(s[x] for x in scalars), *(meaning[a] for a in word), Identity("m")))
    (outcome,) = verify(BUCY, [step("a", Equation(left * s["W"] * left.T, "⪰", NOTHING), proof, "positivity")])
    assert not outcome.accepted
    assert "complex" in outcome.message


def test_the_point_of_a_spectrum_is_no_time():
    """Else the delta at s would set the spectrum's argument and leave that of its formula."""
    for name, point in (("s", "s"), ("ω", "ω")):
        statement = BUCY.statement(f"Phi_y({name})")
        both = (Integral(Delta("t", point) * side, point) for side in (statement.lhs, statement.rhs))
        with pytest.raises(Rejected, match="not a variable of time"):
            claims(Equation(next(both), "=", next(both)), "identity", BUCY.reading())


def test_products_of_deltas_have_no_value():
    product = Delta("a", "b") * Delta("t", "a") * BUCY.symbols["W"]
    for one, two in (("a", "b"), ("b", "a")):
        with pytest.raises(Rejected, match="no product"):
            claims(Equation(Integral(Integral(product, one), two), "=", NOTHING), "identity", BUCY.reading())


@pytest.mark.parametrize(
    ("theory_", "symbol"), [(COVARIANCE, COVARIANCE.symbols["X"].at("t0")), (BUCY, BUCY.symbols["Phi"].at("τ", "t0"))]
)
def test_a_derivative_is_not_zero_because_its_time_is_fixed(theory_, symbol):
    with pytest.raises(Rejected, match="write it at t"):
        claims(Equation(Dot(symbol), "=", NOTHING), "identity", theory_.reading())


def test_a_scalar_does_not_vary_in_time():
    moving = Product((BUCY.symbols["s"].at("t"), BUCY.symbols["W"]))
    with pytest.raises(Rejected, match="scalar s"):
        claims(Equation(Dot(moving), "=", NOTHING), "identity", BUCY.reading())


@pytest.mark.parametrize(
    ("theory_", "name", "times"),
    [
        (OBSERVER, "R_xixi", ("t", "τ")),
        (OBSERVER, "P_e", ("t",)),
        (OBSERVER, "Phi", ("t", "t0")),
        (BUCY, "P_L", ("t",)),
        (BUCY, "Phi", ("t", "t0")),
        (BUCY, "Sigma", ()),
    ],
)
def test_what_depends_on_the_gain_is_no_constant_under_its_gradient(theory_, name, times):
    statement = Equation(Gradient(Trace(theory_.symbols[name].at(*times)), theory_.symbols["L"]), "=", NOTHING)
    with pytest.raises(Rejected, match="may depend on L"):
        claims(statement, "gradient", theory_.reading())


def test_the_output_error_covariance_varies_in_time():
    with pytest.raises(Rejected, match="derivative of Sigma"):
        claims(Equation(Dot(BUCY.symbols["Sigma"]), "=", NOTHING), "identity", BUCY.reading())


def test_the_steady_state_is_a_case():
    assert all(BUCY.declared[name].case for name in ("optimal", "steady P", "steady K"))


def test_a_fact_under_the_name_of_a_reason_is_rejected():
    R = LUENBERGER.symbols["R_{k-1}"]
    proof = congruence({((), ("R_{k-1}",)): 1}, identity("l"), "R_{k-1} > 0")
    steps = [step("innovation covariance", Equation(R, "⪰", NOTHING), proof, "positivity", True)]
    assert "not a reason" in verify(LUENBERGER, steps)[0].message


def test_a_lemma_that_cannot_be_adopted_is_rejected():
    trace = Equation(Trace(BUCY.symbols["A"]), "=", Trace(BUCY.symbols["A"]))
    proof = Proof((Certificate(Poly({}, "m", "m"), trace=True),))
    outcomes = verify(BUCY, [step("a", trace, proof, "trace", lemma) for lemma in (True, False)])
    assert [o.accepted for o in outcomes] == [False, False]
    assert outcomes[1].message == "the name a is taken"


def test_a_proof_holds_nothing_beside_what_its_rule_replays():
    A = BUCY.symbols["A"]
    proof = Proof((Certificate(Poly({}, "m", "m")),), links=("steady P",))
    (outcome,) = verify(BUCY, [step("a", Equation(A, "=", A), proof)])
    assert "nothing else" in outcome.message


def test_an_equal_name_does_not_make_a_rejected_step_proved():
    A, W = BUCY.symbols["A"], BUCY.symbols["W"]
    false = step("a", Equation(A, "=", W), Proof((Certificate(Poly({((), ("A",)): 1, ((), ("W",)): -1}, "m", "m")),)))
    true = step("a", Equation(A, "=", A), Proof((Certificate(Poly({}, "m", "m")),)))
    assert not any(o.accepted for o in verify(BUCY, [false, true]))


@pytest.mark.parametrize("name", ["x_k", "P_k", "L_k*"])
def test_what_changes_from_step_to_step_has_no_rate(name):
    with pytest.raises(Rejected, match="derivative of"):
        claims(Equation(Dot(LUENBERGER.symbols[name]), "=", NOTHING), "identity", LUENBERGER.reading())


def test_the_inverse_of_a_matrix_that_is_not_symmetric_is_not():
    t = Theory("test", "test")
    A = t.matrix("A", "n", "n")
    t.fact("A regular", "invertible", A)
    t.inverse("A^-1", A, "n", symmetric=True, because="A regular")
    with pytest.raises(Rejected, match="declared symmetric, but what it inverts is not"):
        t.reading()
