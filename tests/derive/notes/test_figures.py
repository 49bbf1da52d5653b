"""Drawings: well-formed, the same for the same arrays, different for others, and asking for nothing."""

from __future__ import annotations

import re
from itertools import pairwise
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest

import derive.notes.figures as figures
from derive.notes.figures import covariance_ellipses, deviations_over_time, eigenvalue_map, spectrum_area

TIMES = np.linspace(0.0, 4.0, 50)
FALLING = np.exp(-TIMES)[:, None] * [1.0, 2.0] + [0.5, 1.0]
CIRCLE = np.column_stack([np.cos(TIMES), np.sin(TIMES)])
MODES = np.array([-1 + 1j, -1 - 1j, 0.5 + 0j])


def deviations(scale=1.0):
    return deviations_over_time(TIMES, scale * FALLING, scale * np.array([0.5, 1.0]), ["$x_1$", "$x_2$"], "t [s]")


def modes(scale=1.0, continuous=True):
    return eigenvalue_map(MODES, scale * MODES - 2, continuous)


def ellipses(scale=1.0):
    return covariance_ellipses([("start", 2 * scale * CIRCLE), ("steady", CIRCLE)], ("$x_1$", "$x_2$"))


BLOCKS = [("area", 1.0), ("unstable\npoles", 0.5)]


def spectrum(scale=1.0, blocks=BLOCKS, continuous=True):
    return spectrum_area(TIMES[1:], scale * FALLING[1:, 0], blocks, "sum", continuous)


@pytest.mark.parametrize("draw", [deviations, modes, ellipses, spectrum])
def test_a_drawing_is_whole_and_repeats_itself(draw):
    svg = draw()
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert draw() == svg
    assert draw(1.5) != svg
    assert not re.search(r'(href|src)="(?!#)', svg)
    assert "<script" not in svg
    assert "<date" not in svg
    assert len(svg) < 60_000


def test_the_boundary_of_stability_is_a_line_or_a_circle():
    assert modes(continuous=True).count("#b3261e") == modes(continuous=False).count("#b3261e") == 1
    assert modes(continuous=True) != modes(continuous=False)


def test_the_axis_of_frequency_is_logarithmic_in_continuous_time_alone(monkeypatch):
    scales = []
    monkeypatch.setattr(figures, "as_svg", lambda figure: scales.append([axes.get_xscale() for axes in figure.axes]))
    spectrum()
    spectrum(continuous=False)
    assert scales == [["log", "linear"], ["linear", "linear"]]


@pytest.mark.parametrize(
    ("sizes", "texts", "limits"),
    [
        ((1.0, 0.5), ["1", "0.5", "1.5"], (0, 1.5)),
        ((0.0, 0.0), ["0", "0", "0"], (0, 0)),
        ((-1.0, 3.0, 0.25), ["-1", "3", "0.25", "2.25"], (-1, 2.25)),
        ((2.0, 0.0, -2.5), ["2", "0", "-2.5", "-0.5"], (-0.5, 2)),
    ],
)
def test_blocks_stand_on_each_other_and_the_sum_on_the_ground(sizes, texts, limits, monkeypatch):
    drawn = []
    monkeypatch.setattr(figures, "as_svg", lambda figure: drawn.append(figure.axes[1]))
    spectrum(blocks=[(str(i), size) for i, size in enumerate(sizes)])
    (axes,) = drawn
    assert [text.get_text() for text in axes.texts] == texts
    bottoms = [
        (patch.get_paths()[0].vertices[:, 1].min(), patch.get_paths()[0].vertices[:, 1].max())
        for patch in axes.collections
    ]
    levels = [0.0, *np.cumsum(sizes)]
    expected = [*pairwise(levels), (0.0, levels[-1])]
    np.testing.assert_allclose(bottoms, [sorted(pair) for pair in expected], atol=1e-12)
    low, high = axes.get_ylim()
    assert low <= limits[0] <= limits[1] < high


def test_the_settings_of_the_user_are_left_alone():
    before = dict(matplotlib.rcParams)
    deviations()
    assert dict(matplotlib.rcParams) == before
