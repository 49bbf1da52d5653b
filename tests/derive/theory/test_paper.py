"""Every displayed equation of Fang, Ishii, Chen and Johansson (2018) has the verdict that it deserves."""

from __future__ import annotations

import json
from typing import Any

from click.testing import CliRunner

from derive.cli import cli
from derive.derivation import Derived, Erratum, Given
from derive.theory import LECTURES, lecture
from tests.derive.theory.mutants import outcomes

DEFINED, PROVED, REFUTED = "definition", "proved", "refuted"
# number in the paper (u1, u2, ... where it has none): verdict, and what the formula needs that the paper does not say
PAPER = {
    "u1": (DEFINED, ""),  # autocorrelation
    "u2": (DEFINED, ""),  # spectrum
    "u3": (DEFINED, ""),  # its inversion
    "u4": (PROVED, ""),  # covariance from the spectrum
    "u5": (DEFINED, ""),  # white noise
    "u6": (DEFINED, ""),  # plant
    "u7": (DEFINED, "W and V are intensities, not covariances"),
    "u8": (DEFINED, ""),
    "u9": (DEFINED, ""),  # filter
    "1": (PROVED, ""),
    "u10": (DEFINED, ""),  # P(t)
    "u11": (PROVED, ""),  # Riccati differential equation
    "u12": (DEFINED, ""),  # P, the limit
    "2": (PROVED, "several solutions: the stabilising one, or the strong one"),
    "3": (PROVED, ""),
    "4": (PROVED, ""),
    "u13": (PROVED, ""),  # (4) for one output
    "u14": (PROVED, ""),  # the innovation is white
    "5": (DEFINED, ""),
    "6": (DEFINED, ""),
    "7": (PROVED, "s tends to infinity along the reals; real coefficients"),
    "8": (PROVED, "stable poles, and s_0 is no zero"),
    "9": (DEFINED, ""),
    "10": (DEFINED, ""),
    "11": (PROVED, "s tends to infinity along the reals; real coefficients"),
    "12": (PROVED, "the stabilising (strong) P"),
    "13": (DEFINED, ""),
    "14": (DEFINED, ""),
    "15": (PROVED, ""),
    "16": (DEFINED, ""),
    "17": (PROVED, "the strong P; s tends to infinity along the reals"),
    "18": (PROVED, "the strong P"),
    "19": (DEFINED, ""),
    "20": (PROVED, "the strong P"),
    "21": (PROVED, "the strong P"),
    "22": (PROVED, "the strong P"),
    "23": (PROVED, "not always: exactly when tr(CPC'V^-1) = 0"),
    "24": (PROVED, "the stabilising (strong) P"),
    "u15": (PROVED, ""),  # proof of Theorem 2: from (12) by (11)
    "u16": (PROVED, ""),  # Phi_y V^-1
    "u17": (PROVED, ""),  # a limit
    "25": (REFUTED, "the poles lie in spec(A) and spec(-A)"),
    "26": (PROVED, ""),
    "27": (PROVED, "C is not zero"),
    "28": (PROVED, "C has rank m"),
    "29": (PROVED, ""),
    "30": (PROVED, ""),  # the spectrum, for one output
    "31": (PROVED, "C is not zero"),
    "32": (PROVED, ""),
    "33": (PROVED, ""),
    "34": (PROVED, ""),
    "35": (PROVED, "a sum over one term"),
    "36": (PROVED, "the stabilising (strong) P"),
    "37": (PROVED, ""),
    "38": (PROVED, ""),
    "39": (PROVED, ""),
}


def listed() -> dict[str, dict[str, Any]]:
    """Return what ``derive list --equations 001 --json`` says, by number."""
    result = CliRunner().invoke(cli, ["list", "--equations", "001", "--json"])
    assert result.exit_code == 0
    entries = json.loads(result.stdout)
    found = {entry["number"]: entry for entry in entries}
    assert len(found) == len(entries)
    return found


def test_every_equation_of_the_paper_has_its_verdict():
    found = {number: entry["verdict"] for number, entry in listed().items()}
    assert found == {number: verdict for number, (verdict, _) in PAPER.items()}


def test_what_is_derived_has_steps_and_what_is_defined_has_none():
    for number, entry in listed().items():
        assert entry["document"] == "001"
        assert (entry["steps"] > 0) == (entry["verdict"] != DEFINED) or entry["verdict"] == REFUTED, number


def test_the_derived_equations_replay_and_the_others_are_displayed():
    """What the table calls proved is a step that the kernel accepts, or the end of a chain of such steps."""
    shown = dict.fromkeys(PAPER, "")
    for key in LECTURES:
        item = lecture(key)
        accepted = {outcome.step for outcome in outcomes(key) if outcome.accepted}
        for part in item.items:
            if isinstance(part, Given):
                shown |= {r.number: "given" for r in part.rows if r.source == "001" and shown.get(r.number) == ""}
            elif isinstance(part, Derived):
                numbered = [s for s in part.steps if s.number and (s.source or item.sources[0]) == "001"]
                shown |= {s.number: "step" for s in numbered if {t.name for t in part.steps} <= accepted}
    expected = {PROVED: "step", DEFINED: "given"}
    for number, kind in shown.items():
        assert kind == expected.get(PAPER[number][0], kind), number


def test_an_erratum_of_the_paper_has_a_remark_in_the_table():
    errata = [part for key in LECTURES for part in lecture(key).items if isinstance(part, Erratum)]
    ours = [e for e in errata if e.source == "001" and e.number]
    assert {"2", "u7"} <= {e.number for e in ours}
    for erratum in ours:
        verdict, remark = PAPER[erratum.number]
        assert remark, erratum.number
        assert (verdict == REFUTED) == (erratum.finding == "false"), erratum.number
        assert erratum.evidence or verdict != REFUTED, erratum.number
