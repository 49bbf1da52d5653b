"""Claims on the linear-quadratic regulator, u = -K x, in continuous and in discrete time."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import inv, tr

CT, DT = "lqr-ct", "lqr-dt"


def T(theory: str, latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, True, theory, sides, assume=assume)


def F(theory: str, latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, False, theory, sides, assume=assume)


ENTRIES = [
    T(CT, "K = R^{-1} B^T S", lambda B, R, S, K: (K, inv(R) * B.T * S)),
    F(CT, "K = B^T S", lambda B, S, K: (K, B.T * S)),
    F(CT, "K = R B^T S", lambda B, R, S, K: (K, R * B.T * S)),
    F(CT, "K = - R^{-1} B^T S", lambda B, R, S, K: (K, -inv(R) * B.T * S)),
    T(CT, "R K = B^T S", lambda B, R, S, K: (R * K, B.T * S)),
    T(CT, "A^T S + S A + Q - S B R^{-1} B^T S = 0", lambda A, B, Q, R, S: (A.T * S + S * A + Q - S * B * inv(R) * B.T * S, 0 * S)),
    F(CT, "A S + S A^T + Q - S B R^{-1} B^T S = 0", lambda A, B, Q, R, S: (A * S + S * A.T + Q - S * B * inv(R) * B.T * S, 0 * S)),
    F(CT, "A^T S + S A + Q + S B R^{-1} B^T S = 0", lambda A, B, Q, R, S: (A.T * S + S * A + Q + S * B * inv(R) * B.T * S, 0 * S)),
    F(CT, "A^T S + S A + Q - S B R B^T S = 0", lambda A, B, Q, R, S: (A.T * S + S * A + Q - S * B * R * B.T * S, 0 * S)),
    T(CT, "A^T S + S A + Q - K^T R K = 0", lambda A, Q, R, S, K: (A.T * S + S * A + Q - K.T * R * K, 0 * S)),
    T(CT, "(A - B K)^T S + S (A - B K) + Q + K^T R K = 0", lambda A, B, Q, R, S, K: ((A - B * K).T * S + S * (A - B * K) + Q + K.T * R * K, 0 * S)),
    F(CT, "(A - B K)^T S + S (A - B K) + Q = 0", lambda A, B, Q, S, K: ((A - B * K).T * S + S * (A - B * K) + Q, 0 * S)),
    F(CT, "(A - B K)^T S + S (A - B K) + Q - K^T R K = 0", lambda A, B, Q, R, S, K: ((A - B * K).T * S + S * (A - B * K) + Q - K.T * R * K, 0 * S)),
    F(CT, "(A + B K)^T S + S (A + B K) + Q + K^T R K = 0", lambda A, B, Q, R, S, K: ((A + B * K).T * S + S * (A + B * K) + Q + K.T * R * K, 0 * S)),
    T(CT, "A^T S + S (A - B K) + Q = 0", lambda A, B, Q, S, K: (A.T * S + S * (A - B * K) + Q, 0 * S)),
    T(CT, "S B K = K^T R K", lambda B, R, S, K: (S * B * K, K.T * R * K)),
    F(CT, "S B K = K^T K", lambda B, S, K: (S * B * K, K.T * K)),
    T(CT, r"S \succeq 0", lambda S: (S, 0 * S)),
    F(CT, r"S \succeq Q", lambda S, Q: (S, Q)),
    T(CT, r"A^T S + S A + Q \succeq 0", lambda A, Q, S: (A.T * S + S * A + Q, 0 * S)),
    T(CT, r"\operatorname{tr}(B K) = \operatorname{tr}(R^{-1} B^T S B)", lambda B, R, S, K: (tr(B * K), tr(inv(R) * B.T * S * B))),
    T(DT, "K = (B^T S B + R)^{-1} B^T S A", lambda A, B, R, S, K: (K, inv(B.T * S * B + R) * B.T * S * A)),
    F(DT, "K = (B^T S B - R)^{-1} B^T S A", lambda A, B, R, S, K: (K, inv(B.T * S * B - R) * B.T * S * A)),
    F(DT, "K = R^{-1} B^T S A", lambda A, B, R, S, K: (K, inv(R) * B.T * S * A)),
    F(DT, "K = (B^T S B + R)^{-1} B^T S", lambda B, R, S, K: (K, inv(B.T * S * B + R) * B.T * S)),
    F(DT, "K = (B^T S B + R)^{-1} B^T S A^T", lambda A, B, R, S, K: (K, inv(B.T * S * B + R) * B.T * S * A.T)),
    T(DT, "(B^T S B + R) K = B^T S A", lambda A, B, R, S, K: ((B.T * S * B + R) * K, B.T * S * A)),
    T(DT, "R K = B^T S (A - B K)", lambda A, B, R, S, K: (R * K, B.T * S * (A - B * K))),
    T(DT, "S = A^T S A + Q - A^T S B (B^T S B + R)^{-1} B^T S A", lambda A, B, Q, R, S: (S, A.T * S * A + Q - A.T * S * B * inv(B.T * S * B + R) * B.T * S * A)),
    F(DT, "S = A S A^T + Q - A S B (B^T S B + R)^{-1} B^T S A^T", lambda A, B, Q, R, S: (S, A * S * A.T + Q - A * S * B * inv(B.T * S * B + R) * B.T * S * A.T)),
    F(DT, "S = A^T S A + Q + A^T S B (B^T S B + R)^{-1} B^T S A", lambda A, B, Q, R, S: (S, A.T * S * A + Q + A.T * S * B * inv(B.T * S * B + R) * B.T * S * A)),
    F(DT, "S = A^T S A - Q - A^T S B (B^T S B + R)^{-1} B^T S A", lambda A, B, Q, R, S: (S, A.T * S * A - Q - A.T * S * B * inv(B.T * S * B + R) * B.T * S * A)),
    T(DT, "S = A^T S (A - B K) + Q", lambda A, B, Q, S, K: (S, A.T * S * (A - B * K) + Q)),
    F(DT, "S = A S (A - B K) + Q", lambda A, B, Q, S, K: (S, A * S * (A - B * K) + Q)),
    T(DT, "S = (A - B K)^T S (A - B K) + Q + K^T R K", lambda A, B, Q, R, S, K: (S, (A - B * K).T * S * (A - B * K) + Q + K.T * R * K)),
    F(DT, "S = (A - B K)^T S (A - B K) + Q", lambda A, B, Q, S, K: (S, (A - B * K).T * S * (A - B * K) + Q)),
    F(DT, "S = (A - B K) S (A - B K)^T + Q + K^T R K", lambda A, B, Q, R, S, K: (S, (A - B * K) * S * (A - B * K).T + Q + K.T * R * K)),
    T(DT, "S = A^T S (I + B R^{-1} B^T S)^{-1} A + Q", lambda A, B, Q, R, S, I: (S, A.T * S * inv(I + B * inv(R) * B.T * S) * A + Q)),
    T(DT, "A - B K = (I + B R^{-1} B^T S)^{-1} A", lambda A, B, R, S, K, I: (A - B * K, inv(I + B * inv(R) * B.T * S) * A)),
    F(DT, "A - B K = A (I + B R^{-1} B^T S)^{-1}", lambda A, B, R, S, K, I: (A - B * K, A * inv(I + B * inv(R) * B.T * S))),
    T(DT, r"S \succeq Q", lambda S, Q: (S, Q)),
    F(DT, r"S \preceq Q", lambda S, Q: (S, Q)),
    T(DT, r"S \preceq A^T S A + Q", lambda A, S, Q: (S, A.T * S * A + Q)),
    T(DT, r"B^T S B + R \succ 0", lambda B, S, R: (B.T * S * B + R, 0 * R)),
]  # fmt: skip
