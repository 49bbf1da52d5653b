"""Questions about signs of polynomials, decided by z3's procedure for real closed fields.

Every question has a context of its own and a bound on resources, not on time, so that the answer is the same on every
machine and in every order. Letters are numbered: no name that somebody typed reaches z3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from math import inf
from time import monotonic
from typing import Any

from derive.kernel import Poly

__all__ = ["Answered", "Budget", "Fact", "ask"]

LIMIT = 400_000  # z3's count of resources for one question
TOTAL = 1_500_000  # and for all that one claim asks
Fact = tuple[str, Poly]  # a kind of fact, or "=" for a polynomial that is zero
SIGN = {"nonnegative": "(>= {} 0)", "positive": "(> {} 0)", "nonzero": "(distinct {} 0)", "=": "(= {} 0)"}


@dataclass
class Budget:
    """What one claim may still ask of z3; ``deadline`` is the last resort, by the clock."""

    left: int = TOTAL
    asked: int = 0
    deadline: float = inf

    def milliseconds(self) -> int:
        """Return the time that is left."""
        return int(max(1, min(600_000, 1000 * (self.deadline - monotonic()))))


@dataclass(frozen=True)
class Answered:
    """Whether there are real numbers with the signs asked for, None if undecided.

    ``core`` names facts that contradict each other; ``near`` are rational numbers at, or near, those that z3 found.
    """

    possible: bool | None
    core: tuple[str, ...] = ()
    near: Mapping[str, Fraction] | None = None


def ask(facts: Mapping[str, Fact], choices: Mapping[str, Sequence[Fact]], budget: Budget, digits: int = 0) -> Answered:
    """Ask whether facts can hold together, and one of each of the choices.

    Args:
        facts: facts by name.
        choices: by name, facts of which one has to hold.
        budget: what is left, of which what is spent is taken.
        digits: accuracy of the numbers that are returned where the answer is yes; 0 for none.
    """
    import z3

    if budget.left <= 0:
        return Answered(None)
    letters = sorted({x for _, p in chain(facts.values(), *choices.values()) for m, _ in p.terms for x in m})
    index = {x: f"x{i}" for i, x in enumerate(letters)}
    claims = [_fact(f, index) for f in facts.values()]
    claims += [f"(or {' '.join(_fact(f, index) for f in choice)})" for choice in choices.values()]
    names = [*facts, *choices]
    context = z3.Context()
    solver = z3.SolverFor("QF_NRA", ctx=context)
    solver.set("rlimit", min(LIMIT, budget.left), "timeout", budget.milliseconds())
    solver.from_string("".join(_script(letters, claims)))
    answer = solver.check(*(z3.Bool(f"p{i}", context) for i in range(len(claims))))
    budget.asked += 1
    budget.left -= _spent(solver)
    if answer == z3.unsat:
        return Answered(False, tuple(names[int(str(p)[1:])] for p in solver.unsat_core()))
    if answer != z3.sat:
        return Answered(None)
    return Answered(True, near=_model(solver.model(), letters, context, digits) if digits else None)


def _script(letters: Sequence[str], claims: Sequence[str]) -> Iterator[str]:
    yield from (f"(declare-const x{i} Real)" for i in range(len(letters)))
    yield from (f"(declare-const p{i} Bool)(assert (=> p{i} {claim}))" for i, claim in enumerate(claims))


def _fact(fact: Fact, index: Mapping[str, str]) -> str:
    kind, poly = fact
    addends = [_product(c, [index[x] for x in m]) for (m, _), c in poly.terms.items()]
    body = addends[0] if len(addends) == 1 else f"(+ {' '.join(addends)})" if addends else "0"
    return SIGN[kind].format(body)


def _product(c: Fraction, letters: Sequence[str]) -> str:
    size = f"(/ {abs(c.numerator)} {c.denominator})" if c.denominator != 1 else str(abs(c.numerator))
    number = f"(- {size})" if c < 0 else size
    return f"(* {number} {' '.join(letters)})" if letters else number


def _spent(solver: Any) -> int:
    return int(dict(iter(solver.statistics())).get("rlimit count", 0))


def _model(model: Any, letters: Sequence[str], context: Any, digits: int) -> dict[str, Fraction]:
    import z3

    values = dict[str, Fraction]()
    for i, name in enumerate(letters):
        value = model.eval(z3.Real(f"x{i}", context), model_completion=True)
        value = value if z3.is_rational_value(value) else value.approx(digits)
        values[name] = Fraction(value.numerator_as_long(), value.denominator_as_long())
    return values
