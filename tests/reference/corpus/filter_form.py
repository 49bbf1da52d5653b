"""Claims on the filter form in discrete time: P^+ after the measurement, L_f its gain."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import inv, tr


def T(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, True, "luenberger-dt", sides, assume=assume)


def F(latex: str, sides: Callable[..., Any], *assume: str) -> Entry:
    return Entry(latex, False, "luenberger-dt", sides, assume=assume)


ENTRIES = [
    T("L_f = P C^T (C P C^T + R)^{-1}", lambda P, C, R, Lf: (Lf, P * C.T * inv(C * P * C.T + R))),
    F("L_f = A P C^T (C P C^T + R)^{-1}", lambda A, P, C, R, Lf: (Lf, A * P * C.T * inv(C * P * C.T + R))),
    F("L_f = P^+ C^T (C P^+ C^T + R)^{-1}", lambda Pp, C, R, Lf: (Lf, Pp * C.T * inv(C * Pp * C.T + R))),
    T("L = A L_f", lambda A, L, Lf: (L, A * Lf)),
    F("L = L_f", lambda L, Lf: (L, Lf)),
    T("L_f = P^+ C^T R^{-1}", lambda Pp, C, R, Lf: (Lf, Pp * C.T * inv(R))),
    F("L_f = P C^T R^{-1}", lambda P, C, R, Lf: (Lf, P * C.T * inv(R))),
    T("L = A P^+ C^T R^{-1}", lambda A, Pp, C, R, L: (L, A * Pp * C.T * inv(R))),
    F("L = P^+ C^T R^{-1}", lambda Pp, C, R, L: (L, Pp * C.T * inv(R))),
    T("P^+ = P - P C^T (C P C^T + R)^{-1} C P", lambda P, C, R, Pp: (Pp, P - P * C.T * inv(C * P * C.T + R) * C * P)),
    F("P^+ = P + P C^T (C P C^T + R)^{-1} C P", lambda P, C, R, Pp: (Pp, P + P * C.T * inv(C * P * C.T + R) * C * P)),
    F("P^+ = P - A P C^T (C P C^T + R)^{-1} C P A^T", lambda A, P, C, R, Pp: (Pp, P - A * P * C.T * inv(C * P * C.T + R) * C * P * A.T)),
    T("P^+ = (I - L_f C) P", lambda P, C, Lf, Pp, I: (Pp, (I - Lf * C) * P)),
    F("P^+ = (I - L C) P", lambda P, C, L, Pp, I: (Pp, (I - L * C) * P)),
    F("P^+ = (I - L_f C) P^+", lambda C, Lf, Pp, I: (Pp, (I - Lf * C) * Pp)),
    T("P^+ = (I - L_f C) P (I - L_f C)^T + L_f R L_f^T", lambda P, C, R, Lf, Pp, I: (Pp, (I - Lf * C) * P * (I - Lf * C).T + Lf * R * Lf.T)),
    F("P^+ = (I - L_f C) P (I - L_f C)^T", lambda P, C, Lf, Pp, I: (Pp, (I - Lf * C) * P * (I - Lf * C).T)),
    F("P^+ = (I - L_f C) P (I - L_f C)^T - L_f R L_f^T", lambda P, C, R, Lf, Pp, I: (Pp, (I - Lf * C) * P * (I - Lf * C).T - Lf * R * Lf.T)),
    T("P = A P^+ A^T + Q", lambda A, P, Q, Pp: (P, A * Pp * A.T + Q)),
    F("P = A^T P^+ A + Q", lambda A, P, Q, Pp: (P, A.T * Pp * A + Q)),
    F("P = A P^+ A^T - Q", lambda A, P, Q, Pp: (P, A * Pp * A.T - Q)),
    F("P^+ = A P A^T + Q", lambda A, P, Q, Pp: (Pp, A * P * A.T + Q)),
    T("(P^+)^{-1} = P^{-1} + C^T R^{-1} C", lambda P, C, R, Pp: (inv(Pp), inv(P) + C.T * inv(R) * C), r"P \succ 0"),
    F("(P^+)^{-1} = P^{-1} - C^T R^{-1} C", lambda P, C, R, Pp: (inv(Pp), inv(P) - C.T * inv(R) * C), r"P \succ 0"),
    F("(P^+)^{-1} = P^{-1} + C^T R C", lambda P, C, R, Pp: (inv(Pp), inv(P) + C.T * R * C), r"P \succ 0"),
    T("R L_f^T = C P^+", lambda C, R, Lf, Pp: (R * Lf.T, C * Pp)),
    T("C P^+ C^T = R - R (C P C^T + R)^{-1} R", lambda C, P, R, Pp: (C * Pp * C.T, R - R * inv(C * P * C.T + R) * R)),
    T(r"P^+ \succeq 0", lambda Pp: (Pp, 0 * Pp)),
    T(r"P^+ \preceq P", lambda P, Pp: (Pp, P)),
    F(r"P \preceq P^+", lambda P, Pp: (P, Pp)),
    T(r"C P^+ C^T \preceq R", lambda C, R, Pp: (C * Pp * C.T, R)),
    F(r"P^+ \preceq Q", lambda Pp, Q: (Pp, Q)),
    T(r"\operatorname{tr}(P^+) = \operatorname{tr}(P) - \operatorname{tr}(L_f C P)", lambda P, C, Lf, Pp: (tr(Pp), tr(P) - tr(Lf * C * P))),
    F(r"\operatorname{tr}(P^+) = \operatorname{tr}(P) - \operatorname{tr}(L C P)", lambda P, C, L, Pp: (tr(Pp), tr(P) - tr(L * C * P))),
]  # fmt: skip
