"""The Kalman-Bucy filter: gain, Riccati equations, output error covariance, spectral factorisation.

Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, A Frequency-Domain Characterization of Optimal Error Covariance for
the Kalman-Bucy Filter, arXiv:1807.08604, 2018. The source's e = y - ybar is the innovation; the error of the state has
no letter there and is written with a tilde here. L is any gain, K the optimal one.
"""

from __future__ import annotations

from dataclasses import replace
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
from derive.theory.kalman_bucy_innovation import (
    declare_innovation,
    declare_one_output,
    derive_innovation,
    derive_one_output,
)
from derive.theory.kalman_bucy_stationary import declare_plant, declare_signals, derive_plant, derive_signals

KEY, THEORY, SOURCE = "kalman-bucy", "kalman-bucy", "001"
HALF = Number(Fraction(1, 2))
GENERIC = "a generic point: no eigenvalue"


@cache
def theory() -> Theory:
    """Return the theory ``kalman-bucy``: time-invariant plant, uncorrelated white noises W >= 0, V > 0."""
    t = Theory(THEORY, "Kalman-Bucy filter")
    _plant(t)
    _noise(t)
    _optimum(t)
    _steady(t)
    _frequency(t)
    declare_signals(t)
    declare_one_output(t)
    declare_innovation(t)
    declare_plant(t)
    return t


def _plant(t: Theory) -> None:
    A = t.matrix("A", "m", "m", meaning="state matrix", unit="1/s")
    C = t.matrix("C", "l", "m", meaning="output matrix")
    L = t.varying("L", "m", "l", parameter=False, meaning="filter gain, any")
    t.direction(L)
    x = t.signal("x", "m", meaning="state")
    y = t.signal("y", "l", meaning="output")
    z = t.signal("z", "l", mean="any", meaning="true output")
    x_hat = t.signal("xbar", "m", Glyph("x", accent="bar"), mean="any", meaning="state estimate")
    y_hat = t.signal("ybar", "l", Glyph("y", accent="bar"), mean="any", meaning="output estimate")
    e = t.signal("e", "l", meaning="innovation")
    u = t.signal("u", "m", mean="any", meaning="correction")
    w = t.signal("w", "m", meaning="process noise")
    v = t.signal("v", "l", meaning="measurement noise")
    error = t.signal("xtilde", "m", Glyph("x", accent="tilde"), meaning="error of the state estimate")
    t.define("plant", Dot(x), A * x + w)
    t.define("output", y, C * x + v)
    t.define("true output", z, C * x)
    t.define("filter", Dot(x_hat), A * x_hat + u)
    t.define("output estimate", y_hat, C * x_hat)
    t.define("innovation", e, y - y_hat)
    t.define("correction", u, L * e)
    t.define("error", error, x - x_hat)


def _noise(t: Theory) -> None:
    s = t.symbols
    w, v, error = s["w"], s["v"], s["xtilde"]
    W = t.matrix("W", "m", "m", symmetric=True, meaning="intensity of the process noise", unit="[state]^2/s")
    V = t.matrix("V", "l", "l", symmetric=True, meaning="intensity of the measurement noise", unit="[output]^2 s")
    white = "white noises, uncorrelated with each other"
    t.assume("E[w w']", Expect(w.at("t") * w.at("τ").T), "=", W * Delta("t", "τ"), white)
    t.assume("E[v v']", Expect(v.at("t") * v.at("τ").T), "=", V * Delta("t", "τ"), white)
    t.assume("E[w v']", Expect(w.at("t") * v.at("τ").T), "=", Zero("m", "l"), white)
    t.assume("E[v w']", Expect(v.at("t") * w.at("τ").T), "=", Zero("l", "m"), white)
    for noise, size in ((w, "m"), (v, "l")):
        t.assume(
            f"{noise.name} and x(0)",
            Expect(noise * error.at("t0").T),
            "=",
            Zero(size, "m"),
            "the noises are uncorrelated with the initial state",
        )
    t.assume("W >= 0", W, "⪰", text="an intensity is not negative")
    t.assume("V > 0", V, "≻", text="every output is noisy")
    t.inverse("V^-1", V, "l", symmetric=True, because="V > 0")
    P_L = t.varying(
        "P_L", "m", "m", Glyph("P", sub="L"), symmetric=True, parameter=False, meaning="error covariance for any gain"
    )
    t.define("P_L", Expect(error * error.T), P_L)
    A_L = s["A"] - s["L"] * s["C"]
    Phi = t.matrix("Phi", "m", "m", Glyph("Φ"), constant=False, parameter=False, meaning="transition matrix of A - L C")
    for start in ("t0", "τ"):
        t.define(f"Phi(t,{start})", Dot(Phi.at("t", start)), A_L * Phi.at("t", start))
    t.define("Phi(t,t)", Phi.at("t", "t"), Identity("m"))
    t.define("Phi(t0,t0)", Phi.at("t0", "t0"), Identity("m"))


def _optimum(t: Theory) -> None:
    s = t.symbols
    A, C, W, V = (s[k] for k in "ACWV")
    P = t.varying("P(t)", "m", "m", Glyph("P"), symmetric=True, meaning="optimal error covariance", unit="[state]^2")
    K = t.varying("K(t)", "m", "l", Glyph("K"), meaning="Kalman gain")
    t.symbols["P(t)"] = P = replace(P, show_args=("t",))
    t.symbols["K(t)"] = K = replace(K, show_args=("t",))
    t.define("K(t)", K * V, P * C.T, "the gain where the gradient vanishes")
    t.define("P(t)", Dot(P), A * P + P * A.T + W - P * C.T * V.inv * C * P)
    t.fact("P_L(t0) >= P(t0)", "initial", s["P_L"] - P, "every gain starts from the same error covariance")
    t.assume("optimal", s["L"], "=", K, "the filter uses the Kalman gain", case=True)
    t.assume("P_L(t0)", s["P_L"].at("t0"), "=", P.at("t0"), "the same start")


def _steady(t: Theory) -> None:
    s = t.symbols
    C, V = s["C"], s["V"]
    P = t.matrix("P", "m", "m", symmetric=True, meaning="steady error covariance", unit="[state]^2")
    K = t.matrix("K", "m", "l", meaning="steady Kalman gain")
    t.assume("steady P", s["P(t)"], "=", P, "the steady state", case=True)
    t.assume("steady K", s["K(t)"], "=", K, "the steady state", case=True)
    L = t.matrix("Lc", "m", "l", Glyph("L", sub="∞"), meaning="any constant stabilising gain")
    P_L = t.matrix("Pc", "m", "m", Glyph("P", sub="L∞"), symmetric=True, meaning="its steady error covariance")
    closed = s["A"] - L * C
    t.fact("A - L C Hurwitz", "hurwitz", closed, "the gain stabilises")
    t.define("steady covariance of a gain", closed * P_L + P_L * closed.T + s["W"] + L * V * L.T, Zero("m", "m"))
    Sigma = t.matrix(
        "Sigma",
        "l",
        "l",
        Glyph("Σ", sub="z-ȳ"),
        symmetric=True,
        constant=False,
        parameter=False,
        meaning="output error covariance",
    )
    output_error = t.signal("ztilde", "l", Glyph("z", accent="tilde"), meaning="output error")
    t.define("output error", output_error, s["z"] - s["ybar"])
    t.define("Sigma", Expect(output_error * output_error.T), Sigma)


def _frequency(t: Theory) -> None:
    s = t.symbols
    A, C, W, V = (s[k] for k in "ACWV")
    K, size = s["K"], Identity("m")
    point = t.scalar("s", meaning="a complex number")
    j, omega = t.scalar("j", Glyph("j", upright=True), meaning="imaginary unit"), t.scalar("ω", meaning="frequency")
    for name, value, shown in (("s", point * size, "s"), ("jω", j * omega * size, "ω")):
        plus, minus = value - A, -value - A
        t.fact(f"{name} regular", "invertible", plus, GENERIC)
        t.fact(f"-{name} regular", "invertible", minus, GENERIC)
        t.inverse(f"({name}I-A)^-1", plus, "m", because=f"{name} regular")
        t.inverse(f"(-{name}I-A)^-1", minus, "m", because=f"-{name} regular")
        spectrum = t.matrix(
            f"Phi_y({shown})",
            "l",
            "l",
            Glyph("Φ", sub="y"),
            constant=False,
            show_args=(shown,),
            meaning="spectrum of the output",
        )
        t.complex.add(spectrum.name)
        t.define(f"Phi_y({shown})", spectrum, C * plus.inv * W * minus.inv.T * C.T + V)
    closed = point * size - A + K * C
    t.fact("s closed loop", "invertible", closed, GENERIC)
    t.inverse("(sI-A+KC)^-1", closed, "m", because="s closed loop")


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = Builder(theory(), KEY, "The Kalman-Bucy filter", (SOURCE,))
    derive_signals(b)
    _derive_error(b)
    _derive_covariance(b)
    _derive_gain(b)
    _derive_steady_state(b)
    _derive_output_error(b)
    derive_one_output(b)
    derive_innovation(b)
    _derive_factorisation(b)
    derive_plant(b)
    return b.lecture()


def gain() -> Step:
    """Return the proved gain K(t) = P(t) C' V^-1, equation (1)."""
    return lecture().step("gain")


def riccati() -> Step:
    """Return the proved algebraic Riccati equation (2)."""
    return lecture().step("algebraic Riccati equation")


def spectral_factorisation() -> Step:
    """Return the proved factorisation Phi_y = (I + C F K) V (I + C G K)'."""
    return lecture().step("spectral factorisation")


def _derive_error(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, w, v, error = (s[k] for k in ("A", "C", "L", "w", "v", "xtilde"))
    b.heading("Plant and filter")
    b.given("plant", "output", numbers=("u6", "u6"), source=SOURCE)
    b.given("E[w w']", "E[v v']", numbers=("u7", "u8"), source=SOURCE)
    b.erratum(
        SOURCE,
        "u7",
        "incomplete",
        b.theory.statement("E[w w']"),
        "The source calls ",
        s["W"],
        " and ",
        s["V"],
        " covariance matrices; with a Dirac delta they are intensities, of unit [state]²/s and [output]²·s.",
    )
    b.say("The filter corrects its prediction by the innovation, with any gain ", L, " for now:")
    b.given("filter", "output estimate", "innovation", "correction", numbers=("u9",) * 4, source=SOURCE)
    b.heading("Error dynamics")
    b.given("error")
    chain = b.chain(Dot(error))
    chain.to(Dot(s["x"] - s["xbar"]), "definition of the error", ["error"], rule="apply")
    chain.to(A * s["x"] + w - (A * s["xbar"] + s["u"]), "plant and filter")
    chain.to(
        (A - L * C) * error + w - L * v,
        "insert the correction and collect",
        ["correction", "innovation", "output", "output estimate", "error"],
    )
    chain.close("error dynamics")


def _derive_covariance(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, W, V, w, v, error, P_L, Phi = (s[k] for k in ("A", "C", "L", "W", "V", "w", "v", "xtilde", "P_L", "Phi"))
    start, kernel = error.at("t0"), Phi.at("t", "τ")
    b.heading("Error covariance for any gain")
    b.given("P_L", numbers=("u10",), source=SOURCE)
    b.given("w and x(0)", "v and x(0)")
    solution = Phi.at("t", "t0") * start + Integral(kernel * (w.at("τ") - L.at("τ") * v.at("τ")), "τ")
    signals = ["correction", "innovation", "output", "output estimate", "error"]
    b.unique(
        "variation of constants",
        Equation(error, "=", solution),
        "both sides solve the error dynamics and agree at the initial time",
        A - L * C,
        Zero("1", "1"),
        ["Phi(t,t)", "Phi(t0,t0)", *signals],
    )
    for noise, value in ((w, HALF * W), (v, -(HALF * V * L.T))):
        chain = b.chain(Expect(noise * error.T))
        chain.to(Expect(noise * solution.T), "variation of constants", ["variation of constants"], rule="apply")
        chain.to(value, "white noise; a Dirac delta at the end of the interval counts half", ["Phi(t,t)"])
        chain.close(f"{noise.name} and error")
    closed = A - L * C
    chain = b.chain(Dot(P_L))
    chain.to(Dot(Expect(error * error.T)), "definition", rule="apply")
    chain.to(Expect(Dot(error) * error.T + error * Dot(error).T), "product rule inside the expectation")
    noise = w - L * v
    chain.to(closed * P_L + P_L * closed.T + Expect(noise * error.T) + Expect(error * noise.T), "error dynamics")
    chain.to(closed * P_L + P_L * closed.T + W + L * V * L.T, "the correlations of noise and error")
    chain.close("covariance for any gain")


def _rate(s: dict[str, Symbol], P: Term) -> Term:
    A, C, W, V = (s[k] for k in "ACWV")
    return A * P + P * A.T + W - P * C.T * V.inv * C * P


def _derive_gain(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, W, V, P, K, P_L = (s[k] for k in ("A", "C", "L", "W", "V", "P(t)", "K(t)", "P_L"))
    closed = A - L * C
    b.heading("The optimal gain")
    b.say("At a given covariance, the trace of the right-hand side has the gradient")
    b.state(
        "gradient",
        Equation(Gradient(Trace(closed * P + P * closed.T + W + L * V * L.T), L), "=", 2 * (L * V - P * C.T)),
        "d tr f = tr(G' dL)",
        rule="gradient",
        lemma=False,
    )
    b.say("which vanishes where")
    b.given("K(t)", "V > 0")
    b.state("gain", Equation(K, "=", P * C.T * V.inv), "V is invertible", ["K(t)", "V^-1"], number="1", source=SOURCE)
    b.say("A vanishing gradient is no minimum yet. Completing the square gives more than the trace:")
    chain = b.chain(closed * P + P * closed.T + W + L * V * L.T)
    chain.to(_rate(s, P) + (L - K) * V * (L - K).T, "complete the square in the gain", ["gain", "V^-1"])
    chain.close("completed square")
    b.say("Let ", P, " obey the Riccati equation and start like every other covariance:")
    b.given("P(t)", "P_L(t0)")
    b.positive(
        "square",
        Equation((L - K) * V * (L - K).T, "⪰", Zero("", "")),
        "a congruence of a positive matrix",
        [SquareOf(L - K, "V > 0")],
    )
    b.compare(
        "optimal covariance",
        "transient",
        Equation(P_L, "⪰", P),
        "the difference solves a Lyapunov differential equation driven by the square, from zero or more",
        closed,
        "P_L(t0) >= P(t0)",
        "square",
        ["gain", "V^-1"],
    )
    b.given("optimal")
    b.unique(
        "attained",
        Equation(P_L, "=", P),
        "with the Kalman gain both covariances solve the same linear equation and start together",
        A - K * C,
        (A - K * C).T,
        ["optimal", "gain", "V^-1", "P_L(t0)"],
    )
    chain = b.chain(Dot(P_L))
    chain.to(Dot(P), "the covariance of the Kalman gain", ["attained"], rule="apply")
    chain.to(_rate(s, P), "the Riccati equation", number="u11", source=SOURCE)
    chain.close("Riccati equation", number="u11", source=SOURCE)


def _derive_steady_state(b: Builder) -> None:
    s = b.theory.symbols
    A, C, W, V, P, K, L, P_L = (s[k] for k in ("A", "C", "W", "V", "P", "K", "Lc", "Pc"))
    b.heading("Steady state")
    b.say("In steady state, where the limit exists,")
    b.given("steady P", "steady K", numbers=("u12",), source=SOURCE)
    chain = b.chain(_rate(s, P))
    chain.to(_rate(s, s["P(t)"]), "steady state", ["steady P"])
    chain.to(Dot(s["P(t)"]), "the Riccati equation")
    chain.to(Dot(P), "steady state", ["steady P"], rule="apply")
    chain.to(Zero("m", "m"), "a constant has no rate", number="2", source=SOURCE)
    chain.close("algebraic Riccati equation", number="2", source=SOURCE)
    roots = [r for r in range(-3, 4) if 2 * r - r * r == 0]
    b.erratum(
        SOURCE,
        "2",
        "incomplete",
        Equation(_rate(s, P), "=", Zero("m", "m")),
        "The equation has several solutions; the error covariance is the stabilising one (the strong one, where a mode "
        "on the imaginary axis is not excited).",
        evidence=(
            Evidence(((A, "1"), (C, "1"), (V, "1"), (W, "0")), tuple((f"P = {r}: A - K C", str(1 - r)) for r in roots)),
        ),
    )
    p0 = Fraction(1)
    b.erratum(
        SOURCE,
        "",
        "false",
        ("“(A, C) is detectable, so the estimator is asymptotically stable.”",),
        "Modes on the imaginary axis that the process noise does not excite are kept at the boundary.",
        evidence=(
            Evidence(
                ((A, "0"), (W, "0"), (C, "1"), (V, "1"), ("P(0)", str(p0))),
                tuple((f"P({k}) = 1/(1+{k}), A - K C", str(-p0 / (1 + p0 * k))) for k in (1, 10, 100)),
            ),
        ),
    )
    chain = b.chain(K)
    chain.to(s["K(t)"], "steady state", ["steady K"])
    chain.to(s["P(t)"] * C.T * V.inv, "the gain", ["gain"])
    chain.to(P * C.T * V.inv, "steady state", ["steady P"], number="3", source=SOURCE)
    chain.close("steady gain", number="3", source=SOURCE)
    closed = A - K * C
    b.state(
        "closed-loop form",
        Equation(closed * P + P * closed.T + W + K * V * K.T, "=", Zero("m", "m")),
        "the Riccati equation as a Lyapunov equation",
        ["algebraic Riccati equation", "steady gain", "V^-1"],
    )
    b.say("No constant gain that stabilises does better. For such a gain, with its own steady covariance,")
    b.given("steady covariance of a gain")
    b.positive(
        "steady square",
        Equation((L - K) * V * (L - K).T, "⪰", Zero("", "")),
        "a congruence of a positive matrix",
        [SquareOf(L - K, "V > 0")],
    )
    b.compare(
        "steady optimality",
        "lyapunov",
        Equation(P_L, "⪰", P),
        "the difference solves a Lyapunov equation with a Hurwitz matrix, driven by the square",
        A - L * C,
        "A - L C Hurwitz",
        "steady square",
        ["steady covariance of a gain", "algebraic Riccati equation", "steady gain", "V^-1"],
    )


def _derive_output_error(b: Builder) -> None:
    s = b.theory.symbols
    C, P, z, y_hat, difference, error, P_L = (s[k] for k in ("C", "P", "z", "ybar", "ztilde", "xtilde", "P_L"))
    b.heading("Output error covariance")
    b.given("true output", "output error", "Sigma")
    chain = b.chain(s["Sigma"])
    chain.to(Expect(difference * difference.T), "definition")
    chain.to(Expect((z - y_hat) * (z - y_hat).T), "definition of the output error", ["output error"], rule="apply")
    chain.to(
        Expect(C * error * error.T * C.T), "both outputs", ["true output", "output estimate", "error"], rule="apply"
    )
    chain.to(C * P_L * C.T, "expectation is linear")
    chain.to(C * P * C.T, "the Kalman gain, in steady state", ["attained", "steady P"], number="4", source=SOURCE)
    chain.close("output error covariance", number="4", source=SOURCE)


def _derive_factorisation(b: Builder) -> None:
    s = b.theory.symbols
    A, C, V, K, size, one = s["A"], s["C"], s["V"], s["K"], Identity("m"), Identity("l")
    riccati_and_gain = ("algebraic Riccati equation", "steady gain", "V^-1")
    b.heading("Spectral factorisation")
    b.say("The Popov function, at a generic complex number and on the imaginary axis, is")
    b.given("Phi_y(s)", "Phi_y(ω)", numbers=("16", "13"), source=SOURCE)
    for name, value, shown in (("s", s["s"] * size, "s"), ("jω", s["j"] * s["ω"] * size, "ω")):
        plus, minus = value - A, -value - A
        chain = b.chain(s[f"Phi_y({shown})"])
        factor, other = one + C * plus.inv * K, one + C * minus.inv * K
        chain.to(
            factor * V * other.T,
            "the Riccati equation, and both inverses",
            [f"Phi_y({shown})", f"({name}I-A)^-1", f"(-{name}I-A)^-1", *riccati_and_gain],
        )
        chain.close("spectral factorisation" + ("" if name == "s" else " on the imaginary axis"))
    plus, closed = s["s"] * size - A, s["s"] * size - A + K * C
    b.say("The factor has an inverse that is written with the closed loop:")
    b.state(
        "inverse factor",
        Equation((one + C * plus.inv * K) * (one - C * closed.inv * K), "=", one),
        "both inverses",
        ["(sI-A)^-1", "(sI-A+KC)^-1"],
    )
