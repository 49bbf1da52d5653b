"""Decide claims: proved, refuted, supported or undecided, with the reason."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from derive.claim import Answer, Verdict

if TYPE_CHECKING:
    from derive.interpret.statement import Statement

__all__ = ["decide"]


def decide(statement: Statement, *, seconds: float = 10.0, explain: bool = False, near: bool = True) -> Answer:
    """Decide a statement.

    Args:
        statement: a claim, read in its theory.
        seconds: bound on the time.
        explain: look for a counterexample without each hypothesis that a proof uses.
        near: look for the convention in which a refuted claim holds, and for the nearest true formula.

    Returns:
        proved with a certificate that was replayed, its hypotheses satisfiable; refuted with an exact counterexample;
        or undecided, with the reason in its notes.

    Raises:
        InputError: assumptions that contradict the theory.
    """
    from derive.decide.kinds import holds_along

    answer = _decided(statement, seconds, explain, near)
    if answer.verdict is Verdict.refuted and holds_along(statement):
        note = "what is assumed holds at every time, so that values at one instant refute nothing"
        return Answer(Verdict.undecided, assumed=statement.assumed, notes=(note,))
    return answer


def _decided(statement: Statement, seconds: float, explain: bool, near: bool) -> Answer:
    from derive.decide.kinds import has_no_real_instance, is_analytic, is_matrix_claim

    if is_analytic(statement):
        from derive.decide.spectra.decision import decide_spectra

        return decide_spectra(statement, seconds)
    if statement.scalar:
        from derive.scalar.decision import decide_scalar

        return decide_scalar(statement, seconds=seconds, explain=explain, near=near)
    if is_matrix_claim(statement):
        from derive.decide.matrix import decide_matrix

        answer = decide_matrix(statement, seconds, explain)
        if answer.verdict is Verdict.refuted and has_no_real_instance(statement):
            note = "it fails for real numbers, but j and eigenvalues are not any real numbers"
            return Answer(Verdict.undecided, assumed=statement.assumed, notes=(note,))
        return _with_neighbours(answer, statement) if answer.verdict is Verdict.refuted and near else answer
    return Answer(Verdict.undecided, assumed=statement.assumed, notes=("there is no rule for claims of this kind",))


def _with_neighbours(answer: Answer, statement: Statement) -> Answer:
    """Add the convention in which a refuted claim holds, and the nearest true formula with its explanation."""
    from derive.decide.convention import conventions, letters
    from derive.decide.nearest import Surroundings, nearest

    around = Surroundings.of(statement, letters(statement))
    found = nearest(around)
    notes = (*answer.notes, *conventions(around), *([found[1]] if found and found[1] else []))
    return replace(answer, notes=notes, nearest=found[0] if found else None)
