"""Claims about numbers with their truth, and the reason by which it was found by hand.

S is the root of A^2 + C^2 W/V (of A^2 + B^2 Q/R for the regulator), D = C^2 P + R (B^2 S + R). Where C = 0 is allowed,
the state is stable there.
"""

from __future__ import annotations

from dataclasses import dataclass

KB, DT, CT, RD = "kalman-bucy", "luenberger-dt", "lqr-ct", "lqr-dt"
C0, B0 = r"C \neq 0", r"B \neq 0"


@dataclass(frozen=True)
class Row:
    """A claim, its truth and why."""

    theory: str
    truth: bool
    why: str
    latex: str
    assume: tuple[str, ...] = ()
    undefined: bool = False


def T(theory: str, why: str, latex: str, *assume: str) -> Row:
    """Return a true claim."""
    return Row(theory, True, why, latex, assume)


def F(theory: str, why: str, latex: str, *assume: str) -> Row:
    """Return a false claim."""
    return Row(theory, False, why, latex, assume)


def U(theory: str, why: str, latex: str, *assume: str) -> Row:
    """Return a claim that is undefined somewhere, and true or meaningless elsewhere."""
    return Row(theory, False, why, latex, assume, undefined=True)


ROOTS = [
    T(KB, "both sides 0 for C = 0", r"C^2 P = A V + \sqrt{A^2 V^2 + C^2 V W}"),
    F(KB, "the other root: A = 0", r"C^2 P = A V - \sqrt{A^2 V^2 + C^2 V W}"),
    T(KB, "C^2 P - A V = V S >= 0", r"C^2 P - A V = \sqrt{A^2 V^2 + C^2 V W}"),
    T(KB, "square it", r"(C^2 P - A V)^2 = A^2 V^2 + C^2 V W"),
    T(KB, "the Riccati equation times V", r"P (C^2 P - 2 A V) = V W"),
    U(KB, "A = W = 0", r"P = \frac{V W}{C^2 P - 2 A V}"),
    T(KB, "P > 0, so C^2 P - 2 A V > 0", r"P = \frac{V W}{C^2 P - 2 A V}", "W > 0"),
    T(KB, "the reciprocal of the other form", r"\frac{1}{P} = \frac{\sqrt{A^2 + C^2 W / V} - A}{W}", "W > 0"),
    U(KB, "P = 0", r"\frac{1}{P} = \frac{\sqrt{A^2 + C^2 W / V} - A}{W}"),
    T(KB, "S >= |A| > A", r"P = \frac{W}{\sqrt{A^2 + C^2 W / V} - A}", "A < 0"),
    U(KB, "A = W = 0", r"P = \frac{W}{\sqrt{A^2 + C^2 W / V} - A}", r"A \le 0"),
    T(
        KB, "C > 0 goes under the root",
        r"P = \frac{V}{C} \left( \frac{A}{C} + \sqrt{\frac{A^2}{C^2} + \frac{W}{V}} \right)", "C > 0",
    ),
    F(KB, "C = -1", r"P = \frac{V}{C} \left( \frac{A}{C} + \sqrt{\frac{A^2}{C^2} + \frac{W}{V}} \right)", C0),
    T(KB, "insert", r"P = A + \sqrt{A^2 + W}", "C = 1", "V = 1"),
    F(KB, "the other root", r"P = A - \sqrt{A^2 + W}", "C = 1", "V = 1"),
    F(KB, "C^2 is missing under the root: C = 2, A = 0, W = 1", r"P = \frac{A + \sqrt{A^2 + W}}{C^2}", "V = 1", C0),
    T(KB, "solve for W", r"W = \frac{P^2 C^2}{V} - 2 A P"),
    F(KB, "V = 2", r"W = P^2 C^2 - 2 A P"),
    T(KB, "V = 1", r"W = P^2 C^2 - 2 A P", "V = 1"),
    F(KB, "the factor 2 is missing", r"W = \frac{P^2 C^2}{V} - A P"),
    T(
        KB, "letters with index",
        r"P = \frac{\sigma_v^2}{C^2} \left( A + \sqrt{A^2 + C^2 \frac{\sigma_w^2}{\sigma_v^2}} \right)", C0,
    ),
    F(
        KB, "ratio upside down",
        r"P = \frac{\sigma_v^2}{C^2} \left( A + \sqrt{A^2 + C^2 \frac{\sigma_v^2}{\sigma_w^2}} \right)", C0, "W > 0",
    ),
    T(KB, "golden ratio", r"P = \frac{1 + \sqrt{5}}{2}", "A = 1", "C = 2", "V = 2", "W = 2"),
    F(KB, "the other root", r"P = \frac{1 - \sqrt{5}}{2}", "A = 1", "C = 2", "V = 2", "W = 2"),
    T(KB, "1 + sqrt 2", r"P = 1 + \sqrt{2}", "A = 1", "C = 1", "V = 1", "W = 1"),
    F(KB, "1 + sqrt 2", r"P = 1 + \sqrt{3}", "A = 1", "C = 1", "V = 1", "W = 1"),
    F(KB, "1 + sqrt 2 = 2.414...", r"P = \frac{12}{5}", "A = 1", "C = 1", "V = 1", "W = 1"),
    T(KB, "1.4142 < sqrt 2", r"P > 2.4142", "A = 1", "C = 1", "V = 1", "W = 1"),
    F(KB, "sqrt 2 < 1.4143", r"P > 2.4143", "A = 1", "C = 1", "V = 1", "W = 1"),
]  # fmt: skip

LOOPS = [
    T(KB, "A - K C = -S", r"|A - K C| = \sqrt{A^2 + C^2 W / V}"),
    T(KB, "S >= |A|", r"A - K C \le - |A|"),
    T(KB, "K C = P C^2/V >= 0", r"A - K C \le A"),
    T(KB, "S >= A", r"A - K C \le - A"),
    T(KB, "P C^2/V", r"K C \ge 0"),
    T(KB, "K C = A + S", r"K C \ge 2 A"),
    T(KB, "both", r"K C \ge \max\{0, 2 A\}"),
    F(KB, "A = 1, W = 0: K C = 2", r"K C \ge 3 A"),
    F(KB, "C = -1", r"K \ge 0"),
    T(KB, "P C/V", r"K \ge 0", "C > 0"),
    T(KB, "P > 0", "K > 0", "C > 0", "W > 0"),
    F(KB, "P = 0", "K > 0", "C > 0"),
    F(KB, "A = 1, W = 0", r"K^2 \le \frac{W}{V}"),
    T(KB, "K^2 V = 2 A P + W", r"K^2 \le \frac{W}{V}", r"A \le 0"),
    T(KB, "K^2 V = 2 A P + W", r"K^2 \ge \frac{W}{V}", r"A \ge 0"),
    T(KB, "mirror image", "A - K C = -A", "W = 0", "A > 0"),
    T(KB, "S = |A|", "A - K C = -|A|", "W = 0"),
    T(KB, "P = 0", "A - K C = A", "W = 0", r"A \le 0"),
    F(KB, "A = 1", "A - K C = A", "W = 0"),
    T(KB, "A = 0: K^2 V = W", r"K^2 V = W", "A = 0"),
    T(KB, "cross term", r"K = \frac{P C + N}{V}"),
    F(KB, "W = N = 1, A = 0: P = 0", r"K = \frac{P C - N}{V}"),
    T(KB, "no cross term", r"K = \frac{P C}{V}", "N = 0"),
    F(KB, "N = 1", r"K = \frac{P C}{V}", r"N^2 \le W V"),
    T(
        KB, "F = A - N C/V",
        r"(A - K C)^2 = \left(A - \frac{N C}{V}\right)^2 + \frac{C^2}{V} \left(W - \frac{N^2}{V}\right)",
    ),
    T(KB, "the joint intensity", r"N^2 \le V W"),
    F(KB, "the noises may be one", r"N^2 < V W"),
    T(KB, "the strong solution", r"A - K C \le 0", r"N^2 \le V W"),
]  # fmt: skip

BOUNDS = [
    T(KB, "0 <= 2 A P + W", r"P \le \frac{W}{-2 A}", "A < 0"),
    F(KB, "C = 0", r"P < \frac{W}{-2 A}", "A < 0"),
    T(KB, "C^2 P^2/V > 0", r"P < \frac{W}{-2 A}", "A < 0", "W > 0", C0),
    F(KB, "the sensor helps", r"P \ge \frac{W}{-2 A}", "A < 0"),
    T(KB, "S <= A + |C| root(W/V)", r"P \le \frac{2 A V}{C^2} + \frac{\sqrt{V W}}{|C|}", r"A \ge 0", C0),
    T(KB, "S >= 0", r"P \ge \frac{A V}{C^2}", C0),
    T(KB, "S >= |A|", r"P \ge \frac{A V + |A| V}{C^2}", C0),
    T(KB, "S >= |C| root(W/V)", r"P \ge \frac{A V}{C^2} + \frac{\sqrt{V W}}{|C|}", C0),
    F(KB, "A = W = C = V = 1", r"P \le \frac{A V}{C^2} + \frac{\sqrt{V W}}{|C|}", C0),
    F(KB, "A = -1", r"P^2 \ge \frac{V W}{C^2}", C0),
    T(KB, "P C^2 = V (A + S)", r"P^2 \ge \frac{V W}{C^2}", r"A \ge 0", C0),
    F(KB, "A = 1, W = 0", r"P^2 \le \frac{V W}{C^2}", C0),
    F(KB, "A = W = 0", "P > 0", r"A \ge 0"),
    T(KB, "P > 2 holds", "P > 1", "P > 2"),
    F(KB, "P = 5/2", "P > 3", "P > 2"),
    T(KB, "the smaller of two bounds", r"P \le \min\{\frac{W}{2 |A|}, \frac{\sqrt{V W}}{|C|}\}", "A < 0", C0),
    T(KB, "an unstable plant", r"P > \frac{A V}{C^2}", "A > 0"),
    T(DT, "D P = A^2 P R + D Q", r"P - Q \le A^2 P"),
    F(DT, "A = 0", "P > Q"),
    T(DT, "P (1 - A^2) <= Q", r"P \le \frac{Q}{1 - A^2}", "A^2 < 1"),
    U(DT, "A = 1", r"P \le \frac{Q}{1 - A^2}"),
    F(DT, "A = 0", r"P < Q + \frac{A^2 R}{C^2}", C0),
    T(DT, "C^2 P < D", r"P < Q + \frac{A^2 R}{C^2}", C0, r"A \neq 0"),
    T(DT, "P R <= D P", r"P^+ \le P"),
    F(DT, "C = 0", "P^+ < P"),
    T(DT, "C^2 P < D", r"P^+ < \frac{R}{C^2}", C0),
    T(DT, "P R/D", r"P^+ \ge 0"),
    F(DT, "R = 1, P = 1, C = 2", r"P^+ \ge Q"),
    T(DT, "C^2 P/D", r"L_f C < 1"),
    T(DT, "C^2 P/D", r"L_f C \ge 0"),
    F(DT, "C < 0", r"L_f \le \frac{1}{C}", C0),
    T(DT, "C^2 P < D", r"L_f \le \frac{1}{C}", "C > 0"),
    F(DT, "A = -1", r"L C \le A"),
    T(DT, "A C^2 P/D", r"L C \le A", r"A \ge 0"),
    T(DT, "|A| C^2 P/D", r"|L C| \le |A|"),
    T(DT, "A^2 R/D", r"A (A - L C) \ge 0"),
    T(DT, "1 - Q/P where P > 0, else A^2 <= 1", r"A (A - L C) \le 1"),
    F(DT, "A = 1, Q = 0", r"A (A - L C) < 1"),
    T(DT, "A R/D inside the circle", r"(A - L C)^2 \le 1"),
    T(DT, "the strong solution grows with the plant", r"C^2 P \ge (A^2 - 1) R"),
    F(DT, "A = 1, C = 1, Q = 0", r"C^2 P > (A^2 - 1) R", C0),
    T(DT, "Q > 0 lifts it", r"C^2 P > (A^2 - 1) R", C0, "Q > 0"),
    T(DT, "one step", r"|A - L_k C| \le |A|"),
    T(DT, "one step", r"P_{k+1} \ge Q"),
    T(DT, "one step", r"P_k \le \frac{A^2 R}{C^2} + Q", C0),
    T(DT, "one step", r"P_k \le A^2 P_{k-1} + Q"),
    F(DT, "A = 2, C = 0, P = Q = 1", r"P_k \le P_{k-1} + Q"),
    F(DT, "P_{k-1} = 0 is allowed", r"P_{k-1} > 0"),
    T(CT, "mirror", r"S \ge \frac{2 A R}{B^2}", B0),
    T(CT, "2 A S + Q >= 0", r"S \le \frac{Q}{2 |A|}", "A < 0"),
    F(CT, "A = 1", r"S \le \frac{Q}{2 |A|}", r"A \neq 0"),
    T(CT, "else 2 A S + Q > 0", "S > 0", "Q > 0"),
    F(CT, "A = Q = 0", r"A - B K < 0"),
    T(CT, "A + root", r"B K \ge 2 A"),
    T(RD, "as the predictor", r"S \ge \frac{(A^2 - 1) R}{B^2}", B0),
    T(RD, "stabilisable, and all of it costs", r"|A - B K| < 1", "Q > 0"),
    F(RD, "A = 1, Q = 0", r"|A - B K| < 1"),
    T(RD, "A^2 R S/D", r"S \le A^2 S + Q"),
]  # fmt: skip

DISCRETE = [
    T(DT, "times D", r"(C^2 P + R) (P - Q) = A^2 P R"),
    T(DT, "a quadratic equation", r"C^2 P^2 + (R - A^2 R - C^2 Q) P - Q R = 0"),
    F(DT, "sign of Q R", r"C^2 P^2 + (R - A^2 R - C^2 Q) P + Q R = 0"),
    F(DT, "sign of A^2 R", r"C^2 P^2 + (R + A^2 R - C^2 Q) P - Q R = 0"),
    T(DT, "definition", r"L = A L_f"),
    F(DT, "A = 2", r"L = L_f"),
    T(DT, "P+ = P R/D", r"L_f = \frac{P^+ C}{R}"),
    T(DT, "P R/D", r"P^+ = (1 - L_f C) P"),
    F(DT, "A = 2", r"P^+ = (1 - L C) P"),
    T(DT, "divide by R", r"P^+ = \frac{P}{1 + C^2 P / R}"),
    F(DT, "C^2", r"P^+ = \frac{P}{1 + C P / R}"),
    T(DT, "prediction", r"P = A^2 P^+ + Q"),
    F(DT, "A = 2", r"P = A P^+ + Q"),
    T(DT, "R/D", r"1 - L_f C = \frac{R}{C^2 P + R}"),
    T(DT, "any gain, with the optimal one", r"P = (A - L C)^2 P + Q + L^2 R"),
    F(DT, "L R L' is missing", r"P = (A - L C)^2 P + Q"),
    T(DT, "one factor", r"P = (A - L C) A P + Q"),
    F(DT, "A = 2", r"P = (A - L C) P + Q"),
    T(DT, "C = 0", "L = 0", "C = 0"),
    T(DT, "A = 0", "L = 0", "A = 0"),
    T(DT, "P = 0", "L = 0", "Q = 0", r"A^2 \le 1"),
    F(DT, "A = 2", "L = 0", "Q = 0"),
    T(DT, "the root at A = 1", r"P = \frac{C^2 Q + \sqrt{C^4 Q^2 + 4 C^2 Q R}}{2 C^2}", "A = 1"),
    T(DT, "a random walk", r"P = \frac{Q + \sqrt{Q^2 + 4 Q R}}{2}", "A = 1", "C = 1"),
    F(DT, "Q is missing", r"P = \frac{Q + \sqrt{Q^2 + 4 R}}{2}", "A = 1", "C = 1"),
    T(DT, "P - Q", r"P^+ = \frac{-Q + \sqrt{Q^2 + 4 Q R}}{2}", "A = 1", "C = 1"),
    F(DT, "the other root", r"P^+ = \frac{-Q - \sqrt{Q^2 + 4 Q R}}{2}", "A = 1", "C = 1"),
    T(DT, "C = 1", r"L_f = \frac{P}{P + R}", "C = 1"),
    F(DT, "C = 2", r"L_f = \frac{P}{P + R}"),
    T(DT, "golden ratio", r"P = \frac{1 + \sqrt{5}}{2}", "A = 1", "C = 1", "Q = 1", "R = 1"),
    F(DT, "the other root", r"P = \frac{1 - \sqrt{5}}{2}", "A = 1", "C = 1", "Q = 1", "R = 1"),
    T(DT, "golden ratio", r"L = \frac{\sqrt{5} - 1}{2}", "A = 1", "C = 1", "Q = 1", "R = 1"),
    T(DT, "strong solution", r"P = \frac{(A^2 - 1) R}{C^2}", "Q = 0", "A < -1"),
    T(DT, "0 at the boundary", r"P = \frac{(A^2 - 1) R}{C^2}", "Q = 0", r"A^2 \ge 1"),
    F(DT, "A = 0, C = 1: P = 0", r"P = \frac{(A^2 - 1) R}{C^2}", "Q = 0"),
    F(DT, "A = 0", r"P = \frac{(A^2 - 1) R}{C^2}", "Q = 0", C0),
    T(DT, "the filter's equation", r"\frac{1}{P^+} = \frac{1}{P} + \frac{C^2}{R}", "Q > 0"),
    U(DT, "P = 0", r"\frac{1}{P^+} = \frac{1}{P} + \frac{C^2}{R}"),
    T(DT, "one step", r"P_k = (A - L_k C)^2 P_{k-1} + Q + L_k^2 R"),
    F(DT, "indices", r"P_k = (A - L_k C)^2 P_k + Q + L_k^2 R"),
    T(DT, "one step", r"P_k = (A - L_k C) A P_{k-1} + Q"),
    T(DT, "one step", r"P_{k+1} = \frac{A^2 R P_k}{C^2 P_k + R} + Q"),
    F(DT, "the step before", r"P_{k+1} = \frac{A^2 R P_{k+1}}{C^2 P_{k+1} + R} + Q"),
    T(DT, "nothing known is lost", "P_k = Q", r"P_{k-1} = 0"),
    T(DT, "no memory", "P_k = Q", "A = 0"),
    F(DT, "A = P = 1", "P_k = Q"),
    F(DT, "R > 0", r"L_k = \frac{A}{C}", C0, r"A \neq 0"),
    T(DT, "cross term", r"L = \frac{A P C + S}{C^2 P + R}"),
    F(DT, "sign of S", r"L = \frac{A P C - S}{C^2 P + R}"),
    T(DT, "the joint covariance", r"S^2 \le Q R"),
]  # fmt: skip

REGULATOR = [
    T(CT, "A + root", r"K = \frac{A + \sqrt{A^2 + B^2 Q / R}}{B}", B0),
    U(CT, "B = 0", r"K = \frac{A + \sqrt{A^2 + B^2 Q / R}}{B}"),
    F(CT, "the other root", r"K = \frac{A - \sqrt{A^2 + B^2 Q / R}}{B}", B0),
    T(CT, "stabilisable only for A < 0", r"S = - \frac{Q}{2 A}", "B = 0"),
    T(CT, "the Riccati equation", r"2 A S + Q = \frac{B^2 S^2}{R}"),
    F(CT, "the factor 2", r"A S + Q = \frac{B^2 S^2}{R}"),
    T(CT, "K^2 R = B^2 S^2/R", r"2 A S + Q = K^2 R"),
    T(CT, "an integrator", r"S = \frac{\sqrt{Q R}}{|B|}", "A = 0"),
    T(CT, "Lyapunov", r"2 (A - B K) S + Q + K^2 R = 0"),
    F(CT, "the cost of control is missing", r"2 (A - B K) S + Q = 0"),
    T(RD, "A R/D", r"A - B K = \frac{A R}{B^2 S + R}"),
    T(RD, "cost of the closed loop", r"S = (A - B K)^2 S + Q + K^2 R"),
    F(RD, "K' R K is missing", r"S = (A - B K)^2 S + Q"),
    T(RD, "complete the square", r"S = A^2 S + Q - K^2 (B^2 S + R)"),
    F(RD, "K instead of K^2", r"S = A^2 S + Q - K (B^2 S + R)"),
    T(RD, "no memory", "S = Q", "A = 0"),
    T(RD, "stabilisable only for |A| < 1", r"S = \frac{Q}{1 - A^2}", "B = 0"),
    T(RD, "as the predictor", r"S = \frac{A^2 R + B^2 Q - R + \sqrt{(A^2 R + B^2 Q - R)^2 + 4 B^2 Q R}}{2 B^2}", B0),
    F(RD, "the factor 4", r"S = \frac{A^2 R + B^2 Q - R + \sqrt{(A^2 R + B^2 Q - R)^2 + B^2 Q R}}{2 B^2}", B0),
]  # fmt: skip

NUMBERS = [
    T(KB, "", r"|A|^2 = A^2"), T(KB, "", r"|A| \ge A"), T(KB, "", r"|A| \ge 0"), F(KB, "0", "|A| > 0"),
    F(KB, "A = -1", "|A| = A"), T(KB, "", r"|A C| = |A| |C|"), T(KB, "triangle", r"|A + C| \le |A| + |C|"),
    F(KB, "1 and -1", r"|A + C| = |A| + |C|"), T(KB, "triangle", r"|A - C| \ge |A| - |C|"),
    T(KB, "", r"\max\{A, C\} \ge A"), T(KB, "", r"\max\{A, C\} = \frac{A + C + |A - C|}{2}"),
    T(KB, "", r"\min\{A, C\} = \frac{A + C - |A - C|}{2}"), T(KB, "", r"\max\{A, C\} + \min\{A, C\} = A + C"),
    F(KB, "-1 and -1", r"\max\{A, C\} \ge 0"), T(KB, "", r"\max\{0, A\} = \frac{A + |A|}{2}"),
    T(KB, "", r"\max\{0, A\} - \max\{0, -A\} = A"), T(KB, "", r"\max\{0, A\} \max\{0, -A\} = 0"),
    T(KB, "", r"\sqrt{A^2 C^2} = |A C|"), F(KB, "1 and -1", r"\sqrt{A^2 C^2} = A C"),
    T(KB, "", r"\sqrt{V W} = \sqrt{V} \sqrt{W}"), U(KB, "-1", r"\sqrt{A C} = \sqrt{A} \sqrt{C}"),
    T(KB, "V > 0", r"\sqrt{V^2} = V"), F(KB, "A = -1", r"\sqrt{A^2} = A"), T(KB, "", r"\sqrt{V^2 W} = V \sqrt{W}"),
    T(KB, "", r"\sqrt{W / V} = \frac{\sqrt{W}}{\sqrt{V}}"), T(KB, "square", r"\sqrt{V + W} \le \sqrt{V} + \sqrt{W}"),
    F(KB, "1 and 1", r"\sqrt{V + W} = \sqrt{V} + \sqrt{W}"),
    T(KB, "", r"(\sqrt{V} + \sqrt{W})^2 = V + W + 2 \sqrt{V W}"), T(KB, "", r"\sqrt{A^2 + W} \ge |A|"),
    F(KB, "W = 0", r"\sqrt{A^2 + W} > A"), T(KB, "", r"\sqrt{A^2 + W} > A", "W > 0"),
    T(KB, "", r"\sqrt{A^2 + 2 A C + C^2} = |A + C|"), T(KB, "means", r"\sqrt{V W} \le \frac{V + W}{2}"),
    T(KB, "", r"V^2 + W^2 \ge 2 V W"), F(KB, "1 and 1", r"V^2 + W^2 > 2 V W"), T(KB, "", r"A^2 + C^2 \ge 2 A C"),
    T(KB, "", r"A^2 + C^2 + 1 > 0"), T(KB, "", r"A^4 + C^4 \ge A^2 C^2"),
    T(KB, "Motzkin: no sum of squares", r"A^4 C^2 + A^2 C^4 - 3 A^2 C^2 + 1 \ge 0"),
    F(KB, "A = C = 1", r"A^4 C^2 + A^2 C^4 - 3 A^2 C^2 + 1 > 0"), F(KB, "A = -1", r"A^3 \ge 0"),
    T(KB, "", r"A^3 \ge 0", r"A \ge 0"), U(KB, "W = 0", r"\frac{P}{W} \ge 0"), T(KB, "", r"\frac{P}{W} > 0", "W > 0"),
    U(KB, "A = -1", r"\sqrt{A} \ge 0"), T(KB, "", r"\sqrt{A} \ge 0", r"A \ge 0"), T(KB, "", r"\sqrt{-A} > 0", "A < 0"),
    T(KB, "P >= 2 A V/C^2", r"\sqrt{P - \frac{2 A V}{C^2}} \ge 0", C0), T(KB, "", r"\frac{1}{1 + A^2} \le 1"),
    U(KB, "A = 1", r"\frac{1}{(1 - A^2)^2} > 0"), T(KB, "", r"\frac{1}{1 - A^2} > 0", "A^2 < 1"),
    U(KB, "A = 0", r"\frac{A}{A} = 1"), T(KB, "", r"\frac{A}{A} = 1", r"A \neq 0"),
    U(KB, "A = 0", r"\frac{A^2}{A} = A"),
    T(KB, "", r"\frac{1}{C^2 P + V} > 0"), U(KB, "C = P = V = 1", r"\frac{1}{(C^2 P - V)^2} > 0"),
    U(KB, "P = 0", r"\frac{1}{P} > 0"), T(KB, "", r"\frac{1}{P} > 0", "W > 0"), U(KB, "P = 0", r"\sqrt{P - 1} \ge 0"),
    T(KB, "", r"\sqrt{P} \ge 0"), T(KB, "", r"P^3 \ge 0"), F(KB, "P = 0", r"P \neq 0"), T(KB, "", r"P \neq 0", "W > 0"),
    T(KB, "", r"A^2 - C^2 = (A - C) (A + C)"), F(KB, "1 and 1", r"A^2 + C^2 = (A + C)^2"),
    T(KB, "a chain", r"0 \le P \le P + W \le P + W + V"), F(KB, "W = 0", r"0 \le P < P + W"),
    T(KB, "a letter that is defined", "g = 1", "g = A / A", r"A \neq 0"),
]  # fmt: skip

STEPS = [
    T(DT, "two steps", r"P_{k+2} = Q + \frac{A^2 R P_{k+1}}{C^2 P_{k+1} + R}"),
    T(DT, "the step is monotone", r"P_{k+1} \le P_k", r"P_k \le P_{k-1}"),
    F(DT, "C = 0, A = 2", r"P_{k+1} \le P_k"),
    T(DT, "a fixed point of a monotone step", r"P_k \ge P", r"P_{k-1} \ge P"),
    F(DT, "C = 0, A = 1, Q = 0", r"P_k < P_{k-1} + Q"),
    T(DT, "product of both loops", r"P_k - P = (A - L C) (A - L_k C) (P_{k-1} - P)"),
    F(DT, "one loop twice", r"P_k - P = (A - L C)^2 (P_{k-1} - P)"),
    T(DT, "both loops at most |A|", r"|P_k - P| \le A^2 |P_{k-1} - P|"),
    F(DT, "at the fixed point", r"|P_k - P| < |P_{k-1} - P|"),
    T(DT, "both loops at most 1", r"|P_k - P| \le |P_{k-1} - P|", r"A^2 \le 1"),
]  # fmt: skip

SOLUTIONS = [
    T(KB, "P' = -P^2", r"P(t) = \frac{P(0)}{1 + P(0) t}", "A = 0", "C = 1", "V = 1", "W = 0"),
    F(KB, "the rate is twice that", r"P(t) = \frac{P(0)}{1 + 2 P(0) t}", "A = 0", "C = 1", "V = 1", "W = 0"),
    T(KB, "P' = -C^2 P^2/V", r"P(t) = \frac{P(0)}{1 + P(0) C^2 t / V}", "A = 0", "W = 0"),
    F(KB, "the start is 1 more", r"P(t) = 1 + P(0)"),
    T(KB, "P' = 2 A P", r"P(t) = P(0) e^{2 A t}", "W = 0", "C = 0"),
    F(KB, "P' = 2 A P", r"P(t) = P(0) e^{A t}", "W = 0", "C = 0"),
    T(KB, "variation of constants", r"P(t) = e^{2 A t} P(0) + \frac{W}{2 A} (e^{2 A t} - 1)", r"A \ne 0", "C = 0"),
    F(KB, "sign", r"P(t) = e^{2 A t} P(0) - \frac{W}{2 A} (e^{2 A t} - 1)", r"A \ne 0", "C = 0"),
    T(
        KB, "1/P is linear",
        r"P(t) = \frac{P(0) e^{2 A t}}{1 + \frac{P(0) C^2}{2 A V} (e^{2 A t} - 1)}", r"A \ne 0", "W = 0",
    ),
    T(KB, "", r"e^{-A t} > 0"),
    T(KB, "the tangent", r"e^{A} \ge 1 + A"),
    F(KB, "A = 1", r"e^{A} = 1 + A"),
    T(KB, "", r"e^{2 A} = (e^{A})^2"),
    T(KB, "", r"e^{A} e^{-A} = 1"),
]  # fmt: skip

ROWS = [*STEPS, *SOLUTIONS, *ROOTS, *LOOPS, *BOUNDS, *DISCRETE, *REGULATOR, *NUMBERS]

CONTRADICTIONS = [
    (KB, ("V = 0",)), (KB, ("V = 1", "V = 2")), (KB, ("A > 1", "A < 0")), (KB, ("A > 0", "C = 0")), (KB, ("W = -1",)),
    (KB, ("W = 1", "P = 0")), (KB, ("W = 0", "A = 1", "P = 1", "C = 1", "V = 1")), (DT, ("C = 0", "A = 1")),
    (DT, ("Q > 0", "P = 0")), (DT, ("Q = 1", "P < 1")), (RD, ("B = 0", "A^2 > 1")), (CT, ("S < 0",)),
    (KB, ("A < C", "C < A")), (KB, ("A^2 + C^2 < 0",)),
]  # fmt: skip
