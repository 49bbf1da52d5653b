"""Every kind of edit to every certificate of the theorem table: rejected unless it changes nothing.

What an edited addend amounts to is expanded here by code that shares nothing with the kernel.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.kernel import Alphabet, Certificate, Poly, Rejected, Term, replay
from derive.matrix.search import prove
from tests.reference.theorems import Theorem, theorems

TRUE = [t for t in theorems() if t.true and t.provable]


def turned(letter: str, alphabet: Alphabet) -> str:
    """Transpose a letter."""
    if alphabet.letters[letter.rstrip("'")].symmetric:
        return letter
    return letter[:-1] if letter.endswith("'") else letter + "'"


def expand(terms: tuple[Term, ...], theorem: Theorem) -> Counter:
    """Return the sum of the addends, by (scalars, word); under a trace by the least rotation or transposition."""
    total: Counter = Counter()
    problem = theorem.hypotheses
    for t in terms:
        relation = problem.relations[t.relation]
        for (scalars, word), c in relation.terms.items():
            inner = tuple(turned(a, problem.alphabet) for a in reversed(word)) if t.transposed else word
            full = (*t.left, *inner, *t.right)
            if theorem.trace and full:
                both = (full, tuple(turned(a, problem.alphabet) for a in reversed(full)))
                full = min(w[i:] + w[:i] for w in both for i in range(len(w)))
            total[tuple(sorted((*scalars, *t.scalars))), full] += c * t.coefficient
    return Counter({k: c for k, c in total.items() if c})


def edits(terms: tuple[Term, ...], theorem: Theorem, generator: random.Random):
    """Iterate over changed lists of addends."""
    i = generator.randrange(len(terms))
    t, rest = terms[i], terms[:i] + terms[i + 1 :]
    letters = list(theorem.hypotheses.alphabet.letters)
    others = [name for name in theorem.hypotheses.relations if name != t.relation]
    letter = generator.choice(letters) + generator.choice(("", "'"))
    swapped = t.left[:-2] + t.left[-2:][::-1]
    yield rest
    yield (*terms, t)
    yield (*rest, replace(t, coefficient=t.coefficient + 1))
    yield (*rest, replace(t, coefficient=-t.coefficient))
    yield (*rest, replace(t, coefficient=t.coefficient * Fraction(1, 2)))
    yield (*rest, replace(t, transposed=not t.transposed))
    yield (*rest, replace(t, left=swapped))
    yield (*rest, replace(t, left=t.right, right=t.left))
    yield (*rest, replace(t, left=t.left[1:]))
    yield (*rest, replace(t, right=t.right[:-1]))
    yield (*rest, replace(t, left=(*t.left, letter)))
    yield (*rest, replace(t, right=(letter, *t.right)))
    yield (*rest, replace(t, relation="undeclared"))
    yield (*rest, replace(t, scalars=(*t.scalars, "undeclared")))
    if others:
        yield (*rest, replace(t, relation=generator.choice(others)))


@pytest.mark.parametrize("theorem", [t for t in TRUE if t.claim.terms], ids=lambda t: t.name)
def test_no_edit_of_a_certificate_is_accepted(theorem):
    problem, generator = theorem.hypotheses, random.Random(theorem.name)
    certificate = prove(theorem.claim, problem.relations, problem.alphabet, trace=theorem.trace)
    if not certificate.terms:
        return
    value = expand(certificate.terms, theorem)
    for _ in range(3):
        for terms in edits(certificate.terms, theorem, generator):
            declared = all(t.relation in problem.relations for t in terms)
            changed = replace(certificate, terms=terms)
            if declared and expand(terms, theorem) == value:
                continue
            with pytest.raises(Rejected):
                replay(changed, theorem.claim, problem.relations, problem.alphabet)


@pytest.mark.parametrize("theorem", TRUE, ids=lambda t: t.name)
def test_a_certificate_of_another_claim_is_rejected(theorem):
    problem = theorem.hypotheses
    certificate = prove(theorem.claim, problem.relations, problem.alphabet, trace=theorem.trace)
    for key in [*theorem.claim.terms, ((), ())]:
        if theorem.claim.rows != theorem.claim.cols and key == ((), ()):
            continue
        terms = {**theorem.claim.terms, key: theorem.claim.terms.get(key, Fraction(0)) + 1}
        other = Poly(terms, theorem.claim.rows, theorem.claim.cols)
        with pytest.raises(Rejected, match="another claim"):
            replay(certificate, other, problem.relations, problem.alphabet)
        with pytest.raises(Rejected, match="do not make up the claim"):
            replay(Certificate(other, certificate.terms, theorem.trace), other, problem.relations, problem.alphabet)
