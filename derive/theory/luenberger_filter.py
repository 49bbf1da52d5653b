"""Other forms of the discrete-time observer: filter, Joseph and information form, no cross-covariance, spectrum."""

from __future__ import annotations

from derive.context import Theory
from derive.terms import Equation, Expect, Glyph, Identity, Zero, block
from derive.theory import luenberger_formulas as formulas
from derive.theory.builder import Builder, SquareOf
from derive.theory.luenberger_formulas import covariance, innovation, optimal_gain, riccati_step_with_cross

ONE, EYE = Identity("n"), Identity("l")


def declare(t: Theory) -> None:
    """Declare the filter form and the information form, and the resolvents of the spectrum."""
    s = t.symbols
    A, C, x = s["A"], s["C"], s["x_{k-1}"]
    xhat, y, P, R = (s[f"{k}_{{k-1}}"] for k in ("xhat", "y", "P", "R"))
    gain = formulas.gain(t, "L^f_{k-1}", Glyph("L", sub="k-1", sup="f"), "gain of the filter")
    after = covariance(t, "P+_{k-1}", "n", Glyph("P", sub="k-1", sup="+"), "covariance of the filtered error")
    look = Glyph("x", accent="hat", sub="k-1", sup="+")
    filtered = formulas.signal(t, "xhat+_{k-1}", "n", look, "filtered estimate", "any")
    error = formulas.signal(t, "e+_{k-1}", "n", Glyph("e", sub="k-1", sup="+"), "filtered error")
    t.define("filter gain", gain, P * C.T * innovation(C, P, R).inv)
    t.define("filtered estimate", filtered, xhat - gain * (C * xhat - y))
    t.define("filtered error", error, filtered - x)
    t.define("P+_{k-1}", Expect(error * error.T), after)
    _declare_information(t)
    z = t.scalar("z", meaning="a point where both inverses exist")
    zi = t.scalar("z^-1", Glyph("z", sup="-1"))
    t.define("z z^-1", z * zi * ONE, ONE)
    t.fact("z I - A", "invertible", z * ONE - A, "z is no eigenvalue of A")
    t.fact("z^-1 I - A", "invertible", zi * ONE - A, "1/z is no eigenvalue of A")
    t.inverse("F", z * ONE - A, "n", because="z I - A")
    t.inverse("G", zi * ONE - A, "n", because="z^-1 I - A")


def _declare_information(t: Theory) -> None:
    C, P, R = (t.symbols[k] for k in ("C", "P", "R"))
    after = covariance(t, "P+", "n", Glyph("P", sup="+"), "steady covariance of the filtered error")
    gain = formulas.gain(t, "L_f", Glyph("L", sub="f"), "steady gain of the filter")
    t.define("L_f", gain, P * C.T * innovation(C, P, R).inv)
    t.define("P+", after, P - P * C.T * innovation(C, P, R).inv * C * P)
    t.inverse("R^-1", R, "l", symmetric=True, because="R > 0")
    t.assume("P > 0", P, "≻", text="only for the information form", case=True)
    t.inverse("P^-1", P, "n", symmetric=True, because="P > 0")
    t.inverse("P+^-1", after, "n", symmetric=True, because="P+ > 0")
    t.inverse(
        "Z",
        ONE + C.T * R.inv * C * P,
        "n",
        because=("inverse from the right", "inverse from the left"),
        by=ONE - C.T * innovation(C, P, R).inv * C * P,
    )


def derive(b: Builder) -> None:
    """Derive the other forms."""
    _derive_filter(b)
    _derive_steady_filter(b)
    _derive_information(b)
    _derive_reduction(b)
    _derive_spectrum(b)


def _derive_filter(b: Builder) -> None:
    s = b.theory.symbols
    A, B, C, L, u, x_k = (s[k] for k in ("A", "B", "C", "L_k", "u_{k-1}", "xhat_k"))
    xhat, y, e, v, P, Q, R, S = (s[f"{k}_{{k-1}}"] for k in ("xhat", "y", "e", "v", "P", "Q", "R", "S"))
    gain, filtered, error, after = (s[k] for k in ("L^f_{k-1}", "xhat+_{k-1}", "e+_{k-1}", "P+_{k-1}"))
    inverse = innovation(C, P, R).inv
    optimal = ["optimal gain", "gain with cross-covariance"]
    b.heading("Predictor and filter")
    b.say("The observer above is a predictor. A filter first corrects the estimate with the output of the same time,")
    b.given("filter gain", "filtered estimate")
    b.say("and then predicts. The gain of the predictor is the filter's, moved one step ahead:")
    b.state(
        "predictor and filter gain", Equation(L, "=", A * gain + S * inverse), "both gains", [*optimal, "filter gain"]
    )
    b.state(
        "predictor from filter",
        Equation(x_k, "=", A * filtered + B * u - S * inverse * (C * xhat - y)),
        "the observer with this gain",
        ["observer", "predictor and filter gain", "filtered estimate"],
        lemma=False,
    )
    b.given("filtered error", "P+_{k-1}")
    chain = b.chain(error)
    chain.to(filtered - s["x_{k-1}"], "definition", ["filtered error"])
    chain.to(
        (ONE - gain * C) * e + gain * v,
        "filtered estimate, output and error",
        ["filtered estimate", "output k-1", "error k-1"],
    )
    chain.close("filtered error from the error")
    one = (ONE - gain * C) * e + gain * v
    chain = b.chain(after)
    chain.to(Expect(error * error.T), "definition")
    chain.to(Expect(one * one.T), "the error just derived", ["filtered error from the error"], rule="apply")
    joseph = (ONE - gain * C) * P * (ONE - gain * C).T + gain * R * gain.T
    chain.to(joseph, "error and noise are uncorrelated; this is the Joseph form")
    chain.to(P - P * C.T * inverse * C * P, "insert the filter gain", ["filter gain", "Sigma_k^-1"])
    chain.close("filtered covariance")
    b.say("The Riccati recursion is the prediction of this covariance,")
    b.state(
        "prediction",
        Equation(s["P_k"], "=", A * after * A.T + Q),
        "no cross-covariance",
        ["Riccati recursion", "filtered covariance"],
        lemma=False,
    )


def _derive_steady_filter(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, L_f, P, after, Q, R, S = (s[k] for k in ("A", "C", "L", "L_f", "P", "P+", "Q", "R", "S"))
    b.say("In the steady state the filter has the gain and the covariance")
    b.given("L_f", "P+")
    b.say("and with them")
    b.state(
        "steady predictor and filter gain",
        Equation(L, "=", A * L_f + S * innovation(C, P, R).inv),
        "both gains",
        ["steady gain with cross-covariance", "L_f"],
        lemma=False,
    )
    b.state(
        "steady prediction",
        Equation(P, "=", A * after * A.T + Q),
        "no cross-covariance",
        ["Riccati equation", "P+"],
        lemma=False,
    )
    b.state(
        "Joseph form",
        Equation(after, "=", (ONE - L_f * C) * P * (ONE - L_f * C).T + L_f * R * L_f.T),
        "insert the gain; no rounding of the gain makes this form indefinite",
        ["P+", "L_f", "Sigma^-1"],
    )
    b.state("short form", Equation(after, "=", (ONE - L_f * C) * P), "insert the gain", ["P+", "L_f"], lemma=False)


def _derive_information(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L_f, P, after, Q, R = (s[k] for k in ("A", "C", "L_f", "P", "P+", "Q", "R"))
    inverse, weight = innovation(C, P, R).inv, C.T * R.inv * C
    both = ["Sigma^-1", "R^-1"]
    b.heading("Information form")
    b.say("The gain of the filter follows from its covariance,")
    b.state(
        "gain from the filtered covariance", Equation(L_f, "=", after * C.T * R.inv), "cancel", ["L_f", "P+", *both]
    )
    b.say("Two products show that ", ONE + weight * P, " has an inverse, whatever ", P, " ⪰ 0 is:")
    explicit = ONE - C.T * inverse * C * P
    b.state("inverse from the right", Equation((ONE + weight * P) * explicit, "=", ONE), "multiply out", both)
    b.state("inverse from the left", Equation(explicit * (ONE + weight * P), "=", ONE), "multiply out", both)
    b.say("The Riccati equation then takes a form without the innovation covariance,")
    b.state(
        "Riccati equation in information form",
        Equation(P, "=", A * P * (ONE + weight * P).inv * A.T + Q),
        "no cross-covariance",
        ["Riccati equation", "Z", *both],
        lemma=False,
    )
    b.say("If moreover")
    b.given("P > 0")
    b.positive(
        "P+ > 0",
        Equation(after, "≻", Zero("", "")),
        "the Joseph form, whose first factor has an inverse",
        [SquareOf(ONE - L_f * C, "P > 0"), SquareOf(L_f, "R > 0")],
        ["Joseph form", "L_f", *both],
        witness=ONE + P * weight,
    )
    b.say("then both covariances have an inverse, and a measurement adds its information:")
    b.state(
        "information form",
        Equation(after.inv, "=", P.inv + weight),
        "multiply by the covariance",
        ["P+", "P^-1", "P+^-1", *both],
        lemma=False,
    )


def _derive_reduction(b: Builder) -> None:
    s = b.theory.symbols
    A, C, P, Q, R, S = (s[k] for k in ("A", "C", "P", "Q", "R", "S"))
    inverse = innovation(C, P, R).inv
    moved, left = A - S * R.inv * C, Q - S * R.inv * S.T
    b.heading("Cross-covariance moved into the plant")
    b.say(
        "A cross-covariance does not need equations of its own. With ",
        moved,
        " for ",
        A,
        " and ",
        left,
        " for ",
        Q,
        ",",
    )
    b.given("steady joint noise")
    b.positive(
        "remaining noise",
        Equation(left, "⪰", Zero("", "")),
        "Schur complement: a congruence of the joint covariance",
        [SquareOf(block([[ONE, -S * R.inv]]), "steady joint noise")],
        ["R^-1"],
    )
    rest = left + moved * P * moved.T - moved * P * C.T * inverse * C * P * moved.T
    b.state(
        "reduction",
        Equation(riccati_step_with_cross(A, C, P, Q, R, S), "=", rest),
        "complete the products",
        ["Sigma^-1", "R^-1"],
        lemma=False,
    )
    b.state(
        "reduced gain",
        Equation(optimal_gain(A, C, P, R, S), "=", optimal_gain(moved, C, P, R) + S * R.inv),
        "the same for the gain",
        ["Sigma^-1", "R^-1"],
        lemma=False,
    )


def _derive_spectrum(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, P, Q, R, S, z, zi = (s[k] for k in ("A", "C", "L", "P", "Q", "R", "S", "z", "z^-1"))
    F, G = (z * ONE - A).inv, (zi * ONE - A).inv
    sigma = innovation(C, P, R)
    b.heading("Spectral factorisation")
    b.say("The steady observer factors the spectrum of the output. At every ", z, " where both inverses exist,")
    b.given("z z^-1")
    factors = (EYE + C * F * L) * sigma * (EYE + C * G * L).T
    using = [
        "Riccati equation with cross-covariance",
        "steady gain with cross-covariance",
        "Sigma^-1",
        "F",
        "G",
        "z z^-1",
    ]
    b.state(
        "spectral factorisation with cross-covariance",
        Equation(factors, "=", C * F * Q * G.T * C.T + C * F * S + (C * G * S).T + R),
        "Riccati equation, and z F = I + A F",
        using,
    )
    b.state(
        "spectral factorisation",
        Equation(factors, "=", C * F * Q * G.T * C.T + R),
        "no cross-covariance",
        ["spectral factorisation with cross-covariance", "S = 0"],
    )
