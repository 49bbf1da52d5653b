"""MathML Core printer: what browsers and screen readers take without any script."""

from __future__ import annotations

from html import escape

from derive.latex.alphabet import ACCENTS, SIGNS
from derive.latex.boxes import (
    BESIDE,
    THIN,
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
    tall,
)
from derive.latex.layout import layout
from derive.terms import Equation, Term

SPACE = '<mspace width=".17em"/>'
CAPITAL_GREEK = frozenset("ΓΔΘΛΞΠΣΥΦΨΩ")  # upright, as in LaTeX
DESCENDING = frozenset("Qfgjpqyβγζημξρςφϕχψ")
SINGLE = {":=": "≔"}


def mathml(term: Term | Equation, display: bool = False) -> str:
    """Print a term or an equation as a ``math`` element."""
    return math(layout(term), display)


def math(box: Box, display: bool = False) -> str:
    """Wrap a printed box in a ``math`` element."""
    return f'<math display="block">{_many(box)}</math>' if display else f"<math>{_many(box)}</math>"


def markup(box: Box) -> str:
    """Print a box as exactly one element."""
    match box:
        case Letter(text, upright):
            return _letter(text, upright)
        case Digits(text):
            return f"<mn>{text}</mn>"
        case Op(text, form):
            return _operator(text, form)
        case Row((Op(sign, "prefix"), *rest)):  # what stands first in its row is a prefix without saying so
            return f"<mrow><mo>{sign}</mo>{''.join(map(markup, rest))}</mrow>"
        case Row():
            return f"<mrow>{_many(box)}</mrow>"
        case Scripted(base, sub, sup):
            tag = "msub" if sup is None else "msup" if sub is None else "msubsup"
            return f"<{tag}>{_base(base, sub)}{''.join(markup(b) for b in (sub, sup) if b is not None)}</{tag}>"
        case Accented(base, accent):
            mark = f'<mo stretchy="false">{ACCENTS[accent][1]}</mo>'
            return f'<mover accent="true">{markup(base)}{mark}</mover>'
        case Over(top, bottom, small):
            style = ' displaystyle="false"' if small else ""
            return f"<mfrac{style}>{markup(top)}{markup(bottom)}</mfrac>"
        case Fenced():
            return f"<mrow>{_fenced(box)}</mrow>"
        case Radical(body):
            return f"<msqrt>{_many(body)}</msqrt>"
        case Table(rows):
            cells = ("".join(f"<mtd>{_many(c)}</mtd>" for c in r) for r in rows)
            return f"<mrow><mo>[</mo><mtable>{''.join(f'<mtr>{c}</mtr>' for c in cells)}</mtable><mo>]</mo></mrow>"


def _many(box: Box) -> str:
    """Print a box where any number of elements may stand; brackets of a fixed size need no row of their own."""
    items = box.items if isinstance(box, Row) else (box,)
    return "".join(_fenced(b) if isinstance(b, Fenced) and b.left != "|" and not tall(b) else markup(b) for b in items)


def _fenced(box: Fenced) -> str:
    fixed = "" if tall(box) else ' stretchy="false"'
    return f"<mo{fixed}>{box.left}</mo>{_many(box.body)}<mo{fixed}>{box.right}</mo>"


def _base(box: Box, sub: Box | None) -> str:
    """Print what carries scripts; neither a bracket nor the tail of a letter moves them away from the line."""
    letter = box.base if isinstance(box, Accented) else box
    if sub and isinstance(letter, Letter) and letter.text in DESCENDING:
        return f'<mpadded depth="0">{markup(box)}</mpadded>'
    if not isinstance(box, (Fenced, Row)) or tall(box):
        return markup(box)
    return f'<mpadded height=".62em">{_fenced(box) if isinstance(box, Fenced) else _many(box)}</mpadded>'


def _letter(text: str, upright: bool) -> str:
    normal = len(text) == 1 and (upright or text in CAPITAL_GREEK) and text.isascii() | (text in CAPITAL_GREEK)
    return f'<mi mathvariant="normal">{escape(text)}</mi>' if normal else f"<mi>{escape(text)}</mi>"


def _operator(text: str, form: str) -> str:
    if text in (THIN, BESIDE):
        return SPACE
    sign = escape(SINGLE.get(text, text))
    if text == TOP:
        return f"<mi>{sign}</mi>"
    if form == "infix":
        return f"<mo>{sign}</mo>"
    if form == "prefix":
        return f'<mo form="prefix">{sign}</mo>'
    return f'<mo lspace="0" rspace="0">{sign}</mo>' if text in SIGNS else f"<mo>{sign}</mo>"
