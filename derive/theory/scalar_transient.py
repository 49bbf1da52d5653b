"""The scalar Riccati differential equation in closed form for every start, its limit, sign and monotonicity."""

from __future__ import annotations

from dataclasses import replace

from derive.context import Theory
from derive.functions import Definite, Exp, Infinity, Limit, Quotient, Rate, Start
from derive.terms import Equation, Glyph, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, riccati, square


def bottom(A: Term, S: Term, g: Term, start: Term, h: Term) -> Term:
    """Return the denominator of the solution that starts at a covariance."""
    return ONE - (S + A - g * start) * h


def top(A: Term, W: Term, S: Term, start: Term, h: Term) -> Term:
    """Return the numerator of the solution that starts at a covariance."""
    return start * (ONE - (S - A) * h) + W * h


def declare(t: Theory) -> None:
    """Declare the elapsed time, the two starts and the solutions."""
    s = t.symbols
    A, W, g, S = (s[k] for k in ("A", "W", "g", "S"))
    time, tau = t.scalar("t", meaning="elapsed time"), t.scalar("τ", meaning="time")
    t.assume("t >= 0", time, "≥", text="time runs on")
    t.atom("exp", -2 * S * time, name="e^(-2St)")
    t.atom("integral", Exp(-2 * S * time), "e^(-2St) > 0", "integral of e^(-2Sτ)")
    h = t.scalar("h", meaning="integral of the decay")
    t.define("h", h, Definite(Exp(-2 * S * tau), tau, ZERO, time))
    for name, sub in (("P0", "0"), ("P1", "1")):
        start = t.scalar(name, Glyph("P", sub=sub), meaning="initial error covariance")
        t.assume(f"{name} >= 0", start, "≥", text="a covariance")
        denominator = bottom(A, S, g, start, h)
        t.atom("reciprocal", denominator, f"denominator of {name}", f"1/D{sub}")
        D = t.scalar(f"D{sub}", Glyph("D", sub=sub), meaning="denominator of the solution")
        t.define(f"D{sub}", D, denominator)
        P = t.scalar(f"P{sub}(t)", Glyph("P", sub=sub), meaning="error covariance after the time t")
        t.symbols[P.name] = P = replace(P, show_args=("t",))
        t.define(f"P{sub}(t)", P, Quotient(top(A, W, S, start, h), D))
    t.assume("P1 >= P0", s["P1"], "≥", s["P0"], "the second start is at least the first", case=True)
    t.assume("S > 0", S, ">", text="the closed loop is stable", case=True)
    t.atom("reciprocal", S, "S > 0", "1/S")
    t.assume("S = 0", S, "=", text="neither dynamics nor excitation", case=True)
    t.assume("P0 = 0", s["P0"], "=", text="a start without error", case=True)
    floor = S - A + g * s["P0"]
    t.assume("not (C W = 0, A > 0, P0 = 0)", floor, ">", case=True,
             text="the state is stable, or excited and seen, or the start is uncertain and seen")  # fmt: skip
    t.atom("reciprocal", floor, "not (C W = 0, A > 0, P0 = 0)", "1/floor")
    t.atom("reciprocal", ONE + g * s["P0"] * time, "1 + g P0 t > 0", "1/(1+gP0t)")
    t.assume("t > 0", time, ">", text="after the start", case=True)
    t.atom("reciprocal", time, "t > 0", "1/t")
    t.assume("P0 <= P", s["P"] - s["P0"], "≥", text="a start below the steady state", case=True)
    t.assume("P0 >= P", s["P0"] - s["P"], "≥", text="a start above the steady state", case=True)
    t.assume("S + A > 0", S + A, ">", text="the state is unstable, or excited and seen", case=True)
    t.atom("reciprocal", S + A, "S + A > 0", "1/(S+A)")
    decay = Exp(-2 * S * time)
    conjugate = Quotient(g * W, S + A)
    t.atom(
        "reciprocal", 2 * S * decay + (conjugate + g * s["P0"]) * (ONE - decay), "unstable denominator", "1/unstable"
    )
    t.atom("reciprocal", 2 * S * decay + floor * (ONE - decay), "explicit denominator", "1/explicit")


def derive(b: ScalarBuilder) -> None:
    """Derive the solution and what it does."""
    _derive_decay(b)
    _derive_solution(b)
    _derive_comparison(b)
    _derive_limit(b)
    _derive_special(b)


def _derive_decay(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    S, h, time = s["S"], s["h"], s["t"]
    decay = Exp(-2 * S * time)
    b.heading("The Riccati differential equation")
    b.say("Everything below is written with one function of time, which needs no cases: it is ", time, " if ", S)
    b.say("is zero, and ", Quotient(ONE - decay, 2 * S), " otherwise.")
    b.given("t >= 0", "h")
    b.sign("h >= 0", Equation(h, "≥", ZERO), "the integral of a positive function", ["integral of e^(-2Sτ) ≥ 0"])
    b.rate("decay", Equation(decay, "=", ONE - 2 * S * h), "same derivative, same value at the start")
    b.sign(
        "1 - 2 S h > 0", Equation(ONE - 2 * S * h, ">", ZERO), "an exponential is positive",
        ["e^(-2St) > 0"], identities=["decay"],
    )  # fmt: skip


def _derive_solution(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, h, start, D, P, time = (s[k] for k in ("A", "W", "g", "S", "h", "P0", "D0", "P0(t)", "t"))
    b.given("P0 >= 0")
    facts = ["1 - 2 S h > 0", "S - A >= 0", "h >= 0", "g >= 0"]
    for k in ("P0", "P1"):
        b.sign(
            f"denominator of {k}", Equation(bottom(A, S, g, s[k], h), ">", ZERO),
            "it is (1 - 2Sh) + (S - A)h + g h times the start", [*facts, f"{k} >= 0"],
        )  # fmt: skip
    b.say("So the denominator never vanishes, and the solution exists for all times:")
    b.given("D0", "P0(t)")
    b.state("start", Equation(Start(P, time), "=", start), "h vanishes at the start")
    b.state(
        "Riccati differential equation", Equation(Rate(P, time), "=", riccati(A, W, g, P)),
        "differentiate the quotient; h' = 1 - 2 S h and S^2 = A^2 + g W", ["decay"],
    )  # fmt: skip
    b.sign("D0 > 0", Equation(D, ">", ZERO), "the denominator", ["denominator of P0"])
    b.sign(
        "numerator", Equation(top(A, W, S, start, h), "≥", ZERO), "it is P0 ((1 - 2Sh) + (S + A)h) + W h",
        ["1 - 2 S h > 0", "S + A >= 0", "h >= 0", "P0 >= 0", "W >= 0"],
    )  # fmt: skip
    b.sign(
        "1/D0 > 0", Equation(Quotient(ONE, D), ">", ZERO), "a reciprocal has the sign of its number",
        ["denominator of P0"],
    )  # fmt: skip
    b.sign("P(t) >= 0", Equation(P, "≥", ZERO), "a quotient of such", ["1/D0 > 0", "numerator"])


def _derive_comparison(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, P0, P1, D0, D1, one, two, time = (
        s[k] for k in ("A", "W", "g", "S", "P0", "P1", "D0", "D1", "P0(t)", "P1(t)", "t")
    )
    decay = Exp(-2 * S * time)
    b.heading("Order and direction")
    b.say("Two solutions keep their order, and approach each other with the decay:")
    b.given("P1 >= P0")
    b.state(
        "difference of solutions", Equation(two - one, "=", Quotient((P1 - P0) * decay, D0 * D1)),
        "common denominator", ["decay"],
    )  # fmt: skip
    b.sign("1/D1 > 0", Equation(Quotient(ONE, D1), ">", ZERO), "as before", ["denominator of P1"])
    b.sign(
        "the solutions keep their order", Equation(two, "≥", one), "a product of nonnegative numbers",
        ["P1 >= P0", "e^(-2St) > 0", "1/D0 > 0", "1/D1 > 0"], identities=["difference of solutions"], degree=5,
    )  # fmt: skip
    b.say("Each solution moves in one direction, which the start decides:")
    b.state(
        "direction", Equation(Rate(one, time), "=", Quotient(riccati(A, W, g, P0) * decay, square(D0))),
        "differentiate the quotient", ["decay"],
    )  # fmt: skip
    P, other = s["P"], s["P-"]
    b.state("rate at the start", Equation(riccati(A, W, g, P0), "=", g * (P - P0) * (P0 - other)), "both roots")
    start, now = riccati(A, W, g, P0), Rate(one, time)
    for case, name, at_start, later in (("P0 <= P", "rises", start, now), ("P0 >= P", "falls", -start, -now)):
        b.given(case)
        b.sign(f"it {name} at the start", Equation(at_start, "≥", ZERO), "a product",
               [case, "g >= 0", "P0 >= 0", "P- <= 0"], identities=["rate at the start"])  # fmt: skip
        b.sign(f"it {name}", Equation(later, "≥", ZERO), "the rate at the start decides",
               [f"it {name} at the start", "e^(-2St) > 0"], squares=[Quotient(ONE, D0)],
               identities=["direction"])  # fmt: skip


def _derive_limit(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, h, P0, D0, P_t, P, time = (s[k] for k in ("A", "W", "g", "S", "h", "P0", "D0", "P0(t)", "P", "t"))
    decay = Exp(-2 * S * time)
    b.heading("The way to the steady state")
    b.state(
        "distance to the steady state", Equation(P_t - P, "=", Quotient((P0 - P) * decay, D0)),
        "common denominator; S^2 = A^2 + g W", ["decay"],
    )  # fmt: skip
    b.given("S > 0")
    b.state("integral of the decay", Equation(h, "=", Quotient(ONE - decay, 2 * S)), "solve for h", ["decay"])
    b.state("limit of the decay", Equation(Limit(decay, time, Infinity()), "=", ZERO), "S is positive")
    b.state(
        "limit of h", Equation(Limit(Quotient(ONE - decay, 2 * S), time, Infinity()), "=", Quotient(ONE, 2 * S)),
        "the decay vanishes",
    )  # fmt: skip
    b.say("The denominator tends to a positive number unless an unstable state is neither excited nor started with an")
    b.say("error that the output sees,")
    b.given("not (C W = 0, A > 0, P0 = 0)")
    floor = S - A + g * P0
    explicit = Quotient(2 * S * P0 * decay + (P0 * (S + A) + W) * (ONE - decay), 2 * S * decay + floor * (ONE - decay))
    b.sign(
        "explicit denominator", Equation(2 * S * decay + floor * (ONE - decay), ">", ZERO), "2 S times the denominator",
        ["denominator of P0", "S > 0"], identities=["decay"],
    )  # fmt: skip
    b.state("explicit solution", Equation(P_t, "=", explicit), "multiply by 2 S", ["decay"])
    steady = Quotient(P0 * (S + A) + W, floor)
    b.state(
        "limit",
        Equation(Limit(explicit, time, Infinity()), "=", steady),
        "the decay vanishes, the denominator does not",
    )
    b.state("the limit is the steady state", Equation(steady, "=", P), "S^2 = A^2 + g W")


def _derive_special(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    A, W, g, S, h, P0, P_t, time = (s[k] for k in ("A", "W", "g", "S", "h", "P0", "P0(t)", "t"))
    b.say("A stable state that the output does not see approaches its own covariance:")
    b.state("distance of an unseen state", Equation(P_t - s["p"], "=", (P0 - s["p"]) * Exp(-2 * S * time)),
            "the denominator is one", ["C = 0", "S = -A", "decay"])  # fmt: skip
    b.say("Started without error and without excitation, the error stays zero, whatever the upper root is:")
    b.given("P0 = 0")
    b.state("zero stays zero", Equation(P_t, "=", ZERO), "the numerator vanishes", ["P0 = 0", "W = 0"])
    b.say("Neither dynamics nor excitation: the double root is reached, but not exponentially.")
    b.given("S = 0")
    b.rate("h = t", Equation(h, "=", time), "same derivative, same value at the start", ["S = 0", "decay"])
    b.sign("1 + g P0 t > 0", Equation(ONE + g * P0 * time, ">", ZERO), "one plus nonnegative numbers",
           ["g >= 0", "P0 >= 0", "t >= 0"])  # fmt: skip
    b.state(
        "solution of an integrator", Equation(P_t, "=", Quotient(P0 + W * time, ONE + g * P0 * time)),
        "h = t", ["h = t", "S = 0", "A = 0"],
    )  # fmt: skip
    _derive_double_root(b)
    b.say("Where ", A, " is positive, ", S - A, " cancels; multiplied by its conjugate it does not:")
    b.given("S + A > 0")
    conjugate = Quotient(g * W, S + A)
    b.state("conjugate", Equation(S - A, "=", conjugate), "S^2 - A^2 = g W")
    decay = Exp(-2 * S * time)
    under = 2 * S * decay + (conjugate + g * P0) * (ONE - decay)
    b.sign("unstable denominator", Equation(under, ">", ZERO), "2 S times the denominator",
           ["explicit denominator"], identities=["conjugate"])  # fmt: skip
    over = 2 * S * P0 * decay + (P0 * (S + A) + W) * (ONE - decay)
    b.state("explicit, unstable", Equation(P_t, "=", Quotient(over, under)), "insert the conjugate",
            ["explicit solution", "conjugate", "decay"])  # fmt: skip


def _derive_double_root(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    g, P0, time = (s[k] for k in ("g", "P0", "t"))
    b.say("Without excitation that is at most ", Quotient(ONE, g * time), ", whatever the start:")
    b.given("t > 0")
    b.sign("g > 0", Equation(g, ">", ZERO), "a square that is not zero", ["C ≠ 0", "1/V > 0"])
    b.sign("1/g > 0", Equation(Quotient(ONE, g), ">", ZERO), "a reciprocal has the sign of its number", ["g > 0"])
    b.sign("1/t > 0", Equation(Quotient(ONE, time), ">", ZERO), "a reciprocal has the sign of its number", ["t > 0"])
    value, bound = Quotient(P0, ONE + g * P0 * time), Quotient(ONE, g * time)
    under = "1/(1 + g P0 t) > 0"
    b.sign(under, Equation(Quotient(ONE, ONE + g * P0 * time), ">", ZERO), "a reciprocal has the sign of its number",
           ["1 + g P0 t > 0"])  # fmt: skip
    b.sign("double root from above", Equation(bound, "≥", value), "leave out the one", ["1/g > 0", "1/t > 0", under])
    b.sign("double root from below", Equation(bound, "≥", -value), "the covariance is not negative",
           ["1/g > 0", "1/t > 0", under, "P0 >= 0"])  # fmt: skip
    b.linked("limit at the double root", Equation(Limit(value, time, Infinity()), "=", ZERO), "squeeze",
             "between bounds that vanish", ["double root from above", "double root from below"])  # fmt: skip
