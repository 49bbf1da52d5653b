"""The Kalman filter as an observer: error dynamics, error covariance, and the gain that minimises it.

Source: lecture notes "Kalman filter" (observer with disturbance d and measurement input r), equations 31.x. The error
is e = x - o.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from derive.context import Theory
from derive.derivation import Evidence, Lecture, Step
from derive.terms import (
    Delta,
    Dot,
    Equation,
    Expect,
    Glyph,
    Gradient,
    Identity,
    Integral,
    Number,
    Symbol,
    Term,
    Trace,
    Zero,
)
from derive.theory.builder import Builder, SquareOf
from derive.theory.exact import lyapunov

KEY, THEORY, SOURCE = "observer", "observer-ct", "000"
HALF = Number(Fraction(1, 2))


@cache
def theory() -> Theory:
    """Return the theory ``observer-ct``: plant with disturbance and measurement input, observer, noise, optimum."""
    t = Theory(THEORY, "Observer in continuous time")
    _plant(t)
    _noise(t)
    _optimum(t)
    return t


def _plant(t: Theory) -> None:
    A = t.matrix("A", "n", "n", meaning="state matrix")
    B = t.matrix("B", "n", "p", meaning="input matrix")
    B_d = t.matrix("B_d", "n", "d", Glyph("B", sub="d"), meaning="disturbance input matrix")
    C = t.matrix("C", "l", "n", meaning="output matrix")
    D_u = t.matrix("D_u", "l", "p", Glyph("D", sub="u"), meaning="feedthrough of the input")
    D_d = t.matrix("D_d", "l", "d", Glyph("D", sub="d"), meaning="feedthrough of the disturbance")
    D_r = t.matrix("D_r", "l", "r", Glyph("D", sub="r"), meaning="measurement input matrix")
    L = t.varying("L", "n", "l", parameter=False, meaning="observer gain, any", unit="[state]/([output] s)")
    t.direction(L)
    x = t.signal("x", "n", mean="any", meaning="state")
    o = t.signal("o", "n", mean="any", meaning="observer state")
    u = t.signal("u", "p", mean="any", meaning="input")
    y = t.signal("y", "l", mean="any", meaning="output")
    y_o = t.signal("y_o", "l", Glyph("y", sub="o"), mean="any", meaning="observer output")
    d = t.signal("d", "d", meaning="disturbance")
    r = t.signal("r", "r", meaning="measurement input")
    e = t.signal("e", "n", meaning="error of the observer state")
    xi = t.signal("xi", "n", Glyph("ξ"), meaning="noise input of the error dynamics")
    A_e = t.varying("A_e", "n", "n", Glyph("A", sub="e"), parameter=False, meaning="error matrix")
    B_ed = t.varying("B_ed", "n", "d", Glyph("B", sub="ed"), parameter=False)
    B_er = t.varying("B_er", "n", "r", Glyph("B", sub="er"), parameter=False)
    t.define("plant", Dot(x), A * x + B * u + B_d * d)
    t.define("output", y, C * x + D_u * u + D_d * d + D_r * r)
    t.define("observer", Dot(o), A * o + B * u + L * (y - y_o))
    t.define("observer output", y_o, C * o + D_u * u)
    t.define("error", e, x - o)
    t.define("A_e", A_e, A - L * C)
    t.define("B_ed", B_ed, B_d - L * D_d)
    t.define("B_er", B_er, -(L * D_r))
    for time in ("t", "τ"):
        rhs = B_ed.at(time) * d.at(time) + B_er.at(time) * r.at(time)
        t.define(f"xi({time})", xi.at(time), rhs)


def _noise(t: Theory) -> None:
    s = t.symbols
    d, r, e, xi, Phi = (
        s["d"],
        s["r"],
        s["e"],
        s["xi"],
        t.matrix("Phi", "n", "n", Glyph("Φ"), constant=False, parameter=False),
    )
    for a, b in (("d", "d"), ("d", "r"), ("r", "d"), ("r", "r")):
        R = t.matrix(f"R_{a}{b}", a, b, Glyph("R", sub=a + b), constant=False, meaning=f"correlation of {a} and {b}")
        S = t.matrix(f"S_{a}{b}", a, b, Glyph("S", sub=a + b), symmetric=a == b, meaning="intensity")
        t.define(f"R_{a}{b}", Expect(s[a].at("t") * s[b].at("τ").T), R.at("t", "τ"))
        t.assume(f"white {a}{b}", R.at("t", "τ"), "=", S * Delta("t", "τ"), "d and r are jointly white, of mean zero")
    t.assume("S_rd", t.symbols["S_rd"], "=", t.symbols["S_dr"].T)
    R_xi = t.matrix(
        "R_xixi", "n", "n", Glyph("R", sub="ξξ"), constant=False, parameter=False, meaning="correlation of xi"
    )
    t.define("R_xixi definition", Expect(xi.at("t") * xi.at("τ").T), R_xi.at("t", "τ"))
    for a in (d, r):
        t.assume(
            f"{a.name} and e(t0)",
            Expect(a * e.at("t0").T),
            "=",
            Zero(a.rows, "n"),
            "the initial error is uncorrelated with d and r",
        )
    sigma = t.varying(
        "sigma2", "n", "n", Glyph("σ", sub="ξ", sup="2"), symmetric=True, parameter=False, meaning="intensity of xi"
    )
    B_ed, B_er = s["B_ed"], s["B_er"]
    S_dd, S_dr, S_rd, S_rr = (t.symbols[k] for k in ("S_dd", "S_dr", "S_rd", "S_rr"))
    t.define("sigma2", sigma, B_ed * S_dd * B_ed.T + B_ed * S_dr * B_er.T + B_er * S_rd * B_ed.T + B_er * S_rr * B_er.T)
    P_e = t.varying(
        "P_e",
        "n",
        "n",
        Glyph("P", sub="e"),
        symmetric=True,
        parameter=False,
        meaning="error covariance for any gain",
        unit="[state]^2",
    )
    t.define("P_e", Expect(e * e.T), P_e)
    t.define("Phi", Dot(Phi.at("t", "t0")), s["A_e"] * Phi.at("t", "t0"), "transition matrix of the error dynamics")
    t.define("Phi(t,τ)", Dot(Phi.at("t", "τ")), s["A_e"] * Phi.at("t", "τ"))
    t.define("Phi(t,t)", Phi.at("t", "t"), Identity("n"))
    t.define("Phi(t0,t0)", Phi.at("t0", "t0"), Identity("n"))


def _optimum(t: Theory) -> None:
    s = t.symbols
    A, C, B_d, D_d, D_r = (s[k] for k in ("A", "C", "B_d", "D_d", "D_r"))
    S_dd, S_dr, S_rd, S_rr = (s[k] for k in ("S_dd", "S_dr", "S_rd", "S_rr"))
    R_e = t.matrix(
        "R_e",
        "l",
        "l",
        Glyph("R", sub="e"),
        symmetric=True,
        meaning="intensity of the measurement noise",
        unit="[output]^2 s",
    )
    N = t.matrix("N", "n", "l", meaning="cross intensity of process and measurement noise")
    W = t.matrix("W", "n", "n", symmetric=True, meaning="intensity of the process noise", unit="[state]^2/s")
    t.define("W", W, B_d * S_dd * B_d.T)
    t.define("N", N, B_d * S_dd * D_d.T + B_d * S_dr * D_r.T)
    t.define("R_e", R_e, D_d * S_dd * D_d.T + D_d * S_dr * D_r.T + D_r * S_rd * D_d.T + D_r * S_rr * D_r.T)
    t.assume("R_e > 0", R_e, "≻", text="every output is noisy")
    t.inverse("R_e^-1", R_e, "l", symmetric=True, because="R_e > 0")
    P = t.varying("P", "n", "n", symmetric=True, meaning="optimal error covariance", unit="[state]^2")
    Ls = t.varying("L*", "n", "l", Glyph("L", sup="⋆"), meaning="optimal gain")
    t.define("L*", Ls, (P * C.T + N) * R_e.inv)
    t.define("P", Dot(P), A * P + P * A.T + W - (P * C.T + N) * R_e.inv * (P * C.T + N).T)
    t.fact("P_e(t0) >= P(t0)", "initial", s["P_e"] - P, "every gain starts from the same error covariance")


def closed_form(s: dict[str, Symbol], L: Term, P: Term) -> Term:
    """Return A_e P + P A_e' + sigma_xi^2 written out in L."""
    A, C, B_d, D_d, D_r = (s[k] for k in ("A", "C", "B_d", "D_d", "D_r"))
    S_dd, S_dr, S_rd, S_rr = (s[k] for k in ("S_dd", "S_dr", "S_rd", "S_rr"))
    left, right = B_d - L * D_d, L * D_r
    return (
        (A - L * C) * P
        + P * (A - L * C).T
        + left * S_dd * left.T
        - left * S_dr * right.T
        - right * S_rd * left.T
        + right * S_rr * right.T
    )


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = Builder(theory(), KEY, "The Kalman filter as an observer", (SOURCE,))
    _derive_error(b)
    _derive_correlation(b)
    _derive_covariance(b)
    _derive_gain(b)
    return b.lecture()


def error_dynamics() -> Step:
    """Return the proved error dynamics (31.10)."""
    return lecture().step("error dynamics")


def error_covariance() -> Step:
    """Return the proved Lyapunov equation of the error covariance."""
    return lecture().step("Lyapunov equation")


def gain() -> Step:
    """Return the proof that no gain gives a smaller error covariance than L* = (P C' + N) R_e^-1."""
    return lecture().step("optimal gain")


def _derive_error(b: Builder) -> None:
    """Derive (31.10) by subtraction."""
    s = b.theory.symbols
    A, B, B_d, C, D_d, D_r, L = (s[k] for k in ("A", "B", "B_d", "C", "D_d", "D_r", "L"))
    x, o, u, d, r, e, xi, y, y_o = (s[k] for k in ("x", "o", "u", "d", "r", "e", "xi", "y", "y_o"))
    A_e, B_ed, B_er = s["A_e"], s["B_ed"], s["B_er"]
    b.heading("Plant and observer")
    b.say("A linear plant with state ", x, ", known input ", u, ", disturbance ", d, " and measurement input ", r, ",")
    b.given("plant", "output", numbers=("u1", "u1"), source=SOURCE)
    b.say("and an observer with state ", o, " that corrects itself with the gain ", L, ",")
    b.given("observer", "observer output", numbers=("u2", "u2"), source=SOURCE)
    b.heading("Error dynamics")
    b.say("The error is the state minus its estimate,")
    b.given("error")
    chain = b.chain(Dot(e))
    chain.to(Dot(x - o), "definition of the error", ["error"], rule="apply", number="u3", source=SOURCE)
    chain.to(Dot(x) - Dot(o), "differentiation is linear", number="u3", source=SOURCE)
    chain.to(
        A * x + B * u + B_d * d - (A * o + B * u + L * (y - y_o)),
        "the plant and the observer",
        number="u3",
        source=SOURCE,
    )
    final = (A - L * C) * e + (B_d - L * D_d) * d - L * D_r * r
    chain.to(
        final, "insert both outputs and collect", ["error", "output", "observer output"], number="31.10", source=SOURCE
    )
    chain.to(A_e * e + B_ed * d + B_er * r, "abbreviate", ["A_e", "B_ed", "B_er"], number="31.10", source=SOURCE)
    chain.to(A_e * e + xi, "abbreviate", ["xi(t)"], number="31.10", source=SOURCE)
    b.say("With the abbreviations")
    b.given("A_e", "B_ed", "B_er", "xi(t)")
    b.say("the error obeys")
    chain.close("error dynamics", number="31.10", source=SOURCE)
    b.say("Written out, the noise input is")
    b.state(
        "xi written out",
        Equation(xi, "=", (B_d - L * D_d) * d - L * D_r * r),
        "abbreviations",
        ["xi(t)", "B_ed", "B_er"],
    )


def _derive_correlation(b: Builder) -> None:
    """Derive R_xixi and, for white noise, the intensity sigma_xi^2."""
    s = b.theory.symbols
    d, r, xi, R_xi, sigma = s["d"], s["r"], s["xi"], s["R_xixi"].at("t", "τ"), s["sigma2"]
    B_ed, B_er, L = s["B_ed"], s["B_er"], s["L"]
    one, two = {k: s[k].at("t") for k in "dr"}, {k: s[k].at("τ") for k in "dr"}
    R = {k: s[f"R_{k}"].at("t", "τ") for k in ("dd", "dr", "rd", "rr")}
    S = {k: s[f"S_{k}"] for k in ("dd", "dr", "rd", "rr")}
    at, to = (B_ed.at("t"), B_er.at("t")), (B_ed.at("τ"), B_er.at("τ"))
    b.heading("Correlation of the noise input")
    b.say("Let ", d, " and ", r, " be random signals of mean zero with the correlations")
    b.given("R_dd", "R_dr", "R_rd", "R_rr")
    chain = b.chain(R_xi)
    chain.to(Expect(xi.at("t") * xi.at("τ").T), "definition")
    chain.to(
        Expect((at[0] * one["d"] + at[1] * one["r"]) * (to[0] * two["d"] + to[1] * two["r"]).T),
        "definition of the noise input at both times",
        ["xi(t)", "xi(τ)"],
        rule="apply",
    )
    chain.to(
        at[0] * R["dd"] * to[0].T + at[0] * R["dr"] * to[1].T + at[1] * R["rd"] * to[0].T + at[1] * R["rr"] * to[1].T,
        "expectation is linear; deterministic factors leave it",
    )
    chain.close("R_xixi", number="u4", source=SOURCE)
    b.erratum(
        SOURCE,
        "u4",
        "assumption",
        (
            Equation(
                R_xi,
                "=",
                B_ed * R["dd"] * B_ed.T + B_ed * R["dr"] * B_er.T + B_er * R["rd"] * B_ed.T + B_er * R["rr"] * B_er.T,
            ),
        ),
        "As printed it needs a constant gain ",
        L,
        " and constant ",
        s["B_d"],
        ", ",
        s["D_d"],
        ", ",
        s["D_r"],
        "; otherwise the right-hand factors are those of the time τ, as derived here.",
        proved_by="R_xixi",
    )
    b.say(
        "If ",
        d,
        " and ",
        r,
        " are jointly white, with intensities ",
        S["dd"],
        ", ",
        S["dr"],
        ", ",
        S["rd"],
        ", ",
        S["rr"],
        ",",
    )
    b.given("white dd", "white dr", "white rd", "white rr", "S_rd", "sigma2")
    chain = b.chain(R_xi)
    chain.to(
        at[0] * R["dd"] * to[0].T + at[0] * R["dr"] * to[1].T + at[1] * R["rd"] * to[0].T + at[1] * R["rr"] * to[1].T,
        "the correlation just derived",
        ["R_xixi"],
    )
    delta = Delta("t", "τ")
    chain.to(
        at[0] * S["dd"] * delta * to[0].T
        + at[0] * S["dr"] * delta * to[1].T
        + at[1] * S["rd"] * delta * to[0].T
        + at[1] * S["rr"] * delta * to[1].T,
        "white noise",
        ["white dd", "white dr", "white rd", "white rr"],
    )
    chain.to(sigma * delta, "a Dirac delta samples its factors at equal times", ["sigma2"])
    chain.close("xi is white")
    left, right = s["B_d"] - L * s["D_d"], L * s["D_r"]
    b.state(
        "sigma2 written out",
        Equation(
            sigma,
            "=",
            left * S["dd"] * left.T - left * S["dr"] * right.T - right * S["rd"] * left.T + right * S["rr"] * right.T,
        ),
        "abbreviations",
        ["sigma2", "B_ed", "B_er"],
        number="u6",
        source=SOURCE,
    )
    b.erratum(
        SOURCE,
        "u6",
        "silent",
        (sigma, " is left open (“…”)"),
        "The intensity follows from the correlation of white noise.",
        proved_by="sigma2 written out",
        true=b.steps["sigma2 written out"].statement,
    )


def _derive_covariance(b: Builder) -> None:
    """Derive the Lyapunov equation of the error covariance."""
    s = b.theory.symbols
    e, xi, A_e, P_e, sigma, Phi = (s[k] for k in ("e", "xi", "A_e", "P_e", "sigma2", "Phi"))
    e0 = e.at("t0")
    b.heading("Error covariance")
    b.given("P_e", "d and e(t0)", "r and e(t0)")
    b.say(
        "The error is the sum of what remains of its start and what the noise has added; ",
        Phi.at("t", "τ"),
        " is the transition matrix,",
    )
    b.given("Phi", "Phi(t,t)")
    solution = Phi.at("t", "t0") * e0 + Integral(Phi.at("t", "τ") * xi.at("τ"), "τ")
    abbreviations = ["A_e", "B_ed", "B_er", "xi(t)", "Phi(t,t)", "Phi(t0,t0)"]
    b.unique(
        "variation of constants",
        Equation(e, "=", solution),
        "both sides solve the error dynamics and agree at the initial time",
        A_e,
        Zero("1", "1"),
        abbreviations,
    )
    chain = b.chain(Expect(xi * e0.T))
    chain.to(
        Expect((s["B_ed"] * s["d"] + s["B_er"] * s["r"]) * e0.T),
        "definition of the noise input",
        ["xi(t)"],
        rule="apply",
    )
    chain.to(Zero("n", "n"), "the initial error is uncorrelated with the noise")
    chain.close("xi and e(t0)")
    chain = b.chain(Expect(xi * e.T))
    chain.to(Expect(xi * solution.T), "variation of constants", ["variation of constants"], rule="apply")
    kernel = Phi.at("t", "τ").T
    chain.to(Integral(s["R_xixi"].at("t", "τ") * kernel, "τ"), "the initial error is uncorrelated with the noise")
    chain.to(Integral(sigma * Delta("t", "τ") * kernel, "τ"), "white noise", ["xi is white"], rule="apply")
    chain.to(HALF * sigma, "a Dirac delta at the end of the interval counts half", ["Phi(t,t)"])
    chain.close("xi and e")
    chain = b.chain(Dot(P_e))
    chain.to(Dot(Expect(e * e.T)), "definition", rule="apply")
    chain.to(Expect(Dot(e) * e.T + e * Dot(e).T), "product rule inside the expectation")
    chain.to(
        A_e * P_e + P_e * A_e.T + Expect(xi * e.T) + Expect(e * xi.T),
        "error dynamics",
        ["A_e", "B_ed", "B_er", "xi(t)"],
    )
    chain.to(
        A_e * P_e + P_e * A_e.T + sigma,
        "each of the two correlations is half the intensity",
        number="u5",
        source=SOURCE,
    )
    chain.close("Lyapunov equation", number="u5", source=SOURCE)
    true = lyapunov([[-1, 1], [0, -2]], [[0, 0], [0, 1]])
    b.erratum(
        SOURCE,
        "u5",
        "assumption",
        Equation(Dot(P_e), "=", A_e * P_e + P_e * A_e.T + sigma),
        "It holds for white noise that is uncorrelated with the initial error, which the source does not say. Coloured "
        "noise refutes it: with the noise input of a first-order filter, its variance is not an intensity.",
        evidence=(
            Evidence(
                ((A_e, "-1"), ("correlation of the noise input", "exp(-2|τ|)/4")),
                (
                    ("true stationary variance", str(true[0][0])),
                    ("the equation with the variance 1/4 in place of the intensity", str(Fraction(1, 4) / 2)),
                ),
            ),
        ),
        proved_by="Lyapunov equation",
    )


def _derive_gain(b: Builder) -> None:
    """Derive the optimal gain: completing the square, comparison, and the same from the trace's gradient."""
    s = b.theory.symbols
    A, C, L, Ls, P, P_e, N, W, R_e = (s[k] for k in ("A", "C", "L", "L*", "P", "P_e", "N", "W", "R_e"))
    A_e, sigma = s["A_e"], s["sigma2"]
    definitions = ["A_e", "B_ed", "B_er", "sigma2", "W", "N", "R_e", "S_rd"]
    b.heading("Optimal gain")
    b.say(
        "The source stops here. With the process noise ",
        W,
        ", the cross term ",
        N,
        " and the measurement noise ",
        R_e,
        " ≻ 0,",
    )
    b.given("W", "N", "R_e", "R_e > 0", "L*")
    rate = A * P + P * A.T + W - (P * C.T + N) * R_e.inv * (P * C.T + N).T
    chain = b.chain(A_e * P + P * A_e.T + sigma)
    chain.to(closed_form(s, L, P), "abbreviations", ["A_e", "B_ed", "B_er", "sigma2"])
    chain.to(
        rate + (L - Ls) * R_e * (L - Ls).T, "complete the square in the gain", ["W", "N", "R_e", "L*", "R_e^-1", "S_rd"]
    )
    chain.close("completed square")
    b.say("Let ", P, " start like ", P_e, " and obey the equation without the square:")
    b.given("P")
    b.positive(
        "square",
        Equation((L - Ls) * R_e * (L - Ls).T, "⪰", Zero("", "")),
        "a congruence of a positive matrix",
        [SquareOf(L - Ls, "R_e > 0")],
    )
    b.compare(
        "optimal gain",
        "transient",
        Equation(P_e, "⪰", P),
        "the difference solves a Lyapunov differential equation driven by the square, from zero or more",
        A_e,
        "P_e(t0) >= P(t0)",
        "square",
        [*definitions, "L*", "R_e^-1"],
    )
    at_optimum = closed_form(s, Ls, P)
    b.state(
        "attained",
        Equation(Dot(P), "=", at_optimum),
        "the bound is the covariance of the gain L⋆ itself",
        ["W", "N", "R_e", "L*", "R_e^-1", "S_rd"],
        lemma=False,
    )
    b.say("So no gain gives a smaller error covariance, in the Loewner order and at every time, than ", Ls, ".")
    b.erratum(
        SOURCE,
        "u5",
        "silent",
        ("The optimal gain is not given.",),
        "Completing the square and comparing shows that no gain does better than ",
        Ls,
        ", cross terms included:",
        proved_by="optimal gain",
        true=b.steps["optimal gain"].statement,
    )
    b.heading("The same from the trace")
    b.state(
        "gradient",
        Equation(Gradient(Trace(closed_form(s, L, P)), L), "=", 2 * (L * R_e - P * C.T - N)),
        "d tr f = tr(G' dL), at a given covariance",
        ["R_e", "N", "S_rd"],
        rule="gradient",
        lemma=False,
    )
    b.state(
        "stationary",
        Equation(Ls * R_e - P * C.T - N, "=", Zero("n", "l")),
        "the gradient vanishes at the optimal gain",
        ["L*", "R_e^-1"],
        lemma=False,
    )
