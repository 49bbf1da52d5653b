"""What a theory lets a claim use: typed symbols under the names that people write, and a few proved relations.

A lecture derives; a claim is decided from the lecture's results. Each relation here is a definition or hypothesis of
the lecture's theory, or one of its proved steps, and says which.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.context import Theory
from derive.terms import Term


@dataclass(frozen=True)
class ClaimTheory:
    """The theory that claims are read in.

    ``theory`` holds the symbols and declares what may be used; ``names`` gives the meaning of a spelled name (letter,
    accents, index: see derive.interpret.names); ``optimal`` are the declarations that hold for the optimal gain only;
    ``proved_by`` names, for a declaration that the source does not make, the lecture and the step that proves it.
    """

    key: str
    title: str
    theory: Theory
    names: Mapping[str, Term]
    optimal: frozenset[str] = frozenset()
    proved_by: Mapping[str, tuple[str, str]] = field(default_factory=dict[str, tuple[str, str]])
