"""Lectures as files: steps with their certificates, definitions and hypotheses by name, errata.

The theory is not in the file but named: symbols, definitions and hypotheses are the installed ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_type_hints

from derive._version import __version__
from derive.context import Declared, Theory
from derive.derivation import Erratum, Evidence, Given, GivenRow, Lecture, Step, Text
from derive.errors import InputError
from derive.latex import latex
from derive.serialise import Reader, step_from_json, step_to_json, to_json
from derive.terms import Equation, Symbol, walk
from derive.wellformed import a_dict, a_list, shown

__all__ = ["SCHEMA", "Document", "document_from_json", "document_to_json", "installed", "lecture_to_json"]

SCHEMA = "derive-derivation/1"


@dataclass(frozen=True)
class Document:
    """What a file holds: the steps of a lecture, its definitions and hypotheses by name, and its errata."""

    lecture: str
    title: str
    theory: Theory
    given: tuple[GivenRow, ...]
    steps: tuple[Step, ...]
    errata: tuple[Erratum, ...]


# ------------------------------------------------------------------------------------------------ writing
def plain(text: Text) -> str:
    """Return running text with its terms in LaTeX between dollar signs."""
    return "".join(part if isinstance(part, str) else f"${latex(part)}$" for part in text)


def lecture_to_json(lecture: Lecture) -> dict[str, Any]:
    """Return a lecture as JSON data of schema derive-derivation/1, its certificates included."""
    given = tuple(row for item in lecture.items if isinstance(item, Given) for row in item.rows)
    return document_to_json(
        Document(lecture.key, lecture.title, lecture.theory, given, lecture.steps, lecture.errata), __version__
    )


def document_to_json(document: Document, version: str) -> dict[str, Any]:
    """Return a document as JSON data of schema derive-derivation/1."""
    theory = document.theory
    return {
        "schema": SCHEMA,
        "version": version,
        "lecture": document.lecture,
        "theory": theory.key,
        "title": document.title,
        "symbols": sorted({
            node.name
            for item in (*document.given, *document.steps)
            for side in (item.statement.lhs, item.statement.rhs)
            for node in walk(side)
            if isinstance(node, Symbol)
        }),
        "given": [given_to_json(row, theory) for row in document.given],
        "steps": [step_to_json(s, theory, latex(s.statement), plain(s.reason)) for s in document.steps],
        "errata": [erratum_to_json(e, theory) for e in document.errata],
    }  # fmt: skip


def given_to_json(row: GivenRow, theory: Theory) -> dict[str, Any]:
    """Return a definition or hypothesis as it is shown."""
    return {
        "name": row.name,
        "kind": row.kind,
        "statement": to_json(row.statement, theory),
        "latex": latex(row.statement),
        "reason": plain(row.reason),
        "number": row.number,
        "source": row.source,
    }


def erratum_to_json(erratum: Erratum, theory: Theory) -> dict[str, Any]:
    """Return an erratum; what a source printed and the evidence are shown, not replayed."""
    printed = (erratum.printed,) if isinstance(erratum.printed, Equation) else erratum.printed
    return {
        "source": erratum.source,
        "number": erratum.number,
        "finding": erratum.finding,
        "printed": plain(printed),
        "text": plain(erratum.text),
        "evidence": [
            {key: [[plain((name,)), value] for name, value in getattr(e, key)] for key in ("values", "results")}
            for e in erratum.evidence
        ],
        "true": None if erratum.true is None else to_json(erratum.true, theory),
        "true_latex": "" if erratum.true is None else latex(erratum.true),
        "proved_by": erratum.proved_by,
    }


# ------------------------------------------------------------------------------------------------ reading
def document_from_json(data: Any) -> Document:
    """Read JSON data of schema derive-derivation/1."""
    item = a_dict(
        data, "derivation", ("schema", "version", "lecture", "theory", "title", "symbols", "given", "steps", "errata")
    )
    reader = Reader(installed(item["theory"]))
    reader.read(str, item["version"], "version")
    reader.read(tuple[str, ...], item["symbols"], "symbols")
    return Document(
        reader.read(str, item["lecture"], "lecture"),
        reader.read(str, item["title"], "title"),
        reader.theory,
        tuple(_given(row, reader) for row in a_list(item["given"], "given")),
        tuple(_step(step, reader) for step in a_list(item["steps"], "steps")),
        tuple(_erratum(e, reader) for e in a_list(item["errata"], "errata")),
    )


def _step(data: Any, reader: Reader) -> Step:
    try:
        return step_from_json(data, reader)
    except InputError as error:
        name = data.get("name") if isinstance(data, dict) else data
        raise InputError(f"step {shown(name)}: {error}") from None


def _given(data: Any, reader: Reader) -> GivenRow:
    item = a_dict(data, "given", ("name", "kind", "statement", "latex", "reason", "number", "source"))
    name, number, source, reason, _ = (
        reader.read(str, item[key], key) for key in ("name", "number", "source", "reason", "latex")
    )
    declared, statement = reader.theory.declared.get(name), reader.equation(item["statement"])
    if not isinstance(declared, Declared) or (declared.statement, declared.kind) != (statement, item["kind"]):
        raise InputError(f"given {shown(name)}: not what the theory {reader.theory.key} declares under that name")
    return GivenRow(statement, name, declared.kind, number, source, (reason,) if reason else ())


def _erratum(data: Any, reader: Reader) -> Erratum:
    keys = ("source", "number", "finding", "printed", "text", "evidence", "true", "true_latex", "proved_by")
    item = a_dict(data, "erratum", keys)
    plainly = {key: reader.read(str, item[key], key) for key in keys if key not in ("evidence", "true", "finding")}
    return Erratum(
        plainly["source"],
        plainly["number"],
        reader.read(get_type_hints(Erratum)["finding"], item["finding"], "finding"),
        (plainly["printed"],) if plainly["printed"] else (),
        (plainly["text"],) if plainly["text"] else (),
        tuple(_evidence(e, reader) for e in a_list(item["evidence"], "evidence")),
        None if item["true"] is None else reader.equation(item["true"]),
        plainly["proved_by"],
    )


def _evidence(data: Any, reader: Reader) -> Evidence:
    item = a_dict(data, "evidence", ("values", "results"))
    sides: list[tuple[tuple[str, str], ...]] = []
    for key in ("values", "results"):
        pairs = [reader.read(tuple[str, ...], pair, key) for pair in a_list(item[key], key)]
        if any(len(pair) != 2 for pair in pairs):
            raise InputError(f"{key}: expected pairs of a name and a value, got a list of another length")
        sides.append(tuple((name, value) for name, value in pairs))
    return Evidence(*sides)


def installed(key: Any) -> Theory:
    """Return the installed theory of that key, e.g. luenberger-dt."""
    from derive.theory import theory

    if not isinstance(key, str):
        raise InputError(f"theory: expected a name, got {shown(key)}")
    return theory(key)
