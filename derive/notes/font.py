"""The font of the notes: STIX Two Math, as ziamath ships it, cut down to what a page shows and embedded as woff2."""

from __future__ import annotations

from base64 import b64encode
from functools import cache
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any

from derive.errors import InputError

STRETCHY = "()[]{}|√∫ˆ˙¯˜̂̇̄̃"
FEATURES = ["ccmp", "kern", "ssty"]


def italic(char: str) -> str:
    """Return the mathematical italic that a browser shows for a single letter in ``mi``."""
    code = ord(char)
    if char == "h":
        return "ℎ"
    if "A" <= char <= "Z":
        return chr(0x1D434 + code - ord("A"))
    if "a" <= char <= "z":
        return chr(0x1D44E + code - ord("a"))
    if "Α" <= char <= "Ω":
        return chr(0x1D6E2 + code - ord("Α"))
    if "α" <= char <= "ω":
        return chr(0x1D6FC + code - ord("α"))
    return {"ϵ": "𝜖", "ϑ": "𝜗", "ϕ": "𝜙", "ϱ": "𝜚"}.get(char, char)


def embedded(text: str, letters: str, formulas: str | None = None) -> str:
    """Return a ``data:`` address of the font with the characters of a text, the italics of letters, and brackets.

    ``formulas`` are the characters that may stand in an index or exponent, beside the italics; None is all of them.
    Only those get the shapes for small sizes, which are half of the font.
    """
    italics = frozenset(map(italic, letters))
    characters = frozenset(text) | italics | frozenset(STRETCHY)
    small = characters if formulas is None else frozenset(formulas) | italics
    return "data:font/woff2;base64," + b64encode(_subset(characters, small)).decode("ascii")


@cache
def _subset(characters: frozenset[str], small: frozenset[str]) -> bytes:
    from fontTools.subset import Options, Subsetter
    from fontTools.ttLib import TTFont

    options = Options(flavor="woff2", layout_features=FEATURES, hinting=False, desubroutinize=True, notdef_outline=True)
    options.drop_tables += ["DSIG"]
    font = TTFont(font_file(), recalcTimestamp=False)
    _keep_small(font, small)
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=sorted(map(ord, characters)))
    subsetter.subset(font)
    font.flavor = "woff2"
    out = BytesIO()
    font.save(out)
    return out.getvalue()


def _keep_small(font: Any, characters: frozenset[str]) -> None:
    """Drop the shapes for indices and exponents (feature ssty) of all other characters."""
    kept = {glyph for code, glyph in font.getBestCmap().items() if chr(code) in characters}
    substitutions = font["GSUB"].table
    lookups = {
        i for f in substitutions.FeatureList.FeatureRecord if f.FeatureTag == "ssty" for i in f.Feature.LookupListIndex
    }
    for table in (t for i in lookups for t in substitutions.LookupList.Lookup[i].SubTable):
        shapes = getattr(table, "ExtSubTable", table).alternates
        for glyph in set(shapes) - kept:
            del shapes[glyph]


def font_file() -> Path:
    """Return the path of the font, without importing the package that ships it.

    Raises:
        InputError: ziamath is not installed.
    """
    spec = find_spec("ziamath")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        path = Path(folder) / "fonts" / "STIXTwoMath-Regular.ttf"
        if path.is_file():
            return path
    raise InputError(
        "mathematics font: expected STIX Two Math from the package ziamath, got none; install ziamath>=0.10"
    )
