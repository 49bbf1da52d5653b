"""From the formulas and comments of a document, in order, to its claims."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from derive.check.formula import Broken, Event, Formula, Steer
from derive.check.item import Item, Setting
from derive.check.macros import without_definitions
from derive.check.notation import notation_file
from derive.check.rows import Row, equations
from derive.check.steering import Order, orders
from derive.claim import Claim
from derive.errors import InputError

__all__ = ["collect"]

MARKS = ("given", "claim", "skip")
LONGEST = 20_000  # characters of one display


def collect(events: Sequence[Event], file: str, setting: Setting, prefix: str = "") -> tuple[list[Item], Setting]:
    """Return the claims of a document, and the setting at its end.

    Args:
        events: what the document holds, in order.
        file: its name.
        setting: what holds at its beginning.
        prefix: what the ids of claims without a name begin with.
    """
    collector = Collector(file, setting, prefix)
    said = {i: found for i, event in enumerate(events) if (found := _orders(event)) is not None}
    marks = _marks(events, said)
    for i, event in enumerate(events):
        if isinstance(event, Formula):
            collector.formula(event, marks.get(i) or event.before)
        elif isinstance(event, Broken):
            collector.broken(event.message, event.line)
        elif isinstance(found := said.get(i), str):
            collector.broken(found, event.line)
        elif found:
            collector.steer(found, event.line)
    for i in marks.keys() - set(range(len(events))):
        collector.broken("expected a formula after the comment, got none", -i)
    return collector.items, collector.setting


def _orders(event: Event) -> list[Order] | str | None:
    """Return the orders of a comment, or what is wrong with it."""
    if not isinstance(event, Steer):
        return None
    try:
        return orders(event.text)
    except InputError as error:
        return str(error)


def _marks(events: Sequence[Event], said: Mapping[int, list[Order] | str]) -> dict[int, str]:
    """Return which formulas are given, claims or to be skipped; a comment without formula has its negative line."""
    found: dict[int, str] = {}
    for i, told in said.items():
        event = events[i]
        for mark in (order.key for order in told if isinstance(told, list) and order.key in MARKS):  # type: ignore[union-attr]
            found[_target(events, i, event)] = mark  # type: ignore[arg-type]
    return found


def _target(events: Sequence[Event], i: int, steer: Steer) -> int:
    """Return which formula a comment speaks of: one on its line, else the next displayed one."""
    formulas = [(j, e) for j, e in enumerate(events) if isinstance(e, Formula)]
    if not steer.alone:
        after = [j for j, e in formulas if j > i and e.line == steer.line]
        before = [j for j, e in formulas if j < i and e.line + e.latex.count("\n") in (steer.line, steer.line - 1)]
        if after or before:
            return after[0] if after else before[-1]
    return next((j for j, e in formulas if j > i and e.displayed), -steer.line)


class Collector:
    """Collects the claims of one document."""

    def __init__(self, file: str, setting: Setting, prefix: str):
        self.file, self.setting, self.prefix = file, setting, prefix
        self.start = setting
        self.items: list[Item] = []
        self.unnamed = 0

    def steer(self, told: Sequence[Order], line: int) -> None:
        """Follow the orders of a comment that hold from its place on; a new theory starts afresh."""
        for order in told:
            if order.key == "theory":
                fresh = self.start if self.setting.theory else self.setting
                self.setting = replace(
                    fresh, theory=order.value, macros=self.setting.macros, notation=self.setting.notation
                )
            elif order.key == "assume":
                self.setting = self.setting.assuming(order.value, f"line {line}")
            elif order.key == "scalar":
                self.setting = replace(self.setting, scalar=True)
            elif order.key == "notation":
                self._notation(order.value, line)

    def _notation(self, name: str, line: int) -> None:
        try:
            notation, macros = notation_file(Path(self.file).parent / name)
        except InputError as error:
            self.broken(str(error), line)
            return
        old = self.setting
        self.setting = replace(old, notation={**old.notation, **notation}, macros={**old.macros, **macros})

    def formula(self, formula: Formula, mark: str) -> None:
        """Take up a formula: a claim, an assumption, or nothing."""
        if mark == "skip" or not (formula.displayed or mark):
            return
        if len(formula.latex) > LONGEST:
            self.broken(f"expected a formula of at most {LONGEST} characters, got {len(formula.latex)}", formula.line)
            return
        source = without_definitions(formula.latex)
        for row in equations(source, formula.name):
            line = formula.line + source.count("\n", 0, row.offset)
            if mark == "given":
                self.setting = self.setting.assuming(row.latex, f"line {line}")
            else:
                self._claim(row, line, mark == "claim")

    def _claim(self, row: Row, line: int, explicit: bool) -> None:
        self.items.append(Item(self._at(row.latex, line, row.name), self.setting, explicit))

    def broken(self, message: str, line: int) -> None:
        """Take up a place from which no claim can be taken."""
        self.items.append(Item(self._at("", line, ""), self.setting, True, message))

    def _at(self, latex: str, line: int, name: str) -> Claim:
        self.unnamed += not name
        id_ = name or f"{self.prefix}u{self.unnamed}"
        s = self.setting
        return Claim(latex, s.theory, s.assume, s.scalar, id_, self.file, line, name)


def claims_of(pairs: Iterator[tuple[str, str]], file: str, setting: Setting) -> list[Item]:
    """Return claims that were given one by one, each with its id."""
    s = setting
    return [Item(Claim(latex, s.theory, s.assume, s.scalar, id_, file), s, True) for id_, latex in pairs]
