"""Propagation of the state covariance: transition matrix, integral, differential equation, shaping filters.

Source: W. Vander Velde, Stochastic Estimation and Control (MIT 16.322), Fall 2004, Lecture 23. A tilde marks the
deviation from the mean.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from derive.context import Theory
from derive.derivation import Evidence, Lecture, Step
from derive.terms import Delta, Dot, Equation, Expect, Glyph, Identity, Integral, Number, Symbol, Zero, block
from derive.theory.builder import Builder, SquareOf
from derive.theory.exact import lyapunov

KEY, THEORY, SOURCE = "covariance", "covariance-ct", "004"
HALF = Number(Fraction(1, 2))
TIMES = ("τ1", "τ2")


@cache
def theory() -> Theory:
    """Return the theory ``covariance-ct``: a time-varying linear system driven by white noise, and a shaping filter."""
    t = Theory(THEORY, "State covariance in continuous time")
    _system(t)
    _noise(t)
    _filter(t)
    _filter_noise(t)
    return t


def _system(t: Theory) -> None:
    A = t.varying("A", "n", "n", meaning="state matrix")
    B = t.varying("B", "n", "q", meaning="noise input matrix")
    x = t.signal("x", "n", mean="any", meaning="state")
    n = t.signal("n", "q", mean="any", meaning="noise")
    x_mean = t.varying("xbar", "n", "1", Glyph("x", accent="bar"), meaning="mean of the state")
    n_mean = t.varying("nbar", "q", "1", Glyph("n", accent="bar"), meaning="mean of the noise")
    x_dev = t.signal("xtilde", "n", Glyph("x", accent="tilde"), meaning="deviation of the state from its mean")
    n_dev = t.signal("ntilde", "q", Glyph("n", accent="tilde"), meaning="deviation of the noise from its mean")
    t.define("system", Dot(x), A * x + B * n)
    t.assume("mean", Dot(x_mean), "=", A * x_mean + B * n_mean, "the mean obeys the same system")
    t.define("deviation", x_dev, x - x_mean)
    t.define("noise deviation", n_dev, n - n_mean)


def _noise(t: Theory) -> None:
    s = t.symbols
    A, x, n = s["A"], s["xtilde"], s["ntilde"]
    Phi = t.matrix("Phi", "n", "n", Glyph("Φ"), constant=False, meaning="transition matrix")
    for start in ("τ", "t0", *TIMES):
        t.define(f"Phi(t,{start})", Dot(Phi.at("t", start)), A * Phi.at("t", start))
    t.define("Phi(t,t)", Phi.at("t", "t"), Identity("n"))
    t.define("Phi(t0,t0)", Phi.at("t0", "t0"), Identity("n"))
    N = t.varying("N", "q", "q", symmetric=True, meaning="intensity of the noise")
    X = t.varying("X", "n", "n", symmetric=True, meaning="state covariance", unit="[state]^2")
    white = "the noise is white"
    t.assume("white noise", Expect(n.at("τ1") * n.at("τ2").T), "=", N.at("τ1") * Delta("τ1", "τ2"), white)
    start = "the initial state is uncorrelated with the noise that follows"
    for time in TIMES:
        t.assume(f"x(t0) and n({time})", Expect(x.at("t0") * n.at(time).T), "=", Zero("n", "q"), start)
    t.define("X", Expect(x * x.T), X, "state covariance")
    t.define("X(t0)", Expect(x.at("t0") * x.at("t0").T), X.at("t0"), "initial state covariance")


def _filter(t: Theory) -> None:
    A_ss = t.matrix("A_ss", "s", "s", Glyph("A", sub="ss"), meaning="state matrix of the system")
    A_sv = t.matrix("A_sv", "s", "v", Glyph("A", sub="sv"), meaning="how the filter drives the system")
    A_vv = t.matrix("A_vv", "v", "v", Glyph("A", sub="vv"), meaning="state matrix of the shaping filter")
    B_v = t.matrix("B_v", "v", "m", Glyph("B", sub="v"), meaning="noise input matrix of the shaping filter")
    x = t.signal("x_s", "s", Glyph("x", sub="s"), meaning="system states")
    v = t.signal("v", "v", meaning="shaping filter states")
    n = t.signal("n_v", "m", Glyph("n", sub="v"), meaning="white noise at the input of the filter")
    t.define("driven system", Dot(x), A_ss * x + A_sv * v)
    t.define("filter", Dot(v), A_vv * v + B_v * n)
    Phi = {k: t.matrix(f"Phi_{k}", k[0], k[1], Glyph("Φ", sub=k), constant=False) for k in ("ss", "sv", "vv")}
    for start in ("t0", "τ"):
        ss, sv, vv = (Phi[k].at("t", start) for k in ("ss", "sv", "vv"))
        t.define(f"Phi_ss(t,{start})", Dot(ss), A_ss * ss)
        t.define(f"Phi_sv(t,{start})", Dot(sv), A_ss * sv + A_sv * vv)
        t.define(f"Phi_vv(t,{start})", Dot(vv), A_vv * vv)
    for time in ("t", "t0"):
        t.define(f"Phi_ss({time},{time})", Phi["ss"].at(time, time), Identity("s"))
        t.define(f"Phi_sv({time},{time})", Phi["sv"].at(time, time), Zero("s", "v"))
        t.define(f"Phi_vv({time},{time})", Phi["vv"].at(time, time), Identity("v"))


def _filter_noise(t: Theory) -> None:
    x, v, n = (t.symbols[k] for k in ("x_s", "v", "n_v"))
    A_vv, B_v = t.symbols["A_vv"], t.symbols["B_v"]
    N = t.matrix("N_v", "m", "m", Glyph("N", sub="v"), symmetric=True, meaning="intensity of the filter's noise")
    X = {
        "ss": t.varying("X_ss", "s", "s", Glyph("X", sub="ss"), symmetric=True),
        "sv": t.varying("X_sv", "s", "v", Glyph("X", sub="sv")),
        "vv": t.varying("X_vv", "v", "v", Glyph("X", sub="vv"), symmetric=True),
    }
    signals = {"s": x, "v": v}
    for key, block_ in X.items():
        a, b = signals[key[0]], signals[key[1]]
        t.define(f"X_{key}", Expect(a * b.T), block_)
        t.define(f"X_{key}(t0)", Expect(a.at("t0") * b.at("t0").T), block_.at("t0"))
    t.assume("white filter noise", Expect(n.at("t") * n.at("τ").T), "=", N * Delta("t", "τ"), "the noise is white")
    for a in (x, v):
        t.assume(f"n_v and {a.name}(t0)", Expect(n * a.at("t0").T), "=", Zero("m", a.rows))
    t.assume("N_v >= 0", N, "⪰", text="an intensity is not negative")
    stationary = t.matrix(
        "X_vv_inf",
        "v",
        "v",
        Glyph("X", sub="vv", sup="∞"),
        symmetric=True,
        meaning="stationary covariance of the shaping filter",
    )
    t.fact("A_vv Hurwitz", "hurwitz", A_vv, "the shaping filter is asymptotically stable")
    t.define("stationary filter", A_vv * stationary + stationary * A_vv.T + B_v * N * B_v.T, Zero("v", "v"))
    t.assume("rest", x.at("t0"), "=", Zero("s", "1"), "the system starts from rest")
    t.assume("stationary start", X["vv"].at("t0"), "=", stationary, "the filter has run for all past time")


@cache
def lecture() -> Lecture:
    """Return the lecture, every step proved when it is built."""
    b = Builder(theory(), KEY, "Propagation of the state covariance", (SOURCE,))
    _derive_integral(b)
    _derive_differential(b)
    _derive_augmentation(b)
    _derive_start(b)
    return b.lecture()


def integral() -> Step:
    """Return the proved integral expression of the state covariance."""
    return lecture().step("covariance integral")


def differential() -> Step:
    """Return the proved differential equation dX/dt = A X + X A' + B N B'."""
    return lecture().step("covariance equation")


def _solution(s: dict[str, Symbol], time: str):
    Phi, x, n, B = s["Phi"], s["xtilde"], s["ntilde"], s["B"]
    return Phi.at("t", "t0") * x.at("t0") + Integral(Phi.at("t", time) * B.at(time) * n.at(time), time)


def _derive_integral(b: Builder) -> None:
    """Derive the integral expression; the two middle terms vanish."""
    s = b.theory.symbols
    A, B, N, Phi, X = (s[k] for k in ("A", "B", "N", "Phi", "X"))
    x, x_mean, dev, n, noise = (s[k] for k in ("x", "xbar", "xtilde", "n", "ntilde"))
    b.heading("Deviation from the mean")
    b.say("A linear system with time-varying ", A, ", ", B, " is driven by white noise ", n, "; its mean obeys")
    b.given("system", "mean", "deviation", "noise deviation")
    chain = b.chain(Dot(dev))
    chain.to(Dot(x - x_mean), "definition of the deviation", ["deviation"], rule="apply")
    chain.to(Dot(x) - Dot(x_mean), "differentiation is linear")
    chain.to(A * dev + B * noise, "the system, and the equation of its mean", ["deviation", "noise deviation"])
    chain.close("deviation dynamics")
    b.heading("Solution by the transition matrix")
    b.given("Phi(t,τ)", "Phi(t,t)", numbers=("u1", "u1"), source=SOURCE)
    for time, name in zip(TIMES, ("variation of constants", "variation of constants, renamed"), strict=True):
        b.unique(
            name,
            Equation(dev, "=", _solution(s, time)),
            "both sides solve the system and agree at the initial time"
            + ("" if time == "τ1" else "; another variable of integration"),
            A,
            Zero("1", "1"),
            ["Phi(t,t)", "Phi(t0,t0)", "deviation", "noise deviation"],
        )
    b.heading("The covariance as an integral")
    b.given("X", "white noise", "x(t0) and n(τ1)")
    phi0, p1, p2 = Phi.at("t", "t0"), Phi.at("t", "τ1"), Phi.at("t", "τ2")
    b1, b2, n1, n2, x0 = B.at("τ1"), B.at("τ2"), noise.at("τ1"), noise.at("τ2"), dev.at("t0")
    chain = b.chain(X)
    chain.to(Expect(dev * dev.T), "definition", number="u2", source=SOURCE)
    both = ["variation of constants", "variation of constants, renamed"]
    product = _solution(s, "τ1") * _solution(s, "τ2").T
    chain.to(Expect(product), "variation of constants", both, rule="apply", number="u2", source=SOURCE)
    chain.to(
        phi0 * Expect(x0 * x0.T) * phi0.T
        + Integral(phi0 * Expect(x0 * n2.T) * b2.T * p2.T, "τ2")
        + Integral(p1 * b1 * Expect(n1 * x0.T) * phi0.T, "τ1")
        + Integral(Integral(p1 * b1 * Expect(n1 * n2.T) * b2.T * p2.T, "τ2"), "τ1"),
        "expectation is linear",
        number="u3",
        source=SOURCE,
    )
    chain.to(
        phi0 * X.at("t0") * phi0.T
        + Integral(Integral(p1 * b1 * N.at("τ1") * Delta("τ1", "τ2") * b2.T * p2.T, "τ2"), "τ1"),
        "the two middle terms vanish; the noise is white",
        number="u4",
        source=SOURCE,
    )
    chain.to(
        phi0 * X.at("t0") * phi0.T + Integral(p1 * b1 * N.at("τ1") * b1.T * p1.T, "τ1"),
        "a Dirac delta inside the interval samples the integrand",
        number="u4",
        source=SOURCE,
    )
    chain.close("covariance integral", number="u4", source=SOURCE)
    b.erratum(
        SOURCE,
        "u3",
        "assumption",
        ("The middle terms are said to vanish because the noise is white.",),
        "White noise alone is not enough: the noise must also be uncorrelated with the initial state from then on.",
        proved_by="covariance integral",
    )


def _derive_differential(b: Builder) -> None:
    """Derive dX/dt by Leibniz's rule."""
    s = b.theory.symbols
    A, B, N, Phi, X = (s[k] for k in ("A", "B", "N", "Phi", "X"))
    phi0, p1, X0 = Phi.at("t", "t0"), Phi.at("t", "τ1"), X.at("t0")
    inside = p1 * B.at("τ1") * N.at("τ1") * B.at("τ1").T * p1.T
    start = phi0 * X0 * phi0.T
    b.heading("The covariance as a differential equation")
    chain = b.chain(Dot(X))
    chain.to(Dot(start + Integral(inside, "τ1")), "the integral", ["covariance integral"], rule="apply")
    end = Phi.at("t", "t")
    chain.to(
        A * start + start * A.T + end * B * N * B.T * end.T + Integral(A * inside, "τ1") + Integral(inside * A.T, "τ1"),
        "product rule and Leibniz's rule",
        number="u5",
        source=SOURCE,
    )
    chain.to(A * X + X * A.T + B * N * B.T, "collect", ["covariance integral", "Phi(t,t)"], number="u6", source=SOURCE)
    chain.close("covariance equation", number="u6", source=SOURCE)


def _derive_augmentation(b: Builder) -> None:
    """Derive the covariance equations of a system driven by a shaping filter, block by block."""
    s = b.theory.symbols
    A_ss, A_sv, A_vv, B_v, N = (s[k] for k in ("A_ss", "A_sv", "A_vv", "B_v", "N_v"))
    x, v, n, X_ss, X_sv, X_vv = (s[k] for k in ("x_s", "v", "n_v", "X_ss", "X_sv", "X_vv"))
    Phi = {k: s[f"Phi_{k}"] for k in ("ss", "sv", "vv")}
    b.heading("Shaping filters")
    b.say(
        "Coloured noise is white noise ", n, " through a filter with states ", v, ", which drives the system states ", x
    )
    b.given("driven system", "filter")
    A = block([[A_ss, A_sv], [Zero("v", "s"), A_vv]])
    B = block([[Zero("s", "m")], [B_v]])
    stacked, X = block([[x], [v]]), block([[X_ss, X_sv], [X_sv.T, X_vv]])
    b.state(
        "augmented system",
        Equation(Dot(stacked), "=", A * stacked + B * n),
        "stack the states",
        number="u8",
        source=SOURCE,
        lemma=False,
    )
    from_start = {
        "v": Phi["vv"].at("t", "t0") * v.at("t0") + Integral(Phi["vv"].at("t", "τ") * B_v * n.at("τ"), "τ"),
        "x_s": Phi["ss"].at("t", "t0") * x.at("t0")
        + Phi["sv"].at("t", "t0") * v.at("t0")
        + Integral(Phi["sv"].at("t", "τ") * B_v * n.at("τ"), "τ"),
    }
    ends = [f"Phi_{k}({a},{a})" for k in Phi for a in ("t", "t0")]
    reason = "both sides solve the differential equation and agree at the initial time"
    b.say("Variation of constants, with the blocks of the transition matrix, gives")
    b.unique("filter solution", Equation(v, "=", from_start["v"]), reason, A_vv, Zero("1", "1"), ends)
    b.unique(
        "system solution", Equation(x, "=", from_start["x_s"]), reason, A_ss, Zero("1", "1"), [*ends, "filter solution"]
    )
    b.given("white filter noise", "n_v and x_s(t0)", "n_v and v(t0)")
    for signal, key, value in ((v, "vv", HALF * N * B_v.T), (x, "sv", Zero("m", "s"))):
        solved = from_start[signal.name]
        lemma = "filter solution" if signal is v else "system solution"
        chain = b.chain(Expect(n * signal.T))
        chain.to(Expect(n * solved.T), "variation of constants", [lemma], rule="apply")
        chain.to(value, "a Dirac delta at the end of the interval counts half", [f"Phi_{key}(t,t)"])
        chain.close(f"n_v and {signal.name}")
    equations = {
        "X_ss": (X_ss, x, x, A_ss * X_ss + X_ss * A_ss.T + A_sv * X_sv.T + X_sv * A_sv.T),
        "X_sv": (X_sv, x, v, A_ss * X_sv + X_sv * A_vv.T + A_sv * X_vv),
        "X_vv": (X_vv, v, v, A_vv * X_vv + X_vv * A_vv.T + B_v * N * B_v.T),
    }
    b.say("The blocks of the covariance therefore obey")
    for name, (part, a, c, rate) in equations.items():
        chain = b.chain(Dot(part))
        chain.to(Dot(Expect(a * c.T)), "definition", rule="apply")
        chain.to(Expect(Dot(a) * c.T + a * Dot(c).T), "product rule inside the expectation")
        chain.to(rate, "system and filter")
        chain.close(f"{name} equation")
    b.state(
        "augmented covariance",
        Equation(Dot(X), "=", A * X + X * A.T + B * N * B.T),
        "the three equations are the blocks of the covariance equation of the augmented system",
        lemma=False,
    )


def _derive_start(b: Builder) -> None:
    """Derive the stationary start and that the filter's covariance stays there."""
    s = b.theory.symbols
    A_vv, B_v, N, X_inf = (s[k] for k in ("A_vv", "B_v", "N_v", "X_vv_inf"))
    x0, v0, X_ss, X_sv, X_vv = s["x_s"].at("t0"), s["v"].at("t0"), s["X_ss"], s["X_sv"], s["X_vv"]
    b.heading("Stationary start")
    b.say("The system starts from rest, the filter in its steady state, which solves a Lyapunov equation:")
    b.given("rest", "stationary filter", "stationary start")
    none = {k: Zero(k[0], k[1]) for k in ("ss", "sv", "vs")}
    chain = b.chain(block([[X_ss.at("t0"), X_sv.at("t0")], [X_sv.at("t0").T, X_vv.at("t0")]]))
    stacked = block([[x0], [v0]])
    chain.to(Expect(stacked * stacked.T), "definition", number="u7", source=SOURCE)
    rest = block([[none["ss"], none["sv"]], [none["vs"], v0 * v0.T]])
    chain.to(Expect(rest), "the system starts from rest", ["rest"], rule="apply", number="u7", source=SOURCE)
    final = block([[none["ss"], none["sv"]], [none["vs"], X_inf]])
    chain.to(final, "the filter has run for all past time", ["stationary start"], number="u7", source=SOURCE)
    chain.close("start", number="u7", source=SOURCE)
    b.say("The filter's part is a covariance, and it stays where it is:")
    forcing = B_v * N * B_v.T
    b.positive("forcing", Equation(forcing, "⪰", Zero("", "")), "a congruence", [SquareOf(B_v, "N_v >= 0")])
    b.compare(
        "stationary covariance",
        "lyapunov",
        Equation(X_inf, "⪰", Zero("", "")),
        "Lyapunov equation with a Hurwitz matrix",
        A_vv,
        "A_vv Hurwitz",
        "forcing",
        ["stationary filter"],
    )
    b.unique(
        "stays stationary",
        Equation(X_vv, "=", X_inf),
        "both sides solve the filter's covariance equation and agree at the initial time",
        A_vv,
        A_vv.T,
        ["stationary filter", "stationary start"],
    )
    stable, unstable = lyapunov([[-1, 1], [0, -2]], [[0, 0], [0, 1]]), lyapunov([[1]], [[1]])
    b.erratum(
        SOURCE,
        "u7",
        "assumption",
        b.steps["start"].statement,
        "It needs a filter that is asymptotically stable, time-invariant and driven by noise of constant intensity.",
        evidence=(
            Evidence(
                ((A_vv, "-2"), (s["A_ss"], "-1"), (s["A_sv"], "1"), (B_v, "1"), (N, "1")),
                (("filter variance", str(stable[1][1])), ("cross covariance tends to", str(stable[0][1]))),
            ),
            Evidence(
                ((A_vv, "1"), (B_v, "1"), (N, "1")),
                (("the only solution of the stationary equation, no covariance", str(unstable[0][0])),),
            ),
        ),
        proved_by="stays stationary",
    )
