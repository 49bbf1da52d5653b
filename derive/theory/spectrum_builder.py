"""Write a lecture that goes from matrices to numbers: each statement is proved by the rules of its own kind."""

from __future__ import annotations

from collections.abc import Sequence

from derive.derivation import Proof, Rule, Step, Text
from derive.functions import is_scalar
from derive.kernel import Poly
from derive.kernel import Term as Addend
from derive.terms import Equation
from derive.theory.builder import Builder
from derive.theory.scalar_builder import ScalarBuilder


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
        """Replay a step and keep it; only statements about numbers name the cases of their atoms."""
        return super().record(step) if is_scalar(step.statement) else Builder.record(self, step)

    def positive_number(
        self, name: str, statement: Equation, reason: str | Text, facts: Sequence[str], number: str = "", source: str = ""
    ) -> Step:
        """Prove det V > 0 or tr(M P) >= 0 from facts about the matrices."""
        return self._keep(name, statement, "positive", reason, Proof(links=tuple(facts)), number, source, True)
