"""The published collections CAREX and DAREX, read as estimation problems by duality."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from derive.numeric.modes import Matrix
from derive.numeric.plant import Plant

__all__ = ["COLLECTIONS", "Collection", "Example", "published"]

Collection = Literal["carex", "darex"]
COLLECTIONS: tuple[Collection, ...] = get_args(Collection)


@dataclass(frozen=True, eq=False)
class Example:
    """A regulator problem and the plant that is its dual: A', B', Q, R, S are the plant's A, C, W, V, N.

    Attributes:
        name: as of the archive.
        plant: the plant, unchecked: some examples have R singular or Q indefinite.
        truth: the stabilising solution of the stored doubles, rounded to doubles (n, n), or None.
        rest: what `truth` lacks (n, n).
    """

    name: str
    plant: Plant
    truth: Matrix | None
    rest: Matrix | None

    def error(self, P: Matrix) -> float:
        """Return |P - truth| / |truth|, Frobenius norms, to the digits of a double-double."""
        assert self.truth is not None
        assert self.rest is not None
        return float(np.linalg.norm(P - self.truth - self.rest) / (np.linalg.norm(self.truth) or 1.0))


def published(collection: Collection) -> Iterator[Example]:
    """Iterate over a collection; there is nothing in it unless DERIVE_BENCH names the folder of the collections."""
    folder = os.environ.get("DERIVE_BENCH")
    for path in sorted(Path(folder, collection).glob("*.npz")) if folder else ():
        with np.load(path) as data:
            yield _example(path.stem, dict(data), "continuous" if collection == "carex" else "discrete")


def _example(name: str, data: dict[str, Matrix], time: Literal["continuous", "discrete"]) -> Example:
    n, l = data["B"].shape  # noqa: E741
    cross = data["S"] if data["S"].size else np.zeros((n, l))
    plant = Plant(time=time, A=data["A"].T, C=data["B"].T, W=data["Q"], V=data["R"], N=cross, M=np.eye(n), name=name)
    known = "X_hp" in data and data["X_hp"].size > 0
    return Example(name, plant, data["X_hp"] if known else None, data["X_hp_lo"] if known else None)
