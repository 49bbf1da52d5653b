"""Files of certificates and `lmi certify`: what is malformed, what is rejected, what is proved, and its exit code."""

import json
import os
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from click.testing import CliRunner

import lmi
import lmi.certificate.arithmetic as arithmetic
import lmi.certification.command as command_module
import lmi.certification.outcome as outcome_module
import lmi.validation as validation_module
from derive.errors import InputError
from derive.numeric.plant import example_plant, load_plant
from lmi.certificate.file import certificate_dict, certificate_from_dict, read_certificate, write_certificate
from lmi.certificate.report import above, at_least, at_most, ends
from lmi.certificate.sandwich import Interval, verify
from lmi.certification.sandwich import NotCertifiedError, certified
from lmi.cli import cli
from lmi.routes import ROUTES
from lmi.validation import Verdict

PLANT = """
time = "continuous"
A = [[0.0, 1.0], [-2.0, -0.3]]
C = [[1.0, 0.0]]
W = [[0.0, 0.0], [0.0, 1.0]]
V = [[0.01]]
"""


def invoke(*args):
    return CliRunner().invoke(cli, [str(arg) for arg in args])


@pytest.fixture
def folder(tmp_path):
    """A folder with a plant, its certificate and a gain."""
    (tmp_path / "plant.toml").write_text(PLANT)
    write_certificate(lmi.certify(tmp_path / "plant.toml").certificate, tmp_path / "optimum.json")
    (tmp_path / "L.csv").write_text("3.9\n7.1\n")
    return tmp_path


@pytest.fixture(scope="module")
def data():
    """A certificate as plain data, anew for each test by way of its text."""
    plant = {"time": "discrete", "A": [[1.25, 0.5], [0.0, 0.5]], "C": [[1.0, 0.0]], "Q": np.eye(2), "R": [[0.5]]}
    return json.dumps(certificate_dict(lmi.certify(plant).certificate))


def test_writing_and_reading_change_nothing(tmp_path):
    certificate, bounds = certified(example_plant())
    write_certificate(certificate, tmp_path / "c.json")
    again = read_certificate(tmp_path / "c.json")
    assert again == certificate
    assert verify(again)[1] == bounds
    assert list(tmp_path.iterdir()) == [tmp_path / "c.json"]
    raw = json.loads((tmp_path / "c.json").read_text())
    assert list(raw) == ["schema", "plant", "P_lo", "P_up", "X", "gain"]
    assert raw["schema"] == "lmi-certificate/1"
    numbers = [[Fraction(x) for x in row] for row in raw["plant"]["A"]]
    assert numbers == [[Fraction(x) for x in row] for row in example_plant().A.tolist()]
    assert all("/" in x for row in raw["P_up"] for x in row)


def edited(text, path, value):
    data = json.loads(text)
    *parents, last = path
    inner = data
    for key in parents:
        inner = inner[key]
    inner[last] = value
    return json.dumps(data)


MALFORMED = {
    "empty": (lambda text: "", "JSON"),
    "no JSON": (lambda text: text[:-5], "JSON"),
    "no object": (lambda text: "[1, 2]", "certificate"),
    "a number": (lambda text: "3", "certificate"),
    "deep": (lambda text: "[" * 100_000, "JSON"),
    "a key twice": (lambda text: text.replace('"X":', '"P_lo": [], "X":'), "twice"),
    "other schema": (lambda text: edited(text, ["schema"], "lmi-certificate/2"), "schema"),
    "schema a list": (lambda text: edited(text, ["schema"], ["lmi-certificate/1"]), "schema"),
    "unknown key": (lambda text: edited(text, ["trace"], "1/1"), "trace"),
    "unknown key of the plant": (lambda text: edited(text, ["plant", "name"], "x"), "name"),
    "unknown time": (lambda text: edited(text, ["plant", "time"], "sampled"), "time"),
    "plant a text": (lambda text: edited(text, ["plant"], "plant.toml"), "plant"),
    "a double": (lambda text: edited(text, ["P_lo", 0, 0], 0.5), "P_lo[1][1]"),
    "an integer": (lambda text: edited(text, ["P_lo", 0, 0], 1), "P_lo[1][1]"),
    "a huge integer": (lambda text: edited(text, ["X", 0, 0], 0).replace("[[0,", f"[[{'9' * 5000},"), "X[1][1]"),
    "NaN": (lambda text: edited(text, ["X", 0, 0], float("nan")), "X[1][1]"),
    "nan as a text": (lambda text: edited(text, ["X", 0, 0], "nan"), "X[1][1]"),
    "inf as a text": (lambda text: edited(text, ["X", 0, 0], "inf"), "X[1][1]"),
    "true": (lambda text: edited(text, ["X", 0, 0], True), "X[1][1]"),
    "null": (lambda text: edited(text, ["X", 0, 0], None), "X[1][1]"),
    "decimals": (lambda text: edited(text, ["X", 0, 0], "0.5"), "X[1][1]"),
    "exponent": (lambda text: edited(text, ["X", 0, 0], "1e5"), "X[1][1]"),
    "underscore": (lambda text: edited(text, ["X", 0, 0], "1_0"), "X[1][1]"),
    "blank": (lambda text: edited(text, ["X", 0, 0], " 1/2"), "X[1][1]"),
    "newline": (lambda text: edited(text, ["X", 0, 0], "1/2\n"), "X[1][1]"),
    "other digits": (lambda text: edited(text, ["X", 0, 0], "١/٢"), "X[1][1]"),
    "other digits above": (lambda text: edited(text, ["X", 0, 0], "١/2"), "X[1][1]"),
    "zero denominator": (lambda text: edited(text, ["X", 0, 0], "1/0"), "X[1][1]"),
    "negative denominator": (lambda text: edited(text, ["X", 0, 0], "1/-2"), "X[1][1]"),
    "two slashes": (lambda text: edited(text, ["X", 0, 0], "1/2/3"), "X[1][1]"),
    "too many digits": (lambda text: edited(text, ["X", 0, 0], "1" * 1201), "X[1][1]"),
    "too many digits below": (lambda text: edited(text, ["X", 0, 0], "1/" + "1" * 1201), "X[1][1]"),
    "no rows": (lambda text: edited(text, ["X"], []), "X"),
    "empty rows": (lambda text: edited(text, ["X"], [[], []]), "X"),
    "a row": (lambda text: edited(text, ["X"], ["1/1", "1/1"]), "X"),
    "ragged": (lambda text: edited(text, ["X", 0], ["1/1"]), "X"),
    "ragged below": (lambda text: edited(text, ["X", 1], ["1/1"]), "X"),
    "wrong shape": (lambda text: edited(text, ["X"], [["1/1"]]), "X"),
    "gain transposed": (lambda text: edited(text, ["gain"], [["1/1", "1/1"]]), "gain"),
    "not symmetric": (lambda text: edited(text, ["X", 0, 1], "7/1"), "X"),
    "W not symmetric": (lambda text: edited(text, ["plant", "W", 0, 1], "1/3"), "W"),
    "too many rows": (lambda text: edited(text, ["X"], [["0/1"]] * 201), "X"),
    "too many columns": (lambda text: edited(text, ["plant", "C"], [["0/1"] * 201]), "C"),
}
MALFORMED |= {
    f"no {key}": (lambda text, key=key: json.dumps({k: v for k, v in json.loads(text).items() if k != key}), key)
    for key in ("schema", "plant", "P_lo", "P_up", "X", "gain")
}


@pytest.mark.parametrize(("change", "word"), MALFORMED.values(), ids=MALFORMED.keys())
def test_malformed_files_are_one_line_and_exit_code_2(change, word, data, tmp_path):
    path = tmp_path / "c.json"
    path.write_text(change(data), encoding="utf-8")
    result = invoke("certify", path)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert word in result.stderr
    assert len(result.stderr) < 400 + len(str(path))
    assert "Traceback" not in result.stderr


def test_denominators_without_a_common_one_of_reasonable_size_are_refused(data):
    values = json.loads(data)
    values["X"] = [[f"1/{3**2000}", f"1/{7**1000}"], [f"1/{7**1000}", f"1/{11**1000}"]]
    with pytest.raises(InputError, match="common denominator"):
        certificate_from_dict(values)


def test_more_states_than_are_taken_are_refused(data):
    n, values = 201, json.loads(data)
    square, column = [["0/1"] * n] * n, [["0/1"]] * n
    values["plant"] |= {"A": square, "C": [["0/1"] * n], "W": square, "N": column, "M": square}
    values |= {"P_lo": square, "P_up": square, "X": square, "gain": column}
    with pytest.raises(InputError, match="at most 200 rows"):
        certificate_from_dict(values)


def test_more_digits_than_the_size_allows_are_refused(data, monkeypatch):
    import lmi.certificate.file as module

    certificate_from_dict(json.loads(data))
    monkeypatch.setattr(module, "SIZE", 100)
    with pytest.raises(InputError, match="fewer digits"):
        certificate_from_dict(json.loads(data))


def test_files_that_are_none_are_named(tmp_path, monkeypatch):
    import lmi.certificate.file as module

    for path, word in ((tmp_path, "folder"), (tmp_path / "nothing.json", "found none")):
        result = invoke("certify", path)
        assert result.exit_code == 2
        assert word in result.stderr
    path = tmp_path / "c.json"
    path.write_bytes(b"\xff\xfe\x00")
    assert invoke("certify", path).exit_code == 2
    monkeypatch.setattr(module, "BYTES", 2)
    assert "at most 2 bytes" in invoke("certify", path).stderr


def test_a_certificate_proves_its_bounds(folder):
    for extra in ((), ("--plant", folder / "plant.toml")):
        result = invoke("certify", folder / "optimum.json", *extra)
        assert result.exit_code == 0, result.output
        assert result.stderr == ""
        lines = result.stdout.splitlines()
        assert lines[0].startswith("continuous time, states 2, outputs 1")
        assert lines[2].startswith("tr P    0.3998705977830202649219752746")
        assert [line.split(" ")[0] for line in lines[2:6]] == ["tr", "tr", "P[1,", "P[2,"]
        assert lines[-1] == "certified"
        assert max(map(len, lines)) <= 100


@pytest.mark.parametrize(
    ("path", "value", "word"),
    [
        (["P_lo", 0, 0], "1/1", "F(P_lo) >= 0"),
        (["P_up", 0, 0], "1/100", "G_L(P_up) <= 0"),
        (["X", 0, 0], "0/1", "X > 0"),
        (["plant", "A", 0, 0], "5/1", "(A - LC)X + X(A - LC)' < 0"),
        (["plant", "V", 0, 0], "-1/100", "V > 0"),
        (["gain", 0, 0], "-9/1", "(A - LC)X + X(A - LC)' < 0"),
    ],
)
def test_an_edited_file_is_rejected_with_the_inequality(folder, path, value, word):
    file = folder / "optimum.json"
    file.write_text(edited(file.read_text(), path, value))
    result = invoke("certify", file)
    assert result.exit_code == 1
    assert result.stdout.startswith("rejected: ")
    assert word in result.stdout
    assert "tr P" not in result.stdout


def test_swapped_bounds_are_rejected(folder):
    file = folder / "optimum.json"
    raw = json.loads(file.read_text())
    raw["P_lo"], raw["P_up"] = raw["P_up"], raw["P_lo"]
    file.write_text(json.dumps(raw))
    result = invoke("certify", file)
    assert (result.exit_code, result.stdout) == (1, "rejected: F(P_lo) >= 0, G_L(P_up) <= 0: does not hold\n")


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("-0.3", "-0.30000000000000004", "A"),
        ("C = [[1.0", "C = [[-1.0", "C"),
        ("0.0, 1.0]]\nV", "0.0, 1.5]]\nV", "W"),
        ("0.01", "0.02", "V"),
        ("V =", "N = [[0.0], [0.01]]\nV =", "N"),
        ("V =", "M = [[1.0, 0.0], [0.0, 2.0]]\nV =", "M"),
        ("continuous", "discrete", "time"),
    ],
)
def test_a_certificate_of_another_plant_is_rejected(folder, old, new, key):
    text = PLANT.replace(old, new) if key != "time" else PLANT.replace(old, new).replace("-2.0", "-0.2")
    assert text != PLANT
    (folder / "other.toml").write_text(text)
    result = invoke("certify", folder / "optimum.json", "--plant", folder / "other.toml")
    assert (result.exit_code, result.stdout) == (1, f"rejected: made for another plant: {key} differs\n")


def test_what_takes_too_long_to_decide_is_not_certified(folder, monkeypatch):
    monkeypatch.setattr(arithmetic, "WORK", 1)
    monkeypatch.setattr(arithmetic, "_dominant", lambda table: False)
    result = invoke("certify", folder / "optimum.json")
    assert result.exit_code == 3
    assert result.stdout.startswith("not certified: ")


def test_a_gain_is_certified_and_its_certificate_verified(folder):
    result = invoke("certify", "--plant", folder / "plant.toml", "--gain", folder / "L.csv", "-o", folder / "gain.json")
    assert result.exit_code == 0, result.output
    assert "relative 0.000449" in result.stdout
    again = invoke("certify", folder / "gain.json", "--plant", folder / "plant.toml")
    assert (again.exit_code, again.stdout) == (0, result.stdout)
    gain = read_certificate(folder / "gain.json").gain
    assert [gain[i, 0] for i in range(2)] == [Fraction(3.9), Fraction(7.1)]


def test_a_gain_that_does_not_stabilise_is_refuted(folder):
    (folder / "L.csv").write_text("-3.9\n7.1\n")
    target = folder / "gain.json"
    result = invoke("certify", "--plant", folder / "plant.toml", "--gain", folder / "L.csv", "-o", target)
    assert result.exit_code == 1
    assert result.stdout.startswith(
        "refuted: the gain does not stabilise: A - LC has a mode with real part at least 1.78"
    )
    assert not target.exists()


def test_a_gain_about_which_nothing_is_proved_ends_with_3(folder, monkeypatch):
    import lmi.certification.sandwich as module

    def give_up(plant, gain):
        raise NotCertifiedError("no luck")

    monkeypatch.setattr(module, "certified", give_up)
    result = invoke("certify", "--plant", folder / "plant.toml", "--gain", folder / "L.csv")
    assert (result.exit_code, result.stdout) == (3, "not certified: no luck\n")


@pytest.mark.parametrize(
    "text", ["3.9\n7.1", "# from a paper\n3.9 # first\n\n+71e-1;\n".replace(";", ""), "\ufeff3.9\r\n7.1\r\n"]
)
def test_gains_are_read_as_they_come(folder, text):
    (folder / "L.csv").write_text(text, encoding="utf-8")
    plant = load_plant(folder / "plant.toml")
    assert command_module.read_gain(folder / "L.csv", plant).tolist() == [[3.9], [7.1]]


@pytest.mark.parametrize("separator", [",", ", ", ";", "\t", "  "])
def test_gains_have_any_separator(tmp_path, separator):
    plant = example_plant()
    rows = [separator.join(f"{i}.{j}" for j in range(plant.l)) for i in range(plant.n)]
    (tmp_path / "L.csv").write_text("\n".join(rows))
    gain = command_module.read_gain(tmp_path / "L.csv", plant)
    assert gain.shape == (plant.n, plant.l)
    assert gain[2, 1] == 2.1


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "at least one"), ("3.9, 7.1\n", "transpose"), ("1\n2\n3\n", "shape"), ("1\n1 2\n", "equal length"),
        ("1\nx\n", ":2:"), ("1\nnan\n", ":2:"), ("1\ninf\n", ":2:"), ("1\n1_0\n", ":2:"), ("1\n1,\n", ":2:"),
        ("1\n0x1\n", ":2:"), ("1\n1e400\n", "finite"),
    ],
)  # fmt: skip
def test_bad_gains_are_one_line_and_exit_code_2(folder, text, word):
    (folder / "L.csv").write_text(text)
    result = invoke("certify", "--plant", folder / "plant.toml", "--gain", folder / "L.csv")
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert word in result.stderr
    assert "L.csv" in result.stderr


def test_usage_and_missing_files_end_with_2(folder):
    plant, gain, certificate = folder / "plant.toml", folder / "L.csv", folder / "optimum.json"
    for args in (
        (),
        ("--plant", plant),
        ("--gain", gain),
        (certificate, "--gain", gain, "--plant", plant),
        (certificate, "-o", folder / "x.json"),
        ("--plant", plant, "--gain", folder / "nothing.csv"),
        ("--plant", folder / "nothing.toml", "--gain", gain),
        ("--plant", plant, "--gain", folder),
        ("--plant", plant, "--gain", gain, "-o", folder / "no" / "where.json"),
        (certificate, "--plant", folder / "nothing.toml"),
    ):
        result = invoke("certify", *args)
        assert result.exit_code == 2, (args, result.output)
        assert len(result.stderr.splitlines()) == 1


def test_a_validation_writes_its_certificate_and_carries_it(folder, monkeypatch):
    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], ROUTES[2]))
    result = invoke("validate", folder / "plant.toml", "--certificate", folder / "v.json", "--format", "json")
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert report["certificate"] == json.loads((folder / "v.json").read_text())
    (folder / "report.json").write_text(result.stdout)
    for file in ("v.json", "report.json"):
        again = invoke("certify", folder / file, "--plant", folder / "plant.toml")
        assert again.exit_code == 0, again.output
    text = invoke("validate", folder / "plant.toml")
    assert "certified: 0.39987059778302026492197527464" in text.stdout
    (folder / "plant.toml").write_text(PLANT + "M = [[0.0, 0.0], [0.0, 2.0]]\n")
    text = invoke("validate", folder / "plant.toml")
    assert "certified: 0.72453509221322316333655520886" in text.stdout  # twice the second variance
    assert "<= tr(MP) <= that + " in text.stdout


def test_a_validation_without_certificate_is_unconfirmed(folder, monkeypatch):
    def give_up(plant):
        raise NotCertifiedError("no luck")

    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], ROUTES[2]))
    monkeypatch.setattr("lmi.certification.sandwich.certified", give_up)
    result = invoke("validate", folder / "plant.toml", "--certificate", folder / "v.json")
    assert result.exit_code == 3
    assert "no certificate: not certified: no luck" in result.stdout
    assert result.stdout.splitlines()[-1] == "unconfirmed: there is no certificate"
    assert not (folder / "v.json").exists()
    monkeypatch.setattr(outcome_module, "LARGEST", 1)
    assert "not attempted: 2 states" in invoke("validate", folder / "plant.toml").stdout


def test_a_certificate_that_contradicts_riccati_is_a_disagreement(folder, monkeypatch):
    def of_more_noise(plant):
        return certified(type(plant)(**{**vars(plant), "W": plant.W * 1.001}))

    monkeypatch.setattr(validation_module, "ROUTES", (ROUTES[0], ROUTES[2]))
    monkeypatch.setattr("lmi.certification.sandwich.certified", of_more_noise)
    validation = lmi.validate(folder / "plant.toml")
    assert validation.excluded
    assert validation.verdict is Verdict.DISAGREE
    assert invoke("validate", folder / "plant.toml").exit_code == 1


def test_verifying_a_file_loads_no_number_crunching(folder):
    code = f"""
import sys
from lmi.cli import cli
try:
    cli.main(["certify", {str(folder / "optimum.json")!r}])
except SystemExit as end:
    assert end.code == 0
heavy = {{"numpy", "scipy", "cvxpy", "clarabel", "casadi", "sympy", "flint", "z3", "rich"}} & set(sys.modules)
assert not heavy, heavy
assert not any(name.startswith(("derive.numeric", "lmi.certification")) for name in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=dict(os.environ))
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("certified\n")


def test_printed_decimals_are_outward_and_tight():
    rng = np.random.default_rng(0)
    for _ in range(2000):
        top, bottom = (int(rng.integers(1, 2**62)) ** int(rng.integers(1, 4)) for _ in range(2))
        x = Fraction(top, bottom) * (-1) ** int(rng.integers(0, 2))
        digits = int(rng.integers(1, 33))
        low, high = Fraction(at_least(x, digits)), Fraction(at_most(x, digits))
        assert low <= x <= high
        assert high - low <= abs(x) * Fraction(10) ** (2 - digits)
    assert (at_least(Fraction(0), 5), at_most(Fraction(0), 5)) == ("0", "0")
    huge = Fraction(7**9000, 3)
    assert Fraction(at_least(huge, 5)) <= huge <= Fraction(at_most(huge, 5))


def test_ends_are_told_apart_by_their_digits():
    third = Interval(Fraction(1, 3), Fraction(1, 3) + Fraction(1, 10**20))
    low, high = ends(third)
    assert low.startswith("0.33333333333333333333")
    assert Fraction(low) <= third.lower < third.upper <= Fraction(high)
    assert len(low) < 26
    text, width = above(third)
    assert Fraction(text) + Fraction(width) >= third.upper
    assert Fraction(width) < Fraction(2, 10**20)
