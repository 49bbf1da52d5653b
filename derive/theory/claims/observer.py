"""What claims about the observer in continuous time may use: error dynamics, correlation, covariance, optimal gain.

Source: lecture notes "Kalman filter" (observer with disturbance d and measurement input r), equations 31.x. Letters and
declarations are those of the lecture; L is the optimal gain, and P_e its covariance.
"""

from __future__ import annotations

from functools import cache

from derive.terms import Dot, Expect, Symbol, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, copy
from derive.theory.observer import theory

KEY, LECTURE = "observer-ct", "observer"
SIGNALS = ("x", "o", "u", "y", "y_o", "d", "r", "e", "xi")
INTENSITIES = ("S_dd", "S_dr", "S_rd", "S_rr")
CORRELATIONS = ("R_dd", "R_dr", "R_rd", "R_rr")
CLOSED = ("A_e", "B_ed", "B_er")
PAIRS = (("t", "τ"), ("τ", "t"))


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    lecture = theory()
    t = copy(lecture, {k: s for k, s in lecture.symbols.items() if k not in ("P", "L*", "R_e^-1")})
    t.key, t.title = KEY, "Observer in continuous time"
    plain = ("A", "B", "B_d", "C", "D_u", "D_d", "D_r", "L", *SIGNALS, *CLOSED, *INTENSITIES)
    names: dict[str, Term] = {k: t.symbols[k] for k in (*plain, "P_e", "W", "N", "R_e") if k != "xi"}
    names |= {"P": t.symbols["P_e"], "xi": t.symbols["xi"], "sigma_xi^2": t.symbols["sigma2"]}
    names |= {"hat x": t.symbols["o"]}
    names |= {f"{k}()": t.symbols[k].at("t", "τ") for k in ("Phi", "R_xixi", *CORRELATIONS)}
    usual = frozenset({*plain, *CORRELATIONS, "P_e", "W", "N", "R_e", "sigma2", "R_xixi"})
    return Outline(KEY, t.title, t, names, declare, usual, frozenset("nldr"))


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    covariance = d.has("P_e", "L")
    intensities = covariance or d.has(*INTENSITIES, "W", "N", "R_e", "sigma2", "R_xixi", *CORRELATIONS)
    if covariance or d.has(*CLOSED, *SIGNALS, "sigma2", "R_xixi"):
        d.given(theory(), *CLOSED)
    if intensities:
        _intensities(d)
    if covariance or d.has("sigma2", "R_xixi"):
        d.given(theory(), "sigma2")
        (sigma,) = d.of("sigma2")
        d.assume("sigma2 >= 0", sigma, "⪰", text="an intensity")
    if covariance:
        _covariance(d)
    if d.has(*SIGNALS):
        _dynamics(d)
    if d.has(*SIGNALS, *CORRELATIONS, "R_xixi"):
        _moments(d)


def _intensities(d: Draft) -> None:
    S_dd, S_dr, S_rd, S_rr, R_e = d.of(*INTENSITIES, "R_e")
    d.given(theory(), "S_rd")
    d.assume("joint noise", block([[S_dd, S_dr], [S_rd, S_rr]]), "⪰", text="a joint intensity")
    d.assume("S_dd >= 0", S_dd, "⪰", text="an intensity")
    d.assume("S_rr >= 0", S_rr, "⪰", text="an intensity")
    d.given(theory(), "W", "N", "R_e", "R_e > 0")
    d.inverse("R_e^-1", R_e, "l", "R_e > 0")


def _covariance(d: Draft) -> None:
    """Declare the Lyapunov equation for any gain, and the optimal gain."""
    C, L, N, R_e, P, A_e, sigma = d.of("C", "L", "N", "R_e", "P_e", "A_e", "sigma2")
    d.assume("P_e >= 0", P, "⪰", text="a covariance")
    rate = A_e * P + P * A_e.T + sigma
    d.assume("Lyapunov equation", Dot(P), "=", rate, by=(LECTURE, "Lyapunov equation"))
    d.assume("optimal gain", L, "=", (P * C.T + N) * R_e.inv, by=(LECTURE, "L*"), optimal=True)


def _dynamics(d: Draft) -> None:
    """Declare plant and observer, at both times, and the error dynamics."""
    d.given(theory(), "plant", "output", "observer", "observer output", "error", "xi(t)", "xi(τ)")
    e, xi, A_e = d.of("e", "xi", "A_e")
    d.assume("error dynamics", Dot(e), "=", A_e * e + xi, by=(LECTURE, "error dynamics"))


def _moments(d: Draft) -> None:
    """Declare the correlations of the noises, which are white, and with the initial error."""
    for a, b in ("dd", "dr", "rd", "rr"):
        one, two, R = d.of(a, b, f"R_{a}{b}")
        for first, second in PAIRS:
            d.define(f"R_{a}{b} at {first}, {second}", Expect(one.at(first) * two.at(second).T), R.at(first, second))
    if d.has(*INTENSITIES, "sigma2"):
        d.given(theory(), "white dd", "white dr", "white rd", "white rr")
    for a in d.of("d", "r"):
        start = Expect(a * d.of("e")[0].at("t0").T)
        d.assume(f"{a.name} and e(t0)", start, "=", Zero(a.rows, "n"), "uncorrelated with the initial error")
    if d.has("P_e"):
        e, P = d.of("e", "P_e")
        d.define("P_e", Expect(e * e.T), P)
    if d.has("R_xixi"):
        _correlation(d)


def _correlation(d: Draft) -> None:
    """Declare the correlation of the noise input; it is written with a constant gain."""
    xi, R = d.of("xi", "R_xixi")
    if not d.has("xi"):
        d.given(theory(), "xi(t)", "xi(τ)")
    d.define("R_xixi definition", Expect(xi.at("t") * xi.at("τ").T), R.at("t", "τ"))
    constant: list[Symbol] = d.of("B_ed", "B_er", "A_e", "L")
    for matrix in constant:
        name = f"{matrix.name} constant"
        d.assume(name, matrix.at("τ"), "=", matrix.at("t"), "gain and plant are constant")
        d.added.add(name)
