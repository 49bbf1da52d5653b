"""The innovation of the Kalman-Bucy filter is white: in time, by its integral, and in frequency, by its spectrum.

Part of the lecture on the Kalman-Bucy filter (Fang, Ishii, Chen and Johansson 2018, the two equations after (4)). The
Dirac delta of the source is read under the integral: the correlation of the innovation with its integral since any
initial time t0 is that of white noise, V/2, all of it from the end of the interval.
"""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.terms import Delta, Dot, Equation, Expect, Glyph, Identity, Integral, Number, Symbol, Term, Zero
from derive.theory.builder import Builder

SOURCE = "001"
HALF = Number(Fraction(1, 2))


def declare_innovation(t: Theory) -> None:
    """Declare the integral of the innovation, its correlation with the error, and the innovation's spectrum."""
    s = t.symbols
    A, C, W, V, K, e, error, Phi = (s[k] for k in ("A", "C", "W", "V", "K", "e", "xtilde", "Phi"))
    total = t.signal("eta", "l", Glyph("η"), meaning="integral of the innovation")
    t.define("integral of the innovation", Dot(total), e)
    t.define("its start", total.at("t0"), Zero("l", "1"))
    Psi = t.matrix("Psi", "l", "m", Glyph("Ψ"), constant=False, parameter=False, meaning="integral of C Phi")
    for since in ("t0", "τ"):
        t.define(f"Psi(t,{since})", Dot(Psi.at("t", since)), C * Phi.at("t", since))
    t.define("Psi(t,t)", Psi.at("t", "t"), Zero("l", "m"))
    t.define("Psi(t0,t0)", Psi.at("t0", "t0"), Zero("l", "m"))
    S = t.varying("S", "m", "l", parameter=False, meaning="correlation of the error and the integral")
    t.define("S", Expect(error * total.T), S)
    t.define("S(t0)", Expect(error.at("t0") * total.at("t0").T), S.at("t0"))
    closed = -(s["s"] * Identity("m")) - A + K * C
    t.fact("-s closed loop", "invertible", closed, "a generic point: no eigenvalue")
    t.inverse("(-sI-A+KC)^-1", closed, "m", because="-s closed loop")
    spectrum = t.matrix("Phi_e(s)", "l", "l", Glyph("Φ", sub="e"), constant=False, show_args=("s",))
    t.complex.add(spectrum.name)
    forward, backward = _closed_loop(s)
    t.define(
        "Phi_e(s)",
        spectrum,
        C * forward * W * backward.T * C.T
        + (Identity("l") - C * forward * K) * V * (Identity("l") - C * backward * K).T,
    )


def declare_one_output(t: Theory) -> None:
    """Declare the output error and its variance for a single output, where C is a row."""
    x, x_hat = t.symbols["x"], t.symbols["xbar"]
    C = t.matrix("C1", "1", "m", Glyph("C"), meaning="output matrix, a row")
    z, y_hat, difference = (
        t.varying(name, "1", "1", glyph, symmetric=True, parameter=False, meaning=meaning)
        for name, glyph, meaning in (
            ("z1", Glyph("z"), "true output, a number"),
            ("ybar1", Glyph("y", accent="bar"), "output estimate, a number"),
            ("ztilde1", Glyph("z", accent="tilde"), "output error, a number"),
        )
    )
    t.random.add("ztilde1")
    t.uncentred |= {"z1", "ybar1"}
    variance = t.varying(
        "sigma2",
        "1",
        "1",
        Glyph("σ", sub="z-ȳ", sup="2"),
        symmetric=True,
        parameter=False,
        meaning="variance of the output error",
    )
    t.define("true output, l = 1", z, C * x)
    t.define("output estimate, l = 1", y_hat, C * x_hat)
    t.define("output error, l = 1", difference, z - y_hat)
    t.define("sigma2", Expect(difference * difference.T), variance)


def derive_one_output(b: Builder) -> None:
    """Derive the variance of the output error for one output from the steps of (4)."""
    s = b.theory.symbols
    C, P, P_L, z, y_hat, difference, error = (s[k] for k in ("C1", "P", "P_L", "z1", "ybar1", "ztilde1", "xtilde"))
    b.say("With one output, l = 1, ", C, " is a row, outputs are numbers, and the covariance is a variance:")
    b.given("true output, l = 1", "output error, l = 1", "sigma2")
    chain = b.chain(s["sigma2"])
    chain.to(Expect(difference * difference), "definition; a number is its own transpose", number="u13", source=SOURCE)
    gap = z - y_hat
    chain.to(
        Expect(gap * gap),
        "definition of the output error",
        ["output error, l = 1"],
        rule="apply",
        number="u13",
        source=SOURCE,
    )
    outputs = ["true output, l = 1", "output estimate, l = 1", "error"]
    chain.to(Expect(C * error * error.T * C.T), "both outputs", outputs, rule="apply")
    chain.to(C * P_L * C.T, "expectation is linear")
    chain.to(C * P * C.T, "the Kalman gain, in steady state", ["attained", "steady P"], number="u13", source=SOURCE)
    chain.close("output error variance", number="u13", source=SOURCE)


def derive_innovation(b: Builder) -> None:
    """Derive that the innovation is white, in time and in frequency."""
    s = b.theory.symbols
    e, total, C, v, error = (s[k] for k in ("e", "eta", "C", "v", "xtilde"))
    b.heading("The innovation is white")
    b.say("The innovation is the error as it shows in the output, and noise:")
    signals = ["innovation", "output", "output estimate", "error"]
    b.state("innovation from the error", Equation(e, "=", C * error + v), "both outputs", signals)
    b.say("White noise is known by its integral. From any initial time on, let")
    b.given("integral of the innovation", "its start")
    b.unique(
        "integral written out",
        Equation(total, "=", Integral(e.at("τ"), "τ")),
        "both sides have the same rate and vanish at the initial time",
        Zero("l", "l"),
        Zero("1", "1"),
        ["its start"],
    )
    _derive_noise_and_integral(b)
    _derive_orthogonality(b)
    _derive_whiteness(b)
    _derive_constant_spectrum(b)


def _derive_noise_and_integral(b: Builder) -> None:
    s = b.theory.symbols
    L, V, w, v, error, total, Phi, Psi = (s[k] for k in ("L", "V", "w", "v", "xtilde", "eta", "Phi", "Psi"))
    noise = (w - L * v, w.at("τ") - L.at("τ") * v.at("τ"))
    solution = Psi.at("t", "t0") * error.at("t0") + Integral(Psi.at("t", "τ") * noise[1] + v.at("τ"), "τ")
    b.say("With ", Psi, " the integral of ", s["C"] * Phi, ", variation of constants gives")
    b.unique(
        "integral by variation of constants",
        Equation(total, "=", solution),
        "both sides have the same rate and vanish at the initial time",
        Zero("l", "l"),
        Zero("1", "1"),
        ["innovation from the error", "variation of constants", "its start", "Psi(t,t)", "Psi(t0,t0)"],
    )
    for signal, value in ((w, Zero("m", "l")), (v, HALF * V)):
        chain = b.chain(Expect(signal * total.T))
        lemma = ["integral by variation of constants"]
        chain.to(Expect(signal * solution.T), "variation of constants", lemma, rule="apply")
        chain.to(value, "white noise; a Dirac delta at the end of the interval counts half", ["Psi(t,t)"])
        chain.close(f"{signal.name} and integral")


def _derive_orthogonality(b: Builder) -> None:
    s = b.theory.symbols
    A, C, L, K, V, e, v, error, total, S, P_L = (
        s[k] for k in ("A", "C", "L", "K(t)", "V", "e", "v", "xtilde", "eta", "S", "P_L")
    )
    b.say("The error and the integral have the correlation")
    b.given("S")
    closed = A - L * C
    chain = b.chain(Expect(error * e.T))
    chain.to(Expect(error * (C * error + v).T), "the innovation", ["innovation from the error"], rule="apply")
    chain.to(P_L * C.T - HALF * L * V, "the correlation of noise and error")
    chain.close("error and innovation")
    chain = b.chain(Dot(S))
    chain.to(Dot(Expect(error * total.T)), "definition", rule="apply")
    chain.to(Expect(Dot(error) * total.T + error * Dot(total).T), "product rule inside the expectation")
    chain.to(closed * S + P_L * C.T - L * V, "error dynamics, and the correlations of noise, error and integral")
    chain.close("correlation of error and integral")
    b.say("It starts from zero, and the Kalman gain, of which ", K * V, " is ", s["P(t)"] * C.T, ", keeps it there:")
    chain = b.chain(S.at("t0"))
    chain.to(Expect(error.at("t0") * total.at("t0").T), "definition")
    chain.to(Expect(error.at("t0") * Zero("1", "l")), "the integral starts from zero", ["its start"], rule="apply")
    chain.to(Zero("m", "l"), "nothing correlates with zero")
    chain.close("start of the correlation")
    b.unique(
        "orthogonality",
        Equation(S, "=", Zero("m", "l")),
        "with the Kalman gain both sides solve the same linear equation and start together",
        A - K * C,
        Zero("l", "l"),
        ["optimal", "attained", "K(t)", "start of the correlation"],
    )


def _derive_whiteness(b: Builder) -> None:
    s = b.theory.symbols
    C, V, e, v, error, total, S = (s[k] for k in ("C", "V", "e", "v", "xtilde", "eta", "S"))
    b.say("The error is uncorrelated with all that the filter has seen since the initial time. Therefore")
    white = Integral(V * Delta("t", "τ"), "τ")
    chain = b.chain(Expect(e * Integral(e.at("τ"), "τ").T))
    chain.to(Expect(e * total.T), "the integral of the innovation", ["integral written out"], rule="apply")
    chain.to(Expect((C * error + v) * total.T), "the innovation", ["innovation from the error"], rule="apply")
    chain.to(C * S + HALF * V, "the correlations with the integral")
    chain.to(HALF * V, "the error is uncorrelated with the integral", ["orthogonality"])
    chain.to(white, "a Dirac delta at the end of the interval counts half", number="u14", source=SOURCE)
    chain.close("the innovation is white", lemma=False, number="u14", source=SOURCE)
    b.say(
        "This holds from every initial time on, however short the interval: all of the correlation comes from its end. "
        "That is what it means that the autocorrelation of ", e, " is ", V, " times a Dirac delta of the lag."
    )  # fmt: skip


def _closed_loop(s: dict[str, Symbol]) -> tuple[Term, Term]:
    """Return (sI-A+KC)^-1 and (-sI-A+KC)^-1."""
    size = s["s"] * Identity("m")
    return (size - s["A"] + s["K"] * s["C"]).inv, (-size - s["A"] + s["K"] * s["C"]).inv


def _derive_constant_spectrum(b: Builder) -> None:
    s = b.theory.symbols
    V = s["V"]
    b.say(
        "In steady state the same shows in frequency. Noise reaches the innovation through the closed loop, and "
        "beside it, which makes the spectrum of the innovation"
    )
    b.given("Phi_e(s)")
    used = ["Phi_e(s)", "(sI-A+KC)^-1", "(-sI-A+KC)^-1", "closed-loop form", "steady gain", "V^-1"]
    chain = b.chain(s["Phi_e(s)"])
    chain.to(V, "the Riccati equation, and both inverses", used)
    chain.close("constant spectrum of the innovation")
    b.say("a constant: white noise again, and of the same intensity.")
