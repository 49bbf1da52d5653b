"""The checker on the corpus: no wrong verdict, nearly all decided, and every notation means the same."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import derive
from derive.claim import Claim
from derive.errors import InputError
from derive.interpret import Misfit, understand
from derive.latex.grammar import read
from derive.theory.claims import claim_theory
from tests.reference.corpus import Entry, entries, notations

DECIDED = 0.97
TOLD = {"proved": True, "refuted": False}


@cache
def verdicts() -> Sequence[tuple[Entry, str]]:
    """Return what the checker says of every entry, in its first notation."""
    given = list(entries())
    claims = [Claim(e.latex, e.theory, e.assume, e.scalar, file="corpus") for e in given]
    return list(zip(given, (r.verdict for r in derive.check(claims, jobs=2).results), strict=True))


def test_no_verdict_is_wrong() -> None:
    wrong = [(e.theory, e.latex, e.assume, said) for e, said in verdicts() if TOLD.get(said, e.truth) != e.truth]
    assert wrong == []


def test_nearly_all_are_decided() -> None:
    said = [said for _, said in verdicts()]
    assert sum(s in TOLD for s in said) >= DECIDED * len(said)


def _meaning(latex: str, entry: Entry) -> object:
    given = [read(a) for a in entry.assume]
    try:
        return understand(read(latex), claim_theory(entry.theory), assume=given, scalar=entry.scalar).equations
    except Misfit as error:
        return type(error)


def test_every_notation_means_the_same() -> None:
    """Bold letters, upright transposes and loose brackets change nothing."""
    different = []
    for entry in entries():
        try:
            first, *others = (_meaning(latex, entry) for latex in notations(entry.latex))
        except InputError as error:
            different.append((entry.latex, str(error)))
            continue
        different += [(entry.latex, str(other)) for other in others if other != first]
    assert different == []


def test_an_explanation_changes_no_verdict() -> None:
    """A claim that stands by itself, outside a document, is told which hypotheses it needs."""
    moments = [(e, said) for e, said in verdicts() if "mathbb{E}" in e.latex or e.theory == "observer-ct"]
    assert len(moments) > 20
    claims = [Claim(e.latex, e.theory, e.assume, e.scalar) for e, _ in moments]
    assert [r.verdict for r in derive.check(claims).results] == [said for _, said in moments]
