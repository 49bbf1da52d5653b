"""The tour: what it writes, that its badges come from the replay, and that nothing leaves its folder."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from derive import tour, worked
from derive.errors import InputError
from derive.latex import plain
from derive.notes.model import Display, Figure, Link, Note, Para, Section, Table
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.replay import verify_file
from derive.theory import LECTURES, OWN_PAGE, lecture
from lmi.validation import validate

APART = [key for key in LECTURES if key in OWN_PAGE]
LIMIT = 600_000  # bytes of a page


@pytest.fixture(scope="module")
def validation():
    return validate(example_plant()).as_dict()


@pytest.fixture(scope="module")
def written(validation, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tour")
    stages = []
    summary = tour.write_tour(folder, example_plant(), lambda _: validation, progress=stages.append)
    return folder, summary, stages


class Page(HTMLParser):
    """Collects the tags of a page, its addresses and its anchors."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.addresses, self.anchors = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("href", "src", "srcset", "action", "data", "poster", "xlink:href"):
                self.addresses.append(value)
            if name == "id":
                self.anchors.add(value)


def test_it_writes_what_the_contract_says(written):
    folder, summary, stages = written
    assert sorted(p.name for p in (folder / "certificates").iterdir()) == sorted(f"{key}.json" for key in LECTURES)
    apart = [name for c in summary.chapters for name in c.pages]
    pages = [f"{key}.{suffix}" for key in ("index", *apart) for suffix in ("html", "md")]
    assert sorted(p.name for p in folder.iterdir()) == sorted(["certificates", "figures", "sliders.html", *pages])
    assert summary.expected
    assert len(stages) == len(LECTURES) + 2


def test_the_certificates_replay(written):
    folder, *_ = written
    for key in LECTURES:
        (report,) = verify_file(folder / "certificates" / f"{key}.json")
        assert report.accepted
        assert report.total == len(lecture(key).steps)


def test_a_page_is_self_contained_and_small(written):
    folder, *_ = written
    for path in folder.glob("*.html"):
        text = path.read_text(encoding="utf-8")
        tags = Page(text).tags
        assert not {"link", "iframe", "object", "embed", "img", "base"} & set(tags)
        assert tags.count("script") == (path.stem == "sliders")
        names = re.findall(r' id="([^"]+)"', text)
        assert len(names) == len(set(names))
        assert not re.search(r"url\((?!data:|#|\"?#)|@import", text)
        assert len(text.encode()) < LIMIT, path.name
        assert tags.count("math") > 20


def test_every_link_of_every_page_leads_somewhere(written):
    folder, *_ = written
    pages = {p.name: Page(p.read_text(encoding="utf-8")) for p in folder.glob("*.html")}
    for name, page in pages.items():
        for address in page.addresses:
            file, _, anchor = address.partition("#")
            assert (folder / (file or name)).is_file(), address
            assert not anchor or anchor in pages[file or name].anchors, address
    for key in APART:
        assert f"{key}.html" in pages["index.html"].addresses
    assert all("index.html" in page.addresses for name, page in pages.items() if name != "index.html")
    assert "sliders.html" in pages["index.html"].addresses


def test_links_of_markdown_lead_to_markdown(written):
    folder, *_ = written
    anchors = {p.name: set(re.findall(r'<a id="([^"]+)">', p.read_text(encoding="utf-8"))) for p in folder.glob("*.md")}
    for name in anchors:
        text = re.sub(r"\$`.*?`\$", "", (folder / name).read_text(encoding="utf-8"))
        for file, anchor in re.findall(r"\]\(([^()#\s]*)#?([^()\s]*)\)", text):
            assert (folder / (file or name)).is_file(), (name, file)
            assert not anchor or anchor in anchors[file or name], (name, file, anchor)
        assert name == "index.md" or "](index.md)" in text


def test_the_same_outline_is_drawn_from_one_definition(written):
    """Drawings of one page share the outlines of letters; an anchor stands once."""
    folder, *_ = written
    text = (folder / "index.html").read_text(encoding="utf-8")
    names = re.findall(r' id="([^"]+)"', text)
    assert len(names) == len(set(names))
    assert set(re.findall(r'xlink:href="#([^"]+)"', text)) <= set(names)
    assert text.count("<use ") > 100


def test_lectures_findings_and_example_are_on_both_pages(written):
    folder, *_ = written
    for suffix in ("html", "md"):
        text = (folder / f"index.{suffix}").read_text(encoding="utf-8")
        titles = (*(lecture(key).title for key in LECTURES), "Findings on the", "Worked example")
        places = [re.search(rf"(<h2[^>]*>|^## ){re.escape(t)}", text, re.MULTILINE).start() for t in titles]
        assert places == sorted(places)
        assert example_plant().source.split(",")[0] in text
        for route in ("riccati", "lmi-primal", "lmi-dual", "lmi-h2", "nlp", "integral"):
            assert route in text
        for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text):
            assert (folder / target).read_text(encoding="utf-8").startswith("<svg")
        for key in APART:
            count = f"{len(lecture(key).steps)} of {len(lecture(key).steps)} steps proved and replayed"
            assert count in text
            assert count in (folder / f"{key}.{suffix}").read_text(encoding="utf-8")


def test_a_finding_leads_to_the_page_that_explains_it(tmp_path, monkeypatch):
    """A lecture that moves to a page of its own takes its findings with it; the table stays whole and finds them."""
    monkeypatch.setattr(tour, "OWN_PAGE", {"luenberger"})
    monkeypatch.setattr(tour, "LECTURES", {key: LECTURES[key] for key in ("observer", "luenberger")})
    chapters = tour.write_certificates(tmp_path)
    page = tour.bind(chapters, [])
    (table,) = [b for b in page.blocks if isinstance(b, Table) and b.head[0] == "source"]
    links = [cell for row in table.rows for cell in row[-1] if isinstance(cell, Link)]
    assert len(links) == sum(len(lecture(key).errata) for key in ("observer", "luenberger"))
    for place, source in (("", page), *chapters[1].pages.items()):
        notes = {block.id for block in source.blocks if isinstance(block, Note)}
        assert {link.target for link in links if link.page == place} == notes != set()
    assert {link.address(".html").partition("#")[0] for link in links} == {"", "luenberger.html"}
    assert (page.proved, page.total) == tuple(sum(getattr(c.report, k) for c in chapters) for k in ("proved", "total"))


def test_the_same_input_gives_the_same_files(written, validation, tmp_path):
    folder, *_ = written
    tour.write_tour(tmp_path, example_plant(), lambda _: validation)
    for path in folder.rglob("*.*"):
        assert path.read_bytes() == (tmp_path / path.relative_to(folder)).read_bytes()


def test_the_summary_fits_one_screen(written):
    folder, summary, _ = written
    lines = [line.replace(str(folder), "tour") for line in summary.lines()]
    assert len(lines) <= 24
    assert all(len(line) <= 120 for line in lines)
    total = sum(len(lecture(key).steps) for key in LECTURES)
    assert f"{total} of {total} steps proved and replayed" in "\n".join(lines)
    assert "agree" in "\n".join(lines)


def test_a_badge_comes_from_the_file_alone(tmp_path, monkeypatch):
    original = tour.lecture_to_json

    def spoiled(current):
        data = original(current)
        if current.key == "observer":
            next(s for s in data["steps"] if s["name"] == "square")["certificates"][0]["squares"] = []
        return data

    monkeypatch.setattr(tour, "lecture_to_json", spoiled)
    chapters = tour.write_certificates(tmp_path)
    assert [c.lecture.key for c in chapters if not c.report.accepted] == ["observer"]
    page = tour.bind(chapters, [])
    badges = {row.id: row.badge for block in page.blocks if isinstance(block, Display) for row in block.rows}
    assert badges["observer-square"] == "not proved"
    assert badges["observer-optimal-gain"] == "not proved"
    assert badges["observer-attained"] == "proved"
    assert page.proved < page.total
    summary = tour.Summary(tmp_path, tuple(chapters), "plant", "agree", 0.0)
    assert not summary.expected


def test_a_plant_that_is_not_confirmed_is_not_expected(written):
    _, summary, _ = written
    for verdict in ("disagree", "unconfirmed"):
        other = replace(summary, verdict=verdict)
        assert not other.expected
        assert verdict in "\n".join(other.lines())


def test_a_file_in_the_way(tmp_path):
    (tmp_path / "tour").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="expected a folder"):
        tour.write_tour(tmp_path / "tour", example_plant(), dict)
    assert (tmp_path / "tour").read_text(encoding="utf-8") == "mine"


# ------------------------------------------------------------------------------------------------ worked example
@pytest.mark.parametrize(
    "data",
    [
        {"time": "discrete", "A": [[1.2]], "C": [[1.0]], "Q": [[1.0]], "R": [[2.0]], "dt": 0.1},
        {"time": "discrete", "A": [[0.5, 1.0], [0.0, 0.2]], "C": [[1.0, 0.0]], "Q": [[1.0, 0], [0, 0]], "R": [[2.0]]},
        {"time": "continuous", "A": [[0.0, 1.0], [0.0, 0.0]], "C": [[1.0, 0.0]], "W": [[0.0, 0.0], [0.0, 1.0]],
         "V": [[1.0]], "N": [[0.0], [0.5]], "P0": [[1.0, 0.0], [0.0, 1.0]], "states": ["position", "speed"]},
    ],
)  # fmt: skip
def test_the_example_of_any_plant(data):
    plant = plant_from_mapping(data)
    blocks = worked.worked_example(plant, validate(plant).as_dict(), "What it is.")
    drawings = [b.alt.split()[0] for b in blocks if isinstance(b, Figure)]
    assert drawings == ["Eigenvalues", "Standard", *["Covariance"] * (plant.n > 1), "Simulated", "The", "What"]
    heads = [b.head[0] for b in blocks if isinstance(b, Table)]
    assert heads == ["A", "route", "route", "solver", ""]
    shown = {row.id for b in blocks if isinstance(b, Display) for row in b.rows}
    assert ("worked-example-N" in shown) == ("N" in data)
    letters = {row.id: plain(row.lhs) for b in blocks if isinstance(b, Display) for row in b.rows}
    assert letters["worked-example-V"] == ("V" if plant.is_continuous else "R")
    anchors = [b.id for b in blocks if isinstance(b, Section)]
    assert len(set(anchors)) == len(anchors)


def test_numbers_are_printed_with_a_minus_sign():
    assert worked.number(-0.00123456) == "−0.0012346"
    assert worked.number(None) == "–"
    assert worked.mode(-1 - 2j) == "−1 − 2j"
    assert worked.mode(3 + 0j) == "3"
    assert [plain(worked.decimal(x)) for x in (-0.5, 0.0, 2.25)] == ["-0.5", "0", "2.25"]


def test_the_verdict_names_those_who_confirm(validation):
    blocks = worked.worked_example(example_plant(), validation)
    (text,) = next(b.text for b in blocks if isinstance(b, Para) and "Verdict" in str(b.text))
    assert "agree" in text
    confirming = text.partition("agree: ")[2].partition(" confirm")[0].split(", ")
    for route in validation["routes"]:
        confirms = "riccati" in route["independent_of"] and (route["residual"] or 1.0) < 1e-7
        assert (route["name"] in confirming) == confirms


def test_the_validation_is_plain_data(validation):
    assert json.loads(json.dumps(validation)) == validation
