"""Claims with known truth: formulas of estimation and regulation, true ones and near misses.

An entry carries its truth and how it can be seen without this project: a function of the letters' values that gives
both sides, evaluated with NumPy at random plants, or a sentence. Each is written in three notations.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any

GROUPS = ("discrete", "filter_form", "continuous", "regulator", "observer", "signals", "scalars", "recursions")


@dataclass(frozen=True)
class Entry:
    """A claim, its truth, and both sides as a function of the letters (argument names), or a sentence ``why``."""

    latex: str
    truth: bool
    theory: str
    sides: Callable[..., tuple[Any, Any]] | None = None
    why: str = ""
    assume: tuple[str, ...] = ()
    scalar: bool = False

    @property
    def relation(self) -> str:
        """The relation between the two sides: = ⪰ ≻ (for numbers ≥ >), sides swapped where the page has ⪯."""
        signs = r"\\succeq|\\succ|\\preceq|\\prec|\\geq?(?![a-z])|\\leq?(?![a-z])|\\neq?(?![a-z])|<|>|="
        found = re.search(signs, self.latex)
        assert found, self.latex
        return found.group(0)


def entries() -> Iterator[Entry]:
    """Iterate over all entries, in their first notation."""
    for group in GROUPS:
        yield from import_module(f"tests.reference.corpus.{group}").ENTRIES


def notations(latex: str) -> tuple[str, str, str]:
    """Return a formula as it is, in bold letters with upright transposes, and with loose brackets and primes."""
    bold = re.sub(r"(?<![\\A-Za-z{^])([A-Z])(?![a-z])", r"\\mathbf{\1}", latex).replace("^T", r"^{\mathsf T}")
    loose = re.sub(r"(?<!\\left)\(", r"\\left( ", latex.replace("^T", r"^{\top}")).replace(" = ", r" \;=\; ")
    loose = re.sub(r"(?<!\\right)\)", r" \\right)", loose)
    return latex, bold, loose


def claims() -> Iterator[tuple[str, str, Entry]]:
    """Iterate over (id, LaTeX, entry): every entry in each notation that differs from those before it."""
    for i, entry in enumerate(entries()):
        for j, latex in enumerate(dict.fromkeys(notations(entry.latex))):
            yield f"{entry.theory}-{i:03d}{'abc'[j]}", latex, entry
