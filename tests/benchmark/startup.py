"""How long the command lines take to say what they can do."""

from __future__ import annotations

import subprocess
import sys
from functools import partial

from tests.benchmark.table import Row, best_of

SECONDS, RATIO = 0.4, 12.0  # either is enough: a warm disk, or a multiple of a bare interpreter
RUNS = 5


def startup() -> list[Row]:
    """Return the time of ``derive --help`` and ``lmi --help`` against that of a bare interpreter."""
    bare, _ = best_of(RUNS, lambda: run("-c", "pass"))
    rows = [Row("bare interpreter", f"{bare:.3f} s", "", ok=True)]
    for package in ("derive", "lmi"):
        seconds, done = best_of(RUNS, partial(run, "-m", package, "--help"))
        value = f"{seconds:.3f} s, {seconds / bare:.1f} times the interpreter"
        if done.returncode:
            value = f"fails: {done.stderr.strip().splitlines()[-1]}"
        ok = done.returncode == 0 and (seconds <= SECONDS or seconds <= RATIO * bare)
        rows.append(Row(f"{package} --help", value, f"{SECONDS} s or {RATIO:.0f} times", ok))
    return rows


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run this interpreter."""
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)
