"""A regulator's problem read as the dual observer's: the same numbers transposed, errors in the regulator's words."""

import json

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are, solve_discrete_are

from derive.errors import InputError
from derive.numeric.dual import dual_from_mapping, load_dual
from derive.numeric.riccati import solve_riccati

GOOD = {
    "time": "continuous",
    "A": [[0.0, 1.0], [2.0, -1.0]],
    "B": [[0.0], [1.0]],
    "Q": [[2.0, 0.3], [0.3, 1.0]],
    "R": 0.5,
}

BAD = {
    "no input matrix": ({"B": None}, "B: missing key, expected the input matrix"),
    "no weight": ({"R": None}, "R: missing key, expected the weight of the inputs"),
    "rows of B": ({"B": [[1.0]]}, r"B: expected shape \(2, any\), got \(1, 1\)"),
    "shape of R": ({"R": np.eye(2)}, r"R: expected shape \(1, 1\), got \(2, 2\); states are counted by A, inputs by B"),
    "transposed S": ({"S": [[0.1, 0.1]]}, r"S: expected shape \(2, 1\), got \(1, 2\); transpose it"),
    "asymmetric Q": ({"Q": [[1.0, 0.5], [0.0, 1.0]]}, "Q: expected a symmetric matrix"),
    "negative Q": ({"Q": -np.eye(2)}, "Q: not positive semidefinite"),
    "R = 0": ({"R": 0.0}, "R: not positive definite: .*; every input needs some weight"),
    "large S": ({"S": [[3.0], [0.0]]}, r"\[\[Q, S\], \[S', R\]\]: not positive semidefinite: .*S is too large"),
    "not stabilisable": (
        {"A": np.diag([1.0, 2.0]), "B": [[0.0], [1.0]]},
        r"\(A, B\): not stabilisable: mode 1 is uncontrollable; add an input that moves it",
    ),
    "noise": ({"W": np.eye(2)}, "W: expected the weights Q, R, S of the dual problem, got noise"),
    "unknown key": ({"Z": 1.0}, "Z: unknown key"),
    "not square": ({"A": [[1.0, 2.0]]}, "A: expected a square matrix"),
    "no time": ({"time": None}, "time: missing key"),
}


@pytest.mark.parametrize(("change", "message"), BAD.values(), ids=BAD.keys())
def test_bad_input_is_said_in_the_words_of_the_regulator(change, message):
    with pytest.raises(InputError, match=f"^{message}") as error:
        dual_from_mapping({**GOOD, **change})
    assert "\n" not in str(error.value)


def test_what_is_no_mapping_is_refused():
    with pytest.raises(InputError, match="give A, B, Q, R by name"):
        dual_from_mapping([1.0])


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_the_dual_riccati_equation_is_that_of_the_regulator(time):
    S = np.array([[0.1], [0.2]])
    plant = dual_from_mapping({**GOOD, "time": time, "S": S})
    A, B, Q, R = (np.array(GOOD[key], ndmin=2) for key in ("A", "B", "Q", "R"))
    solve = solve_continuous_are if time == "continuous" else solve_discrete_are
    P = solve(A, B, Q, R, s=S)
    K = (B.T @ P + S.T) / R if time == "continuous" else np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + S.T)
    found = solve_riccati(plant)
    np.testing.assert_allclose(found.P, P, rtol=1e-10)
    np.testing.assert_allclose(found.gain.T, K, rtol=1e-10)


def test_weight_period_and_names_are_kept_and_outputs_do_not_matter():
    plant = dual_from_mapping(
        {
            **GOOD,
            "time": "discrete",
            "dt": 0.1,
            "M": np.diag([1.0, 0.0]),
            "C": [[1.0, 0.0]],
            "states": ["angle", "rate"],
        }
    )
    assert (plant.dt, plant.states, plant.name) == (0.1, ("angle", "rate"), "plant")
    np.testing.assert_array_equal(plant.M, np.diag([1.0, 0.0]))
    np.testing.assert_array_equal(plant.C, [[0.0, 1.0]])


def test_a_file_is_read_and_named_in_its_errors(tmp_path):
    path = tmp_path / "arm.json"
    path.write_text(json.dumps(GOOD))
    assert load_dual(path).name == "arm"
    path.write_text(json.dumps({**GOOD, "R": -1.0}))
    with pytest.raises(InputError, match=r"arm\.json: R: not positive definite"):
        load_dual(path)
