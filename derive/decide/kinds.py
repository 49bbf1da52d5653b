"""Which decision a statement calls for."""

from __future__ import annotations

from fractions import Fraction

from derive.analysis import is_scalar
from derive.context import Declared
from derive.decide.parts import is_trace
from derive.functions import Definite, Limit
from derive.interpret.statement import Statement
from derive.spectral import Det, ImaginaryPart, RealPart, Total
from derive.terms import (
    Block,
    Delta,
    Dot,
    Equation,
    Expect,
    Gradient,
    Identity,
    Image,
    Integral,
    Inverse,
    Neg,
    Number,
    Product,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
    walk,
)

__all__ = ["has_no_real_instance", "holds_along", "is_analytic", "is_matrix_claim"]

MATRIX: tuple[type[Term], ...] = (
    Symbol, Number, Identity, Zero, Sum, Neg, Product, Transpose, Inverse, Dot, Expect, Integral, Delta, Trace,
    Gradient, Block, Image,
)  # fmt: skip
ANALYTIC = (Definite, Limit, Total, Det, RealPart, ImaginaryPart)
EXTREMES = ("λmin(", "λmax(")


def is_analytic(statement: Statement) -> bool:
    """Tell whether a statement has integrals over frequency, limits, determinants or eigenvalues."""
    nodes = (n for e in statement.equations for side in (e.lhs, e.rhs) for n in walk(side))
    return any(isinstance(n, ANALYTIC) or (isinstance(n, Symbol) and n.name[:5] in EXTREMES) for n in nodes)


def holds_along(statement: Statement) -> bool:
    """Tell whether a claim has a rate, and an assumed equation ties what has a rate: P(t) = P says it at every time.

    Values at one instant may satisfy it by chance there, so that they refute nothing.
    """
    theory = statement.theory.theory
    items = [d.statement for d in theory.declared.values() if isinstance(d, Declared)]
    rates = {e.lhs.body for e in items if isinstance(e.lhs, Dot)}
    given = [theory.declared[name] for name in statement.assumed if name in theory.declared]
    tied = [*statement.theory.conditions, *(d.statement for d in given if isinstance(d, Declared))]
    claimed = (n for e in statement.equations for side in (e.lhs, e.rhs) for n in walk(side))
    return any(isinstance(n, Dot) for n in claimed) and any(
        isinstance(n, Symbol) and n in rates and n.name not in theory.random | theory.uncentred
        for e in tied
        if e.relation in ("=", ":=") and not isinstance(e.lhs, Dot)
        for side in (e.lhs, e.rhs)
        for n in walk(side)
    )


def has_no_real_instance(statement: Statement) -> bool:
    """Tell whether a matrix claim means numbers that a real instance leaves free: j, or an eigenvalue of A.

    An equation in jω alone is one between functions of s, which differ at a generic s where they differ at a real one.
    """
    families = statement.theory.theory.families
    nodes = [n for e in statement.equations for side in (e.lhs, e.rhs) for n in walk(side)]
    if any(isinstance(n, Symbol) and n.name in families for n in nodes):
        return True
    ordered = any(e.relation not in ("=", ":=") for e in statement.equations)
    return any(_is_complex(n) for n in nodes) and (ordered or not _in_s_alone(nodes))


def _is_complex(node: Term) -> bool:
    return isinstance(node, Symbol) and (node.name == "j" or node.name.endswith("(ω)"))


def _in_s_alone(nodes: list[Term]) -> bool:
    """Tell whether j and ω stand in products jω only."""
    counted = {k: sum(n.name == k for n in nodes if isinstance(n, Symbol)) for k in ("j", "ω")}
    within = [
        [sum(isinstance(f, Symbol) and f.name == k for f in n.factors) for k in ("j", "ω")]
        for n in nodes
        if isinstance(n, Product)
    ]
    return all(a == b for a, b in within) and [sum(x) for x in zip(*within, strict=True)] in ([*counted.values()], [])


def is_matrix_claim(statement: Statement) -> bool:
    """Tell whether a statement is about matrices and linear combinations of traces only."""
    return all(map(_is_matrix_equation, statement.equations))


def _is_matrix_equation(equation: Equation) -> bool:
    sides = equation.lhs, equation.rhs
    if not all(isinstance(node, MATRIX) for side in sides for node in walk(side)):
        return False
    if any(map(is_trace, sides)):
        return all(is_trace(side) or side in (Zero("", ""), Number(Fraction(0))) for side in sides)
    return not is_scalar(equation)
