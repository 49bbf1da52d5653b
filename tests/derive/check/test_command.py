"""The command `derive check`: arguments, formats, exit codes, one line for whatever is wrong."""

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

import derive
from derive.check.frontmatter import yaml_subset
from derive.cli import cli

GAIN = r"L = A P C^\top (C P C^\top + R)^{-1}"
WRONG = r"L = P C^\top (C P C^\top + R)^{-1}"
NOTE = f"""# A note

<!-- derive: theory=luenberger-dt -->

$$
{GAIN} \\tag{{1}}
$$

$${WRONG}$$ {{#eq:wrong}}

with $P = ($ of no interest.
"""


def run(*arguments, stdin=None):
    result = CliRunner().invoke(cli, ["check", *map(str, arguments)], input=stdin)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


@pytest.fixture
def note(tmp_path, monkeypatch):
    """Return the name of a note in the present folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "note.md").write_text(NOTE, encoding="utf-8")
    return "note.md"


def test_a_note_with_an_error(note):
    result = run(note)
    assert (result.exit_code, result.stderr) == (1, "")
    heads = [line for line in result.stdout.splitlines() if line.startswith("note.md")]
    assert heads == [
        "note.md:6: (1) proved (kernel), luenberger-dt",
        "note.md:9: (eq:wrong) refuted (exact instance), luenberger-dt",
    ]
    assert f"nearest  {GAIN} " in result.stdout
    assert result.stdout.endswith("2 claims: 1 proved, 1 refuted\n")


def test_options_hold_for_every_claim():
    result = run("P = 3", "--theory", "luenberger-dt", "--scalar", "--format", "json", "--assume", "A = 2",
                 "--assume", "Q = 0", "--assume", "C = 1", "--assume", "R = 1")  # fmt: skip
    (claim,) = json.loads(result.stdout)["claims"]
    assert (result.exit_code, claim["verdict"]) == (0, "proved")


def test_json_alone_on_standard_output(note):
    result = run(note, "none.md", "P = (", "--format", "json")
    data = json.loads(result.stdout)
    assert result.exit_code == 2
    assert [(c["file"], c["line"], c["verdict"]) for c in data["claims"]] == [
        ("note.md", 6, "proved"), ("note.md", 9, "refuted"), ("", 0, "error"),
    ]  # fmt: skip
    assert [line.startswith("derive: ") for line in result.stderr.splitlines()] == [True, True]


def test_sarif(note):
    (found,) = json.loads(run(note, "--format", "sarif").stdout)["runs"][0]["results"]
    assert (found["ruleId"], found["locations"][0]["physicalLocation"]["region"]["startLine"]) == ("refuted", 9)


def test_certificates_are_replayed(note):
    result = run(note, "--certificates", "proofs")
    assert result.exit_code == 1
    replayed = CliRunner().invoke(cli, ["verify", "proofs/001-1.json"])
    assert (replayed.exit_code, "1 of 1 proved (kernel)" in replayed.stdout) == (0, True)


def test_standard_input():
    result = run("-", "--theory", "luenberger-dt", stdin=f"{GAIN}\n{WRONG}\n")
    assert result.exit_code == 1
    assert "-:2: u2 refuted" in result.stdout


def test_a_refutation_on_a_guess_asks_for_the_theory():
    result = run(WRONG)
    assert result.exit_code == 3
    assert "--theory luenberger-dt" in result.stdout
    assert "refuted (" not in result.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "Missing argument"),
        (("P = P", "--theory", "kalman"), "theory: expected observer-ct"),
        (("P = P", "--assume", "P ="), "assume 'P =': column 4"),
        (("P = P", "--jobs", "0"), "--jobs"),
        (("P = P", "--timeout", "x"), "--timeout"),
        (("P = P", "--format", "xml"), "--format"),
        (("P = P", "--certificates", "a/b/c"), "a/b/c"),
    ],
)
def test_wrong_usage_gives_one_line(note, arguments, said):
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert said in line


HOSTILE = [
    '__import__("os").system("touch broken")',
    "$(touch broken)",
    r"\input{/etc/passwd}",
    r"\write18{touch broken}",
    "(" * 20_000,
    "a" * 2**20,
    "P = 9^{9^{9^{9^{9}}}}",
    "{" * 5000 + "}" * 5000,
    r"\frac" * 5000,
    "\x00",
    "\udcff",
    "",
]


@pytest.mark.parametrize("claim", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_claims_end_in_one_line(claim, note, tmp_path):
    result = run(claim, "--theory", "luenberger-dt")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert len(line) < 600
    assert not (tmp_path / "broken").exists()


def test_hostile_files_end_in_one_line_each(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = {
        "macro.md": "\\newcommand{\\a}{\\a\\a}\n$$\\a = 1$$", "open.tex": "\\begin{align}" * 5000,
        "head.md": "---\nderive: &a [*a, *a]\n---\n", "deep.ipynb": "[" * 10**6, "nan.jsonl": '{"latex": NaN}',
        "number.jsonl": '{"latex": ' + "9" * 10**5 + "}",
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        result = run(name, "--theory", "luenberger-dt")
        assert (result.exit_code, len(result.stderr.splitlines())) == (2, 1), name


def test_the_command_as_a_process(note):
    command = [sys.executable, "-m", "derive", "check", "note.md", "--format", "json", "--jobs", "2"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (1, "")
    assert [c["verdict"] for c in json.loads(done.stdout)["claims"]] == ["proved", "refuted"]


INTERRUPTIBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what a shell runs in the background
from derive.cli import main
main()
"""


def runs(pid):
    """Whether a process runs, a moment after it was ended."""
    for _ in range(500):
        status = Path(f"/proc/{pid}/stat")
        if not status.exists() or " Z " in status.read_text():
            return False
        time.sleep(0.01)
    return True


def test_an_interruption_ends_the_command_cleanly(note, tmp_path):
    lines = "\n".join(json.dumps({"latex": GAIN, "theory": "luenberger-dt"}) for _ in range(3000))
    (tmp_path / "many.jsonl").write_text(lines, encoding="utf-8")
    command = [sys.executable, "-c", INTERRUPTIBLE, "check", "many.jsonl"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None and not children.read_text():
        pass
    workers = [int(pid) for pid in children.read_text().split()]
    process.send_signal(signal.SIGINT)
    out, err = process.communicate()
    assert workers
    assert (process.returncode, out, err.strip()) == (130, "", "derive: stopped")
    assert not any(map(runs, workers))


# ------------------------------------------------------------------------------------------------ the hook
def test_the_hook_runs_this_command():
    text = (Path(derive.__file__).parents[1] / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    hook = yaml_subset(text.replace("- id:", "  id:"))
    assert (hook["id"], hook["entry"], hook["language"]) == ("derive-check", "derive check", "python")
    assert all(re.search(hook["files"], name) for name in ("a.md", "b/c.tex", "d.ipynb", "e.jsonl", "f.qmd"))
    assert not re.search(hook["files"], "a.md.py")
