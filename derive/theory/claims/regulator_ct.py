"""What claims about the regulator in continuous time may use: S, K steady, S(t), K(t) backwards from the horizon.

The input is u = -K x; S is the cost to go.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from derive.context import Theory
from derive.terms import Dot, Glyph, Term, Zero
from derive.theory.claims.base import Draft, Outline, named_at
from derive.theory.claims.regulator_dt import costs, matrices
from derive.theory.regulator import cost_rate

KEY = "lqr-ct"
ON_THE_WAY = ("S(t)", "K(t)")


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    t = Theory(KEY, "Regulator in continuous time")
    matrices(t)
    for name, rows, symmetric in (("S(t)", "n", True), ("K(t)", "p", False)):
        made = t.varying(name, rows, "n", Glyph(name[0]), symmetric=symmetric)
        t.symbols[name] = replace(made, show_args=None)
    t.matrix("δK(t)", "p", "n", parameter=False)
    t.varying("x", "n", "1", meaning="state")
    t.varying("u", "p", "1", meaning="input")
    s = t.symbols
    names: dict[str, Term] = {k: s[k] for k in (*"ABQRSK", "x", "u")}
    names |= {"S_∞": s["S"], "K_∞": s["K"], "S()": s["S(t)"], "K()": s["K(t)"]}
    return Outline(KEY, t.title, t, names, declare, frozenset({*"ABQRSK", *ON_THE_WAY, "x", "u"}), frozenset("np"))


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    costs(d)
    A, B, Q, R = d.of(*"ABQR")
    plant = d.has("A") and d.has("B") and not d.has(*ON_THE_WAY, "x", "u")  # (A, B) is stabilisable
    if plant or d.has("S", "K") or d.scalar(*"AB"):
        S, K = d.of("S", "K")
        d.assume("S >= 0", S, "⪰", text="a cost")
        d.define("steady cost", cost_rate(A, B, S, Q, R), Zero("n", "n"))
        d.define("steady gain", K, R.inv * B.T * S, optimal=True)
        d.stable("A - B K Hurwitz", "hurwitz", A - B * K)
    if d.has(*ON_THE_WAY):
        S, K = d.of(*ON_THE_WAY)
        d.define("cost to go", Dot(S), -cost_rate(A, B, S, Q, R))
        for time in d.times():
            d.assume(f"S({time}) >= 0", S.at(time), "⪰", text="a cost")
            d.define(f"gain at {time}", K.at(time), R.inv * B.T * S.at(time), optimal=True)
    if d.has("x", "u"):
        x, u = d.of("x", "u")
        d.define("plant", Dot(x), A * x + B * u)
        if d.has("K", "K(t)"):
            varies = d.has("K(t)")
            (gain,) = d.of("K(t)" if varies else "K")
            for time in d.times():
                right = -((gain.at(time) if varies else gain) * x.at(time))
                d.assume(named_at("u = -K x", time), u.at(time), "=", right, text="the optimal input", optimal=True)
