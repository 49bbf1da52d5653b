"""Decide claims between matrices and their traces: certificate, exact counterexample, or undecided.

The equations of the theory that bear on the claim are tried in growing sets: inverses alone, then all but what holds
for the optimal gain only, then everything. What no random instance supports is not searched for.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import replace

from derive.claim import Answer, Counterexample, Verdict
from derive.context import consulting
from derive.decide.certificate import certificate, replayed
from derive.decide.equations import polynomials, prove_equation, refute_equation
from derive.decide.hypotheses import free_gains, inverses_in, names_in, not_needed, pruned, used, without
from derive.decide.obligations import Undefined, Unjustified, justify, justify_given
from derive.decide.parts import Part, bound, oriented, rule_of
from derive.decide.vacuity import contradictory, satisfiable
from derive.decide.workspace import Workspace
from derive.derivation import order_claim
from derive.errors import InputError
from derive.interpret.statement import Statement
from derive.kernel import Poly, Rejected
from derive.terms import lower

FIRST = 60  # instances that are tried for an inequality before a proof is looked for

__all__ = ["decide_matrix", "prove_statement"]


def decide_matrix(statement: Statement, seconds: float = 10.0, explain: bool = False) -> Answer:
    """Decide a statement between matrices or traces."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    try:
        for equation in statement.equations:
            bound(equation, statement.theory)
        justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work)
        polys = [p for e in statement.equations for p in polynomials(e, work)]
        if not satisfiable(statement, polys):
            return _vacuous(statement, work)
        proof, failed = _prove(statement, work)
    except Undefined as found:
        return _undefined(found, statement)
    except Unjustified:
        note = "no reason was found why an inverse in it exists, and no instance where it does not"
        return _refute_where_defined(statement, work.left) or _undecided(statement, note)
    except (Rejected, AssertionError) as error:
        return _undecided(statement, str(error))
    if failed is not None:
        return failed
    if proof is None:
        return _undecided(statement, "neither a proof nor a counterexample was found")
    return _proved(statement, work, proof, polys, explain)


def _refute_where_defined(statement: Statement, seconds: float) -> Answer | None:
    """Refute a statement at an instance where its inverses exist, though no reason is known why they always do."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    try:
        justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work, refuting=False, supposing=True)
        found = [refute_equation(oriented(e, work.reading), work) for e in statement.equations]
    except (Rejected, Undefined, Unjustified):
        return None
    for i, counterexample in enumerate(found):
        if counterexample:
            return _refuted(statement, i, counterexample)
    return None


def _refuted(statement: Statement, number: int, found: Counterexample) -> Answer:
    """Return the answer when one of the relations fails."""
    notes = (f"its relation number {number + 1} fails",) if len(statement.equations) > 1 else ()
    found = _readable(found)
    return Answer(Verdict.refuted, "exact instance", assumed=statement.assumed, counterexample=found, notes=notes)


def _readable(found: Counterexample) -> Counterexample:
    """Return a counterexample whose letters that vary with time are named as at the time t: P for P@t."""
    values = {name.removesuffix("@t"): value for name, value in found.values.items()}
    return replace(found, values=values, hidden=frozenset(name.removesuffix("@t") for name in found.hidden))


def prove_statement(statement: Statement, seconds: float = 1.0) -> bool:
    """Tell whether a statement is proved, its hypotheses satisfiable; nothing is refuted."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    parts: list[Part] = []
    try:
        justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work, refuting=False)
        polys = [p for e in statement.equations for p in polynomials(e, work)]
        for equation in statement.equations:
            part = prove_equation(oriented(equation, work.reading), work)
            if part is None:
                return False
            parts.append(part)
        replayed(statement, pruned(work.items, parts, polys), parts)
    except (Undefined, Unjustified, Rejected, AssertionError):
        return False
    return satisfiable(statement, polys)


# ------------------------------------------------------------------------------------------------ each equation
def _prove(statement: Statement, work: Workspace) -> tuple[list[Part] | None, Answer | None]:
    """Prove every equation; or return the answer that refutes one; or nothing."""
    proof: list[Part] = []
    open_ = False
    for i, equation in enumerate(statement.equations):
        plain = oriented(equation, work.reading)
        found = None if plain.relation == "=" else refute_equation(plain, work, FIRST)
        part = prove_equation(plain, work) if found is None else None
        if part is not None:
            proof.append(part)
            continue
        found = found or refute_equation(plain, work)
        if found is not None:
            return None, _refuted(statement, i, found)
        open_ = True
    return (None if open_ else proof), None


# ------------------------------------------------------------------------------------------------ answers
def _proved(
    statement: Statement, work: Workspace, proof: Sequence[Part], polys: Sequence[Poly], explain: bool
) -> Answer:
    theory = statement.theory
    items = pruned(work.items, proof, polys)
    replayed(statement, items, proof)
    names = {n for part in proof for n in names_in(part)} | inverses_in(polys, work) | _tables(statement, work)
    rests_on = used(names, work.items, theory)
    gains = free_gains(statement.symbols, rests_on, theory)
    notes = tuple(f"holds for every gain {_shown(g)}" for g in gains)
    return Answer(
        Verdict.proved,
        "kernel",
        hypotheses_used=rests_on,
        hypotheses_added=tuple(name for name in rests_on if name in theory.added),
        hypotheses_not_needed=not_needed(statement.symbols, rests_on, theory),
        assumed=statement.assumed,
        needed=_needed(statement, work, rests_on) if explain else {},
        notes=notes,
        certificate=certificate(statement, items, proof),
    )


def _shown(symbol) -> str:
    from derive.latex.plain import plain

    return plain(symbol)


def _tables(statement: Statement, work: Workspace) -> set[str]:
    """Return the declarations behind the derivatives and moments that the statement was read with."""
    reading, *tables = consulting(work.reading)
    for equation in statement.equations:
        for side in (equation.lhs, equation.rhs):
            try:
                lower(side, reading)
            except Rejected:
                continue
    return {reading.origins[key] for table in tables for key in table.read if key in reading.origins}


def _needed(statement: Statement, work: Workspace, names: Iterable[str]) -> dict[str, Counterexample]:
    """Return, for each hypothesis that was used, what fails without it."""
    found: dict[str, Counterexample] = {}
    for name in names:
        for equation in statement.equations:
            plain = oriented(equation, work.reading)
            if rule_of(plain) in ("gradient", "trace", "trace order", "expectation"):
                continue
            ((left,), *more), difference = lower(plain.lhs, work.reading), order_claim(plain, work.reading)
            if more:
                continue
            missing = without(work, name, left, left - difference[0][0], plain.relation, False)
            if missing:
                found[name] = _readable(missing)
                break
    return found


def _undefined(found: Undefined, statement: Statement) -> Answer:
    return Answer(
        Verdict.refuted,
        "undefined",
        assumed=statement.assumed,
        counterexample=_readable(found.counterexample),
        notes=(f"the inverse of {_shown(found.body)} does not exist there",),
    )


def _undecided(statement: Statement, note: str) -> Answer:
    return Answer(Verdict.undecided, assumed=statement.assumed, notes=(note,))


def _vacuous(statement: Statement, work: Workspace) -> Answer:
    """Say that no instance of the hypotheses was found; contradictory assumptions are an error.

    Raises:
        InputError: the assumptions contradict the theory.
    """
    if statement.assumed and contradictory(work):
        names = ", ".join(statement.assumed)
        raise InputError(f"assume: expected relations that a plant can satisfy, got a contradiction from {names}")
    return _undecided(statement, "no instance that satisfies all hypotheses was found")
