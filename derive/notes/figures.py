"""Drawings of the notes as SVG text: the same arrays give the same bytes, and nothing is fetched to show them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import StringIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy import complexfloating
    from numpy.typing import NDArray

__all__ = ["covariance_ellipses", "deviations_over_time", "eigenvalue_map"]

COLOURS = ("#1a5fb4", "#c64600", "#26a269", "#813d9c", "#986a44", "#5e5c64")
STYLE: Any = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#5d6675",
    "axes.linewidth": 0.8,
    "xtick.color": "#5d6675",
    "ytick.color": "#5d6675",
    "grid.color": "#e4e7ec",
    "legend.frameon": False,
    "svg.fonttype": "path",
    "svg.hashsalt": "derive",
    "path.simplify_threshold": 0.3,
}


def deviations_over_time(
    times: NDArray[Any], deviations: NDArray[Any], steady: NDArray[Any], labels: Sequence[str], unit: str = "t"
) -> str:
    """Draw the standard deviations of the error over time, and the steady values they tend to.

    Args:
        times: instants, shape (k,).
        deviations: square roots of the variances, shape (k, n).
        steady: their limits, shape (n,).
        labels: one a state, mathematics allowed.
        unit: label of the time axis.
    """
    with _drawing(6.4, 3.1) as (figure, axes):
        for i, label in enumerate(labels):
            colour = COLOURS[i % len(COLOURS)]
            axes.plot(times, deviations[:, i], color=colour, lw=1.8, label=label)
            axes.axhline(steady[i], color=colour, lw=0.8, ls=(0, (4, 3)))
        axes.set(xlabel=unit, ylabel="standard deviation", xlim=(times[0], times[-1]))
        axes.set_ylim(bottom=0)
        axes.legend(ncols=2)
        axes.grid(axis="y", lw=0.6)
        return _svg(figure)


def eigenvalue_map(before: NDArray[complexfloating], after: NDArray[complexfloating], continuous: bool) -> str:
    """Draw the eigenvalues of A (crosses) and of A - L C (dots) with the boundary of stability."""
    from numpy import concatenate, cos, linspace, pi, sin

    with _drawing(4.6, 3.4) as (figure, axes):
        axes.axhline(0, color="#e4e7ec", lw=0.8, zorder=0)
        if continuous:
            axes.axvline(0, color="#b3261e", lw=1.1)
        else:
            angle = linspace(0, 2 * pi, 181)
            axes.plot(cos(angle), sin(angle), color="#b3261e", lw=1.1)
            axes.set_aspect("equal")
        axes.plot(before.real, before.imag, "x", color="#5e5c64", ms=8, mew=1.8, label="$A$")
        axes.plot(after.real, after.imag, "o", color=COLOURS[0], ms=6, label="$A-LC$")
        every = concatenate([before, after])
        pad = 0.08 * max(float(abs(every).max()), 1e-9)
        if continuous:
            axes.set_xlim(float(every.real.min()) - pad, max(float(every.real.max()), 0.0) + pad)
            top = float(abs(every.imag).max()) + pad
            axes.set_ylim(-top, top)
        axes.set(xlabel="real part", ylabel="imaginary part")
        axes.legend()
        return _svg(figure)


def covariance_ellipses(ellipses: Sequence[tuple[str, NDArray[Any]]], labels: tuple[str, str]) -> str:
    """Draw covariance ellipses, each a curve of shape (k, 2), one for each instant."""
    with _drawing(4.6, 3.4) as (figure, axes):
        for i, (label, points) in enumerate(ellipses):
            axes.plot(points[:, 0], points[:, 1], color=COLOURS[i % len(COLOURS)], lw=1.6, label=label)
        axes.set(xlabel=labels[0], ylabel=labels[1])
        axes.grid(lw=0.6)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return _svg(figure)


@contextmanager
def _drawing(width: float, height: float) -> Iterator[tuple[Figure, Any]]:
    """Draw without a display, in the style of the notes, and leave no trace in the user's settings."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height))
        yield figure, figure.subplots()


def _svg(figure: Figure) -> str:
    out = StringIO()
    figure.savefig(out, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    return _compact(out.getvalue()[out.getvalue().index("<svg") :])


def _compact(svg: str) -> str:
    """Drop what does not show: description, comments, white space between tags, names that nothing refers to."""
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"\s*\n\s*(?=[^<\s])", " ", re.sub(r">\s+<", "><", svg))
    used = set(re.findall(r"#([^\s\")]+)", svg))
    return re.sub(r' id="([^"]*)"', lambda m: m[0] if m[1] in used else "", svg)
