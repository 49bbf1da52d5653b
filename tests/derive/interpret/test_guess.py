"""The theory that formulas are about, where it is clear."""

from __future__ import annotations

import pytest

from derive.interpret import guess
from derive.latex.grammar import read


@pytest.mark.parametrize(
    ("formulas", "key"),
    [
        (["K = P C^T V^{-1}"], "kalman-bucy"),
        (["L = A P C^T (C P C^T + R)^{-1}"], "luenberger-dt"),
        (["L = P C^T (C P C^T + R)^{-1}"], "luenberger-dt"),
        (["P_k = A P_{k-1} A^T + Q", r"\hat x_k = A \hat x_{k-1}"], "luenberger-dt"),
        ([r"\dot e = (A - L C) e + (B_d - L D_d) d - L D_r r"], "observer-ct"),
        ([r"\dot X = A X + X A^T + B N B^T"], "covariance-ct"),
        (["u_k = -K_k x_k", "K_k = (B^T S_{k+1} B + R)^{-1} B^T S_{k+1} A"], "lqr-dt"),
        (["u = -K x", "K = R^{-1} B^T S"], "lqr-ct"),
        (["A P + P A^T + W = P C^T V^{-1} C P", "a + b = c"], "kalman-bucy"),
    ],
)
def test_letters_and_shapes_tell_the_theory(formulas: list[str], key: str):
    found = guess([read(f) for f in formulas])
    assert found is not None
    assert found[0] == key


@pytest.mark.parametrize(
    "formulas",
    [["E = m c^2"], ["A = B"], ["S = A^T S A + Q - A^T S B K"], [], ["x = 1"], ["K = P C^T V^{-1}", "L = L_f + A L_f"]],
)
def test_what_is_not_clear_is_not_guessed(formulas: list[str]):
    assert guess([read(f) for f in formulas]) is None


def test_the_reason_names_the_letters():
    found = guess([read("K = P C^T V^{-1}"), read("a + b = c")])
    assert found is not None
    assert found[1] == "1 of 2 formulas, with the letters K, P, C, V, can be read in this theory alone"


def test_a_guess_knows_a_notation():
    found = guess([read("K = P H^T V^{-1}")], {"H": "C"})
    assert found is not None
    assert found[0] == "kalman-bucy"
