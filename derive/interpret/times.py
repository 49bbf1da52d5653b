"""Times and indices that letters are taken at: x(t), Phi(t,τ), w(t+τ), P(0), P(k)."""

from __future__ import annotations

from derive.interpret.names import LETTERS, tidy
from derive.latex import syntax as s

TIMES = {"t": "t", "tau": "τ", "sigma": "σ", "t_0": "t0", "tau_1": "τ1", "tau_2": "τ2", "t_1": "t1", "t_2": "t2"}


def time_of(node: s.Node) -> str | None:
    """Return the time that a node stands for; 0 is the initial time t0."""
    match node:
        case s.Fenced(body):
            return time_of(body)
        case s.Digits(value) if value == 0:
            return "t0"
        case s.Name(letter, (), sub, ""):
            spelled = LETTERS.get(letter, letter) + (f"_{tidy(sub)}" if sub else "")
            return TIMES.get(spelled)
        case s.Plus(((("+"), one), (sign, two))):
            first, second = time_of(one), time_of(two)
            if first is None or second is None:
                return None
            if sign == "+" and second == "t" and first != "t":
                first, second = second, first
            return f"{first}{sign}{second}"
        case _:
            return None


def literal(node: s.Node) -> str:
    """Return an argument as it is part of a name: omega, s, A, ∞, jomega; '' if it is none."""
    match node:
        case s.Fenced(body):
            return literal(body)
        case s.Name(letter, (), sub, ""):
            return LETTERS.get(letter, letter) + (f"_{tidy(sub)}" if sub else "")
        case s.Infinite():
            return "∞"
        case s.Digits(value):
            return str(value)
        case s.Times((one, two)):
            return literal(one) + literal(two)
        case _:
            return ""


def index_of(node: s.Node) -> str:
    """Return an argument as an index: k, k-1, 0; '' if it is none."""
    match node:
        case s.Name() | s.Digits():
            return literal(node)
        case s.Plus((("+", one), (sign, two))):
            return literal(one) + sign + literal(two)
        case s.Given(body, condition):
            return f"{index_of(body)}|{index_of(condition)}"
        case _:
            return ""


def difference(times: list[str], lag: str) -> tuple[str, str] | None:
    """Return two of the times in a formula that are a lag apart: (t+τ, t) for τ."""
    for one in times:
        for two in times:
            if one in (f"{two}+{lag}", f"{lag}+{two}") or two == f"{one}-{lag}":
                return one, two
    return None
