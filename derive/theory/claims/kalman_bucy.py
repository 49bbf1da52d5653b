"""What claims about the Kalman-Bucy filter may use: P, K steady, P(t), K(t) on the way, spectra at ω and s.

Source: S. Fang, H. Ishii, J. Chen, K. H. Johansson, A Frequency-Domain Characterization of Optimal Error Covariance for
the Kalman-Bucy Filter, arXiv:1807.08604, 2018. Its e = y - ybar is the innovation. Without a letter N in the claim the
noises are uncorrelated.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product

from derive.context import Theory
from derive.functions import PI
from derive.spectral import Conjugate
from derive.terms import Delta, Dot, Expect, Glyph, Identity, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, named_at

KEY, LECTURE = "kalman-bucy", "kalman-bucy"
SIGNALS = ("x", "xbar", "xtilde", "y", "ybar", "z", "ztilde", "e", "u", "w", "v")
ON_THE_WAY = ("P(t)", "K(t)", *SIGNALS)


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    t = Theory(KEY, "Kalman-Bucy filter")
    t.matrix("A", "m", "m", meaning="state matrix", unit="1/s")
    t.matrix("B", "m", "p", meaning="noise input matrix")
    t.matrix("C", "l", "m", meaning="output matrix")
    t.matrix("W", "m", "m", symmetric=True, meaning="intensity of the process noise", unit="[state]^2/s")
    t.matrix("V", "l", "l", symmetric=True, meaning="intensity of the measurement noise", unit="[output]^2 s")
    t.matrix("N", "m", "l", meaning="cross intensity of the noises", unit="[state] [output]")
    t.matrix("P", "m", "m", symmetric=True, meaning="steady error covariance", unit="[state]^2")
    t.matrix("K", "m", "l", meaning="steady Kalman gain")
    P = t.varying("P(t)", "m", "m", Glyph("P"), symmetric=True, meaning="optimal error covariance", unit="[state]^2")
    K = t.varying("K(t)", "m", "l", Glyph("K"), meaning="Kalman gain")
    t.symbols |= {"P(t)": replace(P, show_args=None), "K(t)": replace(K, show_args=None)}
    t.matrix("δK(t)", "m", "l", parameter=False)
    t.matrix(
        "Sigma", "l", "l", Glyph("Σ", sub="z-ȳ"), symmetric=True, parameter=False, meaning="output error covariance"
    )
    _signals(t)
    _spectra(t)
    usual = {"A", "C", "W", "V", "P", "K", "@τ", "@t0", *ON_THE_WAY, "Sigma", "Phi_y(s)", "Phi_y(ω)"}
    return Outline(KEY, t.title, t, _names(t), declare, frozenset(usual), frozenset("ml"))


def _signals(t: Theory) -> None:
    t.signal("x", "m", meaning="state")
    t.signal("y", "l", meaning="output")
    t.signal("z", "l", mean="any", meaning="true output")
    t.signal("xbar", "m", Glyph("x", accent="bar"), mean="any", meaning="state estimate")
    t.signal("ybar", "l", Glyph("y", accent="bar"), mean="any", meaning="output estimate")
    t.signal("e", "l", meaning="innovation")
    t.signal("u", "m", mean="any", meaning="correction")
    t.signal("w", "m", meaning="process noise")
    t.signal("v", "l", meaning="measurement noise")
    t.signal("xtilde", "m", Glyph("x", accent="tilde"), meaning="error of the state estimate")
    t.signal("ztilde", "l", Glyph("z", accent="tilde"), meaning="output error")


def _spectra(t: Theory) -> None:
    t.symbols["π"] = PI
    t.scalar("s", meaning="a complex number")
    t.scalar("j", Glyph("j", upright=True), meaning="imaginary unit")
    t.scalar("ω", meaning="frequency")
    t.scalar("i", meaning="number of an eigenvalue")
    t.scalar("m", meaning="number of states")
    t.roots("λ", t.symbols["i"], t.symbols["m"], Glyph("λ", sub="i"), of="A", meaning="eigenvalue of A")
    for root, of, glyph in (("φ", "zero", "φ"), ("η", "pole", "η"), ("ζ", "zero in the right half plane", "z")):
        t.roots(root, t.symbols["i"], t.symbols["m"], Glyph(glyph, sub="i"), meaning=f"{of} of f")
    for function in "fpq":
        t.scalar(function)
        t.symbols[function] = replace(t.symbols[function], show_args=("s",))
    t.parameter("σ0", Glyph("σ", sub="0"), meaning="real part of s_0")
    t.parameter("ω0", Glyph("ω", sub="0"), meaning="imaginary part of s_0")
    for letter in "yz":
        for shown in ("s", "ω"):
            name = f"Phi_{letter}({shown})"
            t.matrix(name, "l", "l", Glyph("Φ", sub=letter), show_args=(shown,), meaning=f"spectrum of {letter}")
            t.complex.add(name)


def _names(t: Theory) -> dict[str, Term]:
    s = t.symbols
    names: dict[str, Term] = {k: s[k] for k in ("A", "B", "C", "W", "V", "N", "P", "K", "s", "i", "m")}
    names |= {"P_∞": s["P"], "K_∞": s["K"], "P()": s["P(t)"], "K()": s["K(t)"], "j": s["j"], "omega": s["ω"]}
    names |= {"pi": s["π"], "lambda_i(A)": s["λ"], "lambda_i": s["λ"], "sigma_w^2": s["W"], "sigma_v^2": s["V"]}
    for name, symbol in (("x", "x"), ("y", "y"), ("z", "z"), ("e", "e"), ("u", "u"), ("w", "w"), ("v", "v")):
        names[name] = s[symbol]
    for accent in ("bar", "hat"):
        names |= {f"{accent} x": s["xbar"], f"{accent} y": s["ybar"]}
    names |= {"tilde x": s["xtilde"], "tilde z": s["ztilde"]}
    for letter in "yz":
        for shown, key in (("s", "s"), ("ω", "omega")):
            names[f"Phi_{letter}({key})"] = names[f"S_{letter}({key})"] = s[f"Phi_{letter}({shown})"]
            names[f"Phi_{letter}(jomega)"] = s[f"Phi_{letter}(ω)"]
    for index in "ijk":
        names |= {f"varphi_{index}": s["φ"], f"phi_{index}": s["φ"], f"eta_{index}": s["η"], f"z_{index}": s["ζ"]}
        names[f"bar z_{index}"] = Conjugate(s["ζ"])
    names |= {f"{k}(s)": s[k] for k in "fpq"} | {"sigma_0": s["σ0"], "omega_0": s["ω0"]}
    names["s_0"] = s["σ0"] + s["j"] * s["ω0"]
    for sub in ("z-bary", "z-haty"):
        names |= {f"Sigma_{sub}": s["Sigma"], f"sigma_{sub}^2": s["Sigma"]}
    return names


# ------------------------------------------------------------------------------------------------ declarations
def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    cross = d.has("N")
    _noise(d, cross)
    spectral = d.has(*(f"Phi_{k}({x})" for k in "yz" for x in ("s", "ω")))
    plant = d.has("A") and d.has("C") and not (spectral or d.has(*ON_THE_WAY))  # (A, C) is detectable
    if plant or d.has("P", "K", "Sigma") or d.scalar(*"AC"):
        _steady(d, cross)
    if d.has(*ON_THE_WAY):
        _transient(d, cross)
    if d.has(*SIGNALS):
        _dynamics(d)
        _moments(d, cross)
    if spectral:
        _spectrum(d, cross)


def _noise(d: Draft, cross: bool) -> None:
    W, V, N = d.of("W", "V", "N")
    d.assume("W >= 0", W, "⪰", text="an intensity is not negative")
    d.assume("V > 0", V, "≻", text="every output is noisy")
    d.inverse("V^-1", V, "l", "V > 0")
    if cross:
        d.assume("joint noise", block([[W, N], [N.T, V]]), "⪰", text="a joint intensity")


def rate(A: Term, C: Term, W: Term, V: Term, P: Term, N: Term | None = None) -> Term:
    """Return A P + P A' + W - (P C' + N) V^-1 (P C' + N)', the right-hand side of the Riccati equation."""
    if N is None:
        return A * P + P * A.T + W - P * C.T * V.inv * C * P
    return A * P + P * A.T + W - (P * C.T + N) * V.inv * (P * C.T + N).T


def _steady(d: Draft, cross: bool) -> None:
    A, C, W, V, N, P, K, Sigma = d.of("A", "C", "W", "V", "N", "P", "K", "Sigma")
    zero = Zero("m", "m")
    d.assume("P >= 0", P, "⪰", text="a covariance")
    if cross:
        tail = " with cross-covariance"
        by = "spectrum", "Riccati equation" + tail
        d.assume("Riccati equation" + tail, rate(A, C, W, V, P, N), "=", zero, by=by)
        by = "spectrum", "gain" + tail
        d.assume("gain" + tail, K, "=", (P * C.T + N) * V.inv, by=by, optimal=True)
    else:
        name = "algebraic Riccati equation"
        d.assume(name, rate(A, C, W, V, P), "=", zero, by=(LECTURE, name))
        d.assume("steady gain", K, "=", P * C.T * V.inv, by=(LECTURE, "steady gain"), optimal=True)
    d.stable("A - K C Hurwitz", "hurwitz", A - K * C)
    if d.has("Sigma"):
        d.assume("output error covariance", Sigma, "=", C * P * C.T, by=(LECTURE, "output error covariance"))


def _transient(d: Draft, cross: bool) -> None:
    A, C, W, V, N, P, K = d.of("A", "C", "W", "V", "N", "P(t)", "K(t)")
    for time in dict.fromkeys((*d.times(), "t0")):
        text = "what was uncertain at first is only moved by the closed loop, and noise adds to it"
        d.assume("P(0) > 0" if time == "t0" else f"P({time}) > 0", P.at(time), "≻", text=text)
    right = rate(A, C, W, V, P, N if cross else None)
    by = ("observer", "Riccati equation") if cross else (LECTURE, "P(t)")
    d.define("P(t)", Dot(P), right, by=by)
    by = ("observer", "gain") if cross else (LECTURE, "gain")
    for time in d.times():
        best = (P.at(time) * C.T + N if cross else P.at(time) * C.T) * V.inv
        d.assume(f"gain at {time}", K.at(time), "=", best, by=by, optimal=True)


def _dynamics(d: Draft) -> None:
    """Declare plant and filter, and the dynamics of the error."""
    A, C, K = d.of("A", "C", "K(t)")
    x, x_hat, error, y, y_hat, z, gap, e, u, w, v = d.of(*SIGNALS)
    d.define("plant", Dot(x), A * x + w)
    d.define("filter", Dot(x_hat), A * x_hat + u)
    for time in d.times():
        d.define(named_at("output", time), y.at(time), C * x.at(time) + v.at(time))
        d.define(named_at("true output", time), z.at(time), C * x.at(time))
        d.define(named_at("output estimate", time), y_hat.at(time), C * x_hat.at(time))
        d.define(named_at("innovation", time), e.at(time), y.at(time) - y_hat.at(time))
        d.define(named_at("error", time), error.at(time), x.at(time) - x_hat.at(time))
        d.define(named_at("output error", time), gap.at(time), z.at(time) - y_hat.at(time))
        d.define(named_at("correction", time), u.at(time), K.at(time) * e.at(time), by=(LECTURE, "correction"))
    d.assume("error dynamics", Dot(error), "=", (A - K * C) * error + w - K * v, by=(LECTURE, "error dynamics"))


def _moments(d: Draft, cross: bool) -> None:
    """Declare what white noises have for correlation, among them and with the error."""
    W, V, N, P = d.of("W", "V", "N", "P(t)")
    error, w, v = d.of("xtilde", "w", "v")
    for one, two in product(d.times(), repeat=2):
        delta, name = Delta(one, two), f"at {one}, {two}"
        if one != two:
            d.define(f"w and w {name}", Expect(w.at(one) * w.at(two).T), W * delta)
            d.define(f"v and v {name}", Expect(v.at(one) * v.at(two).T), V * delta)
        if cross and one != two:
            d.define(f"w and v {name}", Expect(w.at(one) * v.at(two).T), N * delta)
        elif not cross:
            d.assume(f"w and v {name}", Expect(w.at(one) * v.at(two).T), "=", Zero("m", "l"))
    for time in d.times():
        moment = Expect(error.at(time) * error.at(time).T)
        d.define(f"P({time}) definition", moment, P.at(time), by=(LECTURE, "attained"))


def _spectrum(d: Draft, cross: bool) -> None:
    """Declare the spectra of both outputs as functions of s and of jω."""
    A, C, W, V, N = d.of("A", "C", "W", "V", "N")
    size, s, j, w = Identity("m"), *d.of("s", "j", "ω")
    for name, point, shown in (("s", s * size, "s"), ("jω", j * w * size, "ω")):
        if not d.has(f"Phi_y({shown})", f"Phi_z({shown})"):
            continue
        plus, minus = point - A, -point - A
        for letter, matrix, fact in ((f"({name}I-A)^-1", plus, name), (f"(-{name}I-A)^-1", minus, f"-{name}")):
            d.theory.fact(f"{fact} regular", "invertible", matrix, "a generic point: no eigenvalue")
            d.inverse(letter, matrix, "m", f"{fact} regular", symmetric=False)
        through = C * plus.inv * W * minus.inv.T * C.T
        if cross:
            through = through + C * plus.inv * N + N.T * minus.inv.T * C.T
        y, z = d.of(f"Phi_y({shown})", f"Phi_z({shown})")
        d.define(y.name, y, through + V)
        if d.has(z.name):
            d.define(z.name, z, C * plus.inv * W * minus.inv.T * C.T)
