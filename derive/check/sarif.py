"""The report as a SARIF 2.1.0 log (OASIS), which code hosts show beside the lines of a file."""

from __future__ import annotations

from typing import Any

from derive._version import __version__
from derive.check.result import ERROR, Report, Result

__all__ = ["sarif_log"]

RULES = {
    "refuted": ("error", "The formula is false: there is an instance that satisfies every hypothesis."),
    "supported": ("note", "The formula holds on every instance tried, without a proof."),
    "undecided": ("warning", "Neither a proof nor a counterexample was found."),
    ERROR: ("error", "The formula cannot be read."),
}
SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


def sarif_log(report: Report) -> dict[str, object]:
    """Return the log; proved claims are no findings."""
    run = {
        "tool": {"driver": {"name": "derive", "version": __version__, "rules": _rules()}},
        "columnKind": "unicodeCodePoints",
        "invocations": [{"executionSuccessful": not report.errors, **_notifications(report)}],
        "results": [_result(r) for r in report.results if r.verdict in RULES],
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _rules() -> list[dict[str, Any]]:
    return [
        {"id": name, "shortDescription": {"text": text}, "defaultConfiguration": {"level": level}}
        for name, (level, text) in RULES.items()
    ]


def _notifications(report: Report) -> dict[str, Any]:
    told = [{"level": "error", "message": {"text": text}} for text in report.errors]
    return {"toolExecutionNotifications": told} if told else {}


def _result(result: Result) -> dict[str, Any]:
    found = {
        "ruleId": result.verdict,
        "ruleIndex": list(RULES).index(result.verdict),
        "level": RULES[result.verdict][0],
        "message": {"text": _message(result)},
    }
    return {**found, "locations": [_location(result)]} if result.claim.file else found


def _location(result: Result) -> dict[str, Any]:
    region = {"startLine": max(1, result.claim.line), "snippet": {"text": result.claim.latex}}
    place = {"artifactLocation": {"uri": _uri(result.claim.file)}, "region": region}
    return {"physicalLocation": place}


def _uri(file: str) -> str:
    from urllib.parse import quote

    return quote(file.replace("\\", "/")) if file != "-" else "stdin"


def _message(result: Result) -> str:
    """Return what is wrong, in a sentence or two."""
    claim, answer = result.claim, result.answer
    name = f"({claim.name})" if claim.name else claim.id
    parts = [f"{name} {result.verdict}: {result.message or result.read_as or claim.latex}"]
    if answer and answer.counterexample:
        parts.append(f"At {answer.counterexample}.")
    if answer and answer.nearest:
        parts.append(f"Nearest true formula: {answer.nearest.latex} ({answer.nearest.edit}).")
    return " ".join([*parts, *(f"{note}." for note in (answer.notes if answer else ()))])
