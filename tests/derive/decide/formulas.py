"""True formulas of the sources and of textbooks that have to be proved: LaTeX, theory, assumptions."""

from __future__ import annotations

from tests.derive.decide.reading import DT, KB

OBS, LQC, LQD = "observer-ct", "lqr-ct", "lqr-dt"
S = r"(C P C^T + R)^{-1}"
S_1 = r"(C P_{k-1} C^T + R)^{-1}"
H = r"(A - L_k C) P_{k-1} (A - L_k C)^T"
DEFINITE = (r"P \succ 0",)

SOURCES: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (r"\dot e = (A - L C) e + (B_d - L D_d) d - L D_r r", OBS, ()),
    (r"\dot P_e = A_e P_e + P_e A_e^T + \sigma_\xi^2", OBS, ()),
    (r"e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} - w_{k-1}", DT, ()),
    (r"Q_{k-1} = \mathbb{E}[w_{k-1} w_{k-1}^T]", DT, ()),
    (rf"P_k = Q + {H} + L_k R L_k^T", DT, ()),
    (r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 0", DT, ()),
    (rf"L_k = A P_{{k-1}} C^T {S_1}", DT, ()),
    (rf"P_k = A P_{{k-1}} A^T + Q - A P_{{k-1}} C^T {S_1} C P_{{k-1}} A^T", DT, ()),
    (rf"P = A P A^T + Q - A P C^T {S} C P A^T", DT, ()),
    (rf"L = A P C^T {S}", DT, ()),
    (r"K = P C^T V^{-1}", KB, ()),
    (r"A P + P A^T + W - P C^T V^{-1} C P = 0", KB, ()),
    (r"\dot P = A P + P A^T + W - P C^T V^{-1} C P", KB, ()),
    (r"\Phi_y(s) = C (s I - A)^{-1} W (-s I - A)^{-T} C^T + V", KB, ()),
    (r"\Phi_y(s) = (I + C (s I - A)^{-1} K) V (I + C (-s I - A)^{-1} K)^T", KB, ()),
    (r"(I + C (s I - A)^{-1} K)^{-1} = I - C (s I - A + K C)^{-1} K", KB, ()),
    (r"K = (B^T S B + R)^{-1} B^T S A", LQD, ()),
    (r"S = A^T S A + Q - A^T S B (B^T S B + R)^{-1} B^T S A", LQD, ()),
)

TEXTBOOK: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (r"P^+ = (I - L_f C) P (I - L_f C)^T + L_f R L_f^T", DT, ()),
    (r"P^+ = (I - L_f C) P", DT, ()),
    (r"P^+ = P - L_f (C P C^T + R) L_f^T", DT, ()),
    (r"(P^+)^{-1} = P^{-1} + C^T R^{-1} C", DT, DEFINITE),
    (r"P^+ = (P^{-1} + C^T R^{-1} C)^{-1}", DT, DEFINITE),
    (r"L_f = P^+ C^T R^{-1}", DT, ()),
    (r"L = A L_f", DT, ()),
    (r"P = A P^+ A^T + Q", DT, ()),
    (rf"{S} = R^{{-1}} - R^{{-1}} C (P^{{-1}} + C^T R^{{-1}} C)^{{-1}} C^T R^{{-1}}", DT, DEFINITE),
    (r"P C^T (C P C^T + R)^{-1} = (P^{-1} + C^T R^{-1} C)^{-1} C^T R^{-1}", DT, DEFINITE),
    (r"P (I + C^T R^{-1} C P)^{-1} = P - P C^T (C P C^T + R)^{-1} C P", DT, ()),
    (r"(I + P C^T R^{-1} C)^{-1} P = P (I + C^T R^{-1} C P)^{-1}", DT, ()),
    (r"A P (I + C^T R^{-1} C P)^{-1} A^T + Q = P", DT, ()),
    (r"A - L C = A (I + P C^T R^{-1} C)^{-1}", DT, ()),
    (r"(I - L_f C)^{-1} = I + P C^T R^{-1} C", DT, ()),
    (r"R (C P C^T + R)^{-1} = I - C L_f", DT, ()),
    (r"P = (A - L C) P (A - L C)^T + Q + L R L^T", DT, ()),
    (r"P = (A - L C) P A^T + Q", DT, ()),
    (r"\operatorname{tr} P = \operatorname{tr}(A P A^T) + \operatorname{tr} Q - \operatorname{tr}(L C P A^T)", DT, ()),
    (r"\mathbb{E}[e_k e_{k-1}^T] = (A - L_k C) P_{k-1}", DT, ()),
    (r"\mathbb{E}[e_k v_{k-1}^T] = L_k R", DT, ()),
    (r"\frac{\partial \operatorname{tr} P_k}{\partial L_k} = 2 L_k (C P_{k-1} C^T + R) - 2 A P_{k-1} C^T", DT, ()),
    (r"(A - K C) P + P (A - K C)^T + W + K V K^T = 0", KB, ()),
    (r"(A - K C) P + P A^T + W = 0", KB, ()),
    (r"P^{-1} A + A^T P^{-1} + P^{-1} W P^{-1} - C^T V^{-1} C = 0", KB, DEFINITE),
    (r"K V K^T = P C^T V^{-1} C P", KB, ()),
    (r"\operatorname{tr}(K C) = \operatorname{tr}(C P C^T V^{-1})", KB, ()),
    (r"2 \operatorname{tr}(A P) = \operatorname{tr}(K V K^T) - \operatorname{tr}(W)", KB, ()),
    (r"C (s I - A + K C)^{-1} = (I + C (s I - A)^{-1} K)^{-1} C (s I - A)^{-1}", KB, ()),
    (r"\dot P = (A - K C) P + P (A - K C)^T + W + K V K^T", KB, ()),
    (r"A^T S + S A + Q - S B R^{-1} B^T S = 0", LQC, ()),
    (r"(A - B K)^T S + S (A - B K) + Q + K^T R K = 0", LQC, ()),
    (r"A - B K = (I + B R^{-1} B^T S)^{-1} A", LQD, ()),
    (r"S = (A - B K)^T S (A - B K) + Q + K^T R K", LQD, ()),
)

ORDER: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (r"P_k \succeq 0", DT, ()),
    (r"P_k \preceq Q + A P_{k-1} A^T", DT, ()),
    (r"C P C^T + R \succ 0", DT, ()),
    (r"P^+ \preceq P", DT, ()),
    (r"P \succeq Q", DT, ()),
    (r"P \succeq L R L^T", DT, ()),
    (r"(C P C^T + R)^{-1} \preceq R^{-1}", DT, ()),
    (r"P \succ 0", DT, (r"Q \succ 0",)),
    (rf"{H} + Q + L_k R L_k^T \succeq Q + L_k R L_k^T", DT, ()),
    (r"Q + (A - G C) P_{k-1} (A - G C)^T + G R G^T \succeq P_k", DT, (r"G \in \mathbb{R}^{n \times l}",)),
    (r"\begin{bmatrix} P & P C^T \\ C P & C P C^T + R \end{bmatrix} \succeq 0", DT, ()),
    (r"\operatorname{tr} P_k \ge \operatorname{tr} Q", DT, ()),
    (r"\operatorname{tr}(P C^T R^{-1} C) \ge 0", DT, ()),
    (r"(A - K C) P + P (A - K C)^T \preceq 0", KB, ()),
    (r"\operatorname{tr}(K C) \ge 0", KB, ()),
)
