"""The linear-quadratic regulator in discrete and in continuous time, by completing the square.

The input is u = -K x; S is the cost to go, which the Kalman filter's P mirrors.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from derive.context import Theory
from derive.terms import Dot, Equation, Glyph, Identity, Symbol, Term, Zero
from derive.theory.builder import Builder, SquareOf


@cache
def discrete() -> Theory:
    """Return the theory ``lqr-dt``: plant, cost, and the optimal input u = -K x."""
    t = Theory("lqr-dt", "Regulator in discrete time")
    declare_plant(t, "p")
    declare_discrete(t)
    t.assume("u = -K x", t.symbols["u_{k-1}"], "=", -(t.symbols["K"] * t.symbols["x_{k-1}"]))
    return t


@cache
def continuous() -> Theory:
    """Return the theory ``lqr-ct``: plant, cost, and the optimal input u = -K x."""
    t = Theory("lqr-ct", "Regulator in continuous time")
    declare_plant(t, "p")
    declare_continuous(t)
    t.assume("u = -K x", t.symbols["u"], "=", -(t.symbols["K"] * t.symbols["x"]))
    return t


# ------------------------------------------------------------------------------------------------ formulas
def weight(B: Term, S: Term, R: Term) -> Term:
    """Return the weight of the input and what it leads to, B' S B + R."""
    return B.T * S * B + R


def regulator_gain(A: Term, B: Term, S: Term, R: Term) -> Term:
    """Return the gain (B' S B + R)^-1 B' S A."""
    return weight(B, S, R).inv * B.T * S * A


def cost_to_go(A: Term, B: Term, S: Term, Q: Term, R: Term) -> Term:
    """Return the right-hand side of the Riccati equation.

    Q + A' S A - A' S B (B' S B + R)^-1 B' S A
    """
    return Q + A.T * S * A - A.T * S * B * weight(B, S, R).inv * B.T * S * A


def cost_of_gain(A: Term, B: Term, M: Term, S: Term, Q: Term, R: Term) -> Term:
    """Return the cost to go of the input u = -M x for one step, S from then on.

    Q + M' R M + (A - B M)' S (A - B M)
    """
    return Q + (A - B * M).T * S * (A - B * M) + M.T * R * M


def cost_rate(A: Term, B: Term, S: Term, Q: Term, R: Term) -> Term:
    """Return the Riccati expression in continuous time.

    A' S + S A + Q - S B R^-1 B' S
    """
    return A.T * S + S * A + Q - S * B * R.inv * B.T * S


# ------------------------------------------------------------------------------------------------ theories
def declare_plant(t: Theory, inputs: str, why: str = "every input costs") -> None:
    """Declare the matrices of plant and cost; ``inputs`` names the dimension of the input, ``why`` R > 0."""
    t.matrix("A", "n", "n", meaning="state matrix")
    t.matrix("B", "n", inputs, meaning="input matrix")
    t.assume("Q >= 0", t.matrix("Q", "n", "n", symmetric=True, meaning="cost of the state"), "⪰", text="a cost")
    R = t.matrix("R", inputs, inputs, symmetric=True, meaning="cost of the input")
    t.assume("R > 0", R, "≻", text=why)


def declare_discrete(t: Theory) -> None:
    """Declare the regulator in discrete time: cost to go over a finite horizon, and its limit."""
    A, B, Q, R = (t.symbols[k] for k in "ABQR")
    p = B.cols
    x = t.matrix("x_{k-1}", "n", "1", Glyph("x", sub="k-1"), meaning="state")
    after = t.matrix("x_k", "n", "1", Glyph("x", sub="k"), meaning="state")
    u = t.matrix("u_{k-1}", p, "1", Glyph("u", sub="k-1"), meaning="input, any")
    t.define("plant", after, A * x + B * u)
    S_k = t.matrix("S_k", "n", "n", Glyph("S", sub="k"), symmetric=True, meaning="cost to go")
    earlier = t.matrix("S_{k-1}", "n", "n", Glyph("S", sub="k-1"), symmetric=True, meaning="cost to go")
    K_k = t.matrix("K_{k-1}", p, "n", Glyph("K", sub="k-1"), meaning="optimal gain")
    S = t.matrix("S", "n", "n", symmetric=True, meaning="steady cost to go")
    K = t.matrix("K", p, "n", meaning="steady optimal gain")
    t.matrix("M", p, "n", meaning="another gain")
    for cost, reason, name in ((S_k, "input weight", "weight_k^-1"), (S, "steady input weight", "weight^-1")):
        t.assume(f"{cost.name} >= 0", cost, "⪰", text="a cost")
        t.inverse(name, weight(B, cost, R), p, symmetric=True, because=reason)
    t.define("optimal gain", K_k, regulator_gain(A, B, S_k, R))
    t.define("cost to go", earlier, cost_to_go(A, B, S_k, Q, R))
    t.define("steady cost to go", S, cost_to_go(A, B, S, Q, R))
    t.define("steady gain", K, regulator_gain(A, B, S, R))


def declare_continuous(t: Theory, steady: str = "") -> None:
    """Declare the regulator in continuous time; ``steady`` is what the names of steady letters end in."""
    A, B, Q, R = (t.symbols[k] for k in "ABQR")
    p, mark = B.cols, "∞" if steady else ""
    x = t.varying("x", "n", "1", meaning="state")
    u = t.varying("u", p, "1", meaning="input, any")
    t.define("plant in continuous time", Dot(x), A * x + B * u)
    S_t = at_time(t, "S_t", "n", "n", "S", "cost to go", symmetric=True)
    K_t = at_time(t, "K_t", p, "n", "K", "optimal gain")
    S = t.matrix(f"S{steady}", "n", "n", Glyph("S", sub=mark), symmetric=True, meaning="steady cost to go")
    K = t.matrix(f"K{steady}", p, "n", Glyph("K", sub=mark), meaning="steady optimal gain")
    t.inverse("R^-1", R, p, symmetric=True, because="R > 0")
    t.define("cost to go in continuous time", Dot(S_t), -cost_rate(A, B, S_t, Q, R))
    t.define("optimal gain in continuous time", K_t, R.inv * B.T * S_t)
    t.define("steady cost in continuous time", cost_rate(A, B, S, Q, R), Zero("n", "n"))
    t.define("steady gain in continuous time", K, R.inv * B.T * S)


def at_time(
    t: Theory, name: str, rows: str, cols: str, letter: str, meaning: str, *, symmetric: bool = False
) -> Symbol:
    """Declare a matrix that varies with time and prints with its argument, S(t)."""
    plain = t.varying(name, rows, cols, Glyph(letter), symmetric=symmetric, meaning=meaning)
    t.symbols[name] = replace(plain, show_args=None)
    return t.symbols[name]


# ------------------------------------------------------------------------------------------------ lecture
def derive_discrete(b: Builder) -> None:
    """Derive the regulator's gain and Riccati equation in discrete time."""
    s = b.theory.symbols
    A, B, Q, R, K, M = (s[k] for k in ("A", "B", "Q", "R", "K_{k-1}", "M"))
    x, after, u, S_k, earlier = (s[k] for k in ("x_{k-1}", "x_k", "u_{k-1}", "S_k", "S_{k-1}"))
    eye = Identity(B.cols)
    b.heading("The regulator in discrete time")
    b.say("A plant without noise is steered by its input,")
    b.given("plant")
    b.say("at the cost ", x.T * Q * x + u.T * R * u, " a step, with")
    b.given("Q >= 0", "R > 0")
    b.say("Let ", after.T * S_k * after, " be the least cost from the next step on,")
    b.given("S_k >= 0")
    b.say("The matrix")
    b.positive(
        "input weight",
        Equation(weight(B, S_k, R), "≻", Zero("", "")),
        "a congruence plus a positive matrix",
        [SquareOf(B.T, "S_k >= 0"), SquareOf(eye, "R > 0")],
        witness=eye,
    )
    b.say("has an inverse. With the gain and the matrix")
    b.given("optimal gain", "cost to go")
    b.say("the cost of any input is a part that no input changes, and a square:")
    chain = b.chain(x.T * Q * x + u.T * R * u + after.T * S_k * after)
    chain.to(x.T * Q * x + u.T * R * u + (A * x + B * u).T * S_k * (A * x + B * u), "insert the plant", ["plant"])
    square = (u + K * x).T * weight(B, S_k, R) * (u + K * x)
    using = ["optimal gain", "cost to go", "weight_k^-1"]
    chain.to(x.T * earlier * x + square, "complete the square in the input", using)
    chain.close("cost of an input")
    b.positive(
        "optimal input",
        Equation(x.T * Q * x + u.T * R * u + after.T * S_k * after, "⪰", x.T * earlier * x),
        "the square is not negative; it vanishes for the input -K x",
        [SquareOf((u + K * x).T, "input weight")],
        ["cost of an input"],
    )
    b.say("Written for the inputs u = -M x of any gain ", M, ", this is an identity between matrices:")
    b.state(
        "cost of a gain",
        Equation(cost_of_gain(A, B, M, S_k, Q, R), "=", earlier + (M - K).T * weight(B, S_k, R) * (M - K)),
        "complete the square in the gain",
        using,
    )
    b.positive(
        "cost to go >= 0",
        Equation(earlier, "⪰", Zero("", "")),
        "the cost of the gain K itself; so the step can be repeated",
        [SquareOf(Identity("n"), "Q >= 0"), SquareOf((A - B * K).T, "S_k >= 0"), SquareOf(K.T, "R > 0")],
        using,
    )
    _derive_steady(b)


def _derive_steady(b: Builder) -> None:
    s = b.theory.symbols
    A, B, Q, R, S, K, M = (s[k] for k in ("A", "B", "Q", "R", "S", "K", "M"))
    eye = Identity(B.cols)
    b.say("If the cost to go tends to a limit when the horizon is far away,")
    b.given("S >= 0")
    b.say("then the limit of the weight has an inverse too,")
    b.positive(
        "steady input weight",
        Equation(weight(B, S, R), "≻", Zero("", "")),
        "as before",
        [SquareOf(B.T, "S >= 0"), SquareOf(eye, "R > 0")],
        witness=eye,
    )
    b.say("and the limit is a fixed point of the step, with the gain that belongs to it:")
    b.given("steady cost to go", "steady gain")
    b.state(
        "steady cost of a gain",
        Equation(cost_of_gain(A, B, M, S, Q, R), "=", S + (M - K).T * weight(B, S, R) * (M - K)),
        "complete the square in the gain",
        ["steady cost to go", "steady gain", "weight^-1"],
    )


def derive_continuous(b: Builder) -> None:
    """Derive the regulator's gain and Riccati equation in continuous time."""
    s = b.theory.symbols
    A, B, Q, R, x, u, S, K = (s[k] for k in ("A", "B", "Q", "R", "x", "u", "S_t", "K_t"))
    b.heading("The regulator in continuous time")
    b.given("plant in continuous time")
    b.say("The cost to go ", S, " runs backwards from the end of the horizon, and with it a gain:")
    b.given("cost to go in continuous time", "optimal gain in continuous time")
    chain = b.chain(Dot(x.T * S * x) + x.T * Q * x + u.T * R * u)
    chain.to(
        (A * x + B * u).T * S * x
        + x.T * S * (A * x + B * u)
        - x.T * cost_rate(A, B, S, Q, R) * x
        + x.T * Q * x
        + u.T * R * u,
        "product rule and plant",
    )
    square = (u + K * x).T * R * (u + K * x)
    chain.to(square, "complete the square in the input", ["optimal gain in continuous time", "R^-1"])
    chain.close("rate of the cost")
    b.positive(
        "optimal input in continuous time",
        Equation(Dot(x.T * S * x) + x.T * Q * x + u.T * R * u, "⪰", Zero("", "")),
        "the square is not negative; it vanishes for the input -K x",
        [SquareOf((u + K * x).T, "R > 0")],
        ["rate of the cost"],
    )
    b.say(
        "Integrated over the horizon: the cost of any input is ",
        x.T * S * x,
        " at its beginning plus the integral of the square, so the input u = -K x has the least cost. In the steady "
        "state,",
    )
    b.given("steady cost in continuous time", "steady gain in continuous time")
