"""Boxes: what a formula looks like, before a printer writes it; how wide a box is, and where it may be broken."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from derive.latex.alphabet import GREEK

TIMES, APPLY, THIN = "\u2062", "\u2061", "\u2009"  # invisible times, function application, thin space
BESIDE = "\u2006"  # the space around the name of a function, which TeX sets by itself
TOP, INTEGRAL = "⊤", "∫"
SCRIPT = "𝒜ℬ𝒞𝒟ℰℱ𝒢ℋℐ𝒥𝒦ℒℳ𝒩𝒪𝒫𝒬ℛ𝒮𝒯𝒰𝒱𝒲𝒳𝒴𝒵"
BREAKS = frozenset({"+", "−", "=", ":=", "⪰", "≻"})  # a line may be broken before these


@dataclass(frozen=True)
class Letter:
    """A letter in italics, or upright; a word is always upright."""

    text: str
    upright: bool = False


@dataclass(frozen=True)
class Digits:
    """A number without sign."""

    text: str


@dataclass(frozen=True)
class Op:
    """An operator: 'infix' with space around it, 'prefix' in front of its operand, or 'tight' without space."""

    text: str
    form: str = "infix"


@dataclass(frozen=True)
class Row:
    """Boxes side by side."""

    items: tuple[Box, ...]


@dataclass(frozen=True)
class Scripted:
    """A base with a subscript, a superscript, or both."""

    base: Box
    sub: Box | None = None
    sup: Box | None = None


@dataclass(frozen=True)
class Accented:
    """A base under an accent: hat, bar, dot or tilde."""

    base: Box
    accent: str


@dataclass(frozen=True)
class Over:
    """A fraction; ``small`` keeps it at the size of running text."""

    top: Box
    bottom: Box
    small: bool = False


@dataclass(frozen=True)
class Fenced:
    """A body between brackets, which grow with it when it is tall."""

    body: Box
    left: str = "("
    right: str = ")"


@dataclass(frozen=True)
class Radical:
    """A square root."""

    body: Box


@dataclass(frozen=True)
class Table:
    """Rows of cells between square brackets."""

    rows: tuple[tuple[Box, ...], ...]


Box = Letter | Digits | Op | Row | Scripted | Accented | Over | Fenced | Radical | Table


def parts(box: Box) -> Iterator[Box]:
    """Iterate over the boxes directly inside a box, from left to right."""
    match box:
        case Row(items):
            yield from items
        case Scripted(base, sub, sup):
            yield from (b for b in (base, sub, sup) if b is not None)
        case Accented(base):
            yield base
        case Over(top, bottom):
            yield from (top, bottom)
        case Fenced(body) | Radical(body):
            yield body
        case Table(rows):
            yield from (cell for row in rows for cell in row)
        case _:
            return


def inside(box: Box) -> Iterator[Box]:
    """Iterate over a box and everything in it."""
    yield box
    for part in parts(box):
        yield from inside(part)


def tall(box: Box) -> bool:
    """Return whether a box is higher than a line of text."""
    return any(
        isinstance(b, Table) or (isinstance(b, Over) and not b.small) or b == Op(INTEGRAL, "prefix")
        for b in inside(box)
    )


def row(items: Iterable[Box]) -> Box:
    """Set boxes side by side; rows inside are dissolved, a single box stays as it is."""
    flat = [b for item in items for b in (item.items if isinstance(item, Row) else (item,))]
    return flat[0] if len(flat) == 1 else Row(tuple(flat))


def width(box: Box) -> float:
    """Estimate the width in em, to decide where a row may be broken."""
    match box:
        case Letter(text) | Digits(text):
            return 0.6 * len(text)
        case Op(text, form):
            return 0.0 if text in (TIMES, APPLY) else 0.2 if text in (THIN, BESIDE) else 1.3 if form == "infix" else 0.5
        case Scripted(base, sub, sup):
            return width(base) + 0.7 * max((width(b) for b in (sub, sup) if b is not None), default=0.0)
        case Over(top, bottom, small):
            return (0.7 if small else 1.0) * max(width(top), width(bottom))
        case Fenced(body) | Radical(body):
            return width(body) + 0.8
        case Table(rows):
            return sum(max(width(r[i]) for r in rows) + 0.8 for i in range(len(rows[0]))) + 0.4
        case _:
            return sum(map(width, parts(box)))


def split(box: Box) -> list[Box]:
    """Split an equation or sum where a line may be broken: before each relation and each sign between addends."""
    pieces: list[list[Box]] = [[]]
    for item in box.items if isinstance(box, Row) else (box,):
        if isinstance(item, Op) and item.form == "infix" and item.text in BREAKS and pieces[-1]:
            pieces.append([])
        pieces[-1].append(item)
    return [row(p) for p in pieces]


def label(text: str) -> Box:
    """Lay out an index or a time: letters, numbers and signs; digits right after a letter are its subscript."""
    items: list[Box] = []
    if text.startswith("e^"):
        return Scripted(Letter("e", upright=True), None, label(text[2:]))
    found: list[tuple[str, str, str, str]] = re.findall(r"(\\[A-Za-z]+|[^\W\d_])(\d*)|(\d+)|(\S)", text)
    for letter, index, digits, sign in found:
        if letter:
            base = Letter(GREEK.get(letter.lstrip("\\"), letter.lstrip("\\")))
            items.append(Scripted(base, Digits(index)) if index else base)
        elif digits:
            items.append(Digits(digits))
        elif sign not in "_{}":
            items.append(Letter(sign) if sign == "∞" else Op({"-": "−", "*": "∗"}.get(sign, sign), "tight"))
    return row(items)
