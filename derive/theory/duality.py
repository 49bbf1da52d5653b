"""Duality of regulator and observer: a map of letters, applied to the one and compared with the other.

A -> A', B -> C', Q -> Q, R -> R, S -> P, K -> L'

The map and its inverse are applied in discrete and in continuous time. Source: lecture notes "Optimal Luenberger
Observer", section on the duality with the regulator, whose table has A, B and S only.
"""

from __future__ import annotations

from functools import cache

from derive.context import Theory
from derive.derivation import Derived, Evidence, Lecture, Step
from derive.terms import Dot, Equation, Glyph, Identity, Image, Symbol, Term, Zero
from derive.theory import regulator
from derive.theory.builder import Builder, SquareOf
from derive.theory.exact import Real, riccati_roots, value
from derive.theory.luenberger_formulas import any_gain, covariance, gain, innovation, optimal_gain, riccati_step
from derive.theory.regulator import cost_of_gain, cost_rate, cost_to_go, regulator_gain, weight

KEY, THEORY, SOURCE = "duality", "duality", "002"
TO, BACK = "dual", "original"  # the maps in discrete time
TO_CT, BACK_CT = "dual in continuous time", "original in continuous time"
EYE = Identity("l")


@cache
def theory() -> Theory:
    """Return the theory ``duality``: regulator and observer of one plant size, in discrete and continuous time."""
    t = Theory(THEORY, "Regulator and observer")
    regulator.declare_plant(t, "l", "every input costs, every output is noisy")
    regulator.declare_discrete(t)
    regulator.declare_continuous(t, "_inf")
    t.matrix("C", "l", "n", meaning="output matrix")
    _discrete(t)
    _continuous(t)
    return t


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = Builder(theory(), KEY, "Duality of regulator and observer", (SOURCE,))
    regulator.derive_discrete(b)
    _derive_observer(b)
    _derive_discrete(b)
    _derive_back(b)
    regulator.derive_continuous(b)
    _derive_continuous(b)
    return b.lecture()


def gain_image() -> Step:
    """Return the proved image of the regulator's gain in discrete time, L'."""
    return lecture().step("image of the steady gain")


def riccati_image() -> Step:
    """Return the proved image of the regulator's Riccati equation in discrete time, the observer's."""
    return lecture().step("image of the Riccati equation")


# ------------------------------------------------------------------------------------------------ theory
def _discrete(t: Theory) -> None:
    s = t.symbols
    A, C, Q, R = (s[k] for k in "ACQR")
    before = covariance(t, "P_{k-1}", "n", Glyph("P", sub="k-1"), "error covariance")
    after = covariance(t, "P_k", "n", Glyph("P", sub="k"), "error covariance")
    P = covariance(t, "P", "n", Glyph("P"), "steady error covariance")
    L_k = gain(t, "L_k", Glyph("L", sub="k"), "optimal gain of the observer")
    L = gain(t, "L", Glyph("L"), "steady optimal gain of the observer")
    free = gain(t, "L~", Glyph("L", accent="tilde"), "another gain of the observer")
    for P_, reason, name in ((before, "innovation", "Sigma_k^-1"), (P, "steady innovation", "Sigma^-1")):
        t.assume(f"{P_.name} >= 0", P_, "⪰", text="a covariance")
        t.inverse(name, innovation(C, P_, R), "l", symmetric=True, because=reason)
    t.define("Riccati recursion", after, riccati_step(A, C, before, Q, R))
    t.define("gain of the observer", L_k, optimal_gain(A, C, before, R))
    t.define("Riccati equation", P, riccati_step(A, C, P, Q, R))
    t.define("steady gain of the observer", L, optimal_gain(A, C, P, R))
    pairs = {"S_k": before, "S_{k-1}": after, "S": P, "K_{k-1}": L_k, "K": L, "M": free}
    inverses = {"weight_k^-1": "Sigma_k^-1", "weight^-1": "Sigma^-1"}
    declare_maps(t, (TO, BACK), pairs, {name: s[image] for name, image in inverses.items()})


def _continuous(t: Theory) -> None:
    s = t.symbols
    A, C = s["A"], s["C"]
    W = t.matrix("W", "n", "n", symmetric=True, meaning="intensity of the process noise", unit="[state]^2/s")
    V = t.matrix("V", "l", "l", symmetric=True, meaning="intensity of the measurement noise", unit="[output]^2 s")
    t.assume("V > 0", V, "≻", text="every output is noisy")
    t.inverse("V^-1", V, "l", symmetric=True, because="V > 0")
    P_t = regulator.at_time(t, "P_t", "n", "n", "P", "error covariance", symmetric=True)
    L_t = regulator.at_time(t, "L_t", "n", "l", "L", "optimal gain of the observer")
    P = t.matrix("P_inf", "n", "n", Glyph("P", sub="∞"), symmetric=True, meaning="steady error covariance")
    L = t.matrix("L_inf", "n", "l", Glyph("L", sub="∞"), meaning="steady optimal gain of the observer")
    t.define("Riccati equation in continuous time", Dot(P_t), covariance_rate(A, C, P_t, W, V))
    t.define("gain of the observer in continuous time", L_t, P_t * C.T * V.inv)
    t.define("steady covariance in continuous time", covariance_rate(A, C, P, W, V), Zero("n", "n"))
    t.define("steady gain of the observer in continuous time", L, P * C.T * V.inv)
    pairs = {"S_t": P_t, "K_t": L_t, "S_inf": P, "K_inf": L}
    declare_maps(t, (TO_CT, BACK_CT), pairs, {"Q": W, "R": V, "R^-1": s["V^-1"]})


def declare_maps(t: Theory, names: tuple[str, str], pairs: dict[str, Symbol], same: dict[str, Symbol]) -> None:
    """Declare the map of the regulator's letters to the observer's, and the map back.

    A matrix of the regulator (a cost) goes to a matrix of the observer, a gain to the transpose of a gain.
    """
    to, back = names
    A, B, C = (t.symbols[k] for k in "ABC")
    t.maps[to], t.maps[back] = {"A": A.T, "B": C.T}, {"A": A.T, "C": B.T}
    for name, image in {**pairs, **same}.items():
        symbol = t.symbols[name]
        square = symbol.symmetric
        t.maps[to][name] = image if square else image.T
        t.maps[back][image.name] = symbol if square else symbol.T


def covariance_rate(A: Term, C: Term, P: Term, W: Term, V: Term) -> Term:
    """Return the Riccati expression of the Kalman-Bucy filter.

    A P + P A' + W - P C' V^-1 C P
    """
    return A * P + P * A.T + W - P * C.T * V.inv * C * P


# ------------------------------------------------------------------------------------------------ lecture
def images(b: Builder, name: str, pairs: dict[str, Term]) -> None:
    """Display what a map makes of single letters."""
    made: list[Step] = []
    for letter, image in pairs.items():
        symbol = b.theory.symbols[letter]
        statement = Equation(Image(name, symbol), "=", image)
        made.append(b.equation(f"{name}: {letter}", statement, "by the map", [], "identity"))
    b.items.append(Derived(tuple(made)))


def _derive_observer(b: Builder) -> None:
    s = b.theory.symbols
    C, R, P, before = (s[k] for k in ("C", "R", "P", "P_{k-1}"))
    b.heading("The observer in discrete time")
    b.say("The covariances of the optimal observer, and those of its innovation, are")
    b.given("P_{k-1} >= 0", "P >= 0")
    for P_, name in ((before, "innovation"), (P, "steady innovation")):
        b.positive(
            name,
            Equation(innovation(C, P_, R), "≻", Zero("", "")),
            "a congruence plus a positive matrix",
            [SquareOf(C, f"{P_.name} >= 0"), SquareOf(EYE, "R > 0")],
            witness=EYE,
        )
    b.say("and its equations, as the lecture on the Luenberger observer derives them,")
    b.given("Riccati recursion", "gain of the observer", "Riccati equation", "steady gain of the observer")


def _derive_discrete(b: Builder) -> None:
    """Apply the map to the regulator's equations in discrete time."""
    s = b.theory.symbols
    A, B, C, Q, R, M, free = (s[k] for k in ("A", "B", "C", "Q", "R", "M", "L~"))
    b.heading("The map")
    b.say("The dual replaces the letters of the regulator by those of the observer:")
    images(b, TO, {"A": A.T, "B": C.T, "Q": Q, "R": R, "S": s["P"], "K": s["L"].T})
    b.say("Time is reversed: the cost to go runs backwards from the end, the covariance forwards from the start,")
    images(b, TO, {"S_k": s["P_{k-1}"], "S_{k-1}": s["P_k"], "K_{k-1}": s["L_k"].T})
    b.say("The table of the source has the first two rows and that of ", s["S"], "; the others are needed as well.")
    b.say("The map sends an inverse to the inverse of the image, because")
    for cost, P_, label in (("S_k", "P_{k-1}", ""), ("S", "P", "steady ")):
        b.state(
            f"image of the {label}weight",
            Equation(Image(TO, weight(B, s[cost], R)), "=", innovation(C, s[P_], R)),
            "by the map",
        )
    b.say("With every letter replaced, the regulator's equations are the observer's:")
    for cost, P_, result, gain_, names in (
        ("S_k", "P_{k-1}", "P_k", "L_k", ("Riccati recursion", "gain of the observer", "recursion", "gain")),
        ("S", "P", "P", "L", ("Riccati equation", "steady gain of the observer", "Riccati equation", "steady gain")),
    ):
        chain = b.chain(Image(TO, cost_to_go(A, B, s[cost], Q, R)))
        chain.to(riccati_step(A, C, s[P_], Q, R), "by the map")
        chain.to(s[result], "the observer's Riccati equation", [names[0]])
        chain.close(f"image of the {names[2]}")
        chain = b.chain(Image(TO, regulator_gain(A, B, s[cost], R)))
        chain.to(innovation(C, s[P_], R).inv * C * s[P_] * A.T, "by the map")
        chain.to(s[gain_].T, "the observer's gain, transposed", [names[1]])
        chain.close(f"image of the {names[3]}")
    b.say("The same holds for the closed loop, and for the cost of a gain, whose square was completed:")
    b.state("image of the closed loop", Equation(Image(TO, A - B * M), "=", (A - free * C).T), "by the map")
    P_k = s["P_{k-1}"]
    b.state(
        "image of the cost of a gain",
        Equation(Image(TO, cost_of_gain(A, B, M, s["S_k"], Q, R)), "=", any_gain(A, C, free, P_k, Q, R)),
        "by the map",
    )
    square = (free - s["L_k"]) * innovation(C, P_k, R) * (free - s["L_k"]).T
    b.state(
        "image of the completed square",
        Equation(any_gain(A, C, free, P_k, Q, R), "=", s["P_k"] + square),
        "the image of the regulator's identity holds for the observer",
        ["Riccati recursion", "gain of the observer", "Sigma_k^-1"],
    )


def _derive_back(b: Builder) -> None:
    """Apply the map back, and to the gain as it is printed."""
    s = b.theory.symbols
    A, B, C, Q, R, P, S = (s[k] for k in ("A", "B", "C", "Q", "R", "P", "S"))
    b.heading("And back")
    b.say("The way back to the original replaces the letters of the observer by those of the regulator:")
    images(b, BACK, {"A": A.T, "C": B.T, "P": S, "L": s["K"].T})
    chain = b.chain(Image(BACK, riccati_step(A, C, P, Q, R)))
    chain.to(cost_to_go(A, B, S, Q, R), "by the map")
    chain.to(S, "the regulator's Riccati equation", ["steady cost to go"])
    chain.close("image of the observer's Riccati equation")
    chain = b.chain(Image(BACK, optimal_gain(A, C, P, R)))
    chain.to(regulator_gain(A, B, S, R).T, "by the map")
    chain.to(s["K"].T, "the regulator's gain, transposed", ["steady gain"])
    chain.close("image of the observer's gain")
    for name, term in (("Riccati equation", cost_to_go(A, B, S, Q, R)), ("gain", regulator_gain(A, B, S, R))):
        b.state(
            f"{name} there and back",
            Equation(Image(BACK, Image(TO, term)), "=", term),
            "the two maps undo each other",
            lemma=False,
        )
    b.say("The gain that the source prints is the image of another matrix,")
    b.state(
        "image of the printed gain",
        Equation(Image(BACK, P * C.T * innovation(C, P, R).inv), "=", (weight(B, S, R).inv * B.T * S).T),
        "by the map",
        lemma=False,
    )
    b.say("in which the regulator's gain has lost its last factor ", A, ".")
    b.erratum(
        SOURCE,
        "",
        "incomplete",
        ("The table has the rows ", S, " ↔ ", P, ", ", A, " ↔ ", A.T, ", ", B, " ↔ ", C.T),
        "The rows are right. ",
        Q,
        " and ",
        R,
        " stay, the gain ",
        s["K"],
        " goes to ",
        s["L"].T,
        ", and time is reversed. With the row of the gain the table itself shows that the printed gain lacks ",
        A,
        ": the regulator with the corresponding gain is not optimal, and here it is not even stable.",
        evidence=(printed_gain_evidence(s),),
        true=b.steps["image of the steady gain"].statement,
        proved_by="image of the steady gain",
    )


def printed_gain_evidence(s: dict[str, Symbol]) -> Evidence:
    """Return the closed loop of the regulator with its own gain, and with the image of the printed one."""
    A, B, R, S, K = (s[k] for k in ("A", "B", "R", "S", "K"))
    at: dict[str, Real | int] = {"A": 2, "B": 1, "Q": 1, "R": 1}
    at["S"] = riccati_roots(2, 1, 1, 1)[-1]

    def closed_loop(formula: Term) -> str:
        return str(value(A - B * K, {**at, "K": value(formula, at)}))

    return Evidence(
        tuple((s[name], str(number)) for name, number in at.items()),
        (
            ("closed loop with the gain of the regulator", closed_loop(regulator_gain(A, B, S, R))),
            ("closed loop with the image of the printed gain", closed_loop(weight(B, S, R).inv * B.T * S)),
        ),
    )


def _derive_continuous(b: Builder) -> None:
    """Apply the map and its inverse in continuous time."""
    s = b.theory.symbols
    A, B, C, Q, R, W, V = (s[k] for k in ("A", "B", "C", "Q", "R", "W", "V"))
    S, P, K, L = (s[k] for k in ("S_t", "P_t", "K_t", "L_t"))
    b.heading("The map in continuous time")
    b.say("The Kalman-Bucy filter, as its lecture derives it, has the covariance and the gain")
    b.given("Riccati equation in continuous time", "gain of the observer in continuous time")
    b.given("steady covariance in continuous time", "steady gain of the observer in continuous time")
    b.say("The intensities of its noise take the place of the costs:")
    images(b, TO_CT, {"A": A.T, "B": C.T, "Q": W, "R": V, "S_t": P, "K_t": L.T})
    chain = b.chain(Image(TO_CT, -Dot(S)))
    chain.to(Image(TO_CT, cost_rate(A, B, S, Q, R)), "the regulator's Riccati equation")
    chain.to(covariance_rate(A, C, P, W, V), "by the map")
    chain.to(Dot(P), "the filter's Riccati equation; the sign says that time is reversed")
    chain.close("image of the Riccati equation in continuous time")
    chain = b.chain(Image(TO_CT, R.inv * B.T * S))
    chain.to(V.inv * C * P, "by the map")
    chain.to(L.T, "the filter's gain, transposed", ["gain of the observer in continuous time"])
    chain.close("image of the gain in continuous time")
    S, P, K, L = (s[k] for k in ("S_inf", "P_inf", "K_inf", "L_inf"))
    chain = b.chain(Image(TO_CT, cost_rate(A, B, S, Q, R)))
    chain.to(covariance_rate(A, C, P, W, V), "the same for the algebraic equations")
    chain.to(Zero("n", "n"), "the filter's Riccati equation", ["steady covariance in continuous time"])
    chain.close("image of the algebraic Riccati equation")
    chain = b.chain(Image(TO_CT, R.inv * B.T * S))
    chain.to(V.inv * C * P, "by the map")
    chain.to(L.T, "the filter's gain, transposed", ["steady gain of the observer in continuous time"])
    chain.close("image of the steady gain in continuous time")
    b.say("And back,")
    images(b, BACK_CT, {"W": Q, "V": R, "P_inf": S, "L_inf": K.T})
    b.state(
        "image of the filter's Riccati equation",
        Equation(Image(BACK_CT, covariance_rate(A, C, P, W, V)), "=", cost_rate(A, B, S, Q, R)),
        "by the map",
    )
    b.state(
        "image of the filter's gain",
        Equation(Image(BACK_CT, P * C.T * V.inv), "=", K.T),
        "by the map, and the regulator's gain",
        ["steady gain in continuous time"],
    )
