"""The Luenberger observer over an infinite horizon: Riccati equation, gain, and why they are optimal."""

from __future__ import annotations

from derive.context import Theory
from derive.terms import Equation, Expect, Glyph, Identity, Zero, block
from derive.theory import luenberger_errata as errata
from derive.theory.builder import Builder, SquareOf
from derive.theory.luenberger_errata import SOURCE
from derive.theory.luenberger_formulas import (
    any_gain,
    covariance,
    gain,
    innovation,
    optimal_gain,
    riccati_step,
    riccati_step_with_cross,
)


def declare(t: Theory) -> None:
    """Declare the steady state: constant noise, limits of covariance and gain, another gain, another solution."""
    s = t.symbols
    A, C = s["A"], s["C"]
    Q = covariance(t, "Q", "n", Glyph("Q"), "covariance of the process noise")
    R = covariance(t, "R", "l", Glyph("R"), "covariance of the measurement noise")
    S = t.matrix("S", "n", "l", meaning="cross-covariance", unit="[state] [output]")
    P = covariance(t, "P", "n", Glyph("P"), "steady error covariance")
    L = gain(t, "L", Glyph("L"), "steady optimal gain")
    w, v = s["w_{k-1}"], s["v_{k-1}"]
    for constant, one, two in ((Q, w, w), (R, v, v), (S, w, v)):
        t.assume(f"constant {constant.name}", Expect(one * two.T), "=", constant, "the same at every time")
    t.assume("S = 0", S, "=", Zero("n", "l"), "process and measurement noise are uncorrelated")
    t.assume("Q >= 0", Q, "⪰", text="a covariance")
    t.assume("R > 0", R, "≻", text="every output is noisy")
    t.assume("P >= 0", P, "⪰", text="a covariance")
    t.assume("steady joint noise", block([[Q, S], [S.T, R]]), "⪰", text="a joint covariance")
    t.inverse("Sigma^-1", innovation(C, P, R), "l", symmetric=True, because="steady innovation covariance")
    for indexed, limit in (("P_{k-1}", P), ("P_k", P), ("L_k", L)):
        t.assume(f"{indexed} = {limit.name}", s[indexed], "=", limit, "the steady state is reached", case=True)
    t.fact("A - L C Schur", "schur", A - L * C, "the steady covariance is the stabilising solution", case=True)
    _declare_others(t)


def _declare_others(t: Theory) -> None:
    """Declare a free steady gain with its covariance, another solution, and two covariances of one recursion."""
    A, C, Q, R, S = (t.symbols[k] for k in ("A", "C", "Q", "R", "S"))
    free = gain(t, "L~", Glyph("L", accent="tilde"), "another steady gain")
    loose = covariance(t, "P~", "n", Glyph("P", accent="tilde"), "covariance of another gain")
    t.fact("A - L~ C Schur", "schur", A - free * C, "the other gain stabilises too")
    t.define("covariance of another gain", loose, any_gain(A, C, free, loose, Q, R, S))
    for name, sub, sup, meaning in (
        ("o", "", "∘", "another solution"),
        ("1", "1", "", "one covariance"),
        ("2", "2", "", "another covariance"),
    ):
        P = covariance(t, f"P_{name}", "n", Glyph("P", sub=sub, sup=sup), meaning)
        L = gain(t, f"L_{name}", Glyph("L", sub=sub, sup=sup), f"optimal gain of {meaning}")
        t.assume(f"P_{name} >= 0", P, "⪰", text="a covariance")
        because = f"innovation covariance of P_{name}"
        t.inverse(f"Sigma_{name}^-1", innovation(C, P, R), "l", symmetric=True, because=because)
        t.define(f"L_{name}", L, optimal_gain(A, C, P, R, S))
    other = t.symbols["P_o"]
    t.define("another solution", other, riccati_step_with_cross(A, C, other, Q, R, S))
    t.assume("P_1 >= P_2", t.symbols["P_1"], "⪰", t.symbols["P_2"], "the one covariance is at least the other")


def derive(b: Builder) -> None:
    """Derive the Riccati equation (5), the gain, and their optimality."""
    _derive_limit(b)
    _derive_optimality(b)
    _derive_monotonicity(b)


def _derive_limit(b: Builder) -> None:
    s = b.theory.symbols
    A, C, P, L, Q, R, S = (s[k] for k in ("A", "C", "P", "L", "Q", "R", "S"))
    b.heading("Infinite horizon")
    b.say("If the noise is stationary,")
    b.given("constant Q", "constant R", "constant S", numbers=("u2", "u2"), source=SOURCE)
    b.say("and the covariance has reached a limit ", P, ", then covariance and gain stay the same from step to step,")
    b.given("P_{k-1} = P", "P_k = P", "L_k = L")
    b.say("The innovation covariance of the limit has an inverse, because")
    b.given("P >= 0", "R > 0")
    b.positive(
        "steady innovation covariance",
        Equation(innovation(C, P, R), "≻", Zero("", "")),
        "a congruence plus a positive matrix",
        [SquareOf(C, "P >= 0"), SquareOf(Identity("l"), "R > 0")],
        witness=Identity("l"),
    )
    steady = ["P_{k-1} = P", "constant Q", "constant R", "constant S", "Sigma_k^-1", "Sigma^-1"]
    old = tuple(s[f"{k}_{{k-1}}"] for k in "PQRS")
    chain = b.chain(P)
    chain.to(s["P_k"], "steady state", ["P_k = P"])
    recursion = "Riccati recursion with cross-covariance"
    chain.to(riccati_step_with_cross(A, C, *old), "Riccati recursion", [recursion])
    chain.to(riccati_step_with_cross(A, C, P, Q, R, S), "steady state, stationary noise", steady)
    chain.close("Riccati equation with cross-covariance")
    chain = b.chain(L)
    chain.to(s["L_k"], "steady state", ["L_k = L"])
    formula = optimal_gain(A, C, old[0], old[2], old[3])
    chain.to(formula, "optimal gain", ["optimal gain", "gain with cross-covariance"])
    chain.to(optimal_gain(A, C, P, R, S), "steady state, stationary noise", steady)
    chain.close("steady gain with cross-covariance")
    b.say("Without cross-covariance,")
    b.given("S = 0")
    b.state(
        "Riccati equation",
        Equation(P, "=", riccati_step(A, C, P, Q, R)),
        "no cross-covariance",
        ["Riccati equation with cross-covariance", "S = 0"],
        number="5",
        source=SOURCE,
    )
    b.state(
        "steady gain",
        Equation(L, "=", optimal_gain(A, C, P, R)),
        "no cross-covariance",
        ["steady gain with cross-covariance", "S = 0"],
        number="u3",
        source=SOURCE,
    )
    errata.steady_gain(b)


def _derive_optimality(b: Builder) -> None:
    s = b.theory.symbols
    A, C, P, L, Q, R, S = (s[k] for k in ("A", "C", "P", "L", "Q", "R", "S"))
    free, loose, other, other_gain = (s[k] for k in ("L~", "P~", "P_o", "L_o"))
    steady = ["Riccati equation with cross-covariance", "steady gain with cross-covariance", "Sigma^-1"]
    b.heading("The steady gain is optimal")
    b.say("Written with the gain, the Riccati equation is the covariance equation of the closed loop,")
    b.state("closed loop", Equation(P, "=", any_gain(A, C, L, P, Q, R, S)), "insert the gain", steady)
    b.state(
        "Stein equation",
        Equation(P, "=", any_gain(A, C, L, P, Q, R)),
        "no cross-covariance",
        ["closed loop", "S = 0"],
        lemma=False,
    )
    b.say("Take any other gain ", free, " for which ", A - free * C, " is Schur. Its steady covariance solves")
    b.given("covariance of another gain")
    sigma = innovation(C, P, R)
    b.positive(
        "steady square",
        Equation((free - L) * sigma * (free - L).T, "⪰", Zero("", "")),
        "a congruence of a positive matrix",
        [SquareOf(free - L, "steady innovation covariance")],
    )
    b.compare(
        "steady optimum",
        "stein",
        Equation(loose, "⪰", P),
        "the difference solves a Stein equation that the square drives, and its matrix is Schur",
        A - free * C,
        "A - L~ C Schur",
        "steady square",
        ["covariance of another gain", *steady],
    )
    b.say("If ", A - L * C, " is Schur, ", L, " is one of these gains and ", P, " is its covariance: the minimum.")
    b.say("The same comparison singles out one solution. Let ", other, " be another one,")
    b.given("P_o >= 0")
    b.positive(
        "innovation covariance of P_o",
        Equation(innovation(C, other, R), "≻", Zero("", "")),
        "as before",
        [SquareOf(C, "P_o >= 0"), SquareOf(Identity("l"), "R > 0")],
        witness=Identity("l"),
    )
    b.given("another solution", "L_o")
    b.positive(
        "square of the other solution",
        Equation((L - other_gain) * innovation(C, other, R) * (L - other_gain).T, "⪰", Zero("", "")),
        "a congruence of a positive matrix",
        [SquareOf(L - other_gain, "innovation covariance of P_o")],
    )
    b.compare(
        "largest solution",
        "stein",
        Equation(P, "⪰", other),
        "the stabilising solution is at least as large as every other one, so there is only one",
        A - L * C,
        "A - L C Schur",
        "square of the other solution",
        ["closed loop", "another solution", "L_o", "Sigma_o^-1"],
    )
    errata.roots(b)


def _derive_monotonicity(b: Builder) -> None:
    s = b.theory.symbols
    A, C, Q, R, S = (s[k] for k in ("A", "C", "Q", "R", "S"))
    (P_1, L_1), (P_2, L_2) = ((s[f"P_{i}"], s[f"L_{i}"]) for i in "12")
    b.heading("The recursion keeps the order")
    b.say("Start the recursion from two covariances,")
    b.given("P_1 >= 0", "P_2 >= 0")
    b.say("and compare what one step makes of them.")
    for i, P in (("1", P_1), ("2", P_2)):
        b.positive(
            f"innovation covariance of P_{i}",
            Equation(innovation(C, P, R), "≻", Zero("", "")),
            "as before",
            [SquareOf(C, f"P_{i} >= 0"), SquareOf(Identity("l"), "R > 0")],
            witness=Identity("l"),
        )
    b.given("L_1", "L_2")
    difference = riccati_step_with_cross(A, C, P_1, Q, R, S) - riccati_step_with_cross(A, C, P_2, Q, R, S)
    inverses = ["L_1", "L_2", "Sigma_1^-1", "Sigma_2^-1"]
    b.state(
        "difference of two steps",
        Equation(difference, "=", (A - L_1 * C) * (P_1 - P_2) * (A - L_2 * C).T),
        "the noise cancels",
        inverses,
        lemma=False,
    )
    b.given("P_1 >= P_2")
    b.positive(
        "monotone step",
        Equation(riccati_step_with_cross(A, C, P_1, Q, R, S), "⪰", riccati_step_with_cross(A, C, P_2, Q, R, S)),
        "a congruence of the difference and a square: more uncertainty before is not less after",
        [SquareOf(A - L_1 * C, "P_1 >= P_2"), SquareOf(L_1 - L_2, "innovation covariance of P_2")],
        inverses,
    )
