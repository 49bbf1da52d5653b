"""The embedded font: every character that a page shows, and brackets that can still grow."""

from __future__ import annotations

import re
from base64 import b64decode
from io import BytesIO

import pytest
from fontTools.ttLib import TTFont

from derive.errors import InputError
from derive.latex import mathml
from derive.notes import font, page
from derive.notes.html import _characters, html
from derive.terms import Equation, Expect, Glyph, Symbol, block


def opened(address):
    return TTFont(BytesIO(b64decode(address.removeprefix("data:font/woff2;base64,"))))


def test_the_page_carries_every_character_of_its_mathematics():
    text = html(page(["observer"]))
    (address,) = re.findall(r"url\((data:[^)]*)\)", text)
    covered = opened(address).getBestCmap()
    for element in re.findall(r"<math>.*?</math>", text):
        for single in re.findall(r"<mi>(.)</mi>", element):
            assert ord(font.italic(single)) in covered, single
        assert {ord(c) for c in re.sub(r"<[^>]*>", "", element)} <= set(covered)


def test_brackets_still_grow():
    found = opened(font.embedded("", "A"))
    variants = found["MATH"].table.MathVariants
    vertical = dict(zip(variants.VertGlyphCoverage.glyphs, variants.VertGlyphConstruction, strict=True))
    cmap = found.getBestCmap()
    for bracket in "()[]":
        construction = vertical[cmap[ord(bracket)]]
        assert len(construction.MathGlyphVariantRecord) > 3
        assert construction.GlyphAssembly is not None
    assert len(vertical[cmap[ord("∫")]].MathGlyphVariantRecord) > 1


def test_a_letter_that_is_not_shown_is_not_carried():
    assert ord("𝑍") not in opened(font.embedded("A", "A")).getBestCmap()
    assert ord("𝐴") in opened(font.embedded("", "A")).getBestCmap()
    assert ord("ℎ") in opened(font.embedded("", "h")).getBestCmap()


def test_small_shapes_are_for_what_may_be_small():
    def small(found):
        substitutions = found["GSUB"].table
        (feature,) = [f.Feature for f in substitutions.FeatureList.FeatureRecord if f.FeatureTag == "ssty"]
        tables = [t for i in feature.LookupListIndex for t in substitutions.LookupList.Lookup[i].SubTable]
        names = {glyph for t in tables for glyph in getattr(t, "ExtSubTable", t).alternates}
        return "".join(sorted(chr(code) for code, glyph in found.getBestCmap().items() if glyph in names))

    assert set("word12𝐴") & set(small(opened(font.embedded("word 12", "A", "1")))) == set("1𝐴")
    assert set("12dorw𝐴") <= set(small(opened(font.embedded("word 12", "A"))))
    bracket = '<p>Text</p><math><mi mathvariant="normal">d</mi><msub><mi>x</mi><mn>0</mn></msub></math>'
    assert _characters(bracket) == ("Textdx0", "x", "d0")


def test_the_same_page_gives_the_same_bytes():
    x = Symbol("x", "n", "1", Glyph("x"))
    shown = mathml(Equation(x, "=", Expect(block([[x], [x]]))))
    font._subset.cache_clear()
    first = font.embedded(shown, "x")
    font._subset.cache_clear()
    assert font.embedded(shown, "x") == first


def test_without_the_font_there_is_one_clear_line(monkeypatch):
    monkeypatch.setattr(font, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"expected STIX Two Math from the package ziamath, got none; install ziamath"):
        font.font_file()
