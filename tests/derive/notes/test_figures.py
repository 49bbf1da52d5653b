"""Drawings: well-formed, the same for the same arrays, different for others, and asking for nothing."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest

from derive.notes.figures import covariance_ellipses, deviations_over_time, eigenvalue_map

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


@pytest.mark.parametrize("draw", [deviations, modes, ellipses])
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


def test_the_settings_of_the_user_are_left_alone():
    before = dict(matplotlib.rcParams)
    deviations()
    assert dict(matplotlib.rcParams) == before
