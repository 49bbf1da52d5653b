"""Which hypotheses a proof rests on, which it does not need, and what fails without one of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from derive.claim import Counterexample
from derive.context import Declared, DeclaredFact, DeclaredInverse
from derive.decide.ground import Introduced, Item, Lemma, leave_out
from derive.decide.parts import Part
from derive.decide.workspace import Workspace
from derive.kernel import Poly
from derive.kernel import Term as Addend
from derive.rules import Grid
from derive.terms import Symbol, walk
from derive.theory.claims.base import ClaimTheory

__all__ = [
    "addends_in",
    "addends_of",
    "free_gains",
    "inverses_in",
    "names_in",
    "not_needed",
    "pruned",
    "used",
    "without",
]

SUFFIX = re.compile(r"(\[\d+,\d+\]|\.left|\.right|\.value)$")


def names_in(part: Part) -> set[str]:
    """Return the relations and facts in the proof of an equation."""
    found = part.proof.relations()
    if part.order:
        found |= {t.relation for t in part.order.terms}
        found |= {name for p in part.order.products for name in (p.one, p.two)}
    return found


def _names_of(item: Item) -> set[str]:
    if isinstance(item, Introduced):
        return {t.relation for t in item.right + item.left} | ({item.because} - {""})
    from derive.derivation import Proof

    return Proof(positivity=item.positivity, comparison=item.comparison).relations()


def _polys(item: Item) -> Iterator[Poly]:
    if isinstance(item, Introduced):
        yield item.of
        if item.by is not None:
            yield item.by
        return
    yield from _blocks(item.matrix)
    if item.positivity:
        for square in item.positivity.squares:
            yield from _blocks(square.factor)
        if item.positivity.inverse is not None:
            yield item.positivity.inverse
    if item.comparison:
        yield item.comparison.matrix


def _blocks(grid: Grid) -> Iterator[Poly]:
    for row in grid:
        yield from row


def _letters(addends: Iterable[Addend], polys: Iterable[Poly]) -> set[str]:
    words = [w for t in addends for w in (t.left, t.right)] + [w for p in polys for _, w in p.terms]
    return {letter.replace("'", "") for w in words for letter in w}


def pruned(items: Sequence[Item], proof: Sequence[Part], polys: Iterable[Poly]) -> list[Item]:
    """Return the lemmas and inverses that the claim and its proof make use of, in their order."""
    names = {SUFFIX.sub("", n) for part in proof for n in names_in(part)}
    letters = _letters((), polys) | _letters(addends_in(proof), _squares(proof))
    kept: list[Item] = []
    for item in reversed(items):
        own = item.name if isinstance(item, Lemma) else item.letter
        if own in names or own in letters:
            kept.append(item)
            names |= {SUFFIX.sub("", n) for n in _names_of(item)}
            letters |= _letters(addends_of(item), _polys(item))
    return kept[::-1]


def addends_of(item: Item) -> list[Addend]:
    """Return the addends in the proof of a lemma or inverse."""
    if isinstance(item, Introduced):
        return [*item.right, *item.left]
    found: list[Addend] = list(item.comparison.terms) if item.comparison else []
    if item.positivity:
        found += [t for row in item.positivity.terms for ts in row for t in ts] + list(item.positivity.inverse_terms)
    return found


def addends_in(proof: Sequence[Part]) -> list[Addend]:
    """Return the addends in the proofs of the equations."""
    found: list[Addend] = []
    for part in proof:
        found += [t for c in part.proof.identities for t in c.terms]
        found += part.order.terms if part.order else ()
        found += addends_of(Lemma("", "", (), part.proof.positivity, part.proof.comparison))
    return found


def _squares(proof: Sequence[Part]) -> list[Poly]:
    images = [part.image for part in proof if part.image is not None]
    return images + [
        p for part in proof for p in _polys(Lemma("", "", (), part.proof.positivity, part.proof.comparison))
    ]


def used(names: Iterable[str], items: Sequence[Item], theory: ClaimTheory) -> tuple[str, ...]:
    """Return the declarations of the theory that some relations and facts rest on, in their order.

    An inverse stands for the reason why it exists, a lemma for what proves it.
    """
    own: Mapping[str, Item] = {i.name if isinstance(i, Lemma) else i.letter: i for i in items}
    seen, waiting = set[str](), {SUFFIX.sub("", n) for n in names}
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        declared = theory.theory.declared.get(name)
        if name in own:
            waiting |= {SUFFIX.sub("", n) for n in _names_of(own[name])}
        elif isinstance(declared, DeclaredInverse):
            waiting |= {declared.because} if isinstance(declared.because, str) else set(declared.because)
    kinds = (Declared, DeclaredFact)
    return tuple(name for name, item in theory.theory.declared.items() if name in seen and isinstance(item, kinds))


def inverses_in(polys: Iterable[Poly], work: Workspace) -> set[str]:
    """Return the letters for inverses that occur in some polynomials."""
    return _letters((), polys) & set(work.reading.inverses.values())


def not_needed(symbols: Iterable[Symbol], used_names: Iterable[str], theory: ClaimTheory) -> tuple[str, ...]:
    """Return the hypotheses on the letters of a claim alone that its proof does not use."""
    letters, known = {s.name for s in symbols}, set(used_names)
    reading = theory.reading
    found: list[str] = []
    for name, item in theory.theory.declared.items():
        if name in known or name in reading.real.cases or not _is_hypothesis(item):
            continue
        below = {n.name for t in _terms(item) for n in walk(t) if isinstance(n, Symbol)}
        if below and below <= letters:
            found.append(name)
    return tuple(found)


def _is_hypothesis(item: object) -> bool:
    return isinstance(item, DeclaredFact) or (isinstance(item, Declared) and item.kind == "hypothesis")


def _terms(item: object):
    from derive.context import terms_of

    return terms_of(item)  # type: ignore[arg-type]


def free_gains(symbols: Iterable[Symbol], used_names: Iterable[str], theory: ClaimTheory) -> tuple[Symbol, ...]:
    """Return the gains of a claim whose optimum its proof does not use."""
    if theory.optimal & set(used_names):
        return ()
    gains = {
        item.statement.lhs.name
        for name in theory.optimal
        if isinstance(item := theory.theory.declared.get(name), Declared) and isinstance(item.statement.lhs, Symbol)
    }
    return tuple(s for s in symbols if s.name in gains)


def without(work: Workspace, name: str, lhs: Poly, rhs: Poly, relation: str, trace: bool) -> Counterexample | None:
    """Search for a counterexample to a claim when one hypothesis is dropped."""
    from dataclasses import replace

    from derive.matrix.refute import refute

    problem = work.problem()
    if problem is None:
        return None
    relations = leave_out([name], problem.relations)
    facts = {n: f for n, f in problem.facts.items() if n != name and n not in work.theory.proved_by}
    fewer = replace(problem, relations=relations, facts=facts)
    return refute(lhs, rhs, fewer, relation=relation, trace=trace, most=400, seconds=work.left)
