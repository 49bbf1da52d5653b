"""What every route says of a plant, how it got there, and what is proved: tables and drawings from plain data.

The data are those of a validation, schema lmi-validate/1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from derive.notes.figures_validation import Running, convergence
from derive.notes.model import Block, Figure, Inline, Para, Section, Table
from derive.numeric.plant import Plant
from derive.worked_values import number, proper, spread

__all__ = ["bounds_section", "convergence_section", "is_weighted", "routes_section", "verdict_of"]

Route = Mapping[str, Any]

ROUTES: Mapping[str, str] = {
    "riccati": "algebraic Riccati equation, with Newton steps in extended precision",
    "lmi-primal": "largest P that satisfies the Riccati inequality",
    "lmi-dual": "the dual of that program",
    "lmi-h2": "H2 synthesis by linear matrix inequalities",
    "interior-point": "interior-point method made for the covariance program",
    "nlp": "nonlinear program for the gain",
    "integral": "integral of the logarithm of the output spectrum",
    "hamiltonian": "eigenvalues of the Hamiltonian matrix",
    "closed-form": "closed form for up to three states",
    "simulation": "sample covariance of the error, simulated with the gain of the Riccati equation",
}

SHOWN = 30
"""Most variances whose bounds are listed."""

DOUBTS: Mapping[bool | None, str] = {
    True: "",
    False: " The noise matrix is not exactly semidefinite: P is the greatest Riccati solution, and no covariance.",
    None: " The noise matrix is too large to decide whether it is semidefinite, and P a covariance.",
}


def verdict_of(validation: Mapping[str, Any]) -> str:
    """Return the verdict with its reason."""
    return f"Verdict of the comparison: {validation['verdict']}: {proper(validation['reason'])}. "


def routes_section(plant: Plant, validation: Mapping[str, Any], anchor: str, verdict: str = "") -> list[Block]:
    """Return the table of routes, the reasons of those that give none, and what each of them computes."""
    routes: Sequence[Route] = validation["routes"]
    reasons = [Para((f"{route['name']}: {proper(route['status'])}.",)) for route in routes if ":" in route["status"]]
    return [
        Section("Every route to the steady covariance", 2, anchor),
        Para((f"{verdict}Numbers in floating point that agree are evidence, not a proof.",)),
        _results(plant, validation),
        *reasons,
        _methods(routes),
    ]


def _results(plant: Plant, validation: Mapping[str, Any]) -> Table:
    weighted = is_weighted(plant)
    output = "tr(C P C′ V⁻¹)" if plant.is_continuous else "ln det(C P C′ + R)"
    rows: list[tuple[Inline, ...]] = [
        tuple(
            (cell,)
            for cell in (
                f"{i} {route['name']}",
                _value(route, weighted),
                number(route["output"], ".6g"),
                number(route["output_digits"], "d"),
                number(route["difference"], ".0e"),
                number(route["residual"], ".0e"),
                route["status"].partition(":")[0],
                number(route["seconds"], ".2f"),
            )
        )
        for i, route in enumerate(validation["routes"], start=1)
    ]
    value = "tr(M P)" if weighted else "tr P"
    head = ("route", value, output, "digits proved", "difference", "own error", "status", "s")
    about = (
        "Differences are relative and from the enclosure, that is proved bounds of the error, or from the Riccati "
        "equation where nothing is enclosed; a sampled value comes with its 99.9 % interval."
    )
    return Table(head, tuple(rows), (about,))


def is_weighted(plant: Plant) -> bool:
    """Tell whether tr(M P) is something else than tr P."""
    return bool((np.eye(plant.n) != plant.M).any())


def _value(route: Route, weighted: bool) -> str:
    value, interval = route["cost" if weighted else "trace"], route["interval"]
    if interval is None or value is None:
        return number(value, ".6g")
    return spread(value, value - (route["sample"]["cost_interval"] if weighted else interval)[0])


def _methods(routes: Sequence[Route]) -> Table:
    numbers = {route["name"]: i for i, route in enumerate(routes, start=1)}
    rows = [
        (
            f"{numbers[route['name']]} {route['name']}",
            ROUTES.get(route["name"], ""),
            _drawn_together(numbers[name] for name in route["independent_of"] if name in numbers),
        )
        for route in routes
    ]
    return Table(
        ("route", "what it computes", "independent of"),
        tuple(tuple((cell,) for cell in row) for row in rows),
        ("Routes that share no computation with each other but the plant's data.",),
    )


def _drawn_together(numbers: Iterator[int]) -> str:
    """Return numbers with runs of three or more drawn together: 2–4, 6, 7, 9."""
    runs = [list(group) for _, group in groupby(enumerate(sorted(numbers)), lambda pair: pair[1] - pair[0])]
    ends = [(run[0][1], run[-1][1]) for run in runs]
    return ", ".join(f"{a}–{b}" if b > a + 1 else f"{a}, {b}" if b > a else f"{a}" for a, b in ends)


# ------------------------------------------------------------------------------------------------ what is proved
def bounds_section(plant: Plant, validation: Mapping[str, Any], anchor: str) -> list[Block]:
    """Return what the certificate proves: bounds of the traces and of each variance."""
    bounds = validation["bounds"]
    start = Section("What is proved", 2, anchor)
    if bounds is None:
        return [start, Para((f"There is no certificate: {proper(validation['certificate_status'])}.",))]
    rows = [("tr P", *bounds["trace"])]
    rows += [("tr(M P)", *bounds["cost"])] if is_weighted(plant) else []
    listed = list(zip(plant.states, bounds["variances"], strict=True))[:SHOWN]
    rows += [(f"variance of {name}", *ends) for name, ends in listed]
    table = Table(
        ("", "at least", "at most"), tuple(tuple((cell.replace("-", "−") if i else cell,) for i, cell in enumerate(row))
                                           for row in rows)
    )  # fmt: skip
    left_out = f" The first {SHOWN} of {plant.n} variances are shown." if plant.n > SHOWN else ""
    text = (
        "An exact certificate, decided in integers: no gain that stabilises has less than the lower bounds, and the "
        f"optimum is at most the upper ones. Decimals are rounded outwards.{left_out}{DOUBTS[bounds['is_covariance']]}"
    )
    return [start, Para((text,)), table]


# ------------------------------------------------------------------------------------------------ convergence
def convergence_section(plant: Plant, validation: Mapping[str, Any], anchor: str) -> list[Block]:
    """Return how each solver got to its answer."""
    routes: Sequence[Route] = validation["routes"]
    blocks: list[Block] = [Section("Convergence of each solver", 2, anchor), _steps(routes)]
    curves = [(route["name"], kept) for route in routes if np.isfinite(kept := _positive(route["history"])).sum() > 1]
    running, target = _running(routes), routes[0]["cost"]
    running = running if target is not None else []
    if curves or running:
        svg = convergence(curves, running, target or 0.0, "tr(MP)" if is_weighted(plant) else "tr P")
        about = "What was left to do after each step, and sampled values over the number of runs."
        blocks.append(Figure(svg, (_about(curves, running),), about))
    return blocks


def _about(curves: Sequence[Any], running: Sequence[Any]) -> str:
    left = "what was left after each step: relative gap and residuals, or cost above the least"
    right = "the sampled value and its 99.9 % interval over the number of runs"
    parts = [text for text, shown in ((left, curves), (right, running)) if shown]
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _positive(history: Sequence[float | None]) -> list[float]:
    """Return what a logarithmic axis can show; not a number stands for what it cannot."""
    return [value if value is not None and value > 0 else np.nan for value in history]


def _running(routes: Sequence[Route]) -> list[Running]:
    samples = [route["sample"]["running"] for route in routes if route["sample"] is not None]
    points = [(x["runs"], x["cost"], *x["interval"]) for sample in samples for x in sample]
    return [point for point in points if None not in point]


def _steps(routes: Sequence[Route]) -> Table:
    forms = {"iterations": "d", "residual": ".0e", "seconds": ".2f"}
    rows: list[tuple[Inline, ...]] = [
        ((route["name"],), *((number(route[key], form),) for key, form in forms.items()))
        for route in routes
        if route["iterations"] is not None
    ]
    return Table(("solver", "steps", "own error", "s"), tuple(rows))
