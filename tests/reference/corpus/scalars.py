"""Claims on scalar plants, where letters commute: roots, bounds, limits, and where they are defined."""

from collections.abc import Callable
from typing import Any

from tests.reference.corpus import Entry
from tests.reference.corpus.plants import larger, sqrt

KB, DT, CT, RD = "kalman-bucy", "luenberger-dt", "lqr-ct", "lqr-dt"


def T(theory: str, latex: str, sides: Callable[..., Any] | None, *assume: str, why: str = "") -> Entry:
    return Entry(latex, True, theory, sides, why, assume, scalar=True)


def F(theory: str, latex: str, sides: Callable[..., Any] | None = None, *assume: str, why: str = "") -> Entry:
    return Entry(latex, False, theory, sides, why, assume, scalar=True)


C0 = r"C \neq 0"
ENTRIES = [
    # continuous time: the root and its forms
    T(KB, r"P = \frac{A V + \sqrt{A^2 V^2 + C^2 V W}}{C^2}", lambda A, C, V, W, P: (P, (A * V + sqrt(A**2 * V**2 + C**2 * V * W)) / C**2), C0),
    F(KB, r"P = \frac{A V - \sqrt{A^2 V^2 + C^2 V W}}{C^2}", lambda A, C, V, W, P: (P, (A * V - sqrt(A**2 * V**2 + C**2 * V * W)) / C**2), C0),
    F(KB, r"P = \frac{-A V + \sqrt{A^2 V^2 + C^2 V W}}{C^2}", lambda A, C, V, W, P: (P, (-A * V + sqrt(A**2 * V**2 + C**2 * V * W)) / C**2), C0),
    F(KB, r"P = \frac{A V + \sqrt{A^2 V^2 + C^2 V W}}{2 C^2}", lambda A, C, V, W, P: (P, (A * V + sqrt(A**2 * V**2 + C**2 * V * W)) / (2 * C**2)), C0),
    F(KB, r"P = \frac{A V + \sqrt{A^2 V^2 + 4 C^2 V W}}{C^2}", lambda A, C, V, W, P: (P, (A * V + sqrt(A**2 * V**2 + 4 * C**2 * V * W)) / C**2), C0),
    F(KB, r"P = \frac{A V + \sqrt{A^2 V^2 + C^2 V W}}{C}", lambda A, C, V, W, P: (P, (A * V + sqrt(A**2 * V**2 + C**2 * V * W)) / C), C0),
    F(KB, r"P = \frac{A V + \sqrt{A^2 V^2 + C^2 V W}}{C^2}", None, why="C = 0 is allowed with A < 0, and there the formula divides by zero"),
    T(KB, r"P = \frac{V}{C^2} \left( A + \sqrt{A^2 + C^2 W / V} \right)", lambda A, C, V, W, P: (P, V / C**2 * (A + sqrt(A**2 + C**2 * W / V))), C0),
    F(KB, r"P = \frac{1}{C^2} \left( A + \sqrt{A^2 + C^2 W / V} \right)", lambda A, C, V, W, P: (P, 1 / C**2 * (A + sqrt(A**2 + C**2 * W / V))), C0),
    T(KB, r"P = \frac{V}{C^2} \left( \sqrt{A^2 + C^2 W / V} - |A| + 2 \max\{0, A\} \right)", lambda A, C, V, W, P: (P, V / C**2 * (sqrt(A**2 + C**2 * W / V) - abs(A) + 2 * larger(0, A))), C0),
    F(KB, r"P = \frac{V}{C^2} \left( \sqrt{A^2 + C^2 W / V} - |A| \right)", lambda A, C, V, W, P: (P, V / C**2 * (sqrt(A**2 + C**2 * W / V) - abs(A))), C0),
    F(KB, r"P = \frac{V}{C^2} \left( \sqrt{A^2 + C^2 W / V} + |A| \right)", lambda A, C, V, W, P: (P, V / C**2 * (sqrt(A**2 + C**2 * W / V) + abs(A))), C0),
    T(KB, r"P = \frac{V}{C^2} \left( \sqrt{A^2 + C^2 W / V} - |A| \right)", None, C0, "A < 0", why="2 max(0, A) = 0"),
    T(KB, r"P = \frac{V}{C^2} \left( \sqrt{A^2 + C^2 W / V} + |A| \right)", None, C0, r"A \ge 0", why="|A| = A"),
    T(KB, r"P = \frac{A V}{C^2} + \frac{1}{|C|} \sqrt{V W + A^2 V^2 / C^2}", lambda A, C, V, W, P: (P, A * V / C**2 + sqrt(V * W + A**2 * V**2 / C**2) / abs(C)), C0),
    F(KB, r"P = \frac{A V}{C^2} + \frac{1}{C} \sqrt{V W + A^2 V^2 / C^2}", lambda A, C, V, W, P: (P, A * V / C**2 + sqrt(V * W + A**2 * V**2 / C**2) / C), C0),
    F(KB, r"P = \frac{W}{\sqrt{A^2 + C^2 W / V} - A}", None, why="0/0 for W = 0 and A > 0"),
    T(KB, r"P = \frac{W}{\sqrt{A^2 + C^2 W / V} - A}", lambda A, C, V, W, P: (P, W / (sqrt(A**2 + C**2 * W / V) - A)), "W > 0"),
    F(KB, r"P = \frac{W}{\sqrt{A^2 + C^2 W / V} + A}", lambda A, C, V, W, P: (P, W / (sqrt(A**2 + C**2 * W / V) + A)), "W > 0"),
    # gain and closed loop
    T(KB, r"K = \frac{P C}{V}", lambda P, C, V, K: (K, P * C / V)),
    F(KB, r"K = \frac{P C}{V^2}", lambda P, C, V, K: (K, P * C / V**2)),
    T(KB, r"A - K C = - \sqrt{A^2 + C^2 W / V}", lambda A, C, V, W, K: (A - K * C, -sqrt(A**2 + C**2 * W / V))),
    F(KB, r"A - K C = \sqrt{A^2 + C^2 W / V}", lambda A, C, V, W, K: (A - K * C, sqrt(A**2 + C**2 * W / V))),
    F(KB, r"A - K C = - \sqrt{A^2 - C^2 W / V}", None, why="a negative radicand: A = 0, C = V = W = 1"),
    T(KB, r"A - K C \le 0", lambda A, K, C: (A - K * C, 0)),
    F(KB, r"A - K C < 0", None, why="A = W = 0, C = V = 1: the mode on the axis is not excited"),
    T(KB, r"A - K C < 0", lambda A, K, C: (A - K * C, 0), "W > 0", C0),
    T(KB, r"C K = A + \sqrt{A^2 + C^2 W / V}", lambda A, C, V, W, K: (C * K, A + sqrt(A**2 + C**2 * W / V))),
    T(KB, r"2 A P + W = \frac{C^2 P^2}{V}", lambda A, C, V, W, P: (2 * A * P + W, C**2 * P**2 / V)),
    F(KB, r"A P + W = \frac{C^2 P^2}{V}", lambda A, C, V, W, P: (A * P + W, C**2 * P**2 / V)),
    F(KB, r"2 A P - W = \frac{C^2 P^2}{V}", lambda A, C, V, W, P: (2 * A * P - W, C**2 * P**2 / V)),
    T(KB, r"(A - K C)^2 = A^2 + \frac{C^2 W}{V}", lambda A, C, V, W, K: ((A - K * C) ** 2, A**2 + C**2 * W / V)),
    T(KB, r"K^2 V = 2 A P + W", lambda A, V, W, P, K: (K**2 * V, 2 * A * P + W)),
    F(KB, r"K = \frac{A + \sqrt{A^2 + C^2 W / V}}{C^2}", lambda A, C, V, W, K: (K, (A + sqrt(A**2 + C**2 * W / V)) / C**2), C0),
    T(KB, r"K = \frac{A + \sqrt{A^2 + C^2 W / V}}{C}", lambda A, C, V, W, K: (K, (A + sqrt(A**2 + C**2 * W / V)) / C), C0),
    # bounds
    T(KB, r"P \ge 0", lambda P: (P, 0)),
    F(KB, r"P > 0", None, why="A < 0 and W = 0: P = 0"),
    T(KB, r"P > 0", lambda P: (P, 0), "W > 0"),
    T(KB, r"P > 0", None, "A > 0", why="an unstable plant: P >= 2 A V / C^2"),
    T(KB, r"P \ge \max\{0, 2 A V / C^2\}", lambda A, C, V, P: (P, larger(0, 2 * A * V / C**2)), C0),
    T(KB, r"P \ge \frac{2 A V}{C^2}", lambda A, C, V, P: (P, 2 * A * V / C**2), C0),
    F(KB, r"P \ge \frac{3 A V}{C^2}", None, C0, why="A = C = V = 1, W = 0: 2 against 3"),
    T(KB, r"P \le \frac{V}{C^2} \left( 2 \max\{0, A\} + |C| \sqrt{W / V} \right)", lambda A, C, V, W, P: (P, V / C**2 * (2 * larger(0, A) + abs(C) * sqrt(W / V))), C0),
    T(KB, r"P \le \frac{W}{2 |A|}", None, "A < 0", why="2 A P + W >= 0"),
    F(KB, r"P \le \frac{W}{4 |A|}", None, "A < 0", why="C = 0: P = W/(2|A|)"),
    F(KB, r"P \le \frac{\sqrt{V W}}{|C|}", None, C0, why="A = 1, C = V = 1, W = 0: 2 against 0"),
    T(KB, r"P \le \frac{\sqrt{V W}}{|C|}", None, C0, r"A \le 0", why="sqrt(a^2 + b^2) <= |a| + |b|"),
    T(KB, r"P \ge \frac{\sqrt{V W}}{|C|}", None, C0, r"A \ge 0", why="sqrt(a^2 + b^2) >= |b|"),
    F(KB, r"P \ge \frac{\sqrt{V W}}{|C|}", None, C0, why="A = -1, C = V = W = 1: sqrt 2 - 1 against 1"),
    T(KB, r"P = \frac{\sqrt{V W}}{|C|}", None, "A = 0", why="an integrator"),
    F(KB, r"P = \frac{\sqrt{V W}}{C}", None, "A = 0", why="C = -1"),
    T(KB, r"P = - \frac{W}{2 A}", None, "C = 0", why="the Lyapunov equation; C = 0 is detectable only for A < 0"),
    F(KB, r"P = \frac{W}{2 A}", None, "C = 0", why="A = -1, W = 1: 1/2 against -1/2"),
    T(KB, r"P = \frac{2 A V}{C^2}", None, "W = 0", "A > 0", why="the strong solution of an unstable, unexcited plant"),
    F(KB, r"P = \frac{2 A V}{C^2}", None, "W = 0", C0, why="A = -1: P = 0"),
    T(KB, "P = 0", None, "W = 0", r"A \le 0", why="nothing excites a stable plant"),
    F(KB, "P = 0", None, "W = 0", why="A = 1: P = 2"),
    # discrete time
    T(DT, r"P = \frac{A^2 R + C^2 Q - R + \sqrt{(A^2 R + C^2 Q - R)^2 + 4 C^2 Q R}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R + sqrt((A**2 * R + C**2 * Q - R) ** 2 + 4 * C**2 * Q * R)) / (2 * C**2)), C0),
    F(DT, r"P = \frac{A^2 R + C^2 Q - R - \sqrt{(A^2 R + C^2 Q - R)^2 + 4 C^2 Q R}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R - sqrt((A**2 * R + C**2 * Q - R) ** 2 + 4 * C**2 * Q * R)) / (2 * C**2)), C0),
    F(DT, r"P = \frac{A^2 R + C^2 Q - R + \sqrt{(A^2 R + C^2 Q - R)^2 + 4 Q R}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R + sqrt((A**2 * R + C**2 * Q - R) ** 2 + 4 * Q * R)) / (2 * C**2)), C0),
    F(DT, r"P = \frac{A^2 R + C^2 Q - R + \sqrt{(A^2 R + C^2 Q - R)^2 + 4 C^2 Q R}}{C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R + sqrt((A**2 * R + C**2 * Q - R) ** 2 + 4 * C**2 * Q * R)) / C**2), C0),
    F(DT, r"P = \frac{A^2 R + C^2 Q + R + \sqrt{(A^2 R + C^2 Q - R)^2 + 4 C^2 Q R}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q + R + sqrt((A**2 * R + C**2 * Q - R) ** 2 + 4 * C**2 * Q * R)) / (2 * C**2)), C0),
    T(DT, r"P = \frac{A^2 R + C^2 Q - R + \sqrt{(A^2 R + C^2 Q + R)^2 - 4 A^2 R^2}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R + sqrt((A**2 * R + C**2 * Q + R) ** 2 - 4 * A**2 * R**2)) / (2 * C**2)), C0),
    T(DT, r"P = \frac{A^2 R + C^2 Q - R + \sqrt{((A + 1)^2 R + C^2 Q) ((A - 1)^2 R + C^2 Q)}}{2 C^2}", lambda A, C, Q, R, P: (P, (A**2 * R + C**2 * Q - R + sqrt(((A + 1) ** 2 * R + C**2 * Q) * ((A - 1) ** 2 * R + C**2 * Q))) / (2 * C**2)), C0),
    T(DT, r"P = \frac{A^2 P R}{C^2 P + R} + Q", lambda A, C, Q, R, P: (P, A**2 * P * R / (C**2 * P + R) + Q)),
    F(DT, r"P = \frac{A^2 P R}{C^2 P - R} + Q", None, why="a zero of C^2 P - R, or A = C = R = Q = 1"),
    F(DT, r"P = \frac{A P R}{C^2 P + R} + Q", lambda A, C, Q, R, P: (P, A * P * R / (C**2 * P + R) + Q)),
    T(DT, r"L = \frac{A P C}{C^2 P + R}", lambda A, C, R, P, L: (L, A * P * C / (C**2 * P + R))),
    F(DT, r"L = \frac{P C}{C^2 P + R}", lambda C, R, P, L: (L, P * C / (C**2 * P + R))),
    T(DT, r"A - L C = \frac{A R}{C^2 P + R}", lambda A, C, R, P, L: (A - L * C, A * R / (C**2 * P + R))),
    F(DT, r"A - L C = \frac{R}{C^2 P + R}", lambda A, C, R, P, L: (A - L * C, R / (C**2 * P + R))),
    T(DT, r"|A - L C| \le 1", lambda A, C, L: (abs(A - L * C), 1)),
    F(DT, r"|A - L C| < 1", None, why="A = 1, Q = 0, C = R = 1: P = 0, L = 0"),
    T(DT, r"|A - L C| < 1", lambda A, C, L: (abs(A - L * C), 1), "Q > 0", C0),
    T(DT, r"|A - L C| \le |A|", lambda A, C, L: (abs(A - L * C), abs(A))),
    T(DT, r"P \ge Q", lambda P, Q: (P, Q)),
    F(DT, r"P \le Q", lambda P, Q: (P, Q)),
    T(DT, r"P \le A^2 P + Q", lambda A, P, Q: (P, A**2 * P + Q)),
    T(DT, r"P \le \frac{A^2 R}{C^2} + Q", lambda A, C, Q, R, P: (P, A**2 * R / C**2 + Q), C0),
    F(DT, r"P \le \frac{A^2 R}{C^2}", None, C0, why="A = 0, C = Q = R = 1: 1 against 0"),
    T(DT, r"P \ge \frac{(A^2 - 1) R}{C^2}", lambda A, C, R, P: (P, (A**2 - 1) * R / C**2), C0),
    F(DT, r"P \ge \frac{A^2 R}{C^2}", None, C0, why="A = C = R = 1, Q = 0: 0 against 1"),
    T(DT, r"P = \frac{(A^2 - 1) R}{C^2}", None, "Q = 0", "A > 1", why="the strong solution of an unstable, unexcited plant"),
    T(DT, "P = 0", None, "Q = 0", r"A^2 \le 1", why="nothing excites a plant that does not grow"),
    F(DT, "P = 0", None, "Q = 0", why="A = 2, C = R = 1: P = 3"),
    T(DT, "P = Q", None, "A = 0", why="no memory"),
    T(DT, r"P = \frac{Q}{1 - A^2}", None, "C = 0", why="the Stein equation; C = 0 is detectable only for |A| < 1"),
    F(DT, r"P = \frac{Q}{1 + A^2}", None, "C = 0", why="A = 1/2, Q = 1: 4/3 against 4/5"),
    T(DT, r"L_f = \frac{P C}{C^2 P + R}", lambda C, R, P, Lf: (Lf, P * C / (C**2 * P + R))),
    T(DT, r"P^+ = \frac{P R}{C^2 P + R}", lambda C, R, P, Pp: (Pp, P * R / (C**2 * P + R))),
    F(DT, r"P^+ = \frac{P R}{C P + R}", lambda C, R, P, Pp: (Pp, P * R / (C * P + R))),
    T(DT, r"P^+ \le \frac{R}{C^2}", lambda C, R, Pp: (Pp, R / C**2), C0),
    T(DT, r"P^+ \le P", lambda P, Pp: (Pp, P)),
    T(DT, r"P_k = A^2 P_{k-1} + Q - \frac{A^2 C^2 P_{k-1}^2}{C^2 P_{k-1} + R}", lambda A, C, Q, R, Pm, Pk: (Pk, A**2 * Pm + Q - A**2 * C**2 * Pm**2 / (C**2 * Pm + R))),
    T(DT, r"P_k = \frac{A^2 R P_{k-1}}{C^2 P_{k-1} + R} + Q", lambda A, C, Q, R, Pm, Pk: (Pk, A**2 * R * Pm / (C**2 * Pm + R) + Q)),
    F(DT, r"P_k = \frac{A^2 P_{k-1}}{C^2 P_{k-1} + R} + Q", lambda A, C, Q, R, Pm, Pk: (Pk, A**2 * Pm / (C**2 * Pm + R) + Q)),
    T(DT, r"L_k = \frac{A P_{k-1} C}{C^2 P_{k-1} + R}", lambda A, C, R, Pm, Lk: (Lk, A * Pm * C / (C**2 * Pm + R))),
    F(DT, r"L_k = \frac{P_{k-1} C}{C^2 P_{k-1} + R}", lambda C, R, Pm, Lk: (Lk, Pm * C / (C**2 * Pm + R))),
    T(DT, r"P_k \ge Q", lambda Q, Pk: (Pk, Q)),
    F(DT, r"P_k \le P_{k-1}", lambda Pm, Pk: (Pk, Pm)),
    # the regulator
    T(CT, r"S = \frac{A R + \sqrt{A^2 R^2 + B^2 Q R}}{B^2}", lambda A, B, Q, R, S: (S, (A * R + sqrt(A**2 * R**2 + B**2 * Q * R)) / B**2), r"B \neq 0"),
    F(CT, r"S = \frac{A R - \sqrt{A^2 R^2 + B^2 Q R}}{B^2}", lambda A, B, Q, R, S: (S, (A * R - sqrt(A**2 * R**2 + B**2 * Q * R)) / B**2), r"B \neq 0"),
    T(CT, r"A - B K = - \sqrt{A^2 + B^2 Q / R}", lambda A, B, Q, R, K: (A - B * K, -sqrt(A**2 + B**2 * Q / R))),
    T(CT, r"K = \frac{B S}{R}", lambda B, R, S, K: (K, B * S / R)),
    F(CT, r"K = \frac{B S}{Q}", None, why="Q = 0 is allowed"),
    T(CT, r"S \ge 0", lambda S: (S, 0)),
    T(RD, r"K = \frac{A B S}{B^2 S + R}", lambda A, B, R, S, K: (K, A * B * S / (B**2 * S + R))),
    F(RD, r"K = \frac{B S}{B^2 S + R}", lambda B, R, S, K: (K, B * S / (B**2 * S + R))),
    T(RD, r"S = \frac{A^2 R S}{B^2 S + R} + Q", lambda A, B, Q, R, S: (S, A**2 * R * S / (B**2 * S + R) + Q)),
    T(RD, r"S \ge Q", lambda S, Q: (S, Q)),
    T(RD, r"|A - B K| \le 1", lambda A, B, K: (abs(A - B * K), 1)),
]  # fmt: skip
