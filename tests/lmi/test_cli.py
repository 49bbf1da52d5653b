"""`lmi validate` as a user meets it: exit codes, one line for bad input, a table that fits, JSON alone."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import lmi.validation as validation_module
from derive.numeric.riccati import solve_riccati
from lmi.cli import cli
from lmi.routes import ROUTES, Answer

GOOD = """
time = "continuous"
A = [[0.0, 1.0], [-2.0, -0.3]]
C = [[1.0, 0.0]]
W = [[0.0, 0.0], [0.0, 1.0]]
V = [[0.01]]
"""

BAD = {
    "wrong shape": (GOOD.replace("V = [[0.01]]", "V = [[0.01, 0.0], [0.0, 1.0]]"), "V"),
    "NaN": (GOOD.replace("-0.3", "nan"), "A"),
    "asymmetric W": (GOOD.replace("W = [[0.0, 0.0]", "W = [[1.0, 0.5]"), "W"),
    "indefinite V": (GOOD.replace("0.01", "-0.01"), "V"),
    "undetectable": (GOOD.replace("A = [[0.0, 1.0], [-2.0, -0.3]]", "A = [[1.0, 0.0], [0.0, 2.0]]"), "detectable"),
    "ragged rows": (GOOD.replace("[-2.0, -0.3]", "[-2.0]"), "A"),
    "unknown key": (GOOD + "Z = 3\n", "Z"),
    "empty file": ("", "plant.toml"),
    "not TOML": ("time = = 3\n[[[", "plant.toml"),
}


def invoke(*args):
    return CliRunner().invoke(cli, [str(arg) for arg in args])


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "plant.toml"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize(("text", "word"), BAD.values(), ids=BAD.keys())
def test_bad_plant_is_one_line_on_standard_error_and_exit_code_2(text, word, write):
    result = invoke("validate", write(text))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert result.stderr.startswith("lmi: ")
    assert word in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    "args",
    [("validate", "nowhere.toml"), ("validate",), ("validate", "x", "--format", "xml"), ("--nonsense",), ("nonsense",)],
)
def test_bad_usage_is_one_line_and_exit_code_2(args):
    result = invoke(*args)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1


def test_good_plant_prints_its_table_and_verdict(write):
    result = invoke("validate", write(GOOD))
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert lines[0] == "plant: continuous time, states 2, outputs 1"
    assert [line.split()[0] for line in lines[2 : 2 + len(ROUTES)]] == [spec.name for spec in ROUTES]
    assert any(line.startswith("agree: ") for line in lines[-2:])
    assert max(map(len, lines)) <= 100
    assert "\x1b" not in result.stdout
    assert result.stdout.isascii()


def test_json_is_alone_on_standard_output(write):
    result = invoke("validate", write(GOOD), "--format", "json")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["verdict"] == "agree"
    assert result.stderr == ""


def test_strong_solution_is_said_to_be_and_ends_with_0(write):
    result = invoke("validate", write('time = "discrete"\nA = [[1.0]]\nC = [[1.0]]\nW = [[0.0]]\nV = [[1.0]]\n'))
    assert result.exit_code == 0
    assert "strong" in result.stdout.splitlines()[2]
    assert "strong solution" in result.stdout.splitlines()[-1]


def wrong(plant):
    solution = solve_riccati(plant)
    return Answer("solved", 2 * solution.P, solution.gain, 1.0, error=0.0)


@pytest.mark.parametrize("form", ["text", "json"])
def test_disagreement_ends_with_1_and_is_reported_in_full(form, write, monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], replace(ROUTES[4], run=wrong), ROUTES[5]))
    result = invoke("validate", write(GOOD), "--format", form)
    assert result.exit_code == 1
    assert "disagree" in result.stdout
    assert "integral" in result.stdout


def test_unconfirmed_ends_with_3(write, monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0],))
    result = invoke("validate", write(GOOD))
    assert result.exit_code == 3
    assert result.stdout.splitlines()[-1].startswith("unconfirmed: ")


@pytest.mark.parametrize("weight", [np.eye(2), np.diag([1e-40, 1e12])])
def test_table_fits_100_columns_whatever_the_numbers(weight, write):
    text = GOOD + f"M = {weight.tolist()}\n"
    result = invoke("validate", write(text))
    table = result.stdout.splitlines()[1 : 2 + len(ROUTES)]
    assert max(map(len, table)) <= 100
    assert "…" not in result.stdout
    assert ("tr MP" in table[0]) == (weight[0, 0] != 1)


def test_version_help_and_module_run_as_programs():
    for args in ([], ["--version"], ["--help"], ["validate", "--help"]):
        result = subprocess.run([sys.executable, "-m", "lmi", *args], check=True, capture_output=True, text=True)
        assert "lmi" in result.stdout
        assert result.stderr == ""
