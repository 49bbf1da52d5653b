"""Certificates of positivity: sums of squares, Schur complements, comparison; each ends in identities.

The squares may be proposed. Otherwise they are read off the claim: its terms u H v' with H known to be >= 0 form a
quadratic form in the words u, and the exact factorisation L D L' of its coefficients gives the squares if D >= 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.kernel import Alphabet, Key, Poly, Rejected, Scalars, Term, Word, identity
from derive.matrix.search import prove
from derive.rules import (
    Comparison,
    Context,
    Fact,
    Grid,
    Positivity,
    Square,
    differentiate,
    replay_comparison,
    replay_positivity,
)

__all__ = ["proposals", "prove_comparison", "prove_positive", "rests", "schur_complement", "schur_squares"]

Place = tuple[int, Word]  # a block row of the claim and a word u in it
Form = dict[tuple[Place, Place], Fraction]


def prove_positive(
    claim: Grid,
    context: Context,
    squares: Sequence[Square] | None = None,
    *,
    strict: bool = False,
    inverse: Poly | None = None,
    inverses: Mapping[Poly, str] | None = None,
    overlaps: int | None = None,
    seconds: float = 5.0,
) -> Positivity | None:
    """Search for a proof of G >= 0, or of G > 0 if ``strict``.

    G = sum c_i F_i H_i F_i',  c_i >= 0, H_i >= 0;  strict: one H_i > 0 with c_i > 0 and F_i Z = I

    Args:
        claim: the block matrix G.
        context: relations, facts on the H_i, scalars >= 0.
        squares: the addends; found among the facts if left out.
        strict: ask for a positive definite addend with a right inverse of its factor.
        inverse: that right inverse Z; without it, multiples of the identity and declared inverses are tried.
        inverses: letters for inverses, by the polynomial that they invert.
        overlaps: bound on the overlaps that are resolved for each identity.
        seconds: bound on the time of each identity.
    """
    for proposal in [tuple(squares)] if squares is not None else proposals(claim, context):
        try:
            left = rests(claim, proposal, context)
            terms = _prove_blocks(left, context, overlaps, seconds)
            proof = Positivity(claim, proposal, terms) if terms is not None else None
            if proof and strict:
                proof = _strict(proof, context, inverse, inverses or {}, overlaps, seconds)
            if proof:
                replay_positivity(proof, claim, context)
                return proof
        except (Rejected, IndexError):  # a proposal of another shape proves nothing
            continue
    return None


def rests(claim: Grid, squares: Sequence[Square], context: Context) -> Grid:
    """Return what the squares leave of each block."""
    flip, left = context.alphabet.transpose, [list(row) for row in claim]
    for s in squares:
        core = context.fact(s.fact, "psd", "pd").matrix
        for i, row in enumerate(left):
            for j in range(len(row)):
                for k, core_row in enumerate(core):
                    for m, h in enumerate(core_row):
                        row[j] -= (s.factor[i][k] * h * flip(s.factor[j][m])).scale(s.coefficient, s.scalars)
    return tuple(map(tuple, left))


def _prove_blocks(
    rests: Grid, context: Context, overlaps: int | None, seconds: float
) -> tuple[tuple[tuple[Term, ...], ...], ...] | None:
    out: list[tuple[tuple[Term, ...], ...]] = []
    for row in rests:
        line: list[tuple[Term, ...]] = []
        for rest in row:
            certificate = prove(rest, context.relations, context.alphabet, overlaps=overlaps, seconds=seconds)
            if certificate is None:
                return None
            line.append(certificate.terms)
        out.append(tuple(line))
    return tuple(out)


def _strict(
    proof: Positivity,
    context: Context,
    inverse: Poly | None,
    inverses: Mapping[Poly, str],
    overlaps: int | None,
    seconds: float,
) -> Positivity | None:
    """Add a witness of strictness: an addend with a positive definite core and a factor with a right inverse."""
    for i, s in enumerate(proof.squares):
        if context.facts[s.fact].kind != "pd" or s.scalars or s.coefficient <= 0 or len(s.factor) != 1:
            continue
        factor = s.factor[0][0]
        for z in [inverse] if inverse else _right_inverses(factor, inverses, context.alphabet):
            if (z.rows, z.cols) != (factor.cols, factor.rows):
                continue
            injective = factor * z - identity(factor.rows)
            certificate = prove(injective, context.relations, context.alphabet, overlaps=overlaps, seconds=seconds)
            if certificate:
                return replace(proof, strict=i, inverse=z, inverse_terms=certificate.terms)
    return None


def _right_inverses(factor: Poly, inverses: Mapping[Poly, str], alphabet: Alphabet) -> Iterator[Poly]:
    """Iterate over candidates: the inverse number for c I, and the declared inverse of c S or c S'."""
    if set(factor.terms) == {((), ())}:
        yield identity(factor.rows).scale(1 / factor.terms[(), ()])
    for poly, name in inverses.items():
        for base, letter in ((poly, name), (alphabet.transpose(poly), alphabet.flip(name))):
            ratio = _ratio(factor, base)
            if ratio:
                yield Poly({((), (letter,)): 1 / ratio}, base.cols, base.rows)


def _ratio(a: Poly, b: Poly) -> Fraction | None:
    """Return c with a = c b, or None."""
    if not b.terms or set(a.terms) != set(b.terms):
        return None
    key = next(iter(b.terms))
    ratio = a.terms[key] / b.terms[key]
    return ratio if a == b.scale(ratio) else None


# ------------------------------------------------------------------------------------------------ finding squares
def proposals(claim: Grid, context: Context) -> Iterator[tuple[Square, ...]]:
    """Iterate over sums of squares read off the claim: letters only, then with the facts on sums taken out first."""
    known = {n: f for n, f in context.facts.items() if f.kind in ("psd", "pd") and len(f.matrix) == 1}
    definite = {f.matrix for f in known.values() if f.kind == "pd"}
    known = {n: f for n, f in known.items() if f.kind == "pd" or f.matrix not in definite}
    sums = [n for n, f in known.items() if len(f.matrix[0][0].terms) > 1]
    letters = [n for n, f in known.items() if len(f.matrix[0][0].terms) == 1]
    letters.sort(key=lambda n: _is_identity(known[n]))
    seen: set[tuple[Square, ...]] = set()
    for order in (letters, *([name, *letters] for name in sums), sums + letters):
        proposal = _take_out(claim, {name: known[name] for name in order}, context)
        if proposal not in seen:
            seen.add(proposal)
            yield proposal


def _take_out(claim: Grid, facts: Mapping[str, Fact], context: Context) -> tuple[Square, ...]:
    """Return squares that account for the terms u H v' of the claim, fact by fact; negative forms are passed over."""
    squares: list[Square] = []
    rest = claim
    for name, fact in facts.items():
        core = fact.matrix[0][0]
        positive = [k for k, c in core.terms.items() if c > 0 and not k[0]]
        if not positive:
            continue
        lead = min(positive, key=lambda k: (len(k[1]), k[1]))
        for scalars, form in _forms(rest, lead[1], core.rows, context).items():
            found = _squares(claim, name, core, scalars, {p: c / core.terms[lead] for p, c in form.items()})
            if found:
                squares += found
                rest = rests(rest, found, context)
    return tuple(squares)


def _is_identity(fact: Fact) -> bool:
    return set(fact.matrix[0][0].terms) == {((), ())}


def _forms(grid: Grid, h: Word, size: str, context: Context) -> dict[Scalars, Form]:
    """Return the quadratic forms sum c u h v' in the claim, h of the given size, by their scalars >= 0."""
    forms: dict[Scalars, Form] = {}
    for i, row in enumerate(grid):
        for j, block in enumerate(row):
            for (m, w), c in block.terms.items():
                at = _split(w, h)
                between = context.alphabet.word_shape(w[:at], block.rows)[1] if at is not None else ""
                if at is not None and between == size and context.nonnegative.issuperset(m):
                    v = tuple(context.alphabet.flip(a) for a in reversed(w[at + len(h) :]))
                    forms.setdefault(m, {})[(i, w[:at]), (j, v)] = c
    return forms


def _split(w: Word, h: Word) -> int | None:
    """Return where h stands in a word u h v'; the identity stands in the middle."""
    if not h:
        return len(w) // 2 if len(w) % 2 == 0 else None
    places = [i for i in range(len(w) - len(h) + 1) if w[i : i + len(h)] == h]
    return min(places, key=lambda i: abs(2 * i + len(h) - len(w)), default=None)


def _squares(claim: Grid, fact: str, core: Poly, scalars: Scalars, form: Form) -> list[Square] | None:
    """Factor a quadratic form as L D L' and return the squares, or None if D has a negative entry."""
    squares: list[Square] = []
    form = dict(form)
    for place in sorted({p for pair in form for p in pair}, key=lambda p: (-len(p[1]), p)):
        pivot = form.get((place, place), Fraction(0))
        column = {p: c for (p, q), c in form.items() if q == place and c}
        if not column:
            continue
        if pivot <= 0 or any(form.get((place, p), 0) != c for p, c in column.items()):
            return None
        for p, c in column.items():
            for q, d in column.items():
                form[p, q] = form.get((p, q), Fraction(0)) - c * d / pivot
        rows: list[dict[Key, Fraction]] = [{} for _ in claim]
        for (i, u), c in column.items():
            rows[i][(), u] = c / pivot
        factor = tuple((Poly(terms, claim[i][i].rows, core.rows),) for i, terms in enumerate(rows))
        squares.append(Square(pivot, scalars, factor, fact))
    return squares


# ------------------------------------------------------------------------------------------------ Schur complements
def schur_complement(grid: Grid, inverse: Poly, alphabet: Alphabet) -> Grid:
    """Return X - Y Z^-1 Y' of [[X, Y], [Y', Z]], where Z is the last block and ``inverse`` stands for Z^-1."""
    last = len(grid) - 1
    column = [row[last] for row in grid[:last]]
    return tuple(
        tuple(grid[i][j] - column[i] * inverse * alphabet.transpose(column[j]) for j in range(last))
        for i in range(last)
    )


def schur_squares(grid: Grid, inverse: Poly, complement: str, corner: str) -> tuple[Square, Square]:
    """Return the squares of the block factorisation L D L' of [[X, Y], [Y', Z]].

    G = [I; 0] (X - Y Z^-1 Y') [I 0] + [Y Z^-1; I] Z [Z^-1 Y' I]

    Args:
        grid: the symmetric block matrix G; Z is its last block.
        inverse: the letter for Z^-1.
        complement: name of the fact that the Schur complement is >= 0.
        corner: name of the fact that Z is >= 0.
    """
    last = len(grid) - 1
    sizes = [row[i].rows for i, row in enumerate(grid)]
    top = tuple(
        tuple(identity(sizes[i]) if i == k else Poly({}, sizes[i], sizes[k]) for k in range(last))
        for i in range(last + 1)
    )
    side = (*((row[last] * inverse,) for row in grid[:last]), (identity(sizes[last]),))
    return Square(Fraction(1), (), top, complement), Square(Fraction(1), (), side, corner)


# ------------------------------------------------------------------------------------------------ comparison
def prove_comparison(
    kind: str, claim: Poly, matrix: Poly, stable: str, forcing: str, context: Context, *, seconds: float = 5.0
) -> Comparison | None:
    """Search for a proof of D >= 0 by comparison.

    lyapunov: M D + D M' + F = 0, M Hurwitz;  stein: M D M' - D + F = 0, M Schur;  transient: dD/dt = M D + D M' + F,
    D(t0) >= 0.  F >= 0 throughout.

    Args:
        kind: 'lyapunov', 'stein' or 'transient'.
        claim: D.
        matrix: M.
        stable: name of the fact that M is Hurwitz or Schur, or of the fact 'initial' on D.
        forcing: name of the fact F >= 0.
        context: relations, facts and derivatives.
        seconds: bound on the time.
    """
    flip, forces = context.alphabet.transpose, context.facts.get(forcing)
    if forces is None or len(forces.matrix) != 1:
        return None
    f = forces.matrix[0][0]
    try:
        equation = matrix * claim * flip(matrix) - claim + f
        if kind != "stein":
            equation = matrix * claim + claim * flip(matrix) + f
        if kind == "transient":
            equation = equation - differentiate(claim, context)
        certificate = prove(equation, context.relations, context.alphabet, seconds=seconds)
        if certificate is None:
            return None
        proof = Comparison(kind, claim, matrix, stable, forcing, certificate.terms)
        replay_comparison(proof, claim, context)
    except Rejected:
        return None
    return proof
