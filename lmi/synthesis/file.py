"""Designs as JSON: schema lmi-design/1, the gain stored once; `lmi certify` verifies its certificate."""

import json
import re
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from derive.files import write
from lmi.synthesis.achieved import Achieved
from lmi.synthesis.designs import Design

__all__ = ["SCHEMA", "design_dict", "design_text", "write_design"]

SCHEMA = "lmi-design/1"


def design_dict(design: Design) -> dict[str, Any]:
    """Return a design as plain data; without a certificate, with the reason why."""
    request = design.request
    objective = {"name": request.objective, "gamma": request.gamma, "decay": request.decay, "dual": request.dual}
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "plant": _plant_dict(design),
        "objective": objective,
        "gain": None if design.gain is None else design.gain.tolist(),
        "achieved": None if design.achieved is None else _achieved_dict(design.achieved),
        "certificate": None if design.certificate is None else design.certificate.as_dict(),
    }
    return data if design.certificate is not None else {**data, "reason": design.reason}


def _plant_dict(design: Design) -> dict[str, Any]:
    """Return the plant's numbers; a dual design holds the regulator's."""
    plant = design.plant
    if design.request.dual:
        matrices = {"A": plant.A.T, "B": plant.C.T, "Q": plant.W, "R": plant.V, "S": plant.N, "M": plant.M}
    else:
        matrices = {"A": plant.A, "C": plant.C, "W": plant.W, "V": plant.V, "N": plant.N, "M": plant.M}
    period = {} if plant.dt is None else {"dt": plant.dt}
    numbers = {key: np.asarray(matrix).tolist() for key, matrix in matrices.items()}
    return {"name": plant.name, "time": plant.time, **period, **numbers}


def _achieved_dict(found: Achieved) -> dict[str, Any]:
    return {
        "h2": found.h2,
        "cost": found.cost,
        "hinf": _finite(found.hinf.upper),
        "frequency": found.hinf.frequency,
        "decay": _finite(found.decay),
        "modes": [[mode.real, mode.imag] for mode in found.modes],
    }


def _finite(x: float) -> float | None:
    return x if isfinite(x) else None


def design_text(design: Design) -> str:
    """Return a design as JSON, one row of a matrix a line."""
    text = json.dumps(design.as_dict(), indent=1, allow_nan=False)
    return re.sub(r"\[[^][{}]*\]", lambda row: re.sub(r"\s+", " ", row[0]).replace("[ ", "[").replace(" ]", "]"), text)


def write_design(design: Design, path: str | PathLike[str]) -> None:
    """Write a design.

    Raises:
        InputError: the file cannot be written.
    """
    write(Path(path), design_text(design) + "\n")
