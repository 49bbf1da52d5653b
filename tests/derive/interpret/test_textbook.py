"""A chapter on the discrete filter, typed as three books write it: the same letters of the theory behind each."""

from __future__ import annotations

import pytest

from tests.derive.interpret.reading import meant

DT = "luenberger-dt"
# by column: predictor and filter by signs; by conditions; in bold with a filtered P without mark
SIGNS = {"F": "A", "H": "C", "G": "B", "K": "L^f"}
CONDITIONS = {r"\Phi": "A", "H": "C", "G": "B", "K": "L_f", r"\Sigma": "P"}
BOLD = {"F": "A", "H": "C", "G": "B", "K": "L_f", "P": "P^+", r"\hat x": r"\hat x^+"}
CHAPTER = [
    (
        r"P_k^- = F P_{k-1}^+ F^T + Q",
        r"\Sigma_{k|k-1} = \Phi \Sigma_{k-1|k-1} \Phi' + Q",
        r"\mathbf P_k^- = \mathbf F \mathbf P_{k-1} \mathbf F^{\mathsf T} + \mathbf Q",
        ["P_k", "A", "P+_{k-1}", "Q"],
    ),
    (
        r"K_k = P_k^- H^T (H P_k^- H^T + R)^{-1}",
        r"K_k = \Sigma_{k|k-1} H' [H \Sigma_{k|k-1} H' + R]^{-1}",
        r"\mathbf K_k = \mathbf P_k^- \mathbf H^\top (\mathbf H \mathbf P_k^- \mathbf H^\top + \mathbf R)^{-1}",
        ["L^f_k", "P_k", "C", "R"],
    ),
    (
        r"P_k^+ = (I - K_k H) P_k^- (I - K_k H)^T + K_k R K_k^T",
        r"\Sigma_{k|k} = (I - K_k H) \Sigma_{k|k-1} (I - K_k H)' + K_k R K_k'",
        r"\mathbf P_k = (\mathbf I - \mathbf K_k \mathbf H) \mathbf P_k^- (\mathbf I - \mathbf K_k \mathbf H)^\top"
        r" + \mathbf K_k \mathbf R \mathbf K_k^\top",
        ["P+_k", "L^f_k", "C", "P_k", "R"],
    ),
    (
        r"\hat x_k^+ = \hat x_k^- + K_k (y_k - H \hat x_k^-)",
        r"\hat x_{k|k} = \hat x_{k|k-1} + K_k (y_k - H \hat x_{k|k-1})",
        r"\hat{\mathbf x}_k = \hat{\mathbf x}_k^- + \mathbf K_k (\mathbf y_k - \mathbf H \hat{\mathbf x}_k^-)",
        ["xhat+_k", "xhat_k", "L^f_k", "y_k", "C"],
    ),
    (
        r"\hat x_k^- = F \hat x_{k-1}^+ + G u_{k-1}",
        r"\hat x_{k|k-1} = \Phi \hat x_{k-1|k-1} + G u_{k-1}",
        r"\hat{\mathbf x}_k^- = \mathbf F \hat{\mathbf x}_{k-1} + \mathbf G \mathbf u_{k-1}",
        ["xhat_k", "A", "xhat+_{k-1}", "B", "u_{k-1}"],
    ),
    (
        r"(P_k^+)^{-1} = (P_k^-)^{-1} + H^T R^{-1} H",
        r"\Sigma_{k|k}^{-1} = \Sigma_{k|k-1}^{-1} + H' R^{-1} H",
        r"\mathbf P_k^{-1} = (\mathbf P_k^-)^{-1} + \mathbf H^\top \mathbf R^{-1} \mathbf H",
        ["P+_k", "P_k", "C", "R"],
    ),
]


@pytest.mark.parametrize(("signs", "conditions", "bold", "letters"), CHAPTER)
def test_three_notations_are_one_formula(signs: str, conditions: str, bold: str, letters: list[str]):
    found = [meant(DT, latex, notation=n) for latex, n in ((signs, SIGNS), (conditions, CONDITIONS), (bold, BOLD))]
    assert found[0].equations == found[1].equations == found[2].equations
    assert [s.name for s in found[0].symbols] == letters
