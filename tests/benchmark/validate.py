"""The time of a whole `lmi validate` from the shell, beyond that of importing its two large libraries."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.benchmark.table import Row, best_of
from tests.derive.numeric.plants import random_plant

SECONDS = {4: 2.0, 10: 4.0, 20: 10.0}
IMPORTS = "import cvxpy, casadi"


def validate() -> list[Row]:
    """Return the times at n = 4, 10 and 20, in both time types."""
    imports = best_of(3, lambda: subprocess.run([sys.executable, "-c", IMPORTS], check=True))[0]
    with TemporaryDirectory() as folder:
        return [_row(Path(folder), n, kind, imports) for n in SECONDS for kind in ("continuous", "discrete")]


def _row(folder: Path, n: int, kind: str, imports: float) -> Row:
    plant = random_plant(kind, n, max(1, n // 3), seed=1)
    path = folder / f"{kind}-{n}.json"
    path.write_text(json.dumps({"time": kind} | {key: getattr(plant, key).tolist() for key in "ACWVN"}))
    command = [sys.executable, "-m", "lmi", "validate", str(path)]
    seconds, done = best_of(3, lambda: subprocess.run(command, capture_output=True, text=True))
    beyond = seconds - imports
    value = f"{beyond:.2f} s beyond {imports:.2f} s of imports, exit code {done.returncode}"
    return Row(f"{kind}, n = {n}", value, f"{SECONDS[n]:g} s, agree", done.returncode == 0 and beyond <= SECONDS[n])
