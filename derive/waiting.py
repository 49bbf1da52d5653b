"""When a declaration is tried: as soon as what it waits for has come, and not in vain before.

What comes into force and why is decided in adopting.py; here it is only decided when that is asked. Standard library
only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from derive.declared import Declared, DeclaredAtom, Item, defines, terms_of
from derive.functions import KINDS, Log, Quotient
from derive.terms import Reading, Symbol, Term, walk


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


def waits_of(declared: Mapping[str, Item]) -> dict[str, Wait]:
    """Return what each declaration waits for."""
    definitions = {
        d.statement.lhs.name: name
        for name, d in declared.items()
        if isinstance(d, Declared) and defines(d) and isinstance(d.statement.lhs, Symbol) and d.statement.lhs.scalar
    }
    atoms: dict[tuple[str, Term], set[str]] = {}
    for name, item in declared.items():
        if isinstance(item, DeclaredAtom):
            atoms.setdefault((item.kind, item.of), set()).add(name)
    return {name: _wait(name, item, definitions, atoms) for name, item in declared.items()}


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
