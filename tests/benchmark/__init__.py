"""Speed and counts against their targets: python -m tests.benchmark [--only SECTION]."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy is loaded: everything is measured on one core
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
