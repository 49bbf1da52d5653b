"""Prove or refute one equation or inequality of a claim."""

from __future__ import annotations

from dataclasses import replace

from derive.claim import Counterexample
from derive.decide.gradient import gradient_claim, gradient_of, images, inner
from derive.decide.order import prove_order
from derive.decide.parts import Part, oriented, rule_of
from derive.decide.signals import expanded, inside
from derive.decide.traces import prove_trace_order
from derive.decide.workspace import MOST, Workspace
from derive.derivation import Proof, claims, order_claim
from derive.kernel import Poly, Rejected
from derive.rules import Grid, expect
from derive.terms import Equation, Zero, lower, lower_trace

__all__ = ["polynomials", "prove_equation", "refute_equation"]


def prove_equation(equation: Equation, work: Workspace) -> Part | None:
    """Search for a proof of one equation or inequality."""
    rule, strict = rule_of(equation), equation.relation in ("≻", ">")
    if rule == "positivity":
        grid = order_claim(equation, work.reading)
        found = prove_order(grid, strict, work)
        return Part("comparison" if found.comparison else "positivity", found) if found else None
    if rule == "trace order":
        found = prove_trace_order(lower_trace(equation.lhs - equation.rhs, work.reading), strict, work)
        return Part(rule, order=found) if found else None
    if equation.relation != "=":
        return None
    if rule == "expectation":
        return _expectation(equation, work)
    if rule == "gradient":
        return _gradient(equation, work)
    certificates = []
    for claim in claims(equation, rule, work.reading):  # type: ignore[arg-type]
        found = work.prove(claim.claim, claim.trace)
        if found is None:
            return None
        certificates.append(found)
    return Part(rule, Proof(tuple(certificates)))


def _gradient(equation: Equation, work: Workspace) -> Part | None:
    """Prove what a gradient is, from what holds for every gain and then from everything."""
    for image in images(equation, work):
        try:
            claim = gradient_claim(equation, image, work.reading)
        except Rejected:
            continue
        under = work.prove(inner(equation, work.reading) - image, trace=True, every_gain=True)
        after = work.prove(claim, trace=True) if under else None
        if under and after:
            return Part("gradient", Proof((under, after)), image=image)
    return None


def _expectation(equation: Equation, work: Workspace) -> Part | None:
    """Prove an equation between expectations from the equations of the signals and their moments."""
    for image in expanded(equation, work):
        after = work.prove(expect(image, work.reading.context))
        under = work.prove(inside(equation, work.reading) - image) if after else None
        if after and under:
            return Part("expectation", Proof((under, after)), image=image)
    return None


def refute_equation(equation: Equation, work: Workspace, most: int = MOST) -> Counterexample | None:
    """Search for a counterexample to one equation or inequality; blocks of an equation are tried one by one.

    At most ``most`` instances are tried for an inequality.
    """
    rule = rule_of(equation)
    if rule == "expectation":
        return _refute_expectation(equation, work)
    if rule == "gradient":
        left = gradient_of(equation, work)
        right = None if isinstance(equation.rhs, Zero) else lower(equation.rhs, work.reading)[0][0]
        return work.refute(left, right) if left is not None else None
    if rule in ("trace", "trace order"):
        left, right = (lower_trace(side, work.reading) for side in (equation.lhs, equation.rhs))
        if left.rows != right.rows:
            right = Poly(right.terms, left.rows, left.cols)
        return work.refute(left, right, equation.relation, trace=True, most=most)
    left = lower(equation.lhs, work.reading)
    difference = order_claim(equation, work.reading)
    if len(left) > 1 and equation.relation in ("⪰", "≻"):
        return None
    for row, others in zip(left, difference, strict=True):
        for p, d in zip(row, others, strict=True):
            found = work.refute(p, p - d, equation.relation, most=most)
            if found:
                return found
    return None


def _refute_expectation(equation: Equation, work: Workspace) -> Counterexample | None:
    nothing = Zero("", "")
    terms = [equation.lhs, equation.rhs][: 1 if equation.rhs == nothing else 2]
    sides = [expanded(replace(equation, lhs=term, rhs=nothing), work) for term in terms]
    if not all(sides):
        return None
    left, *right = (expect(images[0], work.reading.context) for images in sides)
    return work.refute(left, right[0] if right else None, equation.relation)


def polynomials(equation: Equation, work: Workspace) -> list[Poly]:
    """Return the polynomials that an equation is about."""
    equation = oriented(equation, work.reading)
    rule = rule_of(equation)
    if rule in ("trace", "trace order"):
        return [lower_trace(side, work.reading) for side in (equation.lhs, equation.rhs)]
    if rule == "expectation":
        found = expanded(equation, work)
        if not found:
            expect(inside(equation, work.reading), work.reading.context)
        return [expect(p, work.reading.context) for p in found]
    if rule == "gradient":
        found = gradient_of(equation, work)
        if found is None:
            raise Rejected("no rule gives this gradient")
        return [found] if isinstance(equation.rhs, Zero) else [found, lower(equation.rhs, work.reading)[0][0]]
    grids: list[Grid] = [order_claim(equation, work.reading), lower(equation.lhs, work.reading)]
    return [p for grid in grids for row in grid for p in row]
