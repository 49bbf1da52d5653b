"""Claims on one step of the covariance in discrete time."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import inv, tr


def T(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, True, "luenberger-dt", sides, assume=assume)


def F(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, False, "luenberger-dt", sides, assume=assume)


ENTRIES = [
    T("L_k = A P_{k-1} C^T (C P_{k-1} C^T + R)^{-1}", lambda A, Pm, C, R, Lk: (Lk, A * Pm * C.T * inv(C * Pm * C.T + R))),
    F("L_k = P_{k-1} C^T (C P_{k-1} C^T + R)^{-1}", lambda Pm, C, R, Lk: (Lk, Pm * C.T * inv(C * Pm * C.T + R))),
    F("L_k = A P_k C^T (C P_k C^T + R)^{-1}", lambda A, Pk, C, R, Lk: (Lk, A * Pk * C.T * inv(C * Pk * C.T + R))),
    F("L_k = A P_{k-1} C^T (C P_k C^T + R)^{-1}", lambda A, Pm, Pk, C, R, Lk: (Lk, A * Pm * C.T * inv(C * Pk * C.T + R))),
    T("L_k R = (A - L_k C) P_{k-1} C^T", lambda A, Pm, C, R, Lk: (Lk * R, (A - Lk * C) * Pm * C.T)),
    T("P_k = Q + (A - L_k C) P_{k-1} (A - L_k C)^T + L_k R L_k^T", lambda A, Pm, Pk, C, Q, R, Lk: (Pk, Q + (A - Lk * C) * Pm * (A - Lk * C).T + Lk * R * Lk.T)),
    F("P_k = Q + (A - L_k C) P_{k-1} (A - L_k C)^T", lambda A, Pm, Pk, C, Q, Lk: (Pk, Q + (A - Lk * C) * Pm * (A - Lk * C).T)),
    F("P_k = Q + (A - L_k C) P_{k-1} (A - L_k C)^T - L_k R L_k^T", lambda A, Pm, Pk, C, Q, R, Lk: (Pk, Q + (A - Lk * C) * Pm * (A - Lk * C).T - Lk * R * Lk.T)),
    F("P_k = Q + (A - L_k C) P_k (A - L_k C)^T + L_k R L_k^T", lambda A, Pk, C, Q, R, Lk: (Pk, Q + (A - Lk * C) * Pk * (A - Lk * C).T + Lk * R * Lk.T)),
    F("P_{k-1} = Q + (A - L_k C) P_k (A - L_k C)^T + L_k R L_k^T", lambda A, Pm, Pk, C, Q, R, Lk: (Pm, Q + (A - Lk * C) * Pk * (A - Lk * C).T + Lk * R * Lk.T)),
    T("P_k = A P_{k-1} A^T + Q - A P_{k-1} C^T (C P_{k-1} C^T + R)^{-1} C P_{k-1} A^T", lambda A, Pm, Pk, C, Q, R: (Pk, A * Pm * A.T + Q - A * Pm * C.T * inv(C * Pm * C.T + R) * C * Pm * A.T)),
    F("P_k = A P_{k-1} A^T - Q - A P_{k-1} C^T (C P_{k-1} C^T + R)^{-1} C P_{k-1} A^T", lambda A, Pm, Pk, C, Q, R: (Pk, A * Pm * A.T - Q - A * Pm * C.T * inv(C * Pm * C.T + R) * C * Pm * A.T)),
    F("P_k = A P_{k-1} A^T + Q - A P_{k-1} C^T (C P_{k-1} C^T + R) C P_{k-1} A^T", lambda A, Pm, Pk, C, Q, R: (Pk, A * Pm * A.T + Q - A * Pm * C.T * (C * Pm * C.T + R) * C * Pm * A.T)),
    T("P_k = (A - L_k C) P_{k-1} A^T + Q", lambda A, Pm, Pk, C, Q, Lk: (Pk, (A - Lk * C) * Pm * A.T + Q)),
    F("P_k = (A - L_k C) P_{k-1} A + Q", lambda A, Pm, Pk, C, Q, Lk: (Pk, (A - Lk * C) * Pm * A + Q)),
    T("P_k = A P_{k-1} A^T + Q - L_k (C P_{k-1} C^T + R) L_k^T", lambda A, Pm, Pk, C, Q, R, Lk: (Pk, A * Pm * A.T + Q - Lk * (C * Pm * C.T + R) * Lk.T)),
    T("P_k = A (P_{k-1}^{-1} + C^T R^{-1} C)^{-1} A^T + Q", lambda A, Pm, Pk, C, Q, R: (Pk, A * inv(inv(Pm) + C.T * inv(R) * C) * A.T + Q), r"P_{k-1} \succ 0"),
    T(r"P_k \succeq 0", lambda Pk: (Pk, 0 * Pk)),
    T(r"P_k \succeq Q", lambda Pk, Q: (Pk, Q)),
    T(r"P_k \preceq A P_{k-1} A^T + Q", lambda A, Pm, Pk, Q: (Pk, A * Pm * A.T + Q)),
    F(r"P_k \preceq P_{k-1}", lambda Pk, Pm: (Pk, Pm)),
    F(r"P_k \succeq P_{k-1}", lambda Pk, Pm: (Pk, Pm)),
    T(r"C P_{k-1} C^T + R \succ 0", lambda C, Pm, R: (C * Pm * C.T + R, 0 * R)),
    F("P_k = P", lambda Pk, P: (Pk, P)),
    T(r"\operatorname{tr} P_k = \operatorname{tr} Q + \operatorname{tr}((A - L_k C) P_{k-1} A^T)", lambda A, Pm, Pk, C, Q, Lk: (tr(Pk), tr(Q) + tr((A - Lk * C) * Pm * A.T))),
]  # fmt: skip
