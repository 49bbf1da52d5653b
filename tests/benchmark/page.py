"""The page of what was measured: a table for each section, with the day, the machine and the versions."""

from __future__ import annotations

import os
import platform
import re
import subprocess
from collections.abc import Mapping, Sequence
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tests.benchmark.table import Row

__all__ = ["write_page"]

HEAD = """# Benchmarks

Everything on this page was measured, and is written by `python -m tests.benchmark --page docs/benchmarks.md`; run it
without `--page` for the figures of your machine. Times are wall time unless a row says otherwise, ratios compare what
ran one after the other in the same process or from the same shell. Unless OMP_NUM_THREADS says otherwise, linear
algebra has one core, for us and for the peers. A row that misses its target says so.

PICOS, CVXOPT, python-control and slycot take part where they are installed (`pip install -e '.[benchmark]'`). The
published collections CAREX and DAREX are read from the folder that the environment variable DERIVE_BENCH names, as
archives with A, B, Q, R, S and a reference solution in double-double.
"""

PACKAGES = ("numpy", "scipy", "cvxpy", "clarabel", "casadi", "python-flint", "picos", "cvxopt", "control", "slycot")

MET = {True: "yes", False: "**no**"}


def write_page(path: Path, results: Mapping[str, Sequence[Row]]) -> None:
    """Write the sections that were measured, and keep the others of the page as they are."""
    sections = _sections(path.read_text(encoding="utf-8")) if path.exists() else {}
    sections |= {name: _section(name, rows) for name, rows in results.items()}
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text("\n".join([HEAD, *(sections[name] for name in sorted(sections))]), encoding="utf-8")
    temporary.replace(path)


def _sections(text: str) -> dict[str, str]:
    """Return the sections of a page by their headings."""
    parts = re.split(r"^## (.+)\n", text, flags=re.MULTILINE)[1:]
    return {name: f"## {name}\n\n{body.strip()}\n" for name, body in zip(parts[::2], parts[1::2], strict=True)}


def _section(name: str, rows: Sequence[Row]) -> str:
    lines = ["| measured | value | target | met |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(map(_cell, (r.name, r.value, r.target)))} | {MET[r.ok]} |" for r in rows]
    return f"## {name}\n\n{_where()}\n\n" + "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;").replace("_", "\\_").replace("*", "\\*")


def _where() -> str:
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    place = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    return f"{date.today()}, commit {done.stdout.strip() or 'unknown'}; {place}; {', '.join(_versions())}."


def _versions() -> list[str]:
    found = []
    for package in PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return found
