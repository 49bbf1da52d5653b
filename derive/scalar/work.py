"""A statement about numbers with the instances of its theory, and how instances contradict it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from derive.context import Declared, DeclaredInverse
from derive.interpret.statement import Statement
from derive.scalar.evaluate import Undefined, Unsure, holds, plain
from derive.scalar.flint_ring import FlintRing
from derive.scalar.hypotheses import names_in, system
from derive.scalar.instances import Instance, Instances, Several
from derive.scalar.ratio import Beyond, name_of
from derive.scalar.reasons import letters_of
from derive.scalar.system import POWERS, ROOTS, Case, Split, System
from derive.terms import Dot, Equation, Symbol, walk
from derive.theory.claims.base import split_index

__all__ = ["Failure", "Work"]

TIMES = ("t", "τ", "t0")
MOST = 4  # signs that split the hypotheses


@dataclass(frozen=True)
class Failure:
    """An instance at which a claim is false, or undefined for a reason."""

    instance: Instance
    number: int  # of the equation
    left: Any = None
    right: Any = None
    undefined: str = ""

    @property
    def exact(self) -> bool:
        """Whether all that is shown is rational."""
        return not self.instance.roots and not self.undefined and None not in (plain(self.left), plain(self.right))


@dataclass
class Work:
    """A statement with the instances of its theory."""

    statement: Statement
    ring: FlintRing
    names: Sequence[str]
    known: System
    cases: tuple[System, ...]
    instances: Several
    deadline: float
    shown: list[str] = field(default_factory=list[str])
    moving: str = ""  # why values at one instant refute nothing
    varying: list[str] = field(default_factory=list[str])  # letters that vary with time

    @classmethod
    def of(cls, statement: Statement, deadline: float, without: frozenset[str] = frozenset()) -> Work:
        """Read the hypotheses, in two cases where a sign decides what they say."""
        names = names_in(statement)
        ring = FlintRing([*names, *ROOTS, *POWERS])
        cases = tuple(_systems(statement, ring, without))
        known = next((c for c in cases if not c.impossible), cases[0])
        instances = Several([Instances(c, ring, names) for c in cases])
        shown = _shown(statement, known)
        symbols = statement.theory.theory.symbols
        stems = {n: symbols.get(n.partition("@")[0]) for n in letters_of(statement)}
        varying = [n for n, symbol in stems.items() if symbol is not None and symbol.args]
        return cls(statement, ring, names, known, cases, instances, deadline, shown, moving(statement), varying)

    def failures(self, instances: Iterable[Instance]) -> Iterator[Failure]:
        """Iterate over the instances that contradict the statement."""
        for instance in instances:
            if monotonic() > self.deadline:
                return
            found = self.failure(instance)
            if found is not None:
                yield found

    def failure(self, instance: Instance) -> Failure | None:
        """Return how an instance contradicts the statement, if it does.

        A covariance that varies is taken positive: it starts so, and stays so.
        """
        if self.moving or any(instance.values.get(n, 1) == 0 for n in self.varying):
            return None
        for i, equation in enumerate(self.statement.equations):
            try:
                answer, left, right = holds(equation, instance.values)
            except Undefined as error:
                return Failure(instance, i, undefined=str(error))
            except Unsure:
                continue
            if answer is False:
                return Failure(instance, i, left, right)
        return None

    def simplest(self, failures: Iterable[Failure]) -> Failure | None:
        """Return the failure that is easiest to follow: both sides exact, small numbers."""
        return min(failures, default=None, key=self.rank)

    def rank(self, failure: Failure) -> tuple[Any, ...]:
        """Order failures: a false value before an undefined one, rational before not, small before large."""
        return bool(failure.undefined), not failure.exact, failure.instance.size(self.shown)


def moving(statement: Statement) -> str:
    """Return why free values of letters may not be those of one solution: several times, or unlike indices."""
    symbols = [n for e in statement.equations for side in (e.lhs, e.rhs) for n in walk(side) if isinstance(n, Symbol)]
    if any(n.args not in ((), ("t",)) or n.name in TIMES for n in symbols):
        return "a function of time is not refuted by values at one instant"
    if _undeclared_rate(statement):
        return "a rate that the theory does not declare is not refuted by values at one instant"
    known = statement.theory.theory.symbols
    indices = {split_index(n.name)[1] for n in symbols if n.name in known and split_index(n.name)[0] != n.name}
    kinds = {"" if i.isdigit() else i[:1] for i in indices if i}
    return "indices that no step connects" if len(kinds) > 1 else ""


def _undeclared_rate(statement: Statement) -> bool:
    """Tell whether a claim has the derivative of a letter that an equation determines, but not its derivative."""
    equations = [d.statement for d in statement.theory.theory.declared.values() if isinstance(d, Declared)]
    found = {e.lhs for e in equations if e.relation in ("=", ":=")}
    nodes = [n for e in statement.equations for side in (e.lhs, e.rhs) for n in walk(side) if isinstance(n, Dot)]
    letters = {n for node in nodes for n in walk(node) if isinstance(n, Symbol) and n.args}
    return any(x in found and Dot(x) not in found for x in letters)


def _systems(
    statement: Statement, ring: FlintRing, without: frozenset[str], cases: tuple[Case, ...] = ()
) -> Iterator[System]:
    try:
        yield system(statement, ring, cases, without)
    except Split as split:
        if len(cases) > MOST:
            raise Beyond("too many cases") from None
        yield from _systems(statement, ring, without, (*cases, ("nonnegative", split.poly)))
        yield from _systems(statement, ring, without, (*cases, ("nonnegative", -split.poly)))


def _shown(statement: Statement, known: System) -> list[str]:
    """Return the letters of an instance that a reader needs, without inverses and what the claim does not mention."""
    theory, used = statement.theory.theory, letters_of(statement)
    hidden = {d.name for d in theory.declared.values() if isinstance(d, DeclaredInverse)}
    for item in theory.declared.values():
        match item:
            case Declared(name=name, statement=Equation(lhs=Symbol() as lhs)):
                if known.solved.get(name_of(lhs)) == name and name_of(lhs) not in used:
                    hidden.add(name_of(lhs))
            case _:
                pass
    order = [n for n in theory.symbols if n in theory.symbols]
    names = [n for n in names_in(statement) if n not in hidden and not n.startswith("d/dt ")]
    return sorted(names, key=lambda n: order.index(n) if n in order else len(order))
