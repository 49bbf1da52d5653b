"""The scalar Riccati recursion: every step in closed form, a power of a Moebius map, by induction.

The power ρ^k is the sequence that starts at 1 and is multiplied by ρ at each step; σ_k is the sum of its first k
members. The covariance P_k is any sequence that starts at P_0 >= 0 and obeys the recursion, multiplied out.
"""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import Quotient, Start
from derive.terms import Equation, Glyph, Number, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL, recursion

HALF = Number(Fraction(1, 2))


def declare(t: Theory) -> None:
    """Declare the power, its sum, and the covariance after k steps."""
    A, C, Q, R, T = (t.symbols[k] for k in "ACQRT")
    t.scalar("k", meaning="number of steps")
    lam, rho = t.scalar("λ", meaning="steady innovation covariance"), t.scalar("ρ", meaning="decay a step")
    t.define("λ", lam, HALF * (square(A) * R + square(C) * Q + R + T))
    t.atom("reciprocal", lam, "λ > 0", "1/λ")
    t.define("ρ", rho, Quotient(square(A) * square(R), square(lam)))
    _declare_powers(t, rho)
    for name, s in (("", t.symbols["σ"]), ("'", t.symbols["σ'"])):
        sub = "k+1" if name else "k"
        n, d = (t.scalar(letter + sub, Glyph(letter, sub=sub)) for letter in "nd")
        t.define(f"n{name}", n, numerator(t, s))
        t.define(f"d{name}", d, denominator(t, s))
    t.atom("reciprocal", t.symbols["dk"], "d > 0", "1/d")
    _declare_covariance(t)
    _declare_cases(t)


def _declare_powers(t: Theory, rho: Term) -> None:
    power, sigma = t.scalar("ρ^k", Glyph("ρ", sup="k")), t.scalar("σ", Glyph("σ", sub="k"))
    after, next_sum = t.scalar("ρ^k+1", Glyph("ρ", sup="k+1")), t.scalar("σ'", Glyph("σ", sub="k+1"))
    t.sequence(power, ONE, after, "no factor")
    t.define("power'", after, rho * power, "one factor more")
    t.sequence(sigma, Number(Fraction(0)), next_sum, "the empty sum")
    t.define("σ'", next_sum, ONE + rho * sigma, "multiply by ρ and add the first power")


def _declare_covariance(t: Theory) -> None:
    A, C, Q, R = (t.symbols[k] for k in "ACQR")
    P = t.scalar("P_k", Glyph("P", sub="k"), meaning="covariance of the predicted state")
    after = t.scalar("P_k'", Glyph("P", sub="k+1"), meaning="the same, one step later")
    t.sequence(P, t.symbols["P0"], after, "the covariance at the start")
    below = square(C) * P + R
    t.recur("recursion", after * below, square(A) * P * R + Q * below, "for every k, multiplied out")
    t.atom("reciprocal", below, "C^2 P_k + R > 0", "1/(C^2 P_k+R)")


def _declare_cases(t: Theory) -> None:
    C, R, T, beta, k, start = (t.symbols[x] for x in ("C", "R", "T", "b", "k", "P0"))
    t.assume("b > 0", beta, ">", text="the root that grows", case=True)
    t.atom("reciprocal", T + beta, "T + b > 0", "1/(T+b)")
    t.assume("T = 0", T, "=", text="a mode on the circle that is not excited", case=True)
    t.atom("reciprocal", R + square(C) * start * k, "R + C^2 P0 k > 0", "1/(R+C^2P0k)")
    for name, parts in {"": halves(t), ", b > 0": growing(t), ", T > b": decaying(t)}.items():
        t.atom("reciprocal", bottom(t, parts[0]), "denominator of the recursion" + name, f"1/(denominator{name})")


def numerator(t: Theory, sigma: Term) -> Term:
    """Return the numerator of the covariance after the steps that sigma counts."""
    A, C, Q, R, lam, start = (t.symbols[k] for k in ("A", "C", "Q", "R", "λ", "P0"))
    return start * (lam + (square(A) * R + square(C) * Q - lam) * sigma) + Q * R * sigma


def denominator(t: Theory, sigma: Term) -> Term:
    """Return the denominator of the covariance after the steps that sigma counts."""
    C, R, lam, start = (t.symbols[k] for k in ("C", "R", "λ", "P0"))
    return lam + (square(C) * start + R - lam) * sigma


def halves(t: Theory) -> tuple[Term, Term]:
    """Return (T - b)/2 and (T + b)/2."""
    T, beta = t.symbols["T"], t.symbols["b"]
    return HALF * (T - beta), HALF * (T + beta)


def growing(t: Theory) -> tuple[Term, Term]:
    """Return the same two numbers, the first without cancellation where b > 0."""
    C, Q, R, T, beta = (t.symbols[k] for k in "CQRTb")
    return Quotient(2 * square(C) * Q * R, T + beta), HALF * (T + beta)


def decaying(t: Theory) -> tuple[Term, Term]:
    """Return the same two numbers, the second without cancellation where T > b."""
    C, Q, R, T, beta = (t.symbols[k] for k in "CQRTb")
    return HALF * (T - beta), Quotient(2 * square(C) * Q * R, T - beta)


def top(t: Theory, large: Term) -> Term:
    """Return the numerator of the explicit covariance after k steps."""
    Q, R, T, start, power = (t.symbols[k] for k in ("Q", "R", "T", "P0", "ρ^k"))
    return start * (T * power + large * (ONE - power)) + Q * R * (ONE - power)


def bottom(t: Theory, small: Term) -> Term:
    """Return the denominator of the explicit covariance after k steps."""
    C, T, start, power = (t.symbols[k] for k in ("C", "T", "P0", "ρ^k"))
    return T * power + (square(C) * start + small) * (ONE - power)


def explicit(t: Theory, parts: tuple[Term, Term]) -> Quotient:
    """Return the covariance after k steps by (T - b)/2 and (T + b)/2, in one of their forms."""
    small, large = parts
    return Quotient(top(t, large), bottom(t, small))


def derive(b: ScalarBuilder) -> None:
    """Derive the recursion and its explicit forms."""
    _derive_power(b)
    _derive_quotient(b)
    _derive_covariance(b)
    _derive_filtered(b)
    _derive_explicit(b)
    _derive_circle(b)


def _derive_power(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, sigma, lam, rho, power = (s[k] for k in ("A", "C", "Q", "R", "σ", "λ", "ρ", "ρ^k"))
    b.heading("Every step of the recursion")
    b.say("The covariance ", s["P_k"], " after ", s["k"], " steps is a sequence that obeys")
    b.given("P_k at the start", "recursion")
    b.say("so that nothing is assumed of a denominator. Each step is a Moebius map; its powers are written with")
    b.sign("λ > 0", Equation(lam, ">", ZERO), "R is positive", ["T >= 0", "R > 0", "Q >= 0"], squares=[A, C])
    b.given("λ", "ρ")
    b.sign("1/λ > 0", Equation(Quotient(ONE, lam), ">", ZERO), RECIPROCAL, ["λ > 0"])
    b.sign("ρ >= 0", Equation(rho, "≥", ZERO), "a square", [], squares=[Quotient(A * R, lam)])
    b.say("with the powers of ", rho, ", and the sum of the first ", s["k"], " of them:")
    b.given("ρ^k at the start", "power'", "σ at the start", "σ'")
    b.say(
        "What holds at the start, and one step later whenever it holds after ", s["k"],
        " steps, holds after every number of steps. By this induction:",
    )  # fmt: skip
    b.induct("ρ^k >= 0", Equation(power, "≥", ZERO), "one at the start; then a product", ["ρ >= 0"])
    b.induct("σ >= 0", Equation(sigma, "≥", ZERO), "zero at the start; then one and a product", ["ρ >= 0"])
    b.induct(
        "the power as a sum", Equation(power, "=", ONE - (ONE - rho) * sigma), "one at the start; then insert both"
    )
    b.state(
        "characteristic equation", Equation(lam * (ONE + rho), "=", square(A) * R + square(C) * Q + R),
        "T^2 = (trace)^2 - 4 det",
    )  # fmt: skip
    small, large = halves(b.theory)
    b.state("upper half", Equation(lam - R, "=", large), "insert both")
    b.state("lower half", Equation(R - lam * rho, "=", small), "λ + λ ρ is the trace")


def _derive_quotient(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, lam, rho, start = (s[k] for k in ("A", "C", "Q", "R", "λ", "ρ", "P0"))
    n, d, n_next, d_next, power, sigma = (s[k] for k in ("nk", "dk", "nk+1", "dk+1", "ρ^k", "σ"))
    small, large = halves(b.theory)
    b.say("The covariance will turn out to be the quotient of")
    b.given("n", "d")
    b.say("where the denominator is positive for every ", s["k"], ", whatever the start:")
    b.given("n'", "d'")
    b.state("denominator from the one before", Equation(d_next, "=", rho * d + square(C) * start + small),
            "insert the sum", ["lower half"])  # fmt: skip
    b.induct("d > 0", Equation(d, ">", ZERO), "λ at the start; then ρ and (T - b)/2 are not both zero",
             ["λ > 0", "ρ >= 0", "T - b >= 0", "R > 0", "P0 >= 0"], squares=[C],
             identities=["denominator from the one before", "lower half"])  # fmt: skip
    b.state("numerator by the power", Equation(n, "=", start * (lam * power + large * sigma) + Q * R * sigma),
            "insert the power", ["the power as a sum", "upper half", "characteristic equation"])  # fmt: skip
    b.sign("n >= 0", Equation(n, "≥", ZERO), "of nonnegative numbers",
           ["P0 >= 0", "λ > 0", "ρ^k >= 0", "T + b >= 0", "σ >= 0", "Q >= 0", "R > 0"],
           identities=["numerator by the power"], alone=True)  # fmt: skip
    b.say("From each step to the next both change by the rows of the matrix of the map, but for the factor ", lam, ":")
    b.state("next denominator", Equation(lam * d_next, "=", square(C) * n + R * d), "the lower row")
    upper = (square(A) * R + square(C) * Q) * n + Q * R * d
    b.state("next numerator", Equation(lam * n_next, "=", upper), "the upper row")


def _derive_covariance(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, n, d, P = (s[k] for k in ("A", "C", "Q", "R", "nk", "dk", "P_k"))
    b.induct(
        "closed form, multiplied out", Equation(P * d, "=", n),
        "the first covariance is λ P_0/λ; one step later, by both rows and the recursion",
        ["recursion", "next denominator", "next numerator"],
    )  # fmt: skip
    b.state("closed form", Equation(P, "=", Quotient(n, d)), "the denominator is positive",
            ["closed form, multiplied out"])  # fmt: skip
    b.state("start of the closed form", Equation(Start(Quotient(n, d), s["k"]), "=", s["P0"]), "λ P_0/λ")
    b.say("It is a covariance, and the recursion never divides by zero:")
    b.sign("1/d > 0", Equation(Quotient(ONE, d), ">", ZERO), RECIPROCAL, ["d > 0"], identities=["1/d"], alone=True)
    b.sign("P_k >= 0", Equation(P, "≥", ZERO), "a quotient of such", ["n >= 0", "1/d > 0"], identities=["closed form"],
           alone=True)  # fmt: skip
    b.sign("C^2 P_k + R > 0", Equation(square(C) * P + R, ">", ZERO), "an innovation covariance", ["P_k >= 0", "R > 0"],
           squares=[C], alone=True)  # fmt: skip
    b.state("recursion as a quotient", Equation(s["P_k'"], "=", recursion(A, C, Q, R, P)), "divide", ["recursion"])


def _derive_filtered(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    C, Q, R, T, lam, M = (s[k] for k in ("C", "Q", "R", "T", "λ", "M"))
    b.say("The letters name what the steady state has already:")
    b.state("steady innovation covariance", Equation(lam, "=", square(C) * M + R), "insert the root")
    over, below = Quotient(s["b"] + T, 2 * square(C)), Quotient(2 * Q * R, T - s["b"])
    b.state(
        "filtered covariance in closed form", Equation(s["M+"], "=", Quotient(over * R, lam)), "the same denominator"
    )
    b.state(
        "filtered covariance without a division by C", Equation(s["M+"], "=", Quotient(below * R, lam)),
        "the other form of the root", ["filtered covariance in closed form", "same discrete covariance"],
    )  # fmt: skip
    b.state("predictor gain", Equation(s["L"], "=", Quotient(s["A"] * s["C"] * over, lam)), "the same denominator")
    b.state("predictor gain without a division by C", Equation(s["L"], "=", Quotient(s["A"] * s["C"] * below, lam)),
            "the other form of the root", ["predictor gain", "same discrete covariance"])  # fmt: skip
    b.state("double root on the circle, gain", Equation(s["L"], "=", ZERO), "insert it", ["double root on the circle"])
    b.state("predictor loop", Equation(s["A"] - s["L"] * C, "=", Quotient(s["A"] * R, lam)), "the same denominator",
            ["discrete closed loop", "steady innovation covariance"])  # fmt: skip
    m = s["m"]
    gain = Quotient(s["A"] * m * C, square(C) * m + R)
    b.state(
        "innovation covariance without a division by C", Equation(square(C) * m + R, "=", lam), "T^2 - b^2 = 4 C^2 Q R"
    )
    b.state("predictor loop without a division by C", Equation(s["A"] - gain * C, "=", Quotient(s["A"] * R, lam)),
            "the same denominator")  # fmt: skip


def _derive_explicit(b: ScalarBuilder) -> None:
    t = b.theory
    s = t.symbols
    C, Q, R, T, lam, rho, sigma, power, P = (s[k] for k in ("C", "Q", "R", "T", "λ", "ρ", "σ", "ρ^k", "P_k"))
    b.say("With the sum of the powers, the covariance after ", s["k"], " steps has the form that it has in continuous")
    b.say("time:")
    small, large = halves(t)
    b.state("decay from the root", Equation(rho, "=", ONE - Quotient(T, lam)), "add both halves",
            ["upper half", "lower half"])  # fmt: skip
    b.state("sum of the powers", Equation(T * sigma, "=", lam * (ONE - power)), "T = λ (1 - ρ)",
            ["the power as a sum", "decay from the root"])  # fmt: skip
    b.given("T > 0")
    under = bottom(t, small)
    b.state("T times the denominator", Equation(T * s["dk"], "=", lam * under), "insert the halves",
            ["decay from the root", "lower half", "sum of the powers", "d", "the power as a sum"])  # fmt: skip
    b.sign("denominator of the recursion", Equation(under, ">", ZERO), "divide by λ", ["T > 0", "d > 0", "1/λ > 0"],
           identities=["T times the denominator", "1/λ"], alone=True)  # fmt: skip
    b.state("T times the numerator", Equation(T * s["nk"], "=", lam * top(t, large)), "insert the halves",
            ["decay from the root", "upper half", "lower half", "sum of the powers", "n",
             "the power as a sum"])  # fmt: skip
    b.state("explicit recursion", Equation(P, "=", explicit(t, halves(t))), "divide both",
            ["closed form", "T times the numerator", "T times the denominator"])  # fmt: skip
    b.say("Each half is the product ", square(C) * Q * R, " over the other; that one is taken which does not cancel.")
    b.given("b > 0")
    b.sign("T + b > 0", Equation(T + s["b"], ">", ZERO), "of positive numbers", ["b > 0", "T >= 0"])
    for name, parts, half, other in ((", b > 0", growing(t), small, 0), (", T > b", decaying(t), large, 1)):
        b.state("half" + name, Equation(half, "=", parts[other]), "T^2 - b^2 = 4 C^2 Q R")
        b.sign("denominator of the recursion" + name, Equation(bottom(t, parts[0]), ">", ZERO), "the same",
               ["denominator of the recursion"], identities=["half" + name])  # fmt: skip
        b.state("explicit recursion" + name, Equation(P, "=", explicit(t, parts)), "insert the half",
                ["explicit recursion", "half" + name])  # fmt: skip


def _derive_circle(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    C, Q, R, T, beta, k, P, start = (s[x] for x in ("C", "Q", "R", "T", "b", "k", "P_k", "P0"))
    b.say("Where ", T, " is zero nothing decays; then the sum counts the steps.")
    b.given("T = 0")
    b.equal("b = 0", Equation(beta, "=", ZERO), ["Q >= 0", "R > 0"], identities=["T = 0"], squares=[C])
    b.induct("k >= 0", Equation(k, "≥", ZERO), "zero at the start; then one more")
    b.induct("counting", Equation(s["σ"], "=", k), "zero at the start; then one more, because ρ is one",
             ["decay from the root", "T = 0"])  # fmt: skip
    b.sign("R + C^2 P0 k > 0", Equation(R + square(C) * start * k, ">", ZERO), "of nonnegative numbers",
           ["R > 0", "P0 >= 0", "k >= 0"], squares=[C])  # fmt: skip
    b.state(
        "recursion on the circle", Equation(P, "=", Quotient((start + Q * k) * R, R + square(C) * start * k)),
        "λ is R", ["b = 0", "T = 0", "counting", "closed form"],
    )  # fmt: skip
    b.say("Started without error and without noise, the error stays zero here as well:")
    b.state("zero stays zero in discrete time", Equation(P, "=", ZERO), "the numerator vanishes",
            ["P0 = 0", "Q = 0", "closed form"])  # fmt: skip
