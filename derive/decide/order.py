"""The Loewner order: by squares that are read off, completed or usual, and by comparison.

What is proposed here is replayed by the rules for positivity; a proposal that no random instance supports is dropped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from derive.decide.completing import DEPTH, between_inverses, completed, dominated
from derive.decide.squares import gains, usual_squares
from derive.decide.workspace import Workspace
from derive.derivation import Proof
from derive.kernel import Poly, Rejected, identity
from derive.matrix.normal import reduced
from derive.matrix.positivity import proposals, prove_comparison, rests, schur_complement, schur_squares
from derive.rules import Comparison, Grid, Positivity, Square, differentiate
from derive.terms import grid_map

__all__ = ["prove_order"]


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
    for squares in block_squares(grid, work) if depth < DEPTH else ():
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


def block_squares(grid: Grid, work: Workspace) -> Iterator[tuple[Square, ...]]:
    """Iterate over squares of block matrices: of a known one, and by the Schur complement of the last block."""
    context = work.reading.context
    for name, fact in list(context.facts.items()):
        if fact.kind in ("psd", "pd") and len(fact.matrix) > 1:
            for factor in _block_factors(grid, fact.matrix, work):
                yield (Square(Fraction(1), (), factor, name),)
    if len(grid) != 2:
        return
    corner = next((n for n, f in context.facts.items() if f.kind == "pd" and f.matrix == ((grid[1][1],),)), None)
    inverse = work.inverse(grid[1][1])
    if corner is None or inverse is None:
        return
    ((complement,),) = schur_complement(grid, inverse, context.alphabet)
    name = _forcing(reduced(complement, work.relations_on([complement]), context.alphabet), work)
    if name is not None:
        yield schur_squares(grid, inverse, name, corner)


def _block_factors(grid: Grid, core: Grid, work: Workspace) -> Iterator[Grid]:
    """Iterate over factors F of F G F': the identity for a matrix like G, else [I, -X] for X = Y Z^-1 and gains."""
    sizes = [row[i].rows for i, row in enumerate(core)]
    if len(grid) == len(core):
        yield tuple(
            tuple(identity(m) if i == j else Poly({}, n, m) for j, m in enumerate(sizes)) for i, n in enumerate(sizes)
        )
        return
    if len(grid) != 1 or len(core) != 2 or grid[0][0].rows != sizes[0]:
        return
    inverse = work.inverse(core[1][1])
    sides = [core[0][1] * inverse] if inverse is not None else []
    sides += [x for x in gains(work) if (x.rows, x.cols) == (sizes[0], sizes[1])]
    yield from (((identity(sizes[0]), -x),) for x in [*sides, Poly({}, *sizes)])


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
        yield from completed(form[0][0], work, depth)
        yield from dominated(form[0][0], work)
        yield from between_inverses(form[0][0], work)


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
