"""What claims about the regulator in discrete time may use: S, K steady, S_k, K_k backwards from the horizon.

The input is u = -K x, or u_k = -K_k x_k where a claim writes gains with an index; S is the cost to go. S_{k-1} follows
from S_k, and K_{k-1} steers from x_{k-1} to x_k.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

from derive.context import Theory
from derive.terms import Glyph, Term
from derive.theory.claims.base import Draft, Outline, index_at
from derive.theory.regulator import cost_to_go, regulator_gain, weight

KEY, LECTURE = "lqr-dt", "duality"


@cache
def outline() -> Outline:
    """Return the letters and names of the theory."""
    t = Theory(KEY, "Regulator in discrete time")
    matrices(t)
    t.matrix("S_#", "n", "n", Glyph("S", sub="#"), symmetric=True, meaning="cost to go")
    K = t.matrix("K_#", "p", "n", Glyph("K", sub="#"), parameter=False, meaning="optimal gain")
    t.matrix("δK_#", K.rows, K.cols, parameter=False)
    t.matrix("x_#", "n", "1", Glyph("x", sub="#"), meaning="state")
    t.matrix("u_#", "p", "1", Glyph("u", sub="#"), meaning="input")
    s = t.symbols
    names: dict[str, Term] = {k: s[k] for k in (*"ABQRSK", "S_#", "K_#", "x_#", "u_#")}
    names |= {"S_∞": s["S"], "K_∞": s["K"]}
    usual = frozenset({*"ABQRSK", "S_{k-1}", "S_k", "K_{k-1}", "x_{k-1}", "x_k", "u_{k-1}"})
    return Outline(KEY, t.title, t, names, declare, usual, frozenset("np"))


def matrices(t: Theory) -> None:
    """Declare the letters of plant, cost, and steady regulator."""
    t.matrix("A", "n", "n", meaning="state matrix")
    t.matrix("B", "n", "p", meaning="input matrix")
    t.matrix("Q", "n", "n", symmetric=True, meaning="cost of the state")
    t.matrix("R", "p", "p", symmetric=True, meaning="cost of the input")
    t.matrix("S", "n", "n", symmetric=True, meaning="steady cost to go")
    t.matrix("K", "p", "n", meaning="steady optimal gain")


def costs(d: Draft) -> None:
    """Declare the costs of state and input."""
    Q, R = d.of("Q", "R")
    d.assume("Q >= 0", Q, "⪰", text="a cost")
    d.assume("R > 0", R, "≻", text="every input costs")
    d.inverse("R^-1", R, "p", "R > 0")


def declare(d: Draft) -> None:
    """Declare what bears on the letters that a claim uses."""
    costs(d)
    plant = d.has("A") and d.has("B") and not d.indices()  # (A, B) is stabilisable
    if plant or d.has("S", "K") or d.scalar(*"AB"):
        _steady(d)
    for letter, numbers in d.indices().items():
        _horizon(d, letter, numbers)


def _steady(d: Draft) -> None:
    A, B, Q, R, S, K = d.of(*"ABQRSK")
    d.assume("S >= 0", S, "⪰", text="a cost")
    name = "steady input weight"
    d.assume(name, weight(B, S, R), "≻", by=(LECTURE, name))
    d.inverse("weight^-1", weight(B, S, R), "p", name)
    d.assume("steady cost to go", S, "=", cost_to_go(A, B, S, Q, R))
    d.define("steady gain", K, regulator_gain(A, B, S, R), optimal=True)
    d.stable("A - B K Schur", "schur", A - B * K)


def _horizon(d: Draft, letter: str, numbers: dict[int, set[str]]) -> None:
    """Declare cost to go, gain and plant from step to step; a lone gain or cost has the step after it."""
    first, last = min(numbers), max(numbers)
    if numbers[last] & {"K", "u"} or (first == last and d.has("Q")):
        last += 1
    indices = [index_at(letter, number) for number in range(first, last + 1)]
    A, B, Q, R = d.of(*"ABQR")
    for index in indices:
        S = d.at("S", index)
        d.assume(f"{S.name} >= 0", S, "⪰", text="a cost")
        name = f"input weight of {S.name}"
        d.assume(name, weight(B, S, R), "≻", by=(LECTURE, "input weight"))
        d.inverse(f"weight_{index}^-1", weight(B, S, R), "p", name)
    plant = any(stems & {"x", "u"} for stems in numbers.values())
    varies = any("K" in stems for stems in numbers.values())
    for now in indices if plant and (varies or d.has("K")) else ():
        if varies and now == indices[-1]:
            continue  # its gain depends on the cost after the last index
        u, x = d.at("u", now), d.at("x", now)
        d.assume(f"{u.name} = -K x", u, "=", -((d.at("K", now) if varies else d.of("K")[0]) * x), optimal=True)
    for now, later in pairwise(indices):
        S, earlier, K = d.at("S", later), d.at("S", now), d.at("K", now)
        d.define(f"cost to go at {now}", earlier, cost_to_go(A, B, S, Q, R))
        d.define(f"optimal gain at {now}", K, regulator_gain(A, B, S, R), optimal=True)
        if plant:
            d.define(f"plant at {later}", d.at("x", later), A * d.at("x", now) + B * d.at("u", now))
