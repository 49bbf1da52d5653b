"""Notes: self-contained pages whose badges come from the replay."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

import derive
from derive.derivation import Erratum, Given, Outcome, Paragraph
from derive.errors import InputError
from derive.notes import page, write_notes
from derive.notes.html import html
from derive.notes.markdown import markdown
from derive.notes.model import Display, Document, Note, document_of
from derive.terms import Equation, Glyph, Symbol
from derive.theory import LECTURES, OWN_PAGE, lecture

SHORT = [key for key in LECTURES if key not in OWN_PAGE]


@pytest.fixture(scope="module")
def all_notes() -> Document:
    return page(SHORT)


@pytest.fixture(scope="module")
def whole_page(all_notes) -> str:
    return html(all_notes)


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.seen, self.open = [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        if tag not in ("meta", "br", "mspace", "link", "img"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_whole_and_asks_for_nothing(whole_page):
    tags = Tags()
    tags.feed(whole_page)
    assert tags.open == []
    names = {tag for tag, _ in tags.seen}
    assert not names & {"script", "link", "img", "iframe", "object"}
    addresses = [
        v for _, attrs in tags.seen for k, v in attrs.items() if k in ("src", "href") and not v.startswith("#")
    ]
    assert addresses == []
    assert set(re.findall(r"url\((\w+):", whole_page)) == {"data"}
    assert "@import" not in whole_page


def test_every_link_leads_to_a_row(whole_page):
    ids = re.findall(r' id="([^"]+)"', whole_page)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]+)"', whole_page)) <= set(ids)


def test_what_is_displayed_again_has_an_anchor_of_its_own():
    item = lecture("luenberger")
    first = next(i for i in item.items if isinstance(i, Given))
    blocks = document_of(replace(item, items=(first, *item.items)), []).blocks
    ids = [row.id for block in blocks if isinstance(block, Display) for row in block.rows]
    assert len(ids) == len(set(ids))
    assert [name for name in ids if name.endswith("-2")] == [f"{name}-2" for name in ids[: len(first.rows)]]


def test_a_page_of_one_lecture_has_its_title_once(whole_page):
    text = html(page(["observer"]))
    assert text.count("The Kalman filter as an observer") == 2  # title of the window, heading
    assert '<ol class="sections"><li><a href="#observer-Plant-and-observer">' in text
    assert whole_page.count(">The Kalman filter as an observer<") == 2  # contents, heading


def test_the_page_is_small_enough(whole_page):
    assert len(whole_page.encode()) <= 600_000


def test_all_steps_are_proved(all_notes):
    assert all_notes.proved == all_notes.total > 200


def test_a_step_that_is_not_accepted_is_not_shown_as_proved():
    item = lecture("observer")
    outcomes = item.verify()
    broken = [replace(o, accepted=False, message="no") if o.step == "observer.4" else o for o in outcomes]
    document = document_of(item, broken)
    rows = [r for b in document.blocks if isinstance(b, Display) for r in b.rows if r.badge in ("proved", "not proved")]
    assert [r.id for r in rows if r.badge == "not proved"] == ["observer-observer.4"]
    assert document.proved == document.total - 1
    for text in (html(document), markdown(document)):
        assert "not proved" in text
        assert re.search(r"(<b>|\*\*)no(</b>|\*\*)", text)


def test_without_outcomes_nothing_is_proved():
    document = document_of(lecture("observer"), [])
    badges = {r.badge for b in document.blocks if isinstance(b, Display) for r in b.rows}
    assert "proved" not in badges
    assert all(note.proof is None and note.true is None for note in document.blocks if isinstance(note, Note))
    assert "proved here" not in html(document)


def test_a_chain_that_is_rejected_takes_its_last_row_with_it():
    item = lecture("observer")
    closed = [Outcome(o.step, o.step != "error dynamics") for o in item.verify()]
    rows = {r.id: r.badge for b in document_of(item, closed).blocks if isinstance(b, Display) for r in b.rows}
    assert rows["observer-observer.6"] == "not proved"


def test_every_derived_row_names_its_rule_and_what_it_rests_on(all_notes):
    page = html(all_notes)
    why = re.findall(r'<div class="why">.*?</div>', page)
    derived = [w for w in why if "badge proved" in w]
    assert len(derived) > 200
    assert all(re.search(r'class="uses">[a-z]', w) for w in derived)
    assert "sum of squares, from" in page
    assert "· sum of squares, from" in markdown(all_notes)


def test_a_finding_without_evidence_is_not_called_refuted():
    item = lecture("luenberger")
    bare = replace(item, items=tuple(replace(e, evidence=()) if isinstance(e, Erratum) else e for e in item.items))
    notes = [b for b in document_of(item, item.verify()).blocks if isinstance(b, Note)]
    assert "refuted" in {n.badge for n in notes}
    assert {b.badge for b in document_of(bare, []).blocks if isinstance(b, Note)} == {"incomplete"}


def test_a_wide_formula_wraps_and_a_comma_stays_with_its_formula():
    P, A = (Symbol(name, "n", "n", Glyph(name)) for name in "PA")
    wide = Equation(P, "=", A * P * A.T + (A - P) * P * (A - P).T + (P - A) * A * (P - A).T)
    document = document_of(replace(lecture("observer"), items=(Paragraph((wide, ", where ", P, ".")),)), [])
    (text,) = re.findall("<p>(.*?)</p>", html(document))
    assert text.count("<math>") == 5
    assert text.count('<math><mo form="infix">') == 3
    assert re.findall(r"<i>.*?<math>((?:(?!<math>).)*)</math>(.)</i>", text)[-1] == ("<mi>P</mi>", ".")


def test_each_lecture_names_its_sources(all_notes):
    assert html(all_notes).count("<p>Source: ") == markdown(all_notes).count("Source: ") == len(SHORT)


def test_text_is_escaped():
    item = lecture("observer")
    nasty = replace(item, title="<script>&", items=(Paragraph(("a < b & $c$ *d* <img src=x>",)),))
    document = document_of(nasty, [])
    assert "<script>" not in html(document)
    assert "<img" not in html(document)
    assert r"\<img" in markdown(document)
    assert r"\$c\$" in markdown(document)


def test_markdown_shows_numbers_reasons_and_badges():
    text = markdown(page(["observer"]))
    assert r"\qquad\text{(31.10)}" in text
    assert "✓ *proved* insert both outputs and collect" in text
    assert text.count("$$") % 2 == 0
    assert text.count(r"\begin{aligned}") == text.count(r"\end{aligned}") > 10


def test_mathematics_survives_the_reader_of_markdown(all_notes):
    """Outside protected spans no backslash escapes a sign but at the end of a line, and no star could be emphasis."""
    text = re.sub(r"\$`.*?`\$", "", markdown(all_notes))
    formulas = re.findall(r"\$\$(.*?)\$\$", text, re.DOTALL) + re.findall(r"(?<!\$)\$([^$\n]+)\$(?!\$)", text)
    assert len(formulas) > 500
    for formula in formulas:
        assert not re.search(r"\\[^A-Za-z]", formula.replace("\\\\\n", "")), formula
        assert "*" not in formula


@pytest.mark.parametrize("name", ["o.html", "o.md", "o.json"])
def test_notes_are_written_by_suffix(tmp_path, name):
    write_notes(["observer"], tmp_path / name)
    text = (tmp_path / name).read_text(encoding="utf-8")
    assert [p.name for p in tmp_path.iterdir()] == [name]
    if name.endswith("json"):
        assert json.loads(text)["schema"] == "derive-derivation/1"
    else:
        assert "31.10" in text


def test_an_unknown_suffix_is_one_clear_line(tmp_path):
    with pytest.raises(InputError, match=r"expected a suffix .md, .html, .json, got '.odt'"):
        write_notes(["observer"], tmp_path / "o.odt")
    with pytest.raises(InputError, match=r"lecture 'obs': unknown"):
        derive.notes.write_notes(["obs"], tmp_path / "o.md")
    assert list(tmp_path.iterdir()) == []
