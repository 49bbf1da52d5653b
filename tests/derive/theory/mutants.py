"""Single-site mutations of presentation terms: a dropped addend, a changed sign, a lost transpose, swapped factors.

Of the frequency domain: a lost modulus, maximum or conjugate, the other part of a root, other ends of an integral or
limit, the roots of another family, a sum over another count, a doubled number, a lost factor.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from functools import cache
from itertools import islice
from typing import Any

from derive.derivation import Outcome, Step, check, claims, learn, order_claim
from derive.functions import Abs, Definite, Infinity, Limit, Max, value
from derive.kernel import Rejected
from derive.scalars import RULES
from derive.spectral import Conjugate, Distance, Growth, ImaginaryPart, Modulus, RealPart, Roots, Total
from derive.terms import Block, Equation, Neg, Number, Product, Reading, Sum, Symbol, Term, Transpose, Zero
from derive.theory import lecture

ZERO = Zero("", "")


def mutants(term: Term, families: Sequence[Symbol] = ()) -> Iterator[Term]:
    """Iterate over the terms that differ from ``term`` at one place; ``families`` are roots and counts to swap in."""
    match term:
        case Sum(addends):
            for i, addend in enumerate(addends):
                rest = (*addends[:i], *addends[i + 1 :])
                yield rest[0] if len(rest) == 1 else Sum(rest)
                flipped = addend.body if isinstance(addend, Neg) else Neg(addend)
                yield Sum((*addends[:i], flipped, *addends[i + 1 :]))
        case Product(factors):
            for i in range(len(factors) - 1):
                swapped = (*factors[:i], factors[i + 1], factors[i], *factors[i + 2 :])
                if not any(isinstance(f, Number) or getattr(f, "scalar", False) for f in factors[i : i + 2]):
                    yield Product(swapped)
            for i in range(len(factors) if families else 0):
                rest = (*factors[:i], *factors[i + 1 :])
                yield rest[0] if len(rest) == 1 else Product(rest)
        case Transpose(body):
            yield body
        case Symbol(scalar=False):
            yield Transpose(term)
            return
        case _:
            yield from _spectral(term, families)
    yield from _below(term, families)


def _spectral(term: Term, families: Sequence[Symbol]) -> Iterator[Term]:
    """Iterate over mutations of a term of the frequency domain, or of a limit or integral, at its root."""
    match term:
        case Number(value) if families:
            yield Number(2 * value)
        case Abs(body) | Max(body) | Modulus(body) | Total(body, _, _):
            yield body
        case Conjugate(root):
            yield root
        case RealPart(root):
            yield ImaginaryPart(root)
        case ImaginaryPart(root):
            yield RealPart(root)
        case Definite(body, symbol, lower, upper):
            yield Definite(body, symbol, Neg(Infinity()) if lower == ZERO else ZERO, upper)
            yield Definite(body, symbol, upper, lower)
        case Limit(body, symbol, point):
            yield body
            yield Limit(body, symbol, ZERO if isinstance(point, Infinity) else Infinity())
        case Roots(point, root, index, count):
            yield Roots(point.body if isinstance(point, Neg) else Neg(point), root, index, count)
        case _:
            pass
    match term:
        case Max(body) | Abs(body):
            yield (Abs if isinstance(term, Max) else Max)(body)
        case Growth(root) | RealPart(root) | ImaginaryPart(root) | Conjugate(root) | Roots(_, root):
            yield from (replace(term, root=other) for other in _next(root, [r for r in families if r.glyph.sub]))
        case Distance(_, Symbol() as root):
            yield from (replace(term, root=other) for other in _next(root, [r for r in families if r.glyph.sub]))
        case _:
            pass
    if isinstance(term, (Roots, Total)):
        counts = [n for n in families if not n.glyph.sub]
        yield from (replace(term, count=other) for other in _next(term.count, counts))


def _next(symbol: Symbol, others: Sequence[Symbol]) -> Sequence[Symbol]:
    """Return the symbol that follows in a cycle."""
    if symbol not in others or len(others) == 1:
        return ()
    return (others[(others.index(symbol) + 1) % len(others)],)


def _below(term: Term, families: Sequence[Symbol]) -> Iterator[Term]:
    if isinstance(term, Block):
        for i, row in enumerate(term.rows):
            for j, entry in enumerate(row):
                for other in mutants(entry, families):
                    line = (*row[:j], other, *row[j + 1 :])
                    yield Block((*term.rows[:i], line, *term.rows[i + 1 :]))
        return
    for f in fields(term):  # type: ignore[arg-type]
        value = getattr(term, f.name)
        if isinstance(value, Term) and f.name != "symbol":
            for other in mutants(value, families):
                yield replace(term, **{f.name: other})  # type: ignore[type-var]
        elif isinstance(value, tuple):
            for i, entry in enumerate(value):
                if isinstance(entry, Term):
                    for other in mutants(entry, families):
                        yield replace(term, **{f.name: (*value[:i], other, *value[i + 1 :])})  # type: ignore[type-var]


# ------------------------------------------------------------------------------------------------ of whole lectures
@cache
def outcomes(key: str) -> tuple[Outcome, ...]:
    """Return what the replay says of each step of a lecture."""
    return tuple(lecture(key).verify())


@cache
def walk(key: str) -> tuple[tuple[Step, Reading, dict[str, Step]], ...]:
    """Return (step, what may be used before it, steps before it) for each step of a lecture."""
    item, earlier, found = lecture(key), dict[str, Step](), list[tuple[Step, Reading, dict[str, Step]]]()
    reading = item.theory.reading()
    for step in item.steps:
        found.append((step, reading, dict(earlier)))
        earlier[step.name] = step
        reading = learn(reading, item.theory, step)
    return tuple(found)


def meaning(statement: Equation, rule: str, reading: Reading) -> Any:
    """Return what a statement is read as under a rule."""
    if rule in ("positivity", "comparison", "uniqueness"):
        return order_claim(statement, reading)
    if rule in RULES:
        return value(statement.lhs, reading) - value(statement.rhs, reading)
    return [c.claim for c in claims(statement, rule, reading)]


def swapped_in(key: str) -> tuple[Symbol, ...]:
    """Return the roots of a theory, and how many there are of each."""
    t = lecture(key).theory
    counts = dict.fromkeys(f.count for f in t.families.values())
    return tuple(t.symbols[name] for name in (*t.families, *counts))


@cache
def judged(key: str) -> tuple[tuple[Step, Equation, bool, bool], ...]:
    """Return (step, mutated statement, whether it is read as the step's own, whether the kernel accepts it).

    Of the many mutations in the frequency domain one in twelve is tried, and all of numbered equations.
    """
    found: list[tuple[Step, Equation, bool, bool]] = []
    families = swapped_in(key)
    for number, (step, reading, earlier) in enumerate(walk(key)):
        own = _meaning(step.statement, step, reading)
        first, every = (number % 12, 12) if families and not step.number else (0, 1)
        for statement in islice(_changed(step.statement, families), first, None, every):
            accepted = _accepted(replace(step, statement=statement), reading, earlier)
            same = accepted and own is not None and _meaning(statement, step, reading) == own
            found.append((step, statement, same, accepted))
    return tuple(found)


def _changed(statement: Equation, families: Sequence[Symbol]) -> Iterator[Equation]:
    for side in ("lhs", "rhs"):
        for other in mutants(getattr(statement, side), families):
            changed = replace(statement, **{side: other})
            if changed != statement:
                yield changed


def _meaning(statement: Equation, step: Step, reading: Reading) -> Any:
    """Return what a statement is read as; a chain looks at the terms, and a limit is read by its rule only."""
    try:
        return None if step.rule == "chain" else meaning(statement, step.rule, reading)
    except Rejected:
        return None


def _accepted(step: Step, reading: Reading, earlier: dict[str, Step]) -> bool:
    try:
        check(step, reading, earlier)
    except Rejected:
        return False
    return True
