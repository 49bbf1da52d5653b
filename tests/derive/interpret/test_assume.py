"""What is given: definitions of new letters, further hypotheses, and what takes the place of a declaration."""

from __future__ import annotations

import pytest

from derive.context import Declared
from derive.interpret import NotUnderstood
from derive.terms import Equation, Symbol, Zero
from tests.derive.interpret.reading import meant

DT, KB, OB, CO = "luenberger-dt", "kalman-bucy", "observer-ct", "covariance-ct"


def declared(statement, name: str) -> Equation:
    """Return what a declaration of a statement's theory says."""
    item = statement.theory.theory.declared[name]
    assert isinstance(item, Declared)
    return item.statement


def test_nothing_given_leaves_the_theory_as_it_is():
    assert meant(DT, "L = 0").assumed == ()
    assert meant(DT, "L = 0").theory is meant(DT, "L = P C^T").theory.about({"L"})


@pytest.mark.parametrize(
    ("key", "latex", "given", "name"),
    [
        (KB, "K = P C^T", "V = I", "V = I"),
        (DT, "P_k = 0", r"P_{k-1} \succ 0", "P_{k-1} > 0"),
        (OB, r"\sigma_\xi^2 = 0", "S_{dr} = 0", "S_dr = 0"),
        (DT, "P = Q", "A = 0", "A = 0"),
        (DT, "P = Q", r"Q \succeq R C", None),
        (DT, r"P \succ 0", r"Q \preceq A Q A^T", "A Q A' >= Q"),
        (DT, "P = Q", r"\operatorname{rank} C = n", "C' C > 0"),
    ],
)
def test_hypotheses_are_added(key: str, latex: str, given: str, name: str | None):
    if name is None:
        with pytest.raises(NotUnderstood, match="an assumption: shapes"):
            meant(key, latex, [given])
        return
    found = meant(key, latex, [given])
    assert found.assumed == (name,)
    assert name in found.theory.theory.declared


def test_a_new_letter_is_defined_and_typed():
    found = meant(DT, "L Z = A P C^T", ["Z = C P C^T + R"])
    Z = found.symbols[1]
    assert (Z.rows, Z.cols) == ("l", "l")
    assert declared(found, "Z = C P C' + R").relation == ":="


def test_a_new_letter_takes_its_shape_from_its_use():
    found = meant(DT, r"M \succeq M C^T C M", [r"M \succ 0"])
    assert (found.symbols[0].rows, found.symbols[0].symmetric) == ("n", True)


def test_a_letter_introduced_by_its_set():
    found = meant(DT, r"(A - G C) P (A - G C)^T \succeq 0", [r"G \in \mathbb{R}^{n \times l}"])
    assert [(s.rows, s.cols) for s in found.symbols if s.name == "G"] == [("n", "l")]


def test_a_shape_that_does_not_follow_is_said():
    with pytest.raises(NotUnderstood, match="M: its shape does not follow"):
        meant(DT, "P = Q", [r"M \succ 0"])


def test_numbers_are_conditions():
    found = meant(DT, r"\alpha P \succeq 0", [r"\alpha \ge 0"])
    assert found.theory.conditions[0].relation == "≥"
    assert "alpha" in found.theory.theory.nonnegative
    assert meant(DT, r"P \succ 0", [r"C \neq 0"]).theory.conditions[0].relation == "≠"


def test_where_all_dimensions_are_1_what_is_given_are_conditions():
    found = meant(KB, "P = 2", ["A < 0", "C = 1"], scalar=True)
    assert [c.relation for c in found.theory.conditions] == [">", "="]
    assert found.assumed == ("0 > A", "C = 1")


# ------------------------------------------------------------------------------------------------ overriding
def test_a_gain_that_is_given_takes_the_place_of_the_optimal_one():
    printed = "L = P C' (C P C' + R)^-1"
    found = meant(DT, "L R = 0", ["L = P C^T (C P C^T + R)^{-1}"])
    assert printed in found.theory.theory.declared
    assert not {"steady gain", "A - L C Schur"} & found.theory.theory.declared.keys()
    assert found.theory.optimal == frozenset()


def test_an_equation_that_a_letter_solves_is_added():
    found = meant(DT, "P = 0", ["P = A P A^T + Q"])
    assert {"Riccati equation", "P = A P A' + Q"} <= found.theory.theory.declared.keys()


def test_a_moment_that_is_given_takes_the_place_of_the_declared_one():
    found = meant(DT, r"\mathbb E[e_k e_k^T] = 0", [r"\mathbb{E}[w_{k-1} v_{k-1}^\top] = S"])
    moments = [n for n, d in found.theory.theory.declared.items() if "w_{k-1} v_{k-1}" in n or n == "w and v at k-1"]
    assert moments == ["E[w_{k-1} v_{k-1}'] = S"]
    assert "covariance recursion with cross-covariance" in found.theory.theory.declared


def test_a_letter_of_another_shape_is_a_new_one():
    found = meant(DT, "L S = A P C^T", ["S = C P C^T + R"])
    assert found.symbols[1].name == "S (given)"
    assert "Riccati equation" in found.theory.theory.declared


def test_a_cross_covariance_that_is_given_brings_the_general_relations():
    assert "Riccati equation with cross-covariance" in meant(DT, "P = Q", ["S = 0"]).theory.theory.declared
    assert declared(meant(DT, "P = Q", ["S = 0"]), "S = 0") == Equation(
        meant(DT, "S = 0").symbols[0], "=", Zero("n", "l")
    )


# ------------------------------------------------------------------------------------------------ other forms
def test_a_function_stands_for_its_definition():
    found = meant(KB, r"L(j\omega) = 0", ["L(s) = C(sI - A)^{-1}K"])
    assert found.equations == meant(KB, r"C(j\omega I - A)^{-1}K = 0").equations


def test_a_dimension_that_is_1():
    found = meant(KB, r"\Sigma_{z-\bar y} = C P C^T", ["l = 1"])
    assert found.symbols[0].rows == "1"
    assert found.theory.theory.symbols["V"].rows == "1"
    assert declared(found, "V > 0").lhs == found.theory.theory.symbols["V"]


def test_a_letter_given_by_blocks():
    blocks = r"X = \begin{bmatrix} X_{ss} & X_{sv} \\ X_{sv}^T & X_{vv} \end{bmatrix}"
    found = meant(CO, r"X(0) = \begin{bmatrix} 0 & 0 \\ 0 & X_{vv}(\infty) \end{bmatrix}", [blocks])
    assert [s.args for s in found.symbols[:3]] == [("t0",)] * 3
    with pytest.raises(NotUnderstood):  # A is not given by blocks: no shapes that refute
        meant(CO, r"\dot X = A X + X A^T + B N B^T", [blocks])


def test_a_constant_is_not_given_by_blocks():
    with pytest.raises(NotUnderstood, match="A is a constant of the theory"):
        meant(KB, "P = W", [r"A = \begin{bmatrix} W & W \\ W & W \end{bmatrix}"])


def test_the_root_of_a_matrix_and_its_extreme_eigenvalues():
    found = meant(KB, r"\operatorname{tr}(V^{-\frac12} C P C^T V^{-\frac12}) \le \lambda_{\max}(P)")
    assert declared(found, "V^1/2 positive").relation == "≻"
    assert "largest eigenvalue of P" in found.theory.theory.declared
    assert all(isinstance(s, Symbol) for s in found.symbols)


def test_an_assumption_without_a_relation_is_an_error():
    with pytest.raises(NotUnderstood, match="expected an equation or an inequality"):
        meant(DT, "P = Q", ["P C^T"])


@pytest.mark.parametrize("given", [["m = 1", "l = 1"], ["l = m = 1"]])
def test_where_state_and_output_are_1_everything_commutes(given: list[str]):
    found = meant(KB, "P C = C P", given)
    assert found.scalar
    assert found.theory.conditions == ()


def test_where_all_dimensions_are_1_detectability_is_in_force():
    assert "A - K C Hurwitz" in meant(KB, "A < 0", ["C = 0"], scalar=True).theory.theory.declared
    assert "A - K C Hurwitz" not in meant(KB, "A W = W").theory.theory.declared


def test_a_value_of_a_defined_letter_is_a_special_case():
    assert {"N", "N = 0"} <= meant(OB, "L = 0", ["N = 0"]).theory.theory.declared.keys()
    assert "N" not in meant(OB, "L = 0", [r"N = B_d S_{dd} D_d^T"]).theory.theory.declared


def test_a_value_of_a_gain_is_another_gain():
    assert "gain" not in meant(DT, "P_k = A P_{k-1} A^T + Q", ["L_k = 0"]).theory.theory.declared


def test_a_rate_of_zero_is_the_steady_state():
    found = meant(KB, r"\dot P = A P", [r"\dot P = 0"])
    (given,) = found.assumed
    assert {"P(t)", given} <= found.theory.theory.declared.keys()
    assert given in found.theory.reading.context.relations
