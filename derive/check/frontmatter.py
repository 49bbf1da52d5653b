"""Settings at the head of a Markdown file: a strict subset of YAML, read for the keys ``derive`` and ``math`` alone.

Mappings by indentation, lists (``- a`` or ``[a, b]``), texts plain or in quotes. Anchors, tags, block texts
and the like are refused inside these keys; other keys may hold anything and are passed over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise

from derive.errors import InputError

__all__ = ["Node", "split_front_matter", "yaml_subset"]

Node = str | list["Node"] | dict[str, "Node"]

HEAD = re.compile(r"---[ \t]*\n(?P<body>(?:[^\n]*\n){0,200000}?)(?:---|\.\.\.)[ \t]*(?:\n|\Z)")
TOP = re.compile(r"(?P<key>[\w\-]+)[ \t]*:(?=[ \t\n]|\Z)")
KEY = re.compile(r"""(?P<key>"(?:[^"\\]|\\.)*"|'(?:[^']|'')*'|[^\s"'#&*!|>%@`\[\]{},:][^:#]*?)[ \t]*:(?:[ \t]+|$)""")
QUOTED = re.compile(r'"(?:[^"\\]|\\.)*"|\'(?:[^\']|\'\')*\'')
ESCAPE = re.compile(r"\\(.)")
ESCAPES = {"n": "\n", "t": "\t", '"': '"', "\\": "\\", "/": "/"}
DEPTH = 8
LIMIT = 2**16  # characters under a key of ours


@dataclass(frozen=True)
class Line:
    """A line that says something: its number in the file, its indentation, and its text."""

    number: int
    indent: int
    text: str


def split_front_matter(text: str) -> tuple[dict[str, Node], int]:
    """Return the settings at the head of a text, and where its body begins.

    Raises:
        InputError: a key of ours holds what is not in the subset; the message names the line.
    """
    head = HEAD.match(text)
    if not head:
        return {}, 0
    found: dict[str, Node] = {}
    lines = head["body"].split("\n")
    starts = [i for i, line in enumerate(lines) if TOP.match(line)]
    for start, stop in pairwise([*starts, len(lines)]):
        key = TOP.match(lines[start])
        if key and key["key"] in ("derive", "math"):
            value = yaml_subset("\n".join(lines[start:stop]), start + 2)
            found |= value if isinstance(value, dict) else {}
    return found, head.end()


def yaml_subset(text: str, first: int = 1) -> Node:
    """Read the subset of YAML; ``first`` is the number of the text's first line.

    Raises:
        InputError: what is not in the subset, with its line.
    """
    if len(text) > LIMIT:
        raise InputError(f"line {first}: expected at most {LIMIT} characters of settings, got {len(text)}")
    lines = [
        Line(first + i, len(raw) - len(raw.lstrip(" ")), raw.strip())
        for i, raw in enumerate(text.split("\n"))
        if raw.strip() and not raw.lstrip().startswith("#")
    ]
    node, rest = _block(lines, 0) if lines else ({}, [])
    if rest:
        raise _refused(rest[0], "the indentation of the lines above")
    return node


def _refused(line: Line, expected: str) -> InputError:
    return InputError(f"line {line.number}: expected {expected}, got {line.text[:60]!r}")


def _block(lines: list[Line], depth: int) -> tuple[Node, list[Line]]:
    """Read a mapping or a list of the first line's indentation; return it and the lines that are left."""
    if depth > DEPTH:
        raise _refused(lines[0], f"at most {DEPTH} levels")
    items = _list if lines[0].text.startswith("- ") else _mapping
    return items(lines, lines[0].indent, depth)


def _mapping(lines: list[Line], indent: int, depth: int) -> tuple[Node, list[Line]]:
    found: dict[str, Node] = {}
    while lines and lines[0].indent == indent and not lines[0].text.startswith("- "):
        line = lines[0]
        key = KEY.match(line.text)
        if not key:
            raise _refused(line, "key: value")
        name, rest = str(_text(key["key"], line)), line.text[key.end() :]
        if name in found:
            raise _refused(line, "each key once")
        found[name], lines = _value(rest, line, lines[1:], depth)
    return found, lines


def _list(lines: list[Line], indent: int, depth: int) -> tuple[Node, list[Line]]:
    found: list[Node] = []
    while lines and lines[0].indent == indent and lines[0].text.startswith("- "):
        found.append(_scalar(lines[0].text[2:].strip(), lines[0]))
        lines = lines[1:]
    return found, lines


def _value(rest: str, line: Line, lines: list[Line], depth: int) -> tuple[Node, list[Line]]:
    """Read what follows a key: on its line, or on the lines below that are indented more (lists may stand level)."""
    if rest and not rest.startswith("#"):
        return _scalar(rest, line), lines
    deeper = lines and (lines[0].indent > line.indent or (lines[0].indent == line.indent and lines[0].text[:2] == "- "))
    return _block(lines, depth + 1) if deeper else ("", lines)


def _scalar(text: str, line: Line) -> Node:
    """Read a text or a list on one line."""
    if not text.startswith("["):
        return _text(text, line)
    inside = re.fullmatch(r"\[(.*)\][ \t]*(?:#.*)?", text)
    if not inside:
        raise _refused(line, "a list [a, b] on one line")
    pieces = re.findall(r'\s*("(?:[^"\\]|\\.)*"|\'(?:[^\']|\'\')*\'|[^,"\']+)\s*(?:,|$)', inside[1])
    return [_text(piece.strip(), line) for piece in pieces if piece.strip()]


def _text(text: str, line: Line) -> str:
    """Read a text, plain or in quotes; a comment behind it is dropped."""
    quoted = QUOTED.match(text)
    if quoted and re.fullmatch(r"[ \t]*(?:#.*)?", text[quoted.end() :]):
        inner = quoted[0][1:-1]
        if quoted[0][0] == "'":
            return inner.replace("''", "'")
        return ESCAPE.sub(lambda m: ESCAPES.get(m[1]) or _unknown(m[0], line), inner)
    if not text or text[0] in "\"'&*!|>%@`{":
        raise _refused(line, "a text, in quotes if it begins with a sign")
    return re.sub(r"[ \t]#.*", "", text).strip()


def _unknown(escape: str, line: Line) -> str:
    raise InputError(f"line {line.number}: expected \\\\ for a backslash in double quotes, got {escape!r}")
