"""The optimal Luenberger observer: error and its covariance, the optimal gain, the Riccati equation in discrete time.

Source: lecture notes "Optimal Luenberger Observer", equations (1)-(5). The error is e = xhat - x; the gain belongs to
the predictor, which estimates x_k from the outputs up to y_{k-1}. The cross-covariance S = E[w v'], which the source
takes as zero, is carried along until it is set to zero.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Lecture, Step
from derive.terms import Equation, Expect, Glyph, Gradient, Identity, Trace, Zero, block
from derive.theory import luenberger_errata as errata
from derive.theory import luenberger_filter, luenberger_steady
from derive.theory import luenberger_formulas as formulas
from derive.theory.builder import Builder, SquareOf
from derive.theory.luenberger_errata import SOURCE
from derive.theory.luenberger_formulas import (
    any_gain,
    covariance,
    innovation,
    riccati_step,
    riccati_step_with_cross,
    signal,
)

KEY, THEORY = "luenberger", "luenberger-dt"


@cache
def theory() -> Theory:
    """Return the theory ``luenberger-dt``: plant, observer, noise, optimal gain, steady state, filter form."""
    t = Theory(THEORY, "Observer in discrete time")
    _plant(t)
    _noise(t)
    _optimum(t)
    luenberger_steady.declare(t)
    luenberger_filter.declare(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = Builder(theory(), KEY, "The optimal Luenberger observer", (SOURCE,))
    _derive_error(b)
    _derive_covariance(b)
    _derive_gain(b)
    _derive_riccati(b)
    luenberger_steady.derive(b)
    luenberger_filter.derive(b)
    return b.lecture()


def error_recursion() -> Step:
    """Return the proved recursion e_k = (A - L_k C) e_{k-1} + L_k v_{k-1} - w_{k-1}, equation (2) with its sign."""
    return lecture().step("error recursion")


def covariance_recursion() -> Step:
    """Return the proved recursion P_k = Q + (A - L_k C) P_{k-1} (A - L_k C)' + L_k R L_k', equation (2)."""
    return lecture().step("covariance recursion")


def gain() -> Step:
    """Return the proved optimal gain L_k = A P_{k-1} C' (C P_{k-1} C' + R)^-1, equation (3) with its A."""
    return lecture().step("gain")


def optimality() -> Step:
    """Return the proof that no gain gives a smaller covariance, in the Loewner order."""
    return lecture().step("Loewner minimum")


def riccati() -> Step:
    """Return the proved Riccati difference equation (4)."""
    return lecture().step("Riccati recursion")


def algebraic_riccati() -> Step:
    """Return the proved algebraic Riccati equation (5)."""
    return lecture().step("Riccati equation")


def steady_gain() -> Step:
    """Return the proved gain of the infinite horizon, L = A P C' (C P C' + R)^-1."""
    return lecture().step("steady gain")


# ------------------------------------------------------------------------------------------------ theory
def _plant(t: Theory) -> None:
    A = t.matrix("A", "n", "n", meaning="state matrix")
    B = t.matrix("B", "n", "p", meaning="input matrix")
    C = t.matrix("C", "l", "n", meaning="output matrix")
    L = t.matrix(
        "L_k", "n", "l", Glyph("L", sub="k"), parameter=False, meaning="observer gain", unit="[state]/[output]"
    )
    t.direction(L)
    u = signal(t, "u_{k-1}", "p", Glyph("u", sub="k-1"), "input", "any")
    for i in ("k-1", "k"):
        key = i if i == "k" else "{k-1}"
        x = signal(t, f"x_{key}", "n", Glyph("x", sub=i), "state", "any")
        xhat = signal(t, f"xhat_{key}", "n", Glyph("x", accent="hat", sub=i), "estimate of the state", "any")
        y = signal(t, f"y_{key}", "l", Glyph("y", sub=i), "output", "any")
        e = signal(t, f"e_{key}", "n", Glyph("e", sub=i), "error of the estimate")
        signal(t, f"w_{key}", "n", Glyph("w", sub=i), "process noise")
        v = signal(t, f"v_{key}", "l", Glyph("v", sub=i), "measurement noise")
        t.define(f"output {i}" if i == "k-1" else "output", y, C * x + v)
        t.define(f"error {i}" if i == "k-1" else "error", e, xhat - x)
    s = t.symbols
    old = s["x_{k-1}"], s["xhat_{k-1}"]
    t.define("plant", s["x_k"], A * old[0] + B * u + s["w_{k-1}"])
    t.define("observer", s["xhat_k"], A * old[1] + B * u - L * (C * old[1] - s["y_{k-1}"]))


def _noise(t: Theory) -> None:
    s = t.symbols
    e, w, v = s["e_{k-1}"], s["w_{k-1}"], s["v_{k-1}"]
    Q = covariance(t, "Q_{k-1}", "n", Glyph("Q", sub="k-1"), "covariance of the process noise")
    R = covariance(t, "R_{k-1}", "l", Glyph("R", sub="k-1"), "covariance of the measurement noise")
    S = t.matrix("S_{k-1}", "n", "l", Glyph("S", sub="k-1"), meaning="cross-covariance", unit="[state] [output]")
    P = covariance(t, "P_{k-1}", "n", Glyph("P", sub="k-1"), "error covariance")
    after = covariance(t, "P_k", "n", Glyph("P", sub="k"), "error covariance", parameter=False)
    t.define("Q_{k-1}", Expect(w * w.T), Q)
    t.define("R_{k-1}", Expect(v * v.T), R)
    t.define("S_{k-1}", Expect(w * v.T), S)
    t.define("P_{k-1}", Expect(e * e.T), P)
    t.define("P_k", Expect(s["e_k"] * s["e_k"].T), after)
    start = "white noise, uncorrelated with the initial error"
    w_j = signal(t, "w_j", "n", Glyph("w", sub="j"), "process noise at a time j ≥ k")
    v_j = signal(t, "v_j", "l", Glyph("v", sub="j"), "measurement noise at a time j ≥ k")
    t.assume("e and w", Expect(e * w.T), "=", Zero("n", "n"), start)
    t.assume("e and v", Expect(e * v.T), "=", Zero("n", "l"), start)
    for later in (w_j, v_j):
        t.assume(f"e and {later.name}", Expect(e * later.T), "=", Zero("n", later.rows), start)
        t.assume(f"w and {later.name}", Expect(w * later.T), "=", Zero("n", later.rows), "white noise")
        t.assume(f"v and {later.name}", Expect(v * later.T), "=", Zero("l", later.rows), "white noise")
    t.assume("E[w v'] = 0", S, "=", Zero("n", "l"), "process and measurement noise are uncorrelated")
    t.assume("P_{k-1} >= 0", P, "⪰", text="a covariance")
    t.assume("R_{k-1} > 0", R, "≻", text="every output is noisy")
    t.assume("joint noise", block([[Q, S], [S.T, R]]), "⪰", text="a joint covariance")


def _optimum(t: Theory) -> None:
    s = t.symbols
    A, C, L, P, R, S = (s[k] for k in ("A", "C", "L_k", "P_{k-1}", "R_{k-1}", "S_{k-1}"))
    best = formulas.gain(t, "L_k*", Glyph("L", sub="k", sup="⋆"), "optimal gain")
    t.inverse("Sigma_k^-1", innovation(C, P, R), "l", symmetric=True, because="innovation covariance")
    t.define("stationary gain", best * innovation(C, P, R), A * P * C.T + S)
    t.assume("optimal gain", L, "=", best, "the observer uses the optimal gain")


# ------------------------------------------------------------------------------------------------ lecture
def _derive_error(b: Builder) -> None:
    """Derive the recursion of the error, equation (2), by subtraction."""
    s = b.theory.symbols
    A, B, C, L, u = (s[k] for k in ("A", "B", "C", "L_k", "u_{k-1}"))
    x, xhat, y, e, w, v = (s[f"{k}_{{k-1}}"] for k in ("x", "xhat", "y", "e", "w", "v"))
    b.heading("Plant and observer")
    b.say(
        "A linear plant is driven by a known input ",
        u,
        " and by process noise ",
        w,
        "; its output carries measurement noise.",
    )
    b.given("plant", "output", numbers=("u1", "u1"), source=SOURCE)
    b.say("The noises have mean zero and the covariances")
    b.given("Q_{k-1}", "R_{k-1}", "S_{k-1}", numbers=("u1", "u1"), source=SOURCE)
    b.say("The observer copies the plant and corrects itself, with a gain ", L, " that is still free:")
    b.given("observer", numbers=("1",), source=SOURCE)
    b.say("The output that corrects it is that of the step before,")
    b.given("output k-1")
    b.say("Nothing below needs ", A, ", ", B, ", ", C, " or the noise to stay the same from one step to the next.")
    b.heading("Error")
    b.say("The error is the estimate minus the state,")
    b.given("error", "error k-1")
    chain = b.chain(s["e_k"])
    chain.to(s["xhat_k"] - s["x_k"], "definition of the error", ["error"])
    chain.to(A * xhat + B * u - L * (C * xhat - y) - (A * x + B * u + w), "observer and plant", ["observer", "plant"])
    chain.to(A * (xhat - x) - L * (C * (xhat - x) - v) - w, "insert the output; the input cancels", ["output k-1"])
    chain.to((A - L * C) * e + L * v - w, "collect", ["error k-1"], number="2", source=SOURCE)
    chain.close("error recursion", number="2", source=SOURCE)


def _derive_covariance(b: Builder) -> None:
    """Derive the recursion of the covariance, equation (2), for every gain."""
    s = b.theory.symbols
    A, C, L = (s[k] for k in ("A", "C", "L_k"))
    e, w, v, P, Q, R, S = (s[f"{k}_{{k-1}}"] for k in ("e", "w", "v", "P", "Q", "R", "S"))
    e_k, P_k = s["e_k"], s["P_k"]
    after = (A - L * C) * e + L * v - w
    b.heading("Error covariance")
    b.given("P_{k-1}", "P_k")
    b.say("White noise that is uncorrelated with the initial error has no correlation with the error of its own time,")
    b.given("e and w", "e and v")
    b.say("nor with the noise of any later time j ≥ k,")
    b.given("e and w_j", "e and v_j", "w and w_j", "w and v_j", "v and w_j", "v and v_j")
    b.say("and so it remains at the next step:")
    for later in (s["w_j"], s["v_j"]):
        chain = b.chain(Expect(e_k * later.T))
        chain.to(Expect(after * later.T), "error recursion", ["error recursion"], rule="apply")
        chain.to(Zero("n", later.rows), "each factor is uncorrelated with later noise")
        chain.close(f"e_k and {later.name}")
    b.say("Squaring the error recursion gives, for every gain,")
    chain = b.chain(P_k)
    chain.to(Expect(e_k * e_k.T), "definition")
    chain.to(Expect(after * after.T), "error recursion", ["error recursion"], rule="apply")
    chain.to(
        any_gain(A, C, L, P, Q, R, S),
        "expectation is linear, the gain is deterministic, error and noise are uncorrelated",
    )
    chain.close("covariance recursion with cross-covariance")
    b.say("If the two noises are uncorrelated,")
    b.given("E[w v'] = 0")
    b.state(
        "covariance recursion",
        Equation(P_k, "=", any_gain(A, C, L, P, Q, R)),
        "no cross-covariance",
        ["covariance recursion with cross-covariance", "E[w v'] = 0"],
        number="2",
        source=SOURCE,
    )
    errata.sign(b)
    errata.cross_covariance(b)
    errata.index_of_noise(b)
    b.say("Covariances are not negative,")
    b.given("P_{k-1} >= 0", "joint noise")
    b.say("and the recursion keeps it so:")
    b.positive(
        "P_k >= 0",
        Equation(P_k, "⪰", Zero("", "")),
        "two congruences; so the hypothesis holds again at the next step",
        [SquareOf(A - L * C, "P_{k-1} >= 0"), SquareOf(block([[Identity("n"), -L]]), "joint noise")],
        ["covariance recursion with cross-covariance"],
    )


def _derive_gain(b: Builder) -> None:
    """Derive the gain: stationary point of the trace, and minimum in the Loewner order."""
    s = b.theory.symbols
    A, C, L, best = (s[k] for k in ("A", "C", "L_k", "L_k*"))
    P, Q, R, S = (s[f"{k}_{{k-1}}"] for k in ("P", "Q", "R", "S"))
    v, e, xhat, y = (s[f"{k}_{{k-1}}"] for k in ("v", "e", "xhat", "y"))
    sigma, cost = innovation(C, P, R), any_gain(A, C, L, P, Q, R, S)
    b.heading("Innovation")
    b.say("What the observer learns from an output is the innovation,")
    b.state("innovation", Equation(y - C * xhat, "=", v - C * e), "output and error", ["output k-1", "error k-1"])
    b.state(
        "covariance of the innovation",
        Equation(Expect((v - C * e) * (v - C * e).T), "=", sigma),
        "error and noise are uncorrelated",
        lemma=False,
    )
    b.given("R_{k-1} > 0")
    b.positive(
        "innovation covariance",
        Equation(sigma, "≻", Zero("", "")),
        "a congruence plus a positive matrix; so the inverse below exists",
        [SquareOf(C, "P_{k-1} >= 0"), SquareOf(Identity("l"), "R_{k-1} > 0")],
        witness=Identity("l"),
    )
    b.heading("Optimal gain")
    b.say(
        "The covariance before, ",
        P,
        ", does not depend on ",
        L,
        ". The trace of the covariance after it has the gradient",
    )
    b.state(
        "gradient",
        Equation(Gradient(Trace(cost), L), "=", 2 * (L * sigma - A * P * C.T - S)),
        "d tr f = tr(G' dL)",
        rule="gradient",
        lemma=False,
    )
    b.say("It vanishes at the gain that solves")
    b.given("stationary gain")
    chain = b.chain(best)
    chain.to(best * sigma * sigma.inv, "the innovation covariance has an inverse", ["Sigma_k^-1"])
    chain.to((A * P * C.T + S) * sigma.inv, "zero of the gradient", ["stationary gain"])
    chain.close("gain with cross-covariance")
    b.say("This gain minimises more than the trace. Completing the square,")
    square = (L - best) * sigma * (L - best).T
    least = riccati_step_with_cross(A, C, P, Q, R, S)
    chain = b.chain(cost)
    chain.to(least + square, "complete the square in the gain", ["stationary gain", "Sigma_k^-1"])
    chain.close("completed square")
    b.positive(
        "Loewner minimum",
        Equation(s["P_k"], "⪰", least),
        "the square is a congruence of a positive matrix",
        [SquareOf(L - best, "innovation covariance")],
        ["covariance recursion with cross-covariance", "completed square"],
    )
    b.state(
        "attained",
        Equation(any_gain(A, C, best, P, Q, R, S), "=", least),
        "the optimal gain attains the bound",
        ["stationary gain", "Sigma_k^-1"],
    )
    b.say("So every other gain gives a covariance that is at least as large, in the Loewner order.")
    errata.stationary_point(b)
    b.say("From here on the observer uses this gain,")
    b.given("optimal gain")
    b.state(
        "gain",
        Equation(L, "=", A * P * C.T * sigma.inv),
        "no cross-covariance",
        ["optimal gain", "gain with cross-covariance", "E[w v'] = 0"],
        number="3",
        source=SOURCE,
    )
    errata.gain(b)


def _derive_riccati(b: Builder) -> None:
    """Derive the Riccati difference equation (4)."""
    s = b.theory.symbols
    A, C, L, P_k = (s[k] for k in ("A", "C", "L_k", "P_k"))
    P, Q, R, S = (s[f"{k}_{{k-1}}"] for k in ("P", "Q", "R", "S"))
    b.heading("Riccati difference equation")
    chain = b.chain(P_k)
    chain.to(any_gain(A, C, L, P, Q, R, S), "covariance for every gain", ["covariance recursion with cross-covariance"])
    chain.to(riccati_step_with_cross(A, C, P, Q, R, S), "insert the optimal gain", ["optimal gain", "attained"])
    chain.close("Riccati recursion with cross-covariance")
    chain = b.chain(P_k)
    chain.to(any_gain(A, C, L, P, Q, R), "covariance for every gain", ["covariance recursion"])
    chain.to(
        riccati_step(A, C, P, Q, R),
        "insert the gain; the inverse cancels",
        ["gain", "Sigma_k^-1"],
        number="4",
        source=SOURCE,
    )
    chain.close("Riccati recursion", number="4", source=SOURCE)
