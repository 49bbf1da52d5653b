"""A worked example: one plant, its modes, its error covariance over time, and every route to the steady one.

What a validation says comes in as plain data of schema lmi-validate/1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from derive.notes.figures import covariance_ellipses, deviations_over_time, eigenvalue_map
from derive.notes.model import Block, Display, Figure, Inline, Para, Row, Section, Table
from derive.numeric.plant import Plant
from derive.numeric.response import Response, covariance_ellipse, covariance_response
from derive.terms import Block as Matrix
from derive.terms import Glyph, Neg, Symbol, Term
from derive.worked_spectrum import spectrum_section

__all__ = ["worked_example"]

TINY = 1e-300

ROUTES: Mapping[str, str] = {
    "riccati": "algebraic Riccati equation, with Newton steps in extended precision",
    "lmi-primal": "largest P that satisfies the Riccati inequality",
    "lmi-dual": "the dual of that program",
    "lmi-h2": "H2 synthesis by linear matrix inequalities",
    "interior-point": "interior-point method made for the covariance program",
    "nlp": "nonlinear program for the gain",
    "integral": "integral of the logarithm of the output spectrum",
    "hamiltonian": "eigenvalues of the Hamiltonian matrix",
    "closed-form": "closed form of the scalar plant",
}


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
        Display(tuple(_given(plant, name) for name in ("A", "C", "W", "V", *("N" if plant.N.any() else "")))),
        Section("Modes", 2, f"{anchor}-modes"),
        Para(("Eigenvalues of ", A, " and, with the optimal gain, of the error matrix ", A - L * C, ":")),
        _mode_table(response),
        _mode_figure(plant, response),
        Section("Error covariance", 2, f"{anchor}-covariance"),
        Para(("The optimal gain and the steady error covariance, by the Riccati equation:",)),
        Display((_row("L", _gain(validation)), _row("P", response.steady))),
        _deviation_figure(plant, response),
        _ellipse_figure(plant, response),
        *spectrum_section(plant, validation, f"{anchor}-spectrum"),
        Section("Every route to the steady covariance", 2, f"{anchor}-routes"),
        Para((_verdict(validation),)),
        _route_table(plant, validation),
    ]


def _given(plant: Plant, name: str) -> Row:
    """Return a matrix of the plant, in discrete time with the letters of covariances."""
    shown = name if plant.is_continuous else {"W": "Q", "V": "R", "N": "S"}.get(name, name)
    return replace(_row(name, getattr(plant, name)), lhs=letter(shown))


def _row(name: str, values: Any) -> Row:
    return Row(letter(name), "=", matrix(values), f"worked-example-{name}")


def letter(name: str) -> Symbol:
    """Return a letter for the text around numbers."""
    return Symbol(name, glyph=Glyph(name))


A, C, L = map(letter, "ACL")


def matrix(values: Any) -> Matrix:
    """Return a matrix of numbers as a term that prints them in decimals."""
    return Matrix(tuple(tuple(decimal(float(value)) for value in row) for row in values))


def decimal(value: float) -> Term:
    """Return a number as a term that prints it with five significant digits."""
    text = number(abs(value))
    digits = Symbol(text, glyph=Glyph(text, upright=True))
    return Neg(digits) if value < 0 else digits


def number(value: float | None, form: str = ".5g") -> str:
    """Return a number as text, with a proper minus sign; a dash for none."""
    return "–" if value is None else f"{value:{form}}".replace("-", "−")


def mode(value: complex) -> str:
    """Return an eigenvalue as text."""
    if not abs(value.imag):
        return number(value.real)
    return f"{number(value.real)} {'−' if value.imag < 0 else '+'} {number(abs(value.imag))}j"


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
    steady = response.steady.diagonal() ** 0.5
    unit = "t [s]" if plant.is_continuous or plant.dt else "k"
    svg = deviations_over_time(response.times, response.deviations, steady, _labels(plant), unit)
    start = "P0" if plant.P0 is not None else "twice the steady value"
    caption = (f"Standard deviation of each state's error over time, from {start}; dashed, the steady values.",)
    return Figure(svg, caption, "Standard deviations of the errors over time, falling to their steady values.")


def _ellipse_figure(plant: Plant, response: Response) -> Figure:
    """Show the two states whose errors are correlated most."""
    deviations = response.deviations[-1]
    correlation = abs(response.steady) / (deviations[:, None] * deviations + TINY)
    pairs = [(i, j) for i in range(plant.n) for j in range(i)]
    first, second = max(pairs, key=lambda pair: correlation[pair], default=(0, 0))
    middle = int((response.deviations.sum(axis=1) > response.deviations[[0, -1]].sum() / 2).sum())
    curves = [
        (label, covariance_ellipse(response.covariances[k], second, first))
        for label, k in (("start", 0), (f"t = {response.times[middle]:.2g}", middle), ("steady", -1))
    ]
    labels = _labels(plant)
    svg = covariance_ellipses(curves, (labels[second], labels[first]))
    caption = ("One standard deviation of the error in the two states that are correlated most, over time.",)
    return Figure(svg, caption, "Covariance ellipses of two states, shrinking to the steady one.")


def _labels(plant: Plant) -> list[str]:
    """Return the names of the states for a drawing; x1 is set as a letter with an index."""
    return [f"$x_{{{name[1:]}}}$" if name[0] == "x" and name[1:].isdigit() else name for name in plant.states]


def _gain(validation: Mapping[str, Any]) -> Any:
    return next(route["gain"] for route in validation["routes"] if route["name"] == "riccati")


def _verdict(validation: Mapping[str, Any]) -> str:
    confirming = [
        route["name"] for route in validation["routes"]
        if "riccati" in route["independent_of"] and (route["relative_difference"] or 1.0) < 1e-6
    ]  # fmt: skip
    return (
        f"Verdict of the comparison: {validation['verdict']}. Numbers in floating point that agree are evidence, "
        f"not a proof; independent of the Riccati equation are {', '.join(confirming)}."
    )


def _route_table(plant: Plant, validation: Mapping[str, Any]) -> Table:
    output = "tr(C P C′ V⁻¹)" if plant.is_continuous else "ln det(C P C′ + R)"
    rows: list[tuple[Inline, ...]] = [
        (
            (route["name"],),
            (ROUTES.get(route["name"], ""),),
            (number(route["trace"], ".8g"),),
            (number(route["output"], ".8g"),),
            (number(route.get("output_digits"), "d"),),
            (number(route["relative_difference"], ".0e"),),
            (number(route["residual"], ".0e"),),
            (route["status"],),
        )
        for route in validation["routes"]
    ]
    head = ("route", "what it computes", "tr P", output, "digits proved", "difference", "own error", "status")
    return Table(head, tuple(rows))
