"""Drawings of the notes as SVG text: the same arrays give the same bytes, and nothing is fetched to show them."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import StringIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy import complexfloating
    from numpy.typing import NDArray

__all__ = [
    "COLOURS", "as_svg", "covariance_ellipses", "deviations_over_time", "drawing", "eigenvalue_map", "spectrum_area",
]  # fmt: skip

COLOURS = ("#1a5fb4", "#c64600", "#26a269", "#813d9c", "#986a44", "#5e5c64")
STYLE: Any = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],  # the second for what the first lacks
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
    with drawing(6.4, 3.1) as (figure, axes):
        for i, label in enumerate(labels):
            colour = COLOURS[i % len(COLOURS)]
            axes.plot(times, deviations[:, i], color=colour, lw=1.8, label=label)
            axes.axhline(steady[i], color=colour, lw=0.8, ls=(0, (4, 3)))
        axes.set(xlabel=unit, ylabel="standard deviation", xlim=(times[0], times[-1]))
        axes.set_ylim(bottom=0)
        axes.legend(ncols=2)
        axes.grid(axis="y", lw=0.6)
        return as_svg(figure)


def eigenvalue_map(before: NDArray[complexfloating], after: NDArray[complexfloating], continuous: bool) -> str:
    """Draw the eigenvalues of A (crosses) and of A - L C (dots) with the boundary of stability."""
    from numpy import concatenate, cos, linspace, pi, sin

    with drawing(4.6, 3.4) as (figure, axes):
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
        return as_svg(figure)


def covariance_ellipses(ellipses: Sequence[tuple[str, NDArray[Any]]], labels: tuple[str, str]) -> str:
    """Draw covariance ellipses, each a curve of shape (k, 2), one for each instant."""
    with drawing(4.6, 3.4) as (figure, axes):
        for i, (label, points) in enumerate(ellipses):
            axes.plot(points[:, 0], points[:, 1], color=COLOURS[i % len(COLOURS)], lw=1.6, label=label)
        axes.set(xlabel=labels[0], ylabel=labels[1])
        axes.grid(lw=0.6)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return as_svg(figure)


def spectrum_area(
    frequencies: NDArray[Any],
    heights: NDArray[Any],
    blocks: Sequence[tuple[str, float]],
    total: str,
    continuous: bool = True,
) -> str:
    """Draw a spectrum as an area, and beside it, as blocks, the area and what is added to it.

    In continuous time the axis of frequency is logarithmic, so the heights have to be w times the integrand: over ln w
    their area is the integral over w. In discrete time the axis is linear, from 0 to pi.

    Args:
        frequencies: shape (k,).
        heights: shape (k,), whose area over the axis is the first block.
        blocks: label and size of each block, the first one the area; a negative one goes down.
        total: label of the sum.
        continuous: whether time is.
    """
    with drawing(7.0, 3.1, widths=(4.0, 0.75 * len(blocks) + 0.3)) as (figure, (left, right)):
        left.fill_between(frequencies, heights, color=COLOURS[0], alpha=0.25, lw=0)
        left.plot(frequencies, heights, color=COLOURS[0], lw=1.6)
        if continuous:
            left.set_xscale("log")
            left.minorticks_off()
        left.set(xlabel=r"$\omega$ [rad/s]" if continuous else r"$\omega$ [rad]", ylabel=_measure(continuous))
        left.set_xlim((frequencies[0], frequencies[-1]) if continuous else (0.0, 3.1415926535))
        _blocks(right, blocks, total)
        for axes, least, most in ((left, min(heights), max(heights)), (right, *_levels(blocks))):
            axes.set_ylim(1.15 * min(least, 0.0), 1.15 * max(most, 0.0) or 1.0)
            axes.axhline(0, color="#5d6675", lw=0.8)
        return as_svg(figure)


def _measure(continuous: bool) -> str:
    """Return the label of what has the integral as its area over the axis of frequency."""
    return r"$\omega\,\ln(\det\Phi_y/\det V)/\pi$" if continuous else r"$\ln(\det\Phi_y/\det R)/\pi$"


def _blocks(axes: Any, blocks: Sequence[tuple[str, float]], total: str) -> None:
    """Draw blocks, each from where the last one ends, and their sum."""
    level, steps = 0.0, [*blocks, (total, sum(size for _, size in blocks))]
    for i, (_, size) in enumerate(steps):
        start = 0.0 if i == len(blocks) else level
        colour = "#5e5c64" if i == len(blocks) else COLOURS[i]
        level = start + size
        axes.fill_between([i - 0.36, i + 0.36], start, level, color=colour, alpha=0.25, lw=0)
        axes.plot([i - 0.36, i + 0.36], [level, level], color=colour, lw=1.6)
        at = (i, max(start, level))
        axes.annotate(f"{size:.4g}", at, (0, 3), textcoords="offset points", ha="center", color=colour)
    axes.set_xticks(range(len(steps)), [label for label, _ in steps])
    axes.tick_params(axis="x", length=0)
    axes.set_yticks([])
    axes.spines[["left", "bottom"]].set_visible(False)


def _levels(blocks: Sequence[tuple[str, float]]) -> tuple[float, float]:
    """Return the lowest and the highest level that the blocks reach."""
    levels = [sum(size for _, size in blocks[:k]) for k in range(len(blocks) + 1)]
    return min(levels), max(levels)


@contextmanager
def drawing(
    width: float, height: float, widths: Sequence[float] = (1.0,), rows: int = 1
) -> Iterator[tuple[Figure, Any]]:
    """Draw without a display, in the style of the notes, and leave no trace in the user's settings.

    Args:
        width: of the drawing.
        height: of the drawing.
        widths: of the axes that lie side by side, relative to each other.
        rows: of axes, one above the other.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height))
        yield figure, figure.subplots(nrows=rows, ncols=len(widths), width_ratios=widths)


def as_svg(figure: Figure) -> str:
    """Return a drawing as the text of its svg element."""
    out = StringIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)  # of a name; a box is drawn
        figure.savefig(out, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    return _compact(out.getvalue()[out.getvalue().index("<svg") :])


def _compact(svg: str) -> str:
    """Drop what does not show: description, comments, white space between tags, names that nothing refers to,
    hundredths of a point, and letters in paths that say the same as the one before."""
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"\s*\n\s*(?=[^<\s])", " ", re.sub(r">\s+<", "><", svg))
    svg = re.sub(r' d="([^"]*)"', lambda path: f' d="{_short_path(path[1])}"', svg)
    svg = re.sub(r'( [xy]="-?\d+\.\d)\d+"', r'\1"', svg)
    used = set(re.findall(r"#([^\s\")]+)", svg))
    return re.sub(r' id="([^"]*)"', lambda m: m[0] if m[1] in used else "", svg)


def _short_path(path: str) -> str:
    """Return a path in tenths of a point; a line or curve after another one goes without its letter."""
    out: list[str] = []
    last = ""
    for word in re.sub(r"(\.\d)\d+", r"\1", path).split():
        if not (word == last and word in "LQC"):
            out.append(word)
        last = word if word.isalpha() else last
    return " ".join(out)
