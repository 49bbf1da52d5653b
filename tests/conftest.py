"""Make the tests' own packages importable, from whatever folder pytest starts, and keep each process to one core."""

import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # small matrices; the processes of pytest-xdist share the cores
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).parents[1]))
