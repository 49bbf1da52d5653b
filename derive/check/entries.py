"""The report as JSON, schema derive-check/1: one entry a claim, in the order of the claims."""

from __future__ import annotations

from typing import Any

from derive.check.result import Report, Result
from derive.claim import Answer, Verdict

__all__ = ["SCHEMA", "entry", "report_entries"]

SCHEMA = "derive-check/1"


def report_entries(report: Report) -> dict[str, object]:
    """Return the report as JSON data."""
    return {"schema": SCHEMA, "claims": [entry(result) for result in report.results]}


def entry(result: Result) -> dict[str, Any]:
    """Return the entry of one claim; what comes after ``seconds`` is there only if it says something."""
    claim, answer = result.claim, result.answer or Answer(Verdict.undecided)
    return {
        "id": claim.id,
        "file": claim.file,
        "line": claim.line,
        "latex": claim.latex,
        "read_as": result.read_as,
        "theory": claim.theory,
        "verdict": result.verdict,
        "method": answer.method,
        "hypotheses_used": list(answer.hypotheses_used),
        "hypotheses_not_needed": list(answer.hypotheses_not_needed),
        "counterexample": answer.counterexample.to_json() if answer.counterexample else None,
        "nearest": {"latex": answer.nearest.latex, "edit": answer.nearest.edit} if answer.nearest else None,
        "certificate": dict(answer.certificate) if answer.certificate else None,
        "seconds": result.seconds,
        **{key: value for key, value in _more(result, answer).items() if value},
    }


def _more(result: Result, answer: Answer) -> dict[str, Any]:
    return {
        "message": result.message,
        "name": result.claim.name,
        "guessed": result.guessed,
        "hypotheses_added": list(answer.hypotheses_added),
        "assumed": list(answer.assumed),
        "needed": {name: example.to_json() for name, example in answer.needed.items()},
        "notes": list(answer.notes),
    }
