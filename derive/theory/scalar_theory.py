"""A theory of many scalars: each declaration is tried only when what it waits for has come.

What comes into force and why is decided by ``declare``; here it is only decided when it is asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.context import Declared, DeclaredAtom, DeclaredFact, DeclaredInverse, Theory, declare, defines, terms_of
from derive.functions import KINDS, Log, Quotient
from derive.terms import Equation, MissingInverse, Reading, Symbol, Term, walk

__all__ = ["ScalarTheory"]

Item = Declared | DeclaredInverse | DeclaredFact | DeclaredAtom


@dataclass(frozen=True)
class Wait:
    """What a declaration waits for: a fact, declarations, and one of each set of atoms that stand for the same."""

    fact: str
    declarations: frozenset[str]
    atoms: tuple[frozenset[str], ...]

    def over(self, reading: Reading) -> bool:
        """Tell whether everything has come."""
        adopted, facts = reading.adopted, reading.context.facts
        come = self.declarations <= adopted and all(not names.isdisjoint(adopted) for names in self.atoms)
        return come and (not self.fact or self.fact in facts)


@dataclass
class ScalarTheory(Theory):
    """A theory whose ``settle`` does not try in vain."""

    waits: dict[str, Wait] = field(default_factory=dict[str, Wait])

    def settle(self, reading: Reading, learnt: Equation | None = None) -> Reading:
        """Adopt every declaration that what is there allows, until nothing more comes; an equation brings nothing."""
        if learnt is not None and learnt.relation == "=":
            return reading
        if self.waits.keys() != self.declared.keys():
            self.waits = self._waits()
        before: frozenset[str] | None = None
        while before != reading.adopted:
            before = reading.adopted
            for name, wait in self.waits.items():
                if name not in reading.adopted and wait.over(reading):
                    try:
                        reading = declare(reading, self.declared[name])
                    except MissingInverse:
                        continue
        return reading

    def _waits(self) -> dict[str, Wait]:
        definitions = {
            d.statement.lhs.name: name
            for name, d in self.declared.items()
            if isinstance(d, Declared) and defines(d) and isinstance(d.statement.lhs, Symbol)
        }
        atoms: dict[tuple[str, Term], set[str]] = {}
        for name, item in self.declared.items():
            if isinstance(item, DeclaredAtom):
                atoms.setdefault((item.kind, item.of), set()).add(name)
        return {name: _wait(name, item, definitions, atoms) for name, item in self.declared.items()}


def _wait(name: str, item: Item, definitions: dict[str, str], atoms: dict[tuple[str, Term], set[str]]) -> Wait:
    nodes = [node for term in terms_of(item) for node in walk(term)]
    used = {definitions[n.name] for n in nodes if isinstance(n, Symbol) and n.name in definitions}
    wanted = {frozenset(atoms[key]) for node in nodes for key in _functions(node) if key in atoms}
    fact = item.because if isinstance(item, DeclaredAtom) else ""
    return Wait(fact, frozenset(used - {name}), tuple(names for names in wanted if name not in names))


def _functions(node: Term) -> Iterator[tuple[str, Term]]:
    """Iterate over the atoms, by kind and argument, that a term needs to be read."""
    match node:
        case Log(Quotient(top, bottom)):
            yield "log", top
            yield "log", bottom
        case Quotient(_, bottom):
            yield "reciprocal", bottom
        case _ if type(node) in KINDS:
            yield KINDS[type(node)], node.body  # type: ignore[attr-defined]
        case _:
            pass
