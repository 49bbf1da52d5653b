"""Which hypotheses bear on a claim: those that share letters with it, directly or through others.

A relation that merely defines a letter which occurs nowhere else constrains nothing, and is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from derive.kernel import Poly, parts
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import base, unknowns
from derive.rules import Fact

__all__ = ["Bearing", "bearing", "lone"]


@dataclass(frozen=True)
class Bearing:
    """The hypotheses that bear on a claim, and all letters in them and in the claim; central ones are on scalars."""

    relations: Mapping[str, Poly]
    central: Mapping[str, Poly]
    facts: Mapping[str, Fact]
    inverses: Mapping[str, Poly]
    letters: frozenset[str]

    def scalars(self) -> set[str]:
        """Return the central scalars that occur."""
        polys = chain(self.relations.values(), self.central.values(), self.inverses.values())
        facts = (p for f in self.facts.values() for p in blocks(f))
        return {s for p in chain(polys, facts) for m, _ in p.terms for s in m}


def bearing(problem: Hypotheses, wanted: set[str]) -> Bearing:
    """Return the hypotheses that bear on the wanted letters."""
    relations, inverses = _peel(problem, wanted)
    facts = {n: f for n, f in problem.facts.items() if f.kind != "initial"}
    known = {n: unknowns(p) for n, p in relations.items()}
    groups: list[set[str]] = list(known.values())
    groups += [set[str]().union(*map(unknowns, blocks(f))) for f in facts.values()]
    groups += [unknowns(p) | {name} for name, p in inverses.items()]
    letters, size = set(wanted), -1
    while size != len(letters):
        size = len(letters)
        for group in groups:
            if group & letters:
                letters |= group
    return Bearing(
        {n: p for n, p in relations.items() if known[n] & letters},
        {n: p for n, p in problem.relations.items() if not unknowns(p)},
        {n: f for n, f in facts.items() if any(unknowns(p) & letters for p in blocks(f))},
        {n: p for n, p in inverses.items() if n in letters},
        frozenset(letters),
    )


def blocks(fact: Fact) -> list[Poly]:
    """Return the blocks of a fact's matrix."""
    return [p for row in fact.matrix for p in row]


def lone(poly: Poly) -> list[str]:
    """Return the letters that occur once, as a term of their own without scalars."""
    occurrences = [base(a) for _, w in poly.terms for a in w]
    return [base(w[0]) for m, w in poly.terms if len(w) == 1 and not m and occurrences.count(base(w[0])) == 1]


def _peel(problem: Hypotheses, wanted: set[str]) -> tuple[dict[str, Poly], dict[str, Poly]]:
    """Leave out relations and inverses that only define a letter which occurs nowhere else."""
    inverses = dict(problem.inverses)
    implied = {f for name, poly in inverses.items() for f in _inverse_relations(problem, name, poly)}
    relations = {n: p for n, p in problem.relations.items() if p not in implied and unknowns(p)}
    fixed = wanted | {a for f in problem.facts.values() for p in blocks(f) for a in unknowns(p)}
    letters = {p: unknowns(p) for p in chain(relations.values(), inverses.values())}
    while True:
        counts: dict[str, int] = {}
        for a in chain(*(letters[p] for p in chain(relations.values(), inverses.values()))):
            counts[a] = counts.get(a, 0) + 1
        gone = [n for n in inverses if n not in fixed and n not in counts]
        for n in gone:
            del inverses[n]
        done = next((n for n, p in relations.items() if _defines_unused(p, counts, fixed, problem)), None)
        if done is not None:
            del relations[done]
        elif not gone:
            return relations, inverses


def _inverse_relations(problem: Hypotheses, name: str, poly: Poly) -> list[Poly]:
    """Return both relations of an inverse, as they are declared and transposed."""
    letter = Poly({((), (name,)): 1}, poly.cols, poly.rows)
    one = Poly({((), ()): 1}, poly.rows, poly.rows)
    both = [poly * letter - one, letter * poly - one]
    return both + [problem.alphabet.transpose(p) for p in both]


def _defines_unused(poly: Poly, counts: Mapping[str, int], fixed: set[str], problem: Hypotheses) -> bool:
    """Tell whether a relation only gives a value to a letter that nothing else mentions.

    The variation of constants e(t) = Phi(t,t0) e(t0) + (an integral) does so for e(t0), as Phi(t,t0) is invertible.
    """
    if any(s.startswith("∫") for m, _ in poly.terms for s in m):
        starts = [w[1] for m, w in poly.terms if not m and len(w) == 2 and parts(w[0])[2] == ("t", "t0")]
        return any(parts(a)[2] == ("t0",) and a not in fixed and counts.get(a) == 1 for a in starts)
    for letter in lone(poly):
        symmetric = problem.alphabet.letters[parts(letter)[0]].symmetric
        free = letter not in fixed and letter not in problem.inverses and counts[letter] == 1
        if free and (not symmetric or problem.alphabet.transpose(poly) in (poly, -poly)):
            return True
    return False
