r"""LaTeX printer: plain amsmath, no macros of its own, e.g. ``(A - L C) P + P (A - L C)^\top``."""

from __future__ import annotations

import re

from derive.latex.alphabet import ACCENTS, GREEK, SIGNS
from derive.latex.boxes import (
    APPLY,
    BESIDE,
    SCRIPT,
    THIN,
    TIMES,
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
    tall,
)
from derive.latex.layout import layout
from derive.terms import Equation, Term

COMMANDS = {char: "\\" + name for name, char in GREEK.items()}
COMMANDS |= {"𝔼": r"\mathbb{E}", **{s: rf"\mathcal{{{chr(ord('A') + i)}}}" for i, s in enumerate(SCRIPT)}}
SPACES = {TIMES: " ", APPLY: "", THIN: r"\,", BESIDE: " "}
NAMES = frozenset(("tr", "Re", "Im"))
BUILT_IN = frozenset(("max", "ln", "arctan", "lim", "det"))  # operators that LaTeX has a command for
ENDS_IN_COMMAND = re.compile(r"\\[A-Za-z]+$")


def latex(term: Term | Equation) -> str:
    """Print a term or an equation as LaTeX for math mode, in the order in which it was written."""
    return tex(layout(term))


def tex(box: Box) -> str:
    """Print a box as LaTeX."""
    match box:
        case Letter(text, upright):
            return _letter(text, upright)
        case Digits(text):
            return text
        case Op(text, form):
            return _operator(text, form)
        case Row(items):
            return _joined([tex(b) for b in items])
        case Scripted(Op() as sign, sub, sup) if sub and sup:
            return f"{tex(sign)}_{{{tex(sub)}}}^{{{tex(sup)}}} "
        case Scripted(base, sub, sup):
            scripts = (mark + _braced(tex(b)) for mark, b in (("_", sub), ("^", sup)) if b is not None)
            return tex(base) + "".join(scripts)
        case Accented(base, accent):
            return _joined(["\\" + ACCENTS[accent][0], _braced(tex(base))])
        case Over(top, bottom, small):
            return _fraction(tex(top), tex(bottom), small)
        case Fenced(body, left, right):
            return rf"\left{left}{tex(body)}\right{right}" if tall(box) else f"{left}{tex(body)}{right}"
        case Radical(body):
            return rf"\sqrt{{{tex(body)}}}"
        case Table(rows):
            lines = r" \\ ".join(" & ".join(map(tex, r)) for r in rows)
            return rf"\begin{{bmatrix}} {lines} \end{{bmatrix}}"


def _letter(text: str, upright: bool) -> str:
    if text in COMMANDS:
        return COMMANDS[text]
    if text in BUILT_IN:
        return "\\" + text
    if len(text) > 1:
        return rf"\operatorname{{{text}}}" if text in NAMES else rf"\mathrm{{{text}}}"
    return rf"\mathrm{{{text}}}" if upright else text


def _operator(text: str, form: str) -> str:
    if text in SPACES:
        return SPACES[text]
    sign = SIGNS.get(text, (text,))[0]
    return f" {sign} " if form == "infix" else sign


def _joined(pieces: list[str]) -> str:
    """Join pieces; a control word and a letter after it are kept apart."""
    out = ""
    for piece in pieces:
        out += " " + piece if ENDS_IN_COMMAND.search(out) and piece[:1].isalpha() else piece
    return out


def _braced(text: str) -> str:
    """Put braces around an argument that needs them."""
    return text if len(text) == 1 or re.fullmatch(r"\\[A-Za-z]+", text) else f"{{{text}}}"


def _fraction(top: str, bottom: str, small: bool) -> str:
    command = r"\tfrac" if small else r"\frac"
    if len(top) == len(bottom) == 1 and (top + bottom).isdigit():
        return f"{command}{top}{bottom}"
    return f"{command}{{{top}}}{{{bottom}}}"
