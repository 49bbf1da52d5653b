r"""Tokens of a formula, each with its columns in the source: ``P_k \succeq 0`` gives P _ k ⪰ 0.

Comments and thin spaces are dropped, Greek letters and signs are read in LaTeX and in Unicode alike (``ẋ``, ``x̂``,
``Aᵀ``, ``R⁻¹``, ``xₖ``, ``⪰``), text and labels are taken as they stand. One pass, linear in the length of the source.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, replace

from derive.errors import InputError
from derive.latex.vocabulary import (
    ACCENT_OF,
    CHARACTERS,
    DELIMITERS,
    DROPPED,
    DROPPED_WITH_ARGUMENT,
    LETTERS,
    POSITIONED,
    RAW,
    RELATIONS,
    SIZES,
    SPELLED_ACCENT,
    TEXT,
    WIDE,
)

MAX_SOURCE = 10_000  # characters of one displayed formula
MAX_TOKENS = 6_000  # of one displayed formula
MAX_DIGITS = 30  # of one number


class Unreadable(InputError):  # noqa: N818 (the state of a formula, as its name says)
    """A formula that cannot be read; ``column`` counts the characters of the source from 0."""

    def __init__(self, column: int, expected: str, got: str) -> None:
        self.column, self.expected, self.got = column, _printable(expected), _printable(got)
        super().__init__(f"column {column + 1}: expected {self.expected}, got {self.got}")


def _printable(text: str) -> str:
    """Return a text on one line, with marks for what cannot be shown."""
    return "".join(c if c.isprintable() else "�" for c in " ".join(text.split()))


def caret(source: str, error: Unreadable) -> str:
    """Return the line of the source that holds the error, and below it a caret under the column."""
    column = min(error.column, len(source))
    start = source.rfind("\n", 0, column) + 1
    line = source[start : start + 20_000].split("\n", 1)[0]
    left = max(0, column - start - 60)
    shown = "".join(" " if c.isspace() else c if c.isprintable() else "�" for c in line[left : left + 110])
    return f"{shown}\n{' ' * (column - start - left)}^"


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of a formula: ``text`` without backslash, and where it stands.

    ``kind``: letter (Latin, or the name of a Greek letter), number, command, relation, sign, delimiter, wide (a space
    that separates), word (text), label, tag, begin, finish (of an environment), parameter (of a macro), end.
    ``side`` of a delimiter: left, right, middle, or empty if its size says nothing; of an array its columns.
    """

    kind: str
    text: str
    start: int
    end: int
    side: str = ""

    def shown(self) -> str:
        """Return how an error names the token."""
        match self.kind:
            case "end":
                return "the end of the formula"
            case "delimiter" if self.text == "null":
                return f"\\{self.side}."
            case "break" | "column" | "wide":
                return "the end of a row"
            case "command":
                return f"\\{self.text[:40]}"
            case "begin" | "finish":
                return f"\\{'begin' if self.kind == 'begin' else 'end'}{{{self.text[:40]}}}"
            case "word":
                return f'the words "{self.text[:40]}"'
            case _:
                return f"\\{self.text}" if self.kind == "letter" and len(self.text) > 1 else self.text[:40]


PATTERN = re.compile(
    r"(?P<space>\s+|~|%[^\n]*)|(?P<command>\\[A-Za-z]+)|(?P<escape>\\[^A-Za-z])|(?P<number>[0-9]+(?:\.[0-9]+)*)"
    r"|(?P<parameter>\#[1-9])|(?P<letter>[A-Za-z])|(?P<relation>:=|=|<|>)|(?P<dots>\.\.\.)"
    r"|(?P<delimiter>[()\[\]|])|(?P<sign>[-+*/^_{}&.,;:!'$])|(?P<other>.)",
    re.DOTALL,
)
GAP = re.compile(r"\s*")
POSITION = re.compile(r"\s*\[[tbc]\]")  # of aligned and array on their line
DISTANCE = re.compile(r"\*?(?:\[-?[0-9.]+ ?(?:pt|em|ex|mm|cm|in|mu|bp|pc|sp)\])?")  # to the next row
INVISIBLE = frozenset("\u200b\u2060\u2061\u2062\u2063\u2064\ufeff")


def tokenise(source: str) -> list[Token]:
    """Return the tokens of a source, without an end.

    Raises:
        Unreadable: the source is too long, or holds a character that no formula has.
    """
    if len(source) > MAX_SOURCE:
        raise Unreadable(0, f"a formula of at most {MAX_SOURCE} characters", f"{len(source)} characters")
    tokens: list[Token] = []
    for token in _raw(source):
        tokens.append(token)
        if len(tokens) > MAX_TOKENS:
            raise Unreadable(token.start, f"a formula of at most {MAX_TOKENS} letters and signs", "one more")
    return tokens


def _raw(source: str) -> Iterator[Token]:
    position = 0
    while position < len(source):
        found = PATTERN.match(source, position)
        assert found is not None
        kind, text, start, position = found.lastgroup or "other", found[0], position, found.end()
        if kind == "space" or (text == "\\" and position == len(source)):
            continue
        if unicodedata.combining(source[position : position + 1] or " "):
            tokens, position = _unicode(source, start)
            yield from tokens
        elif kind == "command":
            tokens, position = _command(source, text[1:], start, position)
            yield from tokens
        elif kind == "escape":
            tokens, position = _escape(source, text[1], start, position)
            yield from tokens
        elif kind == "other":
            tokens, position = _unicode(source, start)
            yield from tokens
        elif kind == "number" and len(text) > MAX_DIGITS:
            raise Unreadable(start, f"a number of at most {MAX_DIGITS} digits", f"{len(text)} digits")
        else:
            yield Token("command" if kind == "dots" else kind, "dots" if kind == "dots" else text, start, position)


def _escape(source: str, sign: str, start: int, end: int) -> tuple[list[Token], int]:
    if sign in ",;:! >\n\t/":
        return [], end
    if sign in "{}":
        return [Token("delimiter", "\\" + sign, start, end)], end
    if sign == "|":
        return [Token("delimiter", "‖", start, end)], end
    if sign == "\\":
        distance = DISTANCE.match(source, end)
        return [Token("break", "\\\\", start, end)], distance.end() if distance else end
    if sign in "[]()":
        return [Token("sign", "$", start, end)], end
    raise Unreadable(start, "a formula", "a backslash before a sign that is no command")


def _command(source: str, name: str, start: int, end: int) -> tuple[list[Token], int]:
    """Return the tokens that a command stands for, and where reading goes on."""
    if name in DROPPED:
        return [], end
    if name in DROPPED_WITH_ARGUMENT:
        return [], _argument(source, end)[1]
    if name in WIDE:
        return [Token("wide", name, start, end)], end
    if name in TEXT or name in RAW:
        end = end + 1 if source[end : end + 1] == "*" else end
        text, end = _argument(source, end)
        return [Token("word" if name in TEXT else name, " ".join(text.split()), start, end)], end
    if name in ("begin", "end"):
        return _environment(source, name, start, end)
    if name == "operatorname" and source[end : end + 1] == "*":
        end += 1
    return [_named(name, start, end)], end


def _named(name: str, start: int, end: int) -> Token:
    if name in LETTERS:
        return Token("letter", name, start, end)
    if name in RELATIONS:
        return Token("relation", RELATIONS[name], start, end)
    if name in DELIMITERS:
        return Token("delimiter", DELIMITERS[name][0], start, end, DELIMITERS[name][1])
    return Token("command", name, start, end)


def _environment(source: str, command: str, start: int, end: int) -> tuple[list[Token], int]:
    text, end = _argument(source, end)
    name, columns = text.strip().rstrip("*"), ""
    if command == "begin":
        position = POSITION.match(source, end) if name in POSITIONED else None
        end = position.end() if position else end
        if name in ("array", "alignat", "alignedat"):
            columns, end = _argument(source, end)
    return [Token("begin" if command == "begin" else "finish", name, start, end, columns)], end


def _argument(source: str, position: int) -> tuple[str, int]:
    """Return the text between the braces that follow, and the column behind them."""
    found = GAP.match(source, position)
    start = found.end() if found else position
    if source[start : start + 1] != "{":
        got = source[start : start + 1]
        raise Unreadable(start, "an opening brace", got if got.isprintable() and got else "the end of the formula")
    depth = 0
    for i in range(start, len(source)):
        if source[i] in "{}" and source[i - 1] != "\\":
            depth += 1 if source[i] == "{" else -1
            if not depth:
                return source[start + 1 : i], i + 1
    raise Unreadable(start, "a closing brace to this opening brace", "the end of the formula")


# ------------------------------------------------------------------------------------------------ Unicode
def _unicode(source: str, start: int) -> tuple[list[Token], int]:
    """Read a character beyond ASCII, or a letter with the accents that combine with it."""
    char, end = source[start], start + 1
    while end < len(source) and end < start + 4 and unicodedata.combining(source[end]):
        end += 1
    if char.isascii() and end == start + 1:
        raise _meaningless(char, start)
    if char in INVISIBLE:
        return [], end
    if char in CHARACTERS and end == start + 1:
        return _from_latex(CHARACTERS[char], start, end), end
    kind = unicodedata.decomposition(char).split(" ")[0]
    if kind in ("<super>", "<sub>"):
        return _script(source, start, kind)
    plain = unicodedata.normalize("NFKD", char)
    if kind == "<font>" and plain.isascii() and "DOUBLE-STRUCK" in unicodedata.name(char, ""):
        plain = rf"\mathbb{{{plain}}}"
        return _from_latex(plain, start, end), end
    if kind in ("<font>", "<fraction>", "<compat>", "") or not kind.startswith("<"):
        return _from_latex(_plain(source[start:end], start), start, end), end
    raise _meaningless(char, start)


def _meaningless(char: str, start: int) -> Unreadable:
    shown = (
        f"{char} (U+{ord(char):04X})" if char.isprintable() and char.isascii() else f"the character U+{ord(char):04X}"
    )
    return Unreadable(start, "a formula", f"{shown}, which has no meaning in one")


def _plain(text: str, start: int) -> str:
    """Write a letter and its combining accents, or the plain form of a character, as LaTeX."""
    latex, plain = "", unicodedata.normalize("NFKD", text)
    for char in plain:
        if char in ACCENT_OF and latex:
            latex = rf"\{SPELLED_ACCENT.get(ACCENT_OF[char], ACCENT_OF[char])}{{{latex}}}"
        elif char == "⁄" and latex.isdigit():
            return rf"\frac{{{latex}}}{{{plain.split(char)[1]}}}"
        elif char.isascii() and char.isprintable():
            latex += char
        elif char in CHARACTERS:
            latex += CHARACTERS[char]
        else:
            raise _meaningless(char, start)
    return latex


def _script(source: str, start: int, kind: str) -> tuple[list[Token], int]:
    """Read a run of raised or lowered characters as one script."""
    end, text = start, ""
    while end < len(source) and unicodedata.decomposition(source[end]).startswith(kind):
        text += unicodedata.normalize("NFKD", source[end])
        end += 1
    return _from_latex(("^{" if kind == "<super>" else "_{") + text + "}", start, end), end


def _from_latex(latex: str, start: int, end: int) -> list[Token]:
    return [replace(t, start=start, end=end) for t in _raw(latex)]


# ------------------------------------------------------------------------------------------------ sizes of brackets
def sized(tokens: list[Token]) -> Iterator[Token]:
    r"""Join each size with its bracket: ``\left`` and ``(`` are one token."""
    rest = iter(tokens)
    for token in rest:
        if token.kind != "command" or token.text not in SIZES:
            yield token
            continue
        bracket = next(rest, Token("end", "", token.end, token.end))
        text = "null" if bracket.text == "." else bracket.text
        if bracket.kind != "delimiter" and text != "null":
            raise Unreadable(bracket.start, f"a bracket after \\{token.text}", bracket.shown())
        yield Token("delimiter", text, token.start, bracket.end, SIZES[token.text] or bracket.side)
