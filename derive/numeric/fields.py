"""Checks of the values that a user gives for a plant: each failure says what was expected, what was got, the remedy."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from numbers import Real
from typing import Any

import numpy as np

from derive.errors import InputError
from derive.numeric.modes import Matrix

__all__ = [
    "check_keys",
    "check_shape",
    "closest",
    "positive_definite",
    "positive_semidefinite",
    "read_matrix",
    "read_names",
    "read_number",
    "read_text",
    "symmetric",
]

SYMMETRY_RTOL = 1e-10
"""Largest |X - X'| taken for rounding, relative to the largest entry."""

DEFINITE_RTOL = 1e-12
"""Largest negative eigenvalue taken for rounding, relative to the largest eigenvalue."""

SINGULAR_RTOL = 1e-14
"""Smallest eigenvalue of a noise correlation matrix that counts as positive."""


def read_matrix(name: str, value: Any) -> Matrix:
    """Return a finite real matrix (rows, columns); a bare number is 1 x 1.

    Raises:
        InputError: entries that are no numbers, ragged rows, a vector, NaN or infinity, no entries.
    """
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return np.array([[read_number(name, value)]])
    rows = [_row(name, i, row) for i, row in enumerate(value, start=1)]
    if not rows or not rows[0]:
        raise InputError(
            f"{name}: expected a matrix with at least one entry, got none; write [[1.0]] for one row of one"
        )
    for i, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise InputError(
                f"{name}: expected rows of equal length, "
                f"got {len(rows[0])} entries in row 1 and {len(row)} in row {i}; complete the shorter one"
            )
    return np.array(rows)


def _row(name: str, i: int, row: Any) -> list[float]:
    if not isinstance(row, list | tuple):
        raise InputError(
            f"{name}: expected a list of rows, got {_show(row)} as row {i}; "
            "write [[1.0, 0.0]] for one row, [[1.0], [0.0]] for one column"
        )
    return [read_number(f"{name}[{i}][{j}]", entry) for j, entry in enumerate(row, start=1)]


def read_number(name: str, value: Any) -> float:
    """Return a finite real number; booleans, strings and complex numbers are none."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise InputError(f"{name}: expected a real number, got {_show(value)}; write it as 1 or 1.0")
    try:
        number = float(value)
    except OverflowError:
        number = np.inf
    if not np.isfinite(number):
        raise InputError(f"{name}: expected a finite number, got {number}; remove or replace it")
    return number


def read_text(name: str, value: Any) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise InputError(f'{name}: expected a text, got {_show(value)}; write it in quotes, as "..."')
    return value


def read_names(name: str, value: Any, count: int) -> tuple[str, ...]:
    """Return `count` different texts."""
    if isinstance(value, np.ndarray):
        value = [str(entry.item() if isinstance(entry, np.ndarray) else entry) for entry in value.ravel()]
    if not isinstance(value, list | tuple):
        raise InputError(f'{name}: expected a list of {count} names, got {_show(value)}; write ["...", "..."]')
    names = tuple(read_text(f"{name}[{i}]", entry).strip() for i, entry in enumerate(value, start=1))
    if len(names) != count:
        raise InputError(f"{name}: expected {count} names, got {len(names)}; give one for each")
    if len(set(names)) != count:
        raise InputError(f"{name}: expected different names, got {_show(list(names))}; rename the repeated one")
    return names


def check_keys(data: Mapping[str, Any], known: Iterable[str]) -> None:
    """Refuse keys that mean nothing here, and suggest the nearest that does."""
    known = tuple(known)
    for key in data:
        if key not in known:
            raise InputError(f"{key}: unknown key; {closest(str(key), known)}")


def closest(word: str, known: Iterable[str]) -> str:
    """Return "did you mean X?", or the list of what is known."""
    known = tuple(known)
    folded = {name.casefold(): name for name in known}
    near = get_close_matches(word.casefold(), folded, n=1, cutoff=0.6)
    return f"did you mean {folded[near[0]]}?" if near else f"known are {', '.join(known)}"


def check_shape(name: str, matrix: Matrix, shape: tuple[int, int]) -> Matrix:
    """Return the matrix when it has the shape."""
    if matrix.shape != shape:
        raise InputError(f"{name}: expected shape {shape}, got {matrix.shape}; {_remedy(matrix, shape)}")
    return matrix


def _remedy(matrix: Matrix, shape: tuple[int, int]) -> str:
    return (
        "transpose it"
        if matrix.shape == shape[::-1]
        else "the number of states is that of A, of outputs that of C's rows"
    )


def symmetric(name: str, matrix: Matrix) -> Matrix:
    """Return (X + X')/2 when X differs from X' by rounding only."""
    difference = np.abs(matrix - matrix.T)
    if difference.max() > SYMMETRY_RTOL * np.abs(matrix).max():
        i, j = np.unravel_index(difference.argmax(), difference.shape)
        raise InputError(
            f"{name}: expected a symmetric matrix, got {matrix[i, j]:.6g} at ({i + 1}, {j + 1}) "
            f"and {matrix[j, i]:.6g} at ({j + 1}, {i + 1}); make them equal"
        )
    return (matrix + matrix.T) / 2


def positive_semidefinite(name: str, matrix: Matrix, remedy: str = "a covariance has no negative eigenvalue") -> Matrix:
    """Return the symmetric matrix when no eigenvalue is negative beyond rounding."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    size = np.abs(eigenvalues).max()
    if eigenvalues[0] < -DEFINITE_RTOL * size:
        raise InputError(
            f"{name}: not positive semidefinite: eigenvalue {eigenvalues[0]:.6g} "
            f"(relative {eigenvalues[0] / size:.3g}); {remedy}"
        )
    return matrix


def positive_definite(name: str, matrix: Matrix, remedy: str = "every output needs some noise") -> Matrix:
    """Return the symmetric matrix when all eigenvalues are positive, whatever the units of its rows."""
    diagonal = np.diag(matrix)
    size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    if diagonal.min() <= 0 or np.linalg.eigvalsh(matrix / np.outer(size, size))[0] < SINGULAR_RTOL:
        eigenvalues = np.linalg.eigvalsh(matrix)
        relative = eigenvalues[0] / (np.abs(eigenvalues).max() or 1.0)
        raise InputError(
            f"{name}: not positive definite: eigenvalue {eigenvalues[0]:.6g} (relative {relative:.3g}); {remedy}"
        )
    return matrix


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
