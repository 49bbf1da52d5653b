"""The command line: what it prints, its exit codes, and one line for whatever is wrong."""

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from derive import __version__, catalogue
from derive.cli import aligned, cli
from derive.derivation import Outcome
from derive.document import lecture_to_json
from derive.theory import LECTURES, lecture


def run(*arguments):
    """Run the command line in this process."""
    result = CliRunner().invoke(cli, [str(a) for a in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def one_line(result):
    """Return the single line on standard error."""
    (line,) = result.stderr.splitlines()
    assert line.startswith("derive: ")
    return line


@pytest.fixture
def file(tmp_path):
    """Return a file with a lecture."""
    path = tmp_path / "observer.json"
    path.write_text(json.dumps(lecture_to_json(lecture("observer"))), encoding="utf-8")
    return path


def spoiled(file, name="spoiled.json"):
    """Return a file whose first certificate with addends proves something else."""
    data = json.loads(file.read_text(encoding="utf-8"))
    step = next(s for s in data["steps"] if s["certificates"][0].get("terms"))
    step["certificates"][0]["terms"][0]["coefficient"] = "11/7"
    path = file.with_name(name)
    path.write_text(json.dumps(data), encoding="utf-8")
    return path, step["name"]


# ------------------------------------------------------------------------------------------------ verify
def test_verify_replays(file):
    result = run("verify", file)
    steps = len(lecture("observer").steps)
    assert (result.exit_code, result.stdout) == (0, f"{file}: observer: {steps} of {steps} proved (kernel)\n")


def test_verify_names_what_it_rejects(file):
    path, step = spoiled(file)
    result = run("verify", path)
    assert result.exit_code == 1
    assert f"  rejected {step}: " in result.stdout


def test_verify_goes_on_after_a_bad_file_and_says_so_last(file, tmp_path):
    path, step = spoiled(file)
    (tmp_path / "bad.json").write_text("{}", encoding="utf-8")
    result = run("verify", path, tmp_path / "bad.json", tmp_path / "none.json", file)
    assert result.exit_code == 2
    assert result.stdout.count("proved (kernel)") == 2
    assert f"rejected {step}" in result.stdout
    assert len(result.stderr.splitlines()) == 2


def test_a_file_without_steps_proves_nothing(file):
    data = json.loads(file.read_text(encoding="utf-8")) | {"steps": [], "errata": [], "given": [], "symbols": []}
    empty = file.with_name("empty.json")
    empty.write_text(json.dumps(data), encoding="utf-8")
    assert run("verify", empty).exit_code == 3
    assert run("verify", empty, file).exit_code == 3
    assert run("verify", empty, spoiled(file)[0]).exit_code == 1


def test_verify_of_the_command_itself_as_a_process(file):
    path, _ = spoiled(file)
    for target, code in ((file, 0), (path, 1), (file.with_name("none"), 2)):
        done = subprocess.run([sys.executable, "-m", "derive", "verify", target], capture_output=True, text=True)
        assert done.returncode == code
        assert "Traceback" not in done.stderr


# ------------------------------------------------------------------------------------------------ list
def test_list_shows_every_lecture_proved():
    result = run("list")
    assert result.exit_code == 0
    for key in LECTURES:
        (line,) = [row for row in result.stdout.splitlines() if row.startswith(f"{key} ") and lecture(key).title in row]
        assert f" {len(lecture(key).steps)} " in line


def test_list_as_json():
    data = json.loads(run("list", "--json").stdout)
    assert [row["lecture"] for row in data["lectures"]] == list(LECTURES)
    assert all(row["proved"] == row["steps"] > 0 for row in data["lectures"])
    assert {row["theory"] for row in data["lectures"]} <= {row["theory"] for row in data["theories"]}


@pytest.mark.parametrize("document", catalogue.DOCUMENTS)
def test_equations_of_a_document(document):
    rows = json.loads(run("list", "--equations", document, "--json").stdout)
    assert rows
    assert {row["document"] for row in rows} == {document}
    assert {row["verdict"] for row in rows} <= {"proved", "refuted", "definition"}
    assert all((row["steps"] > 0) or row["verdict"] != "proved" for row in rows)
    numbers = [row["number"] for row in rows]
    assert len(set(numbers)) == len(numbers)
    assert [n.startswith("u") for n in numbers] == sorted(n.startswith("u") for n in numbers)
    unnumbered = [int(n[1:]) for n in numbers if n.startswith("u")]
    assert unnumbered == sorted(unnumbered)
    by_key = json.loads(run("list", "--equations", catalogue.DOCUMENTS[document][0], "--json").stdout)
    assert by_key == rows


def test_a_wrong_formula_of_a_source_is_listed_as_refuted():
    rows = {e.number: e for e in catalogue.equations("002")}
    false = {e.number for e in lecture("luenberger").errata if e.finding == "false"}
    assert false
    assert {n for n, e in rows.items() if e.verdict == "refuted"} == false


def test_every_lecture_that_carries_numbers_of_a_source_is_asked_for_them():
    found = {(s or lecture(k).sources[0], k) for k in LECTURES for s, _, _ in catalogue._numbered(lecture(k))}
    assert found == {(document, key) for document, keys in catalogue.DERIVED_IN.items() for key in keys}


def test_equations_as_text():
    result = run("list", "--equations", "000")
    header, *rows = result.stdout.splitlines()
    assert header.split() == ["document", "number", "verdict", "lecture", "steps"]
    assert len(rows) == len(catalogue.equations("000"))


def test_an_empty_table():
    assert aligned([]) == ""


# ------------------------------------------------------------------------------------------------ usage
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["lst"], "list"),
        (["verify"], "FILE"),
        (["list", "--equations", "003"], "000"),
        (["list", "--equation"], "--equations"),
        (["notes"], "LECTURE"),
        (["notes", "observer"], "-o"),
        (["notes", "observr", "-o", "x.md"], "observer"),
        (["notes", "observer", "-o", "x.xyz"], ".md, .html, .json"),
        (["notes", "observer", "-o", "x"], ".md, .html, .json"),
        (["notes", "observer", "-o", "no/such/folder/x.md"], "folder"),
        (["notes", "observer", "-o", "x.md", "--to", "scroll"], "gfm"),
        (["tour", "-o", "no/such/folder"], "cannot be made"),
    ],
)
def test_wrong_usage_is_one_line(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert message in one_line(result)
    assert list(tmp_path.iterdir()) == []


def test_version_and_help():
    assert run("--version").stdout == f"derive, version {__version__}\n"
    for arguments in ((), ("tour",), ("list",), ("notes",), ("verify",)):
        for option in ("-h", "--help"):
            result = run(*arguments, option)
            assert (result.exit_code, result.stderr) == (0, "")
            assert "Usage:" in result.stdout


# ------------------------------------------------------------------------------------------------ notes
@pytest.mark.parametrize("suffix", [".md", ".html", ".json"])
def test_notes_in_every_format(suffix, tmp_path):
    path = tmp_path / f"notes{suffix}"
    result = run("notes", "observer", "covariance", "-o", path)
    assert (result.exit_code, result.stderr) == (0, "")
    text = path.read_text(encoding="utf-8")
    for key in ("observer", "covariance"):
        assert lecture(key).title in text
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_notes_as_json_are_verified(tmp_path):
    for keys in (["luenberger"], ["observer", "luenberger"]):
        path = tmp_path / "l.json"
        assert run("notes", *keys, "-o", path).exit_code == 0
        result = run("verify", path)
        assert result.exit_code == 0
        assert result.stdout.count("proved (kernel)") == len(keys)


PLANT = """time = "continuous"
A = [[0.5]]
C = [[1.0]]
W = [[1.0]]
V = [[1.0]]
"""


@pytest.mark.parametrize("suffix", ["html", "md"])
def test_notes_with_a_plant_end_with_its_worked_example(suffix, tmp_path):
    plant, path = tmp_path / "mass.toml", tmp_path / f"n.{suffix}"
    plant.write_text(PLANT, encoding="utf-8")
    assert run("notes", "observer", "-o", path, "--plant", plant).exit_code == 0
    text = path.read_text(encoding="utf-8")
    assert "Worked example: mass" in text
    assert "1.6180339887498948482" in text  # the certified bounds of P, which solves P + 1 - P^2 = 0
    drawings = [p.name for p in sorted((tmp_path / "figures").iterdir())] if suffix == "md" else []
    assert all(f"figures/{name}" in text for name in drawings)
    assert bool(drawings) == (suffix == "md")


def test_a_plant_needs_a_page_and_a_file(tmp_path):
    plant = tmp_path / "mass.toml"
    plant.write_text(PLANT, encoding="utf-8")
    bad = run("notes", "observer", "-o", tmp_path / "n.json", "--plant", plant)
    assert (bad.exit_code, "expected a file ending in" in one_line(bad)) == (2, True)
    missing = run("notes", "observer", "-o", tmp_path / "n.html", "--plant", tmp_path / "none.toml")
    assert (missing.exit_code, "none.toml" in one_line(missing)) == (2, True)
    assert [p.name for p in tmp_path.iterdir()] == ["mass.toml"]


def test_an_existing_file_is_replaced_and_keeps_no_trace_of_a_failure(tmp_path):
    path = tmp_path / "notes.md"
    path.write_text("old", encoding="utf-8")
    assert run("notes", "observer", "-o", path).exit_code == 0
    assert path.read_text(encoding="utf-8") != "old"
    folder = tmp_path / "folder.md"
    folder.mkdir()
    assert run("notes", "observer", "-o", folder).exit_code == 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder.md", "notes.md"]


def test_a_write_that_fails_leaves_nothing(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", refuse)
    assert "No space left on device" in one_line(run("notes", "observer", "-o", tmp_path / "x.md"))
    assert list(tmp_path.iterdir()) == []


def test_the_place_is_looked_at_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr("derive.notes.handout.lecture", None)
    assert "expected an existing folder" in one_line(run("notes", "observer", "-o", tmp_path / "no" / "x.md"))


def test_notes_of_a_lecture_that_does_not_replay_end_with_one(tmp_path, monkeypatch):
    monkeypatch.setattr("derive.derivation.Lecture.verify", lambda self: [Outcome(s.name, False) for s in self.steps])
    assert run("notes", "observer", "-o", tmp_path / "x.md").exit_code == 1
    assert "proved and replayed" in (tmp_path / "x.md").read_text(encoding="utf-8")


def test_a_folder_without_permission(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.mkstemp", refuse)
    assert "cannot be written: Permission denied" in one_line(run("notes", "observer", "-o", tmp_path / "x.md"))
    assert list(tmp_path.iterdir()) == []
