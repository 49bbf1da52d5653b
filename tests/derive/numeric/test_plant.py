"""The one entrance of a plant: what it accepts in every format, and the one line it answers to anything else."""

import json
import pickle
from dataclasses import fields

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from derive.errors import InputError
from derive.numeric.plant import Plant, example_plant, load_plant, plant_from_mapping

GOOD = {
    "time": "continuous",
    "A": [[0.0, 1.0], [-2.0, -0.3]],
    "C": [[1.0, 0.0]],
    "W": [[0.0, 0.0], [0.0, 1.0]],
    "V": [[0.01]],
    "N": [[0.0], [0.05]],
    "name": "pendulum",
    "states": ["angle", "rate"],
}
GENERAL = {
    "time": "continuous",
    "A": GOOD["A"],
    "C": GOOD["C"],
    "B_d": [[0.0], [2.0]],
    "D_d": [[0.5]],
    "D_r": [[1.0]],
    "S_dd": 3.0,
    "S_rr": 0.25,
    "S_dr": 0.1,
}
TWO_OUTPUTS = {"C": [[1, 0], [0, 1]], "N": None}
DISCRETE = {"time": "discrete", "A": [[0.5, 0], [0, 0.5]], "N": None}

TOML = """
time = "continuous"
name = "pendulum"
states = ["angle", "rate"]
A = [[0.0, 1.0], [-2.0, -0.3]]
C = [[1, 0]]
W = [[0.0, 0.0], [0.0, 1.0]]
V = 0.01
N = [[0.0], [0.05]]
"""


def write(folder, kind):
    path = folder / f"plant.{kind}"
    if kind == "toml":
        path.write_text(TOML)
    elif kind == "json":
        path.write_text(json.dumps(GOOD))
    elif kind == "npz":
        np.savez(path, **GOOD)
    else:
        savemat(path, GOOD)
    return path


@pytest.mark.parametrize("kind", ["toml", "json", "npz", "mat"])
def test_every_format_gives_the_same_plant(tmp_path, kind):
    plant = load_plant(write(tmp_path, kind))
    for key in "ACWVN":
        np.testing.assert_array_equal(getattr(plant, key), GOOD[key])
    assert (plant.time, plant.name, plant.states) == ("continuous", "pendulum", ("angle", "rate"))
    assert (plant.n, plant.l, plant.is_continuous, plant.outputs) == (2, 1, True, ("y1",))


FULL = {
    **GOOD,
    "M": [[2.0, 0.0], [0.0, 0.0]],
    "B": [[0.0], [1.0]],
    "D_u": [[0.5]],
    "P0": [[1.0, 0.0], [0.0, 3.0]],
    "source": "a lecture",
    "outputs": ["gyro"],
    "units": {"angle": "rad", "rate": "rad/s"},
}
"""Every key of a continuous plant."""


def matlab_cells(*rows):
    cells = np.empty((len(rows), 1), dtype=object)
    cells[:, 0] = rows
    return cells


def write_full(path, data):
    if path.suffix == ".json":
        path.write_text(json.dumps(data))
    elif path.suffix == ".toml":
        simple = {key: value for key, value in data.items() if key != "units"}
        path.write_text(
            "\n".join(f"{key} = {json.dumps(value)}" for key, value in simple.items())
            + "\n[units]\n"
            + "\n".join(f"{key} = {json.dumps(value)}" for key, value in data["units"].items())
        )
    elif path.suffix == ".npz":
        np.savez(path, **{key: np.array(value) for key, value in data.items() if key != "units"})
    else:
        savemat(path, {**data, "states": matlab_cells("angle", "rate"), "outputs": matlab_cells("gyro")})
    return path


@pytest.mark.parametrize("kind", ["toml", "json", "npz", "mat"])
def test_every_key_survives_every_format(tmp_path, kind):
    expected = plant_from_mapping(FULL)
    plant = load_plant(write_full(tmp_path / f"plant.{kind}", FULL))
    for field in fields(Plant):
        if (kind, field.name) == ("npz", "units"):
            continue  # an archive of arrays has no place for them
        ours, theirs = getattr(plant, field.name), getattr(expected, field.name)
        if isinstance(theirs, np.ndarray):
            np.testing.assert_array_equal(ours, theirs)
            assert ours.dtype == theirs.dtype
        else:
            assert ours == theirs, field.name


MATLAB = {
    "whole numbers": {"A": np.array([[0, 1], [-2, -1]], np.int8), "C": np.array([[1, 0]], np.uint8)},
    "sparse": {"A": csc_matrix([[0.0, 1.0], [-2.0, -1.0]]), "W": csc_matrix([[0.0, 0.0], [0.0, 1.0]])},
    "logical": {"C": np.array([[True, False]])},
    "a vector": {"C": np.array([1.0, 0.0])},
    "a row of names": {"states": matlab_cells("angle", "rate").T},
    "names of equal length": {"states": np.array(["angle", "rate "])},
    "one name": {"outputs": "gyro"},
    "an empty matrix": {"N": np.zeros((0, 0)), "name": ""},
}


@pytest.mark.parametrize("change", MATLAB.values(), ids=MATLAB)
def test_what_matlab_saves_is_read(tmp_path, change):
    data = {**FULL, "A": [[0, 1], [-2, -1]], **change}
    savemat(tmp_path / "plant.mat", data)
    plant = load_plant(tmp_path / "plant.mat")
    np.testing.assert_array_equal(plant.A, [[0, 1], [-2, -1]])
    np.testing.assert_array_equal(plant.C, [[1, 0]])
    np.testing.assert_array_equal(plant.W, FULL["W"])
    assert (plant.states, plant.outputs) == (("angle", "rate"), ("gyro",))
    np.testing.assert_array_equal(plant.N, [[0], [0]] if "N" in change else FULL["N"])


def test_a_sparse_matrix_is_a_matrix():
    plant = plant_from_mapping({**GOOD, "A": csc_matrix(GOOD["A"])})
    np.testing.assert_array_equal(plant.A, GOOD["A"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"N": np.array([0.0, 0.05])}, "N: expected shape (2, 1), got (1, 2); transpose it"),
        ({"A": np.array([[0, 1j], [1, 1]])}, "A[1][1]: expected a real number, got 0j; "),
        ({"A": {"x": 1}}, "A: expected a real number, got {'x': array([[1]])}; "),
        ({"A": matlab_cells("a", "b")}, "A[1][1]: expected a real number, got array(['a'], dtype='<U1'); "),
        ({"states": [1, 2]}, "states[1]: expected a text, got 1; "),
    ],
)
def test_what_is_no_matrix_in_matlab_gives_one_line(tmp_path, change, message):
    savemat(tmp_path / "plant.mat", {**FULL, **change})
    with pytest.raises(InputError) as caught:
        load_plant(tmp_path / "plant.mat")
    assert str(caught.value).startswith(f"{tmp_path / 'plant.mat'}: {message}")
    assert "\n" not in str(caught.value)


def test_what_is_not_given_has_its_default():
    plant = plant_from_mapping({"time": "discrete", "A": 0.5, "C": 2, "Q": 1, "R": 3}, name="scalar")
    np.testing.assert_array_equal(plant.M, [[1]])
    np.testing.assert_array_equal(plant.N, [[0]])
    np.testing.assert_array_equal(plant.W, [[1]])
    np.testing.assert_array_equal(plant.V, [[3]])
    assert (plant.B, plant.D_u, plant.P0, plant.dt, plant.name) == (None, None, None, None, "scalar")


def test_the_general_form_is_reduced():
    plant = plant_from_mapping(GENERAL)
    B_d, D_d, D_r = (np.array(GENERAL[key]) for key in ("B_d", "D_d", "D_r"))
    joint = np.array([[3.0, 0.1], [0.1, 0.25]])
    inputs = np.block([[B_d, np.zeros((2, 1))], [D_d, D_r]])
    expected = inputs @ joint @ inputs.T
    np.testing.assert_allclose(np.block([[plant.W, plant.N], [plant.N.T, plant.V]]), expected, rtol=1e-15)


def test_a_plant_is_read_only_and_travels():
    plant = plant_from_mapping({**GOOD, "units": {"angle": "rad", "y1": "V"}, "P0": [[1, 0], [0, 1]]})
    with pytest.raises(ValueError, match="read-only"):
        plant.A[0, 0] = 1.0
    copy = pickle.loads(pickle.dumps(plant))
    np.testing.assert_array_equal(copy.P0, plant.P0)
    assert copy.units == {"angle": "rad", "y1": "V"}


def test_the_example_is_the_published_aircraft():
    plant = example_plant()
    printed = [[2.313, 2.727, 0.688, 0.023], [2.727, 4.271, 1.148, 0.323],
               [0.688, 1.148, 0.313, 0.102], [0.023, 0.323, 0.102, 0.083]]  # fmt: skip
    assert (plant.n, plant.l) == (4, 2)
    assert "Beale" in plant.source
    np.testing.assert_array_equal(np.round(plant.W, 3), printed)
    assert np.linalg.eigvalsh(printed)[0] < -5e-4 < 0 < np.linalg.eigvalsh(plant.W)[0]
    # the aircraft's roll rate is the derivative of its bank angle, and gravity turns bank into sideslip
    np.testing.assert_array_equal(plant.A.T[0], [0, 1, 0, 0])
    assert plant.A.T[3, 0] == 0.034


REFUSED = {
    "A not square": ({"A": [[1, 2]]}, "A: expected a square matrix, got shape (1, 2); "),
    "shape of C": ({"C": [[1.0], [0.0]]}, "C: expected shape (any, 2), got (2, 1); "),
    "shape of W": ({"W": [[1, 0, 0], [0, 1, 0]]}, "W: expected shape (2, 2), got (2, 3); "),
    "shape of V": ({"V": [[1, 0], [0, 1]]}, "V: expected shape (1, 1), got (2, 2); "),
    "shape of N": ({"N": [[1, 0]]}, "N: expected shape (2, 1), got (1, 2); transpose it"),
    "shape of M": ({"M": 1}, "M: expected shape (2, 2), got (1, 1); "),
    "shape of P0": ({"P0": 1}, "P0: expected shape (2, 2), got (1, 1); "),
    "shape of B": ({"B": 1}, "B: expected shape (2, any), got (1, 1); "),
    "shape of D_u": ({"B": [[1], [0]], "D_u": [[1, 2]]}, "D_u: expected shape (1, 1), got (1, 2); "),
    "NaN": ({"A": [[0, 1], [float("nan"), 0]]}, "A[2][1]: expected a finite number, got nan; remove or replace it"),
    "infinity": ({"W": [[np.inf, 0], [0, 1]]}, "W[1][1]: expected a finite number, got inf; remove or replace it"),
    "too large": ({"W": [[10**400, 0], [0, 1]]}, "W[1][1]: expected a finite number, got inf; remove or replace it"),
    "out of range": ({"V": 1e-60}, "V: expected 0 or a size between 1e-50 and 1e+50, got 1e-60; choose other units"),
    "asymmetric W": (
        {"W": [[1, 0.1], [0.2, 1]]},
        "W: expected a symmetric matrix, got 0.1 at (1, 2) and 0.2 at (2, 1); make them equal",
    ),
    "asymmetric V": (
        {**TWO_OUTPUTS, "V": [[1, 0.5], [0, 1]]},
        "V: expected a symmetric matrix, got 0.5 at (1, 2) and 0 at (2, 1); make them equal",
    ),
    "indefinite W": (
        {"W": [[1, 2], [2, 1]], "N": None},
        "W: not positive semidefinite: eigenvalue -1 (relative -0.333); a covariance has no negative eigenvalue",
    ),
    "indefinite Q": (
        {**DISCRETE, "W": None, "Q": [[1, 2], [2, 1]]},
        "Q: not positive semidefinite: eigenvalue -1 (relative -0.333); a covariance has no negative eigenvalue",
    ),
    "indefinite V": (
        {**TWO_OUTPUTS, "V": [[1, 2], [2, 1]]},
        "V: not positive definite: eigenvalue -1 (relative -0.333); every output needs some noise",
    ),
    "no V": ({"V": 0}, "V: not positive definite: eigenvalue 0 (relative 0); every output needs some noise"),
    "singular V": ({**TWO_OUTPUTS, "V": [[1, 1], [1, 1]]}, "V: not positive definite: eigenvalue "),
    "indefinite joint noise": (
        {"W": [[1, 0], [0, 1]], "V": 1, "N": [[1], [1]]},
        "[[W, N], [N', V]]: not positive semidefinite: eigenvalue -0.414214 (relative -0.172); "
        "N is too large for W and V",
    ),
    "indefinite M": ({"M": [[1, 0], [0, -1]]}, "M: not positive semidefinite: eigenvalue -1 (relative -1); "),
    "indefinite P0": ({"P0": [[1, 0], [0, -1]]}, "P0: not positive semidefinite: eigenvalue -1 (relative -1); "),
    "ragged": (
        {"A": [[0, 1], [-2]]},
        "A: expected rows of equal length, got 2 in row 1 and 1 in row 2; complete the shorter one",
    ),
    "a text for a number": (
        {"A": [["0", 1], [1, 2]]},
        "A[1][1]: expected a real number, got '0'; write it as 1 or 1.0",
    ),
    "a truth value": ({"A": [[True, 1], [1, 2]]}, "A[1][1]: expected a real number, got True; write it as 1 or 1.0"),
    "an array of truth values": ({"A": np.eye(2, dtype=bool)}, "A[1][1]: expected a real number, got True; "),
    "a complex number": ({"A": np.eye(2) * 1j}, "A[1][1]: expected a real number, got 1j; write it as 1 or 1.0"),
    "a vector": (
        {"C": [1.0, 0.0]},
        "C: expected a list of rows, got 1.0 as row 1; write [[1.0, 0.0]] for one row, [[1.0], [0.0]] for one column",
    ),
    "three dimensions": ({"A": np.zeros((2, 2, 2))}, "A[1][1]: expected a real number, got [0.0, 0.0]; "),
    "no rows": ({"A": []}, "A: expected a matrix with at least one entry, got none; "),
    "no columns": ({"A": [[]]}, "A: expected a matrix with at least one entry, got none; "),
    "a word": ({"A": "A"}, "A: expected a real number, got 'A'; "),
    "an unknown key": ({"K": 1}, "K: unknown key; known are time, A, C, W, V, N, "),
    "a misspelt key": ({"state": 1}, "state: unknown key; did you mean states?"),
    "a key in lower case": ({"a": 1}, "a: unknown key; did you mean A?"),
    "a key of two lines": ({"sta\ntes": 1}, "sta tes: unknown key; did you mean states?"),
    "W and Q": ({"Q": [[1, 0], [0, 1]]}, "Q: expected one of W and Q, got both; they mean the same, keep one"),
    "V and R": ({"R": 1}, "R: expected one of V and R, got both; they mean the same, keep one"),
    "N and S": ({"S": [[0], [0]]}, "S: expected one of N and S, got both; they mean the same, keep one"),
    "both forms": ({"B_d": [[1], [0]]}, "W: expected W, V, N or the general form B_d, S_dd, ..., got both; keep one"),
    "a bad time": ({"time": "sampled"}, """time: expected "continuous" or "discrete", got 'sampled'; choose one"""),
    "a time of arrays": ({"time": np.eye(2)}, 'time: expected "continuous" or "discrete", got array('),
    "an unobservable unstable pair": (
        {"A": [[0.3, 2], [-2, 0.3]], "C": [[0, 0]]},
        "(A, C): not detectable: mode 0.3+2j is unobservable; ",
    ),
    "an unobservable integrator": (
        {"A": [[0, 0], [0, -1]], "C": [[0, 1]]},
        "(A, C): not detectable: mode 0 is unobservable; ",
    ),
    "an unobservable constant": (
        {**DISCRETE, "A": [[1, 0], [0, 0.5]], "C": [[0, 1]]},
        "(A, C): not detectable: mode 1 is unobservable; ",
    ),
    "dt in continuous time": ({"dt": 0.1}, 'dt: expected only with time = "discrete", got "continuous"; '),
    "a negative dt": ({**DISCRETE, "dt": -1}, "dt: expected a positive number of seconds, got -1; "),
    "too few names": ({"states": ["angle"]}, "states: expected 2 names, got 1; give one for each"),
    "equal names": ({"states": ["a", "a"]}, "states: expected different names, got ['a', 'a']; "),
    "one name": ({"states": "ab"}, "states: expected a list of 2 names, got 'ab'; "),
    "numbers for names": ({"outputs": [1]}, 'outputs[1]: expected a text, got 1; write it in quotes, as "..."'),
    "a number for a name": ({"name": 3}, "name: expected a text, got 3; "),
    "units in a list": (
        {"units": ["m"]},
        """units: expected units by name, got ['m']; write units = { angle = "m" }""",
    ),
    "the unit of nothing": (
        {"units": {"angles": "m"}},
        "units: expected names of states or outputs, got 'angles'; did",
    ),
    "a number for a unit": ({"units": {"rate": 1}}, "units.rate: expected a text, got 1; "),
}


@pytest.mark.parametrize(("change", "message"), REFUSED.values(), ids=REFUSED)
def test_a_bad_plant_gives_one_line(change, message):
    with pytest.raises(InputError) as caught:
        plant_from_mapping({**GOOD, **change})
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"S_dd": [[1, 0], [0, 1]]}, "S_dd: expected shape (1, 1), got (2, 2); "),
        ({"D_d": [[1, 2]]}, "D_d: expected shape (1, 1), got (1, 2); "),
        ({"D_r": [[1], [2]]}, "D_r: expected shape (1, any), got (2, 1); "),
        ({"S_dr": 1}, "[[S_dd, S_dr], [S_dr', S_rr]]: not positive semidefinite: eigenvalue -0.0751838"),
        ({"S_rr": 0, "S_dr": 0, "D_d": [[0]]}, "V: not positive definite: eigenvalue 0 (relative 0); "),
    ],
)
def test_a_bad_general_form_gives_one_line(change, message):
    with pytest.raises(InputError) as caught:
        plant_from_mapping({**GENERAL, **change})
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("data", "key", "message"),
    [
        (GOOD, "time", 'time: missing key, expected "continuous" or "discrete"; add it'),
        (GOOD, "A", "A: missing key, expected the state matrix; add it"),
        (GOOD, "C", "C: missing key, expected the output matrix; add it"),
        (GOOD, "W", "W: missing key, expected the process noise W (or Q, or B_d with S_dd); add it"),
        (GOOD, "V", "V: missing key, expected the measurement noise V (or R, or D_r with S_rr); add it"),
        (GENERAL, "B_d", "B_d: missing key, expected the disturbance matrix of the general form; add it"),
        (GENERAL, "S_dd", "S_dd: missing key, expected the intensity of d in the general form; add it"),
        (GENERAL, "D_r", "D_r: missing key, expected the matrix of r in the general form; add it"),
        (GENERAL, "S_rr", "S_rr: missing key, expected the intensity of r in the general form; add it"),
    ],
)
def test_a_missing_key_is_named(data, key, message):
    with pytest.raises(InputError) as caught:
        plant_from_mapping({name: value for name, value in data.items() if name != key})
    assert str(caught.value) == message


FILES = {
    "empty.toml": (b"", "expected a plant, got an empty file; it needs time, A, C, W and V"),
    "words.toml": (b"hello\n", "expected TOML, got an error: Expected '=' after a key"),
    "twice.toml": (b"A = 1\nA = 2\n", "expected TOML, got an error: Cannot overwrite a value"),
    "latin.toml": (b'name = "\xe9"\n', "expected text in UTF-8, got other bytes; save it as UTF-8"),
    "words.json": (
        b"hello",
        "expected JSON, got an error: Expecting value: line 1 column 1 (char 0); correct that line",
    ),
    "list.json": (b"[1]", "expected a JSON object, got list; "),
    "twice.json": (b'{"A": 1, "A": 2}', "expected JSON, got an error: key 'A' is given twice; correct that line"),
    "nan.json": (
        json.dumps({**GOOD, "V": float("nan")}).encode(),
        "V: expected a finite number, got nan; remove or replace it",
    ),
    "words.npz": (b"hello", "expected an .npz archive of numbers and texts, got an error: "),
    "words.mat": (b"hello", "expected a MATLAB file of version 7 or older, got an error: "),
    "plant.txt": (b"A = 1", "expected a file ending in .toml, .json, .npz, .mat, got .txt; "),
    "plant.tml": (b"A = 1", "expected a file ending in .toml, .json, .npz, .mat, got .tml; did you mean .toml?"),
    "plant": (b"A = 1", "expected a file ending in .toml, .json, .npz, .mat, got no suffix; "),
    "key.toml": (b"B_D = 1\n", "B_D: unknown key; did you mean B_d?"),
}


@pytest.mark.parametrize(("content", "message"), FILES.values(), ids=FILES)
def test_a_bad_file_gives_one_line(tmp_path, request, content, message):
    path = tmp_path / request.node.callspec.id
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_plant(path)
    assert str(caught.value).startswith(f"{path}: {message}")
    assert "\n" not in str(caught.value)


def test_a_folder_or_nothing_is_no_plant(tmp_path):
    with pytest.raises(InputError, match="expected a file, got a folder; name the plant file in it"):
        load_plant(tmp_path)
    with pytest.raises(InputError, match="expected a file, found none; check the path"):
        load_plant(tmp_path / "absent.toml")


def test_nothing_is_unpickled(tmp_path):
    class Bomb:
        def __reduce__(self):
            return (open, (str(tmp_path / "exploded"), "w"))

    np.savez(tmp_path / "bomb.npz", A=np.array([Bomb()], dtype=object))
    np.save(tmp_path / "bomb.npy", np.array([Bomb()], dtype=object), allow_pickle=True)
    (tmp_path / "bomb.npy").rename(tmp_path / "array.npz")
    for name in ("bomb.npz", "array.npz"):
        with pytest.raises(InputError, match="allow_pickle=False"):
            load_plant(tmp_path / name)
    assert not (tmp_path / "exploded").exists()


def test_a_single_array_is_no_archive(tmp_path):
    np.save(tmp_path / "single.npy", np.eye(2))
    (tmp_path / "single.npy").rename(tmp_path / "single.npz")
    with pytest.raises(InputError, match=r"expected an .npz archive, got a single array; write it with numpy.savez"):
        load_plant(tmp_path / "single.npz")


def test_detectability_does_not_depend_on_units():
    A, C = np.array([[0.1, 1.0], [0.0, 0.2]]), np.array([[1.0, 0.0]])
    for scale in (1e-12, 1.0, 1e12):
        T = np.diag([1.0, scale])
        data = {"time": "continuous", "A": T @ A @ np.linalg.inv(T), "C": scale * C @ np.linalg.inv(T)}
        assert plant_from_mapping({**data, "W": np.eye(2), "V": 1}).n == 2
        hidden = {**data, "A": T @ A.T @ np.linalg.inv(T), "C": scale * np.array([[0.0, 1.0]])}
        hidden["A"] = np.diag([0.1, 0.2])
        with pytest.raises(InputError, match=r"mode 0.1 is unobservable"):
            plant_from_mapping({**hidden, "W": np.eye(2), "V": 1})


@pytest.mark.parametrize("rate", [1e-15, 1e15])
def test_detectability_does_not_depend_on_the_unit_of_time(rate):
    data = {"time": "continuous", "C": [[1, 0]], "W": np.eye(2), "V": 1}
    assert plant_from_mapping({**data, "A": rate * np.array([[0.1, 1.0], [0.0, 0.2]])}).n == 2
    with pytest.raises(InputError, match="is unobservable"):
        plant_from_mapping({**data, "A": rate * np.array([[0.1, 0.0], [0.0, 0.2]])})


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_a_stable_mode_may_hide_beside_a_fast_one(time):
    fast = [[-1e9, 0], [0, -1]] if time == "continuous" else [[0.5, 1e9], [0, 0.4]]
    assert plant_from_mapping({"time": time, "A": fast, "C": [[1, 0]], "W": np.eye(2), "V": 1}).n == 2
    beside = {"time": time, "A": [[2, 0], [0, -0.5]], "C": [[1, 0]], "W": np.eye(2), "V": 1}
    assert plant_from_mapping(beside).n == 2
    unstable = {"time": "continuous", "A": [[-1e9, 0], [0, 1e-3]], "C": [[1, 0]], "W": np.eye(2), "V": 1}
    with pytest.raises(InputError, match=r"mode 0.001 is unobservable"):
        plant_from_mapping(unstable)


def test_a_double_mode_on_the_boundary_must_be_seen():
    T = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    A = T @ np.array([[0, 1, 0], [0, 0, 0], [0, 0, -1.0]]) @ T.T
    data = {"time": "continuous", "A": A, "W": np.eye(3), "V": 1}
    assert plant_from_mapping({**data, "C": [[1, 0, 1]] @ T.T}).n == 3
    for hidden in ([[0, 0, 1]], [[0, 1, 1]]):
        with pytest.raises(InputError, match=r"\(A, C\): not detectable: mode .* is unobservable"):
            plant_from_mapping({**data, "C": hidden @ T.T})


def test_rounding_is_not_taken_for_a_fault():
    rng = np.random.default_rng(0)
    G = rng.standard_normal((6, 2))
    W = G @ G.T
    W[0, 1] *= 1 + 1e-15
    plant = plant_from_mapping({"time": "continuous", "A": -np.eye(6), "C": np.ones((1, 6)), "W": W, "V": 1e-30})
    np.testing.assert_array_equal(plant.W, plant.W.T)
