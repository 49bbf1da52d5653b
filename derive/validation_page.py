"""A validation as a page of its own: one HTML file with its figures in it, that needs no network and no script.

What the validation says comes in as plain data of schema lmi-validate/1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from derive.errors import InputError
from derive.files import check_place, write
from derive.notes.html import html
from derive.notes.model import Block, Display, Document, Para, Section, Table
from derive.numeric.plant import Plant
from derive.numeric.response import covariance_response
from derive.worked import given, modes_section, response_figures
from derive.worked_routes import bounds_section, convergence_section, is_weighted, routes_section
from derive.worked_simulation import deviation_table, simulation_section
from derive.worked_spectrum import spectrum_section
from derive.worked_values import letter, proper, row, unit_of

__all__ = ["check_page", "validation_page", "write_page"]

SUFFIX = ".html"
LARGEST = 8
"""Rows or columns of a matrix up to which it is printed."""

L, P, L_F, P_PLUS = letter("L"), letter("P"), letter("L", "f"), letter("P", "+")

NUMERICAL_ERRORS = (ArithmeticError, RuntimeError, ValueError)

STYLE = """
body{max-width:60rem}
.count{border-left:4px solid var(--hyp);background:var(--hypb);color:var(--fg);border-radius:6px;padding:.5rem .9rem;
font-weight:400;margin:1rem 0}.count b{text-transform:uppercase;letter-spacing:.04em;color:var(--hyp)}
.count:has(.agree){border-color:var(--ok);background:var(--okb)}.count .agree{color:var(--ok)}
.count:has(.disagree){border-color:var(--bad);background:var(--badb)}.count .disagree{color:var(--bad)}
td{white-space:nowrap}.eqs .row{padding:.3rem 0}
"""


def check_page(path: Path) -> None:
    """Check that a page can be written there, before long work.

    Raises:
        InputError: another suffix than .html, no such folder, or a folder of that name.
    """
    if path.suffix != SUFFIX:
        raise InputError(f"{path}: expected a file ending in {SUFFIX}, got {path.suffix or 'no suffix'!r}; rename it")
    check_place(path)


def write_page(path: Path, plant: Plant, validation: Mapping[str, Any]) -> None:
    """Write the page under a temporary name and rename it.

    Raises:
        InputError: the file cannot be written.
    """
    check_page(path)
    write(path, html(validation_page(plant, validation), lead=verdict(validation), style=STYLE))


def verdict(validation: Mapping[str, Any]) -> str:
    """Return the verdict with its reason, in HTML."""
    word = validation["verdict"]
    return f'<b class="{word}">{word}</b> {escape(proper(validation["reason"]))}'


def validation_page(plant: Plant, validation: Mapping[str, Any]) -> Document:
    """Return the page: the plant, every route, what is proved, gain and covariance, modes, errors, spectrum.

    Args:
        plant: the plant.
        validation: what every route says about it, schema lmi-validate/1.
    """
    blocks: list[Block] = [
        *_plant(plant),
        *routes_section(plant, validation, "routes"),
        *bounds_section(plant, validation, "proved"),
        *_covariance(plant, validation),
        *_drawn("Modes and covariance over time", "response", lambda: _response(plant)),
        *_drawn("Simulated error", "simulation", lambda: simulation_section(plant, validation, "simulation")),
        *_drawn("Output spectrum", "spectrum", lambda: spectrum_section(plant, validation, "spectrum")),
        *convergence_section(plant, validation, "convergence"),
    ]
    sizes = f"{plant.time} time, states {plant.n}, outputs {plant.l}"
    source = f". Data: {plant.source}" if plant.source else ""
    return Document(f"Validation of {plant.name}", (f"{sizes}{source}.",), tuple(blocks))


def _drawn(title: str, anchor: str, build: Callable[[], list[Block]]) -> list[Block]:
    """Return a section, or why there is none: what cannot be drawn of a plant takes nothing else with it."""
    try:
        return build()
    except NUMERICAL_ERRORS as error:
        return [Section(title, 2, anchor), Para((f"Not drawn: {error}.",))]


def _plant(plant: Plant) -> list[Block]:
    names = ("A", "C", "W", "V", *("N" if plant.N.any() else ""), *("M" if is_weighted(plant) else ""))
    blocks: list[Block] = [Section("Plant", 2, "plant")]
    if max(plant.n, plant.l) > LARGEST:
        blocks.append(Para((f"Its matrices of {plant.n} states and {plant.l} outputs are in the plant's file.",)))
    else:
        blocks.append(Display(tuple(given(plant, name, "plant") for name in names)))
    signals = [("state", name) for name in plant.states] + [("output", name) for name in plant.outputs]
    if plant.units:
        rows = tuple(((kind,), (name,), (unit_of(plant, name) or "–",)) for kind, name in signals)
        blocks.append(Table(("", "name", "unit"), rows))
    return blocks


def _covariance(plant: Plant, validation: Mapping[str, Any]) -> list[Block]:
    covariance, gain, filtered = validation["covariance"], validation["routes"][0]["gain"], validation["filter"]
    start = Section("Gain and covariance", 2, "covariance")
    if covariance is None or gain is None:
        return [start, Para(("The Riccati equation gave none.",))]
    rows = [row("L", gain, "covariance"), row("P", covariance, "covariance")]
    if filtered:
        rows += [row("L", filtered["gain"], "covariance", "f"), row("P", filtered["covariance"], "covariance", "+")]
    if max(plant.n, plant.l) > LARGEST:
        return [
            start,
            Para(("They are in the report as JSON; here the deviations.",)),
            deviation_table(plant, validation),
        ]
    text = ["By the Riccati equation: the gain ", L, " of the observer and the steady covariance ", P, " of its error"]
    text += ["; with the measurement of the same instant, the filter's ", L_F, " and ", P_PLUS] if filtered else []
    return [start, Para((*text, ".")), Display(tuple(rows)), deviation_table(plant, validation)]


def _response(plant: Plant) -> list[Block]:
    response = covariance_response(plant)
    over_time = Section("Covariance over time", 2, "response")
    return [*modes_section(plant, response, "modes"), over_time, *response_figures(plant, response)]
