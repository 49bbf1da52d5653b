"""Designs as files: what `lmi certify` prints comes from the matrices, and whatever is malformed is one line."""

import json
import subprocess
import sys
from copy import deepcopy
from math import exp, log

import numpy as np
import pytest
from click.testing import CliRunner

import lmi.certificate.arithmetic as arithmetic
import lmi.certificate.design_file as design_file_module
import lmi.certificate.file as file_module
from derive.numeric.dual import dual_from_mapping
from derive.numeric.plant import plant_from_mapping
from lmi.certification.design import certify_design
from lmi.cli import cli

PLANTS = {
    "continuous": {"A": [[0.5, 1.0], [-0.25, 0.75]], "C": [[1.0, 0.0]], "M": [[2.0, 0.5], [0.5, 1.0]]},
    "discrete": {"A": [[0.5, 1.0], [-0.25, 0.75]], "C": [[1.0, 0.0]], "M": [[1.0, 0.0], [0.0, 1.0]], "dt": 0.5},
}
NOISE = {"W": [[1.0, 0.25], [0.25, 0.5]], "V": [[0.5]], "N": [[0.25], [0.0]]}
GAINS = {"continuous": [[2.0], [3.5]], "discrete": [[1.0], [0.75]]}
TIMES = tuple(PLANTS)
ASKED = {"continuous": (7.0, 0.3), "discrete": (9.0, 0.1)}


def file_of(plant, gain, certificate, **objective):
    return {
        "schema": "lmi-design/1",
        "plant": plant,
        "objective": {"name": "hinf", "gamma": None, "decay": None, "dual": False} | objective,
        "gain": gain,
        "achieved": {"hinf": 1e-9, "decay": 1e9, "h2": 0.0},
        "certificate": certificate.as_dict(),
    }


def design_of(time):
    plant = {"name": "small", "time": time, **PLANTS[time], **NOISE}
    gamma, decay = ASKED[time]
    found = certify_design(plant_from_mapping(plant), np.array(GAINS[time]), gamma=gamma, decay=decay, floor=0.1)
    return file_of(plant, GAINS[time], found, gamma=gamma, decay=decay)


@pytest.fixture(scope="module", params=TIMES)
def made(request):
    return design_of(request.param)


@pytest.fixture
def design(made):
    return deepcopy(made)


@pytest.fixture
def run(tmp_path):
    def certify(design, *extra):
        path = tmp_path / "design.json"
        path.write_text(design if isinstance(design, str) else json.dumps(design), encoding="utf-8")
        return CliRunner().invoke(cli, ["certify", str(path), *map(str, extra)])

    return certify


@pytest.fixture
def plant_file(tmp_path):
    def write(plant, **changes):
        path = tmp_path / "plant.json"
        path.write_text(json.dumps({key: x for key, x in (plant | changes).items() if x is not None}))
        return path

    return write


def test_what_is_printed_is_proved_and_not_stated(design, run, plant_file):
    result = run(design)
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    time = design["plant"]["time"]
    assert lines[0] == f"{time} time, states 2, outputs 1: every inequality holds, decided in integers"
    assert [line.split("  ")[0] for line in lines[2:5]] == ["tr P", "tr MP", "H-infinity"]
    row = lines[4].split()
    assert 0.1 < float(row[1]) < float(row[2]) < ASKED[time][0]
    slowest = {"continuous": "real part at most -0.37499", "discrete": "modulus at most 0.7905694"}[time]
    assert lines[-2].startswith(f"every mode of A - LC has {slowest}")
    assert ("a decay rate of at least" in lines[-2]) == (time == "discrete")
    assert lines[-1] == "certified"
    assert max(map(len, lines)) <= 110
    again = run(design, "--plant", plant_file(design["plant"]))
    assert (again.exit_code, again.stdout) == (0, result.stdout)


@pytest.mark.parametrize(("key", "factor"), [("gamma", 0.5), ("decay", 100.0)])
def test_a_request_that_is_stated_and_not_proved_is_rejected(design, run, key, factor):
    design["objective"][key] *= factor
    result = run(design)
    assert result.exit_code == 1
    assert result.stdout.startswith("rejected: the file states ")
    assert "certified" not in result.stdout
    part = {"gamma": "norm", "decay": "decay"}[key]
    design["objective"][key] /= factor
    del design["certificate"][part]
    result = run(design)
    assert (result.exit_code, len(result.stdout.splitlines())) == (1, 1)
    assert result.stdout.startswith("rejected: the file states ")
    design["objective"][key] = None
    assert run(design).exit_code == 0


def test_parts_may_be_left_out_and_are_then_not_proved(design, run):
    design["objective"] = {"name": "h2"}
    for part in ("decay", "floor", "norm"):
        del design["certificate"][part]
        result = run(design)
        assert result.exit_code == 0, result.output
        assert (part == "norm") == ("H-infinity" not in result.stdout)
        assert ("not proved" in result.stdout) == (part == "floor")
    assert "every mode" not in result.stdout


def test_the_period_counts_in_the_decay(run):
    design = design_of("discrete")
    design["plant"]["dt"] = 50.0
    assert run(design).exit_code == 1
    del design["plant"]["dt"]
    numerator, denominator = map(int, design["certificate"]["decay"]["radius"].split("/"))
    assert numerator / denominator < exp(-0.1)
    design["objective"]["decay"] = -log(numerator / denominator) * (1 - 1e-9)
    assert run(design).exit_code == 0
    design["objective"]["decay"] *= 1 + 1e-8
    assert run(design).exit_code == 1


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("A", [[0.5, 1.0], [-0.25, 0.7500000000000001]]), ("C", [[-1.0, 0.0]]), ("W", [[1.0, 0.25], [0.25, 0.625]]),
        ("V", [[0.25]]), ("N", [[0.0], [0.25]]), ("M", [[1.0, 0.5], [0.5, 1.0]]), ("time", None), ("dt", 0.25),
    ],
)  # fmt: skip
def test_a_design_of_another_plant_is_rejected(design, run, plant_file, key, value):
    plant = design["plant"]
    changes = {key: value}
    if key == "time":
        changes = {"time": {"continuous": "discrete", "discrete": "continuous"}[plant["time"]], "dt": None}
    elif key == "dt" and plant["time"] == "continuous":
        return
    result = run(design, "--plant", plant_file(plant, **changes))
    assert (result.exit_code, result.stdout) == (1, f"rejected: made for another plant: {key} differs\n")


def test_switching_the_time_of_a_file_is_rejected_or_malformed(design, run):
    time = design["plant"]["time"]
    design["plant"]["time"] = {"continuous": "discrete", "discrete": "continuous"}[time]
    design["plant"].pop("dt", None)
    assert run(design).exit_code == 2
    decay = design["certificate"]["decay"]
    decay["radius" if time == "continuous" else "rate"] = decay.pop("rate" if time == "continuous" else "radius")
    norm, floor = design["certificate"]["norm"], design["certificate"]["floor"]
    if time == "continuous":
        norm["G"] = floor["K"] = floor["H"]
    else:
        del norm["G"], floor["K"]
    result = run(design)
    assert result.exit_code == 1
    assert result.stdout.startswith("rejected: ")


REGULATOR = {"A": [[0.5, 1.0], [0.0, 0.25]], "B": [[0.0], [1.0]], "Q": [[1.0, 0.0], [0.0, 0.5]], "R": [[2.0]]}


@pytest.mark.parametrize("time", TIMES)
def test_a_dual_design_is_about_the_state_feedback(run, plant_file, time):
    plant = {"time": time, **REGULATOR, "S": [[0.25], [0.0]], "M": [[1.0, 0.0], [0.0, 2.0]]}
    gain = [[2.0, 3.0]] if time == "continuous" else [[0.25, 0.75]]
    found = certify_design(dual_from_mapping(plant), np.array(gain).T)
    design = file_of(plant, gain, found, dual=True)
    result = run(design, "--plant", plant_file(plant))
    assert result.exit_code == 0, result.output
    assert "inputs 1" in result.stdout
    assert "u = -Kx" in result.stdout
    assert "every mode of A - BK has" in result.stdout
    assert "outputs" not in result.stdout
    for key in ("A", "B", "Q", "R", "S", "M"):
        other = deepcopy(plant)
        other[key][0][0] += 0.125
        result = run(design, "--plant", plant_file(other))
        assert (result.exit_code, result.stdout) == (1, f"rejected: made for another plant: {key} differs\n")
    design["gain"] = [[-2.0, -3.0]]
    assert run(design).exit_code == 1


def test_a_design_without_certificate_proves_nothing(design, run):
    result = run(design | {"certificate": None, "gain": None, "achieved": None, "reason": "infeasible"})
    assert (result.exit_code, result.stdout) == (3, "not certified: the design holds no certificate\n")


def test_what_takes_too_long_is_not_certified(design, run, monkeypatch):
    monkeypatch.setattr(arithmetic, "WORK", 1)
    monkeypatch.setattr(arithmetic, "_dominant", lambda table: False)
    result = run(design)
    assert result.exit_code == 3
    assert result.stdout.startswith("not certified: ")


def test_longer_integers_than_are_decided_quickly_are_refused(design, run, monkeypatch):
    monkeypatch.setattr(file_module, "SIZE", 300)
    result = run(design)
    assert result.exit_code == 2
    assert "fewer digits" in result.stderr


def test_what_would_take_minutes_in_all_is_refused(design, run, monkeypatch):
    monkeypatch.setattr(design_file_module, "WORK", 1000)
    result = run(design)
    assert (result.exit_code, len(result.output.splitlines())) == (2, 1)
    assert "(n + l)^3 times the bits of its integers to be at most 1000" in result.output


def at(design, *path):
    for key in path:
        design = design[key]
    return design


def put(*path):
    """Return an edit that puts the last of its arguments at the path before it."""
    *where, key, value = path

    def edit(design):
        at(design, *where)[key] = value
        return json.dumps(design)

    return edit


def drop(*path):
    *where, key = path

    def edit(design):
        del at(design, *where)[key]
        return json.dumps(design)

    return edit


MALFORMED = {
    "schema of the certificate": (put("certificate", "schema", "lmi-certificate/1"), "certificate.schema"),
    "unknown key": (put("trace", 1), "trace"),
    "unknown key of the plant": (put("plant", "B", [[1.0]]), "B"),
    "unknown key of the certificate": (put("certificate", "gamma", "1/1"), "gamma"),
    "unknown key of the objective": (put("objective", "best", True), "best"),
    "unknown key of the norm": (put("certificate", "norm", "bound", "1/1"), "bound"),
    "no object": (put("certificate", "floor", [1]), "floor"),
    "no text": (put("certificate", "norm", "gamma", 6.5), "gamma"),
    "a double of the certificate": (put("certificate", "norm", "P", 0, 0, 6.5), "P[1][1]"),
    "a text of the plant": (put("plant", "A", 0, 0, "1/2"), "A[1][1]"),
    "a text of the gain": (put("gain", 0, 0, "1/2"), "gain[1][1]"),
    "a truth of the gain": (put("gain", 0, 0, True), "gain[1][1]"),
    "null in the gain": (put("gain", 0, 0, None), "gain[1][1]"),
    "NaN": (put("gain", 0, 0, float("nan")), "gain[1][1]"),
    "infinity": (put("plant", "A", 0, 0, float("inf")), "A[1][1]"),
    "NaN as the norm": (put("objective", "gamma", float("nan")), "objective.gamma"),
    "a text as the decay": (put("objective", "decay", "0.1"), "objective.decay"),
    "a list as the norm": (put("objective", "gamma", [1]), "objective.gamma"),
    "dual": (put("objective", "dual", 1), "objective.dual"),
    "dual without its keys": (put("objective", "dual", True), "B"),
    "negative period": (put("plant", "dt", -1.0), "dt"),
    "zero period": (put("plant", "dt", 0.0), "dt"),
    "no time": (drop("plant", "time"), "time"),
    "another time": (put("plant", "time", "sampled"), "plant.time"),
    "a list as the time": (put("plant", "time", [1]), "plant.time"),
    "gain transposed": (put("gain", [[1.0, 2.0]]), "gain"),
    "ragged gain": (put("gain", [[1.0], [2.0, 3.0]]), "gain"),
    "empty gain": (put("gain", []), "gain"),
    "not symmetric": (put("certificate", "floor", "Z", 0, 1, "7/1"), "floor.Z"),
    "W not symmetric": (put("plant", "W", 0, 1, 7.0), "W"),
    "too many columns": (put("plant", "A", [[0.0] * 201]), "A"),
    "too large": (lambda design: json.dumps(design).replace("0.75", "1e999", 1), "finite"),
    "too many digits": (lambda design: json.dumps(design).replace("0.75", "0." + "1" * 1300, 1), "expected a number"),
    "a key twice": (lambda design: json.dumps(design)[:-1] + ', "gain": [[1.0], [2.0]]}', "twice"),
    "a key twice inside": (
        lambda design: json.dumps(design).replace('"gamma": "', '"gamma": "1/1", "gamma": "'),
        "twice",
    ),
    "deep": (lambda design: json.dumps(design).replace('"achieved": ', '"achieved": ' + "[" * 10**5, 1), "JSON"),
    "cut": (lambda design: json.dumps(design)[:-3], "JSON"),
}
MALFORMED |= {
    f"no {key}": (drop(key), key) for key in ("plant", "objective", "gain", "achieved", "certificate")
} | {f"no {part}.{key}": (drop("certificate", part, key), key) for part, key in (
    ("cost", "X"), ("decay", "Y"), ("norm", "P"), ("norm", "gamma"), ("floor", "Z"), ("floor", "H"))}  # fmt: skip


@pytest.mark.parametrize(("edit", "word"), MALFORMED.values(), ids=MALFORMED.keys())
def test_malformed_designs_are_one_line_and_exit_code_2(edit, word, design, run):
    result = run(edit(design))
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert word in result.stderr
    assert "Traceback" not in result.stderr
    assert len(result.stderr) < 600


def test_designs_are_verified_on_the_standard_library_alone(made, tmp_path):
    path = tmp_path / "design.json"
    path.write_text(json.dumps(made))
    code = (
        "import sys; from lmi.certificate.command import certify_file; import lmi.certificate.design_infeasible; "
        f"assert certify_file({str(path)!r}, None)[1] == 0; "
        "print(*{name.partition('.')[0] for name in sys.modules} - set(sys.stdlib_module_names))"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert {"derive", "lmi"} <= set(loaded)
    assert not {"numpy", "scipy", "flint", "cvxpy", "sympy", "casadi"} & set(loaded)
