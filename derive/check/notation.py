"""Which letter plays which role, and macros: in the front matter of a document, or in a TOML file that it names."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from derive.check.files import regular
from derive.check.item import Macro, Setting
from derive.errors import InputError
from derive.files import read_limited

__all__ = ["notation_file", "with_front_matter"]

LIMIT = 2**20  # bytes of a notation file
KEYS = ("theory", "assume", "given", "scalar", "notation", "macros")


def notation_file(path: Path) -> tuple[dict[str, str], dict[str, Macro]]:
    r"""Read a notation file: tables ``[notation]``, F = "A", and ``[macros]``, T = "^{\\top}".

    Raises:
        InputError: no such file, no TOML, or other keys.
    """
    regular(path)
    try:
        data = tomllib.loads(read_limited(path, LIMIT))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: expected TOML with [notation] and [macros], got an error: {error}") from None
    unknown = sorted(set(data) - {"notation", "macros"})
    if unknown:
        raise InputError(f"{path}: expected the tables notation and macros, got {unknown[0]!r}")
    return _letters(data.get("notation", {}), str(path)), _macros(data.get("macros", {}), str(path))


def with_front_matter(setting: Setting, data: Mapping[str, Any], folder: Path) -> Setting:
    """Return a setting with what the head of a document says.

    Raises:
        InputError: an unknown key, or a value of another kind than it has.
    """
    setting = replace(setting, macros={**setting.macros, **_macros(data.get("math", {}), "math")})
    own = data.get("derive") or {}
    if not isinstance(own, dict):
        raise InputError(f"derive: expected {', '.join(KEYS)} below it, got {own!r}")
    unknown = sorted(set(own) - set(KEYS))
    if unknown:
        raise InputError(f"derive: expected {', '.join(KEYS)}, got {unknown[0]!r}")
    setting = replace(
        setting,
        theory=_a_text(own.get("theory", ""), "theory") or setting.theory,
        scalar=setting.scalar or _a_text(own.get("scalar", ""), "scalar") == "true",
        macros={**setting.macros, **_macros(own.get("macros", {}), "macros")},
    )
    for key in ("assume", "given"):
        for latex in _texts(own.get(key, []), key):
            setting = setting.assuming(latex, "the front matter")
    return _with_notation(setting, own.get("notation", {}), folder)


def _with_notation(setting: Setting, notation: Any, folder: Path) -> Setting:
    if isinstance(notation, str) and notation:
        letters, macros = notation_file(folder / notation)
    else:
        letters, macros = _letters(notation or {}, "notation"), {}
    return replace(setting, notation={**setting.notation, **letters}, macros={**setting.macros, **macros})


def _letters(table: Any, where: str) -> dict[str, str]:
    """Check a table of letters."""
    if not isinstance(table, dict) or not all(isinstance(v, str) and v for v in table.values()):
        raise InputError(f'{where}: expected letters of the theory by letter of the document, as in F = "A"')
    return {name.replace("\\", ""): letter.replace("\\", "") for name, letter in table.items()}


def _macros(table_: Any, where: str) -> dict[str, Macro]:
    """Check a table of macros."""
    from derive.latex.macros import table

    if not isinstance(table_, dict):
        raise InputError(f"{where}: expected macros by name, got {table_!r}")
    return table(table_) if table_ else {}


def _a_text(value: Any, key: str) -> str:
    if not isinstance(value, str):
        raise InputError(f"{key}: expected a text, got {value!r}")
    return value


def _texts(value: Any, key: str) -> list[str]:
    values = value if isinstance(value, list) else [value] if value else []
    return [_a_text(v, key) for v in values]
