"""Formulas of Jupyter notebooks: the Markdown cells, with the lines of the file in which they stand."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from derive.check.files import parse_json
from derive.check.formula import Event
from derive.check.markdown import scan_markdown
from derive.errors import InputError

__all__ = ["Cell", "cells", "events_of"]

STRING = re.compile(r'"((?:[^"\\]|\\.)*+)"', re.DOTALL)
EXPECTED = "expected a notebook with a list of cells (version 4)"


@dataclass(frozen=True)
class Cell:
    """A cell: its number from 1, its kind, its text, and the line of the file in which each of its lines stands."""

    number: int
    kind: str
    text: str
    lines: tuple[int, ...]


def cells(text: str, name: str) -> Iterator[Cell]:
    """Iterate over the cells of a notebook.

    Raises:
        InputError: not JSON, or no notebook.
    """
    data = parse_json(_numbered(text), name)
    found = _get(data, "cells")
    if not isinstance(found, list):
        raise InputError(f"{name}: {EXPECTED}")
    for number, cell in enumerate(found, 1):
        if not isinstance(cell, dict):
            raise InputError(f"{name}: {EXPECTED}; cell {number} is none")
        kind, source = _get(cell, "cell_type"), _get(cell, "source")
        pieces = source if isinstance(source, list) else [source]
        if not isinstance(kind, str) or not all(isinstance(p, str) for p in pieces):
            raise InputError(f"{name}: expected cell_type and source in cell {number}, got something else")
        yield _cell(number, kind.partition(":")[2], pieces)


def events_of(cell: Cell) -> list[Event]:
    """Return what a cell holds, with the lines of the file."""
    return [replace(event, line=cell.lines[min(event.line, len(cell.lines)) - 1]) for event in scan_markdown(cell.text)]


def _numbered(text: str) -> str:
    """Put before each text in JSON the line in which it stands: "source" in line 7 becomes "7:source"."""
    line, position, pieces = 1, 0, list[str]()
    for match in STRING.finditer(text):
        line += text.count("\n", position, match.start())
        pieces += [text[position : match.start()], f'"{line}:{match[1]}"']
        position = match.end()
    return "".join([*pieces, text[position:]])


def _get(data: Any, key: str) -> Any:
    """Return what a key with a line before it stands for."""
    if not isinstance(data, dict):
        return None
    return next((value for name, value in data.items() if name.partition(":")[2] == key), None)


def _cell(number: int, kind: str, pieces: list[str]) -> Cell:
    texts, lines = list[str](), list[int]()
    for piece in pieces:
        line, _, text = piece.partition(":")
        texts.append(text)
        lines += [int(line)] * (text.count("\n") if text.endswith("\n") else text.count("\n") + 1)
    return Cell(number, kind, "".join(texts), tuple(lines) or (1,))
