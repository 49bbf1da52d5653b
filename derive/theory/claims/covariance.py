"""What claims about the propagation of a state covariance may use: transition matrix, integral, rate, shaping filter.

Source: W. Vander Velde, Stochastic Estimation and Control (MIT 16.322), Fall 2004, Lecture 23. Letters and declarations
are those of the lecture; A, B, N, X without argument are those at t.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations, product

from derive.terms import Delta, Dot, Expect, Glyph, Identity, Integral, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, copy, named_at
from derive.theory.covariance import theory

KEY, LECTURE = "covariance-ct", "covariance"
SIGNALS = ("x", "xbar", "xtilde", "n", "nbar", "ntilde")
BLOCKS = ("X_ss", "X_sv", "X_vv", "X_vv_inf", "N_v", "x_s", "v", "n_v", "A_ss", "A_sv", "A_vv", "B_v")


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    lecture = theory()
    t = copy(lecture, lecture.symbols)
    t.key, t.title = KEY, "State covariance in continuous time"
    s = t.symbols
    names: dict[str, Term] = {k: s[k] for k in ("A", "B", "N", "X", "x", "n", "v")}
    names["Phi()"] = s["Phi"].at("t", "τ")
    names |= {"bar x": s["xbar"], "bar n": s["nbar"], "tilde x": s["xtilde"], "tilde n": s["ntilde"]}
    names |= {k: s[k] for k in BLOCKS if k != "X_vv_inf"}
    names |= {"X_vv(∞)": s["X_vv_inf"], "X_vv^∞": s["X_vv_inf"], "X_vv,∞": s["X_vv_inf"]}
    usual = frozenset({"A", "B", "N", "X", "Phi", *SIGNALS, *BLOCKS, "@τ", "@t0"})
    return Outline(KEY, t.title, t, names, declare, usual, frozenset("nq"))


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    if d.has("X", "N", *SIGNALS):
        _system(d)
    if d.has("Phi"):
        _transition(d)
    if d.has(*SIGNALS):
        _signals(d)
    if d.has(*BLOCKS):
        _filter(d)


def _system(d: Draft) -> None:
    A, B, N, X = d.of("A", "B", "N", "X")
    for time in dict.fromkeys((*d.times(), "τ", "t0")):
        d.assume(f"N({time}) >= 0", N.at(time), "⪰", text="an intensity is not negative")
        d.assume(f"X({time}) >= 0", X.at(time), "⪰", text="a covariance")
    name = "covariance equation"
    d.assume(name, Dot(X), "=", A * X + X * A.T + B * N * B.T, by=(LECTURE, name))


def _signals(d: Draft) -> None:
    """Declare the system, deviations from the mean, and white noise."""
    d.given(theory(), "system", "mean")
    x, mean, dev, n, n_mean, noise = d.of(*SIGNALS)
    N, X = d.of("N", "X")
    for time in d.times():
        d.define(named_at("deviation", time), dev.at(time), x.at(time) - mean.at(time))
        d.define(named_at("noise deviation", time), noise.at(time), n.at(time) - n_mean.at(time))
        d.define(named_at("X", time), Expect(dev.at(time) * dev.at(time).T), X.at(time))
        if time != "t0":
            start = Expect(dev.at("t0") * noise.at(time).T)
            d.assume(f"x(t0) and n({time})", start, "=", Zero("n", "q"), "uncorrelated with the noise that follows")
    for one, two in permutations(d.times(), 2):
        moment, delta = Expect(noise.at(one) * noise.at(two).T), Delta(one, two)
        d.assume(f"white noise at {one}, {two}", moment, "=", N.at(one) * delta, "the noise is white")


def _transition(d: Draft) -> None:
    """Declare the transition matrix between the times of a claim, and what it makes of the covariance."""
    A, B, N, X, Phi = d.of("A", "B", "N", "X", "Phi")
    for start in dict.fromkeys((*d.times()[1:], "τ", "t0")):
        d.define(f"Phi(t,{start})", Dot(Phi.at("t", start)), A * Phi.at("t", start))
        d.define(f"Phi({start},{start})", Phi.at(start, start), Identity("n"))
    d.define("Phi(t,t)", Phi.at("t", "t"), Identity("n"))
    apart = [(one, two) for one, two in d.pairs("Phi") if one != two]
    if len(apart) > 1:
        for one, two, three in product(d.times(), repeat=3):
            if one != two != three:
                name = f"Phi({one},{three}) by way of {two}"
                d.assume(name, Phi.at(one, three), "=", Phi.at(one, two) * Phi.at(two, three), "solutions continue")
    for one, two in apart:
        d.theory.fact(f"Phi({one},{two}) regular", "invertible", Phi.at(one, two), "a transition has a way back")
    if d.has("X"):
        kernel = Phi.at("t", "τ") * B.at("τ")
        forced, free = Integral(kernel * N.at("τ") * kernel.T, "τ"), Phi.at("t", "t0")
        by = (LECTURE, "covariance integral")
        d.assume("covariance integral", X, "=", free * X.at("t0") * free.T + forced, by=by)
        for start in (two for one, two in apart if one == "t" and two != "t0"):
            _since(d, start)


def _since(d: Draft, start: str) -> None:
    """Declare that the noise since an earlier time adds to the covariance."""
    X, Phi = d.of("X", "Phi")
    added = d.theory.matrix(f"noise since {start}", "n", "n", Glyph("Δ"), symmetric=True, constant=False)
    moved = Phi.at("t", start) * X.at(start) * Phi.at("t", start).T
    d.assume(f"X since {start}", X, "=", moved + added, by=(LECTURE, "covariance integral"))
    d.assume(f"noise since {start} >= 0", added, "⪰", text="the integral of a congruence of the intensity")


def _filter(d: Draft) -> None:
    """Declare system and shaping filter, the equations of their covariances, and where they start."""
    A_ss, A_sv, A_vv, B_v, N = d.of("A_ss", "A_sv", "A_vv", "B_v", "N_v")
    ss, sv, vv, stationary = d.of("X_ss", "X_sv", "X_vv", "X_vv_inf")
    d.given(theory(), "N_v >= 0", "A_vv Hurwitz", "stationary filter", "rest", "stationary start")
    rates = {
        "X_ss": (ss, A_ss * ss + ss * A_ss.T + A_sv * sv.T + sv * A_sv.T),
        "X_sv": (sv, A_ss * sv + sv * A_vv.T + A_sv * vv),
        "X_vv": (vv, A_vv * vv + vv * A_vv.T + B_v * N * B_v.T),
    }
    for name, (matrix, rate) in rates.items():
        d.assume(f"{name} equation", Dot(matrix), "=", rate, by=(LECTURE, f"{name} equation"))
    d.assume("X_vv_inf >= 0", stationary, "⪰", by=(LECTURE, "stationary covariance"))
    for time in ("t", "t0"):
        joint = block([[ss.at(time), sv.at(time)], [sv.at(time).T, vv.at(time)]])
        d.assume(f"joint covariance at {time}", joint, "⪰", text="a covariance")
    d.assume("stays stationary", vv, "=", stationary, by=(LECTURE, "stays stationary"))
    d.assume("X_ss(t0)", ss.at("t0"), "=", Zero("s", "s"), by=(LECTURE, "start"))
    d.assume("X_sv(t0)", sv.at("t0"), "=", Zero("s", "v"), by=(LECTURE, "start"))
    if d.has("x_s", "v", "n_v"):
        d.given(theory(), "driven system", "filter", "X_ss", "X_sv", "X_vv", "white filter noise")
        d.given(theory(), "n_v and x_s(t0)", "n_v and v(t0)")
