"""Claims, verdicts, and the counterexample that carries a refutation. Standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction

__all__ = ["Answer", "Claim", "Counterexample", "Entries", "Nearest", "Verdict"]

Entries = tuple[tuple[Fraction, ...], ...]  # a matrix, row by row


class Verdict(Enum):
    """What can be said of a claim."""

    proved = "proved"
    refuted = "refuted"
    supported = "supported"
    undecided = "undecided"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True)
class Counterexample:
    """An instance that satisfies every hypothesis exactly, and at which the claim fails.

    ``values`` holds every letter, ``scalars`` the central scalars; ``hidden`` are the letters that follow from others
    (inverses) and are not printed. ``left`` and ``right`` are the two sides of the claim (1 x 1 under a trace).
    """

    sizes: Mapping[str, int]
    values: Mapping[str, Entries]
    left: Entries
    right: Entries
    relation: str = "="
    scalars: Mapping[str, Fraction] = field(default_factory=dict[str, Fraction])
    hidden: frozenset[str] = frozenset()
    trace: bool = False

    def to_json(self) -> dict[str, object]:
        """Return nested lists of "p/q" strings, as certificates on file hold them."""
        return {
            "sizes": dict(self.sizes),
            "values": {name: _texts(value) for name, value in self.values.items()},
            "scalars": {name: str(value) for name, value in self.scalars.items()},
            "relation": self.relation,
            "trace": self.trace,
            "left": _texts(self.left),
            "right": _texts(self.right),
        }

    def __str__(self) -> str:
        """Return one line; letters of equal value share an equation: A = 2, C = P = 1: left 7/2, right 3."""
        groups: dict[str, list[str]] = {}
        shown = {name: show(value) for name, value in self.values.items() if name not in self.hidden}
        for name, text in {**shown, **{name: str(value) for name, value in self.scalars.items()}}.items():
            groups.setdefault(text, []).append(name)
        values = ", ".join(" = ".join([*names, text]) for text, names in groups.items())
        return f"{values}: left {show(self.left)}, right {show(self.right)}"


@dataclass(frozen=True)
class Claim:
    """A formula somebody wrote, and what it is read in.

    ``theory`` is empty if it is to be guessed; ``assume`` are relations in LaTeX; ``scalar`` reads every dimension as
    1. ``file``, ``line`` and ``name`` (a label or number such as 31.10) say where it stands.
    """

    latex: str
    theory: str = ""
    assume: tuple[str, ...] = ()
    scalar: bool = False
    id: str = ""
    file: str = ""
    line: int = 0
    name: str = ""


@dataclass(frozen=True)
class Nearest:
    """The nearest true formula to a refuted one: LaTeX, proved, and the edit in words."""

    latex: str
    edit: str


@dataclass(frozen=True)
class Answer:
    """What can be said of a claim, and why.

    ``method`` is the authority: "kernel" (a certificate replays), "sign argument" (replayed without z3), "z3", "exact
    instance", "undefined", "types", "theorem of <lecture>", "enclosures". ``hypotheses_not_needed`` are those of the
    theory that bear on the claim and that its proof does not use; ``added`` those of no source that it needs;
    ``assumed`` what a user declared as given. ``notes`` are sentences for the reader: every gain, conventions, common
    mistakes. ``certificate`` is JSON data that `derive verify` replays.
    """

    verdict: Verdict
    method: str = ""
    hypotheses_used: tuple[str, ...] = ()
    hypotheses_not_needed: tuple[str, ...] = ()
    hypotheses_added: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    counterexample: Counterexample | None = None
    needed: Mapping[str, Counterexample] = field(default_factory=dict[str, Counterexample])  # without that hypothesis
    nearest: Nearest | None = None
    notes: tuple[str, ...] = ()
    certificate: Mapping[str, object] | None = None


def show(value: Entries) -> str:
    """Write a matrix on one line; a 1 x 1 matrix is written as its entry."""
    if len(value) == 1 and len(value[0]) == 1:
        return str(value[0][0])
    return "[" + ", ".join("[" + ", ".join(map(str, row)) + "]" for row in value) + "]"


def _texts(value: Entries) -> list[list[str]]:
    return [[str(x) for x in row] for row in value]
