"""Statements from LaTeX, for tests of the decision."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from derive.claim import Answer, Claim
from derive.decide import decide
from derive.decide.certificate import signed
from derive.interpret import Statement, understand
from derive.latex.grammar import read
from derive.theory.claims import claim_theory

DT, KB = "luenberger-dt", "kalman-bucy"


def statement(latex: str, theory: str = DT, assume: Sequence[str] = ()) -> Statement:
    return understand(read(latex), claim_theory(theory), assume=[read(a) for a in assume])


@cache
def answer(latex: str, theory: str = DT, assume: tuple[str, ...] = (), *, near: bool = False) -> Answer:
    return decide(statement(latex, theory, assume), near=near)


@cache
def certified(latex: str, theory: str = DT, assume: tuple[str, ...] = ()) -> dict:
    found = answer(latex, theory, assume)
    assert found.certificate is not None, found
    return signed(found.certificate, Claim(latex, theory, assume))
