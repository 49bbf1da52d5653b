"""Every formula of the four sources, and every claim of the corpus, has a meaning or the wrong shapes."""

from __future__ import annotations

import json
from importlib.resources import files

import pytest

from derive.interpret import Misfit, echo, shapes
from tests.derive.interpret.reading import meant
from tests.reference.corpus import entries

UNNAMED = {  # an extreme eigenvalue is shown without its matrix
    "001-26", "001-27", "001-27-true", "001-28", "001-28-true",
}  # fmt: skip
SOURCES = ("fang-2018", "luenberger-notes", "observer-notes", "vander-velde-2004")


@pytest.mark.parametrize("source", SOURCES)
def test_every_formula_of_a_source_is_understood(source: str):
    text = (files("derive.check") / "sources" / f"{source}.jsonl").read_text(encoding="utf-8")
    for claim in map(json.loads, text.splitlines()):
        found = meant(claim["theory"], claim["latex"], claim.get("assume", ()), scalar=claim.get("scalar", False))
        assert echo(found), claim["id"]
        if claim["id"] not in UNNAMED:
            again = meant(claim["theory"], echo(found), claim.get("assume", ()), scalar=claim.get("scalar", False))
            assert echo(again) == echo(found), claim["id"]
        assert len(shapes(found)) == len({s.name + str(s.args) for s in found.symbols}), claim["id"]


def test_every_claim_of_the_corpus_is_understood():
    wrong: list[str] = []
    for entry in entries():
        try:
            found = meant(entry.theory, entry.latex, entry.assume, scalar=entry.scalar)
        except Misfit:
            wrong += [entry.latex] if entry.truth else []
        else:
            assert echo(meant(entry.theory, echo(found), entry.assume, scalar=entry.scalar)) == echo(found)
    assert wrong == []
