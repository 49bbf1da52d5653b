"""What a theory lets a claim use: typed symbols under the names that people write, and a few proved relations.

A lecture derives; a claim is decided from the lecture's results. Each relation here is a definition or hypothesis of
the lecture's theory, or one of its proved steps, and says which. Only what bears on the letters of a claim is declared
for it, so that proofs are fast: what is left out constrains no letter of the claim.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

from derive.context import Theory
from derive.errors import InputError
from derive.kernel import Rejected
from derive.terms import Equation, Glyph, Reading, Symbol, Term

Proved = tuple[str, str]  # lecture and step
STEPS = 6  # between the first and the last index of a claim
SCALAR = "1"  # used where all dimensions are 1
INDEX = re.compile(r"^(?:([ijknNt])([+-]\d+)?|(\d+))$")


@dataclass(frozen=True)
class ClaimTheory:
    """The theory that claims are read in.

    ``theory`` holds the symbols and declares what may be used; ``names`` gives the meaning of a spelled name (letter,
    accents, index: see derive.interpret.names); ``optimal`` are the declarations that hold for the optimal gain only;
    ``proved_by`` names, for a declaration that the source does not make, the lecture and the step that proves it;
    ``added`` are hypotheses that no source states.

    A declared fact or hypothesis that is a ``case`` ("A - L C Schur") holds of every instance, so that a counterexample
    has to satisfy it, but no proof may use it: at the boundary it fails. ``conditions`` are assumed relations that the
    kernel has no word for (C ≠ 0 of a matrix, A < 0 of a scalar): counterexamples satisfy them, scalar proofs may use
    them.
    """

    key: str
    title: str
    theory: Theory
    names: Mapping[str, Term]
    optimal: frozenset[str] = frozenset()
    proved_by: Mapping[str, Proved] = field(default_factory=dict[str, Proved])
    added: frozenset[str] = frozenset()
    conditions: tuple[Equation, ...] = ()
    outline: Outline | None = field(default=None, compare=False, repr=False)

    def about(self, letters: Collection[str]) -> ClaimTheory:
        """Return the theory with no more than what bears on the given letters; "@τ" says that one is used at τ.

        "Phi@t,τ" is one at two times; SCALAR among them says that all dimensions are 1.
        """
        return about(self.outline, frozenset(letters)) if self.outline else self

    @cached_property
    def reading(self) -> Reading:
        """What may be used, as the kernel reads it."""
        return self.theory.reading()


@dataclass(frozen=True, eq=False)
class Outline:
    """A theory before anything is declared: its letters, their spelled names, and how declarations are chosen.

    A letter of ``letters`` whose name ends in # stands for one letter at every index. ``declare`` adds to a draft what
    bears on the letters that are used; ``usual`` are the letters of the whole theory.
    """

    key: str
    title: str
    letters: Theory
    names: Mapping[str, Term]
    declare: Callable[[Draft], None]
    usual: frozenset[str]
    sizes: frozenset[str]  # of state, output and input: where these are 1, everything commutes

    def claims(self) -> ClaimTheory:
        """Return the whole theory."""
        return about(self, self.usual)


@lru_cache(maxsize=512)
def about(outline: Outline, letters: frozenset[str]) -> ClaimTheory:
    """Return the claims' theory that bears on some letters."""
    draft = Draft(outline, letters)
    outline.declare(draft)
    optimal, added = frozenset(draft.optimal), frozenset(draft.added)
    return ClaimTheory(
        outline.key, outline.title, draft.theory, outline.names, optimal, draft.proved_by, added, outline=outline
    )


class Draft:
    """Collect what may be used of a theory by a claim with given letters."""

    def __init__(self, outline: Outline, used: frozenset[str]):
        letters = outline.letters
        self.outline, self.used = outline, used
        plain = {name: s for name, s in letters.symbols.items() if not name.endswith("#")}
        self.theory = copy(letters, plain)
        self.optimal: set[str] = set()
        self.added: set[str] = set()
        self.proved_by: dict[str, Proved] = {}

    def has(self, *names: str) -> bool:
        """Tell whether one of the letters is used."""
        return not self.used.isdisjoint(names)

    def of(self, *names: str) -> list[Symbol]:
        """Return letters by their names; one with an index is declared."""
        return [self.theory.symbols.get(name) or self._indexed(name) for name in names]

    def scalar(self, *names: str) -> bool:
        """Tell whether a letter is used where all dimensions are 1: there, detectability is C ≠ 0 or a stable A."""
        return SCALAR in self.used and self.has(*names)

    def times(self) -> list[str]:
        """Return the times at which letters are used, t first."""
        found = sorted(name[1:] for name in self.used if name.startswith("@"))
        return ["t", *(time for time in found if time != "t")]

    def pairs(self, name: str) -> list[tuple[str, str]]:
        """Return the pairs of times at which a letter such as Phi is used."""
        used = sorted(letter.partition("@")[2] for letter in self.used if letter.startswith(name + "@"))
        return [(one, two) for one, _, two in (times.partition(",") for times in used)]

    def at(self, stem: str, index: str) -> Symbol:
        """Return the letter of a family at an index."""
        return self.of(indexed_name(stem + "_#", index))[0]

    def _indexed(self, name: str) -> Symbol:
        symbol = add_indexed(self.theory, self.outline.letters, name)
        if symbol is None:
            raise Rejected(f"{name} is no letter of {self.outline.key}")
        return symbol

    def indices(self) -> dict[str, dict[int, set[str]]]:
        """Return which families are used at which index: for each index letter, by its number.

        Raises:
            InputError: indices that are many steps apart.
        """
        letters, found = self.outline.letters.symbols, dict[str, dict[int, set[str]]]()
        for name in self.used:
            stem, index = split_index(name)
            if index and name not in letters and stem + "_#" in letters:
                letter, number = count(index)
                found.setdefault(letter, {}).setdefault(number, set()).add(stem)
        for letter, numbers in found.items():
            if max(numbers) - min(numbers) > STEPS:
                apart = f"{index_at(letter, min(numbers))} and {index_at(letter, max(numbers))}"
                raise InputError(f"indices: expected at most {STEPS} steps between them, got {apart}")
        return found

    def note(self, name: str, by: Proved | None, optimal: bool) -> None:
        """Note what proves a declaration, and whether it needs the optimal gain."""
        if by is not None:
            self.proved_by[name] = by
        if optimal:
            self.optimal.add(name)

    def given(self, lecture: Theory, *names: str) -> None:
        """Declare what a lecture's theory declares under some names."""
        for name in names:
            self.theory.declared[name] = lecture.declared[name]

    def define(
        self, name: str, lhs: Term, rhs: Term, text: str = "", *, by: Proved | None = None, optimal: bool = False
    ) -> None:
        """Declare lhs := rhs."""
        self.note(name, by, optimal)
        self.theory.define(name, lhs, rhs, text)

    def assume(
        self,
        name: str,
        lhs: Term,
        relation: str,
        rhs: Term | None = None,
        text: str = "",
        *,
        by: Proved | None = None,
        optimal: bool = False,
    ) -> None:
        """Declare a hypothesis of the theory, or a proved relation."""
        self.note(name, by, optimal)
        self.theory.assume(name, lhs, relation, rhs, text)

    def stable(self, name: str, kind: str, matrix: Term) -> None:
        """Declare that every instance is stabilising; a proof may not use it."""
        self.theory.fact(name, kind, matrix, "the stabilising solution", case=True)

    def inverse(self, name: str, of: Term, size: str, because: str, *, symmetric: bool = True) -> None:
        """Declare the letter of an inverse, with the fact by which it exists."""
        self.theory.inverse(name, of, size, symmetric=symmetric, because=because)


def named_at(name: str, time: str) -> str:
    """Return the name of a declaration at a time, plain at t."""
    return name if time == "t" else f"{name} at {time}"


# ------------------------------------------------------------------------------------------------ letters
FLAGS = ("random", "uncentred", "constant", "parameters", "nonnegative", "complex", "arbitrary", "running")


def copy(theory: Theory, symbols: Mapping[str, Symbol] | None = None) -> Theory:
    """Return a theory with the same letters, to which declarations may be added without changing the first."""
    made = Theory(theory.key, theory.title, dict(theory.symbols if symbols is None else symbols))
    made.declared = dict(theory.declared) if symbols is None else {}
    made.families = dict(theory.families)
    for name in FLAGS:
        setattr(made, name, set(getattr(theory, name)))
    return made


def indexed_name(prototype: str, index: str) -> str:
    """Return the name of a letter at an index: P_# at k-1 is P_{k-1}."""
    return prototype.replace("#", index if len(index) == 1 else f"{{{index}}}")


def at_index(prototype: Symbol, index: str) -> Symbol:
    """Return the letter of a family at an index."""
    look = prototype.glyph
    glyph = Glyph(look.letter, look.accent, look.sub.replace("#", index), look.sup, look.upright)
    return replace(prototype, name=indexed_name(prototype.name, index), glyph=glyph)


def add_indexed(theory: Theory, letters: Theory, name: str) -> Symbol | None:
    """Add a letter with an index to a theory, with the properties of its family."""
    stem, index = split_index(name)
    prototype = letters.symbols.get(stem + "_#")
    if prototype is None or not index:
        return None
    theory.symbols[name] = symbol = at_index(prototype, index)
    for flag in FLAGS:
        if prototype.name in getattr(letters, flag):
            getattr(theory, flag).add(name)
    return symbol


def split_index(name: str) -> tuple[str, str]:
    """Split P_{k-1} into P and k-1; a name without index has the index ''."""
    stem, _, index = name.partition("_")
    index = index[1:-1] if index.startswith("{") else index
    return (stem, index) if INDEX.match(index) else (name, "")


def count(index: str) -> tuple[str, int]:
    """Return an index as a letter and a number: k-1 is (k, -1), 0 is ('', 0)."""
    match = INDEX.match(index)
    if match is None:
        raise Rejected(f"{index} is no index")
    letter, shift, number = match.groups()
    return (letter, int(shift or 0)) if letter else ("", int(number))


def index_at(letter: str, number: int) -> str:
    """Return the index of a letter and a number."""
    return f"{letter}{number:+d}" if letter and number else letter or str(number)
