"""How one equation or inequality of a claim is proved, and the replay of that proof. Part of the trust base."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from derive.decide.gradient import check_gradient
from derive.decide.signals import check_expectation, has_expectation
from derive.decide.traces import TraceOrder, check_trace_order
from derive.derivation import Proof, Step, check
from derive.kernel import Poly, Rejected
from derive.terms import (
    Equation,
    Gradient,
    Inverse,
    Neg,
    Number,
    Product,
    Reading,
    Sum,
    Term,
    Trace,
    Zero,
    lower_trace,
    walk,
)
from derive.theory.claims.base import ClaimTheory
from derive.wellformed import expansion

__all__ = ["Part", "Rule", "bound", "is_trace", "oriented", "replay_part", "rule_of"]

Rule = Literal["identity", "trace", "gradient", "positivity", "comparison", "trace order", "expectation"]


@dataclass(frozen=True)
class Part:
    """The proof of one equation or inequality."""

    rule: Rule
    proof: Proof = field(default_factory=Proof)
    order: TraceOrder | None = None
    image: Poly | None = None  # what an expectation is that of, in signals with declared moments


def replay_part(part: Part, equation: Equation, reading: Reading, theory: ClaimTheory) -> None:
    """Accept an equation or inequality by its proof, or raise Rejected."""
    equation = oriented(equation, reading)
    if part.rule == "trace order":
        if part.order is None or part.proof != Proof() or equation.relation not in ("≥", ">"):
            raise Rejected("an inequality between traces has a proof of its own")
        claim = lower_trace(equation.lhs - equation.rhs, reading)
        check_trace_order(part.order, claim, equation.relation == ">", reading.context)
        return
    if part.rule == "expectation":
        if part.image is None or part.order is not None or part.proof != Proof(part.proof.identities):
            raise Rejected("an equation between expectations has a proof of its own")
        check_expectation(equation, part.image, part.proof.identities, reading)
        return
    if part.rule == "gradient":
        if part.image is None or part.order is not None or part.proof != Proof(part.proof.identities):
            raise Rejected("an equation with a gradient has a proof of its own")
        check_gradient(equation, part.image, part.proof.identities, reading, theory)
        return
    if part.order or part.image or part.rule not in ("identity", "trace", "positivity", "comparison"):
        raise Rejected("the proof is of another kind than the rule")
    check(Step("claim", equation, part.rule, (), part.proof), reading, {})


def oriented(equation: Equation, reading: Reading) -> Equation:
    """Write an equation so that a zero stands on the right, with a type where it is needed.

    0 = X is X = 0;  0 ⪰ X is -X ⪰ 0;  := is =
    """
    lhs, relation, rhs = equation.lhs, equation.relation, equation.rhs
    relation = "=" if relation == ":=" else relation
    if _is_zero(lhs) and not _is_zero(rhs):
        lhs, rhs = (rhs if relation in ("=", "≠") else Neg(rhs)), Zero("", "")
    if isinstance(rhs, Gradient) and not isinstance(lhs, Gradient) and relation == "=":
        lhs, rhs = rhs, lhs
    if _is_zero(rhs):
        rhs = _zero_trace(lhs, reading) if is_trace(lhs) else Zero("", "")
    return replace(equation, lhs=lhs, relation=relation, rhs=rhs)


def _is_zero(term: Term) -> bool:
    return isinstance(term, Zero) or (isinstance(term, Number) and term.value == 0)


def _zero_trace(term: Term, reading: Reading) -> Term:
    size = lower_trace(term, reading).rows
    return Trace(Zero(size, size))


def is_trace(term: Term) -> bool:
    """Tell whether a term is a linear combination of traces."""
    match term:
        case Trace():
            return True
        case Neg(body):
            return is_trace(body)
        case Product((Number(), body)):
            return is_trace(body)
        case Sum(addends):
            return all(map(is_trace, addends))
        case _:
            return False


def rule_of(equation: Equation) -> Rule:
    """Return the rule that fits an oriented equation or inequality."""
    if equation.relation in ("⪰", "≻"):
        return "positivity"
    if equation.relation in ("≥", ">"):
        return "trace order"
    if isinstance(equation.lhs, Gradient):
        return "gradient"
    if has_expectation(equation) and not is_trace(equation.lhs):
        return "expectation"
    return "trace" if is_trace(equation.lhs) else "identity"


def bound(equation: Equation, theory: ClaimTheory) -> None:
    """Bound the number of products that an equation expands to, inside its inverses too.

    Raises:
        InputError: more than one statement may have.
    """
    for side in (equation.lhs, equation.rhs):
        for term in (side, *(n.body for n in walk(side) if isinstance(n, Inverse))):
            expansion(term, theory.theory)
