"""Polynomials that are zero: a Groebner basis that grows on demand, and knows where each of its elements comes from.

A monomial is one integer, a field of bits for the exponent of each scalar, the larger scalars in the higher bits: a
product is a sum, the lexical order is that of the integers, and one subtraction tells whether one divides the other.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heapify, heappop, heappush
from struct import unpack

from derive.kernel import ANY, Poly, Term
from derive.real import scalars_of

__all__ = ["Form", "Ideal"]

Number = int | Fraction
Form = dict[int, Number]  # coefficients by monomial
Steps = list[tuple[int, int, Number]]  # source, monomial, coefficient
BITS = 16  # for an exponent, an unsigned short of struct; the highest of them stays free


def whole(c: Number) -> Number:
    """Return a rational number as an integer if it is one; integers are faster."""
    return c if type(c) is int or c.denominator != 1 else c.numerator


def exact(c: Number, d: Number) -> Number:
    """Divide."""
    return whole(Fraction(c) / d)


def multiply(one: Form, two: Form) -> Form:
    """Multiply two polynomials."""
    total: Form = {}
    for m, c in one.items():
        for n, d in two.items():
            total[m + n] = total.get(m + n, 0) + c * d
    return {m: c for m, c in total.items() if c}


@dataclass(frozen=True)
class Rule:
    """An element of the basis, monic: its leading monomial rewrites to minus the tail."""

    lead: int
    tail: tuple[tuple[int, Number], ...]


@dataclass
class Ideal:
    """Relations and their completion; ``order`` lists the scalars, those first that others are made of.

    Source -1 - i is relation i, source k >= 0 is element k of the basis, which is the sum of its ``history``.
    """

    relations: Mapping[str, Poly]
    order: Sequence[str]
    seconds: float = 30.0
    rules: list[Rule] = field(default_factory=list[Rule])
    history: list[Steps] = field(default_factory=list[Steps])
    pairs: list[tuple[int, int, int]] = field(default_factory=list[tuple[int, int, int]])

    def __post_init__(self) -> None:
        """Take up the relations."""
        names = list(dict.fromkeys([*self.order, *(s for p in self.relations.values() for s in sorted(scalars_of(p)))]))
        self.names = names
        self.unit = {name: 1 << BITS * i for i, name in enumerate(names)}
        self.guard = sum(u << BITS - 1 for u in self.unit.values())
        self.deadline = time.monotonic() + self.seconds
        for i, poly in enumerate(self.relations.values()):
            self._add(self.encode(poly), [(-1 - i, 0, 1)])

    def encode(self, poly: Poly) -> Form:
        """Return the coefficients of a kernel polynomial."""
        return {sum(self.unit[s] for s in m): whole(c) for (m, _), c in poly.terms.items()}

    def decode(self, form: Form) -> Poly:
        """Return a kernel polynomial."""
        return Poly({(self.scalars(m), ()): c for m, c in form.items()}, ANY, ANY)

    def scalars(self, monomial: int) -> tuple[str, ...]:
        """Return the scalars of a monomial in the kernel's order."""
        exponents = unpack(f"<{len(self.names)}H", monomial.to_bytes(BITS // 8 * len(self.names), "little"))
        return tuple(sorted(s for s, e in zip(self.names, exponents, strict=True) if e for _ in range(e)))

    def reduce(self, form: Form) -> tuple[Form, Steps]:
        """Return the remainder, and the multiples of the basis that were subtracted."""
        rest, done, steps = dict(form), Form(), Steps()
        heap = [-m for m in rest]
        heapify(heap)
        while heap:
            m = -heappop(heap)
            c = whole(rest.pop(m))
            k = self._find(m) if c else None
            if c and k is None:
                done[m] = c
            if k is None:
                continue
            q = m - self.rules[k].lead
            steps.append((k, q, c))
            for n, d in self.rules[k].tail:
                if q + n in rest:
                    rest[q + n] -= c * d
                else:
                    rest[q + n] = -c * d
                    heappush(heap, -q - n)
        return done, steps

    def _find(self, monomial: int) -> int | None:
        """Return the number of the first element whose leading monomial divides another."""
        high, guard = monomial | self.guard, self.guard
        for k, rule in enumerate(self.rules):
            if (high - rule.lead) & guard == guard:
                return k
        return None

    def grow(self) -> bool:
        """Take up one more element of the Groebner basis; False if there is none, or no time."""
        while self.pairs and time.monotonic() < self.deadline:
            _, i, j = heappop(self.pairs)
            lcm = self._lcm(self.rules[i].lead, self.rules[j].lead)
            up, down = lcm - self.rules[i].lead, lcm - self.rules[j].lead
            total: Form = {up + m: c for m, c in self.rules[i].tail}
            for m, c in self.rules[j].tail:
                total[down + m] = total.get(down + m, 0) - c
            rest, used = self.reduce(total)
            if rest:
                self._add(rest, [(i, up, 1), (j, down, -1), *((k, m, -c) for k, m, c in used)])
                return True
        return False

    def _add(self, form: Form, steps: Steps) -> None:
        if not form:
            return
        new, lead = len(self.rules), max(form)
        scale = whole(1 / Fraction(form[lead]))
        self.rules.append(Rule(lead, tuple((m, whole(c * scale)) for m, c in form.items() if m != lead)))
        self.history.append([(k, m, whole(c * scale)) for k, m, c in steps])
        for i, rule in enumerate(self.rules[:new]):
            lcm = self._lcm(rule.lead, lead)
            if lcm != rule.lead + lead:
                degree = lcm % ((1 << BITS) - 1)  # the sum of the fields
                heappush(self.pairs, (degree, i, new))

    def _lcm(self, one: int, two: int) -> int:
        larger = ((one | self.guard) - two) & self.guard  # where the first exponent is not the smaller one
        first = larger - (larger >> BITS - 1)
        return one & first | two & ~first

    def member(self, claim: Poly) -> tuple[Term, ...] | None:
        """Return the addends that make up a polynomial of the ideal, else None."""
        rest, steps = self.encode(claim), Steps()
        while True:
            rest, used = self.reduce(rest)
            steps += used
            if not rest:
                return tuple(self._terms(steps))
            if not self.grow():
                return None

    def _terms(self, steps: Steps) -> Iterable[Term]:
        """Write multiples of the basis as multiples of the relations, the youngest elements first."""
        cofactors: dict[int, Form] = {}

        def note(source: int, form: Form) -> None:
            cofactor = cofactors.setdefault(source, {})
            for m, c in form.items():
                cofactor[m] = cofactor.get(m, 0) + c

        for k, m, c in steps:
            note(k, {m: c})
        for k in range(len(self.history) - 1, -1, -1):
            cofactor = cofactors.pop(k, {})
            for source, m, c in self.history[k] if cofactor else ():
                note(source, {n + m: c * d for n, d in cofactor.items() if d})
        for i, name in enumerate(self.relations):
            for m, c in cofactors.get(-1 - i, {}).items():
                if c:
                    yield Term(Fraction(c), self.scalars(m), (), name, False, ())
