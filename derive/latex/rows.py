r"""Displays without their layout: ``aligned``, ``split``, ``cases`` and line breaks become separators of statements.

A row goes on with the statement before it when it starts with a relation or with a sign behind an empty cell, or when
the row before it ends in one; a sign that is repeated at the break is read once. Matrices keep their rows. Every pass
goes once through the tokens and keeps its own stack.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from derive.latex.tokens import Token, Unreadable
from derive.latex.vocabulary import BOXES, COLUMNED, LAYOUTS, MATRICES, SIGNS_OF_MULTIPLICATION

SIGNS = frozenset("+-*/") | SIGNS_OF_MULTIPLICATION | {"pm", "mp"}
STOPS = frozenset((",", ";", ".", ":"))
CLOSERS = frozenset((")", "]", "\\}", "}"))
MAX_DEPTH = 20
OPENING, SEPARATORS = frozenset(("(", "[", "\\{")), frozenset(("break", "column", "wide"))


def frame(tokens: list[Token]) -> tuple[list[Token], str, str]:
    """Return the tokens without layout, the label and the tag of the display."""
    body = [t for t in tokens if t.kind not in ("label", "tag")]
    label = next((t.text for t in tokens if t.kind == "label"), "")
    tag = ", ".join(t.text.strip("() ") for t in tokens if t.kind == "tag")
    return _joined(_flattened(_unboxed(_undollared(_systems(_paired_bars(_unbroken(body))))))), label, tag


def _undollared(tokens: list[Token]) -> list[Token]:
    """Drop the marks around the display: $, $$ and \\[."""
    first, last = 0, len(tokens)
    while first < last and tokens[first].text == "$" and tokens[last - 1].text == "$" and first < last - 1:
        first, last = first + 1, last - 1
    return tokens[first:last]


def _unboxed(tokens: list[Token]) -> list[Token]:
    """Drop the box around a whole display."""
    inner = tokens[:-1] if tokens and tokens[-1].text in (".", ",", ";") else tokens
    if len(inner) < 4 or inner[0].text not in BOXES or inner[1].text != "{" or inner[-1].text != "}":
        return tokens
    depth = 0
    for t in inner[1:-1]:
        depth += {"{": 1, "}": -1}.get(t.text, 0)
        if not depth:
            return tokens
    return inner[2:-1]


def _unbroken(tokens: list[Token]) -> list[Token]:
    r"""Drop ``\right. \\ & \left.``, which breaks a line inside brackets."""
    out: list[Token] = []
    i = 0
    while i < len(tokens):
        if tokens[i].text == "null" and tokens[i].side == "right":
            j = i + 1
            while j < len(tokens) and (tokens[j].kind == "break" or tokens[j].text == "&"):
                j += 1
            if j < len(tokens) and j > i + 1 and (tokens[j].text, tokens[j].side) == ("null", "left"):
                out.extend(tokens[i + 1 : i + 2])
                i = j + 1
                continue
        out.append(tokens[i])
        i += 1
    return out


def _paired_bars(tokens: list[Token]) -> list[Token]:
    """Mark a bar that stands alone between brackets as the bar of a condition: (k|k-1)."""
    out = list(tokens)
    open_levels: list[tuple[str, list[int]]] = []
    for i, t in enumerate(tokens):
        if t.text in OPENING or t.text == "{" or (t.kind == "delimiter" and t.side == "left"):
            open_levels.append((t.text, []))
        elif open_levels and (t.text in CLOSERS or (t.kind == "delimiter" and t.side == "right")):
            opened, bars = open_levels.pop()
            if len(bars) == 1 and opened in OPENING:
                out[bars[0]] = replace(tokens[bars[0]], side="middle")
        elif open_levels and t.kind == "delimiter" and t.text == "|" and not t.side:
            open_levels[-1][1].append(i)
    return out


def _systems(tokens: list[Token]) -> list[Token]:
    r"""Read ``\left\{ \begin{array}...\end{array} \right.`` as cases."""
    out = list(tokens)
    lefts: list[int] = []
    for i, t in enumerate(tokens):
        if t.kind == "delimiter" and t.side == "left":
            lefts.append(i)
        elif t.kind == "delimiter" and t.side == "right" and lefts:
            j = lefts.pop()
            inner = tokens[j + 1 : j + 2] + tokens[i - 1 : i]
            if (tokens[j].text, t.text) == ("\\{", "null") and [x.kind for x in inner] == ["begin", "finish"]:
                out[j + 1], out[i - 1] = (replace(x, text="cases", side="") for x in inner)
                out[j] = out[i] = replace(t, kind="nothing")
    return [t for t in out if t.kind != "nothing"]


@dataclass
class _Frame:
    """An environment that is open: its begin, whether its rows are statements, and the columns of this row."""

    begin: Token
    layout: bool
    columns: int = 0


class _Flattener:
    """Takes off the environments that only lay out, and turns their rows and columns into separators."""

    def __init__(self) -> None:
        self.frames = [_Frame(Token("begin", "equation", 0, 0), True)]
        self.out: list[Token] = []
        self.depth = 0
        self.broken: Token | None = None  # a line break inside brackets

    def put(self, t: Token) -> None:
        """Append a token; at a break inside brackets a sign must stand, and one that is repeated is read once."""
        last = self.out[-1] if self.out else t
        if self.broken is not None and not (_sign(t) and _same(t, last)):
            closes = t.text in CLOSERS or (t.kind == "delimiter" and t.side == "right")
            opened = last.text in OPENING or last.text == "," or (last.kind == "delimiter" and last.side == "left")
            if not (_dangling(last) or _dangling(t) or closes or opened):
                raise Unreadable(t.start, "a sign at a line break inside brackets", t.shown())
            self.out.append(t)
        elif self.broken is None:
            self.out.append(t)
        self.broken = None

    def begin(self, t: Token, tokens: list[Token], i: int) -> None:
        """Open an environment."""
        if len(self.frames) > MAX_DEPTH:
            raise Unreadable(t.start, f"at most {MAX_DEPTH} environments inside each other", "one more")
        layout = _is_layout(tokens, i, self.out)
        self.frames.append(_Frame(t, layout))
        if not layout:
            self.put(t)
            self.depth += 1

    def finish(self, t: Token) -> None:
        """Close an environment."""
        top = self.frames[-1]
        if t.text != top.begin.text or len(self.frames) == 1:
            raise Unreadable(t.start, f"\\end{{{top.begin.text}}}" if len(self.frames) > 1 else "a formula", t.shown())
        self.frames.pop()
        if not top.layout:
            self.broken = None
            self.out.append(t)
            self.depth -= 1

    def mark(self, t: Token) -> None:
        """Read a line break or an alignment."""
        top, ampersand = self.frames[-1], t.kind != "break"
        if not top.layout:
            self.out.append(replace(t, kind="cell" if ampersand else "row"))
        elif ampersand:
            top.columns += 1
            even = top.columns % 2 == 0 and top.begin.text in COLUMNED
            self.out.extend([replace(t, kind="column" if even else "align")] if not self.depth else [])
        else:
            top.columns = 0
            self.out.extend([t] if not self.depth else [])
            self.broken = t if self.depth else None


def _flattened(tokens: list[Token]) -> list[Token]:
    """Return the tokens without environments that only lay out."""
    flat = _Flattener()
    for i, t in enumerate(tokens):
        if t.kind == "begin":
            flat.begin(t, tokens, i)
        elif t.kind == "finish":
            flat.finish(t)
        elif t.kind == "break" or (t.text == "&" and t.kind == "sign"):
            flat.mark(t)
        elif t.kind != "wide" or not flat.depth:
            flat.put(t)
            flat.depth += _opens(t)
    if len(flat.frames) > 1:
        begin = flat.frames[-1].begin
        raise Unreadable(begin.start, f"\\end{{{begin.text}}} to {begin.shown()}", "the end of the formula")
    return flat.out


def _opens(token: Token) -> int:
    """Return by how much a token changes the depth of brackets."""
    if token.kind == "delimiter" and token.side in ("left", "right"):
        return 1 if token.side == "left" else -1
    if token.kind == "delimiter" and token.side == "middle":
        return 0
    return 1 if token.text in OPENING or token.text == "{" else -1 if token.text in CLOSERS else 0


def _is_layout(tokens: list[Token], i: int, before: list[Token]) -> bool:
    """Return whether an environment lays out statements: by its name, or where a statement starts."""
    name = tokens[i].text
    if name in LAYOUTS:
        return True
    if name == "cases" or name == "dcases" or name == "rcases":
        return not before or before[-1].kind in ("break", "column", "align", "word", "wide") or before[-1].text in STOPS
    if name not in MATRICES:
        raise Unreadable(tokens[i].start, "an environment for formulas", tokens[i].shown())
    return name == "array" and not before and _relates(tokens[i + 1 :])


def _relates(tokens: list[Token]) -> bool:
    """Return whether a relation stands on the level of these tokens before their first row ends."""
    depth = 0
    for t in tokens:
        depth += _opens(t) + {"begin": 1, "finish": -1}.get(t.kind, 0)
        if depth < 0 or (not depth and t.kind == "break"):
            return False
        if not depth and t.kind == "relation":
            return True
    return False


def _joined(tokens: list[Token]) -> list[Token]:
    """Decide at each break whether a new statement starts, and drop the breaks inside statements."""
    out: list[Token] = []
    relates = False
    for separator, segment in _segments(tokens):
        content = [t for t in segment if t.kind != "align"]
        if not content:
            continue
        first, last = content[0], out[-1] if out else Token("break", "", 0, 0)
        if not out or separator is None:
            out.extend(content)
        elif (first.kind == "relation" or _sign(first)) and _same(first, last):
            out.extend(content[1:])
        elif _dangling(last) or first.kind == "relation" or (_sign(first) and _continues(segment, content)):
            out.extend(content)
        else:
            if separator.kind == "break" and segment[0].kind == "align" and not _related(content) and relates:
                raise Unreadable(first.start, "a sign or a relation at the start of a row", first.shown())
            out.extend([separator, *content])
            relates = False
        relates = relates or _related(content)
    return out


def _segments(tokens: list[Token]) -> list[tuple[Token | None, list[Token]]]:
    segments: list[tuple[Token | None, list[Token]]] = [(None, [])]
    for t in tokens:
        if t.kind in SEPARATORS:
            segments.append((t, []))
        else:
            segments[-1][1].append(t)
    return segments


def _sign(token: Token) -> bool:
    return (token.kind == "sign" and token.text in "+-*/") or (token.kind == "command" and token.text in SIGNS)


def _same(first: Token, last: Token) -> bool:
    return (first.kind, first.text) == (last.kind, last.text)


def _dangling(token: Token) -> bool:
    return token.kind == "relation" or _sign(token)


def _continues(segment: list[Token], content: list[Token]) -> bool:
    """Return whether a row that starts with a sign goes on: behind an empty cell, or as it relates nothing."""
    return segment[0].kind == "align" or not _related(content)


def _related(content: list[Token]) -> bool:
    depth = 0
    for t in content:
        depth += _opens(t) + {"begin": 1, "finish": -1}.get(t.kind, 0)
        if not depth and t.kind == "relation":
            return True
    return False
