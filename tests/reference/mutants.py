"""False variants of true theorems: one term of the claim deleted, negated or doubled."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

from derive.kernel import Poly
from tests.reference.theorems import Theorem


def mutate(claim: Poly, generator: random.Random) -> Poly:
    """Delete, negate or double one term."""
    key = generator.choice(sorted(claim.terms))
    factor = generator.choice((0, -1, 2))
    return Poly({**claim.terms, key: claim.terms[key] * factor}, claim.rows, claim.cols)


def mutants(theorems: Sequence[Theorem], seed: int = 5, each: int = 4) -> list[Theorem]:
    """Return variants of every true theorem that is not an identity of the free algebra."""
    generator = random.Random(seed)
    return [
        replace(t, name=f"{t.name}, mutant {i + 1}", claim=mutate(t.claim, generator), true=False)
        for t in theorems
        if t.true and t.claim.terms
        for i in range(each)
    ]
