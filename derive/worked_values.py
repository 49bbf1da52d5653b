"""Numbers, names and matrices of a plant as the pages print them."""

from __future__ import annotations

import re
from math import floor, log10
from typing import Any

from derive.notes.model import Row, slug
from derive.numeric.plant import Plant
from derive.terms import Block as Matrix
from derive.terms import Glyph, Neg, Symbol, Term

__all__ = [
    "decimal", "drawn_labels", "letter", "matrix", "mode", "number", "proper", "row", "spread", "time_label", "unit_of",
]  # fmt: skip

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def letter(name: str, sub: str = "") -> Symbol:
    """Return a letter for the text around numbers."""
    return Symbol(name + sub, glyph=Glyph(name, sub=sub))


def row(name: str, values: Any, anchor: str, sub: str = "") -> Row:
    """Return the line that gives a matrix."""
    return Row(letter(name, sub), "=", matrix(values), slug(anchor, name + sub))


def matrix(values: Any) -> Matrix:
    """Return a matrix of numbers as a term that prints them in decimals."""
    return Matrix(tuple(tuple(decimal(float(value)) for value in row) for row in values))


def decimal(value: float) -> Term:
    """Return a number as a term that prints it with five significant digits."""
    text = number(abs(value))
    digits = Symbol(text, glyph=Glyph(text, upright=True))
    return Neg(digits) if value < 0 else digits


def number(value: float | None, form: str = ".5g") -> str:
    """Return a number as text, with a proper minus sign; a dash for none."""
    return "–" if value is None else f"{value:{form}}".replace("-", "−")


def proper(text: str) -> str:
    """Return a text with proper minus signs before digits."""
    return "".join("−" if a == "-" and b.isdigit() else a for a, b in zip(text, text[1:] + " ", strict=True))


def spread(value: float, half_width: float) -> str:
    """Return a value with its half width, both to the second digit of that: 7.19 ± 0.20."""
    if not half_width > 0:
        return number(value, ".6g")
    place = floor(log10(half_width)) - 1
    if -4 <= place <= 0 and abs(value) < 1e6:
        return f"{number(value, f'.{-place}f')} ± {half_width:.{-place}f}"
    digits = max(0, floor(log10(max(abs(value), half_width))) - place - 1)
    return f"{number(value, f'.{digits}e')} ± {number(half_width, '.0e')}"


def mode(value: complex) -> str:
    """Return an eigenvalue as text."""
    if not abs(value.imag):
        return number(value.real)
    if not abs(value.real):
        return f"{number(value.imag)}j"
    return f"{number(value.real)} {'−' if value.imag < 0 else '+'} {number(abs(value.imag))}j"


def drawn_labels(plant: Plant) -> list[str]:
    """Return the names of the states for a drawing, with their units; x1 is set as a letter with an index."""
    names = [f"$x_{{{name[1:]}}}$" if name[0] == "x" and name[1:].isdigit() else _plain(name) for name in plant.states]
    return [f"{shown} [{_plain(unit)}]" if (unit := unit_of(plant, name)) else shown
            for shown, name in zip(names, plant.states, strict=True)]  # fmt: skip


def _plain(text: str) -> str:
    """Return a text in which a drawing sees no mathematics."""
    return text.replace("$", r"\$")


def unit_of(plant: Plant, name: str) -> str:
    """Return the unit of a state or an output with raised powers, nothing where the plant gives none."""
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(RAISED), plant.units.get(name, ""))


def time_label(plant: Plant) -> str:
    """Return the label of the axis of time."""
    return "t [s]" if plant.is_continuous or plant.dt else "k"
