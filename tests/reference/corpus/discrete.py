"""Claims on the observer in discrete time, predictor form, steady."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import inv, tr


def T(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, True, "luenberger-dt", sides, assume=assume)


def F(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, False, "luenberger-dt", sides, assume=assume)


ENTRIES = [
    # the gain
    T("L = A P C^T (C P C^T + R)^{-1}", lambda A, P, C, R, L: (L, A * P * C.T * inv(C * P * C.T + R))),
    F("L = P C^T (C P C^T + R)^{-1}", lambda P, C, R, L: (L, P * C.T * inv(C * P * C.T + R))),
    F("L = A P C^T (C P C^T - R)^{-1}", lambda A, P, C, R, L: (L, A * P * C.T * inv(C * P * C.T - R))),
    F("L = A P C^T (C P C^T + 2 R)^{-1}", lambda A, P, C, R, L: (L, A * P * C.T * inv(C * P * C.T + 2 * R))),
    F("L = A^T P C^T (C P C^T + R)^{-1}", lambda A, P, C, R, L: (L, A.T * P * C.T * inv(C * P * C.T + R))),
    F("L = A P C^T R^{-1}", lambda A, P, C, R, L: (L, A * P * C.T * inv(R))),
    F("L = A P C^T (C P C^T)^{-1}", lambda A, P, C, L: (L, A * P * C.T * inv(C * P * C.T))),
    F("L = A Q C^T (C Q C^T + R)^{-1}", lambda A, Q, C, R, L: (L, A * Q * C.T * inv(C * Q * C.T + R))),
    T("L (C P C^T + R) = A P C^T", lambda A, P, C, R, L: (L * (C * P * C.T + R), A * P * C.T)),
    T("(C P C^T + R) L^T = C P A^T", lambda A, P, C, R, L: ((C * P * C.T + R) * L.T, C * P * A.T)),
    F("(C P C^T + R) L^T = C P A", lambda A, P, C, R, L: ((C * P * C.T + R) * L.T, C * P * A)),
    T("L R = (A - L C) P C^T", lambda A, P, C, R, L: (L * R, (A - L * C) * P * C.T)),
    F("L R = (A + L C) P C^T", lambda A, P, C, R, L: (L * R, (A + L * C) * P * C.T)),
    T("L = (A - L C) P C^T R^{-1}", lambda A, P, C, R, L: (L, (A - L * C) * P * C.T * inv(R))),
    T("L = A (I + P C^T R^{-1} C)^{-1} P C^T R^{-1}", lambda A, P, C, R, L, I: (L, A * inv(I + P * C.T * inv(R) * C) * P * C.T * inv(R))),
    F("L = (I + P C^T R^{-1} C)^{-1} P C^T R^{-1}", lambda P, C, R, L, I: (L, inv(I + P * C.T * inv(R) * C) * P * C.T * inv(R))),
    # the Riccati equation
    T("P = A P A^T + Q - A P C^T (C P C^T + R)^{-1} C P A^T", lambda A, P, C, Q, R: (P, A * P * A.T + Q - A * P * C.T * inv(C * P * C.T + R) * C * P * A.T)),
    F("P = A P A^T + Q + A P C^T (C P C^T + R)^{-1} C P A^T", lambda A, P, C, Q, R: (P, A * P * A.T + Q + A * P * C.T * inv(C * P * C.T + R) * C * P * A.T)),
    F("P = A^T P A + Q - A P C^T (C P C^T + R)^{-1} C P A^T", lambda A, P, C, Q, R: (P, A.T * P * A + Q - A * P * C.T * inv(C * P * C.T + R) * C * P * A.T)),
    F("P = A P A^T - Q - A P C^T (C P C^T + R)^{-1} C P A^T", lambda A, P, C, Q, R: (P, A * P * A.T - Q - A * P * C.T * inv(C * P * C.T + R) * C * P * A.T)),
    F("P = A P A^T + Q - P C^T (C P C^T + R)^{-1} C P", lambda A, P, C, Q, R: (P, A * P * A.T + Q - P * C.T * inv(C * P * C.T + R) * C * P)),
    F("P = A P A^T + Q - A P C^T (C P C^T)^{-1} C P A^T", lambda A, P, C, Q: (P, A * P * A.T + Q - A * P * C.T * inv(C * P * C.T) * C * P * A.T)),
    F("P = A P A^T + Q - A P C^T R^{-1} C P A^T", lambda A, P, C, Q, R: (P, A * P * A.T + Q - A * P * C.T * inv(R) * C * P * A.T)),
    T("P = (A - L C) P (A - L C)^T + Q + L R L^T", lambda A, P, C, Q, R, L: (P, (A - L * C) * P * (A - L * C).T + Q + L * R * L.T)),
    F("P = (A - L C) P (A - L C)^T + Q", lambda A, P, C, Q, L: (P, (A - L * C) * P * (A - L * C).T + Q)),
    F("P = (A - L C) P (A - L C)^T + Q - L R L^T", lambda A, P, C, Q, R, L: (P, (A - L * C) * P * (A - L * C).T + Q - L * R * L.T)),
    F("P = (A - L C)^T P (A - L C) + Q + L R L^T", lambda A, P, C, Q, R, L: (P, (A - L * C).T * P * (A - L * C) + Q + L * R * L.T)),
    F("P = (A + L C) P (A + L C)^T + Q + L R L^T", lambda A, P, C, Q, R, L: (P, (A + L * C) * P * (A + L * C).T + Q + L * R * L.T)),
    T("P = (A - L C) P A^T + Q", lambda A, P, C, Q, L: (P, (A - L * C) * P * A.T + Q)),
    F("P = (A - L C) P A^T + Q + L R L^T", lambda A, P, C, Q, R, L: (P, (A - L * C) * P * A.T + Q + L * R * L.T)),
    T("P = A P (A - L C)^T + Q", lambda A, P, C, Q, L: (P, A * P * (A - L * C).T + Q)),
    T("P = A P A^T + Q - L (C P C^T + R) L^T", lambda A, P, C, Q, R, L: (P, A * P * A.T + Q - L * (C * P * C.T + R) * L.T)),
    F("P = A P A^T + Q + L (C P C^T + R) L^T", lambda A, P, C, Q, R, L: (P, A * P * A.T + Q + L * (C * P * C.T + R) * L.T)),
    F("P = A P A^T + Q - L R L^T", lambda A, P, Q, R, L: (P, A * P * A.T + Q - L * R * L.T)),
    T("P = A P A^T + Q - L C P A^T", lambda A, P, C, Q, L: (P, A * P * A.T + Q - L * C * P * A.T)),
    T("P = A (I + P C^T R^{-1} C)^{-1} P A^T + Q", lambda A, P, C, Q, R, I: (P, A * inv(I + P * C.T * inv(R) * C) * P * A.T + Q)),
    T("P = A P (I + C^T R^{-1} C P)^{-1} A^T + Q", lambda A, P, C, Q, R, I: (P, A * P * inv(I + C.T * inv(R) * C * P) * A.T + Q)),
    F("P = A P (I + P C^T R^{-1} C)^{-1} A^T + Q", lambda A, P, C, Q, R, I: (P, A * P * inv(I + P * C.T * inv(R) * C) * A.T + Q)),
    F("P = A P (I - C^T R^{-1} C P)^{-1} A^T + Q", lambda A, P, C, Q, R, I: (P, A * P * inv(I - C.T * inv(R) * C * P) * A.T + Q)),
    T("P = A (P^{-1} + C^T R^{-1} C)^{-1} A^T + Q", lambda A, P, C, Q, R: (P, A * inv(inv(P) + C.T * inv(R) * C) * A.T + Q), r"P \succ 0"),
    F("P = A (P^{-1} + C^T R C)^{-1} A^T + Q", lambda A, P, C, Q, R: (P, A * inv(inv(P) + C.T * R * C) * A.T + Q), r"P \succ 0"),
    # the error matrix
    T("A - L C = A (I - P C^T (C P C^T + R)^{-1} C)", lambda A, P, C, R, L, I: (A - L * C, A * (I - P * C.T * inv(C * P * C.T + R) * C))),
    T("A - L C = A (I + P C^T R^{-1} C)^{-1}", lambda A, P, C, R, L, I: (A - L * C, A * inv(I + P * C.T * inv(R) * C))),
    F("A - L C = A (I + C^T R^{-1} C P)^{-1}", lambda A, P, C, R, L, I: (A - L * C, A * inv(I + C.T * inv(R) * C * P))),
    F("A - L C = (I + P C^T R^{-1} C)^{-1} A", lambda A, P, C, R, L, I: (A - L * C, inv(I + P * C.T * inv(R) * C) * A)),
    # identities for every matrix
    T("(C P C^T + R)^{-1} = R^{-1} - R^{-1} C (P^{-1} + C^T R^{-1} C)^{-1} C^T R^{-1}", lambda P, C, R: (inv(C * P * C.T + R), inv(R) - inv(R) * C * inv(inv(P) + C.T * inv(R) * C) * C.T * inv(R)), r"P \succ 0"),
    F("(C P C^T + R)^{-1} = R^{-1} + R^{-1} C (P^{-1} + C^T R^{-1} C)^{-1} C^T R^{-1}", lambda P, C, R: (inv(C * P * C.T + R), inv(R) + inv(R) * C * inv(inv(P) + C.T * inv(R) * C) * C.T * inv(R)), r"P \succ 0"),
    T("P C^T (C P C^T + R)^{-1} = (P^{-1} + C^T R^{-1} C)^{-1} C^T R^{-1}", lambda P, C, R: (P * C.T * inv(C * P * C.T + R), inv(inv(P) + C.T * inv(R) * C) * C.T * inv(R)), r"P \succ 0"),
    T("(A B)^T = B^T A^T", lambda A, B: ((A * B).T, B.T * A.T)),
    F("P A = A P", lambda A, P: (P * A, A * P)),
    F("Q P = P Q", lambda Q, P: (Q * P, P * Q)),
    T("(A P A^T)^T = A P A^T", lambda A, P: ((A * P * A.T).T, A * P * A.T)),
    # traces
    T(r"\operatorname{tr}(P) = \operatorname{tr}(A P A^T) + \operatorname{tr}(Q) - \operatorname{tr}(L (C P C^T + R) L^T)", lambda A, P, C, Q, R, L: (tr(P), tr(A * P * A.T) + tr(Q) - tr(L * (C * P * C.T + R) * L.T))),
    F(r"\operatorname{tr}(P) = \operatorname{tr}(A P A^T) + \operatorname{tr}(Q)", lambda A, P, Q: (tr(P), tr(A * P * A.T) + tr(Q))),
    T(r"\operatorname{tr}(P) = \operatorname{tr}(Q) + \operatorname{tr}((A - L C) P A^T)", lambda A, P, C, Q, L: (tr(P), tr(Q) + tr((A - L * C) * P * A.T))),
    T(r"\operatorname{tr}(L C P) = \operatorname{tr}(C P L)", lambda C, P, L: (tr(L * C * P), tr(C * P * L))),
    F(r"\operatorname{tr}(A P Q) = \operatorname{tr}(P A Q)", lambda A, P, Q: (tr(A * P * Q), tr(P * A * Q))),
    T(r"\operatorname{tr}(A P Q) = \operatorname{tr}(Q P A^T)", lambda A, P, Q: (tr(A * P * Q), tr(Q * P * A.T))),
    # the Loewner order
    T(r"P \succeq 0", lambda P: (P, 0 * P)),
    T(r"P \succeq Q", lambda P, Q: (P, Q)),
    F(r"Q \succeq P", lambda P, Q: (Q, P)),
    T(r"P \preceq A P A^T + Q", lambda A, P, Q: (P, A * P * A.T + Q)),
    F(r"P \succeq A P A^T", lambda A, P: (P, A * P * A.T)),
    T(r"C P C^T + R \succ 0", lambda C, P, R: (C * P * C.T + R, 0 * R)),
    T(r"C P C^T + R \succeq R", lambda C, P, R: (C * P * C.T + R, R)),
    F(r"C P C^T \succeq R", lambda C, P, R: (C * P * C.T, R)),
    T(r"P \succeq L R L^T", lambda P, L, R: (P, L * R * L.T)),
    T(r"P \succeq Q + L R L^T", lambda P, Q, L, R: (P, Q + L * R * L.T)),
    F(r"P \preceq Q + L R L^T", lambda P, Q, L, R: (P, Q + L * R * L.T)),
    T(r"(C P C^T + R)^{-1} \preceq R^{-1}", lambda C, P, R: (inv(C * P * C.T + R), inv(R))),
    F(r"(C P C^T + R)^{-1} \succeq R^{-1}", lambda C, P, R: (inv(C * P * C.T + R), inv(R))),
    Entry(r"P \succ 0", False, "luenberger-dt", why="A stable and Q = 0: P = 0"),
    T(r"P \succ 0", lambda P: (P, 0 * P), r"Q \succ 0"),
]  # fmt: skip
