"""Every snippet of README and docs runs, and prints what it says.

``pycon`` blocks are doctests, ``console`` blocks shell sessions ("$ " a command, "> " its next line, then its output,
where ... stands for what varies). The blocks of a page share a folder and a Python session, in order.
"""

import doctest
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(?P<kind>[^\n]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
BY_CI = re.compile(r"python3 -m pip install|python3 -m venv|python3 -m pytest|ruff|sphinx-build|PIP_CONSTRAINT")
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
KINDS = {"console", "pycon", "sh", "{toctree}"}


def blocks(page):
    """Return (kind, body, line) of the fenced blocks of a page."""
    text = page.read_text(encoding="utf-8")
    return [(m["kind"].strip(), m["body"], text[: m.start()].count("\n") + 1) for m in BLOCK.finditer(text)]


def sessions(body):
    """Return (command, expected output) of a shell session."""
    found = []
    for line in body.splitlines():
        if line.startswith("$ "):
            found.append([line[2:], ""])
        elif line.startswith("> "):
            found[-1][0] += "\n" + line[2:]
        else:
            found[-1][1] += line + "\n"
    return found


def run_shell(command, folder):
    """Run a command as a reader would; returns its exit code and what the terminal shows."""
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        command, shell=True, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    return done.returncode, done.stdout


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_snippets_run_and_print_what_they_say(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    checker, session, runner = doctest.OutputChecker(), {}, doctest.DocTestRunner(optionflags=FLAGS)
    for kind, body, line in blocks(page):
        if kind == "pycon":
            test = doctest.DocTestParser().get_doctest(body, session, page.name, str(page), line)
            report = []
            runner.run(test, out=report.append, clear_globs=False)
            assert not report, "".join(report)
            session.update(test.globs)
        elif kind == "console" and not BY_CI.search(body):
            for command, expected in sessions(body):
                code, shown = run_shell(command, tmp_path)
                assert code == 0, f"{page.name}:{line}: {command}: exit code {code}\n{shown}"
                assert checker.check_output(expected, shown, FLAGS) or not expected, (
                    f"{page.name}:{line}: {command} prints\n{shown}\nthe page says\n{expected}"
                )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_says_what_it_is(page):
    assert {kind for kind, _, _ in blocks(page)} <= KINDS


def test_a_wrong_snippet_is_noticed(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    for body in ("```pycon\n>>> 1 + 1\n3\n```\n", "```console\n$ false\n```\n", "```console\n$ echo a\nb\n```\n"):
        page.write_text(body, encoding="utf-8")
        with pytest.raises(AssertionError):
            test_snippets_run_and_print_what_they_say(page, tmp_path, monkeypatch)


def test_the_readme_has_the_two_commands_each_alone():
    alone = [body.strip() for kind, body, _ in blocks(ROOT / "README.md") if kind == "sh"]
    assert "python3 -m pip install -e . && derive tour -o tour" in alone
    assert "python3 -m pip install -e '.[test]' && python3 -m pytest" in alone
    assert "python3 -m venv .venv && . .venv/bin/activate" in alone


def test_the_line_that_makes_an_environment_makes_one(tmp_path):
    (line,) = (b.strip() for k, b, _ in blocks(ROOT / "README.md") if k == "sh" and "venv" in b)
    code, shown = run_shell(f"{line} && python3 -c 'import sys; print(sys.prefix)'", tmp_path)
    assert (code, Path(shown.strip())) == (0, tmp_path / ".venv")


def test_links_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_picture_is_a_small_png():
    picture = ROOT / "docs" / "images" / "tour.png"
    data = picture.read_bytes()
    assert data.startswith(b"\x89PNG")
    assert len(data) < 200 * 1024
    assert f"({picture.relative_to(ROOT)})" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_nothing_names_a_registry_or_the_workplace():
    files = [p for p in ROOT.rglob("*") if p.suffix in {".py", ".md", ".toml", ".txt", ".css"} and p.is_file()]
    names = ["/work/" + "shared", "SEED_" + "AUDIT", "index-" + "url", "//py" + "pi."]
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split()
    for file in files:
        if not tracked or str(file.relative_to(ROOT)) in tracked:
            text = file.read_text(encoding="utf-8")
            assert not [name for name in names if name in text], file


def test_continuous_integration_reads_its_commands_from_the_readme():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert os.access(ROOT / ".ci" / "run", os.X_OK)
    assert "grep '^python3 -m pip install -e ' README.md" in script
