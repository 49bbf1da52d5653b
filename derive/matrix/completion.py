"""Noncommutative Buchberger completion with the history of every rule.

A rule rewrites its leading monomial to smaller ones. Each polynomial that arises is a combination
sum c * m * l * node * r of earlier ones, kept as a graph; ``expand`` multiplies out the part of it that a proof uses.
Central scalars are commuting letters: a rule applies where its scalars divide those of the term, and two rules overlap
in their words, or in their scalars across a gap. Gaps may be filled with any word; ``gaps`` lists those that are tried.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from derive.kernel import ANY
from derive.matrix.order import Codec, Encoded, Monomial, Number, divide, join

__all__ = ["Completion", "Rule", "Step"]

Step = tuple[Number, str, str, int, str]  # coefficient, scalars, left word, node, right word


@dataclass(frozen=True, eq=False)
class Rule:
    """The polynomial of a node, monic: scalars * word rewrites to minus the tail."""

    node: int
    scalars: str
    word: str
    tail: tuple[tuple[str, str, Number], ...]
    dimension: str  # its number of rows, or ANY
    binds: frozenset[str]  # variables of integration in the relations it comes from
    plain: bool  # it applies wherever its word occurs


@dataclass(frozen=True)
class Node:
    """A polynomial that arose: a relation (no steps) or a combination of earlier nodes."""

    steps: tuple[Step, ...]
    binds: frozenset[str]


@dataclass
class Completion:
    """A growing set of rules and the overlaps still to be resolved, smallest first."""

    codec: Codec
    max_degree: int
    gaps: tuple[str, ...] = ("",)
    rules: list[Rule] = field(default_factory=list[Rule])
    nodes: list[Node] = field(default_factory=list[Node])
    overlaps: list[tuple[int, int, Rule, Rule, tuple[Step, Step]]] = field(default_factory=list)
    noted: int = 0

    # -------------------------------------------------------------------------------------------- reduction
    def reduce(self, poly: Encoded, dimension: str) -> tuple[Encoded, list[Step]]:
        """Return a normal form and the steps that were subtracted."""
        todo, done, key = dict(poly), Encoded(), self.codec.key
        steps: list[Step] = []
        while todo:
            monomial = max(todo, key=key) if len(todo) > 1 else next(iter(todo))
            c = todo.pop(monomial)
            found = self.find(*monomial, dimension)
            if found is None:
                done[monomial] = c
                continue
            rule, m, left, right = found
            for n, w, d in rule.tail:
                accumulate(todo, (join(m, n), left + w + right), -c * d)
            steps.append((c, m, left, rule.node, right))
        return done, steps

    def find(self, m: str, w: str, dimension: str) -> tuple[Rule, str, str, str] | None:
        """Return the first rule that applies to m * w, with the cofactors (scalars, left, right)."""
        for rule in self.rules:
            at = w.find(rule.word)
            if at < 0:
                continue
            if rule.plain:
                return rule, m, w[:at], w[at + len(rule.word) :]
            for site in self.sites(rule, m, w, dimension):
                return rule, *site
        return None

    def sites(self, rule: Rule, m: str, w: str, dimension: str) -> Iterator[tuple[str, str, str]]:
        """Iterate over the places in m * w where a rule applies, as cofactors (scalars, left, right)."""
        rest = divide(m, rule.scalars)
        at = w.find(rule.word) if rest is not None else -1
        while rest is not None and at >= 0:
            left, right = w[:at], w[at + len(rule.word) :]
            if self.applies(rule, rest, left, right, dimension):
                yield rest, left, right
            at = w.find(rule.word, at + 1)

    def applies(self, rule: Rule, m: str, left: str, right: str, dimension: str) -> bool:
        """Tell whether the types fit around an identity, and no factor is captured by an integral."""
        if not rule.word and rule.dimension not in (ANY, self.codec.between(left, right, dimension)):
            return False
        return not rule.binds or not rule.binds & self.codec.times(m, left + right)

    # -------------------------------------------------------------------------------------------- rules
    def declare(self, poly: Encoded, binds: Iterable[str], dimension: str) -> int:
        """Take a relation as a node, add it to the rules, and return its number."""
        self.nodes.append(Node((), frozenset(binds)))
        node = len(self.nodes) - 1
        self.add(poly, [(1, "", "", node, "")], dimension)
        return node

    def add(self, poly: Encoded, steps: list[Step], dimension: str) -> bool:
        """Make a rule of what remains of a polynomial, retire the rules it replaces, and note its overlaps."""
        queue: list[tuple[Encoded, list[Step], str]] = [(poly, steps, dimension)]
        grown = False
        while queue:
            poly, steps, dimension = queue.pop()
            rest, used = self.reduce(poly, dimension)
            if not rest:
                continue
            new = self._rule(rest, steps + scaled(used, -1), dimension)
            retired = [r for r in self.rules if any(self.sites(new, r.scalars, r.word, r.dimension))]
            self.rules = [r for r in self.rules if r not in retired] + [new]
            queue.extend((whole(r), [(1, "", "", r.node, "")], r.dimension) for r in retired)
            for other in self.rules:
                self._meet(new, other)
            grown = True
        return grown

    def _rule(self, poly: Encoded, steps: list[Step], dimension: str) -> Rule:
        lead = max(poly, key=self.codec.key)
        scale = 1 / Fraction(poly[lead])
        scale = scale.numerator if scale.denominator == 1 else scale
        binds = frozenset[str]().union(*(self.nodes[s[3]].binds for s in steps))
        self.nodes.append(Node(tuple(scaled(steps, scale)), binds))
        tail = tuple((m, w, c * scale) for (m, w), c in poly.items() if (m, w) != lead)
        plain = bool(lead[1]) and not lead[0] and not binds
        return Rule(len(self.nodes) - 1, *lead, tail, dimension, binds, plain)

    # -------------------------------------------------------------------------------------------- overlaps
    def _meet(self, a: Rule, b: Rule) -> None:
        """Note every common multiple of two leading monomials that the rules do not resolve by themselves."""
        multiple = join(a.scalars, divide_out(b.scalars, a.scalars))
        m, n = divide(multiple, a.scalars) or "", divide(multiple, b.scalars) or ""
        shared = len(multiple) < len(a.scalars) + len(b.scalars)
        for u, left_a, right_a, left_b, right_b in self._common(a, b, shared):
            degree = len(u) + len(multiple)
            if degree <= self.max_degree:
                pair = (1, m, left_a, a.node, right_a), (-1, n, left_b, b.node, right_b)
                self.noted += 1
                heapq.heappush(self.overlaps, (self.codec.key((multiple, u))[0], self.noted, a, b, pair))

    def _common(self, a: Rule, b: Rule, shared: bool) -> Iterator[tuple[str, str, str, str, str]]:
        """Iterate over common multiples (word, left and right cofactors of a, of b)."""
        for one, two, swap in ((a, b, False), (b, a, True))[: 1 if a is b else 2]:
            u, v = one.word, two.word
            for k in range(1, min(len(u), len(v))):
                if u[-k:] == v[:k]:
                    yield turn(u + v[k:], "", v[k:], u[:-k], "", swap)
            if (shared or (one.scalars and v)) and one is not two and not (swap and u == v):
                for _, left, right in self.sites(two, two.scalars, u, one.dimension):
                    yield turn(u, "", "", left, right, swap)
            for gap in self.gaps if shared and u and v else ():
                if self.codec.typed(u, gap, v):
                    yield turn(u + gap + v, "", gap + v, u + gap, "", swap)

    def resolve(self) -> bool | None:
        """Resolve the smallest overlap: True if a rule came of it, None if no overlap is left."""
        if not self.overlaps:
            return None
        _, _, a, b, pair = heapq.heappop(self.overlaps)
        if a not in self.rules or b not in self.rules:
            return False
        poly = Encoded()
        for rule, (c, m, left, _, right) in zip((a, b), pair, strict=True):
            if not self.applies(rule, m, left, right, rule.dimension):
                return False
            for n, w, d in rule.tail:
                accumulate(poly, (join(m, n), left + w + right), c * d)
        left = pair[0][2]
        dimension = self.codec.rows(left) if left else a.dimension
        return self.add(poly, list(pair), dimension)

    # -------------------------------------------------------------------------------------------- history
    def expand(self, steps: list[Step]) -> list[Step]:
        """Multiply out a combination of nodes until only relations are left."""
        pending: dict[int, dict[tuple[str, str, str], Number]] = {}
        collect(pending, steps)
        for node in range(len(self.nodes) - 1, -1, -1):
            if self.nodes[node].steps and node in pending:
                for (m, left, right), c in pending.pop(node).items():
                    inner = self.nodes[node].steps
                    collect(pending, ((c * d, join(m, n), left + p, k, q + right) for d, n, p, k, q in inner))
        return [(c, m, p, node, q) for node, sites in pending.items() for (m, p, q), c in sites.items()]


def accumulate(poly: Encoded, monomial: Monomial, c: Number) -> None:
    """Add c * monomial in place."""
    total = poly.get(monomial, 0) + c
    if total:
        poly[monomial] = total
    else:
        poly.pop(monomial, None)


def scaled(steps: Iterable[Step], factor: Number) -> list[Step]:
    """Multiply a combination by a number."""
    return [(c * factor, m, left, node, right) for c, m, left, node, right in steps]


def collect(pending: dict[int, dict[tuple[str, str, str], Number]], steps: Iterable[Step]) -> None:
    """Add steps with equal cofactors of a node."""
    for c, m, left, node, right in steps:
        sites = pending.setdefault(node, {})
        total = sites.get((m, left, right), 0) + c
        if total:
            sites[m, left, right] = total
        else:
            del sites[m, left, right]


def whole(rule: Rule) -> Encoded:
    """Return the polynomial of a rule."""
    return {(rule.scalars, rule.word): 1, **{(m, w): c for m, w, c in rule.tail}}


def divide_out(n: str, m: str) -> str:
    """Return n / gcd(m, n)."""
    rest = list(n)
    for s in m:
        if s in rest:
            rest.remove(s)
    return "".join(rest)


def turn(u: str, p: str, q: str, r: str, s: str, swap: bool) -> tuple[str, str, str, str, str]:
    """Order the cofactors as those of the first and of the second rule."""
    return (u, r, s, p, q) if swap else (u, p, q, r, s)
