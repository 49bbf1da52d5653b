"""A long document on several pages: nothing is lost, and every link leads to where its anchor is."""

from __future__ import annotations

import re

import pytest

from derive.notes.html import block, html
from derive.notes.markdown import markdown
from derive.notes.model import Section, document_of
from derive.notes.parts import anchors, parts
from derive.theory import lecture


@pytest.fixture(scope="module")
def document():
    return document_of(lecture("luenberger"), lecture("luenberger").verify())


def test_a_short_document_stays_one_page(document):
    assert parts(document, "luenberger") == {"luenberger": document}


def test_pages_are_cut_before_sections_and_stay_small(document):
    pages = parts(document, "l", limit=60_000)
    assert list(pages) == ["l", *(f"l-{i}" for i in range(2, len(pages) + 1))]
    assert len(pages) > 2
    for page in pages.values():
        size = sum(len(block(b).encode()) for b in page.blocks)
        assert size < 62_000 or sum(isinstance(b, Section) and b.level == 2 for b in page.blocks) == 1
        assert isinstance(page.blocks[0], Section)
        assert (page.proved, page.total) == (document.proved, document.total)
    assert [a for page in pages.values() for a in anchors(page.blocks)] == list(anchors(document.blocks))
    assert [b for page in pages.values() for b in page.blocks if isinstance(b, Section)] == [
        b for b in document.blocks if isinstance(b, Section)
    ]


@pytest.mark.parametrize(("write", "suffix"), [(html, ".html"), (markdown, ".md")])
def test_links_lead_from_page_to_page(document, write, suffix):
    pages = parts(document, "l", limit=60_000)
    texts = {name + suffix: write(page) for name, page in pages.items()}
    places = {name: set(re.findall(r' id="([^"]+)"', text)) for name, text in texts.items()}
    crossing = 0
    for name, text in texts.items():
        for file, anchor in re.findall(r'(?:href="|\]\()([\w.-]*)#([^"()]+)', text):
            assert anchor in places[file or name], (name, file, anchor)
            crossing += bool(file)
        for other in texts:
            assert other in text
    assert crossing > 10


def test_every_anchor_of_a_page_is_known(document):
    shown = re.findall(r' id="([^"]+)"', "".join(map(block, document.blocks)))
    assert list(anchors(document.blocks)) == shown


def test_the_whole_document_is_still_one_page_elsewhere(document):
    assert document.title in html(document)
    assert "Part 2" not in html(document)
