"""Inequalities: the Loewner order by squares and comparison; traces by products of two matrices >= 0.

What is proposed here is replayed by the rules for positivity; a proposal that no random instance supports is dropped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.decide.squares import usual_squares
from derive.decide.workspace import Workspace
from derive.derivation import Proof
from derive.kernel import ANY, Certificate, Poly, Rejected, Term, replay
from derive.matrix.normal import reduced
from derive.matrix.positivity import proposals, prove_comparison, rests
from derive.rules import Comparison, Context, Grid, Positivity, Square, differentiate
from derive.terms import grid_map

__all__ = ["TraceOrder", "TraceProduct", "check_trace_order", "prove_order", "prove_trace_order"]

DEPTH = 2  # squares that are completed one after the other


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


# ------------------------------------------------------------------------------------------------ the Loewner order
def prove_order(grid: Grid, strict: bool, work: Workspace, depth: int = 0) -> Proof | None:
    """Search for a proof of G ⪰ 0, or G ≻ 0."""
    for form in _forms(grid, work):
        _know_inverses(form, work)
        if depth < DEPTH:
            _know_letters(form, work, depth)
        for squares in _squares(form, work, depth):
            proof = _by_squares(grid, squares, strict, work)
            if proof:
                return Proof(positivity=proof)
    if len(grid) == len(grid[0]) == 1:
        for squares in usual_squares(grid[0][0], strict, work):
            proof = _by_squares(grid, squares, strict, work)
            if proof:
                return Proof(positivity=proof)
    if strict or len(grid) != 1 or len(grid[0]) != 1 or depth:
        return None
    found = _by_comparison(grid[0][0], work)
    return Proof(comparison=found) if found else None


def _forms(grid: Grid, work: Workspace) -> Iterator[Grid]:
    """Iterate over ways to write the claim: as it stands, and with definitions and equations put in."""
    seen: list[Grid] = []
    alphabet = work.reading.context.alphabet
    polys = [p for row in grid for p in row]
    for relations in (None, work.relations_on(polys, every_gain=True), work.relations_on(polys)):
        form = grid if relations is None else grid_map(lambda p, r=relations: reduced(p, r, alphabet), grid)
        if form not in seen:
            seen.append(form)
            yield form


def _know_inverses(grid: Grid, work: Workspace) -> None:
    """Take up M^-1 ≻ 0 for the inverses that occur."""
    letters = {a for row in grid for p in row for _, w in p.terms for a in w}
    for poly, name in list(work.reading.inverses.items()):
        if name in letters:
            work.inverse_is_positive(poly)


def _know_letters(grid: Grid, work: Workspace, depth: int) -> None:
    """Take up X ⪰ 0 for the symmetric letters that occur and of which nothing is known, if it can be proved."""
    context = work.reading.context
    known = {f.matrix[0][0] for f in context.facts.values() if f.kind in ("psd", "pd") and len(f.matrix) == 1}
    letters = sorted({a for row in grid for p in row for _, w in p.terms for a in w if context.alphabet.flip(a) == a})
    for letter in letters:
        poly = Poly({((), (letter,)): 1}, *context.alphabet.shape(letter))
        if poly not in known and grid != ((poly,),) and _is_defined(letter, work):
            found = prove_order(((poly,),), False, work, depth + 1)
            if found and found.positivity:
                work.lemma(f"{letter} >= 0", poly, found.positivity)


def _is_defined(letter: str, work: Workspace) -> bool:
    """Tell whether an equation gives a letter as an expression in others."""
    return any(((), (letter,)) in p.terms for p in work.equations(False).relations.values())


def _squares(form: Grid, work: Workspace, depth: int) -> Iterator[tuple[Square, ...]]:
    context = work.reading.context
    yield from proposals(form, context)
    if len(form) == len(form[0]) == 1:
        yield from _completed(form[0][0], work, depth)
        yield from _dominated(form[0][0], work)
        yield from _inverses(form[0][0], work)


def _inverses(poly: Poly, work: Workspace) -> Iterator[tuple[Square, ...]]:
    """N^-1 - M^-1 = M^-1 (E + E N^-1 E) M^-1 for M = N + E, where E is a sum of squares."""
    context, one = work.reading.context, Fraction(1)
    names = {c: w for (m, w), c in poly.terms.items() if not m and len(w) == 1}
    matrices = {(name,): p for p, name in work.reading.inverses.items()}
    if len(poly.terms) != 2 or set(names) != {1, -1} or not set(names.values()) <= set(matrices):
        return
    n, m = matrices[names[one]], matrices[names[-one]]
    fact, x = work.inverse_is_positive(n), work.inverse(m)
    if fact is None or x is None:
        return
    for squares in proposals(((m - n,),), context):
        moved = tuple(replace(s, factor=((x * s.factor[0][0],),)) for s in squares)
        yield (*moved, Square(one, (), ((x * (m - n),),), fact))


def _dominated(poly: Poly, work: Workspace) -> Iterator[tuple[Square, ...]]:
    """Take back what was subtracted: X - Y Z^-1 Y' = [I, -Y Z^-1] G [I, -Y Z^-1]' for G = [[X, Y], [Y', Z]].

    The squares F_i H_i F_i' of G give the squares [I, -Y Z^-1] F_i H_i (.)'.
    """
    context, flip = work.reading.context, work.reading.context.alphabet.transpose
    for _, core, inverse in _cores(work):
        ((_, (letter,)),) = inverse.terms
        taken = Poly({k: -c for k, c in poly.terms.items() if letter in k[1]}, poly.rows, poly.cols)
        facts = {n: f for n, f in context.facts.items() if f.matrix == ((inverse,),) and f.kind == "pd"}
        if not taken.terms or not facts:
            continue
        squares = next(proposals(((taken,),), replace(context, facts=facts)), ())
        if len(squares) != 1 or squares[0].scalars:
            continue
        y, c = squares[0].factor[0][0], squares[0].coefficient
        grid = ((poly + taken, y.scale(c)), (flip(y).scale(c), core.scale(c)))
        for above in proposals(grid, context):
            found = [(s, s.factor[0][0] - y * inverse * s.factor[1][0]) for s in above]
            yield tuple(replace(s, factor=((factor,),)) for s, factor in found if factor.terms)


def _completed(poly: Poly, work: Workspace, depth: int) -> Iterator[tuple[Square, ...]]:
    """Complete squares: c X S X' + N X' + X N' is c (X + N S^-1 / c) S (X + N S^-1 / c)' and what is left."""
    context, alphabet = work.reading.context, work.reading.context.alphabet
    for fact, core, inverse in _cores(work):
        lead = min((k for k, c in core.terms.items() if c > 0 and not k[0]), key=lambda k: (len(k[1]), k[1]))
        for u in _sides(poly, lead[1], work):
            turned = tuple(alphabet.flip(a) for a in reversed(u))
            c = poly.terms[(), (*u, *lead[1], *turned)] / core.terms[lead]
            x = Poly({((), u): 1}, poly.rows, core.rows)
            left = poly - (x * core * alphabet.transpose(x)).scale(c)
            n = Poly(
                {
                    (m, w[: -len(u)]): d
                    for (m, w), d in left.terms.items()
                    if len(w) > len(u) and w[-len(u) :] == turned
                },
                poly.rows,
                core.rows,
            )
            factor = x + (n * inverse).scale(1 / c)
            square = Square(c, (), ((factor,),), fact)
            rest = reduced(rests(((poly,),), [square], context)[0][0], work.relations_on([poly]), alphabet)
            if not rest.terms:
                yield (square,)
                continue
            for more in proposals(((rest,),), context):
                yield (square, *more)
            if depth < DEPTH and len(rest.terms) < len(poly.terms):
                for more in _completed(rest, work, depth + 1):
                    yield (square, *more)


def _cores(work: Workspace) -> list[tuple[str, Poly, Poly]]:
    """Return (fact, S, letter for S^-1) of the matrices S ≻ 0 with an inverse."""
    found: list[tuple[str, Poly, Poly]] = []
    for name, fact in work.reading.context.facts.items():
        if fact.kind == "pd" and len(fact.matrix) == 1:
            core = fact.matrix[0][0]
            inverse = work.inverse(core)
            if inverse is not None and any(c > 0 and not m and w for (m, w), c in core.terms.items()):
                found.append((name, core, inverse))
    return found


def _sides(poly: Poly, h: tuple[str, ...], work: Workspace) -> list[tuple[str, ...]]:
    """Return the words u of products c u h u' with c > 0."""
    flip, found = work.reading.context.alphabet.flip, list[tuple[str, ...]]()
    for (m, w), c in poly.terms.items():
        size = (len(w) - len(h)) // 2
        u = w[:size]
        if c > 0 and not m and size > 0 and w == (*u, *h, *(flip(a) for a in reversed(u))):
            found.append(u)
    return sorted(found, key=lambda u: (len(u), u))


def _by_squares(grid: Grid, squares: tuple[Square, ...], strict: bool, work: Workspace) -> Positivity | None:
    """Prove that a claim is a sum of squares, unless a random instance tells that it is not."""
    try:
        left = rests(grid, squares, work.reading.context)
    except (Rejected, IndexError):
        return None
    if not all(work.plausible(p) for row in left for p in row):
        return None
    return work.positive(grid, strict, squares)


# ------------------------------------------------------------------------------------------------ comparison
def _by_comparison(claim: Poly, work: Workspace) -> Comparison | None:
    """Compare by a Lyapunov or Stein equation with a stable matrix, or from the initial time on."""
    kinds = {"hurwitz": "lyapunov", "schur": "stein", "initial": "transient"}
    for name, fact in list(work.reading.context.facts.items()):
        if fact.kind not in kinds or len(fact.matrix) != 1:
            continue
        for matrix in [fact.matrix[0][0]] if fact.kind != "initial" else _rates(claim, fact.matrix[0][0], work):
            if matrix.rows == claim.rows:
                found = _compare(kinds[fact.kind], claim, matrix, name, work)
                if found:
                    return found
    return None


def _rates(claim: Poly, initial: Poly, work: Workspace) -> Iterator[Poly]:
    """Return the matrices M of dX/dt = M X + ... for the letters X of the claim."""
    if claim != initial:
        return
    rate = differentiate(claim, work.reading.context)
    for _, word in claim.terms:
        terms = {(m, w[:-1]): c for (m, w), c in rate.terms.items() if len(word) == 1 and len(w) > 1 and w[-1:] == word}
        if terms and claim.terms[(), word] == 1:
            yield Poly(terms, claim.rows, claim.cols)


def _compare(kind: str, claim: Poly, matrix: Poly, stable: str, work: Workspace) -> Comparison | None:
    flip = work.reading.context.alphabet.transpose
    try:
        driven = claim - matrix * claim * flip(matrix) if kind == "stein" else -(matrix * claim + claim * flip(matrix))
        if kind == "transient":
            driven = driven + differentiate(claim, work.reading.context)
    except Rejected:
        return None
    relations = work.relations_on([driven, claim])
    forcing = reduced(driven, relations, work.reading.context.alphabet)
    if flip(forcing) != forcing or not work.plausible(driven - forcing):
        return None
    name = _forcing(forcing, work)
    if name is None:
        return None
    context = replace(work.reading.context, relations=relations)
    return prove_comparison(kind, claim, matrix, stable, name, context, seconds=work.attempt)


def _forcing(forcing: Poly, work: Workspace) -> str | None:
    """Prove F ⪰ 0 and return the name of the fact."""
    for name, fact in work.reading.context.facts.items():
        if fact.kind in ("psd", "pd") and fact.matrix == ((forcing,),):
            return name
    proof = prove_order(((forcing,),), False, work, depth=1)
    if proof is None or proof.positivity is None:
        return None
    return work.lemma(f"forcing {len(work.items) + 1}", forcing, proof.positivity)


# ------------------------------------------------------------------------------------------------ traces
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
