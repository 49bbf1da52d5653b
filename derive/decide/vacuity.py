"""Hypotheses that can be satisfied: an exact instance, or a contradiction."""

from __future__ import annotations

import time
from collections.abc import Iterable
from functools import lru_cache

from derive.decide.obligations import Undefined, Unjustified, justify_given
from derive.decide.order import prove_order
from derive.decide.workspace import Workspace
from derive.interpret.statement import Statement
from derive.kernel import Poly, Rejected, identity
from derive.matrix.refute import satisfy
from derive.rules import Grid
from derive.theory.claims.base import ClaimTheory

__all__ = ["contradictory", "satisfiable"]

VACUITY = 5.0  # seconds for an instance of the hypotheses


class Same:
    """A key by identity; a theory is never changed once it is made."""

    def __init__(self, theory: ClaimTheory):
        self.theory = theory

    def __hash__(self) -> int:
        return id(self.theory)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.theory is self.theory


def satisfiable(statement: Statement, polys: Iterable[Poly]) -> bool:
    """Tell whether an exact instance of the hypotheses was found, assumptions included."""
    theory = statement.theory
    context = theory.reading.context
    assumed = [p for name, p in context.relations.items() if name.partition("[")[0] in statement.assumed]
    facts = [
        p for name in statement.assumed if name in context.facts for row in context.facts[name].matrix for p in row
    ]
    known = set(context.alphabet.letters)
    letters = {a.replace("'", "") for p in [*polys, *assumed, *facts] for _, w in p.terms for a in w}
    scalars = {s for p in polys for m, _ in p.terms for s in m}
    return _has_instance(
        Same(theory), frozenset(a for a in letters if a.partition("@")[0] in known), frozenset(scalars)
    )


@lru_cache(maxsize=1024)
def _has_instance(key: Same, letters: frozenset[str], scalars: frozenset[str]) -> bool:
    work = Workspace(key.theory, time.monotonic() + VACUITY)
    try:
        justify_given(work)
    except (Undefined, Unjustified, Rejected):
        return False
    problem = work.problem()
    if problem is None:
        return False
    polys = [Poly({((), (a,)): 1}, *problem.alphabet.shape(a)) for a in sorted(letters)]
    polys += [identity("").scale(1, (s,)) for s in sorted(scalars) if s[0] not in "∫δ"]
    return satisfy(problem, polys, seconds=VACUITY) is not None


def contradictory(work: Workspace) -> bool:
    """Tell whether I = 0 follows, or M ≻ 0 for a matrix with -M ⪰ 0."""
    context = work.reading.context
    sizes = {letter.rows for letter in context.alphabet.letters.values()} - {"1"}
    if any(work.prove(identity(size)) for size in sorted(sizes)):
        return True
    for fact in list(context.facts.values()):
        strict = {"pd": False, "psd": True}.get(fact.kind)
        if strict is not None and len(fact.matrix) == 1:
            turned: Grid = ((-fact.matrix[0][0],),)
            if prove_order(turned, strict, work, depth=1):
                return True
    return False
