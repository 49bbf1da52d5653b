"""Coordinates in which a covariance is the identity, in extended precision."""

import numpy as np
import pytest

from derive.numeric.gain_frame import Frame
from derive.numeric.lyapunov import error_covariance
from derive.numeric.normal import normal_form
from derive.numeric.stabilise import stabilising_gain
from tests.derive.numeric.plants import random_plant

TIMES = ["continuous", "discrete"]


@pytest.mark.parametrize("time", TIMES)
def test_the_inverse_is_one_to_extended_precision(time):
    frame = Frame.of(normal_form(random_plant(time, 5, 2, seed=1)))
    rng = np.random.default_rng(0)
    for _ in range(2):
        G = rng.standard_normal((5, 5)) * 10.0 ** -np.arange(5)
        frame = frame.sharpened(G @ G.T)
    assert np.abs(frame.R @ frame.T - np.eye(5)).max() < 1e-17 * np.abs(frame.R).max() * np.abs(frame.T).max()


@pytest.mark.parametrize("time", TIMES)
def test_covariances_are_those_of_the_plant_in_new_coordinates(time):
    frame = Frame.of(normal_form(random_plant(time, 4, 2, seed=1)))
    F, C, W = frame.matrices()
    K = stabilising_gain(F, C, time)
    P = frame.covariance(K)
    np.testing.assert_allclose(P.astype(float), error_covariance(F, C, W, np.eye(2), np.zeros((4, 2)), K, time), 1e-9)
    sharper = frame.sharpened(P)
    np.testing.assert_allclose(sharper.covariance(sharper.R @ K).astype(float), np.eye(4), atol=1e-9)
    K = K.astype(np.longdouble)
    loop = frame.F - K @ frame.C
    moved = loop @ P + P @ loop.T if time == "continuous" else loop @ P @ loop.T - P
    assert np.abs(moved + frame.W + K @ K.T).max() < 3e-18 * np.abs(P).max()


@pytest.mark.parametrize("time", TIMES)
def test_a_gain_that_does_not_stabilise_has_no_covariance(time):
    frame = Frame.of(normal_form(random_plant(time, 4, 2, seed=1)))
    F, C, _ = frame.matrices()
    for K in (100 * F @ np.linalg.pinv(C), np.full((4, 2), np.inf)):
        assert np.isnan(frame.covariance(K).astype(float)).all()
