"""What claims about the Luenberger observer in discrete time may use: P, L steady, P_k, L_k from step to step.

Source: lecture notes "Optimal Luenberger Observer". The gain is the predictor's; L_f and P+ are the filter's. Without
a letter S in the claim the noises are uncorrelated; Q and R are constant, Q_k and R_k may vary from step to step.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from derive.context import Theory
from derive.errors import InputError
from derive.terms import Expect, Glyph, Symbol, Term, Zero, block
from derive.theory.claims.base import Draft, Outline, index_at
from derive.theory.luenberger_formulas import (
    any_gain,
    covariance,
    gain,
    innovation,
    optimal_gain,
    riccati_step,
    riccati_step_with_cross,
    signal,
)

KEY, LECTURE = "luenberger-dt", "luenberger"
STEADY = ("P", "L", "L_f", "P+")
SIGNALS = ("x", "xhat", "y", "u", "e", "w", "v", "xhat+", "e+")


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    t = Theory(KEY, "Observer in discrete time")
    t.matrix("A", "n", "n", meaning="state matrix")
    t.matrix("B", "n", "p", meaning="input matrix")
    t.matrix("C", "l", "n", meaning="output matrix")
    covariance(t, "Q", "n", Glyph("Q"), "covariance of the process noise")
    covariance(t, "R", "l", Glyph("R"), "covariance of the measurement noise")
    t.matrix("S", "n", "l", meaning="cross-covariance", unit="[state] [output]")
    covariance(t, "P", "n", Glyph("P"), "steady error covariance")
    covariance(t, "P+", "n", Glyph("P", sup="+"), "steady covariance of the filtered error")
    gain(t, "L", Glyph("L"), "steady optimal gain")
    gain(t, "L_f", Glyph("L", sub="f"), "steady gain of the filter")
    t.scalar("z", meaning="a complex number")
    _families(t)
    usual = {"A", "B", "C", "Q", "R", *STEADY, "P_{k-1}", "P_k", "L_k", *(f"{s}_k" for s in SIGNALS)}
    return Outline(KEY, t.title, t, _names(t), declare, frozenset(usual), frozenset("nl"))


def _families(t: Theory) -> None:
    """Declare the letters with an index."""
    covariance(t, "Q_#", "n", Glyph("Q", sub="#"), "covariance of the process noise")
    covariance(t, "R_#", "l", Glyph("R", sub="#"), "covariance of the measurement noise")
    t.matrix("S_#", "n", "l", Glyph("S", sub="#"), meaning="cross-covariance", unit="[state] [output]")
    covariance(t, "P_#", "n", Glyph("P", sub="#"), "error covariance", parameter=True)
    covariance(t, "P+_#", "n", Glyph("P", sub="#", sup="+"), "covariance of the filtered error")
    L = t.matrix("L_#", "n", "l", Glyph("L", sub="#"), parameter=False, meaning="gain", unit="[state]/[output]")
    t.matrix("δL_#", L.rows, L.cols, parameter=False)
    gain(t, "L^f_#", Glyph("L", sub="#", sup="f"), "gain of the filter")
    look = {
        "xhat": Glyph("x", accent="hat", sub="#"),
        "xhat+": Glyph("x", accent="hat", sub="#", sup="+"),
        "e+": Glyph("e", sub="#", sup="+"),
    }
    known = {"x": "state", "xhat": "estimate", "y": "output", "u": "input", "xhat+": "filtered estimate"}
    noise = {"e": "error", "e+": "filtered error", "w": "process noise", "v": "measurement noise"}
    for stem in SIGNALS:
        size = {"y": "l", "v": "l", "u": "p"}.get(stem, "n")
        glyph = look.get(stem, Glyph(stem, sub="#"))
        signal(t, f"{stem}_#", size, glyph, known.get(stem) or noise[stem], "any" if stem in known else "zero")


def _names(t: Theory) -> dict[str, Term]:
    s = t.symbols
    names: dict[str, Term] = {k: s[k] for k in ("A", "B", "C", "Q", "R", "S", "P", "L", "L_f", "z")}
    names |= {"P^+": s["P+"], "P^-": s["P"], "L^f": s["L_f"], "P_∞": s["P"], "L_∞": s["L"]}
    names |= {"Q_#": s["Q_#"], "R_#": s["R_#"], "S_#": s["S_#"]}
    names |= {"P_#": s["P_#"], "P_#^-": s["P_#"], "P_#^+": s["P+_#"], "L_#": s["L_#"]}
    names |= {"L_#^f": s["L^f_#"], "L_f,#": s["L^f_#"]}
    names |= {f"{k}_#": s[f"{k}_#"] for k in "xyuewv"}
    names |= {"hat x_#": s["xhat_#"], "hat x_#^-": s["xhat_#"], "hat x_#^+": s["xhat+_#"]}
    return names | {"e_#^+": s["e+_#"], "e_#^-": s["e_#"]}


# ------------------------------------------------------------------------------------------------ declarations
def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    used = d.indices()
    noise = Noise(d, used)
    noise.declare()
    if d.has(*STEADY):
        _steady(d, noise.cross)
    for letter, numbers in used.items():
        _transient(d, letter, numbers, noise)


@dataclass
class Noise:
    """Which noise covariances a claim writes with an index: those vary, the others are constant."""

    d: Draft
    used: Mapping[str, Mapping[int, set[str]]]

    def __post_init__(self) -> None:
        stems = set[str]().union(*(found for numbers in self.used.values() for found in numbers.values()))
        self.varies = stems & {"Q", "R", "S"}
        self.cross = self.d.has("S") or "S" in stems

    def declare(self) -> None:
        """Declare the constant covariances."""
        d = self.d
        Q, R, S = d.of("Q", "R", "S")
        d.assume("Q >= 0", Q, "⪰", text="a covariance")
        d.assume("R > 0", R, "≻", text="every output is noisy")
        d.inverse("R^-1", R, "l", "R > 0")
        if self.cross:
            d.assume("steady joint noise", block([[Q, S], [S.T, R]]), "⪰", text="a joint covariance")

    def at(self, index: str) -> list[Symbol]:
        """Return the covariances of process and measurement noise at an index, and their cross-covariance."""
        return [self.d.at(k, index) if k in self.varies else self.d.of(k)[0] for k in "QRS"]

    def declare_at(self, index: str) -> None:
        """Declare the covariances that vary; where a claim writes Q as well, they are all the same."""
        d = self.d
        Q, R, S = self.at(index)
        if "Q" in self.varies:
            d.assume(f"{Q.name} >= 0", Q, "⪰", text="a covariance")
        if "R" in self.varies:
            d.assume(f"{R.name} > 0", R, "≻", text="every output is noisy")
            d.inverse(f"{R.name}^-1", R, "l", f"{R.name} > 0")
        if self.cross and self.varies:
            d.assume(f"joint noise at {index}", block([[Q, S], [S.T, R]]), "⪰", text="a joint covariance")
        for name, symbol in zip("QRS", (Q, R, S), strict=True):
            if name in self.varies and (d.has(name) or (d.has(*STEADY) and name != "S")):
                d.assume(f"constant {symbol.name}", symbol, "=", d.of(name)[0], "the same at every time")


def _steady(d: Draft, cross: bool) -> None:
    A, C, Q, R, S, P, L = d.of("A", "C", "Q", "R", "S", "P", "L")
    sigma = innovation(C, P, R)
    d.assume("P >= 0", P, "⪰", text="a covariance")
    by = (LECTURE, "steady innovation covariance")
    d.assume("steady innovation covariance", sigma, "≻", by=by)
    d.inverse("Sigma^-1", sigma, "l", "steady innovation covariance")
    tail = " with cross-covariance" if cross else ""
    right = riccati_step_with_cross(A, C, P, Q, R, S) if cross else riccati_step(A, C, P, Q, R)
    d.assume(f"Riccati equation{tail}", P, "=", right, by=(LECTURE, f"Riccati equation{tail}"))
    best = optimal_gain(A, C, P, R, S if cross else None)
    d.assume(f"steady gain{tail}", L, "=", best, by=(LECTURE, f"steady gain{tail}"), optimal=True)
    d.stable("A - L C Schur", "schur", A - L * C)
    if d.has("L_f", "P+"):
        L_f, after = d.of("L_f", "P+")
        d.define("L_f", L_f, P * C.T * sigma.inv)
        d.define("P+", after, P - P * C.T * sigma.inv * C * P)
        d.assume("P+ >= 0", after, "⪰", by=(LECTURE, "Joseph form"))


def _transient(d: Draft, letter: str, numbers: dict[int, set[str]], noise: Noise) -> None:
    """Declare covariances at every index that is used, and the steps between them."""
    first, last = min(numbers), max(numbers)
    needs_step = "L" in numbers[first] or (first == last and d.has("Q", "S"))
    signals = any(stem in SIGNALS for stems in numbers.values() for stem in stems)
    if "L" in numbers[first] and (letter, first) == ("", 0):
        raise InputError("L_0: the first gain is L_1, which is made of P_0")
    if needs_step and ("L" in numbers[first] or (letter, first) not in (("k", -1), ("", 0))):
        first -= 1
    indices = [index_at(letter, number) for number in range(first, last + 1)]
    for i, index in enumerate(indices):
        noise.declare_at(index)
        _covariance(d, index, numbers.get(first + i, set()), noise, reached=i > 0)
    for before, after in pairwise(indices):
        _step(d, before, after, noise)
    if signals:
        _moments(d, indices, noise)
        for before, after in pairwise(indices):
            _dynamics(d, before, after)


def named(name: str, index: str) -> str:
    """Return the name of a declaration at an index, plain where the lecture has it."""
    return name if index in ("k", "k-1") else f"{name} at {index}"


def _covariance(d: Draft, index: str, stems: set[str], noise: Noise, *, reached: bool) -> None:
    """Declare P_k >= 0, the innovation covariance and its inverse, and the filter at an index."""
    C, R, P = d.of("C")[0], noise.at(index)[1], d.at("P", index)
    d.assume(f"{P.name} >= 0", P, "⪰", text="a covariance", by=(LECTURE, "P_k >= 0") if reached else None)
    sigma, key = innovation(C, P, R), f"innovation covariance of {P.name}"
    d.assume(key, sigma, "≻", by=(LECTURE, "innovation covariance"))
    d.inverse(f"Sigma_{index}^-1", sigma, "l", key)
    if stems & {"L^f", "P+", "xhat+", "e+"}:
        L_f, after = d.at("L^f", index), d.at("P+", index)
        d.define(f"filter gain at {index}", L_f, P * C.T * sigma.inv)
        right = P - P * C.T * sigma.inv * C * P
        d.assume(f"filtered covariance at {index}", after, "=", right, by=(LECTURE, "filtered covariance"))
        d.assume(f"{after.name} >= 0", after, "⪰", by=(LECTURE, "filtered covariance"))


def _step(d: Draft, before: str, after: str, noise: Noise) -> None:
    """Declare the covariance recursion for any gain, and the optimal gain."""
    (A, C), (Q, R, S), cross = d.of("A", "C"), noise.at(before), noise.cross
    P, P_k, L = d.at("P", before), d.at("P", after), d.at("L", after)
    tail = " with cross-covariance" if cross else ""
    step = any_gain(A, C, L, P, Q, R, S if cross else None)
    d.assume(named(f"covariance recursion{tail}", after), P_k, "=", step, by=(LECTURE, f"covariance recursion{tail}"))
    best = optimal_gain(A, C, P, R, S if cross else None)
    d.assume(named(f"gain{tail}", after), L, "=", best, by=(LECTURE, f"gain{tail}"), optimal=True)


# ------------------------------------------------------------------------------------------------ signals
def _moments(d: Draft, indices: list[str], noise: Noise) -> None:
    """Declare the covariances of noise and error, and that later noise is uncorrelated with what came before."""
    for i, index in enumerate(indices):
        Q, R, S = noise.at(index)
        e, w, v, P = (d.at(k, index) for k in ("e", "w", "v", "P"))
        zero = Zero("n", "l")
        d.define(f"Q at {index}", Expect(w * w.T), Q)
        d.define(f"R at {index}", Expect(v * v.T), R)
        d.assume(f"w and v at {index}", Expect(w * v.T), "=", S if noise.cross else zero)
        d.define(f"P at {index}", Expect(e * e.T), P)
        for later in indices[i:]:
            w_j, v_j = d.at("w", later), d.at("v", later)
            for one in (w_j, v_j):
                d.assume(f"{e.name} and {one.name}", Expect(e * one.T), "=", Zero("n", one.rows))
                if later != index:
                    d.assume(f"{w.name} and {one.name}", Expect(w * one.T), "=", Zero("n", one.rows))
                    d.assume(f"{v.name} and {one.name}", Expect(v * one.T), "=", Zero("l", one.rows))
        _instant(d, index)


def _instant(d: Draft, index: str) -> None:
    """Declare output and error, and the filtered estimate, at an index."""
    (C,) = d.of("C")
    x, xhat, y, e, v = (d.at(k, index) for k in ("x", "xhat", "y", "e", "v"))
    d.define(f"output at {index}", y, C * x + v)
    d.define(f"error at {index}", e, xhat - x)
    if d.has(d.at("xhat+", index).name, d.at("e+", index).name):
        filtered, error, L_f = d.at("xhat+", index), d.at("e+", index), d.at("L^f", index)
        d.define(f"filtered estimate at {index}", filtered, xhat - L_f * (C * xhat - y))
        d.define(f"filtered error at {index}", error, filtered - x)


def _dynamics(d: Draft, before: str, after: str) -> None:
    """Declare plant, observer and the error recursion, for any gain."""
    A, B, C = d.of("A", "B", "C")
    x, xhat, y, u, e, w, v = (d.at(k, before) for k in ("x", "xhat", "y", "u", "e", "w", "v"))
    L, e_k = d.at("L", after), d.at("e", after)
    d.define(named("plant", after), d.at("x", after), A * x + B * u + w)
    d.define(named("observer", after), d.at("xhat", after), A * xhat + B * u - L * (C * xhat - y))
    recursion = (A - L * C) * e + L * v - w
    d.assume(named("error recursion", after), e_k, "=", recursion, by=(LECTURE, "error recursion"))
