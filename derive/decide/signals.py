"""Expectations: the signals are first put in the form of which the moments are declared.

E[p] = E[q] for p = q by the equations between signals, and E[q] follows from the moments.
"""

from __future__ import annotations

from derive.decide.workspace import Workspace
from derive.kernel import Certificate, Poly, Rejected, parts, replay
from derive.matrix.normal import reduced
from derive.rules import expect
from derive.terms import Equation, Expect, Neg, Number, Product, Reading, Sum, Term, Zero, lower, walk

__all__ = ["check_expectation", "expanded", "has_expectation", "inside"]


def has_expectation(equation: Equation) -> bool:
    """Tell whether an expectation occurs."""
    return any(isinstance(n, Expect) for side in (equation.lhs, equation.rhs) for n in walk(side))


def inside(equation: Equation, reading: Reading) -> Poly:
    """Return the polynomial p for which the equation says E[p] = 0.

    Raises:
        Rejected: the sides are no linear combinations of expectations.
    """
    left = _inside(equation.lhs, reading)
    return left if _is_zero(equation.rhs) else left - _inside(equation.rhs, reading)


def _is_zero(term: Term) -> bool:
    return isinstance(term, Zero)


def _inside(term: Term, reading: Reading) -> Poly:
    """Return what a linear combination of expectations is the expectation of; what is not random stands for itself."""
    match term:
        case Zero("", ""):
            return Poly({}, "", "")
        case Expect(body):
            return _one(body, reading)
        case Neg(body):
            return -_inside(body, reading)
        case Sum(addends):
            total = _inside(addends[0], reading)
            for addend in addends[1:]:
                total = total + _inside(addend, reading)
            return total
        case Product((Number(value), body)):
            return _inside(body, reading).scale(value)
        case Product(factors) if any(isinstance(n, Expect) for n in walk(term)):
            total: Poly | None = None
            for factor in factors:
                poly = _inside(factor, reading)
                total = poly if total is None else total * poly
            if total is None or sum(any(isinstance(n, Expect) for n in walk(f)) for f in factors) != 1:
                raise Rejected("a product of expectations is not the expectation of a product")
            return total
        case _:
            if any(isinstance(n, Expect) for n in walk(term)):
                raise Rejected("an expectation stands where there is no rule for it")
            poly = _one(term, reading)
            noise = reading.context.random | reading.context.uncentred
            if any(parts(a)[0] in noise for _, w in poly.terms for a in w):
                raise Rejected("a random signal is compared with an expectation")
            return poly


def _one(term: Term, reading: Reading) -> Poly:
    grid = lower(term, reading)
    if len(grid) != 1 or len(grid[0]) != 1:
        raise Rejected("the expectation of a block matrix is written out by blocks")
    return grid[0][0]


def check_expectation(equation: Equation, image: Poly, identities: tuple[Certificate, ...], reading: Reading) -> None:
    """Accept E[p] = 0 from p = q and E[q] = 0, or raise Rejected."""
    if len(identities) != 2 or any(c.trace for c in identities) or equation.relation != "=":
        raise Rejected("an equation between expectations has two identities: under the expectation, and after it")
    body = inside(equation, reading)
    for claim, proof in ((body - image, identities[0]), (expect(image, reading.context), identities[1])):
        replay(proof, claim, reading.context.relations, reading.context.alphabet)


def expanded(equation: Equation, work: Workspace) -> list[Poly]:
    """Return ways to write p, each with moments that are declared; the shortest derivation first."""
    body = inside(equation, work.reading)
    context = work.reading.context
    found: list[Poly] = []
    relations = work.equations(False).relations
    signals = context.random | context.uncentred
    chosen = {n: p for n, p in relations.items() if _letters(p) & signals}
    centred = {n: p for n, p in chosen.items() if not _letters(p) & context.uncentred}
    away = sorted(context.uncentred)
    for equations, eliminate in (({}, ()), (centred, ()), (chosen, ()), (chosen, away)):
        image = reduced(body, equations, context.alphabet, eliminate)
        try:
            expect(image, context)
        except Rejected:
            continue
        if image not in found:
            found.append(image)
    return found


def _letters(poly: Poly) -> set[str]:
    return {parts(a)[0] for _, w in poly.terms for a in w}
