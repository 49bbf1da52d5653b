"""Claims on the Kalman-Bucy filter, steady."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import inv, tr


def T(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, True, "kalman-bucy", sides, assume=assume)


def F(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, False, "kalman-bucy", sides, assume=assume)


ENTRIES = [
    T("K = P C^T V^{-1}", lambda P, C, V, K: (K, P * C.T * inv(V))),
    F("K = P C^T V", lambda P, C, V, K: (K, P * C.T * V)),
    F("K = P C^T", lambda P, C, K: (K, P * C.T)),
    F("K = - P C^T V^{-1}", lambda P, C, V, K: (K, -P * C.T * inv(V))),
    F("K = 2 P C^T V^{-1}", lambda P, C, V, K: (K, 2 * P * C.T * inv(V))),
    F("K = A P C^T V^{-1}", lambda A, P, C, V, K: (K, A * P * C.T * inv(V))),
    F("K = P C^T (C P C^T + V)^{-1}", lambda P, C, V, K: (K, P * C.T * inv(C * P * C.T + V))),
    T("K V = P C^T", lambda P, C, V, K: (K * V, P * C.T)),
    T("V K^T = C P", lambda P, C, V, K: (V * K.T, C * P)),
    T("K V K^T = P C^T V^{-1} C P", lambda P, C, V, K: (K * V * K.T, P * C.T * inv(V) * C * P)),
    F("K V K^T = P C^T V C P", lambda P, C, V, K: (K * V * K.T, P * C.T * V * C * P)),
    T("K C P = K V K^T", lambda P, C, V, K: (K * C * P, K * V * K.T)),
    T("A P + P A^T + W - P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (A * P + P * A.T + W - P * C.T * inv(V) * C * P, 0 * P)),
    F("A P + P A^T + W + P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (A * P + P * A.T + W + P * C.T * inv(V) * C * P, 0 * P)),
    F("A P + P A^T + W - P C^T V C P = 0", lambda A, P, C, V, W: (A * P + P * A.T + W - P * C.T * V * C * P, 0 * P)),
    F("A^T P + P A + W - P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (A.T * P + P * A + W - P * C.T * inv(V) * C * P, 0 * P)),
    F("A P + P A^T - W - P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (A * P + P * A.T - W - P * C.T * inv(V) * C * P, 0 * P)),
    F("A P + P A^T + W - P C^T C P = 0", lambda A, P, C, W: (A * P + P * A.T + W - P * C.T * C * P, 0 * P)),
    F("A P + P A + W - P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (A * P + P * A + W - P * C.T * inv(V) * C * P, 0 * P)),
    F("2 A P + W - P C^T V^{-1} C P = 0", lambda A, P, C, V, W: (2 * A * P + W - P * C.T * inv(V) * C * P, 0 * P)),
    T("A P + P A^T + W - K V K^T = 0", lambda A, P, V, W, K: (A * P + P * A.T + W - K * V * K.T, 0 * P)),
    F("A P + P A^T + W + K V K^T = 0", lambda A, P, V, W, K: (A * P + P * A.T + W + K * V * K.T, 0 * P)),
    T("(A - K C) P + P (A - K C)^T + W + K V K^T = 0", lambda A, P, C, V, W, K: ((A - K * C) * P + P * (A - K * C).T + W + K * V * K.T, 0 * P)),
    F("(A - K C) P + P (A - K C)^T + W = 0", lambda A, P, C, W, K: ((A - K * C) * P + P * (A - K * C).T + W, 0 * P)),
    F("(A - K C) P + P (A - K C)^T + W - K V K^T = 0", lambda A, P, C, V, W, K: ((A - K * C) * P + P * (A - K * C).T + W - K * V * K.T, 0 * P)),
    F("(A + K C) P + P (A + K C)^T + W + K V K^T = 0", lambda A, P, C, V, W, K: ((A + K * C) * P + P * (A + K * C).T + W + K * V * K.T, 0 * P)),
    F("(A - K C)^T P + P (A - K C) + W + K V K^T = 0", lambda A, P, C, V, W, K: ((A - K * C).T * P + P * (A - K * C) + W + K * V * K.T, 0 * P)),
    T("(A - K C) P + P A^T + W = 0", lambda A, P, C, W, K: ((A - K * C) * P + P * A.T + W, 0 * P)),
    T("A P + P (A - K C)^T = - W", lambda A, P, C, W, K: (A * P + P * (A - K * C).T, -W)),
    T("K C P = P C^T K^T", lambda P, C, K: (K * C * P, P * C.T * K.T)),
    F("K C P = C^T K^T P", lambda P, C, K: (K * C * P, C.T * K.T * P)),
    T("K C = P C^T V^{-1} C", lambda P, C, V, K: (K * C, P * C.T * inv(V) * C)),
    T("C K V = C P C^T", lambda P, C, V, K: (C * K * V, C * P * C.T)),
    T("C K = C P C^T V^{-1}", lambda P, C, V, K: (C * K, C * P * C.T * inv(V))),
    F("C K = V^{-1} C P C^T", lambda P, C, V, K: (C * K, inv(V) * C * P * C.T)),
    T("P^{-1} A + A^T P^{-1} + P^{-1} W P^{-1} - C^T V^{-1} C = 0", lambda A, P, C, V, W: (inv(P) * A + A.T * inv(P) + inv(P) * W * inv(P) - C.T * inv(V) * C, 0 * P), r"P \succ 0"),
    F("P^{-1} A + A^T P^{-1} - P^{-1} W P^{-1} - C^T V^{-1} C = 0", lambda A, P, C, V, W: (inv(P) * A + A.T * inv(P) - inv(P) * W * inv(P) - C.T * inv(V) * C, 0 * P), r"P \succ 0"),
    T(r"\operatorname{tr}(K C) = \operatorname{tr}(C P C^T V^{-1})", lambda P, C, V, K: (tr(K * C), tr(C * P * C.T * inv(V)))),
    F(r"\operatorname{tr}(K C) = \operatorname{tr}(C P C^T V)", lambda P, C, V, K: (tr(K * C), tr(C * P * C.T * V))),
    T(r"2 \operatorname{tr}(A P) = \operatorname{tr}(K V K^T) - \operatorname{tr}(W)", lambda A, P, V, W, K: (2 * tr(A * P), tr(K * V * K.T) - tr(W))),
    F(r"\operatorname{tr}(A P) = \operatorname{tr}(K V K^T) - \operatorname{tr}(W)", lambda A, P, V, W, K: (tr(A * P), tr(K * V * K.T) - tr(W))),
    T(r"\operatorname{tr}(A - K C) = \operatorname{tr}(A) - \operatorname{tr}(C P C^T V^{-1})", lambda A, P, C, V, K: (tr(A - K * C), tr(A) - tr(C * P * C.T * inv(V)))),
    T(r"P \succeq 0", lambda P: (P, 0 * P)),
    Entry(r"P \succ 0", False, "kalman-bucy", why="A stable and W = 0: P = 0"),
    F(r"P \succeq W", lambda P, W: (P, W)),
    T(r"K V K^T \succeq 0", lambda K, V: (K * V * K.T, 0 * K * K.T)),
    T(r"A P + P A^T + W \succeq 0", lambda A, P, W: (A * P + P * A.T + W, 0 * P)),
    F(r"A P + P A^T \succeq 0", lambda A, P: (A * P + P * A.T, 0 * P)),
    T(r"(A - K C) P + P (A - K C)^T \preceq 0", lambda A, P, C, K: ((A - K * C) * P + P * (A - K * C).T, 0 * P)),
    F(r"A P + P A^T \preceq 0", lambda A, P: (A * P + P * A.T, 0 * P)),
    T(r"C P C^T + V \succ 0", lambda C, P, V: (C * P * C.T + V, 0 * V)),
    T(r"(C P C^T + V)^{-1} \preceq V^{-1}", lambda C, P, V: (inv(C * P * C.T + V), inv(V))),
    F("A - K C = A (I + P C^T V^{-1} C)^{-1}", lambda A, P, C, V, K, I: (A - K * C, A * inv(I + P * C.T * inv(V) * C))),
    F("W = P", lambda W, P: (W, P)),
    Entry("K = P C^T", True, "kalman-bucy", why="K = P C' V^-1 with V = I", assume=("V = I",)),
    Entry("A P + P A^T + W - P C^T C P = 0", True, "kalman-bucy", why="the Riccati equation", assume=("V = I",)),
]  # fmt: skip
