"""Write a lecture about real scalars: the prover searches identities and signs, the kernel replays them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from derive.context import Declared, DeclaredAtom, names_of
from derive.derivation import Derived, Proof, Rule, Step, Text, hidden_from, in_force
from derive.functions import Definite, Limit, Rate, Start, value
from derive.induction import Claim, Induction, claim_of, starts_in
from derive.kernel import Certificate, Poly, Rejected
from derive.kernel import Term as Addend
from derive.real import HYPOTHESIS, Sign, scalars_of
from derive.scalar.search import closure, prove_identity, prove_sign
from derive.terms import Equation, Reading, Term, Zero
from derive.theory.builder import Builder, NotDerived, _used

T = TypeVar("T")


def _text(reason: str | Text) -> Text:
    return (reason,) if isinstance(reason, str) else reason


class ScalarBuilder(Builder):
    """Collect the items of a lecture whose statements are about scalars."""

    def equation(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        using: Sequence[str],
        rule: Rule,
        number: str = "",
        source: str = "",
        lemma: bool = False,
    ) -> Step:
        """Prove one equation without displaying it; a scalar identity unless another rule is named."""
        rule = "scalar" if rule == "identity" else rule
        return super().equation(name, statement, reason, using, rule, number, source, lemma)

    def prove(self, claim: Poly, using: Sequence[str], trace: bool = False, label: str = "") -> tuple[Addend, ...]:
        """Find the addends of a certificate from the named relations and the atoms that occur."""
        relations = self.reading.context.relations
        named = {r: relations[r] for name in using for r in names_of(name, relations)}
        near = {**named, **closure([claim, *named.values()], self.reading.real, relations, expand=False)}
        allowed = {**named, **closure([claim, *named.values()], self.reading.real, relations)}
        found = prove_identity(claim, near, self.order()) if len(near) < len(allowed) and named else None
        found = found or prove_identity(claim, allowed, self.order())
        if found is None:
            raise NotDerived(f"{self.key}: no certificate for {label} from {', '.join(allowed) or 'nothing'}")
        return found

    def order(self) -> list[str]:
        """Return the scalars, those first that others are made of."""
        return [name for name in self.theory.symbols if self.theory.symbols[name].scalar]

    def sign(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        using: Sequence[str],
        *,
        identities: Sequence[str] = (),
        squares: Sequence[Term] = (),
        number: str = "",
        source: str = "",
        degree: int = 3,
        alone: bool = False,
        show: bool = True,
    ) -> Step:
        """Prove lhs >=, > or ≠ rhs: were it false, products of nonnegative numbers would add up to less than zero."""
        claim = self._claim(name, statement)
        found = self._sign(name, claim, statement.relation, using, identities, squares, degree, alone)
        return self._keep(name, statement, "sign", reason, Proof(sign=found), number, source, show)

    def _claim(self, name: str, statement: Equation) -> Poly:
        try:
            return value(statement.lhs, self.reading) - value(statement.rhs, self.reading)
        except Rejected as error:
            raise NotDerived(f"{self.key}: step {name!r}: {error}") from error

    def _sign(
        self,
        name: str,
        claim: Poly,
        relation: str,
        using: Sequence[str],
        identities: Sequence[str],
        squares: Sequence[Term],
        degree: int,
        alone: bool,
    ) -> Sign:
        """Find a certificate of sign."""
        context, real = self.reading.context, self.reading.real
        extra = [self._claim(name, Equation(term, "=", Zero("", ""))) for term in squares]
        missing = [f for f in using if f not in context.facts]
        if missing:
            raise NotDerived(f"{self.key}: step {name!r}: no fact {', '.join(missing)}")
        facts = {f: context.facts[f] for f in using}
        named = {r: context.relations[r] for n in identities for r in names_of(n, context.relations)}
        polys = [claim, *extra, *named.values(), *(f.matrix[0][0] for f in facts.values())]
        allowed = named if alone else {**named, **closure(polys, real, context.relations)}
        known = {s for p in (*polys, *allowed.values()) for s in scalars_of(p)}
        order = [s for s in self.order() if s in known]
        found = prove_sign(claim, relation, facts, allowed, order, extra, degree)
        if found is None:
            raise NotDerived(f"{self.key}: no certificate of sign for {name} from {', '.join(using) or 'nothing'}")
        return found

    def induct(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        using: Sequence[str] = (),
        *,
        identities: Sequence[str] = (),
        squares: Sequence[Term] = (),
        degree: int = 3,
    ) -> Step:
        """Prove a statement for every number of steps: at the start, and one step later from the claim itself."""
        try:
            claim = claim_of(statement, self.reading)
        except Rejected as error:
            raise NotDerived(f"{self.key}: step {name!r}: {error}") from error
        relation = statement.relation

        def identity(poly: Poly, more: Sequence[str]) -> Certificate:
            return Certificate(poly, self.prove(poly, [*using, *more], label=name))

        def sign(poly: Poly, more: Sequence[str]) -> Sign:
            return self._sign(name, poly, relation, [*using, *more], identities, squares, degree, False)

        if relation == "=":
            proof = Proof(self._at_both(claim, identity))
        else:
            proof = Proof(induction=Induction(*self._at_both(claim, sign)))
        uses = (*_used(proof), *sorted(starts_in(statement, self.reading)))
        return self._display(Step(name, statement, "induction", _text(reason), proof, uses, lemma=True))

    def _at_both(self, claim: Claim, find: Callable[[Poly, Sequence[str]], T]) -> tuple[T, T]:
        """Find the certificates at the start, and one step later from the claim."""
        start, known = find(claim.start, ()), self.reading
        self.reading = claim.supposed(known)
        try:
            return start, find(claim.later, (HYPOTHESIS,))
        finally:
            self.reading = known

    def linked(
        self,
        name: str,
        statement: Equation,
        rule: Rule,
        reason: str | Text,
        links: Sequence[str],
        *,
        number: str = "",
        source: str = "",
        show: bool = True,
    ) -> Step:
        """Prove a statement from steps: 'both' inequalities, a 'squeeze', an 'integral'."""
        return self._keep(name, statement, rule, reason, Proof(links=tuple(links)), number, source, show)

    def equal(
        self,
        name: str,
        statement: Equation,
        using: Sequence[str],
        *,
        identities: Sequence[str] = (),
        squares: Sequence[Term] = (),
        reason: str = "both are nonnegative and have the same square",
    ) -> Step:
        """Prove a = b by a >= b and b >= a."""
        links = f"{name}, one way", f"{name}, the other"
        for link, e in zip(links, (statement, _turned(statement)), strict=True):
            self.sign(link, Equation(e.lhs, "≥", e.rhs), reason, using, identities=identities, squares=squares)
        return self.linked(name, statement, "both", "two inequalities", links)

    def record(self, step: Step) -> Step:
        """Replay a step and keep it; it also names the cases in which its quotients and roots are defined."""
        uses = dict.fromkeys((*step.uses, *self._consulted(step.statement), *self._cases(step.statement)))
        return super().record(self._complete(replace(step, uses=tuple(uses))))

    def _complete(self, step: Step) -> Step:
        """Name what is proved in a case as well, if the limits in a statement are not known without it."""
        limited = any(isinstance(side, Limit) for side in (step.statement.lhs, step.statement.rhs))
        if not limited or not _reads(step.statement, self.reading):
            return step
        hidden = hidden_from(step, self.reading, self.steps)
        more = [name for name in self.steps if name in hidden]

        def reads(names: Sequence[str]) -> bool:
            named = replace(step, uses=(*step.uses, *names))
            return _reads(step.statement, in_force(named, self.reading, self.steps))

        if reads(()):
            return step
        for name in tuple(more):
            if reads([other for other in more if other != name]):
                more.remove(name)
        return replace(step, uses=(*step.uses, *more))

    def _consulted(self, statement: Equation) -> list[str]:
        """Return the cases and proved limits without which the limits in a statement are not known."""
        limited = any(isinstance(side, Limit) for side in (statement.lhs, statement.rhs))
        if not limited or not _reads(statement, self.reading):
            return []
        reading, found = self.reading, list[str]()
        cases = {n for n, d in self.theory.declared.items() if isinstance(d, Declared) and d.case}

        def needs(names: set[str]) -> bool:
            facts = {k: v for k, v in reading.context.facts.items() if k not in names}
            return not _reads(statement, replace(reading, context=replace(reading.context, facts=facts)))

        if needs(cases):
            found += [name for name in self.theory.declared if name in cases and needs({name})]
        for name, step in self.steps.items():
            if isinstance(step.statement.lhs, Limit) and step.rule == "squeeze":
                known = value(step.statement.lhs.body, reading)
                limits = {k: v for k, v in reading.real.limits.items() if known.terms.keys() != {(k[2], ())}}
                if not _reads(statement, replace(reading, real=replace(reading.real, limits=limits))):
                    found.append(name)
        return found

    def _cases(self, statement: Equation) -> list[str]:
        """Return the cases that the atoms in a statement need."""
        declared, atoms = self.theory.declared, self.reading.real.atoms
        sides = [s.body if isinstance(s, (Limit, Definite, Rate, Start)) else s for s in (statement.lhs, statement.rhs)]
        waiting, seen = {s for side in sides for s in scalars_of(value(side, self.reading))}, set[str]()
        while waiting:
            name = waiting.pop()
            seen.add(name)
            if name in atoms:
                waiting |= scalars_of(atoms[name].of) - seen
        reasons = [item.because for name in sorted(seen) if isinstance(item := declared.get(name), DeclaredAtom)]
        return [r for r in reasons if isinstance(d := declared.get(r), Declared) and d.case]

    def _keep(
        self,
        name: str,
        statement: Equation,
        rule: Rule,
        reason: str | Text,
        proof: Proof,
        number: str,
        source: str,
        show: bool,
    ) -> Step:
        step = self.record(Step(name, statement, rule, _text(reason), proof, _used(proof), number, source, True))
        if show:
            self.items.append(Derived((step,)))
        return step

    def rate(self, name: str, statement: Equation, reason: str | Text, using: Sequence[str] = ()) -> Step:
        """Prove f = g because both have the same derivative in t and the same value at 0."""
        return self.state(name, statement, reason, using, rule="same rate")


def _reads(statement: Equation, reading: Reading) -> bool:
    return readable(statement.lhs, reading) and readable(statement.rhs, reading)


def readable(term: Term, reading: Reading) -> bool:
    """Tell whether a term has a meaning as a number."""
    try:
        value(term, reading)
    except Rejected:
        return False
    return True


def _turned(statement: Equation) -> Equation:
    return Equation(statement.rhs, statement.relation, statement.lhs)
