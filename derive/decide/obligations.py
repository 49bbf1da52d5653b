"""Definedness: every inverse in a claim exists for a reason, or is refuted where it does not.

M is invertible because M ≻ 0 (or -M ≻ 0), because it is a product of invertible matrices, because it is I + X Y with
I + Y X invertible, because its product with an invertible matrix is, or at a generic point. Each reason but the first
and the last ends in an explicit two-sided inverse, which the kernel checks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.claim import Counterexample
from derive.context import terms_of
from derive.decide.ground import GENERIC, Introduced, generic, moves, ratio
from derive.decide.order import prove_order
from derive.decide.workspace import Workspace
from derive.kernel import Poly, Rejected, identity
from derive.terms import Inverse, Neg, Product, Term, Transpose, lower

__all__ = ["Undefined", "Unjustified", "invert", "justify", "justify_given"]

DEPTH = 3  # how often a matrix may be traced back to another one
FIRST = 20  # instances that are tried before a reason is looked for
SINGULAR = 1500  # instances that are tried for one where a matrix is singular


@dataclass
class Undefined(Exception):  # noqa: N818 - what was found about a claim
    """An inverse of the claim does not exist at an instance of the hypotheses."""

    body: Term
    counterexample: Counterexample


@dataclass
class Unjustified(Exception):  # noqa: N818 - what was found about a claim
    """Neither a reason why an inverse exists was found, nor an instance where it does not."""

    body: Term


def justify(term: Term, work: Workspace, refuting: bool = True, supposing: bool = False) -> None:
    """Establish every inverse of a term, the inner ones first.

    Args:
        term: one side of a claim.
        work: where they are established.
        refuting: look for an instance where one does not exist.
        supposing: suppose one for which nothing was found, to refute the claim where it exists.

    Raises:
        Undefined: one of them does not exist everywhere.
        Unjustified: nothing was found about one of them.
        Rejected: the term has no meaning.
    """
    for child in term.children():
        justify(child, work, refuting, supposing)
    if not isinstance(term, Inverse):
        return
    grid = lower(term.body, work.reading)
    if len(grid) != 1 or len(grid[0]) != 1 or grid[0][0].rows != grid[0][0].cols:
        raise Rejected("the inverse of a block matrix, or of a matrix that is not square, has no rule")
    poly = grid[0][0]
    if work.inverse(poly) is not None or _by_factors(term.body, work):
        return
    refuting = refuting and not moves(poly, work.reading.context, work.reading.inverses)  # a generic point avoids it
    found = work.refute(poly, relation="invertible", most=FIRST) if refuting else None
    if found is None and invert(poly, work) is not None:
        return
    found = found or (work.refute(poly, relation="invertible", most=SINGULAR) if refuting else None)
    if found:
        raise Undefined(term.body, found)
    if not supposing:
        raise Unjustified(term.body)
    work.suppose(poly)


def justify_given(work: Workspace) -> None:
    """Establish the inverses in what is given; the declarations that wait for them are taken up."""
    for name in work.waiting():
        item = work.theory.theory.declared[name]
        for term in terms_of(item) if name not in work.reading.adopted else ():
            justify(term, work, refuting=False)
    if work.waiting():
        raise Rejected(f"{work.waiting()[0]}: no reason was found why an inverse in it exists")


def invert(poly: Poly, work: Workspace, depth: int = 0) -> Poly | None:
    """Return the inverse of a matrix as a letter that is established, or None."""
    known = work.inverse(poly)
    if known is not None or poly.rows != poly.cols or not poly.terms or depth > DEPTH:
        return known
    if _by_fact(poly, work) or _by_sign(poly, work):
        return work.inverse(poly)
    if any(_explicit(poly, by, work) for by in _candidates(poly, work, depth)):
        return work.inverse(poly)
    for variable in GENERIC:
        if generic(poly, variable, work.reading.context, work.reading.inverses):
            work.take(Introduced(work.fresh(), poly, generic=variable))
            return work.inverse(poly)
    return None


def _by_fact(poly: Poly, work: Workspace) -> bool:
    for name, fact in work.reading.context.facts.items():
        if fact.kind in ("pd", "invertible") and fact.matrix == ((poly,),):
            work.take(Introduced(work.fresh(), poly, because=name))
            return True
    return False


def _by_sign(poly: Poly, work: Workspace) -> bool:
    """Prove M ≻ 0 and introduce its inverse."""
    if work.reading.context.alphabet.transpose(poly) != poly or not work.reading.context.is_real(poly):
        return False
    found = prove_order(((poly,),), True, work)
    if found is None or found.positivity is None:
        return False
    letter = work.fresh()
    fact = work.lemma(f"matrix of {letter} > 0", poly, found.positivity, strict=True)
    work.take(Introduced(letter, poly, because=fact))
    return True


def _explicit(poly: Poly, by: Poly | None, work: Workspace) -> bool:
    """Introduce the inverse of a matrix by an explicit formula for it."""
    if by is None:
        return False
    found = work.proves_inverse(poly, by)
    if found is None:
        return False
    work.take(Introduced(work.fresh(), poly, by=by, right=found[0], left=found[1]))
    return True


def _by_factors(body: Term, work: Workspace) -> bool:
    """Invert a product as it is written, or the transpose or negative of what has an inverse."""
    by: Poly | None = None
    match body:
        case Product(factors):
            polys = [grid[0][0] for grid in (lower(f, work.reading) for f in factors if not _is_central(f))]
            if len(polys) < 2 or any(p.rows != p.cols for p in polys):
                return False
            by = _reversed([invert(p, work) for p in polys])
            total = lower(body, work.reading)[0][0]
            plain = polys[0]
            for p in polys[1:]:
                plain = plain * p
            factor = ratio(total, plain)
            by = by.scale(1 / factor) if by is not None and factor else None
        case Transpose(inner) | Neg(inner):
            ((poly,),) = lower(inner, work.reading)
            found = invert(poly, work)
            if found is not None:
                by = -found if isinstance(body, Neg) else work.reading.context.alphabet.transpose(found)
        case _:
            return False
    ((poly,),) = lower(body, work.reading)
    return work.inverse(poly) is not None or _explicit(poly, by, work)


def _is_central(term: Term) -> bool:
    from derive.terms import Number, Symbol

    return isinstance(term, Number) or (isinstance(term, Symbol) and term.scalar)


def _reversed(inverses: list[Poly | None]) -> Poly | None:
    total: Poly | None = None
    for inverse in reversed(inverses):
        if inverse is None:
            return None
        total = inverse if total is None else total * inverse
    return total


# ------------------------------------------------------------------------------------------------ formulas to try
def _candidates(poly: Poly, work: Workspace, depth: int) -> Iterator[Poly | None]:
    """Iterate over formulas for the inverse of a matrix."""
    if set(poly.terms) == {((), ())}:
        yield identity(poly.rows).scale(1 / poly.terms[(), ()])
    for other, name in work.reading.inverses.items():
        letter = Poly({((), (name,)): 1}, other.cols, other.rows)
        if c := ratio(poly, letter):
            yield other.scale(1 / c)
        if c := ratio(poly, other):
            yield letter.scale(1 / c)
    yield _rewritten(poly, work, depth)
    yield _negative(poly, work, depth)
    yield _word(poly, work, depth)
    yield from _multiples(poly, work, depth)
    yield from _exchanged(poly, work, depth)
    yield from _woodbury(poly, work, depth)


def _rewritten(poly: Poly, work: Workspace, depth: int) -> Poly | None:
    """Return the inverse of what a matrix is by definition."""
    found = _reduced(poly, work, work.relations_on([poly]))
    return None if found == poly else invert(found, work, depth + 1)


def _negative(poly: Poly, work: Workspace, depth: int) -> Poly | None:
    """M^-1 = -(-M)^-1 for -M ≻ 0."""
    if sum(c < 0 for c in poly.terms.values()) * 2 <= len(poly.terms) or not (
        _by_fact(-poly, work) or _by_sign(-poly, work)
    ):
        return None
    found = work.inverse(-poly)
    return -found if found is not None else None


def _word(poly: Poly, work: Workspace, depth: int) -> Poly | None:
    """(c A B)^-1 = B^-1 A^-1 / c for square letters."""
    (((scalars, word), c), *rest) = poly.terms.items()
    alphabet = work.reading.context.alphabet
    shapes = [alphabet.shape(a) for a in word]
    if rest or scalars or len(word) < 2 or any(rows != cols for rows, cols in shapes):
        return None
    found = _reversed([invert(Poly({((), (a,)): 1}, *alphabet.shape(a)), work, depth + 1) for a in word])
    return found.scale(1 / c) if found is not None else None


def _multiples(poly: Poly, work: Workspace, depth: int) -> Iterator[Poly | None]:
    """M^-1 = H (M H)^-1 and (H M)^-1 H for H with an inverse, if M H is known to have one."""
    relations = work.relations_on([poly], every_gain=False)
    for matrix, name in list(work.reading.inverses.items()):
        for h in (Poly({((), (name,)): 1}, matrix.cols, matrix.rows), matrix):
            if h.rows != poly.rows:
                continue
            for left in (True, False):
                product = _reduced(h * poly if left else poly * h, work, relations)
                inverse = _known(product, work)
                if inverse is not None:
                    yield inverse * h if left else h * inverse


def _known(poly: Poly, work: Workspace) -> Poly | None:
    """Return the inverse of a matrix that has one already, or is a known fact."""
    found = work.inverse(poly)
    if found is not None or not poly.terms:
        return found
    if set(poly.terms) == {((), ())}:
        return identity(poly.rows).scale(1 / poly.terms[(), ()])
    for other, name in work.reading.inverses.items():
        letter = Poly({((), (name,)): 1}, other.cols, other.rows)
        if c := ratio(poly, letter):
            return other.scale(1 / c)
        if c := ratio(poly, other):
            return letter.scale(1 / c)
    if _by_fact(poly, work) or _by_sign(poly, work):
        return work.inverse(poly)
    return None


def _exchanged(poly: Poly, work: Workspace, depth: int) -> Iterator[Poly | None]:
    """(c I + X Y)^-1 = (I - X (c I + Y X)^-1 Y) / c for a product that is split in two."""
    c = poly.terms.get(((), ()))
    rest = [(key, d) for key, d in poly.terms.items() if key != ((), ())]
    if not c or len(rest) != 1 or rest[0][0][0]:
        return
    (((_, word), d),) = rest
    alphabet = work.reading.context.alphabet
    for i in range(1, len(word)):
        x = Poly({((), word[:i]): d}, poly.rows, alphabet.shape(word[i])[0])
        y = Poly({((), word[i:]): 1}, x.cols, poly.cols)
        inner = y * x + identity(x.cols).scale(c)
        found = work.inverse(inner)
        if found is None and _any_multiple(inner, work, depth):
            found = work.inverse(inner)
        if found is not None:
            yield (identity(poly.rows) - x * found * y).scale(1 / c)


def _woodbury(poly: Poly, work: Workspace, depth: int) -> Iterator[Poly | None]:
    """(X + c U Z^-1 V)^-1 = X^-1 - X^-1 U (Z / c + V X^-1 U)^-1 V X^-1."""
    if depth > 1:
        return
    for z, name in list(work.reading.inverses.items()):
        ours = {k: c for k, c in poly.terms.items() if k[1].count(name) == 1 and not k[0]}
        if len(ours) != 1 or len(poly.terms) == 1:
            continue
        (((_, word), c),) = ours.items()
        at = word.index(name)
        u, v = Poly({((), word[:at]): 1}, poly.rows, z.rows), Poly({((), word[at + 1 :]): 1}, z.cols, poly.cols)
        x = invert(Poly({k: d for k, d in poly.terms.items() if k not in ours}, poly.rows, poly.cols), work, depth + 1)
        if x is None:
            continue
        inner = _reduced(z.scale(1 / c) + v * x * u, work, work.relations_on([z, x, u, v]))
        found = invert(inner, work, depth + 1)
        if found is not None:
            yield x - x * u * found * v * x


def _any_multiple(poly: Poly, work: Workspace, depth: int) -> bool:
    return any(_explicit(poly, by, work) for by in _multiples(poly, work, depth))


def _reduced(poly: Poly, work: Workspace, relations) -> Poly:
    from derive.matrix.normal import reduced

    return reduced(poly, relations, work.reading.context.alphabet)
