"""Spelled names: letters, accents, indices, times and frequencies, each in its theory."""

from __future__ import annotations

import pytest

from derive.interpret import NotUnderstood
from derive.terms import Symbol, Transpose
from tests.derive.interpret.reading import meant

DT, KB, OB, CO, RC, RD = "luenberger-dt", "kalman-bucy", "observer-ct", "covariance-ct", "lqr-ct", "lqr-dt"
NAMES = [
    (DT, r"P", "P"), (DT, r"\mathbf{P}", "P"), (DT, r"\boldsymbol{P}_{\infty}", "P"), (DT, r"P_{k-1}", "P_{k-1}"),
    (DT, r"P_k^-", "P_k"), (DT, r"P_{k|k-1}", "P_k"), (DT, r"P_{k\mid k-1}", "P_k"), (DT, r"P(k|k-1)", "P_k"),
    (DT, r"P_k^+", "P+_k"), (DT, r"P_{k|k}", "P+_k"), (DT, r"P_{k-1|k-1}", "P+_{k-1}"), (DT, r"P_{k+1|k}", "P_{k+1}"),
    (DT, r"P_0", "P_0"), (DT, r"P(0)", "P_0"), (DT, r"P^+", "P+"), (DT, r"Q_{k-1}", "Q_{k-1}"), (DT, r"Q", "Q"),
    (DT, r"\mathbf{Q}_{k}", "Q_k"), (DT, r"P_{n+1}", "P_{n+1}"),
    (KB, r"P", "P"), (KB, r"P(t)", "P(t)"), (KB, r"P(0)", "P(t)"), (KB, r"\sigma_{\mathbf w}^2", "W"), (KB, r"W", "W"),
    (OB, r"\mathbf{P}_{\mathbf{e}}", "P_e"), (OB, r"\boldsymbol\sigma_{\xi}^2", "sigma2"), (OB, r"W", "W"),
    (CO, r"X(t)", "X"), (CO, r"X", "X"), (CO, r"X(\tau)", "X"), (CO, r"X(t_0)", "X"),
    (RC, r"S", "S"), (RC, r"S(t)", "S(t)"), (RC, r"S_\infty", "S"), (RD, r"S_{k+1}", "S_{k+1}"), (RD, r"Q", "Q"),
]  # fmt: skip
OTHERS = [
    (DT, r"L_f = L^f"), (DT, r"L_{f,k} = L_k^f"), (KB, r"\Phi_y(\omega) = \Phi_{\mathbf y}(j\omega)"),
    (KB, r"\Sigma_{z-\bar y} = \Sigma_{\mathbf z - \overline{\mathbf y}}"), (KB, r"V = \sigma_v^2"),
]  # fmt: skip


@pytest.mark.parametrize(("key", "latex", "name"), NAMES)
def test_a_name_stands_for_one_letter(key: str, latex: str, name: str):
    equation = meant(key, rf"{latex} = ({latex})^T").equations[0]
    assert isinstance(equation.lhs, Symbol)
    assert equation.lhs.name == name
    assert equation.rhs == Transpose(equation.lhs)


@pytest.mark.parametrize(("key", "latex"), OTHERS)
def test_two_spellings_are_one_letter(key: str, latex: str):
    equation = meant(key, latex).equations[0]
    assert equation.lhs == equation.rhs


def test_filter_form_and_prediction_differ():
    assert meant("luenberger-dt", r"\hat x_{k|k} = \hat x_k^+").equations[0].lhs.name == "xhat+_k"  # type: ignore[union-attr]
    assert meant("luenberger-dt", r"\hat x_{k|k-1} = \hat x_k^-").equations[0].rhs.name == "xhat_k"  # type: ignore[union-attr]


def test_an_initial_time_is_t0():
    assert meant("kalman-bucy", "P(0) = P(t_0)").equations[0].lhs == meant("kalman-bucy", "P(t_0) = 0").equations[0].lhs


@pytest.mark.parametrize("latex", [r"\dot P = W", r"\frac{d}{dt} P = W", r"\frac{dP}{dt} = W", r"\dot{P}(t) = W"])
def test_a_rate_is_that_of_the_transient(latex: str):
    (symbol, _) = meant("kalman-bucy", latex).symbols
    assert symbol.name == "P(t)"


def test_beside_a_rate_or_a_signal_letters_are_those_at_t():
    assert [s.name for s in meant("kalman-bucy", r"\dot P = K V K^T").symbols] == ["P(t)", "K(t)", "V"]
    assert [s.name for s in meant("kalman-bucy", r"\dot{\hat x} = A \hat x + K (y - C \hat x)").symbols][2] == "K(t)"
    assert [s.name for s in meant("kalman-bucy", r"K = P C^T V^{-1}").symbols][:2] == ["K", "P"]


def test_where_p_of_t_is_written_p_is_steady():
    assert [s.name for s in meant("kalman-bucy", r"\dot P(t) = P").symbols] == ["P(t)", "P"]


@pytest.mark.parametrize(
    ("latex", "said"),
    [
        ("K = L", "K: no letter of luenberger-dt"),
        ("P_{k|k-2} = P", "expected an index k|k-1 (prediction) or k|k (filtered), got k|k-2"),
        ("A_k = A", "A_k: no letter of luenberger-dt, which has A;"),
        (r"\tilde P = P", "tilde P: no letter"),
    ],
)
def test_a_name_without_meaning_is_said(latex: str, said: str):
    with pytest.raises(NotUnderstood, match=r".") as error:
        meant("luenberger-dt", latex)
    assert said in str(error.value)


def test_a_place_is_given():
    with pytest.raises(NotUnderstood) as error:
        meant("luenberger-dt", "P = Q + K A")
    assert error.value.span == (8, 9)


# ------------------------------------------------------------------------------------------------ notations
def test_a_notation_renames_roles():
    found = meant("luenberger-dt", r"\Sigma_{k|k-1} = F \Sigma_{k-1|k-1} F^T + Q", notation={"F": "A", r"\Sigma": "P"})
    assert [s.name for s in found.symbols] == ["P_k", "A", "P+_{k-1}", "Q"]


def test_a_notation_of_an_accent():
    found = meant("kalman-bucy", r"\check x = A x", notation={r"\check{x}": r"\bar{x}"})
    assert [s.name for s in found.symbols] == ["xbar", "A", "x"]


def test_a_notation_without_backslashes():
    found = meant("kalman-bucy", r"\Sigma = \check x \check x^T", notation={"Sigma": "P", "check{x}": "hat{x}"})
    assert [s.name for s in found.symbols] == ["P(t)", "xbar"]


def test_a_letter_whose_role_is_taken_is_an_error():
    with pytest.raises(NotUnderstood, match="A: the notation gives its role to F"):
        meant("luenberger-dt", "P = A P F^T + Q", notation={"F": "A"})


def test_letters_may_be_exchanged():
    found = meant("luenberger-dt", "C = A P A^T", notation={"A": "C", "C": "R"})
    assert [s.name for s in found.symbols] == ["R", "C", "P"]
