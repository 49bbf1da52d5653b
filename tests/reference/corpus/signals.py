"""Claims on signals and their second moments; true ones follow in a line from plant, observer and noise."""

from tests.reference.corpus import Entry

DT, CT = "luenberger-dt", "kalman-bucy"


def T(theory: str, latex: str, why: str) -> Entry:
    return Entry(latex, True, theory, why=why)


def F(theory: str, latex: str, why: str) -> Entry:
    return Entry(latex, False, theory, why=why)


ENTRIES = [
    T(DT, "x_k = A x_{k-1} + B u_{k-1} + w_{k-1}", "the plant"),
    F(DT, "x_k = A x_{k-1} + B u_{k-1} - w_{k-1}", "the sign of the noise"),
    T(DT, r"\hat{x}_k = A \hat{x}_{k-1} + B u_{k-1} + L_k (y_{k-1} - C \hat{x}_{k-1})", "the observer"),
    F(DT, r"\hat{x}_k = A \hat{x}_{k-1} + B u_{k-1} - L_k (y_{k-1} - C \hat{x}_{k-1})", "the sign of the correction"),
    T(DT, r"e_k = \hat{x}_k - x_k", "the convention of the source"),
    F(DT, r"e_k = x_k - \hat{x}_k", "the other convention"),
    T(DT, "e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} - w_{k-1}", "subtract"),
    F(DT, "e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} + w_{k-1}", "printed with the wrong sign"),
    F(DT, "e_k = (A - L_k C) e_{k-1} - L_k v_{k-1} - w_{k-1}", "the sign of v"),
    F(DT, "e_k = (A + L_k C) e_{k-1} + L_k v_{k-1} - w_{k-1}", "the sign of L C"),
    T(DT, "y_{k-1} = C x_{k-1} + v_{k-1}", "the output"),
    F(DT, "y_{k-1} = C x_{k-1}", "the noise is missing"),
    T(DT, r"\mathbb{E}[e_{k-1} w_{k-1}^T] = 0", "white noise"),
    T(DT, r"\mathbb{E}[e_{k-1} v_{k-1}^T] = 0", "white noise"),
    T(DT, r"\mathbb{E}[w_{k-1} v_{k-1}^T] = 0", "uncorrelated noises"),
    T(DT, r"\mathbb{E}[e_k e_k^T] = P_k", "the definition"),
    T(DT, r"\mathbb{E}[e_k e_k^T] = (A - L_k C) P_{k-1} (A - L_k C)^T + L_k R L_k^T + Q", "square the error recursion"),
    F(DT, r"\mathbb{E}[e_k e_k^T] = (A - L_k C) P_{k-1} (A - L_k C)^T + Q", "L R L' is dropped"),
    T(DT, r"\mathbb{E}[e_k e_{k-1}^T] = (A - L_k C) P_{k-1}", "the error recursion times e_{k-1}'"),
    F(DT, r"\mathbb{E}[e_k e_{k-1}^T] = A P_{k-1}", "the gain is missing"),
    T(DT, r"\mathbb{E}[e_k w_{k-1}^T] = -Q", "the error recursion times w'"),
    F(DT, r"\mathbb{E}[e_k w_{k-1}^T] = Q", "the sign of w in the error"),
    F(DT, r"\mathbb{E}[e_k w_{k-1}^T] = 0", "e_k contains w_{k-1}"),
    T(DT, r"\mathbb{E}[e_k v_{k-1}^T] = L_k R", "the error recursion times v'"),
    F(DT, r"\mathbb{E}[e_k v_{k-1}^T] = -L_k R", "the sign of v in the error"),
    T(CT, r"\dot{x} = A x + w", "the plant"),
    F(CT, r"\dot{x} = A x - w", "the sign of the noise"),
    T(CT, "y = C x + v", "the output"),
    T(CT, r"\dot{P} = A P + P A^T + W - P C^T V^{-1} C P", "the Riccati differential equation"),
    F(CT, r"\dot{P} = A P + P A^T + W + P C^T V^{-1} C P", "the sign of the quadratic term"),
    F(CT, r"\dot{P} = A P + P A^T - W - P C^T V^{-1} C P", "the sign of the noise"),
    F(CT, r"\dot{P} = A^T P + P A + W - P C^T V^{-1} C P", "the regulator's equation"),
]  # fmt: skip
