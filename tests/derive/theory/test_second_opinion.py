"""A second opinion on the lectures: exact instances satisfy what is proved and refute what is changed.

An instance that refutes a changed statement satisfies the hypotheses of the step, so these are not contradictory.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from derive.derivation import claims, learn
from derive.kernel import Poly
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import unknowns
from derive.matrix.refute import refute
from derive.theory import LECTURES, lecture


def bearing_on(claim: Poly, step, reading) -> Hypotheses:
    """Return the relations of the step's certificates, with the inverses and facts about their letters."""
    every = Hypotheses.of(reading.context, reading.inverses)
    used = {t.relation for c in step.proof.identities for t in c.terms}
    relations = {n: p for n, p in every.relations.items() if n in used}
    letters = unknowns(claim).union(*map(unknowns, relations.values()))
    inverses = {n: p for n, p in every.inverses.items() if n in letters}
    letters = letters.union(*map(unknowns, inverses.values()))
    facts = {n: f for n, f in every.facts.items() if all(unknowns(p) <= letters for row in f.matrix for p in row)}
    return replace(every, relations=relations, inverses=inverses, facts=facts)


def algebraic(claim: Poly, problem: Hypotheses) -> bool:
    """Integrals and Dirac deltas have no value at an instance."""
    return not any(s[0] in "∫δ" for p in (claim, *problem.relations.values()) for m, _ in p.terms for s in m)


def statements(key: str):
    item = lecture(key)
    reading = item.theory.reading()
    for step in item.steps:
        if step.rule in ("identity", "trace"):
            for certificate in claims(step.statement, step.rule, reading):
                problem = bearing_on(certificate.claim, step, reading)
                if len(certificate.claim.terms) > 1 and algebraic(certificate.claim, problem):
                    yield step.name, certificate, problem
        reading = learn(reading, item.theory, step)


@pytest.mark.parametrize("key", [key for key in LECTURES if key not in ("scalar", "spectrum-dt")])  # about numbers
def test_a_doubled_term_is_refuted_and_the_statement_is_not(key):
    tried = 0
    for name, certificate, problem in statements(key):
        claim = certificate.claim
        zero = Poly({}, claim.rows, claim.cols)
        first = next(iter(claim.terms))
        changed = Poly({**claim.terms, first: 2 * claim.terms[first]}, claim.rows, claim.cols)
        assert refute(claim, zero, problem, trace=certificate.trace, seconds=0.05) is None, name
        assert refute(changed, zero, problem, trace=certificate.trace, seconds=5.0) is not None, name
        tried += 1
    assert tried >= 3
