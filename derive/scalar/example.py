"""A counterexample between real numbers, whose values may be roots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.claim import Counterexample

__all__ = ["NumberExample"]


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
