"""What claims about the propagation of a state covariance may use: transition matrix, integral, rate, shaping filter.

Source: W. Vander Velde, Stochastic Estimation and Control (MIT 16.322), Fall 2004, Lecture 23. Letters and declarations
are those of the lecture; A, B, N, X without argument are those at t.
"""

from __future__ import annotations

from functools import cache

from derive.terms import Dot, Expect, Identity, Integral, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, copy
from derive.theory.covariance import theory

KEY, LECTURE = "covariance-ct", "covariance"
SIGNALS = ("x", "xbar", "xtilde", "n", "nbar", "ntilde")
BLOCKS = ("X_ss", "X_sv", "X_vv", "X_vv_inf", "N_v", "x_s", "v", "n_v", "A_ss", "A_sv", "A_vv", "B_v")
STARTS = ("t0", "τ", "τ1", "τ2")
VARIABLES = ("τ", "τ1")


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
    names |= {f"{k}()": s[k].at("t", "τ") for k in ("Phi_ss", "Phi_sv", "Phi_vv")}
    names |= {"X_vv(∞)": s["X_vv_inf"], "X_vv^∞": s["X_vv_inf"], "X_vv,∞": s["X_vv_inf"]}
    return Outline(
        KEY, t.title, t, names, declare, frozenset({"A", "B", "N", "X", "Phi", *SIGNALS, *BLOCKS}), frozenset("nq")
    )


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    if d.has("X", "N", *SIGNALS):
        _system(d)
    if d.has("Phi"):
        _transition(d)
    if d.has(*SIGNALS):
        d.given(theory(), "system", "mean", "deviation", "noise deviation", "white noise", "X", "X(t0)")
        for time in VARIABLES:
            x, n = d.of("xtilde", "ntilde")
            d.assume(f"x(t0) and n({time})", Expect(x.at("t0") * n.at(time).T), "=", Zero("n", "q"))
    if d.has(*BLOCKS):
        _filter(d)


def _system(d: Draft) -> None:
    A, B, N, X = d.of("A", "B", "N", "X")
    d.assume("N(t) >= 0", N, "⪰", text="an intensity is not negative")
    for time in VARIABLES:
        d.assume(f"N({time}) >= 0", N.at(time), "⪰", text="an intensity is not negative")
    d.assume("X(t) >= 0", X, "⪰", text="a covariance")
    d.assume("X(t0) >= 0", X.at("t0"), "⪰", text="a covariance")
    name = "covariance equation"
    d.assume(name, Dot(X), "=", A * X + X * A.T + B * N * B.T, by=(LECTURE, name))


def _transition(d: Draft) -> None:
    """Declare the transition matrix, and the integral expression of the covariance."""
    A, B, N, X, Phi = d.of("A", "B", "N", "X", "Phi")
    for start in STARTS:
        d.define(f"Phi(t,{start})", Dot(Phi.at("t", start)), A * Phi.at("t", start))
        d.define(f"Phi({start},{start})", Phi.at(start, start), Identity("n"))
    d.define("Phi(t,t)", Phi.at("t", "t"), Identity("n"))
    if d.has("X"):
        free = Phi.at("t", "t0") * X.at("t0") * Phi.at("t", "t0").T
        for time in VARIABLES:
            forced = Phi.at("t", time) * B.at(time) * N.at(time) * B.at(time).T * Phi.at("t", time).T
            name = "covariance integral" + ("" if time == "τ1" else f" over {time}")
            d.assume(name, X, "=", free + Integral(forced, time), by=(LECTURE, "covariance integral"))


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
