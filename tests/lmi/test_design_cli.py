"""`lmi design` as a user meets it: a gain and its proof, files that `lmi certify` verifies, exit codes, errors."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

import lmi
from lmi.cli import cli
from lmi.synthesis.file import design_text

PLANT = """
time = "continuous"
A = [[0.0, 1.0], [-2.0, -0.3]]
C = [[1.0, 0.0]]
W = [[0.0, 0.0], [0.0, 1.0]]
V = [[0.01]]
"""

DUAL = """
time = "discrete"
dt = 0.1
A = [[1.0, 0.1], [0.2, 1.1]]
B = [[0.0], [0.1]]
Q = [[1.0, 0.0], [0.0, 0.5]]
R = [[0.1]]
"""

BLIND = """
time = "discrete"
A = [[1.2, 0.0], [0.0, 0.5]]
C = [[1.0, 0.0]]
Q = [[1.0, 0.0], [0.0, 1.0]]
R = [[1.0]]
"""


def invoke(*args):
    return CliRunner().invoke(cli, [str(arg) for arg in args])


@pytest.fixture
def folder(tmp_path):
    for name, text in {"plant": PLANT, "dual": DUAL, "blind": BLIND}.items():
        (tmp_path / f"{name}.toml").write_text(text)
    return tmp_path


@pytest.fixture(scope="module")
def smallest(tmp_path_factory):
    """The text of a design of the smallest norm, and what was printed."""
    folder = tmp_path_factory.mktemp("smallest")
    (folder / "plant.toml").write_text(PLANT)
    result = invoke("design", folder / "plant.toml", "--objective", "hinf", "-o", folder / "d.json")
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in folder.iterdir()) == ["d.json", "plant.toml"]
    return (folder / "d.json").read_text(), result


def test_the_report_shows_gain_values_bounds_and_verdict(smallest):
    text, result = smallest
    lines = result.stdout.splitlines()
    gain = np.array(json.loads(text)["gain"])
    assert lines[0] == "plant: continuous time, states 2, outputs 1"
    assert lines[1] == "gain L"
    np.testing.assert_allclose([[float(line)] for line in lines[2:4]], gain, rtol=1e-9)
    assert lines[4].startswith("modes of A - LC: -")
    assert re.match(
        r"computed: H2 norm [\d.]+, H-infinity norm 0\.3129\d+ at omega = [\d.]+, decay rate [\d.]+$", lines[5]
    )
    row = next(line for line in lines if line.startswith("H-infinity")).split()
    assert float(row[1]) <= float(row[2]) <= float(row[1]) * (1 + 1e-4)
    assert lines[-1] == "certified"
    assert result.stderr == ""


def test_the_file_holds_what_the_contract_says(smallest):
    data = json.loads(smallest[0])
    assert list(data) == ["schema", "plant", "objective", "gain", "achieved", "certificate"]
    assert data["schema"] == "lmi-design/1"
    assert data["objective"] == {"name": "hinf", "gamma": None, "decay": None, "dual": False}
    assert data["plant"] == {
        "name": "plant", "time": "continuous", "A": [[0.0, 1.0], [-2.0, -0.3]], "C": [[1.0, 0.0]],
        "W": [[0.0, 0.0], [0.0, 1.0]], "V": [[0.01]], "N": [[0.0], [0.0]], "M": [[1.0, 0.0], [0.0, 1.0]],
    }  # fmt: skip
    assert {"h2", "cost", "hinf", "decay", "modes"} <= set(data["achieved"])
    assert data["achieved"]["cost"] == pytest.approx(data["achieved"]["h2"] ** 2)


def test_certify_verifies_the_file_and_rejects_another_plant(smallest, folder):
    (folder / "d.json").write_text(smallest[0])
    good = invoke("certify", folder / "d.json", "--plant", folder / "plant.toml")
    assert (good.exit_code, good.stdout.splitlines()[-1]) == (0, "certified")
    (folder / "other.toml").write_text(PLANT.replace("-0.3", "-0.2"))
    other = invoke("certify", folder / "d.json", "--plant", folder / "other.toml")
    assert (other.exit_code, other.stdout) == (1, "rejected: made for another plant: A differs\n")


@pytest.mark.parametrize("edit", ["gain", "plant", "gamma", "decay"])
def test_certify_rejects_an_edited_file(smallest, folder, edit):
    data = json.loads(smallest[0])
    if edit == "gain":
        data["gain"][0][0] *= 1.01
    elif edit == "plant":
        data["plant"]["V"][0][0] *= 2
    else:
        data["objective"][edit] = {"gamma": 0.9, "decay": 1.1}[edit] * data["achieved"][
            {"gamma": "hinf"}.get(edit, edit)
        ]
    (folder / "d.json").write_text(json.dumps(data))
    result = invoke("certify", folder / "d.json")
    assert result.exit_code == 1
    assert result.stdout.startswith("rejected: ")


def test_json_holds_the_same_alone(smallest, folder):
    result = invoke("design", folder / "plant.toml", "--objective", "hinf", "--format", "json")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == json.loads(smallest[0])
    assert result.stderr == ""


def test_a_dual_design_is_written_as_state_feedback_and_verified(folder):
    path = folder / "k.json"
    result = invoke("design", folder / "dual.toml", "--dual", "--decay", "0.5", "-o", path)
    assert result.exit_code == 0, result.output
    assert "gain K, u = -Kx" in result.stdout
    data = json.loads(path.read_text())
    assert list(data["plant"]) == ["name", "time", "dt", "A", "B", "Q", "R", "S", "M"]
    loop = np.array(data["plant"]["A"]) - np.array(data["plant"]["B"]) @ np.array(data["gain"])
    assert np.abs(np.linalg.eigvals(loop)).max() <= np.exp(-0.05)
    assert invoke("certify", path, "--plant", folder / "dual.toml").exit_code == 0
    (folder / "dual.toml").write_text(DUAL.replace("dt = 0.1", "dt = 0.2"))
    assert "dt differs" in invoke("certify", path, "--plant", folder / "dual.toml").stdout


INFEASIBLE = {
    "gamma": (("plant.toml", "--objective", "hinf", "--gamma", "0.3"), "infeasible: gamma 0.3 fails: ", 1),
    "decay": (("blind.toml", "--decay", "1"), "infeasible: decay 1 fails: mode 0.5 is unobservable", 1),
    "both": (
        ("plant.toml", "--objective", "hinf", "--gamma", "0.32", "--decay", "20"),
        "not certified: gamma 0.32 and decay 20 fail together: each alone can be met",
        3,
    ),
}


@pytest.mark.parametrize(("args", "line", "code"), INFEASIBLE.values(), ids=INFEASIBLE.keys())
def test_what_cannot_be_met_is_one_line_that_names_the_specification(args, line, code, folder):
    result = invoke("design", folder / args[0], *args[1:], "-o", folder / "none.json")
    assert result.exit_code == code, result.output
    assert len(result.stdout.splitlines()) == 2
    assert result.stdout.splitlines()[1].startswith(line)
    assert not (folder / "none.json").exists()


def test_json_of_what_cannot_be_met_has_the_reason(folder):
    result = invoke("design", folder / "blind.toml", "--decay", "1", "--format", "json")
    data = json.loads(result.stdout)
    assert result.exit_code == 1
    assert (data["gain"], data["achieved"], data["certificate"]) == (None, None, None)
    assert data["reason"].startswith("decay 1 fails")


USAGE = {
    "objective": ("plant.toml", "--objective", "h3"),
    "gamma with h2": ("plant.toml", "--gamma", "1"),
    "gamma no number": ("plant.toml", "--objective", "hinf", "--gamma", "x"),
    "gamma negative": ("plant.toml", "--objective", "hinf", "--gamma", "-1"),
    "decay infinite": ("plant.toml", "--decay", "inf"),
    "no file": ("nowhere.toml",),
    "dual of a plant": ("plant.toml", "--dual"),
    "no folder for the output": ("plant.toml", "-o", "{folder}/nowhere/d.json"),
    "format": ("plant.toml", "--format", "xml"),
}


@pytest.mark.parametrize("args", USAGE.values(), ids=USAGE.keys())
def test_bad_usage_is_one_line_and_exit_code_2(args, folder):
    result = invoke("design", folder / args[0], *(arg.format(folder=folder) for arg in args[1:]))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert result.stderr.startswith("lmi: ")


def test_python_gives_the_same_as_the_command_line(folder):
    found = lmi.design(folder / "plant.toml", objective="h2", decay=3.0)
    result = invoke("design", folder / "plant.toml", "--decay", "3", "--format", "json")
    assert json.loads(result.stdout) == found.as_dict()
    assert json.loads(design_text(found)) == found.as_dict()


def test_the_command_line_alone_loads_no_optimiser():
    code = "import lmi.cli, sys; print([m for m in ('cvxpy', 'scipy', 'numpy', 'flint') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_a_norm_that_rounding_hides_is_not_certified():
    """What is left of the noise after rounding is 0, and so is the computed norm; the true one is about 0.046."""
    faint = {
        "time": "continuous",
        "A": [[-1e-6, 0.0], [0.0, -1e-6]],
        "C": [[7.0, -4.0]],
        "W": [[0.16000000000000003, 0.27999999999999997], [0.27999999999999997, 0.48999999999999994]],
        "V": [[1e12]],
        "M": [[49.0, -28.0], [-28.0, 16.0]],
    }
    found = lmi.design(faint, "hinf", gamma=1e-6)
    assert found.verdict.value != "certified"
    assert found.achieved is None or found.achieved.hinf.upper == 0.0


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_a_norm_that_is_nothing_is_certified_as_little(time):
    plant = {"time": time, "A": [[-0.5]], "C": [[1.0]], "W": [[1.0]], "V": [[1.0]], "M": [[0.0]]}
    found = lmi.design(plant, "hinf", gamma=0.5)
    assert found.verdict.value == "certified"
    assert 0 < found.certificate.norm.gamma <= 0.5


def test_a_decay_that_a_hidden_mode_has_is_not_said_to_fail():
    hidden = {"time": "continuous", "A": [[-3.0, 0.0], [0.0, -0.5]], "C": [[1.0, 0.0]], "W": np.eye(2), "V": [[1.0]]}
    assert lmi.design(hidden, decay=0.4999999999999995).verdict.value == "certified"
    assert "stays with every gain" not in lmi.design(hidden, decay=0.5).reason
    assert lmi.design(hidden, decay=0.51).verdict.value == "infeasible"


def test_a_name_cannot_look_like_a_verdict(folder):
    (folder / "plant.toml").write_text('name = "x\\ncertified\\n"' + PLANT)
    result = invoke("design", folder / "plant.toml", "--objective", "hinf", "--gamma", "0.01")
    assert result.exit_code == 1
    assert "certified" not in result.output.splitlines()
    (folder / "plant.toml").write_text('name = "x\\u001b[2J"' + PLANT)
    result = invoke("design", folder / "plant.toml")
    assert (result.exit_code, len(result.output.splitlines())) == (2, 1)
    assert "name: expected printable characters" in result.output


def test_what_is_not_written_is_said(folder):
    old = folder / "old.json"
    old.write_text("old")
    command = [
        sys.executable,
        "-m",
        "lmi",
        "design",
        "plant.toml",
        "--objective",
        "hinf",
        "--gamma",
        "0.01",
        "-o",
        "old.json",
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "lmi: old.json: not written, as no gain was found\n"
    assert old.read_text() == "old"


@pytest.mark.parametrize("place", ["", ".", "missing/d.json"])
def test_a_place_where_no_file_can_be_is_one_line_before_any_work(place, folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setattr("lmi.synthesis.designs.find_gain", lambda *_: pytest.fail("work"))
    result = invoke("design", "plant.toml", "-o", place)
    assert (result.exit_code, len(result.output.splitlines())) == (2, 1)


def test_a_costly_gain_comes_with_a_hint(smallest, folder):
    _, smallest_norm = smallest
    assert "near the smallest norm gains are large; --gamma 0.319 finds one that costs less" in smallest_norm.stdout
    result = invoke("design", folder / "plant.toml", "--objective", "hinf", "--gamma", "0.319")
    assert "near the smallest norm" not in result.output


def test_a_design_too_large_to_be_verified_is_one_line(folder, monkeypatch):
    monkeypatch.setattr("lmi.certificate.design_file.WORK", 100)
    result = invoke("design", folder / "plant.toml")
    assert (result.exit_code, len(result.output.splitlines())) == (2, 1)
    assert "certificate: expected (n + l)^3 times the bits" in result.output
