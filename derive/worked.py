"""A worked example: one plant, its modes, its error covariance over time, and every route to the steady one.

What a validation says comes in as plain data of schema lmi-validate/1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from derive.notes.figures import covariance_ellipses, deviations_over_time, eigenvalue_map
from derive.notes.model import Block, Display, Figure, Para, Row, Section, Table
from derive.numeric.plant import Plant
from derive.numeric.response import Response, covariance_ellipse, covariance_response
from derive.worked_routes import bounds_section, convergence_section, routes_section, verdict_of
from derive.worked_simulation import simulation_section
from derive.worked_spectrum import spectrum_section
from derive.worked_values import decimal, drawn_labels, letter, matrix, mode, number, row, time_label

__all__ = ["decimal", "given", "matrix", "mode", "modes_section", "number", "response_figures", "worked_example"]

TINY = 1e-300

NAMED = 6
"""Most states whose deviations are drawn."""

A, C, L = map(letter, "ACL")


def worked_example(plant: Plant, validation: Mapping[str, Any], about: str = "") -> list[Block]:
    """Return the section of the notes on a plant.

    Args:
        plant: the plant.
        validation: what every route says about it.
        about: what to know of the plant.
    """
    response = covariance_response(plant)
    anchor = "worked-example"
    return [
        Section(f"Worked example: {plant.name}", 1, anchor),
        *([Para((about,))] if about else []),
        *([Para((f"Data: {plant.source}.",))] if plant.source else []),
        Display(tuple(given(plant, name, anchor) for name in ("A", "C", "W", "V", *("N" if plant.N.any() else "")))),
        *modes_section(plant, response, f"{anchor}-modes"),
        Section("Error covariance", 2, f"{anchor}-covariance"),
        Para(("The optimal gain and the steady error covariance, by the Riccati equation:",)),
        Display((row("L", _gain(validation), anchor), row("P", response.steady, anchor))),
        *response_figures(plant, response),
        *simulation_section(plant, validation, f"{anchor}-simulation", runs=2),
        *spectrum_section(plant, validation, f"{anchor}-spectrum"),
        *routes_section(plant, validation, f"{anchor}-routes", verdict_of(validation)),
        *convergence_section(plant, validation, f"{anchor}-convergence"),
        *bounds_section(plant, validation, f"{anchor}-bounds"),
    ]


def given(plant: Plant, name: str, anchor: str) -> Row:
    """Return a matrix of the plant, in discrete time with the letters of covariances."""
    shown = name if plant.is_continuous else {"W": "Q", "V": "R", "N": "S"}.get(name, name)
    return replace(row(name, getattr(plant, name), anchor), lhs=letter(shown))


def modes_section(plant: Plant, response: Response, anchor: str) -> list[Block]:
    """Return the eigenvalues of A and of A - L C, as a table and on a map."""
    return [
        Section("Modes", 2, anchor),
        Para(("Eigenvalues of ", A, " and, with the optimal gain, of the error matrix ", A - L * C, ":")),
        _mode_table(response),
        _mode_figure(plant, response),
    ]


def response_figures(plant: Plant, response: Response) -> list[Block]:
    """Return the covariance over time: standard deviations, and ellipses of two states."""
    ellipses = [_ellipse_figure(plant, response)] if plant.n > 1 else []
    return [_deviation_figure(plant, response), *ellipses]


def _mode_table(response: Response) -> Table:
    def ordered(values: Iterable[complex]) -> list[complex]:
        return sorted(values, key=lambda z: (-z.real, -z.imag))

    pairs = zip(ordered(response.open_loop), ordered(response.closed_loop), strict=True)
    return Table(("A", "A − L C"), tuple(((mode(a),), (mode(b),)) for a, b in pairs))


def _mode_figure(plant: Plant, response: Response) -> Figure:
    svg = eigenvalue_map(response.open_loop, response.closed_loop, plant.is_continuous)
    caption = ("Eigenvalues of ", A, " (crosses) and of ", A - L * C, " (dots), with the boundary of stability.")
    return Figure(svg, caption, "Eigenvalues of A and of A - L C in the complex plane.")


def _deviation_figure(plant: Plant, response: Response) -> Figure:
    shown = min(plant.n, NAMED)
    steady = response.steady.diagonal()[:shown].clip(min=0.0) ** 0.5
    labels = drawn_labels(plant)[:shown]
    svg = deviations_over_time(response.times, response.deviations[:, :shown], steady, labels, time_label(plant))
    start = "P0" if plant.P0 is not None else "twice the steady value"
    some = f" The first {shown} of {plant.n} states." if shown < plant.n else ""
    caption = (f"Standard deviation of each state's error over time, from {start}; dashed, the steady values.{some}",)
    return Figure(svg, caption, "Standard deviations of the errors over time, falling to their steady values.")


def _ellipse_figure(plant: Plant, response: Response) -> Figure:
    """Show the two states whose errors are correlated most."""
    deviations = response.deviations[-1]
    correlation = abs(response.steady) / (deviations[:, None] * deviations + TINY)
    pairs = [(i, j) for i in range(plant.n) for j in range(i)]
    first, second = max(pairs, key=lambda pair: correlation[pair])
    middle = int((response.deviations.sum(axis=1) > response.deviations[[0, -1]].sum() / 2).sum())
    start, later = (response.covariances[k] for k in (0, middle))
    instants = (("start", start), (f"t = {response.times[middle]:.2g}", later), ("steady", response.steady))
    curves = [(label, covariance_ellipse(P, second, first)) for label, P in instants]
    labels = drawn_labels(plant)
    svg = covariance_ellipses(curves, (labels[second], labels[first]))
    caption = ("One standard deviation of the error in the two states that are correlated most, over time.",)
    return Figure(svg, caption, "Covariance ellipses of two states, shrinking to the steady one.")


def _gain(validation: Mapping[str, Any]) -> Any:
    return next(route["gain"] for route in validation["routes"] if route["name"] == "riccati")
