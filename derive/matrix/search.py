"""Proof search: is the claim a combination of the declared relations? The answer is a certificate for the kernel."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from fractions import Fraction

from derive.kernel import Alphabet, Certificate, Poly, Term, bound, sample
from derive.matrix.completion import Completion, Step, accumulate
from derive.matrix.order import Codec, Encoded, weigh

__all__ = ["declare", "prove"]

ROUNDS = 100  # of rotation under a trace, or of sampling by deltas
TRACE = "@"  # tr I of a dimension as a letter: "@n"


def prove(
    claim: Poly,
    relations: Mapping[str, Poly],
    alphabet: Alphabet,
    *,
    trace: bool = False,
    eliminate: Sequence[str] = (),
    max_degree: int = 12,
    overlaps: int | None = None,
    seconds: float = 5.0,
) -> Certificate | None:
    """Search for a proof of claim = 0 (under a trace: tr claim = 0).

    claim = sum c_i * m_i * l_i * r_i * s_i, r_i a relation or its transpose

    The relations and their transposes are completed to a rewriting system until the claim rewrites to zero. Letters
    with a definition X - f rewrite to it. What is found is returned for every dimension at once; None says that
    nothing was found, not that the claim is false.

    Args:
        claim: the polynomial to be shown zero.
        relations: polynomials that are zero, by name.
        alphabet: letters and central scalars.
        trace: compare words up to rotation and transposition.
        eliminate: letters to be removed first, e.g. the unknown of an equation.
        max_degree: bound on letters and scalars of an overlap.
        overlaps: bound on the number of overlaps that are resolved, the same on every machine.
        seconds: bound on the time.

    Source: T. Mora, An introduction to commutative and noncommutative Groebner bases, 1994; J. Helton, M. Stankus,
    Computer assistance for "discovering" formulas in system engineering and operator theory, 1999.

    Example:
        >>> from derive.kernel import Letter, identity, replay
        >>> letters = Alphabet({x: Letter(x, "n", "n") for x in ("A", "B")})
        >>> one = identity("n")
        >>> word = lambda *w: Poly({((), w): 1}, "n", "n")
        >>> relations = {"AB = I": word("A", "B") - one, "BA = I": word("B", "A") - one}
        >>> claim = word("A", "B", "A", "B") - one
        >>> replay(prove(claim, relations, letters), claim, relations, letters)
    """
    deadline = time.monotonic() + seconds
    codec = Codec(alphabet, weigh(relations, eliminate))
    goal: Encoded = codec.encode(claim)
    completion = Completion(codec, max_degree, gaps=_gaps(goal, relations, codec))
    origin = declare(completion, relations)
    sizes = _by_size(goal, claim.rows, codec) if trace else {claim.rows: goal}
    steps: list[Step] = []
    resolved = 0
    while True:
        for size, poly in sizes.items():
            sizes[size], used = _reduce(completion, poly, size)
            steps += used
        rest, more = _cyclic(completion, sizes) if trace else (sizes[claim.rows], [])
        if not rest:
            return Certificate(claim, _terms(completion, steps + more, origin), trace)
        grown = False
        while not grown:
            grown, resolved = completion.resolve(), resolved + 1
            if grown is None or resolved == overlaps or time.monotonic() > deadline:
                return None


def _reduce(completion: Completion, poly: Encoded, dimension: str) -> tuple[Encoded, list[Step]]:
    """Reduce; where a Dirac delta is left, let it sample its factors, as the kernel does, and reduce again."""
    codec, steps = completion.codec, list[Step]()
    for _ in range(ROUNDS):
        poly, used = completion.reduce(poly, dimension)
        steps += used
        if not any(codec.names[s].startswith("δ") for m, _ in poly for s in m):
            break
        sampled = codec.encode(sample(codec.decode(poly, dimension)))
        if sampled == poly:
            break
        poly = sampled
    return poly, steps


def declare(completion: Completion, relations: Mapping[str, Poly]) -> dict[int, tuple[str, bool]]:
    """Add the relations and their transposes, smallest first; return the name behind each node."""
    codec, sources = completion.codec, []
    for name, relation in relations.items():
        turned = codec.alphabet.transpose(relation)
        binds = {s for m, _ in relation.terms for s in bound(m)}
        for transposed, poly in enumerate([relation] if turned in (relation, -relation) else [relation, turned]):
            encoded = codec.encode(poly)
            if encoded:
                sources.append(
                    (max(map(codec.key, encoded)), len(sources), name, bool(transposed), poly, encoded, binds)
                )
    origin: dict[int, tuple[str, bool]] = {}
    for _, _, name, transposed, poly, encoded, binds in sorted(sources):
        origin[completion.declare(encoded, binds, poly.rows)] = name, transposed
    return origin


def _gaps(goal: Encoded, relations: Mapping[str, Poly], codec: Codec) -> tuple[str, ...]:
    """Return the words that may stand between two rules that meet in their scalars: those within the claim."""
    if not any(m for relation in relations.values() for m, _ in relation.terms):
        return ("",)
    inside = {w[i:j] for _, w in goal for i in range(len(w)) for j in range(i, len(w))}
    return tuple(sorted(inside | {""}, key=lambda w: (len(w), w)))


def _terms(completion: Completion, steps: list[Step], origin: Mapping[int, tuple[str, bool]]) -> tuple[Term, ...]:
    codec = completion.codec
    return tuple(
        Term(Fraction(c), codec.scalars(m), codec.word(left), *origin[node], codec.word(right))
        for c, m, left, node, right in completion.expand(steps)
    )


# ------------------------------------------------------------------------------------------------ under a trace
def _by_size(poly: Encoded, dimension: str, codec: Codec) -> dict[str, Encoded]:
    """Sort the words under a trace by their number of rows; the identity has that of the claim."""
    sizes: dict[str, Encoded] = {}
    for (m, w), c in poly.items():
        sizes.setdefault(codec.rows(w) if w else dimension, Encoded())[m, w] = c
    return sizes


def _cyclic(completion: Completion, sizes: Mapping[str, Encoded]) -> tuple[Encoded, list[Step]]:
    """Return what is left of a trace when words may also be rotated and transposed, and the steps subtracted."""
    poly, steps = Encoded(), list[Step]()
    for size, words in sizes.items():
        for (m, w), c in words.items():
            accumulate(poly, (m, w or completion.codec.letter(TRACE + size)), c)
    for _ in range(ROUNDS):
        turned, used = _turn(completion, poly)
        steps += used
        if turned == poly:
            break
        poly = turned
    return poly, steps


def _turn(completion: Completion, poly: Encoded) -> tuple[Encoded, list[Step]]:
    """Reduce each word after a rotation or transposition to which a rule applies; else take the least of them."""
    codec, out, steps = completion.codec, Encoded(), list[Step]()
    for (m, w), c in poly.items():
        if codec.names[w[0]].startswith(TRACE):
            accumulate(out, (m, w), c)
            continue
        turns = sorted({v[i:] + v[:i] for v in (w, codec.flip(w)) for i in range(len(w))})
        start = next((v for v in turns if completion.find(m, v, codec.rows(v))), turns[0])
        rest, used = completion.reduce({(m, start): c}, codec.rows(start))
        steps += used
        for (n, v), d in rest.items():
            accumulate(out, (n, v or codec.letter(TRACE + codec.rows(start))), d)
    return out, steps
