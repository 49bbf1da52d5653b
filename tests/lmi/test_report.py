"""The report of a validation: on a terminal, in a notebook, and as a page that says what the data say."""

import json
import re
import subprocess
import sys
from fractions import Fraction
from html.parser import HTMLParser
from io import StringIO

import numpy as np
import pytest
from click.testing import CliRunner

import derive.notes.figures as figures
import derive.notes.figures_validation as figures_validation
import derive.notes.html as html_module
import derive.validation_page as page_module
import lmi.validation as validation_module
from derive.errors import InputError
from derive.numeric.plant import example_plant, plant_from_mapping
from derive.validation_page import validation_page, verdict, write_page
from lmi.cli import cli
from lmi.report.rows import ranges, spread
from lmi.report.table import print_table
from lmi.routes import ROUTES
from lmi.validation import validate

TRACK = {
    "name": "track <1>",
    "time": "discrete",
    "dt": 0.1,
    "A": [[1.0, 0.1], [0.0, 0.9]],
    "C": [[1.0, 0.0]],
    "Q": [[0.0, 0.0], [0.0, 0.04]],
    "R": [[0.25]],
    "states": ["position", "speed"],
    "outputs": ["GNSS"],
    "units": {"position": "m", "speed": "m/s^2"},
}
STRONG = {"time": "continuous", "A": [[0.0, 0.0], [0.0, -1.0]], "C": [[1.0, 1.0]], "W": [[0, 0], [0, 2]], "V": [[1.0]]}
SECTIONS = ["plant", "routes", "proved", "covariance", "modes", "response", "simulation", "spectrum", "convergence"]


class Page(HTMLParser):
    """Collects the tags of a page, its addresses, anchors and tables."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.addresses, self.anchors, self.tables, self.cell = [], [], [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name in ("href", "src", "srcset", "action", "data", "poster", "xlink:href"):
                self.addresses.append(value)
            if name == "id":
                self.anchors.append(value)
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.cell = ""

    def handle_data(self, data):
        if self.cell is not None:
            self.cell += data

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.tables[-1][-1].append(self.cell)
            self.cell = None

    def table(self, head):
        """Return the rows of the one table whose head starts like this."""
        (found,) = (rows for rows in self.tables if rows[0][: len(head)] == head)
        return found[1:]


def written(plant, folder):
    """Return the validation of a plant, the text of its page, and the page."""
    validation = validate(plant)
    write_page(folder / "report.html", validation.plant, validation.as_dict())
    text = (folder / "report.html").read_text(encoding="utf-8")
    return validation, text, Page(text)


@pytest.fixture(scope="module")
def track(tmp_path_factory):
    return written(TRACK, tmp_path_factory.mktemp("track"))


@pytest.fixture
def undrawn(monkeypatch):
    """Leave drawings and font out, which take most of the time."""
    for module in (figures, figures_validation):
        monkeypatch.setattr(module, "as_svg", lambda figure: "<svg></svg>")
    monkeypatch.setattr(html_module, "embedded", lambda *_: "data:")


# ------------------------------------------------------------------------------------------------ the page
def test_the_page_is_whole_and_asks_for_nothing(track):
    _, text, page = track
    assert not {"link", "iframe", "object", "embed", "img", "base", "script", "form"} & set(page.tags)
    assert not re.search(r"url\((?!data:|#|\"?#)|@import", text)
    assert all(address.startswith("#") for address in page.addresses)
    assert len(page.anchors) == len(set(page.anchors))
    assert {address[1:] for address in page.addresses} <= set(page.anchors)
    assert page.tags.count("svg") == 6
    assert len(text.encode()) < 400_000


def test_its_sections_are_those_of_a_report_in_order(track):
    _, text, page = track
    assert [anchor for anchor in page.anchors if anchor in SECTIONS] == SECTIONS
    assert text.index('class="agree"') < text.index("<nav")
    assert "track &lt;1&gt;" in text
    assert "<1>" not in text


def test_its_tables_hold_the_numbers_of_the_data(track):
    validation, _, page = track
    data = validation.as_dict()
    rows = page.table(["route", "tr P"])
    assert [row[0] for row in rows] == [f"{i} {spec.name}" for i, spec in enumerate(ROUTES, start=1)]
    for row, route in zip(rows, data["routes"], strict=True):
        shown = [cell.replace("−", "-") for cell in row]
        assert shown[6] == route["status"].partition(":")[0]
        if route["interval"] is None:
            assert shown[1] == ("–" if route["trace"] is None else f"{route['trace']:.6g}")
        else:
            value, half_width = map(float, shown[1].split(" ± "))
            assert value - half_width == pytest.approx(route["interval"][0], rel=2e-2)
        assert shown[2] == ("–" if route["output"] is None else f"{route['output']:.6g}")
    bounds = {name: ends for name, *ends in page.table(["", "at least", "at most"])}
    assert bounds["tr P"] == data["bounds"]["trace"]
    for name, ends in zip(validation.plant.states, data["bounds"]["variances"], strict=True):
        assert bounds[f"variance of {name}"] == ends
    deviations = page.table(["state", "standard deviation", "after the measurement"])
    assert [row[0] for row in deviations] == ["position [m]", "speed [m/s²]"]
    for i, row in enumerate(deviations):
        assert float(row[1]) == pytest.approx(np.sqrt(data["covariance"][i][i]), rel=1e-4)
        assert float(row[2]) == pytest.approx(np.sqrt(data["filter"]["covariance"][i][i]), rel=1e-4)
        lower, upper = map(float, row[3].split(" to "))
        assert lower < float(row[1]) < upper


def test_independent_routes_are_named_by_their_numbers(track):
    validation, _, page = track
    numbers = {route.name: i for i, route in enumerate(validation.routes, start=1)}
    for row, route in zip(page.table(["route", "what it computes"]), validation.routes, strict=True):
        named = [part.split("–") for part in row[2].split(", ")]
        found = {k for ends in named for k in range(int(ends[0]), int(ends[-1]) + 1)}
        assert found == {numbers[name] for name in route.independent_of}


def test_other_units_change_what_has_units_and_nothing_else(track, tmp_path, undrawn):
    """x1 in units of 1/8: its variance times 64, exactly within the bounds; modes, output and verdict stay."""
    unit = np.array([8.0, 1.0])
    other = {
        **TRACK,
        "A": np.array(TRACK["A"]) * unit[:, None] / unit,
        "C": np.array(TRACK["C"]) / unit,
        "Q": np.array(TRACK["Q"]) * np.outer(unit, unit),
    }
    (first, _, before), (second, _, after) = track, written(other, tmp_path)
    assert first.verdict is second.verdict
    assert before.table(["A", "A − L C"]) == after.table(["A", "A − L C"])
    outputs = [[row[2] for row in page.table(["route", "tr P"])] for page in (before, after)]
    assert outputs[0] == outputs[1]
    for row, scaled in zip(before.table(["", "at least"])[1:], after.table(["", "at least"])[1:], strict=True):
        factor = 64 if "position" in row[0] else 1
        lower, upper = (Fraction(end) for end in scaled[1:])
        assert lower <= factor * Fraction(row[2])
        assert upper >= factor * Fraction(row[1])
        assert upper - lower < Fraction(1, 10**25)


def test_the_order_of_states_orders_the_rows(track, tmp_path, undrawn):
    turned = {
        **TRACK,
        "A": np.array(TRACK["A"])[::-1, ::-1],
        "C": np.array(TRACK["C"])[:, ::-1],
        "Q": np.array(TRACK["Q"])[::-1, ::-1],
        "states": TRACK["states"][::-1],
    }
    _, _, page = written(turned, tmp_path)
    rows = [row[:3] for row in page.table(["state", "standard deviation"])]
    assert rows == [row[:3] for row in track[2].table(["state", "standard deviation"])][::-1]


def test_a_strong_solution_has_a_page_that_says_what_is_missing(tmp_path, undrawn):
    validation, text, page = written(STRONG, tmp_path)
    assert validation.routes[0].status == "strong"
    assert "Simulation is not applicable: mode 0 of A - L C does not decay" in text
    assert page.tags.count("svg") == 4


def test_a_verdict_that_is_not_good_is_not_green(track, undrawn):
    data = track[0].as_dict()
    for word in ("agree", "disagree", "unconfirmed"):
        assert verdict({**data, "verdict": word, "reason": "1 < 2"}) == f'<b class="{word}">{word}</b> 1 &lt; 2'
    without = {**data, "covariance": None, "filter": None, "bounds": None, "certificate_status": "failed: no <luck>"}
    for answer, doubt in ((True, ""), (False, "and no covariance"), (None, "too large to decide")):
        bounds = {**data["bounds"], "is_covariance": answer}
        text = str(validation_page(track[0].plant, {**data, "bounds": bounds}).blocks)
        assert doubt in text
        assert doubt or "covariance." not in text.partition("An exact certificate")[2].partition("Table")[0]
    shown = str(validation_page(track[0].plant, without).blocks)
    assert "There is no certificate: failed: no <luck>" in shown
    assert "The Riccati equation gave none." in shown


def test_large_matrices_are_left_out(tmp_path, undrawn):
    n = 9
    plant = {"time": "continuous", "A": -np.eye(n), "C": np.eye(1, n), "W": np.eye(n), "V": 1.0}
    _, text, page = written(plant, tmp_path)
    assert "9 states and 1 outputs are in the plant" in text
    assert len(page.table(["state"])) == n
    assert "The first 6 of 9 states" in text


def test_what_cannot_be_drawn_takes_nothing_else_with_it(track, tmp_path, monkeypatch, undrawn):
    def fail(*_):
        raise InputError("response: out of luck")

    monkeypatch.setattr(page_module, "covariance_response", fail)
    write_page(tmp_path / "report.html", track[0].plant, track[0].as_dict())
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Not drawn: response: out of luck" in text
    assert {"simulation", "spectrum", "convergence"} <= set(Page(text).anchors)


def test_names_that_no_font_has_are_drawn_all_the_same(tmp_path):
    names = ["$x_{\u5024", "<b>"]
    _, text, page = written({**TRACK, "states": names, "units": {"<b>": "rad/s^-1"}}, tmp_path)
    assert [row[0] for row in page.table(["state", "standard deviation"])] == ["$x_{\u5024", "<b> [rad/s⁻¹]"]
    assert "b" not in page.tags[page.tags.index("main") :]
    assert "Not drawn" not in text


# ------------------------------------------------------------------------------------------------ the file
@pytest.fixture
def plant_file(tmp_path):
    path = tmp_path / "plant.json"
    path.write_text(json.dumps({"time": "discrete", "A": [[2.0]], "C": [[1.0]], "Q": [[1.0]], "R": [[1.0]]}))
    return path


def invoke(*args):
    return CliRunner().invoke(cli, [str(arg) for arg in args])


def test_the_command_writes_the_page_beside_the_table(plant_file, tmp_path, undrawn):
    result = invoke("validate", plant_file, "-o", tmp_path / "report.html")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1].startswith(("agree", "  "))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["plant.json", "report.html"]
    data = json.loads(invoke("validate", plant_file, "--format", "json", "-o", tmp_path / "again.html").stdout)
    assert data["verdict"] == "agree"
    assert data["bounds"]["trace"][0] in (tmp_path / "again.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "word"),
    [("report.pdf", ".html"), ("report", ".html"), ("nowhere/report.html", "folder"), ("folder.html", "folder")],
)
def test_a_bad_place_is_one_line_before_any_work(name, word, plant_file, tmp_path, monkeypatch):
    monkeypatch.setattr(validation_module, "validate", lambda *_, **__: pytest.fail("the plant was validated"))
    (tmp_path / "folder.html").mkdir()
    result = invoke("validate", plant_file, "-o", tmp_path / name)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert word in result.stderr
    assert not (tmp_path / name).is_file()


def test_a_page_that_fails_leaves_the_old_one(track, tmp_path, monkeypatch, undrawn):
    path = tmp_path / "report.html"
    path.write_text("old")
    monkeypatch.setattr(page_module, "html", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_page(path, track[0].plant, track[0].as_dict())
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_drawings_are_loaded_for_a_page_alone(plant_file):
    code = (
        "import sys\nfrom lmi.cli import cli\n"
        f"try:\n cli.main(['validate', {str(plant_file)!r}])\nexcept SystemExit:\n pass\n"
        "print('LOADED', *(n for n in ('matplotlib', 'fontTools', 'derive.validation_page') if n in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "LOADED"


# ------------------------------------------------------------------------------------------------ text and notebook
class Terminal(StringIO):
    """A terminal without colours."""

    def isatty(self):
        return True


@pytest.fixture(scope="module")
def aircraft():
    return validate(example_plant())


@pytest.mark.parametrize(("columns", "wide"), [(80, False), (99, False), (100, True), (140, True)])
def test_a_terminal_shows_what_it_has_room_for(columns, wide, aircraft, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setenv("NO_COLOR", "1")
    terminal = Terminal()
    print_table(aircraft, terminal)
    lines = re.sub(r"\x1b\[[0-9;]*m", "", terminal.getvalue()).splitlines()
    table = lines[1 : 2 + len(ROUTES)]
    assert max(len(line.rstrip()) for line in table) <= columns
    assert "…" not in terminal.getvalue()
    assert ("independent of" in table[0]) == wide
    assert ("+-" in table[-1]) == wide


def test_str_is_the_report_and_fits_100_columns(aircraft):
    text = str(aircraft)
    out = StringIO()
    print_table(aircraft, out)
    assert text == out.getvalue().rstrip()
    lines = text.splitlines()
    assert max(map(len, lines[: 2 + len(ROUTES)])) <= 100
    assert lines[2].split()[:2] == ["riccati", "1"]
    assert lines[1 + len(ROUTES)].split()[0] == "simulation"
    assert text.isascii()


def test_the_filter_form_is_shown_in_discrete_time_alone(track, aircraft):
    (line,) = (line for line in str(track[0]).splitlines() if line.startswith("filter form"))
    covariance, P = np.array(track[0].as_dict()["filter"]["covariance"]), track[0].routes[0].P
    C, R = track[0].plant.C, track[0].plant.V
    np.testing.assert_allclose(covariance, np.linalg.inv(np.linalg.inv(P) + C.T @ np.linalg.inv(R) @ C), rtol=1e-9)
    assert line.endswith(f"tr P+ = {np.trace(covariance):.6g}")
    assert "filter form" not in str(aircraft)
    assert aircraft.filter_form is aircraft.as_dict()["filter"] is None


def test_a_notebook_shows_verdict_and_table(track):
    validation, *_ = track
    text = validation._repr_html_()
    page = Page(text)
    (rows,) = page.tables
    assert [row[0] for row in rows[1:]] == [route.name for route in validation.routes]
    assert "track &lt;1&gt;" in text
    assert "agree: " in text
    assert "script" not in page.tags


def test_the_words_of_a_weighted_plant():
    plant = plant_from_mapping({"time": "continuous", "A": -1.0, "C": 1.0, "W": 1.0, "V": 1.0, "M": 3.0})
    validation = validate(plant)
    text = str(validation)
    assert "tr MP" in text.splitlines()[1]
    assert f"{3 * (np.sqrt(2) - 1):.6g}" in text.splitlines()[2]


@pytest.mark.parametrize(
    ("value", "half_width", "text"),
    [
        (7.19168, 0.194, "7.19+-0.19"),
        (0.126642, 0.00168, "0.1266+-0.0017"),
        (4.22, 0.0, "4.22"),
        (1234.5, 12.3, "1234+-12"),
        (1.2345e-9, 1.2e-11, "1.23e-09+-1e-11"),
        (8.7e7, 3.2e5, "8.70e+07+-3e+05"),
        (-2.5, 0.31, "-2.50+-0.31"),
    ],
)
def test_a_spread_is_printed_to_its_second_digit(value, half_width, text):
    assert spread(value, half_width) == text


@pytest.mark.parametrize(
    ("numbers", "text"), [([], "-"), ([3], "3"), ([2, 1], "1 2"), ([1, 2, 3, 5], "1-3 5"), ([10, 9, 8, 1], "1 8-10")]
)
def test_numbers_in_a_row_are_drawn_together(numbers, text):
    assert ranges(numbers) == text


def test_the_text_says_how_far_the_covariance_follows_the_plant(aircraft):
    """The condition bounds, to first order, what a relative change of the numbers does to P."""
    (line,) = [line for line in str(aircraft).splitlines() if line.startswith("condition: ")]
    condition = float(line.split()[6])
    plant, P = aircraft.plant, aircraft.routes[0]
    changed = plant_from_mapping(
        {"time": plant.time, "A": plant.A * (1 + 1e-6), "C": plant.C, "W": plant.W, "V": plant.V}
    )
    moved = abs(validation_module.validate(changed).routes[0].trace / P.trace - 1)
    assert 0 < moved <= 1.05 * condition * 1e-6
    assert "boundary" not in str(aircraft)


def test_modes_beside_the_boundary_are_named():
    text = str(validate(plant_from_mapping(STRONG)))
    assert "modes of A - LC on the boundary of stability or beside it: 0" in text
