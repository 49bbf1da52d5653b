"""Squares that a matrix is a sum of, found by completing them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from derive.decide.workspace import Workspace
from derive.kernel import Poly
from derive.matrix.normal import reduced
from derive.matrix.positivity import proposals, rests
from derive.rules import Square

__all__ = ["DEPTH", "between_inverses", "completed", "dominated"]

DEPTH = 2  # squares that are completed one after the other


def between_inverses(poly: Poly, work: Workspace) -> Iterator[tuple[Square, ...]]:
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


def dominated(poly: Poly, work: Workspace) -> Iterator[tuple[Square, ...]]:
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


def completed(poly: Poly, work: Workspace, depth: int) -> Iterator[tuple[Square, ...]]:
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
                for more in completed(rest, work, depth + 1):
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
