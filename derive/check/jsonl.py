"""Claims in JSON lines: {"id": ..., "theory": ..., "latex": ..., "assume": [...], "scalar": false}."""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from derive.check.files import parse_json
from derive.check.item import Item, Setting
from derive.claim import Claim
from derive.errors import InputError

__all__ = ["claims_of_lines"]

KINDS = {"id": str, "theory": str, "latex": str, "name": str, "scalar": bool, "assume": list}


def claims_of_lines(text: str, file: str, setting: Setting) -> list[Item]:
    """Return the claims of a text, one a line; a line that holds none is a claim with a message."""
    items: list[Item] = []
    for line, raw in enumerate(text.split("\n"), 1):
        if raw.strip():
            name = f"u{len(items) + 1}"
            try:
                items.append(_item(raw, file, line, name, setting))
            except InputError as error:
                items.append(Item(Claim("", id=name, file=file, line=line), setting, True, str(error)))
    return items


def _item(raw: str, file: str, line: int, name: str, setting: Setting) -> Item:
    data = parse_json(raw, "line")
    if not isinstance(data, dict) or "latex" not in data:
        raise InputError('line: expected an object with "latex", got none')
    for key, value in data.items():
        _check(key, value)
    s = replace(
        setting, theory=data.get("theory") or setting.theory, scalar=setting.scalar or data.get("scalar", False)
    )
    for latex in data.get("assume", []):
        s = s.assuming(latex, f"line {line}")
    claim = Claim(data["latex"], s.theory, s.assume, s.scalar, data.get("id") or name, file, line, data.get("name", ""))
    return Item(claim, s, True)


def _check(key: str, value: Any) -> None:
    """Check one entry; unknown keys are passed over unless they look like a slip of the pen."""
    if key not in KINDS:
        close = get_close_matches(key.lower(), KINDS, 1, 0.75)
        if close:
            raise InputError(f"{key}: unknown key; is {close[0]} meant?")
    elif not isinstance(value, KINDS[key]):
        raise InputError(f"{key}: expected {_spoken(key)}, got {str(value)[:60]!r}")
    elif key == "assume" and not all(isinstance(latex, str) for latex in value):
        raise InputError("assume: expected a list of formulas, got other entries")


def _spoken(key: str) -> str:
    return {bool: "true or false", list: "a list of formulas"}.get(KINDS[key], "a text")
