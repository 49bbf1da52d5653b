"""What claims about the observer in continuous time may use: error dynamics, correlation, covariance, optimal gain.

Source: lecture notes "Kalman filter" (observer with disturbance d and measurement input r), equations 31.x. Letters and
declarations are those of the lecture; L is the optimal gain, and P_e its covariance.
"""

from __future__ import annotations

from functools import cache
from itertools import product

from derive.terms import Delta, Dot, Expect, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, copy, named_at
from derive.theory.observer import theory

KEY, LECTURE = "observer-ct", "observer"
SIGNALS = ("x", "o", "u", "y", "y_o", "d", "r", "e", "xi")
INTENSITIES = ("S_dd", "S_dr", "S_rd", "S_rr")
CORRELATIONS = ("R_dd", "R_dr", "R_rd", "R_rr")
CLOSED = ("A_e", "B_ed", "B_er")


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
    usual = frozenset({*plain, *CORRELATIONS, "P_e", "W", "N", "R_e", "sigma2", "R_xixi", "@τ"})
    return Outline(KEY, t.title, t, names, declare, usual, frozenset("nldr"))


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    covariance = d.has("P_e", "L")
    correlations = d.has(*SIGNALS, *CORRELATIONS, "R_xixi")
    if covariance or correlations or d.has(*CLOSED, "sigma2"):
        _closed(d)
    if covariance or correlations or d.has(*INTENSITIES, "W", "N", "R_e", "sigma2"):
        _intensities(d)
    if covariance or d.has("sigma2", "R_xixi"):
        _noise_input(d)
    if covariance:
        _covariance(d)
    if d.has(*SIGNALS):
        _dynamics(d)
    if correlations:
        _moments(d)
    if d.has("R_xixi"):
        _correlation(d)


def _closed(d: Draft) -> None:
    """Declare the matrices of the error dynamics."""
    A, B_d, C, D_d, D_r, L = d.of("A", "B_d", "C", "D_d", "D_r", "L")
    A_e, B_ed, B_er = d.of(*CLOSED)
    for time in d.times():
        gain = L.at(time)
        d.define(named_at("A_e", time), A_e.at(time), A - gain * C)
        d.define(named_at("B_ed", time), B_ed.at(time), B_d - gain * D_d)
        d.define(named_at("B_er", time), B_er.at(time), -(gain * D_r))


def _intensities(d: Draft) -> None:
    S_dd, S_dr, S_rd, S_rr, R_e = d.of(*INTENSITIES, "R_e")
    d.given(theory(), "S_rd")
    d.assume("joint noise", block([[S_dd, S_dr], [S_rd, S_rr]]), "⪰", text="a joint intensity")
    d.assume("S_dd >= 0", S_dd, "⪰", text="an intensity")
    d.assume("S_rr >= 0", S_rr, "⪰", text="an intensity")
    d.given(theory(), "W", "N", "R_e", "R_e > 0")
    d.inverse("R_e^-1", R_e, "l", "R_e > 0")


def _noise_input(d: Draft) -> None:
    """Declare the intensity of the noise input."""
    S_dd, S_dr, S_rd, S_rr, sigma = d.of(*INTENSITIES, "sigma2")
    for time in d.times():
        B_ed, B_er = (b.at(time) for b in d.of("B_ed", "B_er"))
        right = B_ed * S_dd * B_ed.T + B_ed * S_dr * B_er.T + B_er * S_rd * B_ed.T + B_er * S_rr * B_er.T
        d.define(named_at("sigma2", time), sigma.at(time), right)
        d.assume(named_at("sigma2 >= 0", time), sigma.at(time), "⪰", text="an intensity")


def _covariance(d: Draft) -> None:
    """Declare the Lyapunov equation for any gain, and the optimal gain."""
    C, L, N, R_e, P, A_e, sigma = d.of("C", "L", "N", "R_e", "P_e", "A_e", "sigma2")
    rate = A_e * P + P * A_e.T + sigma
    d.assume("Lyapunov equation", Dot(P), "=", rate, by=(LECTURE, "Lyapunov equation"))
    for time in d.times():
        d.assume(named_at("P_e >= 0", time), P.at(time), "⪰", text="a covariance")
        best = (P.at(time) * C.T + N) * R_e.inv
        d.assume(named_at("optimal gain", time), L.at(time), "=", best, by=(LECTURE, "L*"), optimal=True)


def _dynamics(d: Draft) -> None:
    """Declare plant and observer, and the error dynamics."""
    d.given(theory(), "plant", "observer")
    C, D_u, D_d, D_r, A_e, B_ed, B_er = d.of("C", "D_u", "D_d", "D_r", "A_e", "B_ed", "B_er")
    for time in d.times():
        x, o, u, y, y_o, dist, r, e, xi = (signal.at(time) for signal in d.of(*SIGNALS))
        d.define(named_at("output", time), y, C * x + D_u * u + D_d * dist + D_r * r)
        d.define(named_at("observer output", time), y_o, C * o + D_u * u)
        d.define(named_at("error", time), e, x - o)
        d.define(f"xi({time})", xi, B_ed.at(time) * dist + B_er.at(time) * r)
    e, xi = d.of("e", "xi")
    d.assume("error dynamics", Dot(e), "=", A_e * e + xi, by=(LECTURE, "error dynamics"))


def _moments(d: Draft) -> None:
    """Declare the correlations of the noises, which are white, and with the initial error."""
    for (a, b), (first, second) in product(("dd", "dr", "rd", "rr"), product(d.times(), repeat=2)):
        one, two, R, S = d.of(a, b, f"R_{a}{b}", f"S_{a}{b}")
        moment = Expect(one.at(first) * two.at(second).T)
        d.define(f"R_{a}{b} at {first}, {second}", moment, R.at(first, second))
        if first != second:
            name = f"white {a}{b} at {first}, {second}"
            d.assume(name, R.at(first, second), "=", S * Delta(first, second), "d and r are jointly white")
    for a in d.of("d", "r"):
        start = Expect(a * d.of("e")[0].at("t0").T)
        d.assume(f"{a.name} and e(t0)", start, "=", Zero(a.rows, "n"), "uncorrelated with the initial error")
    if d.has("P_e"):
        for time in d.times():
            e, P = (s.at(time) for s in d.of("e", "P_e"))
            d.define(named_at("P_e", time), Expect(e * e.T), P)


def _correlation(d: Draft) -> None:
    """Declare the correlation of the noise input; it is written with a constant gain."""
    xi, R = d.of("xi", "R_xixi")
    for first, second in product(d.times(), repeat=2):
        d.define(f"R_xixi at {first}, {second}", Expect(xi.at(first) * xi.at(second).T), R.at(first, second))
    if not d.has(*SIGNALS):
        B_ed, B_er, dist, r = d.of("B_ed", "B_er", "d", "r")
        for time in d.times():
            d.define(f"xi({time})", xi.at(time), B_ed.at(time) * dist.at(time) + B_er.at(time) * r.at(time))
    for matrix, time in product(d.of("B_ed", "B_er", "A_e", "L"), d.times()[1:]):
        name = f"{matrix.name} constant at {time}"
        d.assume(name, matrix.at(time), "=", matrix, "gain and plant are constant")
        d.added.add(name)
