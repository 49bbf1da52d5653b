"""How a declaration or a proved statement extends what may be used, and which hypotheses are let in.

A definition or equation becomes a relation, an inequality a fact, d/dt x = f and E[a b'] = f entries of tables. An
inverse, root, quotient or logarithm comes with the reason why it exists, and waits for it. Standard library only.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

from derive.analysis import is_scalar
from derive.declared import Declared, DeclaredAtom, DeclaredFact, DeclaredInverse, Item, names_of_roots, terms_of
from derive.entries import behind
from derive.functions import Limit, Power, Start, value
from derive.kernel import Poly, Rejected, identity
from derive.real import COMPLEX, FREQUENCY, RESERVED, STEPS, TIME, UNIT, scalar, scalars_of
from derive.roots import is_real
from derive.rules import Fact, Grid
from derive.scalars import adopt_atom, adopt_scalar
from derive.spectral import Det, Roots
from derive.terms import (
    Dot,
    Equation,
    Expect,
    MissingInverse,
    Product,
    Reading,
    Sum,
    Symbol,
    Term,
    Trace,
    Transpose,
    Zero,
    lower,
    walk,
)

FACT_OF = {"⪰": "psd", "≻": "pd"}
KINDS = ("hurwitz", "schur", "invertible", "initial", "single")  # hypotheses on a matrix that are no (in)equality


def declare(reading: Reading, item: Item) -> Reading:
    """Extend a reading by one declaration of the theory."""
    _check_hypothesis(item, reading)
    if isinstance(item, Declared) and item.statement.relation == ":=" and isinstance(item.statement.lhs, Symbol):
        below = frozenset(n.name for n in walk(item.statement.rhs) if isinstance(n, Symbol))
        letters = {**reading.real.letters, item.statement.lhs.name: below}
        _check_letter(item.statement, reading)
        reading = replace(reading, real=replace(reading.real, letters=letters))
    reading = replace(
        reading, real=replace(reading.real, fixed={**reading.real.fixed, item.name: _fixed(item, reading)})
    )
    if isinstance(item, Declared):
        reading = adopt(reading, item.name, item.statement)
    elif isinstance(item, DeclaredFact):
        if item.kind not in KINDS:
            raise Rejected(f"{item.name}: {item.kind} is no kind of matrix")
        reading = _with_fact(reading, item.name, Fact(item.kind, lower(item.matrix, reading)))
    elif isinstance(item, DeclaredAtom):
        reading = adopt_atom(reading, item.name, item.kind, item.of, item.because)
    else:
        reading = adopt_inverse(reading, item)
    return replace(reading, adopted=reading.adopted | {item.name})


def _check_letter(statement: Equation, reading: Reading) -> None:
    """Reject the definition of a matrix that depends on s or j, unless the letter is said to be complex."""
    lhs = statement.lhs
    if isinstance(lhs, Symbol) and not lhs.scalar and lhs.name not in reading.context.complex:
        polys = [poly for row in lower(statement.rhs, reading) for poly in row]
        if any(behind(poly, reading) & {COMPLEX, UNIT} for poly in polys):
            raise Rejected(f"{lhs.name} is not declared to be complex, but what it stands for may be")


def _fixed(item: Item, reading: Reading) -> frozenset[str]:
    """Return the scalars that a hypothesis holds at some value, and that no limit or derivative may move.

    x > 0 and x ≥ 0 are true of all values that a variable takes, but the number of steps is 0 as well; so is an
    equation between functions of s. What is declared for every number of steps holds k nowhere.
    """
    if isinstance(item, (DeclaredInverse, DeclaredAtom)) or (isinstance(item, Declared) and item.generic):
        return frozenset()
    real = reading.real
    nodes = [n for t in terms_of(item) for n in walk(t)]
    found = reading.real.reached(n.name for n in nodes if isinstance(n, Symbol))
    found -= {name for f in reading.real.families.values() for name in (f.index, f.count)}
    functions = [n for node in nodes if isinstance(node, (Det, Trace, Roots)) for n in walk(node)]
    if isinstance(item, DeclaredFact) or any(isinstance(n, Symbol) and n.name == COMPLEX for n in functions):
        found -= {COMPLEX}
    if any(isinstance(n, Symbol) and not n.scalar and n.name in reading.context.complex for n in nodes):
        found -= {COMPLEX}
    match item:
        case Declared(every=True):
            return frozenset(found - {STEPS})
        case Declared(statement=Equation(Symbol(name=name), ">" | "≥", Zero())) if not (
            name in real.atoms or (real.sequences and real.varies(name, STEPS))
        ):
            return frozenset()
        case Declared(statement=Equation(Symbol(scalar=True), ":=", _)):
            return frozenset()
        case Declared(statement=Equation(Limit(_, symbol, _), _, _)):
            return frozenset(found - {symbol.name})
        case _:
            return frozenset(found)


def _check_hypothesis(item: Item, reading: Reading) -> None:
    """Reject a hypothesis on an arbitrary parameter, unless it holds for all but one value of a variable.

    A scalar may be defined by one, and an atom made of it: its reason is a fact that is proved. The same for a running
    parameter r, of which it is known that r > 0.
    """
    if isinstance(item, DeclaredAtom):
        return
    real, names = reading.real, {n.name for t in terms_of(item) for n in walk(t) if isinstance(n, Symbol)}
    _check_recursion(item, names, reading)
    match item:
        case Declared(statement=Equation(Sum((Power(x, 2), Power(a, 2))), ">", Zero())) if item.generic:
            shift, width = value(x, reading) - scalar(item.generic), value(a, reading)
            used, steps = scalars_of(shift) | scalars_of(width), (STEPS,) if real.sequences else ()
            variables = (COMPLEX, FREQUENCY, TIME, *steps, *real.running)
            moving = any(real.varies(s, v) for s in used for v in variables)
            if (
                item.generic not in (COMPLEX, FREQUENCY, *real.running)
                or moving
                or not (is_real(shift, reading) and is_real(width, reading))
            ):
                raise Rejected(
                    f"{item.name}: x must be the variable and a real shift, a must be real and not depend on it"
                )
        case Declared(statement=Equation(Symbol(name=r), ">", Zero())) if r in real.running and not item.generic:
            pass
        case Declared(statement=Equation(Symbol(scalar=True) as lhs, ":=", _)) if not item.generic:
            if lhs.name in RESERVED | real.arbitrary | real.running | names_of_roots(real.families):
                raise Rejected(f"{item.name}: {lhs.name} has a meaning already")
        case _ if getattr(item, "generic", "") or real.reached(names) & (real.arbitrary | real.running):
            raise Rejected(f"{item.name}: nothing may be assumed of an arbitrary or running parameter")
        case _:
            pass


def _check_recursion(item: Item, names: set[str], reading: Reading) -> None:
    """Reject a next member that depends on what the rules vary, and what is said of every k but is no recursion."""
    if not isinstance(item, Declared):
        return
    lhs, real, next_ = item.statement.lhs, reading.real, reading.real.following
    defines = item.statement.relation == ":=" and isinstance(lhs, Symbol) and lhs.name in next_
    starts = isinstance(lhs, Start) and item.statement.relation == ":="
    if item.every and not starts and (item.statement.relation != "=" or not names & (next_ - real.pending)):
        raise Rejected(f"{item.name}: it does not say how a sequence goes on")
    if item.every and not starts and not scalars_of(value(lhs, reading) - value(item.statement.rhs, reading)) & next_:
        raise Rejected(f"{item.name}: the next member drops out of it")
    varied = {COMPLEX, UNIT, FREQUENCY, *real.arbitrary, *real.running} | names_of_roots(real.families)
    if (defines or item.every) and real.reached(names) & (varied | ({TIME} if item.every else set())):
        raise Rejected(f"{item.name}: a sequence depends on nothing that the rules vary")
    if defines and not is_real(value(item.statement.rhs, reading), reading):
        raise Rejected(f"{item.name}: a sequence consists of real numbers")


def adopt(reading: Reading, name: str, statement: Equation) -> Reading:
    """Extend a reading by a statement that is declared or proved.

    d/dt x = f and E[a b'] = f become entries of the tables of derivatives and moments, X >= 0 and X > 0 facts,
    everything else a relation lhs - rhs = 0 (one a block).
    """
    context, lhs, rhs = reading.context, statement.lhs, statement.rhs
    if is_scalar(statement):
        return adopt_scalar(reading, name, statement)
    if statement.relation in FACT_OF:
        matrix = lower(lhs, reading) if _is_zero(rhs) else _difference(statement, reading)
        return _with_fact(reading, name, Fact(FACT_OF[statement.relation], matrix))
    if statement.relation not in ("=", ":="):
        raise Rejected(f"{statement.relation} is no relation between matrices")
    match lhs:
        case Dot(Symbol() as x) if x.letter not in context.derivatives:
            ((rate,),) = lower(rhs, reading)
            context = replace(context, derivatives={**context.derivatives, x.letter: rate})
            return replace(reading, context=context, origins={**reading.origins, x.letter: name})
        case Expect(Product((Symbol() as a, Transpose(Symbol() as b)))):
            ((moment,),) = lower(rhs, reading)
            key = (a.letter, context.alphabet.flip(b.letter))
            if key not in context.moments:
                context = replace(context, moments={**context.moments, key: moment})
                return replace(reading, context=context, origins={**reading.origins, key: name})
        case _:
            pass
    grid = _difference(statement, reading)
    named = {
        name if len(grid) == len(row) == 1 else f"{name}[{i + 1},{j + 1}]": p
        for i, row in enumerate(grid)
        for j, p in enumerate(row)
        if p.terms
    }
    return replace(reading, context=replace(context, relations={**context.relations, **named}))


def adopt_inverse(reading: Reading, item: DeclaredInverse) -> Reading:
    """Extend a reading by the two relations of an inverse, if its reason holds.

    M X = I, X M = I;  the inverse of a matrix that may be complex may be complex

    Raises:
        MissingInverse: the reason is not proved yet.
        Rejected: the reason is about something else.
    """
    context = reading.context
    ((poly,),) = lower(item.of, reading)
    _check_reason(item, poly, reading)
    if context.alphabet.letters[item.name].symmetric and context.alphabet.transpose(poly) != poly:
        raise Rejected(f"{item.name} is declared symmetric, but what it inverts is not")
    inverse = Poly({((), (item.name,)): Fraction(1)}, poly.cols, poly.rows)
    relations = {
        **context.relations,
        f"{item.name}.right": poly * inverse - identity(poly.rows),
        f"{item.name}.left": inverse * poly - identity(poly.cols),
    }
    because = (item.because,) if isinstance(item.because, str) else item.because
    real = replace(reading.real, reasons={**reading.real.reasons, item.name: because})
    unreal = context.complex if context.is_real(poly) else context.complex | {item.name}
    context = replace(context, relations=relations, complex=unreal)
    return replace(reading, context=context, inverses={**reading.inverses, poly: item.name}, real=real)


def _check_reason(item: DeclaredInverse, poly: Poly, reading: Reading) -> None:
    """Reject an inverse of M without a reason: M > 0, M invertible, or M X = I and X M = I for the term X."""
    context = reading.context
    if isinstance(item.because, str):
        fact = context.facts.get(item.because)
        found = fact and fact.kind in ("pd", "invertible") and fact.matrix == ((poly,),)
        missing = [] if fact else [item.because]
    else:
        ((by,),) = lower(item.by or item.of, reading)
        wanted = (poly * by - identity(poly.rows), by * poly - identity(poly.cols))
        missing = [name for name in item.because if name not in context.relations]
        found = all(context.relations.get(n) == p for n, p in zip(item.because, wanted, strict=True))
    if missing:
        raise MissingInverse(f"{' and '.join(missing)} not proved yet")
    if not found:
        raise Rejected(f"{item.because} is not a reason why {item.name} exists")


class Consulted(dict):  # type: ignore[type-arg]
    """A table of derivatives or moments that notes which of its entries were read."""

    def __init__(self, table: Mapping[Any, Poly]):
        super().__init__(table)
        self.read: set[Any] = set()

    def get(self, key: Any, default: Any = None) -> Any:
        """Return the entry and note it."""
        if key in self:
            self.read.add(key)
        return super().get(key, default)

    def __getitem__(self, key: Any) -> Poly:
        self.read.add(key)
        return super().__getitem__(key)


def consulting(reading: Reading) -> tuple[Reading, Consulted, Consulted]:
    """Return the reading with tables that note what is read."""
    derivatives, moments = Consulted(reading.context.derivatives), Consulted(reading.context.moments)
    context = replace(reading.context, derivatives=derivatives, moments=moments)
    return replace(reading, context=context), derivatives, moments


def names_of(name: str, relations: Iterable[str]) -> list[str]:
    """Return the relations that a declaration or lemma stands for: itself, its blocks, or both sides of an inverse."""
    return [relation for relation in relations if name in _names(relation)]


def by_name(relations: Iterable[str]) -> dict[str, list[str]]:
    """Return the relations that each name stands for."""
    found: dict[str, list[str]] = {}
    for relation in relations:
        for name in _names(relation):
            found.setdefault(name, []).append(relation)
    return found


@lru_cache(maxsize=1 << 14)
def _names(relation: str) -> tuple[str, ...]:
    """Return a relation, and what is in front of each bracket or dot in its name."""
    return (relation, *(relation[:i] for i, letter in enumerate(relation) if letter in "[."))


@lru_cache(maxsize=1 << 14)
def owner(name: str) -> str:
    """Return the declaration or lemma that a relation stands for."""
    return re.sub(r"(\[\d+,\d+\]|\.left|\.right)$", "", name)


def _with_fact(reading: Reading, name: str, fact: Fact) -> Reading:
    return replace(reading, context=replace(reading.context, facts={**reading.context.facts, name: fact}))


def _is_zero(term: Term) -> bool:
    return isinstance(term, Zero)


def _difference(statement: Equation, reading: Reading) -> Grid:
    if _is_zero(statement.rhs):
        return lower(statement.lhs, reading)
    lhs, rhs = lower(statement.lhs, reading), lower(statement.rhs, reading)
    if len(lhs) != len(rhs) or len(lhs[0]) != len(rhs[0]):
        raise Rejected("the two sides have different block shapes")
    return tuple(tuple(p - q for p, q in zip(r, s, strict=True)) for r, s in zip(lhs, rhs, strict=True))
