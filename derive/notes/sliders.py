"""The page of sliders: the scalar filter's closed forms, drawn by the JavaScript that is exported from their proofs.

The page is one file without network and without code of others. Its script has two parts: the functions that
``Formula.to_javascript`` writes, which alone compute what the filter does, and ``sliders.js``, which moves, draws and
says in words where a closed form is not defined.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from derive.context import Declared
from derive.derivation import Lecture, Outcome
from derive.errors import InputError
from derive.latex.mathml import mathml
from derive.notes.html import block, inline, resource, whole_page
from derive.notes.model import Display, Inline, Link, Para, Row, Section, slug
from derive.terms import Dot, Equation, Glyph, Symbol

if TYPE_CHECKING:
    from derive.scalar.formula import Formula, Known

__all__ = ["PANELS", "Panel", "Slider", "script", "slider_page"]

TITLE = "The scalar filter by sliders"
ABOUT = (
    "The error covariance of the optimal filter for one state and one output, in closed form. The curves are computed "
    "by programs exported from the formulas; a badge says that the formula and every branch of its program were "
    "proved, and the proofs replayed."
)


Proofs = tuple[str, Mapping[str, str]]  # page of the proofs, and that of each anchor where they are on several


@dataclass(frozen=True)
class Slider:
    """A range input: whole positions, which stand for multiples of 1/per or for powers of ten.

    Attributes:
        symbol: key of the letter in the theory; T is the horizon, which no formula has.
        unit: unit of the value.
        low: lowest position.
        high: highest position.
        start: position to begin with.
        per: positions to one unit, or to one decade.
        decades: whether a position is an exponent, for what has to be positive.
    """

    symbol: str
    unit: str
    low: int
    high: int
    start: int
    per: int = 20
    decades: bool = False

    def value(self, position: int) -> float:
        """Return what a position stands for."""
        return 10 ** (position / self.per) if self.decades else position / self.per


@dataclass(frozen=True)
class Panel:
    """Sliders, what they compute, and the positions worth a look.

    Attributes:
        key: name in the script.
        title: heading.
        about: what the letters mean.
        definitions: declarations of the theory that the formulas need.
        formulas: names of closed forms.
        sliders: inputs.
        values: (key in the script, label, unit) of what is printed.
        plots: (key in the script, caption) of what is drawn.
        cases: values that differ from those at the start, by the name of the case.
    """

    key: str
    title: str
    about: Inline
    definitions: tuple[str, ...]
    formulas: tuple[str, ...]
    sliders: tuple[Slider, ...]
    values: tuple[tuple[str, Inline, str], ...]
    plots: tuple[tuple[str, str], ...]
    cases: Mapping[str, Mapping[str, float]]


def _continuous(symbol: Callable[[str], Symbol]) -> Panel:
    A, C, W, V, K, P = map(symbol, "ACWVKP")
    start, later = symbol("P0"), symbol("P0(t)")
    x, y, w, v = map(_letter, "xywv")
    return Panel(
        "continuous", "Continuous time",
        (
            "A state ", Equation(Dot(x), "=", A * x + w), " and an output ", Equation(y, "=", C * x + v),
            " with white noises of intensity ", W, " and ", V, "; ", P, " is the steady error covariance, ", K,
            " the gain, and ", later, " the covariance after a time ", symbol("t"),
            " from the start ", start, ".",
        ),
        ("g", "S"),
        ("care_covariance", "care_gain", "care_closed_loop", "riccati_transient"),
        (
            Slider("A", "1/s", -60, 60, 20), Slider("C", "[output]/[state]", -40, 40, 20),
            Slider("W", "[state]²/s", 0, 100, 20), Slider("V", "[output]²·s", -40, 20, 0, decades=True),
            Slider("P0", "[state]²", 0, 100, 80), Slider("T", "s", 1, 40, 8, per=2),
        ),
        (
            ("P", (P,), "[state]²"), ("K", (K,), "[state]/([output]·s)"), ("loop", (A - K * C,), "1/s"),
            ("end", ("P(t) at the horizon",), "[state]²"), ("limit", ("limit of P(t)",), "[state]²"),
        ),
        (
            ("state", "Steady error covariance over A; the circle is at the present values."),
            ("time", "Error covariance over time, from P(0); dashed, what it tends to."),
        ),
        {
            "unstable": {}, "stable": {"A": -1}, "integrator": {"A": 0}, "unstable, not excited": {"W": 0},
            "not excited, no error": {"W": 0, "P0": 0}, "double root": {"A": 0, "W": 0, "T": 20},
            "unseen, stable": {"A": -0.5, "C": 0, "T": 10}, "unseen, unstable": {"A": 0.5, "C": 0},
        },
    )  # fmt: skip


def _discrete(symbol: Callable[[str], Symbol]) -> Panel:
    A, C, Q, R, L, M, plus, start, later = map(symbol, ("A", "C", "Q", "R", "L", "M", "M+", "P0", "P_k"))
    x, y, w, v = map(_letter, "xywv")
    return Panel(
        "discrete", "Discrete time",
        (
            "A state that becomes ", A * x + w, " in each step and an output ", Equation(y, "=", C * x + v),
            " with white noises of covariance ", Q, " and ", R, "; ", M, " is the steady error covariance before a "
            "measurement, ", plus, " after it, ", L, " the gain, and ", later, " the covariance before a measurement "
            "after ", symbol("k"), " steps from the start ", start, ".",
        ),
        ("b", "T", "λ", "ρ"),
        ("dare_covariance", "dare_filtered_covariance", "dare_gain", "dare_closed_loop", "riccati_recursion"),
        (
            Slider("A", "", -60, 60, 24), Slider("C", "[output]/[state]", -40, 40, 20),
            Slider("Q", "[state]²", 0, 100, 20), Slider("R", "[output]²", -40, 20, 0, decades=True),
            Slider("P0", "[state]²", 0, 100, 80), Slider("T", "steps", 1, 40, 10, per=1),
        ),
        (
            ("M", (M,), "[state]²"), ("plus", (plus,), "[state]²"), ("L", (L,), "[state]/[output]"),
            ("loop", (A - L * C,), ""), ("end", (later, " at the horizon"), "[state]²"),
            ("limit", ("limit of ", later), "[state]²"),
        ),
        (
            ("state", "Steady error covariance over A, before and after the measurement."),
            ("time", "Error covariance after each step, from the start; dashed, what it tends to."),
        ),
        {
            "unstable": {}, "stable": {"A": 0.5}, "no memory": {"A": 0}, "unstable, not excited": {"A": 1.5, "Q": 0},
            "not excited, no error": {"A": 1.5, "Q": 0, "P0": 0}, "double root": {"A": 1, "Q": 0, "T": 40},
            "unseen, stable": {"A": 0.5, "C": 0}, "unseen, unstable": {"C": 0},
        },
    )  # fmt: skip


def _letter(name: str) -> Symbol:
    return Symbol(name, glyph=Glyph(name), scalar=True)


PANELS = (_continuous, _discrete)


def slider_page(
    outcomes: Sequence[Outcome], proofs: str = "", back: str = "", places: Mapping[str, str] | None = None
) -> str:
    """Return the page of sliders as HTML.

    Args:
        outcomes: what the replay of the scalar lecture said; the badges come from it.
        proofs: page of the scalar lecture, without suffix, to which the formulas link; none if empty.
        back: page to return to, without suffix; none if empty.
        places: page of each anchor of the lecture, if it has several pages.
    """
    from derive.theory import lecture

    current = lecture("scalar")
    panels = [make(current.theory.symbols.__getitem__) for make in PANELS]
    complaints = _complaints(panels, frozenset(o.step for o in outcomes if o.accepted))
    body = "\n".join(_section(panel, current, complaints, (proofs, places or {})) for panel in panels)
    subtitle = (Link("All lectures", "", back), " · ") if back else ()
    about = Link(current.title, "", proofs) if proofs else current.title
    return whole_page(
        TITLE, (*subtitle, "Formulas and proofs: ", about), "", f"{block(Para((ABOUT,)))}\n{NOSCRIPT}\n{body}",
        style=resource("sliders.css"), script=script(panels),
    )  # fmt: skip


NOSCRIPT = "<noscript><p>The formulas below stand by themselves; the sliders need JavaScript.</p></noscript>"


def script(panels: Sequence[Panel]) -> str:
    """Return the script of the page: the exported functions, then what moves and draws."""
    from derive.scalar.library import formula

    names = dict.fromkeys(name for panel in panels for name in panel.formulas)
    return "\n".join((*(formula(name).to_javascript() for name in names), resource("sliders.js")))


def _section(panel: Panel, lecture: Lecture, complaints: Mapping[str, str], proofs: Proofs) -> str:
    from derive.scalar.library import formula

    rows = [_definition(name, lecture, panel.key) for name in panel.definitions]
    rows += [_row(formula(name), complaints[name], proofs) for name in panel.formulas]
    blocks = (Section(panel.title, 1, panel.key), Para(panel.about), Display(tuple(rows)))
    return "\n".join((*map(block, blocks), _controls(panel, lecture)))


def _definition(name: str, lecture: Lecture, panel: str) -> Row:
    declared = lecture.theory.declared[name]
    assert isinstance(declared, Declared)
    said = declared.statement
    return Row(said.lhs, said.relation, said.rhs, slug(panel, "where", name), badge=declared.kind)


def _row(formula: Formula, message: str, proofs: Proofs) -> Row:
    """Show a formula; it is proved if there is no complaint."""
    defined = f"defined: {formula.defined.replace('>=', '≥')}"
    page, places = proofs
    anchor = slug("scalar", formula.step)
    link = ("; ", Link("proof", anchor, places.get(anchor, page))) if page else ()
    said = formula.statement
    return Row(
        said.lhs, said.relation, said.rhs, formula.name, badge="not proved" if message else "proved",
        reason=(defined, *link), message=message,
    )  # fmt: skip


def _complaints(panels: Sequence[Panel], accepted: frozenset[str]) -> dict[str, str]:
    """Return what keeps each formula from being proved: a step that is not accepted, a program that says otherwise."""
    from derive.scalar.formula import behind
    from derive.scalar.library import formula

    formulas = [formula(name) for panel in panels for name in panel.formulas]
    known = behind(formulas, accepted)
    return {made.name: _complaint(made, known) for made in formulas}


def _complaint(formula: Formula, known: Known) -> str:
    try:
        formula.check(known)
    except InputError as error:
        return str(error).removeprefix(f"{formula.name}: ")
    return ""


# ---------------------------------------------------------------------------------------------------- controls
def _controls(panel: Panel, lecture: Lecture) -> str:
    sliders = "".join(_slider(s, panel.key, lecture) for s in panel.sliders)
    cases = "".join(
        f'<button type="button" data-set="{escape(json.dumps(values))}">{escape(name)}</button>'
        for name, values in panel.cases.items()
    )
    values = "".join(
        f'<div><dt>{inline(label)}</dt><dd data-value="{key}"></dd> <small>{unit}</small></div>'
        for key, label, unit in panel.values
    )
    plots = "".join(
        f'<figure><svg data-plot="{key}" role="img" aria-label="" viewBox="0 0 400 276"></svg>'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
        for key, caption in panel.plots
    )
    return (
        f'<form class="panel" data-panel="{panel.key}" autocomplete="off"><div class="plots">{plots}</div>'
        f'<dl class="values">{values}</dl><p class="words" role="status"></p>'
        f"<fieldset><legend>Parameters</legend>{sliders}</fieldset>"
        f'<div class="cases" role="group" aria-label="Cases">{cases}</div></form>'
    )


def _slider(slider: Slider, panel: str, lecture: Lecture) -> str:
    anchor = f"{panel}-{slider.symbol}"
    if slider.symbol == "T":
        letter, meaning = "", "horizon"
    else:
        symbol = lecture.theory.symbols[slider.symbol]
        letter, meaning = mathml(symbol), symbol.meaning
    scale = "decades" if slider.decades else "linear"
    unit = f" <small>{slider.unit}</small>" if slider.unit else ""
    return (
        f'<div class="slider"><label for="{anchor}">{letter} {escape(meaning)}</label>'
        f'<span><output for="{anchor}"></output>{unit}</span>'
        f'<input type="range" id="{anchor}" name="{slider.symbol}" min="{slider.low}" max="{slider.high}" step="1" '
        f'value="{slider.start}" data-scale="{scale}" data-per="{slider.per}" data-unit="{slider.unit}"></div>'
    )
