"""Which hypotheses a proof about numbers rests on, for the reader."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.context import Declared, DeclaredFact, DeclaredInverse
from derive.interpret.statement import Statement
from derive.latex import plain
from derive.scalar.proof import Proof, Reason, Step, Turned, leaves
from derive.scalar.ratio import Beyond, name_of
from derive.scalar.system import System
from derive.terms import Dot, Symbol, Term, walk

__all__ = ["bearing_names", "letters_of", "used_names"]


def letters_of(statement: Statement) -> set[str]:
    """Return the letters of a claim, derivatives as letters of their own."""
    return {name for e in statement.equations for side in (e.lhs, e.rhs) for name in _names(side)}


def _names(term: Term) -> Iterator[str]:
    for node in walk(term):
        if isinstance(node, Dot):
            yield from ("d/dt " + n.name for n in walk(node) if isinstance(n, Symbol) and n.args)
        if isinstance(node, Symbol):
            try:
                yield name_of(node)
            except Beyond:
                continue


def bearing_names(statement: Statement, known: System) -> list[str]:
    """Return the hypotheses that bear on a claim, without the letters of inverses."""
    inverses = {d.name for d in statement.theory.theory.declared.values() if isinstance(d, DeclaredInverse)}
    named = dict.fromkeys((*known.origins.values(), *known.solved.values(), *statement.assumed))
    return [n for n in named if n and n not in inverses]


def used_names(statement: Statement, systems: Sequence[System], proof: Proof) -> set[str]:
    """Return the declarations behind the facts that a proof uses, and behind letters that stand for others.

    An equation that gives a letter away is used if the letter occurs in the claim or in what is used.
    """
    facts = {name for leaf in leaves(proof) for step in leaf.steps for name in _facts(step)}
    said = _said(statement)
    found, letters = set[str](), letters_of(statement)
    for known in systems:
        for x in letters & known.values.keys():
            for factor, _ in known.values[x].bottom:
                known.nonzero(factor)  # notes what it consults
        consulted = facts | known.consulted
        for name, (_, poly) in known.facts.items():
            names = {x for m, _ in known.ring.poly(poly).terms for x in m}
            if name in consulted or (known.ring.size(poly) == 1 and len(names) == 1 and names <= consulted):
                found.add(known.origins[name])
        found |= {known.origins[n] for n in known.relations if n in facts}
    solved = {x: by for known in systems for x, by in known.solved.items() if by}
    while True:
        below = {x for name in found for x in said.get(name, ())}
        more = {solved[x] for x in letters | below if x in solved} - found
        if not more:
            return found - {""}
        found |= more


def _said(statement: Statement) -> dict[str, set[str]]:
    """Return the letters of every declaration."""
    found: dict[str, set[str]] = {}
    for item in statement.theory.theory.declared.values():
        match item:
            case Declared(name=name, statement=equation):
                found[name] = {*_names(equation.lhs), *_names(equation.rhs)}
            case DeclaredFact(name=name, matrix=matrix):
                found[name] = set(_names(matrix))
            case DeclaredInverse(name=name, of=of):
                found[name] = set(_names(of))
            case _:
                continue
    for equation in statement.theory.conditions:
        found[plain(equation)] = {*_names(equation.lhs), *_names(equation.rhs)}
    return found


def _facts(step: Step) -> Iterator[str]:
    match step:
        case Reason(factors=factors, used=used):
            yield from used
            yield from (name for f in factors if f.reason is not None for name in _facts(f.reason))
        case Turned(reason=reason):
            yield from _facts(reason)
        case _:
            return
