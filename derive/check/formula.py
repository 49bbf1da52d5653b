"""What a document holds, in order: formulas, comments that steer the checker, macros, and what is broken."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field

__all__ = ["Broken", "Event", "Formula", "Macros", "Places", "Steer"]


@dataclass(frozen=True)
class Formula:
    """A formula as it stands between its delimiters; ``line`` is that of its first letter, ``name`` its label.

    ``before`` says what a comment inside it asks for: "given", "claim", "skip" or nothing.
    """

    latex: str
    line: int
    name: str = ""
    displayed: bool = True
    before: str = ""


@dataclass(frozen=True)
class Steer:
    """A comment to the checker, e.g. ``theory=luenberger-dt``; ``alone`` if nothing else is on its line."""

    text: str
    line: int
    alone: bool = True


@dataclass(frozen=True)
class Macros:
    """LaTeX text that defines macros."""

    latex: str
    line: int


@dataclass(frozen=True)
class Broken:
    """A place where a formula or comment begins and cannot be read to its end."""

    message: str
    line: int


Event = Formula | Steer | Macros | Broken


@dataclass(frozen=True)
class Places:
    """Line numbers of the positions in a text that begins at line ``first`` of its file."""

    text: str
    first: int = 1
    _ends: list[int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_ends", [i for i, c in enumerate(self.text) if c == "\n"])

    def row(self, position: int) -> int:
        """Return the index of the line that holds a position."""
        return bisect_right(self._ends, position - 1)

    def line(self, position: int) -> int:
        """Return the number, in the file, of the line that holds a position."""
        return self.first + self.row(position)

    def start(self, position: int) -> int:
        """Return where the line that holds a position begins."""
        row = self.row(position)
        return self._ends[row - 1] + 1 if row else 0

    def end(self, position: int) -> int:
        """Return where the line that holds a position ends."""
        row = self.row(position)
        return self._ends[row] if row < len(self._ends) else len(self.text)
