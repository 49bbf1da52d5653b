"""Transients: the covariance after a time, and after a number of steps, from any start."""

from __future__ import annotations

from fractions import Fraction

from derive.functions import Exp, Log, Power, Quotient, Root
from derive.scalar.formula import Formula, Sequence
from derive.scalar.letters import NOTHING, compare, scalar_lecture, symbols
from derive.scalar.program import Branch, Let, Program
from derive.terms import Equation, Number, Term

__all__ = ["FORMULAS"]

ONE, HALF = Number(Fraction(1)), Number(Fraction(1, 2))


def riccati_transient() -> Formula:
    """P(t) for dP/dt = 2 A P + W - C^2 P^2/V."""
    A, C, W, V, g, S, start, time, P = symbols("A C W V g S P0 t P0(t)")
    decay = Exp(-2 * S * time)
    rest = ONE - decay

    def explicit(plus: Term, minus: Term) -> Term:
        return Quotient(2 * S * start * decay + (start * plus + W) * rest, 2 * S * decay + (minus + g * start) * rest)

    program = Program(
        "riccati_transient", (A, C, W, V, start, time),
        (Let(g, Quotient(Power(C, 2), V)), Let(S, Root(Power(A, 2) + g * W))),
        (
            Branch((compare(start, "="), compare(W, "=")), NOTHING, "zero stays zero"),
            Branch((compare(S, ">"), compare(A, ">")), explicit(S + A, Quotient(g * W, S + A)), "explicit, unstable"),
            Branch((compare(S, ">"),), explicit(S + A, S - A), "explicit solution"),
            Branch((), Quotient(start + W * time, ONE + g * start * time), "solution of an integrator"),
        ),
    )  # fmt: skip
    meaning = "start", "Riccati differential equation", "P(t) >= 0"
    roles = (*meaning, "distance to the steady state", "bound of the error")
    return Formula(
        "riccati_transient", Equation(P, "=", explicit(S + A, S - A)), "V > 0, W >= 0, P(0) >= 0, t >= 0",
        "explicit solution", roles, program, scalar_lecture,
    )  # fmt: skip


def riccati_recursion() -> Formula:
    """P_k for P_{k+1} = A^2 P_k R/(C^2 P_k + R) + Q, an explicit power."""
    A, C, Q, R, b, T, lam, rho, start, k, P, power = symbols("A C Q R b T λ ρ P0 k P_k ρ^k")
    product = 2 * Power(C, 2) * Q * R
    rises = Quotient(product, T + b), HALF * (T + b)
    falls = HALF * (T - b), Quotient(product, T - b)

    def explicit(halves: tuple[Term, Term], power: Term) -> Term:
        small, large = halves
        rest = ONE - power
        top = start * (T * power + large * rest) + Q * R * rest
        return Quotient(top, T * power + (Power(C, 2) * start + small) * rest)

    near, far = (Exp(k * Log(base)) for base in (ONE - Quotient(T, lam), rho))
    slow, moving, large = compare(rho, ">", HALF), compare(T, ">"), compare(b, ">")
    program = Program(
        "riccati_recursion", (A, C, Q, R, start, k),
        (
            Let(b, (A - ONE) * (A + ONE) * R + Power(C, 2) * Q), Let(T, Root(Power(b, 2) + 4 * Power(C, 2) * Q * R)),
            Let(lam, HALF * (Power(A, 2) * R + Power(C, 2) * Q + R + T)),
            Let(rho, Quotient(Power(A, 2) * Power(R, 2), Power(lam, 2))),
        ),
        (
            Branch((compare(k, "="),), start, "start of the closed form"),
            Branch((compare(start, "="), compare(Q, "=")), NOTHING, "zero stays zero in discrete time"),
            Branch((moving, large, slow), explicit(rises, near), "explicit recursion, b > 0"),
            Branch((moving, large), explicit(rises, far), "explicit recursion, b > 0"),
            Branch((moving, slow), explicit(falls, near), "explicit recursion, T > b"),
            Branch((moving,), explicit(falls, far), "explicit recursion, T > b"),
            Branch((), Quotient((start + Q * k) * R, R + Power(C, 2) * start * k), "recursion on the circle"),
        ),
    )  # fmt: skip
    sequences = (
        Sequence(near, power, "ρ^k at the start", "power'"),
        Sequence(far, power, "ρ^k at the start", "power'"),
    )
    meaning = "closed form", "recursion as a quotient", "P_k >= 0"
    roles = (*meaning, "distance in discrete time", "bound of the error in discrete time")
    return Formula(
        "riccati_recursion", Equation(P, "=", explicit((HALF * (T - b), HALF * (T + b)), power)),
        "R > 0, Q >= 0, P0 >= 0, k = 0, 1, 2, ...", "explicit recursion", roles, program, scalar_lecture,
        sequences=sequences,
    )  # fmt: skip


FORMULAS = riccati_transient, riccati_recursion
