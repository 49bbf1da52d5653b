"""The formulas of the four sources, typed as claims, get the verdicts that are known by hand.

``open`` marks a formula that is not decided yet: it may stay undecided or be supported, but never get the wrong word.
"""

import json
import re
from functools import cache
from pathlib import Path

import pytest

import derive
from derive.check import Report, check
from derive.check.certificates import write_certificates
from derive.replay import verify_file

ROOT = Path(derive.__file__).parents[1]
SOURCES = sorted((ROOT / "derive" / "check" / "sources").glob("*.jsonl"))
WANTED = json.loads((ROOT / "tests" / "reference" / "source_claims.json").read_text(encoding="utf-8"))
SHIFTED = {"001-u7", "001-u8"}  # files know no time t+τ
NUMBERS = {"observer-notes": "000", "fang-2018": "001", "luenberger-notes": "002", "vander-velde-2004": "004"}


@cache
def report(path):
    return check(path)


def rows():
    """Return the rows of the audit's tables: source, formula, verdict."""
    text = (ROOT / "docs" / "audit.md").read_text(encoding="utf-8")
    found = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| 00") and len(cells) == 5:
            found.append(cells)
    return found


def test_every_claim_has_a_verdict_to_reach():
    ids = [json.loads(line)["id"] for path in SOURCES for line in path.read_text(encoding="utf-8").splitlines()]
    assert sorted(ids) == sorted(WANTED)
    assert {path.stem for path in SOURCES} == set(NUMBERS)
    assert all(id_.startswith(NUMBERS[path.stem]) for path in SOURCES for id_ in ids_of(path))


def ids_of(path):
    return [json.loads(line)["id"] for line in path.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_the_verdicts_are_those_known_by_hand(path):
    wrong = {}
    for result in report(path).results:
        wanted = WANTED[result.claim.id]
        allowed = {wanted["verdict"], *(("supported", "undecided") if wanted.get("open") else ())}
        if result.verdict not in allowed:
            wrong[result.claim.id] = (result.verdict, result.message or (result.answer and result.answer.notes))
    assert not wrong


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_what_is_refuted_shows_where_and_what_is_true(path):
    for result in report(path).results:
        if result.verdict == "refuted":
            assert result.answer.counterexample or result.answer.method == "types", result.claim.id


def test_the_missing_letter_of_the_printed_gains_is_found():
    (luenberger,) = (path for path in SOURCES if path.stem == "luenberger-notes")
    found = {r.claim.id: r.answer.nearest for r in report(luenberger).results if r.verdict == "refuted"}
    assert found["002-u4"].latex == r"L = A P C^\top (C P C^\top + R)^{-1}"
    assert "A" in found["002-3"].edit


def test_their_certificates_are_replayed(tmp_path):
    for path in SOURCES:
        proved = [r for r in report(path).results if r.verdict == "proved" and r.claim.id not in SHIFTED]
        kept = tuple(r for r in proved if r.answer.method == "kernel")
        written = write_certificates(Report(kept), tmp_path / path.stem)
        assert len(written) == len(kept) > 0
        assert all(found.accepted for file in written for found in verify_file(file))


# ------------------------------------------------------------------------------------------------ the page
def test_the_page_lists_every_claim_once_with_its_verdict():
    told = {}
    for _, _, verdict, _, ids in rows():
        for id_ in re.findall(r"`([^`]+)`", ids):
            assert id_ not in told, id_
            told[id_] = verdict
    assert sorted(told) == sorted(WANTED)
    wrong = {
        id_: (verdict, WANTED[id_]["verdict"]) for id_, verdict in told.items() if verdict != WANTED[id_]["verdict"]
    }
    assert not wrong
