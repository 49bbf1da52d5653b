"""Gradients of a trace whose letters depend on the gain: they are first written out for every gain.

d tr P = d tr f(L) for P = f(L) at every L, where f contains L and parameters only
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.context import Declared
from derive.decide.ground import leave_out
from derive.decide.workspace import Workspace
from derive.derivation import DIRECTION
from derive.kernel import Certificate, Poly, Rejected, parts, replay
from derive.matrix.normal import reduced
from derive.rules import variation
from derive.terms import Dot, Equation, Expect, Gradient, Reading, Symbol, Term, Zero, lower, lower_trace, walk
from derive.theory.claims.base import ClaimTheory

__all__ = ["check_gradient", "dependent", "gradient_claim", "gradient_of", "images", "inner"]


def dependent(gain: str, theory: ClaimTheory) -> frozenset[str]:
    """Return the letters that change with a gain: those that an equation gives by it, or by others that do.

    All letters of an equation between it and others do, if it gives none of them. What holds for the optimal gain only
    says nothing of that.
    """
    pairs: list[tuple[set[str], set[str]]] = []
    for name, item in theory.theory.declared.items():
        if isinstance(item, Declared) and name not in theory.optimal and item.statement.relation in ("=", ":="):
            sides = item.statement.lhs, item.statement.rhs
            named = [_defined(side) for side in sides]
            pairs += [({n}, _names(other)) for n, other in zip(named, sides[::-1], strict=True) if n]
            if not any(named) and not any(isinstance(n, Expect) for side in sides for n in walk(side)):
                both = _names(sides[0]) | _names(sides[1])
                pairs.append((both, both))
    found = {gain}
    while True:
        more = {n for names, below in pairs if below & found for n in names}
        if more <= found:
            return frozenset(found - {gain})
        found |= more


def _defined(side: Term) -> str:
    """Return the name of the letter that an equation gives, itself or by its rate; "" if a side is no letter."""
    side = side.body if isinstance(side, Dot) else side
    return side.name if isinstance(side, Symbol) else ""


def _names(term: Term) -> set[str]:
    return {n.name for n in walk(term) if isinstance(n, Symbol)}


def inner(equation: Equation, reading: Reading) -> Poly:
    """Return what stands under the trace of a gradient."""
    if not isinstance(equation.lhs, Gradient) or equation.relation != "=":
        raise Rejected("an equation with a gradient on the left is needed")
    return lower_trace(equation.lhs.body, reading)


def gradient_claim(equation: Equation, image: Poly, reading: Reading) -> Poly:
    """Return d tr f along a direction H less tr(G' H), which is zero under the trace if G is the gradient."""
    if not isinstance(equation.lhs, Gradient):
        raise Rejected("an equation with a gradient on the left is needed")
    symbol, alphabet = equation.lhs.symbol, reading.context.alphabet
    change = DIRECTION + symbol.letter
    moved = variation(image, symbol.letter, change, reading.context)
    gradient = Poly({}, *alphabet.shape(symbol.letter))
    if not isinstance(equation.rhs, Zero):
        ((gradient,),) = lower(equation.rhs, reading)
    product = alphabet.transpose(gradient) * Poly({((), (change,)): 1}, *alphabet.shape(symbol.letter))
    return Poly(moved.terms, product.rows, product.cols) - product


def check_gradient(
    equation: Equation, image: Poly, identities: tuple[Certificate, ...], reading: Reading, theory: ClaimTheory
) -> None:
    """Accept the gradient of tr p by tr p = tr f for every gain, and the gradient of tr f; or raise Rejected."""
    if len(identities) != 2 or not all(c.trace for c in identities):
        raise Rejected("a gradient has two identities under the trace")
    context, gain = reading.context, equation.lhs.symbol.name if isinstance(equation.lhs, Gradient) else ""
    if {parts(a)[0] for _, w in image.terms for a in w} & dependent(gain, theory):
        raise Rejected("a letter under the gradient changes with the gain")
    anywhere = leave_out(theory.optimal, context.relations)
    replay(identities[0], inner(equation, reading) - image, anywhere, context.alphabet)
    replay(identities[1], gradient_claim(equation, image, reading), context.relations, context.alphabet)


def images(equation: Equation, work: Workspace) -> Iterator[Poly]:
    """Iterate over ways to write what is under the trace: as it stands, and by what holds for every gain."""
    body = inner(equation, work.reading)
    gain = equation.lhs.symbol.name if isinstance(equation.lhs, Gradient) else ""
    changing = dependent(gain, work.theory)
    image = reduced(body, work.equations(True).relations, work.reading.context.alphabet)
    for form in dict.fromkeys((body, image)):
        if not {parts(a)[0] for _, w in form.terms for a in w} & changing:
            yield form


def gradient_of(equation: Equation, work: Workspace) -> Poly | None:
    """Return the gradient of the trace on the left as a polynomial: tr(u H v) has the gradient (v u)'."""
    if not isinstance(equation.lhs, Gradient):
        return None
    symbol, alphabet = equation.lhs.symbol, work.reading.context.alphabet
    change = DIRECTION + symbol.letter
    for image in images(equation, work):
        try:
            moved = variation(image, symbol.letter, change, work.reading.context)
        except Rejected:
            continue
        total = Poly({}, *alphabet.shape(symbol.letter))
        for (m, w), c in moved.terms.items():
            at = next(i for i, a in enumerate(w) if parts(a)[0] == DIRECTION + symbol.name)
            turned = Poly({(m, w[at + 1 :] + w[:at]): c}, total.rows, total.cols)
            if w[at] == change:
                turned = alphabet.transpose(Poly(turned.terms, total.cols, total.rows))
            total = total + turned
        return total
    return None
