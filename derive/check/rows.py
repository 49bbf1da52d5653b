r"""A display as the equations in it: rows of align and its kin, with the rows that continue them, and their names.

Whatever is taken away (comments, labels, alignment) leaves blanks, so that every letter keeps its column.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

__all__ = ["Row", "equations"]

NUMBERED_ROWS = frozenset(("align", "gather", "eqnarray", "alignat", "flalign"))
COMMON_NUMBER = frozenset(("aligned", "split", "gathered", "alignedat", "cases", "dcases"))
ONE_EQUATION = frozenset(("equation", "multline", "displaymath", "math", "dmath"))
DEPTH = 50  # of environments around an equation

BEGIN = re.compile(r"\s*\\begin\{(?P<name>[A-Za-z]+)(?P<star>\*?)\}(?:\{[^{}]*\})?")
PIECE = re.compile(r"\\begin\{[A-Za-z*]+\}|\\end\{[A-Za-z*]+\}|\\\\(?:\*?\[[^\]\n]*\])?|\\.|[{}&]", re.DOTALL)
COMMENT = re.compile(r"(?<!\\)((?:\\\\)*)%[^\n]*")
TAG = re.compile(r"\\tag\*?\s*+\{([^{}]*+)\}")
LABEL = re.compile(r"\\label\s*+\{([^{}]*+)\}")
SILENT = re.compile(r"\\(?:nonumber|notag|allowdisplaybreaks|displaystyle|limits)(?![A-Za-z])")
NUMBER = re.compile(r"(?:\\q?quad|[.,;])\s*\((\d+(?:\.\d+)*[a-z]?)\)[\s.,;]*\Z")
RELATION = re.compile(
    r"(?:[=<>≤≥≻≺⪰⪯≜]|:=|\\(?:leq?|geq?|eq|equiv|neq?|prec|succ|preceq|succeq|triangleq|coloneqq|lt|gt)(?![A-Za-z]))"
)
SIGN = re.compile(r"(?:[-+−±]|\\(?:pm|cdot|times|quad|qquad)(?![A-Za-z]))")
SPACE_AT_END = re.compile(r"\\q?quad\Z")
OPERATOR_AT_END = re.compile(r"(?:[-+−=]|\\cdot|\\times)\s*\Z")


@dataclass(frozen=True)
class Row:
    """One equation of a display: LaTeX, how far into the display it begins, and its name."""

    latex: str
    offset: int
    name: str = ""


def equations(source: str, name: str = "") -> list[Row]:
    """Return the equations of a display, in order; ``name`` is what stands beside the display."""
    return _equations(COMMENT.sub(lambda m: m[1] + _blanks(m[0][len(m[1]) :]), source), name, 0, 0)


def _equations(source: str, name: str, offset: int, depth: int) -> list[Row]:
    inner = _inside(source)
    if inner is None or depth == DEPTH:
        text, own = _named(source)
        text = _without_end(text)
        start = len(text) - len(text.lstrip())
        return [Row(text[start:], offset + start, own or name)] if text[start:] else []
    kind, start, stop = inner
    name = _named(source[:start] + source[stop:])[1] or name
    body = source[start:stop]
    if kind not in NUMBERED_ROWS:
        body, own = _named(body)
        name = own or name
    if kind in ONE_EQUATION:
        return _equations(_one_row(body) if kind == "multline" else body, name, offset + start, depth + 1)
    found = [row for at, text in _joined(body, kind) for row in _equations(text, "", offset + start + at, depth + 1)]
    several = len(found) > 1
    return [Row(r.latex, r.offset, r.name or (_part(name, i) if several else name)) for i, r in enumerate(found)]


def _inside(source: str) -> tuple[str, int, int] | None:
    """Return kind and extent of the body if the source is one environment of equations."""
    begin = BEGIN.match(source)
    if not begin or begin["name"] not in NUMBERED_ROWS | COMMON_NUMBER | ONE_EQUATION:
        return None
    depth = 0
    for piece in PIECE.finditer(source):
        depth += piece[0].startswith("\\begin{") - piece[0].startswith("\\end{")
        if depth == 0 and piece[0].startswith("\\end{"):
            rest = _named(source[piece.end() :])[0]
            return None if rest.strip(" \t\n.,;") else (begin["name"], begin.end(), piece.start())
    return None


def _part(name: str, i: int) -> str:
    """Name the i-th equation of a display: 2a, 2b; or eq:riccati-1."""
    if not name:
        return ""
    return f"{name}{chr(ord('a') + i)}" if name[-1].isdigit() and i < 26 else f"{name}-{i + 1}"


def _joined(body: str, kind: str) -> Iterator[tuple[int, str]]:
    """Iterate over (start, text) of the equations in rows; a row that continues an equation is joined to it."""
    extents = list(_rows(body))
    clean = list(_one_row(body))
    for start, stop in extents:
        _unalign(clean, start, stop, kind)
    texts = ["".join(clean[start:stop]) for start, stop in extents]
    first = 0
    for i, (start, stop) in enumerate(extents[1:], 1):
        begun = any(t.strip() for t in texts[first:i])
        if begun and _continues(texts[i - 1], body[start:stop], texts[i]):
            _drop_double_sign(clean, texts[i - 1], start, texts[i])
        else:
            yield extents[first][0], "".join(clean[extents[first][0] : extents[i - 1][1]])
            first = i
    yield extents[first][0], "".join(clean[extents[first][0] :])


def _rows(body: str) -> Iterator[tuple[int, int]]:
    """Iterate over the extents of the rows of a body."""
    depth = start = 0
    for piece in PIECE.finditer(body):
        depth += _opens(piece[0])
        if depth == 0 and piece[0].startswith("\\\\"):
            yield start, piece.start()
            start = piece.end()
    yield start, len(body)


def _opens(piece: str) -> int:
    """Return 1 for what opens a group or environment, -1 for what closes one, 0 otherwise."""
    return (piece == "{" or piece.startswith("\\begin{")) - (piece == "}" or piece.startswith("\\end{"))


def _one_row(body: str) -> str:
    """Blank the line breaks of a body."""
    clean, depth = list(body), 0
    for piece in PIECE.finditer(body):
        depth += _opens(piece[0])
        if depth == 0 and piece[0].startswith("\\\\"):
            clean[piece.start() : piece.end()] = _blanks(piece[0])
    return "".join(clean)


def _unalign(clean: list[str], start: int, stop: int, kind: str) -> None:
    """Blank the alignment of a row; every second mark stands between two equations, and becomes a comma."""
    text = "".join(clean[start:stop])
    depth = marks = seen = 0
    for piece in PIECE.finditer(text):
        depth += _opens(piece[0])
        if depth == 0 and piece[0] == "&":
            marks += 1
            between = text[seen : piece.start()].strip()
            seen = piece.end()
            needed = marks % 2 == 0 and between and not between.endswith((",", ";")) and kind != "eqnarray"
            clean[start + piece.start()] = "," if needed else " "


def _continues(before: str, written: str, row: str) -> bool:
    """Whether a row goes on with the equation before it."""
    text = row.strip()
    if not text or RELATION.match(text) or OPERATOR_AT_END.search(before):
        return True
    return bool(SIGN.match(text)) and (written.lstrip().startswith("&") or not RELATION.search(text))


def _drop_double_sign(clean: list[str], before: str, start: int, row: str) -> None:
    """Blank a sign at the start of a row that the row before ends with: a + \\\\ & + b."""
    last = before.rstrip()[-1:]
    if last and last in "+=-−" and row.lstrip().startswith(last):
        clean[start + len(row) - len(row.lstrip())] = " "


def _named(source: str) -> tuple[str, str]:
    """Return a source whose labels, numbers and switches are blanks, and the name that they give."""
    tag, label, number = TAG.search(source), LABEL.search(source), NUMBER.search(source)
    for pattern in (TAG, LABEL, SILENT, NUMBER):
        source = pattern.sub(lambda m: _blanks(m[0]), source)
    found = tag or number or label
    return source, found[1].strip(" \t\n()") if found else ""


def _without_end(text: str) -> str:
    """Return a text without the full stop, comma and spacing at its end."""
    while text:
        shorter = text.rstrip(" \t\n.,;~")
        escapes = len(shorter) - len(shorter.rstrip("\\"))
        if escapes % 2 and len(shorter) < len(text):  # the spacing commands \\, and \\;
            shorter = shorter[:-1]
        shorter = SPACE_AT_END.sub("", shorter)
        if shorter == text:
            break
        text = shorter
    return text


def _blanks(text: str) -> str:
    """Return as many blanks as a text has letters, its line ends kept."""
    return "".join("\n" if c == "\n" else " " for c in text)
