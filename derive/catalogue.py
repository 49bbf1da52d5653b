"""What is there: lectures and theories, and the displayed equations of each source with their verdict."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.derivation import Derived, Erratum, Given, Lecture
from derive.errors import InputError
from derive.theory import LECTURES, THEORIES, lecture, theory

__all__ = ["DOCUMENTS", "Entry", "document_key", "equations", "lectures", "theories"]

DOCUMENTS = {
    "000": ("observer-notes", "Lecture notes, Kalman filter as an observer (equations 31.x)"),
    "001": ("fang-2018", "Fang, Ishii, Chen, Johansson, arXiv:1807.08604 (2018)"),
    "002": ("luenberger-notes", "Optimal Luenberger observer (lecture notes)"),
    "004": ("vander-velde-2004", "Vander Velde, MIT 16.322, Lecture 23 (2004)"),
}

DERIVED_IN = {
    "000": ("observer",),
    "001": ("kalman-bucy", "scalar", "spectrum"),
    "002": ("luenberger",),
    "004": ("covariance",),
}  # the lectures that carry a source's equation numbers; no other one is built to list them


@dataclass
class Entry:
    """An equation of a source: what is said of it, where, and by how many steps."""

    document: str
    number: str
    lecture: str
    steps: int = 0
    findings: list[str] = field(default_factory=list[str])

    @property
    def verdict(self) -> str:
        """'refuted' if the source's formula is false, 'proved' if it is derived, else 'definition'."""
        return "refuted" if "false" in self.findings else "proved" if self.steps else "definition"

    def as_dict(self) -> dict[str, str | int]:
        """Return the entry as JSON data."""
        return {
            "document": self.document,
            "number": self.number,
            "verdict": self.verdict,
            "lecture": self.lecture,
            "steps": self.steps,
        }


def document_key(name: str) -> str:
    """Return the number of a source given its number or key.

    Raises:
        InputError: no such source.
    """
    known = {**{key: key for key in DOCUMENTS}, **{label: key for key, (label, _) in DOCUMENTS.items()}}
    if name not in known:
        raise InputError(f"document {name!r}: unknown; known are {', '.join(known)}")
    return known[name]


def equations(document: str) -> list[Entry]:
    """Return the displayed equations of a source in order; unnumbered ones are u1, u2, ..."""
    found: dict[str, Entry] = {}
    for key in DERIVED_IN[document]:
        current = lecture(key)
        for source, number, finding in _numbered(current):
            if (source or current.sources[0]) == document:
                entry = found.setdefault(number, Entry(document, number, key))
                if finding == "step":
                    entry.lecture = entry.lecture if entry.steps else key
                    entry.steps += 1
                else:
                    entry.findings.append(finding)
    return sorted(found.values(), key=lambda e: _order(e.number))


def _numbered(lecture: Lecture) -> Iterator[tuple[str, str, str]]:
    """Iterate over (source, number, 'given', 'step' or the finding) of all that carries an equation's number."""
    for item in lecture.items:
        if isinstance(item, Given):
            yield from ((row.source, row.number, "given") for row in item.rows if row.number)
        elif isinstance(item, Derived):
            yield from ((step.source, step.number, "step") for step in item.steps if step.number)
        elif isinstance(item, Erratum) and item.number:
            yield item.source, item.number, item.finding


def _order(number: str) -> tuple[bool, list[int]]:
    """Order numbers as in the source: numbered ones first, then u1, u2, ..."""
    return number.startswith("u"), [int(n) for n in re.findall(r"\d+", number)]


def lectures() -> list[dict[str, str | int]]:
    """Return every lecture with its theory, its steps, how many of them the kernel accepts, and its errata."""
    table: list[dict[str, str | int]] = []
    for key in LECTURES:
        current = lecture(key)
        table.append({
            "lecture": key,
            "title": current.title,
            "theory": current.theory.key,
            "steps": len(current.steps),
            "proved": sum(outcome.accepted for outcome in current.verify()),
            "errata": len(current.errata),
        })  # fmt: skip
    return table


def theories() -> list[dict[str, str | int]]:
    """Return every theory with the number of its symbols, definitions and hypotheses."""
    found = [theory(key) for key in THEORIES]
    return [
        {"theory": t.key, "title": t.title, "symbols": len(t.symbols), "declarations": len(t.declared)} for t in found
    ]
