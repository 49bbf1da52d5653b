"""Replay of files: each step is accepted by the kernel or not, whoever wrote the file.

The theory (symbols, definitions, hypotheses) is the installed one. A step is accepted when the kernel accepts its
certificate and the file shows it as it prints: same LaTeX, same list of relations.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from derive.context import Declared, Theory
from derive.derivation import Erratum, Outcome, Proof, Step, learn, verify
from derive.document import SCHEMA, Document, document_from_json, document_to_json, installed
from derive.errors import InputError
from derive.files import read_limited
from derive.kernel import Rejected, replay
from derive.serialise import SCHEMAS, Reader, certificates
from derive.terms import Reading
from derive.wellformed import a_dict, shown

__all__ = ["Report", "verify_data", "verify_file"]

LIMIT = 64 * 2**20  # bytes
MARKS = 8_000_000  # commas and brackets: bounds the memory that the parsed file takes


@dataclass(frozen=True)
class Report:
    """What the replay of one derivation says; ``outcomes`` has one entry a step, in order, then complaints."""

    path: str
    schema: str
    lecture: str
    theory: str
    total: int
    outcomes: tuple[Outcome, ...]
    authority: str = "kernel"

    @property
    def proved(self) -> int:
        """Number of accepted steps."""
        return sum(o.accepted for o in self.outcomes[: self.total])

    @property
    def accepted(self) -> bool:
        """Whether every step is accepted and everything is shown as it is."""
        return bool(self.outcomes) and all(o.accepted for o in self.outcomes)


def verify_file(path: Path) -> list[Report]:
    """Replay every derivation or certificate in a file with the kernel and the installed theories.

    Returns:
        One report for each derivation in the file, which holds one or a list of them.

    Raises:
        InputError: the file is missing, too large, no JSON, or not well-formed.
    """
    data = parse(read_limited(path, LIMIT), path)
    try:
        return [verify_data(item, str(path)) for item in (data if isinstance(data, list) and data else [data])]
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except (LookupError, TypeError, ArithmeticError, AssertionError, RecursionError, MemoryError) as error:
        raise InputError(f"{path}: expected a well-formed proof, got one that cannot be replayed: {error!r}") from None


def parse(text: str, path: Path) -> Any:
    """Parse JSON of bounded size.

    Raises:
        InputError: not JSON, a key given twice, or too large.
    """
    if sum(text.count(mark) for mark in ",[{") > MARKS:
        raise InputError(f"{path}: expected at most {MARKS} values, got more; split the file")
    try:
        return json.loads(text, object_pairs_hook=_unique, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise InputError(f"{path}: expected JSON, got an error: {reason[:200]}") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key is given twice in one object")
    return found


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is not a number")


def verify_data(data: Any, path: str) -> Report:
    """Replay a derivation, a single identity certificate or the certificate of a claim."""
    schema = a_dict(data, "file").get("schema")
    if schema == SCHEMAS["identities"]:
        return verify_claim(data, path) if "latex" in data else verify_certificate(data, path)
    if schema != SCHEMA:
        raise InputError(f"schema: expected {SCHEMA} or {SCHEMAS['identities']}, got {shown(schema)}")
    document = document_from_json(data)
    again = document_to_json(document, data["version"])
    outcomes = [
        _names_all(_as_shown(outcome, shows, prints), step, document.theory)
        for outcome, step, shows, prints in zip(
            verify(document.theory, document.steps), document.steps, data["steps"], again["steps"], strict=True
        )
    ]
    proved = {o.step for o in outcomes if o.accepted}
    outcomes += _frame(data, again) + [o for e in document.errata for o in _true_form(e, document, proved)]
    return Report(path, SCHEMA, document.lecture, document.theory.key, len(document.steps), tuple(outcomes))


def _as_shown(outcome: Outcome, shows: dict[str, Any], prints: dict[str, Any]) -> Outcome:
    """Reject an accepted step that the file shows as something else than what was proved."""
    wrong = [key for key in prints if shows[key] != prints[key]]
    if not outcome.accepted or not wrong:
        return outcome
    detail = f": {prints[wrong[0]]}" if wrong[0] == "latex" else ""
    return Outcome(outcome.step, False, f"the file shows another {wrong[0]} than the step's own{detail}")


def _names_all(outcome: Outcome, step: Step, theory: Theory) -> Outcome:
    """Reject an accepted step that does not name all that its certificate rests on."""
    known = {f"I{size}" for size in theory.sizes()} | set(step.proof.links)
    names = {re.sub(r"(\[\d+,\d+\]|\.left|\.right)$", "", name) for name in step.proof.relations() - known}
    if not outcome.accepted or names <= set(step.uses):
        return outcome
    return Outcome(outcome.step, False, f"it uses {', '.join(sorted(names - set(step.uses)))} without naming it")


def _frame(data: dict[str, Any], again: dict[str, Any]) -> list[Outcome]:
    """Reject what surrounds the steps if it is shown as something else than it prints."""
    return [
        Outcome(key, False, f"the file shows other {key} than its own")
        for key in ("symbols", "given", "errata")
        if data[key] != again[key]
    ]


def _true_form(erratum: Erratum, document: Document, proved: set[str]) -> list[Outcome]:
    """Reject an erratum whose true formula is neither declared nor a step that is accepted."""
    name = f"erratum {erratum.source} {erratum.number}"
    if erratum.proved_by and erratum.proved_by not in proved:
        return [Outcome(name, False, f"the step {erratum.proved_by} is not proved in this file")]
    statements = [s.statement for s in document.steps if s.name in proved]
    statements += [d.statement for d in document.theory.declared.values() if isinstance(d, Declared)]
    if erratum.true is not None and erratum.true not in statements:
        return [Outcome(name, False, "its true formula is neither declared nor proved in this file")]
    return []


def verify_certificate(data: Any, path: str) -> Report:
    """Replay a single identity certificate from the theory and, if it names them, the lemmas of installed lectures."""
    theory = installed(data.get("theory"))
    _, certificate = Reader(theory).certificate(data)
    shows, prints = {**data}, certificates(Proof(identities=(certificate,)), theory)[0]
    outcome = Outcome("certificate", True)
    try:
        context = theory.reading().context
        if not set(prints["relations"]) <= set(context.relations):
            context = taught(theory).context
        replay(certificate, certificate.claim, context.relations, context.alphabet)
    except Rejected as error:
        outcome = Outcome("certificate", False, str(error))
    return Report(path, SCHEMAS["identities"], "", theory.key, 1, (_as_shown(outcome, shows, prints),))


def verify_claim(data: Any, path: str) -> Report:
    """Replay the certificate of a claim: its LaTeX is read again in the installed theory."""
    from derive.decide.certificate import replay_claim

    outcome = Outcome("claim", True)
    try:
        replay_claim(data)
    except Rejected as error:
        outcome = Outcome("claim", False, str(error))
    return Report(path, SCHEMAS["identities"], "", shown(data["theory"]).strip("'"), 1, (outcome,))


def taught(theory: Theory) -> Reading:
    """Return the theory's reading, extended by the lemmas of the installed lectures over it, each replayed first."""
    from derive.theory import LECTURES, lecture

    reading = theory.reading()
    for steps in (lecture(key).steps for key in LECTURES if lecture(key).theory.key == theory.key):
        accepted = {o.step for o in verify(theory, steps) if o.accepted}
        for step in (s for s in steps if s.name in accepted):
            reading = learn(reading, theory, step)
    return reading
