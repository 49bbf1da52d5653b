"""The page of sliders: its script computes what Python computes, at every edge, and its badges come from the replay."""

from __future__ import annotations

import itertools
import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import quickjs

from derive.functions import Quotient
from derive.notes import sliders
from derive.notes.sliders import PANELS, script, slider_page
from derive.scalar import library
from derive.theory import lecture, theory

STEPS = (1, 40)
GRID = {
    "A": (-3.0, -1.0, -0.05, 0.0, 0.05, 1.0, 3.0), "C": (-2.0, 0.0, 0.05, 1.0), "W": (0.0, 0.05, 5.0),
    "V": (0.01, 1.0, 10.0), "P0": (0.0, 0.05, 5.0), "T": (0.5, 20.0), "Q": (0.0, 0.05, 5.0), "R": (0.01, 1.0, 10.0),
}  # fmt: skip


@pytest.fixture(scope="module")
def outcomes():
    return lecture("scalar").verify()


@pytest.fixture(scope="module")
def page(outcomes) -> str:
    return slider_page(outcomes, "scalar", "index")


@pytest.fixture(scope="module")
def panels():
    return {panel.key: panel for panel in (make(theory("scalar").symbols.__getitem__) for make in PANELS)}


@pytest.fixture
def js(page):
    """The script of the page, in an engine without a document."""
    context = quickjs.Context()
    context.eval(re.search(r"<script>(.*)</script>", page, re.DOTALL)[1])
    return lambda expression: json.loads(context.eval(f"JSON.stringify({expression}, (k, v) => {ODD})"))


ODD = 'typeof v === "number" && !Number.isFinite(v) ? String(v) : v'


def points(panel):
    names = [s.symbol for s in panel.sliders]
    grid = {**GRID, "T": STEPS} if panel.key == "discrete" else GRID
    return [dict(zip(names, values, strict=True)) for values in itertools.product(*(grid[n] for n in names))]


def evaluated(js, panel):
    where = points(panel)
    return zip(where, js(f"{json.dumps(where)}.map({panel.key})"), strict=True)


def agree(one, two):
    one, two = float(one), float(two)
    return (math.isnan(one) and math.isnan(two)) or one == two or abs(one - two) <= 1e-12 * max(1.0, abs(one))


# ------------------------------------------------------------------------------------------------ values
KEYS = {"continuous": ("P", "K", "loop", "end"), "discrete": ("M", "plus", "L", "loop", "end")}


def undefined(key, p):
    return p["C"] == 0 and (p["A"] >= 0 if key == "continuous" else abs(p["A"]) >= 1)


@pytest.mark.parametrize("key", KEYS)
def test_values_are_those_of_python(js, panels, key):
    found = [values["values"] for _, values in evaluated(js, panels[key])]
    where = {name: np.array(column) for name, column in zip(points(panels[key])[0], columns(panels[key]), strict=True)}
    where = {**where, "t": where["T"], "k": where["T"]}
    for name, formula in zip(KEYS[key], panels[key].formulas, strict=True):
        made = library.formula(formula)
        wanted = made.to_numpy()(*(where[s.name] for s in made.program.arguments))
        for p, value, other in zip(points(panels[key]), wanted, (values[name] for values in found), strict=True):
            assert agree(value, other), (name, p, value, other)
            assert math.isnan(value) == (name != "end" and undefined(key, p)), (name, p)


def columns(panel):
    return zip(*(p.values() for p in points(panel)), strict=True)


@pytest.mark.parametrize(("key", "late"), [("continuous", 1e12), ("discrete", 1e12)])
def test_the_limit_is_what_the_transient_tends_to(js, panels, key, late):
    formula = library.formula(panels[key].formulas[-1])
    later, names = formula.to_numpy(), [s.name for s in formula.program.arguments[:-1]]
    seen = set()
    for p, found in evaluated(js, panels[key]):
        value, words = float(later(*(p[name] for name in names), late)), found["words"]
        shown = float(found["values"]["limit"])
        assert (not value < 1e9) == math.isnan(shown), p
        assert math.isnan(shown) or abs(value - shown) <= 1e-8 * max(1, shown), p
        assert ("grows without bound" in words) == math.isnan(shown), p
        assert "stays 0" not in words or shown == p["P0"] == 0, p
        assert "Nothing drives the state" not in words or shown == p["P0"], p
        seen.add((math.isnan(shown), shown == 0, "stays 0" in words, "Nothing drives the state" in words))
    assert len(seen) == 5


def test_the_curves_are_the_formulas(js):
    p = {"A": 1, "C": 1, "W": 1, "V": 1, "P0": 4, "T": 4}
    P, later = (library.formula(n).to_numpy() for n in ("care_covariance", "riccati_transient"))
    plots = js(f"PLOTS.continuous({json.dumps(p)}, continuous({json.dumps(p)}).values)")
    assert [x for x, _ in plots["state"]["curves"][0]][::240] == [-3, 3]
    assert all(agree(P(x, 1, 1, 1), y) for x, y in plots["state"]["curves"][0])
    assert all(agree(later(1, 1, 1, 1, 4, t), y) for t, y in plots["time"]["curves"][0])
    assert plots["time"]["curves"][0][-1][0] == 4


@pytest.mark.parametrize("key", KEYS)
def test_what_is_not_defined_is_said_in_words(js, panels, key):
    for p, found in evaluated(js, panels[key]):
        assert undefined(key, p) == found["words"].startswith("Not defined here: C = 0"), p
        assert bool(found["words"]) >= (p["C"] == 0 or p.get("W", p.get("Q")) == 0)


@pytest.mark.parametrize(
    ("key", "special", "words"),
    [
        ("continuous", {"A": -1.0, "C": 0.0}, "the gain is 0"),
        ("continuous", {"A": -1.0, "W": 0.0}, "dies out by itself, and the gain is 0"),
        ("continuous", {"A": 0.0, "W": 0.0}, "double root, at 0. P(t) falls to it like 1/t"),
        ("continuous", {"A": 0.0, "W": 0.0, "P0": 0.0}, "double root, at 0. Started without error"),
        ("continuous", {"A": 1.0, "W": 0.0}, "A − KC = −A"),
        ("continuous", {"A": 1.0, "W": 0.0, "P0": 0.0}, "P(t) stays 0"),
        ("continuous", {"A": 0.0, "W": 0.0, "C": 0.0}, "P(t) stays at P(0)"),
        ("continuous", {}, ""),
        ("discrete", {"A": 0.5, "C": 0.0}, "the gain is 0"),
        ("discrete", {"A": -1.0, "Q": 0.0}, "double root, at 0. The covariance falls to it like 1/k"),
        ("discrete", {"A": -1.0, "Q": 0.0, "P0": 0.0}, "double root, at 0. Started without error"),
        ("discrete", {"A": 0.5, "Q": 0.0}, "dies out by itself, and the gain is 0"),
        ("discrete", {"A": 2.0, "Q": 0.0}, "A − LC = 1/A"),
        ("discrete", {"A": 2.0, "Q": 0.0, "P0": 0.0}, "the covariance stays 0"),
        ("discrete", {"A": -1.0, "Q": 0.0, "C": 0.0}, "stays what it was"),
        ("discrete", {"A": 0.0}, "nothing of its past"),
        ("discrete", {}, ""),
    ],
)
def test_special_cases_are_named(js, key, special, words):
    p = {"A": 1.2, "C": 1.0, "W": 1.0, "V": 1.0, "P0": 4.0, "T": 4.0, "Q": 1.0, "R": 1.0, **special}
    found = js(f"{key}({json.dumps(p)})")["words"]
    assert words in found
    assert bool(words) == bool(found)


# ------------------------------------------------------------------------------------------------ sliders
def test_a_position_stands_for_the_same_value_in_both_languages(js, panels):
    for slider in (s for panel in panels.values() for s in panel.sliders):
        places = list(range(slider.low, slider.high + 1))
        scale = json.dumps("decades" if slider.decades else "linear")
        values = js(f"{places}.map(x => valueOf(x, {scale}, {slider.per}))")
        assert values == pytest.approx([slider.value(x) for x in places], rel=1e-15, abs=0)
        assert js(f"{values}.map(x => positionOf(x, {scale}, {slider.per}))") == places
        assert slider.low <= slider.start <= slider.high
        assert (0.0 in values) == (slider.symbol in ("A", "C", "W", "P0", "Q"))


def test_a_case_is_where_the_sliders_can_be(panels):
    for panel in panels.values():
        by_name = {s.symbol: s for s in panel.sliders}
        for values in panel.cases.values():
            for name, value in values.items():
                slider = by_name[name]
                assert value in [slider.value(x) for x in range(slider.low, slider.high + 1)], (panel.key, name)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("0", "0"), ("-0.5", "−0.5"), ("1 + Math.SQRT2", "2.414"), ("12345.6", "12350"), ("5.434e52", "5.434·10⁵²"),
        ("-1.5e-7", "−1.5·10⁻⁷"), ("NaN", "not defined"), ("1/0", "beyond what numbers here can hold"),
    ],
)  # fmt: skip
def test_numbers_as_text(js, value, text):
    assert js(f"shown({value})") == text


# ------------------------------------------------------------------------------------------------ drawings
@pytest.mark.parametrize("key", KEYS)
def test_every_drawing_is_made_of_numbers(js, panels, key):
    panel = panels[key]
    drawn = js(
        f"{json.dumps(points(panel))}.map(p => Object.values(PLOTS.{key}(p, {key}(p).values)).map(drawing).join(''))"
    )
    for p, svg in zip(points(panel), drawn, strict=True):
        assert not re.search(r"NaN|Infinity|undefined", svg), p
        for tag, numbers in re.findall(r"<(\w+)[^>]* d=\"([^\"]*)\"", svg):
            assert tag == "path"
            assert re.fullmatch(r"([MLHVv ]-?\d+(\.\d)?( -?\d+(\.\d)?)?)*", numbers), numbers
            corners = [(float(x), float(y)) for x, y in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", numbers)]
            assert all(46 <= x <= 388 and 26 <= y <= 236 for x, y in corners), p
        assert (">not defined<" in svg) == (p["C"] == 0)
        steady = {"continuous": 1, "discrete": 2}[key] * (not undefined(key, p))
        assert svg.count(' r="4.5"') == steady + 1
        assert svg.count(' r="2.6"') == (p["T"] + 1) * (key == "discrete")


def test_the_circle_is_on_the_curve(js):
    p = '{"A": 1, "C": 1, "W": 1, "V": 1, "P0": 4, "T": 4}'
    svg = js(f"drawing(PLOTS.continuous({p}, continuous({p}).values).state)")
    x, y = (float(v) for v in re.search(r'<circle[^>]* cx="([\d.]+)" cy="([\d.]+)"', svg).groups())
    curve = re.search(r'class="curve c0" d="([^"]*)"', svg)[1]
    nearest = min(re.findall(r"[ML]([\d.]+) ([\d.]+)", curve), key=lambda q: abs(float(q[0]) - x))
    assert abs(float(nearest[0]) - x) < 1
    assert abs(float(nearest[1]) - y) < 1
    ticks = {text: float(h) for h, text in re.findall(r'y="([\d.]+)" text-anchor="end">(\d)<', svg)}
    scale = (ticks["2"] - ticks["4"]) / 2
    assert (ticks["0"] - 4 - y) / scale == pytest.approx(1 + math.sqrt(2), abs=0.01)


def test_a_curve_that_leaves_the_frame_is_cut(js):
    assert js("line([[0, 0], [1, 5], [2, 9], [3, 5], [4, 0]], x => x, y => y, 4)") == "M0 0L1 5M3 5L4 0"
    assert js("line([[0, 1], [1, NaN], [2, 1], [3, 2]], x => x, y => y, 4)") == "M0 1M2 1L3 2"


# ------------------------------------------------------------------------------------------------ the page
class Elements(HTMLParser):
    """Collects the elements of a page, with their attributes, and the text of those that are labels."""

    def __init__(self, text):
        super().__init__()
        self.seen = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))

    def all(self, tag, **wanted):
        return [a for t, a in self.seen if t == tag and all(a.get(k) == v for k, v in wanted.items())]


def test_the_page_asks_for_nothing_and_is_small(page):
    elements = Elements(page)
    assert "http" not in re.sub(r"data:font/woff2;base64,[A-Za-z0-9+/=]*", "", page)
    assert not {"link", "img", "iframe", "object", "embed"} & {tag for tag, _ in elements.seen}
    assert not [a for _, a in elements.seen if "src" in a]
    assert {a["href"].partition("#")[0] for a in elements.all("a")} == {"index.html", "scalar.html"}
    assert not re.search(r"fetch\(|XMLHttp|import\(|eval\(|new Function", page)
    assert len(page.encode()) < 120_000


def test_the_page_by_itself_has_no_links(outcomes):
    assert Elements(slider_page(outcomes)).all("a") == []


def test_every_slider_has_a_label_and_every_drawing_words(page):
    elements = Elements(page)
    ids = [a["id"] for _, a in elements.seen if "id" in a]
    assert len(ids) == len(set(ids))
    inputs = elements.all("input", type="range")
    assert len(inputs) == 12
    for a in inputs:
        assert elements.all("label", **{"for": a["id"]})
        assert elements.all("output", **{"for": a["id"]})
        assert int(a["min"]) <= int(a["value"]) <= int(a["max"])
    assert all(a["role"] == "img" and "aria-label" in a for a in elements.all("svg"))
    assert len(elements.all("p", role="status")) == 2
    assert "prefers-color-scheme:dark" in page
    assert "<noscript>" in page


def test_the_script_is_what_the_formulas_export(page, panels):
    source = re.search(r"<script>\n(.*)</script>", page, re.DOTALL)[1]
    assert source == script(list(panels.values()))
    for name in (name for panel in panels.values() for name in panel.formulas):
        assert library.formula(name).to_javascript() in source


DOCUMENT = """
const elements = %s;
function element(a) {
  const dataset = Object.fromEntries(
    Object.entries(a).filter(([k]) => k.startsWith("data-")).map(([k, v]) => [k.slice(5), v]));
  return {...a, dataset, defaultValue: a.value, attributes: {}, listeners: {}, classList: {toggle: () => 0},
    setAttribute(k, v) { this.attributes[k] = v; }, addEventListener(k, f) { this.listeners[k] = f; }};
}
const forms = elements.map(({form, parts}) => {
  const made = parts.map(([tag, a]) => [tag, element(a)]);
  const of = (tag) => made.filter(([t]) => t === tag).map(([, e]) => e);
  return Object.assign(element(form), {
    querySelectorAll: (s) => of(s.startsWith("input") ? "input" : "button"),
    querySelector(s) {
      const [, tag, name, value] = s.match(/^(\\w*)(?:\\[([\\w-]+)="(.*)"\\]|\\.words)$/);
      return s === ".words" ? of("p").find((e) => e.class === "words")
        : made.find(([t, e]) => (!tag || t === tag) && e[name] === value)[1];
    }});
});
const document = {querySelectorAll: () => forms};
"""


def opened(page):
    """Run the script of the page with the elements of the page, as far as it touches them."""
    found, current = [], None
    for tag, a in Elements(page).seen:
        if tag == "form":
            current = {"form": a, "parts": []}
            found.append(current)
        elif current is not None:
            current["parts"].append((tag, a))
    context = quickjs.Context()
    context.eval(DOCUMENT % json.dumps(found))
    context.eval(re.search(r"<script>(.*)</script>", page, re.DOTALL)[1])
    return lambda expression: json.loads(context.eval(f"JSON.stringify({expression})"))


def test_the_page_shows_its_values_when_it_opens(page):
    ask = opened(page)
    texts = ask(
        "['P', 'K', 'loop', 'end', 'limit'].map(k => forms[0].querySelector(`[data-value=\"${k}\"]`).textContent)"
    )
    assert texts == ["2.414", "2.414", "−1.414", "2.414", "2.414"]
    assert ask("forms[0].querySelector('output[for=\"continuous-V\"]').textContent") == "1"
    assert ask("forms.map(f => f.querySelector('svg[data-plot=\"state\"]').innerHTML.includes('curve'))") == [
        True,
        True,
    ]
    assert "limit is 2.414" in ask("forms[0].querySelector('svg[data-plot=\"time\"]').attributes['aria-label']")


def test_moving_a_slider_and_choosing_a_case_change_the_page(page):
    ask = opened(page)
    value = "forms[0].querySelector('[data-value=\"P\"]').textContent"
    words = "forms[0].querySelector('.words').textContent"
    assert ask("(forms[0].querySelectorAll('input')[0].value = '-20', forms[0].listeners.input(), 0)") == 0
    assert ask(value) == "0.4142"
    chosen = (
        "forms[0].querySelectorAll('button').find(b => b['data-set'] === '{\"A\": 0.5, \"C\": 0}').listeners.click()"
    )
    ask(f"({chosen}, 0)")
    assert ask(value) == "not defined"
    assert ask(words).startswith("Not defined here")
    assert ask("forms[0].querySelectorAll('input').map(i => Number(i.value))") == [10, 0, 20, 0, 80, 8]
    assert ask("forms[0].querySelectorAll('input')[0].attributes['aria-valuetext']") == "0.5 1/s"


# ------------------------------------------------------------------------------------------------ badges
def badges(page):
    rows = re.findall(r'<div class="row" id="(\w+)">.*?<b class="badge ([^"]*)">', page)
    return {name: badge for name, badge in rows if name in library.FORMULAS}


def test_every_formula_is_proved(page, panels):
    assert badges(page) == {name: "proved" for panel in panels.values() for name in panel.formulas}


def test_a_badge_comes_from_the_replay(outcomes):
    lost = [replace(o, accepted=o.step != "solution of an integrator") for o in outcomes]
    found = badges(slider_page(lost))
    assert {name for name, badge in found.items() if badge != "proved"} == {"riccati_transient"}
    assert "the step &#x27;solution of an integrator&#x27; is rejected" in slider_page(lost)
    assert set(badges(slider_page([])).values()) == {"not proved"}


def test_a_program_that_is_not_what_was_proved_has_no_badge(outcomes, monkeypatch):
    original = library.formula

    def spoiled(name):
        made = original(name)
        if name != "care_gain":
            return made
        A, C, *_ = made.program.arguments
        first, *others = made.program.branches
        wrong = replace(first, body=Quotient(A + A, C))
        return replace(made, program=replace(made.program, branches=(wrong, *others)))

    monkeypatch.setattr(library, "formula", spoiled)
    found = badges(sliders.slider_page(outcomes))
    assert {name for name, badge in found.items() if badge != "proved"} == {"care_gain"}
