"""The tour: what it writes, that its badges come from the replay, and that nothing leaves the page."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from derive import tour, worked
from derive.errors import InputError
from derive.latex import plain
from derive.notes.model import Display, Figure, Para, Section, Table
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.replay import verify_file
from derive.theory import IN_TOUR, lecture
from lmi.validation import validate


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
    assert sorted(p.name for p in (folder / "certificates").iterdir()) == sorted(f"{key}.json" for key in IN_TOUR)
    names = sorted(p.name for p in folder.iterdir())
    assert names == ["certificates", "figures", "index.html", "index.md"]
    assert summary.expected
    assert len(stages) == len(IN_TOUR) + 2


def test_the_certificates_replay(written):
    folder, *_ = written
    for key in IN_TOUR:
        (report,) = verify_file(folder / "certificates" / f"{key}.json")
        assert report.accepted
        assert report.total == len(lecture(key).steps)


def test_the_page_is_self_contained(written):
    folder, *_ = written
    text = (folder / "index.html").read_text(encoding="utf-8")
    page = Page(text)
    assert not {"script", "link", "iframe", "object", "embed", "img", "base"} & set(page.tags)
    assert {a.partition("#")[0] for a in page.addresses} == {""}
    assert {a[1:] for a in page.addresses} <= page.anchors
    assert not re.search(r"url\((?!data:|#|\"?#)|@import", text)
    without_plots = re.sub(r"<figure>.*?</figure>", "", text, flags=re.DOTALL)
    assert len(without_plots.encode()) < 800 * 1024
    assert page.tags.count("math") > 500


def test_lectures_findings_and_example_are_on_both_pages(written):
    folder, *_ = written
    for name in ("index.html", "index.md"):
        text = (folder / name).read_text(encoding="utf-8")
        titles = (*(lecture(key).title for key in IN_TOUR), "Findings on the", "Worked example")
        places = [re.search(rf"(<h2[^>]*>|^## ){re.escape(t)}", text, re.MULTILINE).start() for t in titles]
        assert places == sorted(places)
        assert example_plant().source.split(",")[0] in text
        for route in ("riccati", "lmi-primal", "lmi-dual", "lmi-h2", "nlp", "integral"):
            assert route in text
    for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text):
        assert (folder / target).read_text(encoding="utf-8").startswith("<svg")


def test_the_same_input_gives_the_same_files(written, validation, tmp_path):
    folder, *_ = written
    tour.write_tour(tmp_path, example_plant(), lambda _: validation)
    for path in folder.rglob("*.*"):
        assert path.read_bytes() == (tmp_path / path.relative_to(folder)).read_bytes()


def test_the_summary_fits_one_screen(written):
    _, summary, _ = written
    lines = list(summary.lines())
    assert len(lines) <= 24
    assert all(len(line) <= 120 for line in lines)
    total = sum(len(lecture(key).steps) for key in IN_TOUR)
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
    assert [type(b) for b in blocks if isinstance(b, (Figure, Table))] == [Table, Figure, Figure, Figure, Table]
    shown = {row.id for b in blocks if isinstance(b, Display) for row in b.rows}
    assert ("worked-example-N" in shown) == ("N" in data)
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
    for route in validation["routes"]:
        confirms = route["name"] not in ("riccati", "hamiltonian", "closed-form")
        assert (route["name"] in text) == confirms


def test_the_validation_is_plain_data(validation):
    assert json.loads(json.dumps(validation)) == validation
