"""Documents as text: regular files of bounded size in UTF-8, JSON without surprises."""

from __future__ import annotations

import json
import stat
from pathlib import Path
from typing import Any

from derive.errors import InputError
from derive.files import read_limited

__all__ = ["LIMIT", "decoded", "lines_checked", "parse_json", "read_text", "regular"]

LIMIT = 32 * 2**20  # bytes of a document
LONGEST_LINE = 2**18  # characters


def regular(path: Path) -> None:
    """Check that a path leads to a file.

    Raises:
        InputError: it does not exist, leads nowhere, or is a folder or device.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"{_short(path)}: cannot be read: {reason}; check the path") from None
    if stat.S_ISDIR(mode):
        raise InputError(f"{path}: expected a file, got a folder; name the files in it")
    if not stat.S_ISREG(mode):
        raise InputError(f"{path}: expected a file, got a pipe or device; use - for standard input")


def read_text(path: Path) -> str:
    """Read a document.

    Raises:
        InputError: no regular file, too large, not UTF-8.
    """
    regular(path)
    return _plain(read_limited(path, LIMIT))


def decoded(data: bytes, name: str) -> str:
    """Return what was read from standard input as text.

    Raises:
        InputError: too large, not UTF-8.
    """
    if len(data) > LIMIT:
        raise InputError(f"{name}: expected at most {LIMIT // 2**20} MB, got more; split it")
    try:
        return _plain(data.decode())
    except UnicodeDecodeError:
        raise InputError(f"{name}: expected text in UTF-8, got other bytes") from None


def _plain(text: str) -> str:
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def lines_checked(text: str, name: str) -> str:
    """Return a text whose lines all have a length that a person could have written.

    Raises:
        InputError: a line is too long.
    """
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > LONGEST_LINE:
            raise InputError(f"{name}:{number}: expected at most {LONGEST_LINE} characters a line, got {len(line)}")
    return text


def parse_json(text: str, where: str) -> Any:
    """Parse JSON as the standard has it.

    Raises:
        InputError: not JSON, NaN or an infinity, a key given twice, a number of thousands of digits, nested too deeply.
    """
    try:
        return json.loads(text, object_pairs_hook=_unique, parse_constant=_no_number)
    except RecursionError:
        raise InputError(f"{where}: expected JSON, got one that is nested too deeply") from None
    except ValueError as error:
        raise InputError(f"{where}: expected JSON, got an error: {str(error)[:200]}") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key is given twice in one object")
    return found


def _no_number(name: str) -> Any:
    raise ValueError(f"{name} is not a number")


def _short(path: Path) -> str:
    return str(path) if len(str(path)) < 200 else f"{str(path)[:100]}..."
