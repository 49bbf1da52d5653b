"""Proofs of statements about real numbers: a tree of cases, and in each the reasons for every sign that is needed.

A reason is one of: at sight (all addends have the sign), a fact, a product of factors with their own reasons, a
certificate of sign (a sum of products of facts that would be negative were the claim false), or nothing but z3's word.
``accept`` replays a tree from the statement alone; it trusts no reason, and takes none of z3. Standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from derive.interpret.statement import Statement
from derive.kernel import Alphabet, Poly, Rejected
from derive.real import Sign, replay_sign
from derive.rules import Context, Fact
from derive.scalar.hypotheses import system
from derive.scalar.ratio import Beyond, KernelRing, Numbers, Ratio, plain, upright
from derive.scalar.system import Case, Split, System, proportional, sign_of

__all__ = [
    "ANSWERS", "Either", "Factor", "Leaf", "Proof", "Reason", "Square", "Step", "Tree", "Turned", "accept", "claims_of",
    "known_fact", "leaves", "needs_of", "plain", "upright",
]  # fmt: skip

STRICT = {"≥": False, ">": True, "≠": True}


@dataclass(frozen=True)
class Factor:
    """A factor of a product, its power, its sign (0: only that it is not zero, or nothing at all) and why."""

    poly: Poly
    power: int
    sign: int = 0
    reason: Reason | None = None


@dataclass(frozen=True)
class Reason:
    """Why a polynomial is ≥ 0, > 0 or ≠ 0: by a fact or at sight, as a product, or by a certificate of sign.

    "apart" says of p > 0 that p >= 0 is known and p ≠ 0, for which ``factors`` has the reason.
    """

    rule: str  # "known", "product", "apart", "sign", "z3"
    number: Fraction = Fraction(1)
    factors: tuple[Factor, ...] = ()
    sign: Sign | None = None
    used: tuple[str, ...] = ()  # facts, for the reader

    def certified(self) -> bool:
        """Tell whether the reason can be replayed."""
        return self.rule != "z3" and all(f.reason is None or f.reason.certified() for f in self.factors)


@dataclass(frozen=True)
class Square:
    """A radicand as q^2 s; the reason says that s >= 0."""

    q: Poly
    s: Poly


@dataclass(frozen=True)
class Turned:
    """A sign that decides what a term is: the reason shows sign * poly >= 0."""

    sign: int
    reason: Reason


Step = Reason | Square | Turned


@dataclass(frozen=True)
class Leaf:
    """What is needed for the statement in one case, in the order in which it is asked for."""

    steps: tuple[Step, ...] = ()
    impossible: bool = False

    def certified(self) -> bool:
        """Tell whether all reasons can be replayed."""
        reasons = [s.reason if isinstance(s, Turned) else s for s in self.steps]
        return all(r.certified() for r in reasons if isinstance(r, Reason))


@dataclass(frozen=True)
class Tree:
    """Either p >= 0 or -p >= 0, and a tree for each."""

    poly: Poly
    above: Proof
    below: Proof


@dataclass(frozen=True)
class Either:
    """One of some alternatives holds, and there is a proof for each."""

    number: int
    proofs: tuple[Proof, ...]


Proof = Tree | Either | Leaf


def leaves(proof: Proof) -> Iterator[Leaf]:
    """Iterate over the cases of a proof."""
    match proof:
        case Leaf():
            yield proof
        case Tree(_, above, below):
            yield from (*leaves(above), *leaves(below))
        case Either(_, proofs):
            yield from (leaf for p in proofs for leaf in leaves(p))


# ---------------------------------------------------------------------------------------------- what is needed
ANSWERS = {"⪰": "≥", "≻": ">", ":=": "=", "=": "=", "≥": "≥", ">": ">", "≠": "≠"}


def known_fact(known: System, poly: Any, relation: str) -> bool:
    """Tell whether a sign is known at sight or by one fact."""
    found = known.sight(poly)
    if found is not None:
        sign, strict = found
        if relation == "≠" and strict:
            return True
        if sign >= 0 and (strict or not STRICT[relation]):
            return True
    for name, (kind, p) in known.facts.items():
        ratio = proportional(known.ring, poly, p)
        if ratio is None:
            continue
        same = ratio > 0 and (kind == "positive" or (kind == "nonnegative" and relation == "≥"))
        if same or (relation == "≠" and kind != "nonnegative"):
            known.consulted.add(name)
            return True
    return False


def claims_of(statement: Statement, numbers: Numbers) -> Iterator[tuple[str, Any]]:
    """Iterate over the claims as a relation of a polynomial to zero, reading each when it is asked for."""
    for equation in statement.equations:
        relation = ANSWERS.get(equation.relation)
        if relation is None:
            raise Beyond(f"the relation {equation.relation} is not decided between numbers")
        sides = numbers.read(equation.lhs), numbers.read(equation.rhs)
        difference = numbers.add(sides[0], numbers.negative(sides[1]))
        yield relation, difference.top if relation in "=≠" else numbers.same_sign(difference)


def needs_of(relation: str, poly: Any, ring: Any) -> list[tuple[str, Any]]:
    """Return what has to be shown of signs; an equation that is one of polynomials needs nothing."""
    if relation != "=":
        return [(relation, poly)]
    return [("≥", poly), ("≥", -poly)] if ring.poly(poly).terms else []


# ---------------------------------------------------------------------------------------------- replay
@dataclass
class _Replay:
    """Answers what a term needs from the steps of a leaf, each of which is checked."""

    known: System
    steps: list[Step]
    context: Context = field(init=False)

    def nonzero(self, poly: Any) -> None:
        if not self.known.ring.poly(poly).terms:
            raise Rejected("a division by zero")
        if not self.known.nonzero(poly):
            self.check("≠", poly)

    def sign(self, poly: Any) -> int:
        try:
            return sign_of(self.known, poly)
        except Split:
            step = self._next()
            if not isinstance(step, Turned) or step.sign not in (1, -1):
                raise Rejected("a sign is needed") from None
            self._check(step.reason, "≥", poly if step.sign > 0 else -poly)
            return step.sign

    def positive(self, poly: Any) -> bool:
        return self.known.positive(poly)

    def square(self, poly: Any) -> tuple[Any, Any]:
        step = self._next()
        if not isinstance(step, Square) or step.q * step.q * step.s != poly or not upright(step.q):
            raise Rejected("a radicand is no square times the rest")
        if not known_fact(self.known, step.s, "≥"):
            self.check("≥", step.s)
        return step.q, step.s

    def root(self, poly: Any) -> Any:
        if not any(m for m, _ in poly.terms) and poly.terms == {((), ()): 1}:
            return self.known.ring.constant(Fraction(1))
        return self.known.ring.letter(self.known.root(poly))

    def exponential(self, argument: Ratio) -> Ratio:
        numbers = Numbers(self.known.ring, {}, self)
        return self.known.exponential(argument, self.sign(numbers.same_sign(argument)), numbers)

    def check(self, relation: str, poly: Any) -> None:
        """Check that the next step shows the sign of a polynomial."""
        step = self._next()
        if not isinstance(step, Reason):
            raise Rejected("a reason for a sign is needed")
        self._check(step, relation, poly)

    def _next(self) -> Step:
        if not self.steps:
            raise Rejected("a reason is missing")
        return self.steps.pop(0)

    def _check(self, reason: Reason, relation: str, poly: Poly) -> None:
        match reason.rule:
            case "known":
                if not known_fact(self.known, poly, relation):
                    raise Rejected("the sign is not known at sight")
            case "product":
                self._product(reason, relation, poly)
            case "apart" if relation == ">" and len(reason.factors) == 1:
                (factor,) = reason.factors
                shown = factor.poly == plain(poly) and (factor.power, factor.sign) == (1, 1)
                if factor.reason is None or not shown or not known_fact(self.known, poly, "≥"):
                    raise Rejected("it is not known that the number is not negative")
                self._check(factor.reason, "≠", poly)
            case "sign" if reason.sign is not None:
                facts = {n: Fact(kind, ((p,),)) for n, (kind, p) in self.known.facts.items()}
                names = {x for p in (poly, *(f.matrix[0][0] for f in facts.values())) for m, _ in p.terms for x in m}
                names |= {x for p in self.known.relations.values() for m, _ in p.terms for x in m}
                context = Context(Alphabet({}, frozenset(names)), facts=facts, relations=dict(self.known.relations))
                replay_sign(reason.sign, poly, relation, context)
            case _:
                raise Rejected(f"{reason.rule} is no reason that can be replayed")

    def _product(self, reason: Reason, relation: str, poly: Poly) -> None:
        ring = self.known.ring
        total, sign = ring.constant(reason.number), 1 if reason.number > 0 else -1
        if not reason.number:
            raise Rejected("a product with zero")
        for factor in reason.factors:
            for _ in range(factor.power):
                total = total * factor.poly
            odd = factor.power % 2 == 1
            if relation == "≠" or not odd:
                wanted = "≠" if STRICT[relation] else ""
            else:
                wanted, sign = (">" if STRICT[relation] else "≥"), sign * factor.sign
            turned = factor.poly if wanted == "≠" or factor.sign > 0 else -factor.poly
            if wanted and (factor.sign in (1, -1) or wanted == "≠") and factor.reason is not None:
                self._check(factor.reason, wanted, turned)
            elif wanted:
                raise Rejected("a factor without sign")
        if total != poly or (relation != "≠" and sign != 1):
            raise Rejected("the product is another, or of the other sign")


def accept(statement: Statement, tree: Proof, cases: Sequence[Case] = ()) -> None:
    """Replay a proof of all that a statement says, its definedness included; or raise Rejected."""
    if len(cases) > 12:
        raise Rejected("too many cases")
    if isinstance(tree, Tree):
        accept(statement, tree.above, [*cases, ("nonnegative", tree.poly)])
        accept(statement, tree.below, [*cases, ("nonnegative", -tree.poly)])
        return
    try:
        known = system(statement, KernelRing(), cases)
        if known.impossible and not cases:
            raise Rejected(f"the assumptions contradict the theory: {known.impossible}")
        if isinstance(tree, Either):
            _each(statement, tree, known, cases)
            return
        if tree.impossible:
            if not known.impossible:
                raise Rejected("the case is possible")
            return
        answers = _Replay(known, list(tree.steps))
        numbers = Numbers(known.ring, known.values, answers)
        for relation, poly in claims_of(statement, numbers):
            for needed, p in needs_of(relation, poly, known.ring):
                if not known_fact(known, p, needed):
                    answers.check(needed, p)
    except Split:
        raise Rejected("a sign in the hypotheses is not known") from None
    except Beyond as error:
        raise Rejected(str(error)) from None


def _each(statement: Statement, tree: Either, known: System, cases: Sequence[Case]) -> None:
    if not 0 <= tree.number < len(known.alternatives):
        raise Rejected("there are no such alternatives")
    choice = known.alternatives[tree.number]
    if len(choice) != len(tree.proofs):
        raise Rejected("an alternative without proof")
    for case, proof in zip(choice, tree.proofs, strict=True):
        accept(statement, proof, [*cases, case])
