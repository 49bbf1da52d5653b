"""The closed forms of plants of order two: spectral factor, double integrator and oscillator, entry by entry."""

from __future__ import annotations

from fractions import Fraction

from derive.errors import InputError
from derive.functions import Abs, Power, Quotient, Root
from derive.scalar.formula import Formula
from derive.scalar.letters import compare, scalar_lecture, symbols
from derive.scalar.program import Branch, Let, Program
from derive.terms import Equation, Number, Term

__all__ = ["FORMULAS", "formula"]

HALF = Number(Fraction(1, 2))
ENTRIES = ("P11", "P12", "P22")
FORMULAS = (
    "spectral_factor_linear", "spectral_factor_constant",
    *(f"{plant}_{P.lower()}" for plant in ("double_integrator", "oscillator") for P in ENTRIES),
)  # fmt: skip


def _factor(name: str) -> Formula:
    """Return a coefficient of the factor s^2 + a1 s + a0 of ω^4 + c2 ω^2 + c0."""
    c0, c2, a0, a1 = symbols("c0 c2 a0 a1")
    inner, symbol = c2 + 2 * Root(c0), a1 if name.endswith("linear") else a0
    body, step = (Root(inner) if symbol == a1 else Root(c0)), f"{symbol.name} in roots"
    program = Program(name, (c0, c2), (), (Branch((compare(c0, ">"), compare(inner, ">")), body, step),))
    roles = "spectral factor of order two", f"{symbol.name} > 0", "factor is Hurwitz", f"only {symbol.name}"
    return Formula(name, Equation(symbol, "=", body), "c0 > 0, c2 + 2 √c0 > 0", step, roles, program, scalar_lecture)


def _double_integrator(entry: str) -> Formula:
    """Return an entry of the covariance of x1' = x2 + w1, x2' = w2, y = x1 + v."""
    w1, w2, V, P = symbols(f"w1 w2 V {entry}")
    both = w1 + 2 * Root(V * w2)
    body = Root({"P11": V * both, "P12": V * w2, "P22": w2 * both}[entry])
    step = f"double integrator, {entry}"
    defined = (compare(w1, "≥"), compare(w2, "≥"), compare(V, ">"))
    program = Program(f"double_integrator_{entry.lower()}", (w1, w2, V), (), (Branch(defined, body, step),))
    return _covariance(program, P, body, "V > 0, W1 >= 0, W2 >= 0", step, "double integrator, det P")


def _oscillator(entry: str) -> Formula:
    """Return an entry of the covariance of x1' = x2, x2' = -ω0^2 x1 - 2 ζ ω0 x2 + w2, y = x1 + v."""
    o, zeta, w2, V, e0, e1, excess, P = symbols(f"ω0 ζ w2 V e0 e1 excess {entry}")
    damping, size = 2 * zeta * o, Abs(zeta * o)

    def value(gain: Term, rate: Term) -> Term:
        squares = {"P11": V * gain, "P12": HALF * V * Power(gain, 2)}
        return squares.get(entry, V * gain * (Power(o, 2) + HALF * gain * rate))

    lets = (
        Let(e0, Root(Power(o, 4) + Quotient(w2, V))),
        Let(excess, Quotient(w2, V * (e0 + Power(o, 2)))),
        Let(e1, Root(4 * Power(zeta, 2) * Power(o, 2) + 2 * excess)),
    )
    step, noise = f"oscillator, {entry}", (compare(w2, ">"), compare(V, ">"))
    branches = (
        Branch((*noise, compare(damping, "≥")), value(Quotient(2 * excess, e1 + damping), e1), step),
        Branch(noise, value(e1 - damping, e1), step),
        Branch((compare(w2, "="), compare(V, ">")), value(2 * (size - zeta * o), 2 * size), f"unexcited, {entry}"),
    )
    program = Program(f"oscillator_{entry.lower()}", (o, zeta, w2, V), lets, branches)
    shown = scalar_lecture().step(step).statement.rhs
    return _covariance(program, P, shown, "V > 0, W2 >= 0", step, "oscillator, det P")


def _covariance(program: Program, P: Term, body: Term, defined: str, step: str, determinant: str) -> Formula:
    entries = (f"Riccati equation {k} of order two" for k in ("11", "12", "22"))
    roles = (*entries, "closed loop of order two", "closed loop is Hurwitz", "P11 > 0", "det P > 0", determinant)
    return Formula(program.name, Equation(P, "=", body), defined, step, roles, program, scalar_lecture)


def formula(name: str) -> Formula:
    """Return a closed form of order two by its name.

    Raises:
        InputError: no such formula.
    """
    if name not in FORMULAS:
        raise InputError(f"formula {name!r}: unknown; known are {', '.join(FORMULAS)}")
    plant, _, entry = name.rpartition("_")
    makers = {"spectral_factor": lambda _: _factor(name), "double_integrator": _double_integrator}
    return makers.get(plant, _oscillator)(entry.upper())
