"""Write a lecture that goes from matrices to numbers: each statement is proved by the rules of its own kind."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from derive.analysis import is_scalar
from derive.context import DeclaredFact
from derive.derivation import Proof, Rule, Step, Text
from derive.functions import Limit, value
from derive.kernel import Poly
from derive.kernel import Term as Addend
from derive.real import scalars_of
from derive.spectral import Entry
from derive.terms import Equation, Reading, walk
from derive.theory.builder import Builder
from derive.theory.scalar_builder import ScalarBuilder, readable


class SpectrumBuilder(ScalarBuilder):
    """Collect the items of a lecture about matrices, their determinants and traces, and the roots of polynomials."""

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
        """Prove one equation: between matrices with the kernel, between numbers as a scalar identity."""
        if rule == "identity" and not is_scalar(statement):
            return Builder.equation(self, name, statement, reason, using, rule, number, source, lemma)
        return super().equation(name, statement, reason, using, rule, number, source, lemma)

    def prove(self, claim: Poly, using: Sequence[str], trace: bool = False, label: str = "") -> tuple[Addend, ...]:
        """Find the addends of a certificate, for matrices or for scalars."""
        if trace or claim.rows or any(word for _, word in claim.terms):
            return Builder.prove(self, claim, using, trace, label)
        return super().prove(claim, using, trace, label)

    def record(self, step: Step) -> Step:
        """Replay a step and keep it; one about numbers also names the limits it reads, and l = 1 if it has entries."""
        if not is_scalar(step.statement):
            return Builder.record(self, step)
        nodes = [n for side in (step.statement.lhs, step.statement.rhs) for n in walk(side)]
        single = [n for n, d in self.theory.declared.items() if isinstance(d, DeclaredFact) and d.kind == "single"]
        entries = single if any(isinstance(n, Entry) for n in nodes) else []
        read = [n for n in nodes if isinstance(n, Limit)]
        if step.rule == "same argument" and isinstance(step.statement.lhs, Limit):
            found = self.steps[step.proof.links[0]].statement.rhs
            read = [replace(step.statement.lhs, body=found)]
        return super().record(replace(step, uses=(*step.uses, *entries, *self._limits(read))))

    def _limits(self, read: Sequence[Limit]) -> list[str]:
        """Return the steps without which limits are not known."""
        found: list[str] = []
        for term in (n for n in read if readable(n, self.reading)):
            scalars = self._moving(term)
            near = [n for n, first in self._known(term) if n not in found and first <= scalars]
            found += [n for n in near if not readable(term, self._without(n))]
        return found

    def _known(self, term: Limit) -> Iterator[tuple[str, set[str]]]:
        """Iterate over steps that are limits as the same variable tends to the same point, with their first product."""
        for name, step in self.steps.items():
            lhs = step.statement.lhs
            if isinstance(lhs, Limit) and (lhs.symbol, lhs.point) == (term.symbol, term.point):
                (m, _), *_ = value(lhs.body, self.reading).terms
                yield name, {s for s in m if self.reading.real.varies(s, term.symbol.name)}

    def _moving(self, term: Limit) -> set[str]:
        """Return the scalars in a limit that depend on its variable."""
        real = self.reading.real
        body = real.unfold(value(term.body, self.reading))
        return {s for s in scalars_of(body) if real.varies(s, term.symbol.name)}

    def _without(self, name: str) -> Reading:
        """Return the reading without the limit that a step has proved."""
        reading, lhs = self.reading, self.steps[name].statement.lhs
        if not isinstance(lhs, Limit):
            return reading
        known = value(lhs.body, reading)
        limits = {k: v for k, v in reading.real.limits.items() if known.terms.keys() != {(k[2], ())}}
        sums = tuple(k for k in reading.real.sums if k[2] != known)
        return replace(reading, real=replace(reading.real, limits=limits, sums=sums))

    def positive_number(
        self,
        name: str,
        statement: Equation,
        reason: str | Text,
        facts: Sequence[str],
        number: str = "",
        source: str = "",
    ) -> Step:
        """Prove det V > 0 or tr(M P) >= 0 from facts about the matrices."""
        return self._keep(name, statement, "positive", reason, Proof(links=tuple(facts)), number, source, True)
