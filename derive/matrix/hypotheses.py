"""What a matrix claim is decided under: types, equations, facts, and which letter is the inverse of what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.kernel import Alphabet, Poly, at_time
from derive.rules import Context, Fact

__all__ = ["Hypotheses", "at_start"]


@dataclass(frozen=True)
class Hypotheses:
    """The hypotheses of a claim.

    relations hold exactly; a fact says that a matrix (block by block) is 'psd', 'pd', 'hurwitz', 'schur' or
    'invertible'; ``inverses`` names for a letter the polynomial of which it is the two-sided inverse; the scalars
    in ``nonnegative`` are >= 0.
    """

    alphabet: Alphabet
    relations: Mapping[str, Poly] = field(default_factory=dict[str, Poly])
    facts: Mapping[str, Fact] = field(default_factory=dict[str, Fact])
    inverses: Mapping[str, Poly] = field(default_factory=dict[str, Poly])
    nonnegative: frozenset[str] = frozenset()

    @classmethod
    def of(cls, context: Context, inverses: Mapping[Poly, str]) -> Hypotheses:
        """Return the hypotheses that a reading stands for; ``inverses`` gives the letter by the polynomial."""
        letters = {name: poly for poly, name in inverses.items()}
        return cls(context.alphabet, context.relations, context.facts, letters, context.nonnegative)

    def at_start(self) -> Hypotheses:
        """Return what the hypotheses say at t = t0, where every integral from t0 to t vanishes."""
        facts = {
            name: Fact("psd" if f.kind == "initial" else f.kind, tuple(tuple(map(at_start, row)) for row in f.matrix))
            for name, f in self.facts.items()
        }
        relations = {name: at_start(p) for name, p in self.relations.items()}
        inverses = {_letter_at_start(name): at_start(p) for name, p in self.inverses.items()}
        return Hypotheses(self.alphabet, relations, facts, inverses, self.nonnegative)


def at_start(poly: Poly) -> Poly:
    """Return the value of a polynomial at t = t0."""
    kept = {k: c for k, c in poly.terms.items() if not any(s.startswith("∫") for s in k[0])}
    return at_time(Poly(kept, poly.rows, poly.cols), "t", "t0")


def _letter_at_start(name: str) -> str:
    (((_, (letter,)), _),) = at_time(Poly({((), (name,)): 1}, "", ""), "t", "t0").terms.items()
    return letter
