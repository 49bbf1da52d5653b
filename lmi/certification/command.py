"""What `lmi certify` does: verify a file, or certify a gain from anywhere; lines to print and an exit code."""

import re
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.errors import InputError
from derive.numeric.fields import read_matrix
from derive.numeric.plant import Plant

__all__ = ["as_gain", "certify_gain", "read_gain"]

Matrix = NDArray[np.floating[Any]]

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
BYTES = 16_000_000


def as_gain(name: str, value: Any, plant: Plant) -> Matrix:
    """Return an observer gain L (n, l) of a plant.

    Raises:
        InputError: no matrix of that shape.
    """
    gain = read_matrix(name, value)
    wanted = (plant.n, plant.l)
    if gain.shape != wanted:
        remedy = "transpose it" if gain.shape == wanted[::-1] else "one row for each state, one column for each output"
        raise InputError(f"{name}: expected shape {wanted}, got {gain.shape}; {remedy}")
    return gain


def read_gain(path: str | PathLike[str], plant: Plant) -> Matrix:
    """Read a gain: one line for each state, numbers separated by commas, semicolons or blanks; # starts a comment.

    Raises:
        InputError: no such file, no numbers, another shape.
    """
    path = Path(path)
    try:
        if path.stat().st_size > BYTES:
            raise InputError(f"{path}: expected a gain, got a file of more than {BYTES} bytes; check the path")
        lines = path.read_bytes().decode("utf-8-sig").splitlines()
    except FileNotFoundError:
        raise InputError(f"{path}: expected a file, found none; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: expected a readable file, got {error.strerror or error}; check the file") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected text in UTF-8, got other bytes; save it as CSV") from None
    rows = [(number, line.partition("#")[0].strip()) for number, line in enumerate(lines, start=1)]
    return as_gain(str(path), [_row(path, number, line) for number, line in rows if line], plant)


def _row(path: Path, number: int, line: str) -> list[float]:
    entries = re.split(r"\s*[,;]\s*|\s+", line)
    for entry in entries:
        if not NUMBER.fullmatch(entry):
            raise InputError(f"{path}:{number}: expected numbers, got {entry[:40]!r}; write 1.5 or 1.5e-3")
    return [float(entry) for entry in entries]


def certify_gain(plant: Plant, gain: Matrix, output: str | None) -> tuple[list[str], int]:
    """Prove a bound on a gain, or that it does not stabilise.

    Returns:
        Lines to print, and 0, 1 or 3 for the command line.
    """
    from lmi.certificate.file import write_certificate
    from lmi.certificate.report import proved_lines
    from lmi.certification.sandwich import NotCertifiedError, UnstableGainError, certified

    try:
        certificate, bounds = certified(plant, gain)
    except UnstableGainError as error:
        return [f"refuted: {error}"], 1
    except NotCertifiedError as error:
        return [f"not certified: {error}"], 3
    if output is not None:
        write_certificate(certificate, output)
    return [*proved_lines(certificate, bounds), "certified"], 0
