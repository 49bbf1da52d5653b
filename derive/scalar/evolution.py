"""A closed form P(t) = f(t) of a covariance that obeys a differential equation.

The solution of P' = g(P) with a given start is unique, g being a polynomial in P. So P(t) = f(t) for all t >= 0 says
that f(0) = P(0) and f' = g(f), and that f is defined for t >= 0: a statement about numbers. Standard library only.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from derive.context import Declared
from derive.functions import put
from derive.interpret.statement import Statement
from derive.latex import plain
from derive.real import TIME
from derive.terms import Dot, Equation, Number, Symbol, Term, Zero, walk

__all__ = ["evolution"]

START = "t0"  # the initial time, from which t is counted


def evolution(statement: Statement) -> Statement | None:
    """Return what a closed form of a solution says about numbers; None if the statement is no closed form."""
    if len(statement.equations) != 1:
        return None
    match statement.equations[0]:
        case Equation(Symbol(args=("t",)) as solution, "=", form):
            pass
        case _:
            return None
    right = _rate(solution, statement)
    letters = [n for n in walk(form) if isinstance(n, Symbol)]
    if right is None or any(n.args not in ((), (START,)) for n in letters):
        return None
    clock, start = Symbol(TIME, scalar=True), solution.at(START)
    equations = (
        Equation(put(form, {clock: Number(Fraction(0))}), "=", start),
        Equation(Dot(form), "=", put(right, {solution: form})),
    )
    conditions = tuple(Equation(x, "≥", Zero("", "")) for x in (clock, start))
    theory = replace(statement.theory, conditions=(*statement.theory.conditions, *conditions))
    return replace(statement, equations=equations, theory=theory, assumed=(*statement.assumed, *map(plain, conditions)))


def _rate(solution: Symbol, statement: Statement) -> Term | None:
    """Return the right-hand side of the differential equation that the theory declares."""
    for item in statement.theory.theory.declared.values():
        match item:
            case Declared(statement=Equation(Dot(letter), "=" | ":=", right)) if letter == solution:
                return right
            case _:
                continue
    return None
