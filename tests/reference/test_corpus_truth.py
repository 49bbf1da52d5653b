"""The truth of the corpus, without this project: NumPy at random plants."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.reference.corpus import Entry, claims, entries
from tests.reference.corpus.plants import PLANTS, SCALAR_PLANTS

SEEDS = range(40)
EVALUATED = [e for e in entries() if e.sides is not None]


def _values(entry: Entry) -> Iterator[dict[str, Any]]:
    """Iterate over plants that satisfy what is assumed of definiteness, which random plants do not all do."""
    for seed in SEEDS:
        plant = (SCALAR_PLANTS if entry.scalar else PLANTS)[entry.theory](seed)
        if entry.scalar:
            plant = {name: float(value[0, 0]) for name, value in plant.items()}
        yield plant


def _holds(entry: Entry, plant: dict[str, Any]) -> bool:
    assert entry.sides is not None
    left, right = entry.sides(**{name: plant[name] for name in inspect.signature(entry.sides).parameters})
    if entry.relation in (r"\preceq", r"\prec", r"\le", "<"):
        left, right = right, left
    difference, scale = np.atleast_2d(left - right), 1 + np.abs(left).max() + np.abs(right).max()
    if entry.relation == "=":
        return bool(np.abs(difference).max() < 1e-7 * scale)
    return bool(np.linalg.eigvalsh((difference + difference.T) / 2).min() > -1e-9 * scale)


@pytest.mark.parametrize("entry", EVALUATED, ids=lambda e: f"{e.theory}: {e.latex}")
def test_truth_at_random_plants(entry: Entry) -> None:
    """A true formula holds at every plant; a false one fails at one at least."""
    assert all(_holds(entry, plant) for plant in _values(entry)) == entry.truth


def test_size() -> None:
    """At least 400 claims, both truths, each with its reason, no formula with two truths."""
    found = list(claims())
    assert len(found) >= 400
    truths = [entry.truth for _, _, entry in found]
    assert 0.35 < sum(truths) / len(truths) < 0.65
    assert all(entry.sides or entry.why for _, _, entry in found)
    keys = [(e.theory, e.latex, e.assume, e.scalar) for e in entries()]
    assert len(keys) == len(set(keys))
