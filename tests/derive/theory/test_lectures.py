"""Every lecture replays; no mutated statement does; what each step rests on is pinned."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path

import pytest

from derive.derivation import claims
from derive.kernel import Rejected
from derive.matrix.search import prove
from derive.theory import LECTURES, lecture
from tests.derive.theory.mutants import judged, mutants, outcomes, walk

PINNED = Path(__file__).parents[2] / "reference" / "relations.json"
# steps whose rule accepts other statements; test_spectrum.py evaluates these, and they are true
TRUE_AS_WELL = {
    ("spectrum", "det V > 0"): "V is symmetric",
    ("spectrum", "trace below"): "V and P are symmetric",
    ("spectrum", "trace above"): "V and P are symmetric",
    ("spectrum", "the resolvent vanishes"): "whatever stands beside the resolvent",
    ("spectrum", "limit of s tr L"): "the trace is cyclic",
}


@pytest.mark.parametrize("key", LECTURES)
def test_every_step_replays(key):
    assert [o for o in outcomes(key) if not o.accepted] == []
    assert len(outcomes(key)) >= 10


@pytest.mark.parametrize("key", LECTURES)
def test_no_mutated_statement_replays(key):
    """A mutant that is read as the step itself is the step; others are rejected, or true as well."""
    found = judged(key)
    assert sum(not same for _, _, same, _ in found) > 100
    wrong = [(step.name, str(other)) for step, other, same, accepted in found if accepted and not same]
    assert [(name, other) for name, other in wrong if (key, name) not in TRUE_AS_WELL] == []


@pytest.mark.parametrize("key", LECTURES)
def test_no_mutated_statement_is_proved(key):
    """The search finds no certificate for a mutant from all that the theory and the lemmas before it offer."""
    rng, candidates = random.Random(7), []
    for step, reading, _ in walk(key):
        if step.rule != "identity" or not step.number:
            continue
        for other in mutants(step.statement.rhs):
            statement = replace(step.statement, rhs=other)
            try:
                wanted = claims(statement, step.rule, reading)
            except Rejected:
                continue
            if [c.claim for c in wanted] != [c.claim for c in claims(step.statement, step.rule, reading)]:
                candidates.append((statement, wanted, reading, step))
    for statement, wanted, reading, step in rng.sample(candidates, min(12, len(candidates))):
        names = {r for c in step.proof.identities for t in c.terms for r in (t.relation,)}
        relations = {k: v for k, v in reading.context.relations.items() if k in names}
        found = [prove(c.claim, relations, reading.context.alphabet, seconds=0.3) for c in wanted]
        assert None in found, statement


@pytest.mark.parametrize("key", LECTURES)
def test_nothing_that_is_derived_was_declared(key):
    """No numbered equation is a hypothesis of the theory; it may fold a definition."""
    item = lecture(key)
    relations = item.theory.reading().context.relations
    hypotheses = {n for n, d in item.theory.declared.items() if getattr(d, "kind", "") == "hypothesis"}
    chosen = {
        "stationary start",  # the initial value that the source prescribes: a choice, not a result
        "output error covariance",  # of the lecture on the frequency domain: equation (4), proved in that on the filter
    }
    declared = [p for n, p in relations.items() if n.partition("[")[0] in hypotheses - chosen]
    for step, reading, _ in walk(key):
        if step.number and step.rule in ("identity", "trace"):
            for c in claims(step.statement, step.rule, reading):
                assert not c.claim.terms or all(c.claim not in (r, -r) for r in declared), step.name


def test_what_each_step_rests_on_is_pinned():
    """Change tests/reference/relations.json only when a derivation really rests on something else."""
    found = {key: {s.name: sorted(s.uses) for s in lecture(key).steps} for key in LECTURES}
    assert found == json.loads(PINNED.read_text(encoding="utf-8"))


def test_numbered_equations_of_the_sources_are_reached():
    wanted = {
        "observer": {"u1", "u2", "31.10", "u3", "u4", "u5", "u6"},
        "covariance": {"u1", "u2", "u3", "u4", "u5", "u6", "u7", "u8"},
        "kalman-bucy": {"1", "2", "3", "4", "13", "16"},
        "luenberger": {"1", "2", "3", "4", "5"},
    }
    for key, numbers in wanted.items():
        item = lecture(key)
        rows = [r for i in item.items if hasattr(i, "rows") for r in i.rows]
        reached = {s.number for s in item.steps} | {r.number for r in rows}
        assert numbers <= reached, key
