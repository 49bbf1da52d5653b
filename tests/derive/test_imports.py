"""Starting is instant and the layers hold: what is imported, seen from a fresh interpreter."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import derive

ROOT = Path(derive.__file__).parents[1]
HEAVY = {
    "numpy", "scipy", "sympy", "casadi", "cvxpy", "clarabel", "z3", "flint", "pypandoc", "matplotlib", "rich",
    "fontTools", "ziamath", "control",
}  # fmt: skip


def loaded(code):
    """Return the top-level modules, and ours in full, that a fresh interpreter holds after running code."""
    script = f"import sys\n{code}\nprint('MODULES', *sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "80"}
    )
    names = done.stdout.rpartition("MODULES")[2].split()
    return {n.partition(".")[0] for n in names} | {n for n in names if n.startswith(("derive.", "lmi."))}


def command(*arguments):
    """Return code that runs a command line and goes on."""
    package, *rest = arguments
    return f"""
sys.argv = {list(arguments)}
from {package}.cli import cli
try:
    cli.main({rest})
except SystemExit as end:
    assert not end.code, end.code
"""


@pytest.mark.parametrize("code", ["import derive", "import lmi"])
def test_importing_a_package_loads_nothing_else(code):
    names = loaded(code)
    assert not names & (HEAVY | {"click", "json"})
    assert {n for n in names if n.startswith(("derive.", "lmi."))} <= {"derive._version", "derive.errors"}


@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("tour", "--help"), ("notes", "--help")])
def test_help_and_version_load_only_the_command_line(arguments):
    names = loaded(command("derive", *arguments))
    assert "derive.cli" in names
    assert not names & HEAVY
    assert {n for n in names if n.startswith("derive.")} <= {"derive._version", "derive.errors", "derive.cli"}
    assert not any(n.startswith("lmi") for n in names)


def test_listing_and_replay_need_no_number():
    names = loaded(command("derive", "list", "--equations", "002"))
    assert {"derive.catalogue", "derive.derivation"} <= names
    assert not names & HEAVY


def test_a_lecture_is_loaded_when_it_is_used():
    names = loaded("import derive; derive.observer.lecture()")
    assert "derive.theory.observer" in names
    assert "derive.theory.covariance" not in names
    assert not names & HEAVY


def imports_of(path):
    """Return the modules that a file imports, wherever in the file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("module", ["kernel", "rules", "terms", "context", "derivation", "serialise", "wellformed"])
def test_the_trusted_modules_use_the_standard_library_only(module):
    ours = {"derive", "__future__"}
    found = {name.partition(".")[0] for name in imports_of(ROOT / "derive" / f"{module}.py")}
    assert found <= set(sys.stdlib_module_names) | ours


def test_the_kernel_stands_alone_and_is_short():
    source = ROOT / "derive" / "kernel.py"
    assert not [name for name in imports_of(source) if name.startswith("derive")]
    assert len(source.read_text(encoding="utf-8").splitlines()) <= 300


def test_derive_never_imports_lmi_but_for_the_command_line():
    users = [p for p in (ROOT / "derive").rglob("*.py") if any(n.partition(".")[0] == "lmi" for n in imports_of(p))]
    assert [p.name for p in users] == ["cli.py"]


def test_lmi_imports_only_numbers_claims_errors_and_files_but_for_the_page_of_the_command_line():
    allowed = ("derive.numeric", "derive.claim", "derive.errors", "derive.files", "derive._version")
    for path in (ROOT / "lmi").rglob("*.py"):
        page = ("derive.validation_page",) if path.name == "cli.py" else ()
        foreign = [n for n in imports_of(path) if n.startswith("derive") and not n.startswith((*allowed, *page))]
        assert not foreign, path


def test_nothing_imports_the_command_line_or_the_search_from_below():
    for name in ("kernel", "rules", "terms", "context", "derivation", "serialise", "document", "replay"):
        upper = ("derive.cli", "derive.tour", "derive.notes", "derive.matrix", "derive.theory.builder")
        assert not [n for n in imports_of(ROOT / "derive" / f"{name}.py") if n.startswith(upper)], name
