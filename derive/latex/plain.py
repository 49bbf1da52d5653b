"""Plain text printer for terminals and alternative texts, e.g. ``(A - L C) P (A - L C)' + Q``."""

from __future__ import annotations

import unicodedata

from derive.latex.alphabet import ACCENTS, SIGNS
from derive.latex.boxes import (
    APPLY,
    BESIDE,
    THIN,
    TIMES,
    TOP,
    Accented,
    Box,
    Digits,
    Fenced,
    Letter,
    Op,
    Over,
    Radical,
    Row,
    Scripted,
    Table,
)
from derive.latex.layout import layout
from derive.terms import Equation, Term

SPACES = {TIMES: " ", APPLY: "", THIN: " ", BESIDE: " "}


def plain(term: Term | Equation) -> str:
    """Print a term or an equation on one line of text."""
    return text(layout(term))


def text(box: Box) -> str:
    """Print a box as text."""
    match box:
        case Letter(letters):
            return unicodedata.normalize("NFKC", letters)
        case Digits(digits):
            return digits
        case Op(sign, form):
            printed = SPACES.get(sign, SIGNS.get(sign, ("", sign))[1])
            return f" {printed} " if form == "infix" else printed
        case Row(items):
            return "".join(map(text, items))
        case Scripted(base, sub, sup):
            lower = "_" + _group(text(sub)) if sub is not None else ""
            upper = "'" if sup == Op(TOP, "tight") else "^" + _group(text(sup)) if sup is not None else ""
            return text(base) + lower + upper + " " * isinstance(base, Op)
        case Accented(base, accent):
            return text(base) + ACCENTS[accent][2]
        case Over(top, bottom):
            return f"{_part(top)}/{_part(bottom)}" + " " * (not isinstance(top, Digits))
        case Fenced(body, left, right):
            return left + text(body) + right
        case Radical(body):
            return f"sqrt({text(body)})"
        case Table(rows):
            return "[" + "; ".join(", ".join(map(text, r)) for r in rows) + "]"


def _part(box: Box) -> str:
    """Print a part of a fraction, in parentheses unless it is a single box or the sign of a derivative."""
    derivative = isinstance(box, Row) and box.items[0] in (Letter("d", upright=True), Op("∂", "tight"))
    return f"({text(box)})" if isinstance(box, Row) and not derivative else text(box)


def _group(script: str) -> str:
    return script if script.isalnum() or script in ("-1", "+", "-", "*") else f"{{{script}}}"
