"""The scalar Riccati recursion: every step in closed form, a power of a Moebius map, by induction.

The power ρ^k is the sequence that starts at 1 and is multiplied by ρ at each step; σ is the sum of its first k members.
What holds at the start and, if it holds for k, for k + 1, are two steps with a certificate each. That both together
make it hold for every k is the principle of induction: the text says so, no certificate does.
"""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import Quotient
from derive.terms import Equation, Glyph, Number, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL, recursion

HALF = Number(Fraction(1, 2))
HYPOTHESIS = "the induction hypothesis"
CLAIMS = ("ρ^k >= 0", "σ >= 0", "N_k >= 0", "D_k > 0")


def declare(t: Theory) -> None:
    """Declare the power, its sum, and the covariance after k and k + 1 steps."""
    A, C, Q, R, T = (t.symbols[k] for k in "ACQRT")
    k = t.scalar("k", meaning="number of steps")
    t.assume("k >= 0", k, "≥", text="steps are counted from the start")
    sigma = t.scalar("σ", Glyph("σ", sub="k"), meaning="1 + ρ + ... + ρ^{k-1}")
    after = t.scalar("σ'", Glyph("σ", sub="k+1"), meaning="the next of these sums")
    lam, rho = t.scalar("λ", meaning="steady innovation covariance"), t.scalar("ρ", meaning="decay a step")
    t.define("λ", lam, HALF * (square(A) * R + square(C) * Q + R + T))
    t.atom("reciprocal", lam, "λ > 0", "1/λ")
    t.define("ρ", rho, Quotient(square(A) * square(R), square(lam)))
    t.define("σ'", after, ONE + rho * sigma)
    for name, s in (("", sigma), ("'", after)):
        _declare_step(t, name, s, "k+1" if name else "k")
    t.atom("reciprocal", square(C) * t.symbols["P_k"] + R, "C^2 P_k + R > 0", "1/(C^2 P_k+R)")
    t.assume("σ = 0", sigma, "=", text="the empty sum", case=True)
    _declare_cases(t)


def _declare_step(t: Theory, name: str, sigma: Term, sub: str) -> None:
    power = t.scalar(f"ρ^{sub}", Glyph("ρ", sup=sub), meaning=f"the power of ρ after {sub} steps")
    over, under = numerator(t, sigma), denominator(t, sigma)
    if not name:
        t.assume("σ >= 0", sigma, "≥", text=HYPOTHESIS, case=True)
        t.assume("N_k >= 0", over, "≥", text=HYPOTHESIS, case=True)
        t.assume("D_k > 0", under, ">", text=HYPOTHESIS, case=True)
    t.define(f"power{name}", power, ONE - (ONE - t.symbols["ρ"]) * sigma)
    if not name:
        t.assume("ρ^k >= 0", power, "≥", text=HYPOTHESIS, case=True)
    n, d = (t.scalar(letter + sub, Glyph(letter, sub=sub)) for letter in "nd")
    t.define(f"n{name}", n, over)
    t.define(f"d{name}", d, under)
    t.atom("reciprocal", d, f"d{name} > 0", f"1/d{name}")
    P = t.scalar(f"P_k{name}", Glyph("P", sub=sub), meaning="covariance of the predicted state")
    t.define(f"P_k{name}", P, Quotient(n, d))


def _declare_cases(t: Theory) -> None:
    C, R, T, beta, sigma, start = (t.symbols[k] for k in ("C", "R", "T", "b", "σ", "P0"))
    t.assume("b > 0", beta, ">", text="the root that grows", case=True)
    t.atom("reciprocal", T + beta, "T + b > 0", "1/(T+b)")
    t.assume("T = 0", T, "=", text="a mode on the circle that is not excited", case=True)
    t.atom("reciprocal", R + square(C) * start * sigma, "R + C^2 P0 σ > 0", "1/(R+C^2P0σ)")
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
    _derive_start(b)
    _derive_next(b)
    _derive_filtered(b)
    _derive_explicit(b)
    _derive_circle(b)


def _derive_power(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, sigma, lam, rho, P = (s[k] for k in ("A", "C", "Q", "R", "σ", "λ", "ρ", "P_k"))
    b.heading("Every step of the recursion")
    b.say("The recursion ", Equation(s["P_k'"], "=", recursion(A, C, Q, R, P)), " is a Moebius map; its powers are")
    b.say("written with")
    b.sign("λ > 0", Equation(lam, ">", ZERO), "R is positive", ["T >= 0", "R > 0", "Q >= 0"], squares=[A, C])
    b.given("λ", "ρ")
    b.say("and the sums ", Equation(sigma, "=", ONE + rho), " + ... of its first powers, which obey")
    b.given("σ'", "power", "power'")
    b.state(
        "characteristic equation", Equation(lam * (ONE + rho), "=", square(A) * R + square(C) * Q + R),
        "T^2 = (trace)^2 - 4 det",
    )  # fmt: skip
    b.say("So the power starts at one and is multiplied by ", rho, " at each step, as a power is:")
    b.state("sum of no power", Equation(sigma, "=", ZERO), "the empty sum", ["σ = 0"])
    b.state("power at the start", Equation(s["ρ^k"], "=", ONE), "the empty sum", ["σ = 0"])
    b.state("the power as a sum", Equation(s["ρ^k+1"], "=", rho * s["ρ^k"]), "insert both")


def _derive_start(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    n, d, sigma, P, power, start = (s[k] for k in ("nk", "dk", "σ", "P_k", "ρ^k", "P0"))
    b.say("The claim, for every number of steps, is")
    b.given("n", "d", *CLAIMS)
    b.sign("d > 0", Equation(d, ">", ZERO), HYPOTHESIS, ["D_k > 0"])
    b.sign("n >= 0", Equation(n, "≥", ZERO), HYPOTHESIS, ["N_k >= 0"])
    b.given("P_k")
    b.say("It holds at the start,")
    b.state("induction start", Equation(P, "=", start), "the empty sum", ["σ = 0"])
    b.sign("sum at the start", Equation(sigma, "≥", ZERO), "the empty sum", [], identities=["σ = 0"])
    b.sign("power at the start >= 0", Equation(power, "≥", ZERO), "one", [], identities=["σ = 0"])
    b.sign("numerator at the start", Equation(n, "≥", ZERO), "the empty sum", ["P0 >= 0", "λ > 0"],
           identities=["σ = 0"])  # fmt: skip
    b.sign("denominator at the start", Equation(d, ">", ZERO), "the empty sum", ["λ > 0"], identities=["σ = 0"])


def _derive_next(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, C, Q, R, lam, rho, P = (s[k] for k in ("A", "C", "Q", "R", "λ", "ρ", "P_k"))
    n, d, n_next, d_next = (s[k] for k in ("nk", "dk", "nk+1", "dk+1"))
    b.say("and from each step to the next:")
    b.given("n'", "d'")
    b.sign("1/λ > 0", Equation(Quotient(ONE, lam), ">", ZERO), RECIPROCAL, ["λ > 0"])
    b.sign("ρ >= 0", Equation(rho, "≥", ZERO), "a square", [], squares=[Quotient(A * R, lam)])
    b.sign("next sum", Equation(s["σ'"], "≥", ZERO), "one and a nonnegative number", ["ρ >= 0", "σ >= 0"])
    b.sign("next power", Equation(s["ρ^k+1"], "≥", ZERO), "a product", ["ρ >= 0", "ρ^k >= 0"],
           identities=["the power as a sum"])  # fmt: skip
    upper, lower = (square(A) * R + square(C) * Q) * n + Q * R * d, square(C) * n + R * d
    b.state("next denominator", Equation(lam * d_next, "=", lower), "the lower row of the Moebius matrix")
    b.state("next numerator", Equation(lam * n_next, "=", upper), "the upper row")
    facts = ["n >= 0", "d > 0", "R > 0"]
    b.sign("lower row", Equation(lower, ">", ZERO), "as " + HYPOTHESIS + " says", facts, squares=[C])
    b.sign("upper row", Equation(upper, "≥", ZERO), "as " + HYPOTHESIS + " says", [*facts, "Q >= 0"], squares=[A, C])
    rows = ("d' > 0", d_next, ">", "lower row", "denominator"), ("n' >= 0", n_next, "≥", "upper row", "numerator")
    for name, x, relation, row, link in rows:
        b.sign(name, Equation(x, relation, ZERO), "divide by λ", [row, "1/λ > 0"], identities=["next " + link, "1/λ"],
               alone=True)  # fmt: skip
    b.given("P_k'")
    b.sign("1/d > 0", Equation(Quotient(ONE, d), ">", ZERO), RECIPROCAL, ["d > 0"], identities=["1/d"], alone=True)
    b.sign("P_k >= 0", Equation(P, "≥", ZERO), "a quotient of such", ["n >= 0", "1/d > 0"], identities=["P_k"],
           alone=True)  # fmt: skip
    b.sign("C^2 P_k + R > 0", Equation(square(C) * P + R, ">", ZERO), "an innovation covariance", ["P_k >= 0", "R > 0"],
           squares=[C], alone=True)  # fmt: skip
    b.state(
        "induction step", Equation(s["P_k'"], "=", recursion(A, C, Q, R, P)), "both rows",
        ["next numerator", "next denominator", "P_k", "P_k'"],
    )  # fmt: skip
    b.say("A sequence is determined by its start and by the way from each member to the next. This principle of")
    b.say("induction is the one thing here that rests on the text and on no certificate.")


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
    b.state("upper half", Equation(lam - R, "=", large), "insert both")
    b.state("lower half", Equation(R - lam * rho, "=", small), "λ + λ ρ is the trace")
    b.state("decay from the root", Equation(rho, "=", ONE - Quotient(T, lam)), "add both halves",
            ["upper half", "lower half"])  # fmt: skip
    b.state("sum of the powers", Equation(T * sigma, "=", lam * (ONE - power)), "T = λ (1 - ρ)")
    b.given("T > 0")
    under = bottom(t, small)
    b.state("T times the denominator", Equation(T * s["dk"], "=", lam * under), "insert the halves",
            ["decay from the root", "lower half", "sum of the powers", "d", "power"])  # fmt: skip
    b.sign("denominator of the recursion", Equation(under, ">", ZERO), "divide by λ", ["T > 0", "d > 0", "1/λ > 0"],
           identities=["T times the denominator", "1/λ"], alone=True)  # fmt: skip
    b.state("T times the numerator", Equation(T * s["nk"], "=", lam * top(t, large)), "insert the halves",
            ["decay from the root", "upper half", "lower half", "sum of the powers", "n", "power"])  # fmt: skip
    b.state("explicit recursion", Equation(P, "=", explicit(t, halves(t))), "divide both")
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
    C, Q, R, T, beta, sigma, P, start = (s[k] for k in ("C", "Q", "R", "T", "b", "σ", "P_k", "P0"))
    b.say("Where ", T, " is zero nothing decays; then the sum counts the steps.")
    b.given("T = 0")
    b.equal("b = 0", Equation(beta, "=", ZERO), ["Q >= 0", "R > 0"], identities=["T = 0"], squares=[C])
    b.state("counting", Equation(s["σ'"], "=", ONE + sigma), "ρ is one", ["decay from the root", "T = 0"])
    b.sign("R + C^2 P0 σ > 0", Equation(R + square(C) * start * sigma, ">", ZERO), "of nonnegative numbers",
           ["R > 0", "P0 >= 0", "σ >= 0"], squares=[C])  # fmt: skip
    b.state(
        "recursion on the circle", Equation(P, "=", Quotient((start + Q * sigma) * R, R + square(C) * start * sigma)),
        "λ is R", ["b = 0", "T = 0"],
    )  # fmt: skip
    b.say("Started without error and without noise, the error stays zero here as well:")
    b.state("zero stays zero in discrete time", Equation(P, "=", ZERO), "the numerator vanishes", ["P0 = 0", "Q = 0"])
