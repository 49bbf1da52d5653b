"""Comments that steer the checker without showing: ``derive: theory=luenberger-dt, assume=R \\succ 0``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from derive.errors import InputError

__all__ = ["Order", "orders"]

WORDS = ("given", "claim", "skip", "scalar")
KEYS = ("theory", "assume", "notation")
EXPECTED = "theory=KEY, assume=FORMULA, notation=FILE, scalar, given, claim or skip"
ORDER = re.compile(r"""\s*(?P<key>[A-Za-z]+)\s*(?:=\s*(?P<value>"[^"]*"|[^\s,"]+|))?\s*(?P<stop>,|\s|$)""")


@dataclass(frozen=True)
class Order:
    """One order: its key and, if it has one, its value."""

    key: str
    value: str = ""


def orders(text: str) -> list[Order]:
    """Read the orders of a comment; ``assume=`` takes the rest of it unless its formula stands in double quotes.

    Raises:
        InputError: a word that is no order, or a value that is missing.
    """
    found: list[Order] = []
    position = 0
    while text[position:].strip(" \t\n,"):
        position += len(text[position:]) - len(text[position:].lstrip(" \t\n,"))
        assumed = re.match(r'assume\s*=\s*(?!")', text[position:])
        if assumed:
            return [*found, _order("assume", text[position + assumed.end() :].strip())]
        match = ORDER.match(text, position)
        if not match:
            raise InputError(f"derive: expected {EXPECTED}, got {text[position : position + 40].strip()!r}")
        found.append(_order(match["key"], match["value"]))
        position = match.end()
    if not found:
        raise InputError(f"derive: expected {EXPECTED}, got nothing")
    return found


def _order(key: str, value: str | None) -> Order:
    """Check one order."""
    if key in WORDS and value is None:
        return Order(key)
    if key in KEYS and value and value.strip('" '):
        return Order(key, value[1:-1].strip() if value.startswith('"') else value)
    got = key if value is None else f"{key}={value}"
    raise InputError(f"derive: expected {EXPECTED}, got {got!r}")
