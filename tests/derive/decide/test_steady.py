"""Answers do not depend on what was decided before, nor on how often; the corpus of claims gets its verdicts."""

from __future__ import annotations

import pytest

from derive.claim import Verdict
from derive.decide import decide
from derive.decide.kinds import is_matrix_claim
from derive.interpret import Misfit
from tests.derive.decide.reading import DT, KB, statement
from tests.reference.corpus import entries

SOME = [
    (r"L = P C^T (C P C^T + R)^{-1}", DT, ()),
    (r"P^+ = (P^{-1} + C^T R^{-1} C)^{-1}", DT, (r"P \succ 0",)),
    (r"P \succeq Q", DT, ()),
    (r"A P + P A^T + W + P C^T V^{-1} C P = 0", KB, ()),
    (r"P^{-1} P = I", DT, ()),
    (r"\mathbb{E}[e_k e_{k-1}^T] = (A - L_k C) P_{k-1}", DT, ()),
]


def test_the_order_of_claims_does_not_matter():
    forth = [decide(statement(*s)) for s in SOME]
    back = [decide(statement(*s)) for s in reversed(SOME)][::-1]
    assert forth == back
    assert forth == [decide(statement(*s)) for s in SOME]


@pytest.mark.parametrize("part", range(3))
def test_the_corpus(part):
    """Every claim between matrices is decided, none wrongly."""
    wrong: list[str] = []
    for entry in list(entries())[part::3]:
        if entry.scalar:
            continue
        try:
            found = statement(entry.latex, entry.theory, entry.assume)
        except Misfit:
            assert not entry.truth
            continue
        if is_matrix_claim(found):
            verdict = decide(found, near=False).verdict
            wrong += [entry.latex] * (verdict is not (Verdict.proved if entry.truth else Verdict.refuted))
    assert wrong == []
