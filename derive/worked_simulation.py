"""The simulated error in the notes: paths within their bands, standard deviations beside the sampled ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from derive.notes.figures_validation import error_bands
from derive.notes.model import Block, Figure, Para, Section, Table
from derive.numeric.plant import Plant
from derive.numeric.simulation import error_paths
from derive.worked_values import drawn_labels, number, proper, time_label, unit_of

__all__ = ["deviation_table", "simulation_section"]

PANELS = 6
"""Most states whose errors are drawn."""


def simulation_section(plant: Plant, validation: Mapping[str, Any], anchor: str, runs: int = 3) -> list[Block]:
    """Return simulated errors of some runs over time within three standard deviations, or why there are none."""
    start = Section("Simulated error", 2, anchor)
    riccati = validation["routes"][0]
    if validation["covariance"] is None or riccati["gain"] is None:
        return [start, Para(("There is no covariance and no gain to simulate.",))]
    deviations = np.sqrt(np.maximum(np.diag(validation["covariance"]), 0.0))
    paths = error_paths(plant, np.array(riccati["gain"]), deviations, runs)
    if paths is None:
        status = next((r["status"] for r in validation["routes"] if r["name"] == "simulation"), "not applicable")
        return [start, Para((f"Simulation is {proper(status)}.",))]
    shown = min(plant.n, PANELS)
    labels = drawn_labels(plant)[:shown]
    svg = error_bands(paths.times, paths.errors[:, :, :shown], deviations[:shown], labels, time_label(plant))
    some = f" The first {shown} of {plant.n} states." if shown < plant.n else ""
    caption = (
        f"Errors of {runs} simulated runs that start without error, and plus and minus three steady standard "
        f"deviations (dashed). After the start {100 * paths.inside:.2f} % of the errors are within; "
        f"99.73 % are expected.{some}"
    )
    return [start, Figure(svg, (caption,), "Simulated errors over time, almost all within three standard deviations.")]


def deviation_table(plant: Plant, validation: Mapping[str, Any]) -> Table:
    """Return the standard deviation of each state's error: computed, after the measurement, and as it was sampled."""
    filtered = validation["filter"]
    sample = next((r["sample"] for r in validation["routes"] if r["sample"] is not None), None)
    head = ["state", "standard deviation"]
    head += ["after the measurement"] if filtered else []
    head += ["sampled, 99.9 % interval"] if sample else []
    rows: list[tuple[tuple[str], ...]] = []
    for i, name in enumerate(plant.states):
        unit = unit_of(plant, name)
        cells = [f"{name} [{unit}]" if unit else name, _root(validation["covariance"][i][i])]
        cells += [_root(filtered["covariance"][i][i])] if filtered else []
        cells += [" to ".join(map(_root, sample["variance_intervals"][i]))] if sample else []
        rows.append(tuple((cell,) for cell in cells))
    return Table(tuple(head), tuple(rows))


def _root(variance: float | None) -> str:
    return number(None if variance is None else max(variance, 0.0) ** 0.5)
