"""Stationary signals: autocorrelation, spectrum, covariance, white noise, and the output spectrum of a stable plant.

Part of the lecture on the Kalman-Bucy filter (Fang, Ishii, Chen and Johansson 2018, section II.A and around (15)).
Limits of averages and integrals over all lags or frequencies are letters to the kernel: what is used of them is what
is declared of them here. The one-sided transform is derived up to a limit, which is a hypothesis of its own.
"""

from __future__ import annotations

from fractions import Fraction

from derive.context import Theory
from derive.functions import PI, Definite, Exp, Infinity, Limit, Quotient
from derive.presentation import Named
from derive.terms import (
    Delta,
    Dot,
    Equation,
    Expect,
    Glyph,
    Identity,
    Integral,
    Neg,
    Number,
    Product,
    Symbol,
    Term,
    Zero,
)
from derive.theory.builder import Builder

SOURCE = "001"


def declare_signals(t: Theory) -> None:
    """Declare autocorrelation, spectrum and covariance of a stationary signal x, and what makes it white."""
    x, j, omega = t.symbols["x"], t.symbols["j"], t.symbols["ω"]
    lag, time = Symbol("τ", scalar=True), Symbol("t", scalar=True)
    R, R_0 = (
        t.matrix(f"R_x({a})", "m", "m", Glyph("R", sub="x"), show_args=(a,), meaning="autocorrelation of x")
        for a in ("τ", "0")
    )
    Phi = t.matrix("Phi_x(ω)", "m", "m", Glyph("Φ", sub="x"), show_args=("ω",), meaning="power spectrum of x")
    t.complex.add(Phi.name)
    Sigma = t.matrix("Sigma_x", "m", "m", Glyph("Σ", sub="x"), meaning="covariance of x")
    X = t.matrix("X_x", "m", "m", Glyph("X", sub="x"), meaning="spectrum of x when it is white")
    turn, turns = Product((j, omega, lag)), Quotient(Number(Fraction(1)), Product((Number(Fraction(2)), PI)))
    mean = _named(t, "mean of x(t+τ) x(t)", Limit(Expect(x.at("t+τ") * x.at("t").T), time, Infinity()))
    mean_0 = _named(t, "mean of x(t) x(t)", Limit(Expect(x.at("t") * x.at("t").T), time, Infinity()))
    forward = _named(t, "transform of R_x", _over_all(R * Exp(Neg(turn)), lag))
    back = _named(t, "inverse transform of Phi_x", turns * _over_all(Phi * Exp(turn), omega))
    back_0 = _named(t, "integral of Phi_x", turns * _over_all(Phi, omega))
    impulse = _named(t, "X_x δ(τ)", X * Symbol("δ", scalar=True, args=("τ",)))
    t.define("autocorrelation", R, mean)
    t.define("autocorrelation at 0", R_0, mean_0, "at lag 0")
    t.define("spectrum", Phi, forward)
    t.assume("inversion", R, "=", back, "Fourier inversion")
    t.assume("inversion at 0", R_0, "=", back_0, "at lag 0, where the exponential is 1")
    t.define("covariance", Sigma, mean_0)
    t.assume("constant spectrum", Phi, "=", X, "the case of a white signal", case=True)
    t.assume("white", R, "=", impulse, "the case of a white signal", case=True)


def _over_all(body: Term, variable: Symbol) -> Term:
    return Definite(body, variable, Neg(Infinity()), Infinity())


def _named(t: Theory, name: str, shows: Term) -> Symbol:
    """Declare a letter that prints as what it stands for."""
    t.matrix(name, "m", "m")
    t.complex.add(name)
    t.symbols[name] = letter = Named(name, "m", "m", shows=shows)
    return letter


def declare_plant(t: Theory) -> None:
    """Declare what the spectrum of a stable plant needs: hypotheses, correlation over time, one-sided transforms."""
    s = t.symbols
    A, C, V, w, v, x, y = (s[k] for k in ("A", "C", "V", "w", "v", "x", "y"))
    X = t.matrix("X", "m", "m", symmetric=True, meaning="stationary covariance of the state", unit="[state]^2")
    R = t.matrix("R_x", "m", "m", Glyph("R", sub="x"), constant=False, meaning="correlation of the state in time")
    start = "w, v and the initial state are uncorrelated"
    none = Zero("m", "l")
    t.assume("w and the initial state", Expect(w * x.at("t0").T), "=", Zero("m", "m"), start)
    t.assume("v and the initial state", Expect(v * x.at("t0").T), "=", Zero("l", "m"), start)
    t.assume("the initial state and v", Expect(x.at("t0") * v.at("t0").T), "=", none, start)
    t.assume("w and v(t0)", Expect(w.at("τ") * v.at("t0").T), "=", none, start)
    t.assume("w(τ) and the initial state", Expect(w.at("τ") * x.at("t0").T), "=", Zero("m", "m"), start)
    t.assume("v is white from t0", Expect(v * v.at("t0").T), "=", V * Delta("t", "t0"), "white noise")
    t.define("output(t0)", y.at("t0"), C * x.at("t0") + v.at("t0"))
    t.assume("stationary", Expect(x * x.T), "=", X, "A is stable, and the plant has run for long", case=True)
    t.assume("stationary(t0)", R.at("t0", "t0"), "=", X, "A is stable, and the plant has run for long", case=True)
    t.define("R_x(t,t0)", Expect(x * x.at("t0").T), R.at("t", "t0"))
    Phi_A = t.matrix("Phi_A", "m", "m", Glyph("Φ", sub="A"), constant=False, meaning="transition matrix of A")
    for since in ("t0", "τ"):
        t.define(f"Phi_A(t,{since})", Dot(Phi_A.at("t", since)), A * Phi_A.at("t", since))
    t.define("Phi_A(t,t)", Phi_A.at("t", "t"), Identity("m"))
    t.define("Phi_A(t0,t0)", Phi_A.at("t0", "t0"), Identity("m"))
    point = s["s"]
    decay = t.varying("Omega", "m", "m", Glyph("Ω"), meaning="the exponential of -s(t-t0), times the identity")
    t.complex.add("Omega")
    t.define("Omega", Dot(decay), -(point * decay))
    t.define("Omega(t0)", decay.at("t0"), Identity("m"))
    for sign in "+-":
        G = t.matrix(f"G{sign}", "m", "m", Glyph("G", sub=sign), meaning="one-sided transform of R_x")
        t.complex.add(G.name)
        matrix = _point(s, sign) - A
        t.assume(
            f"transform{sign}", matrix * G, "=", X, f"the limit at s = {sign.strip('+')}jω, for a stable A", case=True
        )
    S_y, S_z = (
        t.matrix(f"S_{k}(ω)", "l", "l", Glyph("S", sub=k), show_args=("ω",), meaning=f"power spectrum of {k}")
        for k in "yz"
    )
    Phi_x = s["Phi_x(ω)"]
    t.complex |= {S_y.name, S_z.name}
    both = s["G+"] + s["G-"].T
    t.assume("two-sided transform", Phi_x, "=", both, "the integral over all lags, split at 0", case=True)
    t.define("spectrum of y", S_y, C * Phi_x * C.T + V)
    t.define("spectrum of z", S_z, C * Phi_x * C.T)


def _point(s: dict[str, Symbol], sign: str) -> Term:
    value = s["j"] * s["ω"] * Identity("m")
    return value if sign == "+" else -value


def derive_signals(b: Builder) -> None:
    """Display what a stationary signal has, and derive its covariance from its spectrum."""
    s = b.theory.symbols
    b.heading("Stationary signals")
    b.say("All signals have mean zero. A signal ", s["x"], " is stationary if its autocorrelation exists,")
    b.given("autocorrelation", "autocorrelation at 0", numbers=("u1", ""), source=SOURCE)
    b.say("Its power spectrum is the transform of the autocorrelation, and has that as its inverse transform:")
    b.given("spectrum", "inversion", "inversion at 0", numbers=("u2", "u3", ""), source=SOURCE)
    b.say("The covariance of the signal is therefore the mean of its spectrum.")
    b.given("covariance")
    chain = b.chain(s["Sigma_x"])
    chain.to(s["R_x(0)"], "the autocorrelation at lag 0", ["covariance", "autocorrelation at 0"])
    chain.to(s["integral of Phi_x"], "the inversion at lag 0", ["inversion at 0"])
    chain.close("covariance from the spectrum", number="u4", source=SOURCE)
    b.say("The signal is white if its spectrum is constant; then")
    b.given("constant spectrum", "white", numbers=("", "u5"), source=SOURCE)


def derive_plant(b: Builder) -> None:
    """Derive the spectrum of the output of a stable plant, (15), and of its true output, (32)."""
    b.heading("The output spectrum of a stable plant")
    b.say(
        "Let ", b.theory.symbols["A"], " be stable, and the plant have run for so long that its state is stationary:"
    )  # fmt: skip
    b.given("stationary", "w and the initial state")
    _derive_lyapunov(b)
    _derive_correlation(b)
    _derive_transform(b)
    _derive_spectra(b)


def _derive_lyapunov(b: Builder) -> None:
    s = b.theory.symbols
    A, W, w, x, X, Phi = (s[k] for k in ("A", "W", "w", "x", "X", "Phi_A"))
    solution = Phi.at("t", "t0") * x.at("t0") + Integral(Phi.at("t", "τ") * w.at("τ"), "τ")
    b.unique(
        "state by variation of constants",
        Equation(x, "=", solution),
        "both sides solve the plant's equation and agree at the initial time",
        A,
        Zero("1", "1"),
        ["Phi_A(t,t)", "Phi_A(t0,t0)"],
    )
    chain = b.chain(Expect(w * x.T))
    chain.to(Expect(w * solution.T), "variation of constants", ["state by variation of constants"], rule="apply")
    half = Number(Fraction(1, 2)) * W
    chain.to(half, "white noise; a Dirac delta at the end of the interval counts half", ["Phi_A(t,t)"])
    chain.close("w and x")
    chain = b.chain(Zero("m", "m"))
    chain.to(Dot(X), "a constant has no rate")
    chain.to(Dot(Expect(x * x.T)), "stationary", rule="apply")
    chain.to(Expect(Dot(x) * x.T + x * Dot(x).T), "product rule inside the expectation")
    chain.to(A * X + X * A.T + W, "the plant, and the correlation of noise and state")
    chain.close("stationary covariance")


def _derive_correlation(b: Builder) -> None:
    s = b.theory.symbols
    A, C, V, x, v, y, R, Phi = (s[k] for k in ("A", "C", "V", "x", "v", "y", "R_x", "Phi_A"))
    lagged, x0, v0, y0 = R.at("t", "t0"), x.at("t0"), v.at("t0"), y.at("t0")
    b.say("The correlation of the state with what it was at an earlier time decays like the free motion:")
    b.given("R_x(t,t0)", "stationary(t0)")
    chain = b.chain(Dot(lagged))
    chain.to(Dot(Expect(x * x0.T)), "definition", rule="apply")
    chain.to(Expect(Dot(x) * x0.T), "what is past does not change")
    chain.to(A * lagged, "the plant; the noise that follows is uncorrelated with the state")
    chain.close("decay of the correlation")
    b.say("Process and measurement noise are uncorrelated, so that the output adds white noise to it:")
    b.given("v and the initial state", "the initial state and v", "w and v(t0)", "v is white from t0")
    solution = Phi.at("t", "t0") * x0 + Integral(Phi.at("t", "τ") * s["w"].at("τ"), "τ")
    chain = b.chain(Expect(x * v0.T))
    chain.to(Expect(solution * v0.T), "variation of constants", ["state by variation of constants"], rule="apply")
    chain.to(Zero("m", "l"), "the measurement noise is uncorrelated with all of it")
    chain.close("x and v(t0)")
    chain = b.chain(Expect(y * y0.T))
    both = (C * x + v) * (C * x0 + v0).T
    chain.to(Expect(both), "the output at both times", ["output", "output(t0)"], rule="apply")
    chain.to(C * lagged * C.T + V * Delta("t", "t0"), "expectation is linear")
    chain.close("correlation of the output")


def _derive_transform(b: Builder) -> None:
    s = b.theory.symbols
    A, X, R, decay, size = (*(s[k] for k in ("A", "X", "R_x", "Omega")), Identity("m"))
    part = Integral(R.at("τ", "t0") * decay.at("τ"), "τ")
    point, rest = s["s"] * size - A, X - R.at("t", "t0") * decay
    b.say(
        "For the transform of this over positive lags, let ", decay,
        " be the exponential of ", -s["s"], " times the lag, as a matrix. Up to a time ", Symbol("t"), " it satisfies",
    )  # fmt: skip
    b.given("Omega", "Omega(t0)")
    b.unique(
        "transform up to a time",
        Equation(point * part, "=", rest),
        "both sides have the same rate and vanish at the initial time",
        Zero("m", "m"),
        Zero("m", "m"),
        ["Omega(t0)", "stationary(t0)"],
    )
    b.say(
        "As time goes on the last term vanishes, since ", A, " is stable and ", s["s"], " has no negative real part. ",
        "The limits of the integral at ", s["j"] * s["ω"], " and ", -(s["j"] * s["ω"]), " are therefore given by",
    )  # fmt: skip
    b.given("transform+", "transform-")


def _derive_spectra(b: Builder) -> None:
    s = b.theory.symbols
    A, C, W, V, X, Phi = (s[k] for k in ("A", "C", "W", "V", "X", "Phi_x(ω)"))
    plus, minus = (_point(s, sign) - A for sign in "+-")
    b.say("At negative lags the autocorrelation is the transpose, so both together make the spectrum:")
    b.given("two-sided transform")
    state = plus.inv * W * minus.inv.T
    inverses = ["(jωI-A)^-1", "(-jωI-A)^-1"]
    chain = b.chain(Phi)
    limits = ["two-sided transform", "transform+", "transform-", *inverses]
    chain.to(plus.inv * X + X * minus.inv.T, "both limits", limits)
    chain.to(plus.inv * (X * minus.T + plus * X) * minus.inv.T, "a common factor on each side", inverses)
    chain.to(state, "the covariance is stationary", ["stationary covariance"])
    chain.close("spectrum of the state")
    b.say("The transform of a Dirac delta is 1. Hence the outputs have the spectra")
    b.given("spectrum of y", "spectrum of z")
    through = C * state * C.T
    for k, number, written in (("y", "15", through + V), ("z", "32", through)):
        chain = b.chain(s[f"S_{k}(ω)"])
        used = [f"spectrum of {k}", "spectrum of the state"]
        chain.to(written, "the spectrum of the state", used, number=number, source=SOURCE)
        if k == "y":
            chain.to(s["Phi_y(ω)"], "the Popov function", ["Phi_y(ω)"])
        chain.close(f"spectrum of {k}, written out")
