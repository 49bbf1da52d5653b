"""Inequalities between traces, by products of two matrices >= 0. ``check_trace_order`` is part of the trust base."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from derive.decide.order import prove_order
from derive.decide.workspace import Workspace
from derive.kernel import ANY, Certificate, Poly, Rejected, Term, replay
from derive.matrix.normal import reduced
from derive.rules import Context

__all__ = ["TraceOrder", "TraceProduct", "check_trace_order", "prove_trace_order"]


@dataclass(frozen=True)
class TraceProduct:
    """The addend c * tr(M H), c >= 0, with M and H the matrices of two facts."""

    coefficient: Fraction
    one: str
    two: str


@dataclass(frozen=True)
class TraceOrder:
    """tr G >= 0 because tr G is a sum of products tr(M H) of positive semidefinite matrices; > 0 if one is definite."""

    products: tuple[TraceProduct, ...]
    terms: tuple[Term, ...]


def check_trace_order(proof: TraceOrder, claim: Poly, strict: bool, context: Context) -> None:
    """Accept tr G >= 0 or tr G > 0, or raise Rejected.

    tr(M H) = tr(H^1/2 M H^1/2) >= 0 for M, H >= 0, and > 0 if both are definite
    """
    rest, positive = claim, False
    for product in proof.products:
        facts = [context.fact(name, "psd", "pd") for name in (product.one, product.two)]
        if product.coefficient < 0 or any(len(f.matrix) != 1 or len(f.matrix[0]) != 1 for f in facts):
            raise Rejected("a product needs a coefficient >= 0 and two facts on one block")
        (m, h), flip = [f.matrix[0][0] for f in facts], context.alphabet.transpose
        if any(flip(x) != x or not context.is_real(x) for x in (m, h)):
            raise Rejected("a matrix under the trace is not known to be real and symmetric")
        if (m.rows, m.cols) != (h.cols, h.rows):
            raise Rejected("the two matrices of a product have different sizes")
        added = (m * h).scale(-product.coefficient)
        rest = Poly(rest.terms, added.rows, added.cols) + added if _no_identity(rest) else rest + added
        positive |= product.coefficient > 0 and all(f.kind == "pd" for f in facts)
    replay(Certificate(rest, proof.terms, trace=True), rest, context.relations, context.alphabet)
    if strict and not positive:
        raise Rejected("no product is of two definite matrices")


def _no_identity(poly: Poly) -> bool:
    return all(w for _, w in poly.terms)


# ------------------------------------------------------------------------------------------------ search
def prove_trace_order(claim: Poly, strict: bool, work: Workspace) -> TraceOrder | None:
    """Search for a proof of tr G >= 0, or tr G > 0."""
    for proposal in _trace_proposals(claim, work):
        found = _by_products(claim, proposal, strict, work)
        if found:
            return found
    return None


def _by_products(claim: Poly, products: list[TraceProduct], strict: bool, work: Workspace) -> TraceOrder | None:
    rest, context = claim, work.reading.context
    for product in products:
        m, h = (context.facts[name].matrix[0][0] for name in (product.one, product.two))
        added = (m * h).scale(-product.coefficient)
        rest = Poly(rest.terms, added.rows, added.cols) + added if _no_identity(rest) else rest + added
    found = work.prove(rest, trace=True)
    if found is None:
        return None
    proof = TraceOrder(tuple(products), found.terms)
    try:
        check_trace_order(proof, claim, strict, work.reading.context)
    except Rejected:
        return None
    return proof


def _trace_proposals(claim: Poly, work: Workspace) -> Iterator[list[TraceProduct]]:
    """Iterate over sums of products: the claim itself under a trace, then one known matrix taken out of every term."""
    alphabet = work.reading.context.alphabet
    forms = [claim, *(reduced(claim, work.relations_on([claim], every_gain=flag), alphabet) for flag in (True, False))]
    one = Fraction(1)
    for form in dict.fromkeys(forms):
        symmetric = _symmetric(form, work)
        if symmetric is not None:
            name = _known(symmetric, work)
            if name:
                yield [TraceProduct(one, name, f"I{symmetric.rows}")]
        for fact, rest in _taken_out(form, work):
            name = _known(rest, work)
            if name:
                yield [TraceProduct(one, fact, name)]


def _symmetric(form: Poly, work: Workspace) -> Poly | None:
    """Return the polynomial as a symmetric matrix, if all its words have one size."""
    alphabet = work.reading.context.alphabet
    if ANY in (form.rows, form.cols) or not form.terms:
        return None
    shapes = {alphabet.word_shape(w, form.rows) for _, w in form.terms}
    if len(shapes) != 1 or len(set(*shapes)) != 1:
        return None
    ((rows, cols),) = shapes
    poly = Poly(form.terms, rows, cols)
    return (poly + alphabet.transpose(poly)).scale(Fraction(1, 2))


def _taken_out(form: Poly, work: Workspace) -> Iterator[tuple[str, Poly]]:
    """Write tr G as tr(H R) for a letter H >= 0 that occurs in every word; yields (fact on H, R)."""
    for name, fact in list(work.reading.context.facts.items()):
        if fact.kind not in ("psd", "pd") or len(fact.matrix) != 1 or len(fact.matrix[0][0].terms) != 1:
            continue
        ((key, c),) = fact.matrix[0][0].terms.items()
        if key[0] or len(key[1]) != 1 or c != 1:
            continue
        letter, size = key[1][0], fact.matrix[0][0].rows
        rest: dict[tuple[tuple[str, ...], tuple[str, ...]], Fraction] = {}
        for (m, w), d in form.terms.items():
            if letter not in w:
                break
            at = w.index(letter)
            turned = (m, w[at + 1 :] + w[:at])
            rest[turned] = rest.get(turned, Fraction(0)) + d
        else:
            found = _symmetric(Poly(rest, size, size), work)
            if found is not None:
                yield name, found


def _known(poly: Poly, work: Workspace) -> str | None:
    """Return the name of a fact that a matrix is >= 0, proved if it is missing."""
    for kind in ("pd", "psd"):
        for name, fact in work.reading.context.facts.items():
            if fact.kind == kind and fact.matrix == ((poly,),):
                return name
    for strict in (True, False):
        proof = prove_order(((poly,),), strict, work, depth=1)
        if proof and proof.positivity:
            return work.lemma(f"matrix {len(work.items) + 1}", poly, proof.positivity, strict)
    return None
