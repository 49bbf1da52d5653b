"""Read a formula in a theory, as the tests of this folder do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from derive.interpret import Statement, understand
from derive.latex.grammar import read
from derive.theory.claims import claim_theory


def meant(
    key: str, latex: str, assume: Sequence[str] = (), *, scalar: bool = False, notation: Mapping[str, str] | None = None
) -> Statement:
    """Return what a formula says; its theory comes into force."""
    given = [read(a) for a in assume]
    found = understand(read(latex), claim_theory(key), assume=given, scalar=scalar, notation=notation)
    assert found.theory.reading.adopted == found.theory.theory.declared.keys()
    return found
