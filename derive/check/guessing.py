"""Theories that nobody named: guessed from the letters of a document, and never the ground of a refutation alone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from derive.check.item import Item
from derive.check.judge import read_item
from derive.check.result import Result
from derive.claim import Answer, Verdict
from derive.errors import InputError

__all__ = ["guessed", "justified"]

LETTERS = re.compile(r"\\[A-Za-z]+|[A-Za-z]")


def guessed(items: Sequence[Item]) -> list[tuple[Item, str]]:
    """Return claims with the theory that their document seems to be written in, and what speaks for it."""
    groups: dict[tuple[str, str], list[Item]] = {}
    for item in items:
        if not (item.claim.theory or item.message):
            groups.setdefault(_group(item), []).append(item)
    found = {key: _guess(group) for key, group in groups.items()}
    return [_with(item, *found.get(_group(item), ("", ""))) for item in items]


def _group(item: Item) -> tuple[str, str]:
    """Return what the theory is guessed from: a whole document, or a claim that stands by itself."""
    alone = not item.claim.file or item.claim.file.endswith(".jsonl")
    return item.claim.file, item.claim.id if alone else ""


def _with(item: Item, key: str, why: str) -> tuple[Item, str]:
    if item.claim.theory or item.message:
        return item, ""
    return replace(item, claim=replace(item.claim, theory=key)), why


def _guess(items: Sequence[Item]) -> tuple[str, str]:
    """Return the key of a theory and what speaks for it; two empty texts if nothing does."""
    from derive.interpret.guess import guess

    displays = []
    for item in items:
        for latex in (item.claim.latex, *item.claim.assume):
            try:
                displays.append(read_item(item, latex))
            except InputError:
                continue
    return guess(displays, items[0].setting.notation) or ("", "")


def justified(results: Sequence[Result]) -> list[Result]:
    """Return results in which no refutation rests on a guess that nothing confirms.

    A guessed theory is confirmed for a claim when other claims of its document, proved from the theory's relations,
    use all its letters, and when at least as many are proved that way as refuted. Shapes that do not fit are no ground
    at all: what is a number in the document may be a matrix in the theory.
    """
    return [_confirmed(r, results) if r.guessed and r.verdict == "refuted" else r for r in results]


def _confirmed(result: Result, results: Sequence[Result]) -> Result:
    mine = [r for r in results if r.guessed and r.claim.file == result.claim.file]
    proved = [r for r in mine if r.verdict == "proved" and r.answer and r.answer.hypotheses_used]
    known = {letter for r in proved for letter in _letters(r)}
    if result.shapes and _letters(result) <= known and len(proved) >= sum(r.verdict == "refuted" for r in mine):
        return result
    key, answer = result.claim.theory, result.answer
    ground = f": {answer.counterexample or ' '.join(answer.notes)}" if answer else ""
    notes = (
        f"in {key}, which is a guess, it would be refuted{ground}",
        f"name the theory to have it decided: theory={key} in a comment of the document, or --theory {key}",
    )
    return replace(result, verdict="undecided", answer=Answer(Verdict.undecided, notes=notes))


def _letters(result: Result) -> set[str]:
    """Return the letters of a claim without accents and indices."""
    found = (LETTERS.findall(re.split(r"[_^]", name)[0]) for name in result.shapes)
    return {letters[-1] for letters in found if letters}
