"""Make the tests' own packages importable, from whatever folder pytest starts."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
