"""Fast encoding of words, and the monomial order that decides what rewrites to what.

A letter becomes one character, a word or a monomial of central scalars a string (scalars sorted), so that divisibility
is a substring search. Monomials are ordered by weight, then by word, then by scalars; every letter weighs 1, but a
letter X with a definition X - f weighs more than each word of f, and a letter to be eliminated more than any word
without it. This order is compatible with products, so every rewriting ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from derive.kernel import Alphabet, Poly, Scalars, Word, parts, times_of

__all__ = ["Codec", "Encoded", "Monomial", "Number", "divide", "join", "weigh"]

Monomial = tuple[str, str]  # scalars, word
Number = int | Fraction
Encoded = dict[Monomial, Number]
HEAVY = 1_000_000  # weight of a letter to be eliminated


def join(m: str, n: str) -> str:
    """Multiply two encoded monomials of central scalars."""
    return "".join(sorted(m + n)) if m and n else m or n


def divide(m: str, n: str) -> str | None:
    """Return m / n for encoded monomials of central scalars, or None if n does not divide m."""
    if not n:
        return m
    rest = list(m)
    for s in n:
        if s not in rest:
            return None
        rest.remove(s)
    return "".join(rest)


@dataclass
class Codec:
    """The letters and scalars of one problem as characters, with their weights, types and times."""

    alphabet: Alphabet
    weights: Mapping[str, int]
    letters: dict[str, str] = field(default_factory=dict[str, str])
    names: dict[str, str] = field(default_factory=dict[str, str])
    weight: dict[str, int] = field(default_factory=dict[str, int])
    keys: dict[Monomial, tuple[int, str, int, str]] = field(default_factory=dict)

    def letter(self, name: str) -> str:
        """Return the character of a letter or scalar (later letters are larger in the order)."""
        found = self.letters.get(name)
        if found is None:
            found = self.letters[name] = chr(0x4E00 + len(self.letters))
            self.names[found] = name
            self.weight[found] = self.weights.get(parts(name)[0], 1)
        return found

    def encode(self, poly: Poly) -> Encoded:
        """Return the terms of a polynomial with encoded monomials, integers where the coefficients are integral."""
        return {
            ("".join(sorted(map(self.letter, m))), "".join(map(self.letter, w))): exact(c)
            for (m, w), c in poly.terms.items()
        }

    def decode(self, terms: Encoded, dimension: str) -> Poly:
        """Return the polynomial of encoded terms; its type is used for nothing but identities."""
        return Poly({(self.scalars(m), self.word(w)): c for (m, w), c in terms.items()}, dimension, dimension)

    def scalars(self, m: str) -> Scalars:
        """Return the names of encoded scalars, sorted as the kernel wants them."""
        return tuple(sorted(self.names[s] for s in m))

    def word(self, w: str) -> Word:
        """Return the letters of an encoded word."""
        return tuple(self.names[a] for a in w)

    def key(self, monomial: Monomial) -> tuple[int, str, int, str]:
        """Return the place of a monomial in the order."""
        found = self.keys.get(monomial)
        if found is None:
            m, w = monomial
            found = self.keys[monomial] = (sum(self.weight[a] for a in w), w, len(m), m)
        return found

    def flip(self, w: str) -> str:
        """Return the transpose of an encoded word."""
        return "".join(self.letter(self.alphabet.flip(self.names[a])) for a in reversed(w))

    def times(self, m: str, w: str) -> set[str]:
        """Return the times that occur in a monomial, bound or free."""
        return times_of(self.scalars(m), self.word(w))

    def rows(self, w: str) -> str:
        """Return the row dimension of a word that is not empty."""
        return self.alphabet.shape(self.names[w[0]])[0]

    def cols(self, w: str) -> str:
        """Return the column dimension of a word that is not empty."""
        return self.alphabet.shape(self.names[w[-1]])[1]

    def between(self, left: str, right: str, dimension: str) -> str:
        """Return the dimension between two words; between two empty ones it is the given one."""
        return self.cols(left) if left else self.rows(right) if right else dimension

    def typed(self, *words: str) -> bool:
        """Tell whether words may be multiplied in this order."""
        full = [w for w in words if w]
        return all(self.cols(v) == self.rows(w) for v, w in pairwise(full))


def exact(c):
    """Return an integral fraction as int, which computes faster."""
    return c.numerator if c.denominator == 1 else c


def weigh(relations: Mapping[str, Poly], eliminate: Sequence[str]) -> dict[str, int]:
    """Return weights such that defined letters rewrite to their definitions and eliminated letters lead.

    A relation defines the letter X if X occurs in it once, alone and without scalars, and if no earlier definition
    leads from its other letters back to X.
    """
    weights = dict.fromkeys(eliminate, HEAVY)
    definitions: dict[str, Poly] = {}
    for relation in relations.values():
        name = _defined(relation, definitions, eliminate)
        if name:
            definitions[name] = relation
    pending = list(definitions)
    while pending:
        for name in pending:
            others = _letters(definitions[name]) - {name}
            if not others & set(pending):
                words = (w for _, w in definitions[name].terms if [parts(a)[0] for a in w] != [name])
                heaviest = max((sum(weights.get(parts(a)[0], 1) for a in w) for w in words), default=0)
                weights[name] = max(weights.get(name, 1), heaviest + 1)
                pending.remove(name)
                break
    return weights


def _letters(poly: Poly) -> set[str]:
    return {parts(a)[0] for _, w in poly.terms for a in w}


def _defined(relation: Poly, definitions: Mapping[str, Poly], eliminate: Iterable[str]) -> str:
    occurrences = [parts(a)[0] for _, w in relation.terms for a in w]
    lone = [parts(w[0])[0] for m, w in relation.terms if len(w) == 1 and not m]
    free = [name for name in lone if occurrences.count(name) == 1 and name not in definitions]
    free = [name for name in free if name not in _reach(set(occurrences) - {name}, definitions)]
    return next((name for name in free if name in set(eliminate)), free[0] if free else "")


def _reach(names: set[str], definitions: Mapping[str, Poly]) -> set[str]:
    """Return the letters on which the given ones depend through definitions."""
    seen: set[str] = set()
    stack = list(names)
    while stack:
        name = stack.pop()
        if name not in seen:
            seen.add(name)
            stack += _letters(definitions[name]) - {name} if name in definitions else ()
    return seen
