"""A script belongs to what stands right before it, also where brackets look like arguments of a letter."""

import pytest

from derive.claim import Verdict
from derive.decide import decide
from derive.interpret import understand
from derive.latex.grammar import read
from derive.theory.claims import claim_theory


@pytest.mark.parametrize(
    ("latex", "meaning"),
    [
        (r"W = V^{-1}(s-1)", "1/V (s - 1)"),
        (r"W = V(s-1)^{-1}", "V 1/(s - 1)"),
        (r"W = V(1-2)^2", "V (1 - 2)^2"),
        (r"W = V^2(1-2)", "V^2 (1 - 2)"),
    ],
)
def test_scripts_stay_with_their_factor(latex: str, meaning: str) -> None:
    claim = understand(read(latex), claim_theory("kalman-bucy"), scalar=True)
    assert str(claim.equations[0].rhs) == meaning


@pytest.mark.parametrize(("latex", "verdict"), [(r"V(1-2)^2 = V", "proved"), (r"V(1-2)^2 = V^2", "refuted")])
def test_a_square_of_brackets_is_no_square_of_the_product(latex: str, verdict: str) -> None:
    claim = understand(read(latex), claim_theory("kalman-bucy"), scalar=True)
    assert decide(claim).verdict is Verdict(verdict)
