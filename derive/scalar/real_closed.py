"""Questions about signs of polynomials, decided by z3's procedure for real closed fields.

Every question has a context of its own and a bound on resources, not on time, so that the answer is the same on every
machine and in every order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from derive.kernel import Poly

__all__ = ["Budget", "Model", "Question"]

LIMIT = 1_500_000  # z3's count of resources for one question
TOTAL = 12_000_000  # and for all that one claim asks
Fact = tuple[str, Poly]  # a kind of fact, or "=" for a polynomial that is zero


@dataclass
class Budget:
    """What one claim may still ask of z3."""

    left: int = TOTAL
    asked: int = 0


@dataclass(frozen=True)
class Model:
    """Rational values near those that z3 found; exact says whether they are those."""

    values: Mapping[str, Fraction]
    exact: bool


@dataclass
class Question:
    """Facts of which it is asked whether they can hold together; of each of the alternatives one has to."""

    facts: Sequence[Fact]
    alternatives: Sequence[Sequence[Fact]] = ()
    model: Model | None = field(default=None)

    def possible(self, budget: Budget, digits: int = 0) -> bool | None:
        """Tell whether there are real numbers with these signs; None if it is not decided within the budget."""
        import z3

        if budget.left <= 0:
            return None
        context = z3.Context()
        solver = z3.SolverFor("QF_NRA", ctx=context)
        solver.set("rlimit", min(LIMIT, budget.left))
        write = _Writer(context)
        solver.add(*(write.fact(*f) for f in self.facts))
        for choice in self.alternatives:
            solver.add(z3.Or(*(write.fact(*f) for f in choice)))
        answer = solver.check()
        budget.asked += 1
        budget.left -= _spent(solver)
        if answer == z3.sat and digits:
            self.model = write.model(solver.model(), digits)
        return True if answer == z3.sat else False if answer == z3.unsat else None


def _spent(solver: Any) -> int:
    statistics = solver.statistics()
    return int(statistics.get_key_value("rlimit count")) if "rlimit count" in statistics.keys() else 0


class _Writer:
    """Writes polynomials in a context of z3."""

    def __init__(self, context: Any):
        import z3

        self.z3, self.context = z3, context
        self.letters: dict[str, Any] = {}
        self.zero = z3.RealVal(0, context)

    def letter(self, name: str) -> Any:
        if name not in self.letters:
            self.letters[name] = self.z3.Real(f"x{len(self.letters)}", self.context)
        return self.letters[name]

    def poly(self, poly: Poly) -> Any:
        addends = [self._product(c, m) for (m, _), c in poly.terms.items()]
        return addends[0] if len(addends) == 1 else self.z3.Sum(addends) if addends else self.zero

    def _product(self, c: Fraction, names: Iterable[str]) -> Any:
        factors = [self.letter(n) for n in names]
        if c != 1 or not factors:
            factors.insert(0, self.z3.RealVal(str(c), self.context))
        return factors[0] if len(factors) == 1 else self.z3.Product(factors)

    def fact(self, kind: str, poly: Poly) -> Any:
        value = self.poly(poly)
        match kind:
            case "nonnegative":
                return value >= self.zero
            case "positive":
                return value > self.zero
            case "nonzero":
                return value != self.zero
            case _:
                return value == self.zero

    def model(self, model: Any, digits: int) -> Model:
        values, exact = dict[str, Fraction](), True
        for name, letter in self.letters.items():
            value = model.eval(letter, model_completion=True)
            if self.z3.is_rational_value(value):
                values[name] = Fraction(value.numerator_as_long(), value.denominator_as_long())
            else:
                near = value.approx(digits)
                values[name] = Fraction(near.numerator_as_long(), near.denominator_as_long())
                exact = False
        return Model(values, exact)
