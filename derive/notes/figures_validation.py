"""Drawings of a validation: simulated errors within their bands, and how each solver converged."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

from derive.notes.figures import COLOURS, as_svg, drawing

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Running", "convergence", "error_bands"]

POINTS = 160
"""Most points of a curve."""

Running = tuple[int, float, float, float]
"""A number of runs, the estimate from them, and the ends of its interval."""


def error_bands(
    times: NDArray[Any], errors: NDArray[Any], deviations: NDArray[Any], labels: Sequence[str], unit: str
) -> str:
    """Draw simulated errors over time, one panel a state, within plus and minus three standard deviations.

    Args:
        times: instants, shape (k,).
        errors: shape (runs, k, m).
        deviations: steady standard deviations, shape (m,).
        labels: one a state, mathematics allowed.
        unit: label of the time axis.
    """
    count = len(labels)
    wide, step = min(count, 2), ceil(len(times) / POINTS)
    rows = ceil(count / wide)
    with drawing(7.2 if wide > 1 else 5.6, 0.5 + 1.75 * rows, (1.0,) * wide, rows) as (figure, grid):
        every = list(grid.flat) if count > 1 else [grid]
        for i, (axes, label) in enumerate(zip(every, labels, strict=False)):
            _band(axes, times, float(deviations[i]))
            for run, path in enumerate(errors[:, ::step, i]):
                axes.plot(times[::step], path, color=COLOURS[run % len(COLOURS)], lw=0.7)
            axes.set_ylabel(label)
            axes.set_xlim(times[0], times[-1])
            if i >= count - wide:
                axes.set_xlabel(unit)
        for axes in every[count:]:
            axes.set_visible(False)
        figure.subplots_adjust(hspace=0.35, wspace=0.32)
        return as_svg(figure)


def _band(axes: Any, times: NDArray[Any], deviation: float) -> None:
    """Draw the band of three standard deviations and what is a little outside of it."""
    axes.axhspan(-3 * deviation, 3 * deviation, color=COLOURS[0], alpha=0.09, lw=0)
    for end in (-3, 3):
        axes.axhline(end * deviation, color=COLOURS[0], lw=0.9, ls=(0, (4, 3)))
    if deviation > 0:
        axes.set_ylim(-4.2 * deviation, 4.2 * deviation)
    axes.locator_params(axis="y", nbins=5)


def convergence(
    curves: Sequence[tuple[str, Sequence[float]]], running: Sequence[Running], target: float, cost: str
) -> str:
    """Draw what was left to do after each step of the solvers that tell, and a sampled value over the number of runs.

    Args:
        curves: name of a solver, and what was left before its first step and after each one; positive.
        running: estimates from more and more runs, or none.
        target: what the estimates should tend to.
        cost: what is estimated.
    """
    wide = bool(curves) + bool(running)
    with drawing(3.6 * wide, 2.9, (1.0,) * wide) as (figure, grid):
        panels = list(grid) if wide > 1 else [grid]
        if curves:
            _curves(panels[0], curves)
        if running:
            _running(panels[-1], running, target)
            panels[-1].set_ylabel(cost)
        figure.subplots_adjust(wspace=0.36)
        return as_svg(figure)


def _curves(axes: Any, curves: Sequence[tuple[str, Sequence[float]]]) -> None:
    for i, (name, values) in enumerate(curves):
        axes.plot(range(len(values)), values, "o-", color=COLOURS[i % len(COLOURS)], lw=1.3, ms=3.5, label=name)
    axes.set_yscale("log")
    axes.minorticks_off()
    axes.set(xlabel="step", ylabel="left to do")
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.grid(axis="y", lw=0.6)
    axes.legend()


def _running(axes: Any, running: Sequence[Running], target: float) -> None:
    runs, values = [r for r, *_ in running], [value for _, value, *_ in running]
    below = [value - lower for _, value, lower, _ in running]
    above = [upper - value for _, value, _, upper in running]
    axes.axhline(target, color=COLOURS[1], lw=1.2, ls=(0, (4, 3)), label="Riccati equation")
    axes.errorbar(runs, values, (below, above), fmt="o", color=COLOURS[0], ms=4, lw=1.2, capsize=3, label="simulation")
    axes.set_xscale("log", base=2)
    axes.minorticks_off()
    named = {runs[-1], *(r for r in runs[::2] if r < runs[-1] / 3)}
    axes.set_xticks(runs, [str(r) if r in named else "" for r in runs])
    axes.set_xlabel("runs")
    axes.legend()
