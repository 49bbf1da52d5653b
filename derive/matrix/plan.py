"""What to choose and what to compute when an instance of some hypotheses is built.

Inverse letters are computed from what they invert. A relation with a lone letter (X in X = f, the noise in a Riccati
equation) is solved for it. Any other relation is first tried at a random instance: if it holds there, it follows from
the rest; else it is solved for a letter that occurs linearly. The letters declared last are solved for first, and no
letter may depend on itself. All other letters are free. What is chosen here decides how fast an instance is found, not
whether it is one: every hypothesis is tested in the end.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from derive.kernel import Poly, parts
from derive.matrix.bearing import Bearing, bearing, lone
from derive.matrix.hypotheses import Hypotheses
from derive.matrix.instance import Instance, base, unknowns
from derive.matrix.solve import Rule
from derive.rules import Fact

__all__ = ["Plan", "make_plans"]

PROBES = 3  # random instances that are tried for one that exists
PROBE_SIZE = 2


@dataclass(frozen=True)
class Plan:
    """Free letters and scalars in order, the rules for the others, and what is tested in the end.

    ``shown`` are the letters that the claim depends on, without twins.
    """

    free: tuple[str, ...]
    free_scalars: tuple[str, ...]
    rules: tuple[Rule, ...]
    relations: Mapping[str, Poly]
    central: Mapping[str, Poly]
    facts: Mapping[str, Fact]
    shown: frozenset[str]


def make_plans(problem: Hypotheses, claim: Iterable[Poly]) -> list[Plan]:
    """Return ways to build instances of the hypotheses that bear on a claim; none if an integral is among them.

    The first lets free letters that the claim does not mention equal one of their kind, P_1 = P; the last does not.
    """
    polys = list(claim)
    wanted = set[str]().union(*map(unknowns, polys))
    bears = bearing(problem, wanted)
    scalars = bears.scalars() | {s for p in polys for m, _ in p.terms for s in m}
    if any(s[0] == "∫" for s in scalars):
        return []
    scalars = {s for s in scalars if s[0] != "δ"}
    rules = Chooser(problem, bears, scalars).choose()
    twins = _twins(problem, bears.letters, wanted, rules)
    shown = frozenset(depends(wanted, rules)) - {rule.target for rule in twins}
    return [_plan(problem, bears, scalars, shown, r) for r in ([rules + twins, rules] if twins else [rules])]


def _plan(problem: Hypotheses, bears: Bearing, scalars: set[str], shown: frozenset[str], rules: list[Rule]) -> Plan:
    targets = {rule.target for rule in rules}
    return Plan(
        tuple(_by_declaration(problem, bears.letters - targets)),
        tuple(sorted(scalars - targets)),
        ordered(rules),
        bears.relations,
        bears.central,
        bears.facts,
        shown,
    )


def _twins(problem: Hypotheses, letters: Iterable[str], wanted: set[str], rules: list[Rule]) -> list[Rule]:
    """Set free letters outside the claim to the first letter of the same type whose name begins with the same sign."""
    found: list[Rule] = []
    known = _by_declaration(problem, letters)
    for a in known:
        if a in wanted or a in {rule.target for rule in rules + found}:
            continue
        like = (b for b in known if b != a and b[0] == a[0] and _type(problem, b) == _type(problem, a))
        twin = next((b for b in like if a not in depends({b}, rules + found)), None)
        if twin is not None:
            found.append(Rule(a, "matrix", Poly({((), (a,)): 1, ((), (twin,)): -1}, *problem.alphabet.shape(a))))
    return found


def _type(problem: Hypotheses, letter: str) -> tuple[str, str, bool]:
    found = problem.alphabet.letters[parts(letter)[0]]
    return found.rows, found.cols, found.symmetric


def _by_declaration(problem: Hypotheses, letters: Iterable[str]) -> list[str]:
    order = {name: i for i, name in enumerate(problem.alphabet.letters)}
    return sorted(letters, key=lambda a: (order.get(parts(a)[0], 0), a))


@dataclass
class Chooser:
    """Choose what each relation is solved for."""

    problem: Hypotheses
    bears: Bearing
    scalars: set[str]

    def choose(self) -> list[Rule]:
        """Return the rules: definitions first, then what does not follow from them; X = Y takes what is left."""
        rules = [Rule(name, "inverse", poly) for name, poly in self.bears.inverses.items()]
        rules += _scalar_rules(self.bears.central)
        same = [p for p in self.bears.relations.values() if len(p.terms) == len(lone(p)) == 2]
        open_: list[Poly] = []
        for poly in (p for p in self.bears.relations.values() if p not in same):
            rule = self._rule(poly, lone(poly), rules)
            rules += [rule] if rule else []
            open_ += [] if rule else [poly]
        probe: Instance | None = None
        for poly in open_:
            probe = probe or self._probe(rules + self._aliases(same, rules))
            if probe is None or any(x != 0 for x in probe.evaluate(poly).entries()):
                rules, probe = self._solve_too(poly, rules), None
        return rules + self._aliases(same, rules)

    def _solve_too(self, poly: Poly, rules: list[Rule]) -> list[Rule]:
        """Add a rule for one more relation; if need be, another relation gives way and is solved for another letter."""
        rule = self._rule(poly, _linear(poly), rules)
        if rule is not None:
            return [*rules, rule]
        for old in (r for r in rules if r.kind == "matrix" and r.target in _linear(poly)):
            others = [r for r in rules if r is not old]
            rule = self._rule(poly, [old.target], others)
            moved = rule and self._rule(old.poly, set(_linear(old.poly)) - {old.target}, [*others, rule])
            if rule and moved:
                return [*others, rule, moved]
        return rules

    def _aliases(self, same: Iterable[Poly], rules: list[Rule]) -> list[Rule]:
        found: list[Rule] = []
        for poly in same:
            rule = self._rule(poly, lone(poly), rules + found)
            found += [rule] if rule else []
        return found

    def _rule(self, poly: Poly, candidates: Iterable[str], rules: list[Rule]) -> Rule | None:
        """Solve a relation for a candidate, the one declared last, that no other letter of the relation depends on."""
        taken = {rule.target for rule in rules}
        for target in reversed(_by_declaration(self.problem, candidates)):
            if target not in taken and target not in depends(unknowns(poly) - {target}, rules):
                return Rule(target, "matrix", poly)
        return None

    def _probe(self, rules: list[Rule]) -> Instance | None:
        """Return an instance of the rules at random values, whatever the facts say."""
        from flint import fmpq, fmpq_mat

        targets = {rule.target for rule in rules}
        alphabet = self.problem.alphabet
        names = {d for a in self.bears.letters for d in alphabet.shape(a)}
        for seed in range(PROBES):
            generator = random.Random(seed)
            instance = Instance(alphabet, dict.fromkeys(names, PROBE_SIZE))
            for s in sorted(self.scalars - targets):
                instance.scalars[s] = fmpq(generator.randint(2, 99), generator.randint(2, 99))
            for a in sorted(self.bears.letters - targets):
                rows, cols = instance.shape(a)
                value = fmpq_mat(rows, cols, [generator.randint(-99, 99) for _ in range(rows * cols)])
                instance.values[a] = value + value.transpose() if alphabet.letters[parts(a)[0]].symmetric else value
            if all(rule.apply(instance) for rule in ordered(rules)):
                return instance
        return None


def _linear(poly: Poly) -> list[str]:
    """Return the letters that occur at most once in every word."""
    return [a for a in unknowns(poly) if all(sum(base(x) == a for x in w) <= 1 for _, w in poly.terms)]


def depends(letters: set[str], rules: Iterable[Rule]) -> set[str]:
    """Return the letters that the given ones depend on, themselves included."""
    sources = {rule.target: unknowns(rule.poly) - {rule.target} for rule in rules}
    seen: set[str] = set()
    stack = list(letters)
    while stack:
        letter = stack.pop()
        if letter not in seen:
            seen.add(letter)
            stack += sources.get(letter, ())
    return seen


def _scalar_rules(central: Mapping[str, Poly]) -> list[Rule]:
    rules: list[Rule] = []
    for poly in central.values():
        taken = {rule.target for rule in rules}
        counts = {s: max(m.count(s) for m, _ in poly.terms) for m, _ in poly.terms for s in m}
        target = next((s for s in sorted(counts, reverse=True) if counts[s] == 1 and s not in taken), None)
        if target is not None:
            rules.append(Rule(target, "scalar", poly))
    return rules


def ordered(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Return the rules for scalars, then each rule after those that it depends on."""
    out = [rule for rule in rules if rule.kind == "scalar"]
    waiting = [rule for rule in rules if rule.kind != "scalar"]
    while waiting:
        targets = {rule.target for rule in waiting}
        ready = [r for r in waiting if not (unknowns(r.poly) - {r.target}) & targets] or waiting
        out += ready
        waiting = [rule for rule in waiting if rule not in ready]
    return tuple(out)
