"""What a matrix claim is decided under: types, equations, facts, and which letter is the inverse of what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.kernel import Alphabet, Poly
from derive.rules import Context, Fact

__all__ = ["Hypotheses"]


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
