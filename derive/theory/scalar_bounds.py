"""How long it takes to the steady state: explicit bounds on the error, and the time after which it is below any η.

|P(t) - P| <= c e^(-2St), c = |P(0) - P| (1 + 2S/(S - A + g P(0))); so it is below η from t = ln(1 + c/η)/(2S) on.
In discrete time T takes the place of 2S, ρ^k that of the exponential function, and -ln ρ that of the rate 2S.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.context import Theory
from derive.functions import Abs, Exp, Log, Quotient
from derive.terms import Equation, Glyph, Term
from derive.theory.scalar_builder import ScalarBuilder
from derive.theory.scalar_continuous import ONE, ZERO, square
from derive.theory.scalar_discrete import RECIPROCAL
from derive.theory.scalar_recursion import halves

FLOOR, FLOOR_D = "not (C W = 0, A > 0, P0 = 0)", "not (C Q = 0, A^2 > 1, P0 = 0)"
LATER, LATER_D = "t >= ln(1 + c/η)/(2S)", "k >= ln(1 + c/η)/(-ln ρ)"


@dataclass(frozen=True)
class Approach:
    """A covariance that tends to its steady value: gap = start * decay * share, and share <= factor.

    ``exponent`` is minus the logarithm of the decay; ``positive`` names the fact that the decay is.
    """

    sub: str
    start: Term
    gap: Term
    factor: Term
    decay: Term
    exponent: Term
    positive: str


def continuous(t: Theory) -> Approach:
    """Return the approach in continuous time."""
    A, S, g, P0, P, P_t, time = (t.symbols[k] for k in ("A", "S", "g", "P0", "P", "P0(t)", "t"))
    factor = ONE + Quotient(2 * S, S - A + g * P0)
    return Approach("", P0 - P, P_t - P, factor, Exp(-2 * S * time), 2 * S * time, "e^(-2St) > 0")


def floor_d(t: Theory) -> Term:
    """Return the denominator of the recursion after infinitely many steps."""
    return square(t.symbols["C"]) * t.symbols["P0"] + halves(t)[0]


def discrete(t: Theory) -> Approach:
    """Return the approach in discrete time."""
    T, rho, power, k, P0, M, P_k = (t.symbols[x] for x in ("T", "ρ", "ρ^k", "k", "P0", "M", "P_k"))
    factor = ONE + Quotient(T, floor_d(t))
    return Approach("_d", P0 - M, P_k - M, factor, power, -(k * Log(rho)), "ρ^k > 0")


def declare(t: Theory) -> None:
    """Declare the error allowed, the constants of both bounds, and the logarithms that the times are made of."""
    error = t.scalar("η", meaning="error allowed")
    t.assume("η > 0", error, ">", text="some error is allowed")
    t.atom("reciprocal", error, "η > 0", "1/η")
    t.atom("log", error, "η > 0", "ln η")
    t.atom("log", ONE, "1 > 0", "ln 1")
    _declare_approach(t, continuous(t), LATER)
    _declare_powers(t)
    _declare_approach(t, discrete(t), LATER_D)


def _declare_powers(t: Theory) -> None:
    rho, power, after = (t.symbols[x] for x in ("ρ", "ρ^k", "ρ^k+1"))
    t.assume(FLOOR_D, floor_d(t), ">", case=True,
             text="the state is stable, or excited and seen, or the start is uncertain and seen")  # fmt: skip
    t.atom("reciprocal", floor_d(t), FLOOR_D, "1/floor_d")
    t.assume("ρ > 0", rho, ">", text="the state remembers", case=True)
    for name, x, why in (("ρ", rho, "ρ > 0"), ("ρ^k", power, "ρ^k > 0"), ("ρ^(k+1)", after, "ρ^(k+1) > 0")):
        t.atom("log", x, why, f"ln {name}")


def _declare_approach(t: Theory, a: Approach, later: str) -> None:
    error = t.symbols["η"]
    t.atom("absolute", a.start, name="|start|" + a.sub)
    t.atom("absolute", a.gap, name="|error|" + a.sub)
    c = t.scalar("c" + a.sub, Glyph("c", sub=a.sub[1:]), meaning="constant of the bound")
    t.define("c" + a.sub, c, Abs(a.start) * a.factor)
    t.atom("reciprocal", a.decay, a.positive, "1/decay" + a.sub)
    larger = (error + c) * a.decay
    t.atom("reciprocal", larger, "(η + c) decay > 0" + a.sub, "1/larger" + a.sub)
    if a.decay != t.symbols.get("ρ^k"):
        t.atom("log", a.decay, a.positive, "ln decay" + a.sub)
    t.atom("log", error + c, "η + c > 0" + a.sub, "ln(η+c)" + a.sub)
    t.atom("log", larger, "(η + c) decay > 0" + a.sub, "ln larger" + a.sub)
    t.assume(later, a.exponent, "≥", Log(error + c) - Log(error), "later than η asks for", case=True)


def derive(b: ScalarBuilder) -> None:
    """Derive both bounds and both times."""
    _derive_continuous(b)
    _derive_time(b, continuous(b.theory), LATER, "logarithm of the decay")
    _derive_discrete(b)
    _derive_powers(b)
    _derive_time(b, discrete(b.theory), LATER_D, "ln ρ^k = k ln ρ")


def _derive_bound(b: ScalarBuilder, a: Approach, equation: str, share: tuple[str, str], decay: str) -> None:
    """Derive |gap| <= c decay; ``share`` names the facts that the share is positive, and at most the factor."""
    c, tail = b.theory.symbols["c" + a.sub], a.sub.replace("_d", " in discrete time")
    b.given("c" + a.sub)
    for sign, start, gap in (("", a.start, a.gap), ("-", -a.start, -a.gap)):
        b.sign(f"|start| >= {sign}start{tail}", Equation(Abs(a.start), "≥", start), "by its square",
               [f"|start|{a.sub} ≥ 0"])  # fmt: skip
        b.sign(f"c decay >= {sign}error{tail}", Equation(c * a.decay, "≥", gap), "insert the bound of the denominator",
               [f"|start| >= {sign}start{tail}", f"|start|{a.sub} ≥ 0", decay, *share],
               identities=[equation, "c" + a.sub], alone=True)  # fmt: skip
    both = [f"c decay >= {sign}error{tail}" for sign in ("", "-")]
    b.sign("bound of the error" + tail, Equation(c * a.decay, "≥", Abs(a.gap)), "both signs",
           [*both, f"|error|{a.sub} ≥ 0"], identities=["|error|" + a.sub], alone=True)  # fmt: skip
    b.sign("c >= 0" + a.sub, Equation(c, "≥", ZERO), "of nonnegative numbers",
           [f"|start|{a.sub} ≥ 0", *share])  # fmt: skip


def _derive_time(b: ScalarBuilder, a: Approach, later: str, logarithm: str) -> None:
    """Derive that the error is at most η from the time on that the case ``later`` names."""
    s, tail = b.theory.symbols, a.sub.replace("_d", " in discrete time")
    error, c = s["η"], s["c" + a.sub]
    larger = (error + c) * a.decay
    b.sign("η + c > 0" + a.sub, Equation(error + c, ">", ZERO), "of such", ["η > 0", "c >= 0" + a.sub], alone=True)
    b.sign("(η + c) decay > 0" + a.sub, Equation(larger, ">", ZERO), "a product", ["η + c > 0" + a.sub, a.positive],
           alone=True)  # fmt: skip
    b.sign("1/larger > 0" + a.sub, Equation(Quotient(ONE, larger), ">", ZERO), RECIPROCAL,
           ["(η + c) decay > 0" + a.sub], identities=["1/larger" + a.sub], alone=True)  # fmt: skip
    b.state("larger over decay" + a.sub, Equation(Quotient(larger, a.decay), "=", error + c), "cancel",
            ["1/decay" + a.sub])  # fmt: skip
    b.linked("logarithm of a product" + a.sub, Equation(Log(Quotient(larger, a.decay)), "=", Log(error + c)),
             "same argument", "the same", ["larger over decay" + a.sub])  # fmt: skip
    b.given(later)
    b.sign("enough" + a.sub, Equation(error, "≥", larger), "ln x is at most x - 1",
           [f"ln η - ln larger{a.sub} ≤", later, "1/larger > 0" + a.sub],
           identities=["logarithm of a product" + a.sub, logarithm, "1/larger" + a.sub], alone=True)  # fmt: skip
    b.sign("settled" + tail, Equation(error, "≥", Abs(a.gap)), "the bound is below η",
           ["enough" + a.sub, "bound of the error" + tail, "η > 0", a.positive], alone=True)  # fmt: skip


def _derive_continuous(b: ScalarBuilder) -> None:
    t = b.theory
    S, g, P0, D, time, error = (t.symbols[k] for k in ("S", "g", "P0", "D0", "t", "η"))
    a, floor = continuous(t), S - t.symbols["A"] + g * P0
    b.heading("How long it takes")
    b.say("The denominator is ", a.decay + floor * t.symbols["h"], "; its reciprocal has a bound without ", time, ":")
    b.given(FLOOR)
    b.sign("1/floor > 0", Equation(Quotient(ONE, floor), ">", ZERO), RECIPROCAL, [FLOOR])
    facts = ["1/floor > 0", FLOOR, "h >= 0", "S > 0", "e^(-2St) > 0"]
    b.sign("slack", Equation(a.factor * D, "≥", ONE), "multiply out", facts, identities=["decay"])
    b.sign("bound of 1/D", Equation(a.factor, "≥", Quotient(ONE, D)), "divide", ["slack", "1/D0 > 0"])
    _derive_bound(b, a, "distance to the steady state", ("1/D0 > 0", "bound of 1/D"), a.positive)
    b.say("So the error is below any ", error, " after a time that is known beforehand:")
    b.given("η > 0")
    b.sign("1 > 0", Equation(ONE, ">", ZERO), "a number", [])
    b.state("η over itself", Equation(Quotient(error, error), "=", ONE), "cancel")
    b.linked("logarithm of one", Equation(Log(Quotient(error, error)), "=", Log(ONE)), "same argument", "the same",
             ["η over itself"])  # fmt: skip
    b.rate("logarithm of the decay", Equation(Log(a.decay), "=", -a.exponent), "same derivative, same start",
           ["logarithm of one", "1/decay"])  # fmt: skip


def _derive_discrete(b: ScalarBuilder) -> None:
    t = b.theory
    lam, d, sigma, M, P, P0, power = (t.symbols[k] for k in ("λ", "dk", "σ", "M", "P_k", "P0", "ρ^k"))
    a, floor = discrete(t), floor_d(t)
    b.heading("How many steps it takes")
    b.say("Each step multiplies the distance to the steady state by ", t.symbols["ρ"], ", but for the denominator:")
    b.state(
        "distance in discrete time", Equation(P - M, "=", Quotient((P0 - M) * lam * power, d)), "common denominator",
        ["closed form", "the power as a sum"],
    )  # fmt: skip
    b.given(FLOOR_D)
    b.sign("1/floor > 0 in discrete time", Equation(Quotient(ONE, floor), ">", ZERO), RECIPROCAL, [FLOOR_D])
    b.state("denominator by the floor", Equation(d, "=", lam * power + floor * sigma), "insert the lower half",
            ["lower half", "d", "the power as a sum"])  # fmt: skip
    b.sign("slack in discrete time", Equation(a.factor * d, "≥", lam), "multiply out; T σ is λ (1 - ρ^k)",
           ["1/floor > 0 in discrete time", FLOOR_D, "σ >= 0", "T > 0", "ρ^k >= 0", "λ > 0"], degree=4,
           identities=["denominator by the floor", "sum of the powers", "1/floor_d"], alone=True)  # fmt: skip
    b.sign("λ/d > 0", Equation(Quotient(lam, d), ">", ZERO), "a quotient of such", ["λ > 0", "1/d > 0"], alone=True)
    b.sign("bound of λ/d", Equation(a.factor, "≥", Quotient(lam, d)), "divide", ["slack in discrete time", "1/d > 0"],
           identities=["1/d"], alone=True)  # fmt: skip
    _derive_bound(b, a, "distance in discrete time", ("λ/d > 0", "bound of λ/d"), "ρ^k >= 0")


def _derive_powers(b: ScalarBuilder) -> None:
    s = b.theory.symbols
    rho, power, after, k = (s[x] for x in ("ρ", "ρ^k", "ρ^k+1", "k"))
    b.say("A state that remembers has a power that is positive, with the logarithm ", k * Log(rho), ", by induction:")
    b.given("ρ > 0")
    b.induct("ρ^k > 0", Equation(power, ">", ZERO), "one at the start; then a product", ["ρ > 0"])
    b.sign("ρ^(k+1) > 0", Equation(after, ">", ZERO), "a product", ["ρ > 0", "ρ^k > 0"], identities=["power'"],
           alone=True)  # fmt: skip
    b.state("next power over this one", Equation(Quotient(after, power), "=", rho), "cancel", ["power'", "1/decay_d"])
    b.linked("logarithm of a step", Equation(Log(Quotient(after, power)), "=", Log(rho)), "same argument", "the same",
             ["next power over this one"])  # fmt: skip
    b.induct("ln ρ^k = k ln ρ", Equation(Log(power), "=", k * Log(rho)), "both are zero at the start; then add ln ρ",
             ["logarithm of one", "logarithm of a step"])  # fmt: skip
