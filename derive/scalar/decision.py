"""Decide what is claimed of real numbers: small exact instances first, then a proof.

An instance that satisfies every hypothesis and contradicts the claim refutes it. A proof is a tree of reasons for signs
that proof.py replays; where one of them is z3's, z3 is the authority. What neither finds is supported by the instances
at which the claim was evaluated, or undecided.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import islice
from time import monotonic

from derive.claim import Answer, Counterexample, Verdict
from derive.context import DeclaredFact
from derive.errors import InputError
from derive.interpret.statement import Statement
from derive.latex import plain
from derive.scalar.argue import Failed, Prover, Unknown, choices_of, facts_of
from derive.scalar.evaluate import Undefined, Unsure, holds
from derive.scalar.evolution import evolution
from derive.scalar.example import example
from derive.scalar.flint_ring import rational
from derive.scalar.proof import Proof, accept, leaves
from derive.scalar.proof_file import certificate
from derive.scalar.ratio import Beyond
from derive.scalar.real_closed import Budget, ask
from derive.scalar.reasons import bearing_names, letters_of, used_names
from derive.scalar.work import Failure, Work
from derive.terms import Equation, Symbol, Zero

__all__ = ["decide_scalar"]

FIRST, MORE = 60, 600  # instances at which a claim is evaluated before and after a proof is tried
POINTS = 1_000  # points at which the first instances are looked for
FEW = 200  # points at which instances are looked for before z3 is asked whether there are any


def decide_scalar(statement: Statement, *, seconds: float = 10.0, explain: bool = False, near: bool = True) -> Answer:
    """Decide a statement about real numbers.

    Args:
        statement: equations and inequalities between numbers, or matrices with every dimension 1.
        seconds: bound on the time; z3 is bounded by its own count, so that the answer does not depend on the machine.
        explain: look for a counterexample without each hypothesis that a proof uses.
        near: look for the nearest true formula to one that is refuted, or where one that is undefined holds.

    Raises:
        InputError: the assumptions contradict each other or the theory.
    """
    deadline = monotonic() + seconds
    try:
        solution = evolution(statement)
        if solution is not None:
            return _solution(_decided(solution, deadline, explain, near=False, free=True), statement)
        return _decided(statement, deadline, explain, near)
    except Beyond as error:
        return Answer(Verdict.undecided, assumed=statement.assumed, notes=(str(error),))


def _decided(statement: Statement, deadline: float, explain: bool, near: bool, free: bool = False) -> Answer:
    """Decide a statement; ``free`` says that the letters of several times are free of each other."""
    work = Work.of(statement, deadline)
    work.moving = "" if free else work.moving
    _satisfiable(work)
    found = work.simplest(work.failures(work.instances.first(FIRST, POINTS)))
    answer = _proved_or_not(work, explain) if found is None else _refuted(work, found)
    return _with_neighbours(answer, work) if near and answer.verdict is Verdict.refuted else answer


def _solution(answer: Answer, statement: Statement) -> Answer:
    """Answer for a closed form of a solution, from what its start and its rate are."""
    named = {*statement.theory.theory.declared, *statement.assumed}
    used, not_needed = (
        tuple(h for h in names if h in named) for names in (answer.hypotheses_used, answer.hypotheses_not_needed)
    )
    data = answer.certificate and {**answer.certificate, "symbols": sorted(letters_of(statement)), "evolution": True}
    said = ("a solution is known by its start and its rate",) if answer.verdict is not Verdict.undecided else ()
    example, lhs = answer.counterexample, statement.equations[0].lhs
    if example is not None and isinstance(lhs, Symbol):
        example = replace(example, values={n: v for n, v in example.values.items() if n != lhs.name})
    return replace(
        answer,
        hypotheses_used=used,
        hypotheses_not_needed=not_needed,
        assumed=statement.assumed,
        counterexample=example,
        notes=(*answer.notes, *said),
        certificate=data,
    )


def _with_neighbours(answer: Answer, work: Work) -> Answer:
    """Add what is true instead: of a formula that is undefined, where it holds; else the nearest true one."""
    from derive.scalar.near import nearest_scalar

    left = min(2.0, work.deadline - monotonic())
    if answer.method == "undefined":
        where = _where(work, answer.counterexample)
        return replace(answer, notes=(*answer.notes, f"proved where {where}")) if where else answer
    return replace(answer, nearest=nearest_scalar(work.statement, seconds=left))


def _where(work: Work, example: Counterexample | None) -> str:
    """Return a condition on a letter that is zero or negative in a counterexample, with which the claim is true."""
    statement = work.statement
    values = {n: v[0][0] for n, v in example.values.items()} if example else {}
    letters = [s for s in statement.symbols if values.get(s.name, 1) <= 0 and s.name in letters_of(statement)]
    zero = [s for s in letters if values[s.name] == 0]
    for symbol, relation in (*((s, "≠") for s in zero), *((s, ">") for s in letters), *((s, "≥") for s in letters)):
        condition = Equation(symbol, relation, Zero("", ""))
        theory = replace(statement.theory, conditions=(*statement.theory.conditions, condition))
        other = replace(statement, theory=theory, assumed=(*statement.assumed, plain(condition)))
        try:
            if decide_scalar(other, seconds=work.deadline - monotonic(), near=False).verdict is Verdict.proved:
                return plain(condition)
        except InputError:
            continue
    return ""


def _satisfiable(work: Work) -> None:
    """Make sure that some numbers satisfy all hypotheses."""
    if all(c.impossible for c in work.cases):
        raise InputError(f"assume: expected what the theory allows, got a contradiction with {work.known.impossible}")
    if not work.instances.first(1, FEW) and _possible(work, Budget(deadline=work.deadline)) is False:
        raise InputError("assume: expected what the theory allows, got a contradiction; leave one assumption out")


def _possible(work: Work, budget: Budget) -> bool | None:
    """Tell whether the hypotheses of a case have a solution; None if that is not known of one, and of none else."""
    found = [ask(facts_of(c), choices_of(c), budget).possible for c in work.cases if not c.impossible]
    return True if True in found else None if None in found else False


# ---------------------------------------------------------------------------------------------- proofs
def _proved_or_not(work: Work, explain: bool) -> Answer:
    prover = Prover(work.statement, work.ring, work.names, work.deadline, seeds=work.instances.first(FIRST, POINTS))
    try:
        tree = prover.prove()
    except Failed as failed:
        found = _near(work, failed.near) or work.simplest(islice(work.failures(work.instances.first(MORE)), 3))
        return _refuted(work, found) if found else _open(work, "z3 has numbers at which it fails, none was confirmed")
    except Unknown as error:
        return _searched(work, str(error))
    except Beyond as error:
        return _searched(work, str(error))
    if not work.instances.first(1) and _possible(work, prover.budget) is not True:
        return _open(work, "no numbers were found that satisfy all hypotheses")
    return _proved(work, prover, tree, explain)


def _searched(work: Work, why: str) -> Answer:
    found = work.simplest(islice(work.failures(work.instances.first(MORE)), 3))
    return _refuted(work, found) if found else _open(work, why)


def _open(work: Work, why: str) -> Answer:
    """Answer with how often the claim was enclosed, if it could be evaluated."""
    if work.moving:
        return Answer(Verdict.undecided, assumed=work.statement.assumed, notes=(work.moving, why))
    enclosed = 0
    for instance in work.instances.first(FIRST, POINTS):
        try:
            answers = [holds(e, instance.values)[0] for e in work.statement.equations]
        except (Undefined, Unsure, Beyond):
            continue
        enclosed += False not in answers
    if not enclosed:
        return Answer(Verdict.undecided, assumed=work.statement.assumed, notes=(why,))
    note = f"it holds, as far as enclosures of {200} bits can tell, at {enclosed} instances"
    return Answer(Verdict.supported, "enclosures", assumed=work.statement.assumed, notes=(note, why))


def _proved(work: Work, prover: Prover, tree: Proof, explain: bool) -> Answer:
    certified = all(leaf.certified() for leaf in leaves(tree))
    if certified:
        accept(work.statement, tree)
    used, bearing = used_names(work.statement, prover.systems, tree), bearing_names(work.statement, work.known)
    named = tuple(o for o in bearing if o in used), tuple(o for o in bearing if o not in used)
    needed = _needed(work, named[0]) if explain else {}
    data = certificate(work.statement, tree) if certified else None
    notes = tuple(f"holds for every gain {g}" for g in _gains(work, prover, used))
    method = "sign argument" if certified else "z3"
    return Answer(Verdict.proved, method, *named, assumed=work.statement.assumed, needed=needed, notes=notes,
                  certificate=data)  # fmt: skip


def _gains(work: Work, prover: Prover, used: set[str]) -> list[str]:
    """Return the gains that may be any, because the claim is true without the declarations of the optimal ones."""
    optimal = work.statement.theory.optimal
    gains = [x for x, by in work.known.solved.items() if by in optimal and x in letters_of(work.statement)]
    if not gains:
        return []
    declared = work.statement.theory.theory.declared
    stable = {n for n, d in declared.items() if isinstance(d, DeclaredFact) and d.case}
    try:
        replace(prover, without=optimal | stable, certificates=False, systems=[], seeds=()).prove()
    except (Failed, Unknown, Beyond):
        return []
    return gains


def _needed(work: Work, names: Sequence[str]) -> dict[str, Counterexample]:
    """Return a counterexample for hypotheses without which there is one."""
    found: dict[str, Counterexample] = {}
    for name in names:
        try:
            other = Work.of(work.statement, work.deadline, frozenset({name}))
        except Beyond:
            continue
        failure = other.simplest(islice(other.failures(other.instances.first(MORE // 3)), 8))
        if failure is not None:
            found[name] = example(other, failure)
    return found


# ---------------------------------------------------------------------------------------------- refutations
def _near(work: Work, model: Mapping[str, Fraction] | None) -> Failure | None:
    """Return an exact instance near the numbers that z3 found, the simplest that contradicts the statement."""
    if model is None:
        return None
    found: list[Failure] = []
    for largest in (1, 2, 4, 10, 100, 10**4, 10**9):
        values = {n: model.get(n, Fraction(1)).limit_denominator(largest) for n in work.instances.free}
        instances = work.instances.at({n: rational(v) for n, v in values.items()})
        found += work.failures(instances)
        if found:
            return work.simplest(found)
    return None


def _refuted(work: Work, failure: Failure) -> Answer:
    method = "undefined" if failure.undefined else "exact instance"
    return Answer(Verdict.refuted, method, counterexample=example(work, failure), assumed=work.statement.assumed)
