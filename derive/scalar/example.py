"""A counterexample between real numbers, whose values may be roots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from flint import fmpq

from derive.claim import Counterexample
from derive.scalar.evaluate import plain
from derive.scalar.flint_ring import fraction
from derive.scalar.work import Failure, Work

__all__ = ["NumberExample", "example"]


@dataclass(frozen=True)
class NumberExample(Counterexample):
    """A counterexample in which a letter or a side may be no rational number.

    ``also`` gives such letters as expressions; ``sides`` say in words or digits what the two sides are where they are
    not both rational, or why the formula is undefined.
    """

    also: Mapping[str, str] = field(default_factory=dict[str, str])
    sides: tuple[str, str] = ("", "")

    def to_json(self) -> dict[str, object]:
        """Return what a counterexample has, with the values and sides that are not rational."""
        found = super().to_json()
        if self.also:
            found["roots"] = dict(self.also)
        return {**found, "sides": list(self.sides)} if any(self.sides) else found

    def __str__(self) -> str:
        """Return one line, as a counterexample does."""
        if not any(self.sides):
            return super().__str__()
        values, _, _ = super().__str__().rpartition(": left")
        values = ", ".join([*filter(None, [values]), *(f"{n} = {x}" for n, x in self.also.items())])
        left, right = self.sides
        return f"{values}: left {left}, right {right}" if right else f"{values}: {left}"


def example(work: Work, failure: Failure) -> Counterexample:
    """Return the counterexample that an instance makes."""
    symbols = work.statement.theory.theory.symbols
    point = {n: v for n, v in failure.instance.values.items() if n in work.shown}
    exact = {n: fraction(v) for n, v in point.items() if isinstance(v, fmpq)}
    central = {n for n in exact if n in symbols and symbols[n].scalar}
    sizes = {s: 1 for n in exact if n in symbols for s in (symbols[n].rows, symbols[n].cols) if s}
    left, right = (plain(x) for x in (failure.left, failure.right))
    also = {n: words for n, words in failure.instance.roots.items() if n in work.shown}
    sides = ("", "")
    if failure.undefined:
        sides = failure.undefined, ""
    elif left is None or right is None or also:
        sides = _text(failure.left), _text(failure.right)
    return NumberExample(
        sizes or {"1": 1}, {_at_start(n): ((x,),) for n, x in exact.items() if n not in central},
        () if left is None or any(sides) else ((left,),), () if right is None or any(sides) else ((right,),),
        work.statement.equations[failure.number].relation, {n: exact[n] for n in exact if n in central},
        also=also, sides=sides,
    )  # fmt: skip


def _at_start(name: str) -> str:
    """Return how a reader knows a letter: P(t)@t0 is P(0)."""
    stem, _, time = name.partition("@")
    return stem.removesuffix("(t)") + "(0)" if time == "t0" else name


def _text(value: Any) -> str:
    """Write a number exactly, or its first digits."""
    exact = plain(value)
    return str(exact) if exact is not None else f"{value.str(12, radius=False)}…"
