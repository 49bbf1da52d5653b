"""State-space systems of other packages as plants."""

import numpy as np
import pytest
from scipy import signal

import lmi
from derive.errors import InputError
from derive.numeric.plant import plant_from_mapping
from derive.numeric.systems import plant_from_system

A, B, C, D = [[0.0, 1.0], [-2.0, -1.0]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.5]]
NOISE = {"W": np.diag([0.1, 1.0]), "V": 0.2}


def systems_of_scipy(dt):
    return signal.StateSpace(A, B, C, D) if dt is None else signal.StateSpace(A, B, C, D, dt=dt)


def systems_of_control(dt):
    return pytest.importorskip("control").ss(A, B, C, D, dt)


@pytest.mark.parametrize("make", [systems_of_scipy, systems_of_control])
@pytest.mark.parametrize(
    ("dt", "time", "period"), [(None, "continuous", None), (0.1, "discrete", 0.1), (True, "discrete", None)]
)
def test_a_system_is_the_plant_of_its_matrices(make, dt, time, period):
    plant = plant_from_system(make(dt), **NOISE, N=[[0.05], [0.1]])
    expected = plant_from_mapping({"time": time, "A": A, "B": B, "C": C, "D_u": D, **NOISE, "N": [[0.05], [0.1]]})
    for key in ("A", "B", "C", "D_u", "W", "V", "N", "M"):
        np.testing.assert_array_equal(getattr(plant, key), getattr(expected, key))
    assert (plant.time, plant.dt, plant.name) == (time, period, "system")


def test_zero_is_the_continuous_period_of_python_control():
    assert plant_from_system(systems_of_control(0), **NOISE).is_continuous


def test_names_come_along_and_may_be_given():
    control = pytest.importorskip("control")
    system = control.ss(A, B, C, D, states=["angle", "rate"], outputs=["gyro"], name="pendulum")
    plant = plant_from_system(system, **NOISE, units={"rate": "rad/s"})
    assert (plant.states, plant.outputs, plant.name) == (("angle", "rate"), ("gyro",), "pendulum")
    assert plant_from_system(system, **NOISE, states=["p", "q"]).states == ("p", "q")
    assert plant_from_system(systems_of_scipy(None), **NOISE).states == ("x1", "x2")


def test_noise_enters_with_the_input():
    system = systems_of_scipy(None)
    plant = plant_from_system(system, B_d=system.B, D_d=system.D, S_dd=3, D_r=1, S_rr=0.25)
    np.testing.assert_allclose(plant.W, [[0, 0], [0, 3]])
    np.testing.assert_allclose(plant.N, [[0], [1.5]])
    np.testing.assert_allclose(plant.V, [[1.0]])


def test_a_system_without_a_period_may_be_discrete():
    assert plant_from_system(systems_of_control(None), **NOISE, time="discrete").time == "discrete"


def test_a_system_is_validated():
    system = signal.StateSpace([[0.5]], [[1]], [[1]], [[0]], dt=True)
    validation = lmi.validate(plant_from_system(system, Q=1, R=1))
    a = 0.5  # P = a^2 P / (P + 1) + 1
    assert validation.verdict.value == "agree"
    np.testing.assert_allclose(validation.route("riccati").trace, (a**2 + np.sqrt(a**4 + 4)) / 2, rtol=1e-15)


REFUSED = {
    "transfer function": (
        signal.TransferFunction([1], [1, 2]),
        {},
        "got TransferFunctionContinuous; convert it with .to_ss()",
    ),
    "zeros and poles": (
        signal.ZerosPolesGain([], [-1], 1),
        {},
        "got ZerosPolesGainContinuous; convert it with .to_ss()",
    ),
    "a number": (3, {}, "system: expected a state-space system with A, B, C, D, got int; give a StateSpace"),
    "nothing": (None, {}, "got NoneType; give a StateSpace"),
    "A twice": (systems_of_scipy(None), {"A": A}, "A: expected from the system alone, got it as a key too; remove it"),
    "D as a key": (systems_of_scipy(None), {"D_u": D}, "D_u: expected from the system alone"),
    "another time": (systems_of_scipy(0.1), {"time": "continuous"}, "time: expected discrete, as the system's dt says"),
    "no noise": (systems_of_scipy(None), {"W": None}, "W: missing key"),
    "a bad shape": (systems_of_scipy(None), {"W": 1}, "W: expected shape (2, 2), got (1, 1)"),
    "not detectable": (signal.StateSpace([[1.0]], [[1]], [[0.0]], [[0]]), {"W": 1}, "(A, C): not detectable: mode 1 "),
}


@pytest.mark.parametrize(("system", "change", "message"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_plant_gets_one_line(system, change, message):
    with pytest.raises(InputError) as error:
        plant_from_system(system, **{**NOISE, **change})
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_transfer_functions_of_python_control_are_refused():
    control = pytest.importorskip("control")
    with pytest.raises(InputError, match=r"got TransferFunction; convert it with \.to_ss\(\)"):
        plant_from_system(control.tf([1], [1, 2]), W=1, V=1)
