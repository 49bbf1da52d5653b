"""Search for a proof of a statement about real numbers: signs at sight, by factors, by z3, and certificates for them.

Nothing here is believed: what is found is a tree of reasons that proof.py replays; where a reason is z3's word alone,
the tree says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations, combinations_with_replacement
from math import comb, isqrt
from time import monotonic
from typing import Any

from flint import arb

from derive.interpret.statement import Statement
from derive.kernel import Poly
from derive.real import NEGATION, Sign, SignProduct, constant, contrary, sign_product
from derive.rules import Fact
from derive.scalar.flint_ring import FlintRing
from derive.scalar.hypotheses import system
from derive.scalar.ideal import Ideal
from derive.scalar.instances import Instance, Instances
from derive.scalar.proof import (
    Either,
    Factor,
    Leaf,
    Proof,
    Reason,
    Square,
    Step,
    Tree,
    Turned,
    claims_of,
    known_fact,
    needs_of,
    plain,
    upright,
)  # fmt: skip
from derive.scalar.ratio import Numbers, Ratio
from derive.scalar.real_closed import Budget, ask
from derive.scalar.real_closed import Fact as Claim
from derive.scalar.search import Remainders, contradiction, products
from derive.scalar.system import Case, Split, System, proportional, sign_of

__all__ = ["Failed", "Prover", "Unknown"]

DEPTH = 7  # of the tree of cases
TRIED = 24  # instances at which a sign is looked at before it is proved
ENOUGH = 6  # of those of the theory that satisfy the case
FEW = 60  # points at which instances of a case are looked for
PRODUCTS = 700  # of facts, in one certificate of sign
LARGE = 150  # addends of all facts, for a certificate of sign
FALSE = {"≥": "positive", ">": "nonnegative", "≠": "="}  # of -p, where the claim on p fails


class Failed(Exception):  # noqa: N818 - an answer
    """What is needed is false; ``near`` are numbers at or near those at which it fails, if z3 found them."""

    def __init__(self, near: Mapping[str, Fraction] | None = None):
        super().__init__("false")
        self.near = near


class Choose(Exception):  # noqa: N818 - a question
    """A certificate needs to know which of some alternatives holds."""

    def __init__(self, number: int):
        super().__init__("alternatives")
        self.number = number


class Unknown(Exception):  # noqa: N818 - an answer
    """It is not decided within the budget."""


@dataclass
class Prover:
    """Proves a statement; ``deadline`` ends what the budget of z3 does not."""

    statement: Statement
    ring: FlintRing
    names: Sequence[str]
    deadline: float
    without: frozenset[str] = frozenset()
    seeds: Sequence[Instance] = ()  # of the theory
    certificates: bool = True
    budget: Budget = field(init=False)
    systems: list[System] = field(default_factory=list[System])  # of the cases, as they end

    def __post_init__(self) -> None:
        """Bound what z3 may spend."""
        self.budget = Budget(deadline=self.deadline)

    def prove(self, cases: Sequence[Case] = ()) -> Proof:
        """Return a proof.

        Raises:
            Failed: the statement is false in a case.
            Unknown: it is not decided within the budget.
            Beyond: it is no statement about algebraic functions of real numbers.
        """
        try:
            known = system(self.statement, self.ring, cases, self.without)
            self.systems.append(known)
            return Leaf(impossible=True) if known.impossible else self._leaf(known, len(cases))
        except Split as split:
            if len(cases) >= DEPTH:
                raise Unknown("too many cases") from None
            poly = plain(split.poly)
            above = self.prove([*cases, ("nonnegative", poly)])
            return Tree(poly, above, self.prove([*cases, ("nonnegative", -poly)]))
        except Choose as choose:
            choice = [(kind, self.ring.poly(p)) for kind, p in self.systems[-1].alternatives[choose.number]]
            return Either(choose.number, tuple(self.prove([*cases, case]) for case in choice))

    def _leaf(self, known: System, depth: int) -> Leaf:
        search = _Search(self, known, depth)
        numbers = Numbers(self.ring, known.values, search)
        for relation, poly in claims_of(self.statement, numbers):
            for needed, p in needs_of(relation, poly, self.ring):
                if not known_fact(known, p, needed):
                    search.steps.append(search.reason(needed, p))
        return Leaf(tuple(search.steps))


class _Search:
    """Answers what a term needs, and keeps the reasons."""

    def __init__(self, prover: Prover, known: System, depth: int):
        self.prover, self.known, self.ring, self.depth = prover, known, prover.ring, depth
        self.steps: list[Step] = []
        self.instances = Instances(known, self.ring, prover.names)
        points = [i for i in prover.seeds if self.instances.allows(i)][:TRIED]
        self.points = points if len(points) >= ENOUGH else self.instances.first(ENOUGH, FEW)

    # ------------------------------------------------------------------------------------- answers
    def nonzero(self, poly: Any) -> None:
        """Prove that a divisor is not zero."""
        if not len(poly):
            raise Failed
        if not self.known.nonzero(poly):
            self.steps.append(self.reason("≠", poly))

    def sign(self, poly: Any) -> int:
        """Prove the sign of a polynomial, or ask for two cases."""
        try:
            return sign_of(self.known, poly)
        except Split:
            pass
        signs = self._signs(poly)
        if not {1, -1} <= signs:
            sign = -1 if -1 in signs else 1
            try:
                self.steps.append(Turned(sign, self.reason("≥", poly if sign > 0 else -poly)))
                return sign
            except Failed:
                pass
        raise Split(self.ring.poly(self._undecided(poly)))

    def positive(self, poly: Any) -> bool:
        """Tell whether a factor is positive at sight."""
        return self.known.positive(poly)

    def square(self, poly: Any) -> tuple[Any, Any]:
        """Split a radicand into a square and a rest without square factors, and prove that it is not negative."""
        if not len(poly):
            q, s = self.ring.constant(Fraction(0)), self.ring.constant(Fraction(1))
        else:
            number, factors = self.ring.factors(poly)
            outer, inner = _square_part(number)
            q, s = self.ring.constant(outer), self.ring.constant(inner)
            for f, e in factors:
                for _ in range(e // 2):
                    q = q * f
                s = s * f if e % 2 else s
        q = q if upright(self.ring.poly(q)) else -q
        self.steps.append(Square(self.ring.poly(q), self.ring.poly(s)))
        if not known_fact(self.known, s, "≥"):
            self.steps.append(self.reason("≥", s))
        return q, s

    def root(self, poly: Any) -> Any:
        """Return the root of a number without square factors."""
        if poly == self.ring.constant(Fraction(1)):
            return poly
        return self.ring.letter(self.known.root(poly))

    def exponential(self, argument: Ratio) -> Ratio:
        """Return exp of a number, by the sign of that."""
        numbers = Numbers(self.ring, {}, self)
        return self.known.exponential(argument, self.sign(numbers.same_sign(argument)), numbers)

    # ------------------------------------------------------------------------------------- signs
    def _signs(self, poly: Any) -> set[int]:
        """Return the signs that a polynomial has at some instances: 1, 0, -1."""
        values = [self.instances.value(poly, i) for i in self.points]
        return {sign for v in values for sign in (1, 0, -1) if _has(v, sign)}

    def _undecided(self, poly: Any) -> Any:
        """Return the first factor of odd power whose sign changes, or is not known."""
        odd = [f for f, e in self.ring.factors(poly)[1] if e % 2]
        unknown = [f for f in odd if not self._has_sign(f)]
        return next((f for f in unknown if {1, -1} <= self._signs(f)), (*unknown, poly)[0])

    def _has_sign(self, poly: Any) -> bool:
        try:
            sign_of(self.known, poly)
        except Split:
            return False
        return True

    def reason(self, relation: str, poly: Any) -> Reason:
        """Prove a polynomial ≥ 0, > 0 or ≠ 0."""
        if monotonic() > self.prover.deadline:
            raise Unknown("no time left")
        if known_fact(self.known, poly, relation):
            return Reason("known")
        self._look(relation, poly)
        product = self._by_factors(relation, poly)
        return product if product is not None else self._by_z3(relation, poly)

    def _look(self, relation: str, poly: Any) -> None:
        """Fail if an instance shows that the claim is false."""
        signs = self._signs(poly)
        if (0 in signs and relation != "≥") or (-1 in signs and relation != "≠"):
            raise Failed

    def _by_factors(self, relation: str, poly: Any) -> Reason | None:
        number, factors = self._factors(poly)
        if len(factors) == 1 and factors[0][1] == 1:
            return None
        found, total = list[Factor](), 1 if number > 0 else -1
        for f, e in factors:
            factor = self._factor(relation, f, e)
            if factor is None:
                return None
            found.append(factor)
            total *= factor.sign if relation != "≠" and e % 2 else 1
        return Reason("product", number, tuple(found)) if relation == "≠" or total > 0 else None

    def _factors(self, poly: Any) -> tuple[Fraction, list[tuple[Any, int]]]:
        """Return number and factors, each as it is written."""
        number, factors = self.ring.factors(poly)
        found: list[tuple[Any, int]] = []
        for f, e in factors:
            written = self.ring.of(plain(self.ring.poly(f)))
            ratio = proportional(self.ring, f, written) or Fraction(1)
            number, found = number * ratio**e, [*found, (written, e)]
        return number, found

    def _factor(self, relation: str, f: Any, power: int) -> Factor | None:
        written = self.ring.poly(f)
        if relation == "≥" and power % 2 == 0:
            return Factor(written, power, 1)
        if relation == "≠" or power % 2 == 0:
            return Factor(written, power, 1, self.reason("≠", f))
        try:
            sign = sign_of(self.known, f)
        except Split:
            signs = self._signs(f)
            if {1, -1} <= signs:
                return None
            sign = -1 if -1 in signs else 1
        try:
            return Factor(written, power, sign, self.reason(relation, f if sign > 0 else -f))
        except Failed:
            return None

    # ------------------------------------------------------------------------------------- z3 and certificates
    def _by_z3(self, relation: str, poly: Any) -> Reason:
        facts = facts_of(self.known)
        claim = self.ring.poly(poly)
        against = (FALSE[relation], claim if relation == "≠" else -claim)
        found = ask({**facts, NEGATION: against}, choices_of(self.known), self.prover.budget, 12)
        if found.possible is None:
            raise Unknown("z3 has no answer within its budget")
        if found.possible:
            raise Failed(found.near)
        used = tuple(name for name in found.core if name in facts)
        if not self.prover.certificates:
            return Reason("z3", used=used)
        if relation == ">" and known_fact(self.known, poly, "≥"):
            return Reason("apart", factors=(Factor(plain(claim), 1, 1, self._by_z3("≠", poly)),))
        wider = tuple(n for n, (kind, _) in facts.items() if n in used or kind in ("positive", "nonzero"))
        for names in (used, wider) if len(wider) > len(used) else (used,):
            sign = self._certificate(relation, claim, {n: facts[n] for n in names})
            if sign is not None:
                return Reason("sign", sign=sign, used=tuple(n for n in names if n in _named(sign)))
        choices = [i for i in range(len(self.known.alternatives)) if f"choice {i}" in found.core]
        if choices and self.depth < DEPTH:
            raise Choose(choices[0])
        return Reason("z3", used=used)

    def _certificate(self, relation: str, claim: Poly, chosen: Mapping[str, Claim]) -> Sign | None:
        """Return a certificate of sign from the facts that z3 needed, and roots."""
        facts = {n: Fact(kind, ((p,),)) for n, (kind, p) in chosen.items() if kind != "="}
        relations = {n: p for n, (kind, p) in chosen.items() if kind == "="}
        against = contrary(claim, relation)
        facts |= {NEGATION: against} if against else {}
        relations |= {} if against else {NEGATION: claim}
        order = [
            n for n in reversed(self.ring.names) if any(n in m for p in _polys(facts, relations) for m, _ in p.terms)
        ]
        ideal = Ideal(relations, order, 1.0)
        while len(ideal.rules) < 12 and ideal.grow():
            pass
        remainders = Remainders(ideal, facts)
        if sum(len(p.terms) for p in _polys(facts, relations)) > LARGE:
            return None
        for degree, used in _multipliers([(n, self.ring.poly(self.ring.letter(n))) for n in order]):
            if comb(len(facts) + degree, degree) * (1 + len(used)) > PRODUCTS or monotonic() > self.prover.deadline:
                continue
            found = contradiction(list(products(facts, used, degree)), remainders)
            if found:
                return _sign(claim, relation, found, facts, ideal)
        return None


def facts_of(known: System) -> dict[str, Claim]:
    """Return facts and equations of a system, for z3."""
    facts = {name: (kind, known.ring.poly(p)) for name, (kind, p) in known.facts.items()}
    return facts | {name: ("=", known.ring.poly(p)) for name, p in known.relations.items()}


def choices_of(known: System) -> dict[str, list[Claim]]:
    """Return the alternatives of a system, for z3."""
    return {
        f"choice {i}": [(kind, known.ring.poly(p)) for kind, p in choice] for i, choice in enumerate(known.alternatives)
    }


def _has(value: Any, sign: int) -> bool:
    """Tell whether a number has a sign for certain."""
    if isinstance(value, arb):
        return bool(value > 0 if sign > 0 else value < 0 if sign < 0 else False)
    return ((value > 0) - (value < 0)) == sign


def _sign(
    claim: Poly, relation: str, found: Sequence[SignProduct], facts: Mapping[str, Fact], ideal: Ideal
) -> Sign | None:
    total = constant(0)
    for product in found:
        total = total + sign_product(product, facts)[0]
    terms = ideal.member(total)
    return None if terms is None else Sign(claim, relation, tuple(found), terms)


def _multipliers(letters: Sequence[tuple[str, Poly]]) -> Iterator[tuple[int, list[Poly]]]:
    """Iterate over degrees of products of facts, and polynomials whose squares multiply them; the cheap ones first."""
    squares = [p for n, p in letters if not n.startswith("√")]
    pairs = [*squares, *(a * b for a, b in combinations_with_replacement(squares, 2))]
    every = [p for _, p in letters]
    sums = [a + b.scale(c) for a, b in combinations(every, 2) for c in (-1, 1)]
    sums = list(map(plain, (*sums, *(a * a - b * b for a, b in combinations(squares, 2)))))
    yield from ((1, squares), (2, squares), (3, []), (3, squares), (4, []), (3, pairs), (1, [*sums, *pairs]), (2, sums))


def _named(sign: Sign) -> set[str]:
    return {name for p in sign.products for name in p.facts} | {t.relation for t in sign.terms}


def _polys(facts: Mapping[str, Fact], relations: Mapping[str, Poly]) -> list[Poly]:
    return [*(f.matrix[0][0] for f in facts.values()), *relations.values()]


def _square_part(number: Fraction) -> tuple[Fraction, Fraction]:
    """Return q and s with number = q^2 s, s a whole number with few square factors."""
    whole, q = number.numerator * number.denominator, Fraction(1, number.denominator)
    for p in (2, 3, 5, 7, 11, 13):
        while whole % (p * p) == 0:
            whole, q = whole // (p * p), q * p
    if whole > 0 and isqrt(whole) ** 2 == whole:
        return q * isqrt(whole), Fraction(1)
    return q, Fraction(whole)
