"""Write a lecture: state what follows, and let the prover find the certificate that the kernel replays.

Nothing enters a lecture unproved: a step without a certificate raises ``NotDerived`` when the lecture is built.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from derive.context import Declared, Theory, consulting, names_of
from derive.derivation import (
    Derived,
    Erratum,
    Evidence,
    Given,
    GivenRow,
    Heading,
    Item,
    Lecture,
    Paragraph,
    Proof,
    Rule,
    Step,
    Text,
    check,
    claims,
    learn,
    order_claim,
)
from derive.kernel import Poly, Rejected
from derive.kernel import Term as Addend
from derive.matrix.positivity import prove_comparison, prove_positive
from derive.matrix.search import prove
from derive.rules import Context, Square, Uniqueness, at_start, rate_equation
from derive.terms import Equation, Reading, Term, lower


class NotDerived(Exception):  # noqa: N818 - a statement of fact about the lecture
    """A step of a lecture for which no certificate was found, or whose certificate the kernel rejects."""


@dataclass(frozen=True)
class SquareOf:
    """A proposed addend c F H F' of a positivity proof: the factor as a term, H by the name of its fact."""

    factor: Term
    fact: str
    coefficient: Fraction = Fraction(1)


def _text(reason: str | Text) -> Text:
    return (reason,) if isinstance(reason, str) else reason


def _used(proof: Proof, tables: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the declarations and lemmas a step rests on: relations, facts, and entries of tables that were read."""
    names = [re.sub(r"(\[\d+,\d+\]|\.left|\.right)$", "", r) for r in sorted(proof.relations())]
    return tuple(dict.fromkeys(n for n in (*names, *tables) if n not in proof.links))


class Builder:
    """Collect the items of one lecture over one theory."""

    def __init__(self, theory: Theory, key: str, title: str, sources: Sequence[str] = ()):
        self.theory, self.key, self.title, self.sources = theory, key, title, tuple(sources)
        self.reading: Reading = theory.reading()
        self.items: list[Item] = []
        self.steps: dict[str, Step] = {}

    def heading(self, title: str) -> None:
        """Start a section."""
        self.items.append(Heading(title))

    def say(self, *text: str | Term | Equation) -> None:
        """Add a paragraph; terms and equations are typeset inline."""
        self.items.append(Paragraph(text))

    def given(self, *names: str, numbers: Sequence[str] = (), source: str = "", reasons: Sequence[str] = ()) -> None:
        """Display declarations of the theory by name."""
        rows: list[GivenRow] = []
        for i, name in enumerate(names):
            item = self.theory.declared[name]
            if not isinstance(item, Declared):
                raise NotDerived(f"{self.key}: {name!r} is not an equation that can be displayed")
            number = numbers[i] if i < len(numbers) else ""
            reason = (reasons[i],) if i < len(reasons) and reasons[i] else (item.text,) if item.text else ()
            rows.append(GivenRow(item.statement, name, item.kind, number, source if number else "", reason))
        self.items.append(Given(tuple(rows)))

    def chain(self, start: Term) -> Chain:
        """Start a chain of equations from a term."""
        return Chain(self, start)

    def erratum(
        self,
        source: str,
        number: str,
        finding: Literal["false", "incomplete", "assumption", "silent"],
        printed: Equation | Text,
        *text: str | Term | Equation,
        evidence: Sequence[Evidence] = (),
        true: Equation | None = None,
        proved_by: str = "",
    ) -> None:
        """Record what is wrong or missing in a source, with its evidence."""
        if proved_by and proved_by not in self.steps:
            raise NotDerived(f"{self.key}: the erratum names {proved_by!r}, which is not a step of this lecture")
        self.items.append(Erratum(source, number, finding, printed, text, tuple(evidence), true, proved_by))

    def prove(self, claim: Poly, using: Sequence[str], trace: bool = False, label: str = "") -> tuple[Addend, ...]:
        """Find the addends of a certificate from the named relations and lemmas."""
        found = prove(claim, self._with_only(using).relations, self.reading.context.alphabet, trace=trace)
        if found is None:
            raise self._missing(label, using)
        return found.terms

    def _missing(self, label: str, using: Sequence[str]) -> NotDerived:
        return NotDerived(f"{self.key}: no certificate for {label} from {', '.join(using) or 'nothing'}")

    def _with_only(self, using: Sequence[str]) -> Context:
        """Return what may be used with no other relations than the named declarations and lemmas."""
        relations = self.reading.context.relations
        allowed = {r: relations[r] for name in using for r in names_of(name, relations)}
        return replace(self.reading.context, relations=allowed)

    def record(self, step: Step) -> Step:
        """Replay a step with the kernel and keep it; a lemma may be used from now on."""
        try:
            check(step, self.reading, self.steps)
        except Rejected as error:
            raise NotDerived(f"{self.key}: step {step.name!r}: {error}") from error
        if step.name in self.steps or step.name in self.theory.declared:
            raise NotDerived(f"{self.key}: the name {step.name!r} is taken")
        self.steps[step.name] = step
        self.reading = learn(self.reading, self.theory, step)
        return step

    def state(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        using: Sequence[str] = (),
        *,
        rule: Rule = "identity",
        number: str = "",
        source: str = "",
        lemma: bool = True,
    ) -> Step:
        """Prove and display one equation on its own."""
        step = self.equation(name, statement, reason, using, rule, number, source, lemma)
        self.items.append(Derived((step,)))
        return step

    def _display(self, step: Step) -> Step:
        self.items.append(Derived((self.record(step),)))
        return step

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
        """Prove one equation without displaying it."""
        reading, *tables = consulting(self.reading)
        try:
            wanted = claims(statement, rule, reading)
        except Rejected as error:
            raise NotDerived(f"{self.key}: step {name!r}: {error}") from error
        proofs = tuple(replace(c, terms=self.prove(c.claim, using, c.trace, name)) for c in wanted)
        read = sorted(self.reading.origins[key] for table in tables for key in table.read)
        proof = Proof(proofs)
        step = Step(name, statement, rule, _text(reason), proof, _used(proof, read), number, source, lemma)
        return self.record(step)

    def positive(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        squares: Sequence[SquareOf],
        using: Sequence[str] = (),
        *,
        witness: Term | None = None,
        number: str = "",
        source: str = "",
    ) -> Step:
        """Prove lhs ⪰ rhs, or lhs ≻ rhs: one square is positive definite, ``witness`` its factor's right inverse."""
        context = self._with_only(using)
        made = [Square(s.coefficient, (), lower(s.factor, self.reading), s.fact) for s in squares]
        proof = prove_positive(
            order_claim(statement, self.reading),
            context,
            made,
            strict=statement.relation == "≻",
            inverse=lower(witness, self.reading)[0][0] if witness else None,
        )
        if proof is None:
            raise self._missing(name, using)
        done = Proof(positivity=proof)
        step = Step(name, statement, "positivity", _text(reason), done, _used(done), number, source, True)
        return self._display(step)

    def compare(
        self,
        name: str,
        kind: str,
        statement: Equation,
        reason: str | Text,
        matrix: Term,
        stable: str,
        forcing: str,
        using: Sequence[str] = (),
        *,
        number: str = "",
        source: str = "",
    ) -> Step:
        """Prove lhs ⪰ rhs by comparison: Lyapunov or Stein equation, or from the initial time on."""
        d, m = order_claim(statement, self.reading)[0][0], lower(matrix, self.reading)[0][0]
        proof = prove_comparison(kind, d, m, stable, forcing, self._with_only(using))
        if proof is None:
            raise self._missing(name, using)
        done = Proof(comparison=proof)
        step = Step(name, statement, "comparison", _text(reason), done, _used(done), number, source, True)
        return self._display(step)

    def unique(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        left: Term,
        right: Term,
        using: Sequence[str] = (),
        *,
        number: str = "",
        source: str = "",
    ) -> Step:
        """Prove f = g because both solve dX/dt = M X + X N + (the same) and agree at t0."""
        context = self.reading.context
        claim = order_claim(statement, self.reading)[0][0]
        m, n = lower(left, self.reading)[0][0], lower(right, self.reading)[0][0]
        rate = self.prove(rate_equation(claim, m, n, context), using, label=name)
        initial = self.prove(at_start(claim, context), using, label=name)
        proof = Proof(uniqueness=Uniqueness(claim, m, n, rate, initial))
        return self._display(
            Step(name, statement, "uniqueness", _text(reason), proof, _used(proof), number, source, True)
        )

    def lecture(self) -> Lecture:
        """Close the lecture; every declaration of the theory must have come into force."""
        waiting = set(self.theory.declared) - self.reading.adopted
        if waiting:
            raise NotDerived(
                f"{self.key}: declarations whose inverse was never justified: {', '.join(sorted(waiting))}"
            )
        return Lecture(self.key, self.title, self.theory, tuple(self.items), self.sources)


class Chain:
    """A chain of equations t0 = t1 = t2 ...; ``close`` states its ends as a lemma and displays it."""

    def __init__(self, builder: Builder, start: Term):
        self.builder, self.start, self.end = builder, start, start
        self.links: list[Step] = []

    def to(
        self,
        after: Term,
        reason: str | Text,
        using: Sequence[str] = (),
        *,
        rule: Rule = "identity",
        number: str = "",
        source: str = "",
        name: str = "",
    ) -> Chain:
        """Prove that the last term equals ``after``."""
        label = name or f"{self.builder.key}.{len(self.builder.steps) + 1}"
        statement = Equation(self.end, "=", after)
        self.links.append(self.builder.equation(label, statement, reason, using, rule, number, source))
        self.end = after
        return self

    def close(
        self,
        name: str,
        *,
        number: str = "",
        source: str = "",
        reason: str | Text = "ends of the chain",
        lemma: bool = True,
    ) -> Step:
        """State first = last, as a lemma that later steps may use unless said otherwise, and display the chain."""
        statement = Equation(self.start, "=", self.end)
        proof = Proof(links=tuple(s.name for s in self.links))
        ends = self.builder.record(Step(name, statement, "chain", _text(reason), proof, (), number, source, lemma))
        self.builder.items.append(Derived((*self.links, ends)))
        return ends
