"""Decide claims between matrices and their traces: certificate, exact counterexample, or undecided.

The equations of the theory that bear on the claim are tried in growing sets: inverses alone, then all but what holds
for the optimal gain only, then everything. What no random instance supports is not searched for.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache

from derive.claim import Answer, Counterexample, Verdict
from derive.context import consulting, terms_of
from derive.decide.certificate import certificate, replayed
from derive.decide.gradient import gradient_claim, gradient_of, images, inner
from derive.decide.hypotheses import free_gains, inverses_in, names_in, not_needed, pruned, used, without
from derive.decide.obligations import Undefined, Unjustified, justify
from derive.decide.order import prove_order, prove_trace_order
from derive.decide.parts import Part, oriented, rule_of
from derive.decide.signals import expanded, inside
from derive.decide.workspace import Workspace
from derive.derivation import Proof, claims, order_claim
from derive.errors import InputError
from derive.interpret.statement import Statement
from derive.kernel import Poly, Rejected, identity
from derive.matrix.refute import satisfy
from derive.rules import Grid, expect
from derive.terms import Equation, Zero, lower, lower_trace
from derive.theory.claims.base import ClaimTheory

__all__ = ["decide_matrix", "prove_statement"]

VACUITY = 2.0  # seconds for an instance of the hypotheses
REFUTE = 3.0  # seconds for a counterexample


def decide_matrix(statement: Statement, seconds: float = 10.0, explain: bool = False) -> Answer:
    """Decide a statement between matrices or traces."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    try:
        _justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work)
        polys = [p for e in statement.equations for p in _polys(e, work)]
    except Undefined as found:
        return _undefined(found, statement)
    except Unjustified:
        note = "no reason was found why an inverse in it exists, and no instance where it does not"
        return _refute_where_defined(statement, work.left) or _undecided(statement, note)
    except (Rejected, AssertionError) as error:
        return _undecided(statement, str(error))
    if not _satisfiable(statement, polys):
        return _vacuous(statement, work)
    proof, failed = _prove(statement, work)
    if failed is not None:
        return failed
    if proof is None:
        return _undecided(statement, "neither a proof nor a counterexample was found")
    return _proved(statement, work, proof, polys, explain)


def _refute_where_defined(statement: Statement, seconds: float) -> Answer | None:
    """Refute a statement at an instance where its inverses exist, though no reason is known why they always do."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    try:
        _justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work, refuting=False, supposing=True)
        found = [_refute(oriented(e, work.reading), work) for e in statement.equations]
    except (Rejected, Undefined, Unjustified):
        return None
    for i, counterexample in enumerate(found):
        if counterexample:
            return _refuted(statement, i, counterexample)
    return None


def _refuted(statement: Statement, number: int, found: Counterexample) -> Answer:
    """Return the answer when one of the relations fails."""
    notes = (f"its relation number {number + 1} fails",) if len(statement.equations) > 1 else ()
    return Answer(Verdict.refuted, "exact instance", assumed=statement.assumed, counterexample=found, notes=notes)


def prove_statement(statement: Statement, seconds: float = 1.0) -> bool:
    """Tell whether a statement is proved, its hypotheses satisfiable; nothing is refuted."""
    work = Workspace(statement.theory, time.monotonic() + seconds, statement.equations)
    try:
        _justify_given(work)
        for equation in statement.equations:
            for side in (equation.lhs, equation.rhs):
                justify(side, work, refuting=False)
        polys = [p for e in statement.equations for p in _polys(e, work)]
    except (Undefined, Unjustified, Rejected, AssertionError):
        return False
    parts = []
    for equation in statement.equations:
        part = _part(oriented(equation, work.reading), work)
        if part is None:
            return False
        parts.append(part)
    items = pruned(work.items, parts, polys)
    try:
        replayed(statement, items, parts)
    except Rejected:
        return False
    return _satisfiable(statement, polys)


def _justify_given(work: Workspace) -> None:
    """Establish the inverses in what is given; the declarations that wait for them are taken up."""
    for name in work.waiting():
        item = work.theory.theory.declared[name]
        for term in terms_of(item) if name not in work.reading.adopted else ():
            justify(term, work, refuting=False)
    if work.waiting():
        raise Rejected(f"{work.waiting()[0]}: no reason was found why an inverse in it exists")


# ------------------------------------------------------------------------------------------------ each equation
def _prove(statement: Statement, work: Workspace) -> tuple[list[Part] | None, Answer | None]:
    """Prove every equation; or return the answer that refutes one; or nothing."""
    proof: list[Part] = []
    open_ = False
    for i, equation in enumerate(statement.equations):
        plain = oriented(equation, work.reading)
        part = _part(plain, work)
        if part is not None:
            proof.append(part)
            continue
        found = _refute(plain, work)
        if found is not None:
            return None, _refuted(statement, i, found)
        open_ = True
    return (None if open_ else proof), None


def _part(equation: Equation, work: Workspace) -> Part | None:
    """Search for a proof of one equation or inequality."""
    rule, strict = rule_of(equation), equation.relation in ("≻", ">")
    if rule == "positivity":
        grid = order_claim(equation, work.reading)
        found = prove_order(grid, strict, work)
        return Part("comparison" if found.comparison else "positivity", found) if found else None
    if rule == "trace order":
        found = prove_trace_order(lower_trace(equation.lhs - equation.rhs, work.reading), strict, work)
        return Part(rule, order=found) if found else None
    if equation.relation != "=":
        return None
    if rule == "expectation":
        return _expectation(equation, work)
    if rule == "gradient":
        return _gradient(equation, work)
    certificates = []
    for claim in claims(equation, rule, work.reading):  # type: ignore[arg-type]
        found = work.prove(claim.claim, claim.trace)
        if found is None:
            return None
        certificates.append(found)
    return Part(rule, Proof(tuple(certificates)))


def _gradient(equation: Equation, work: Workspace) -> Part | None:
    """Prove what a gradient is, from what holds for every gain and then from everything."""
    for image in images(equation, work):
        try:
            claim = gradient_claim(equation, image, work.reading)
        except Rejected:
            continue
        under = work.prove(inner(equation, work.reading) - image, trace=True, every_gain=True)
        after = work.prove(claim, trace=True) if under else None
        if under and after:
            return Part("gradient", Proof((under, after)), image=image)
    return None


def _expectation(equation: Equation, work: Workspace) -> Part | None:
    """Prove an equation between expectations from the equations of the signals and their moments."""
    for image in expanded(equation, work):
        after = work.prove(expect(image, work.reading.context))
        under = work.prove(inside(equation, work.reading) - image) if after else None
        if after and under:
            return Part("expectation", Proof((under, after)), image=image)
    return None


def _refute(equation: Equation, work: Workspace) -> Counterexample | None:
    """Search for a counterexample to one equation or inequality; blocks of an equation are tried one by one."""
    rule = rule_of(equation)
    if rule == "expectation":
        return _refute_expectation(equation, work)
    if rule == "gradient":
        left = gradient_of(equation, work)
        right = None if isinstance(equation.rhs, Zero) else lower(equation.rhs, work.reading)[0][0]
        return work.refute(left, right, seconds=REFUTE) if left is not None else None
    if rule in ("trace", "trace order"):
        left, right = (lower_trace(side, work.reading) for side in (equation.lhs, equation.rhs))
        if left.rows != right.rows:
            right = Poly(right.terms, left.rows, left.cols)
        return work.refute(left, right, equation.relation, trace=True, seconds=REFUTE)
    left = lower(equation.lhs, work.reading)
    difference = order_claim(equation, work.reading)
    if len(left) > 1 and equation.relation in ("⪰", "≻"):
        return None
    for row, others in zip(left, difference, strict=True):
        for p, d in zip(row, others, strict=True):
            found = work.refute(p, p - d, equation.relation, seconds=REFUTE)
            if found:
                return found
    return None


def _refute_expectation(equation: Equation, work: Workspace) -> Counterexample | None:
    nothing = Zero("", "")
    terms = [equation.lhs, equation.rhs][: 1 if equation.rhs == nothing else 2]
    sides = [expanded(replace(equation, lhs=term, rhs=nothing), work) for term in terms]
    if not all(sides):
        return None
    left, *right = (expect(images[0], work.reading.context) for images in sides)
    return work.refute(left, right[0] if right else None, equation.relation, seconds=REFUTE)


def _polys(equation: Equation, work: Workspace) -> list[Poly]:
    """Return the polynomials that an equation is about."""
    equation = oriented(equation, work.reading)
    rule = rule_of(equation)
    if rule in ("trace", "trace order"):
        return [lower_trace(side, work.reading) for side in (equation.lhs, equation.rhs)]
    if rule == "expectation":
        found = expanded(equation, work)
        if not found:
            expect(inside(equation, work.reading), work.reading.context)
        return [expect(p, work.reading.context) for p in found]
    if rule == "gradient":
        found = gradient_of(equation, work)
        if found is None:
            raise Rejected("no rule gives this gradient")
        return [found] if isinstance(equation.rhs, Zero) else [found, lower(equation.rhs, work.reading)[0][0]]
    grids: list[Grid] = [order_claim(equation, work.reading), lower(equation.lhs, work.reading)]
    return [p for grid in grids for row in grid for p in row]


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
            if rule_of(plain) in ("gradient", "trace", "trace order"):
                continue
            ((left,), *more), difference = lower(plain.lhs, work.reading), order_claim(plain, work.reading)
            if more:
                continue
            missing = without(work, name, left, left - difference[0][0], plain.relation, False)
            if missing:
                found[name] = missing
                break
    return found


def _undefined(found: Undefined, statement: Statement) -> Answer:
    return Answer(
        Verdict.refuted,
        "undefined",
        assumed=statement.assumed,
        counterexample=found.counterexample,
        notes=(f"the inverse of {_shown(found.body)} does not exist there",),
    )


def _undecided(statement: Statement, note: str) -> Answer:
    return Answer(Verdict.undecided, assumed=statement.assumed, notes=(note,))


# ------------------------------------------------------------------------------------------------ satisfiable
class Same:
    """A key by identity; a theory is never changed once it is made."""

    def __init__(self, theory: ClaimTheory):
        self.theory = theory

    def __hash__(self) -> int:
        return id(self.theory)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.theory is self.theory


def _satisfiable(statement: Statement, polys: Iterable[Poly]) -> bool:
    """Tell whether an exact instance of the hypotheses was found, assumptions included."""
    theory = statement.theory
    context = theory.reading.context
    assumed = [p for name, p in context.relations.items() if name.partition("[")[0] in statement.assumed]
    facts = [
        p for name in statement.assumed if name in context.facts for row in context.facts[name].matrix for p in row
    ]
    known = set(context.alphabet.letters)
    letters = {a.replace("'", "") for p in [*polys, *assumed, *facts] for _, w in p.terms for a in w}
    scalars = {s for p in polys for m, _ in p.terms for s in m}
    return _has_instance(
        Same(theory), frozenset(a for a in letters if a.partition("@")[0] in known), frozenset(scalars)
    )


@lru_cache(maxsize=1024)
def _has_instance(key: Same, letters: frozenset[str], scalars: frozenset[str]) -> bool:
    work = Workspace(key.theory, time.monotonic() + VACUITY)
    try:
        _justify_given(work)
    except (Undefined, Unjustified, Rejected):
        return False
    problem = work.problem()
    if problem is None:
        return False
    polys = [Poly({((), (a,)): 1}, *problem.alphabet.shape(a)) for a in sorted(letters)]
    polys += [identity("").scale(1, (s,)) for s in sorted(scalars) if s[0] not in "∫δ"]
    return satisfy(problem, polys, seconds=VACUITY) is not None


def _vacuous(statement: Statement, work: Workspace) -> Answer:
    """Say that no instance of the hypotheses was found; contradictory assumptions are an error.

    Raises:
        InputError: the assumptions contradict the theory.
    """
    if statement.assumed and _contradictory(work):
        names = ", ".join(statement.assumed)
        raise InputError(f"assume: expected relations that a plant can satisfy, got a contradiction from {names}")
    return _undecided(statement, "no instance that satisfies all hypotheses was found")


def _contradictory(work: Workspace) -> bool:
    """Tell whether I = 0 follows, or M ≻ 0 for a matrix with -M ⪰ 0."""
    context = work.reading.context
    sizes = {letter.rows for letter in context.alphabet.letters.values()} - {"1"}
    if any(work.prove(identity(size)) for size in sorted(sizes)):
        return True
    for fact in list(context.facts.values()):
        strict = {"pd": False, "psd": True}.get(fact.kind)
        if strict is not None and len(fact.matrix) == 1:
            turned: Grid = ((-fact.matrix[0][0],),)
            if prove_order(turned, strict, work, depth=1):
                return True
    return False
