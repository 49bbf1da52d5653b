"""Checks of the values that a user gives: each failure says what was expected, what was got and the remedy."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from numbers import Real
from typing import Any

import numpy as np

from derive.errors import InputError
from derive.numeric.modes import Matrix

__all__ = [
    "Fields",
    "closest",
    "positive_definite",
    "positive_semidefinite",
    "read_matrix",
    "read_names",
    "read_number",
    "read_text",
    "show",
    "symmetric",
]

LARGEST = 1e50
"""Largest number, and inverse of the smallest, so that C^2/V and its like stay within double precision."""

SYMMETRY_RTOL = 1e-10
"""Largest |X - X'| taken for rounding, relative to the largest entry."""

DEFINITE_RTOL = 1e-12
"""Largest negative eigenvalue taken for rounding, relative to the largest eigenvalue."""

SINGULAR_RTOL = 1e-14
"""Smallest eigenvalue of a noise correlation matrix that counts as positive."""


@dataclass(frozen=True)
class Fields:
    """Values by key, and the key that the user wrote for each."""

    values: Mapping[str, Any]
    names: Mapping[str, str]

    @classmethod
    def of(cls, data: Mapping[str, Any], known: Iterable[str], synonyms: Mapping[str, str]) -> "Fields":
        """Refuse keys that are unknown, or given twice under two names; leave out values that are None."""
        known = (*known, *synonyms)
        for key in data:
            if key not in known:
                word = " ".join(str(key).split())
                raise InputError(f"{word:.40}: unknown key; {closest(word, known)}")
        given = {key: value for key, value in data.items() if value is not None}
        for other, key in synonyms.items():
            if other in given and key in given:
                raise InputError(f"{other}: expected one of {key} and {other}, got both; they mean the same, keep one")
        names = {synonyms.get(key, key): key for key in given}
        return cls({key: given[name] for key, name in names.items()}, names)

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def required(self, key: str, meaning: str) -> Any:
        """Return the value of a key that must be there."""
        if key not in self:
            raise InputError(f"{key}: missing key, expected {meaning}; add it")
        return self.values[key]

    def matrix(self, key: str, rows: int | None, columns: int | None, meaning: str = "") -> Matrix:
        """Return the matrix of a key, of the given shape where it is not None."""
        matrix = read_matrix(self.names.get(key, key), self.required(key, meaning))
        wanted = (rows or len(matrix), columns or matrix.shape[1])
        if matrix.shape != wanted:
            raise InputError(
                f"{self.names[key]}: expected shape {_shape(rows, columns)}, got {matrix.shape}; "
                + ("transpose it" if matrix.shape == wanted[::-1] else "states are counted by A, outputs by C")
            )
        return matrix

    def optional(self, key: str, rows: int | None, columns: int | None) -> Matrix | None:
        """Return the matrix of a key, or None without the key."""
        return self.matrix(key, rows, columns) if key in self else None


def _shape(rows: int | None, columns: int | None) -> str:
    return f"({rows or 'any'}, {columns or 'any'})"


def read_matrix(name: str, value: Any) -> Matrix:
    """Return a finite real matrix (rows, columns); a bare number is 1 x 1, a sparse matrix is filled.

    Raises:
        InputError: entries that are no numbers, ragged rows, a vector, NaN or infinity, no entries.
    """
    if hasattr(value, "toarray"):
        value = value.toarray()
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return np.array([[read_number(name, value)]])
    rows = [_row(name, i, row) for i, row in enumerate(value, start=1)]
    if not rows or not rows[0]:
        raise InputError(f"{name}: expected a matrix with at least one entry, got none; write [[1.0]] for a number")
    for i, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise InputError(
                f"{name}: expected rows of equal length, got {len(rows[0])} in row 1 and {len(row)} in row {i}; "
                "complete the shorter one"
            )
    return np.array(rows)


def _row(name: str, i: int, row: Any) -> list[float]:
    if isinstance(row, np.ndarray):
        row = row.tolist()
    if not isinstance(row, list | tuple):
        raise InputError(
            f"{name}: expected a list of rows, got {show(row)} as row {i}; "
            "write [[1.0, 0.0]] for one row, [[1.0], [0.0]] for one column"
        )
    return [read_number(f"{name}[{i}][{j}]", entry) for j, entry in enumerate(row, start=1)]


def read_number(name: str, value: Any) -> float:
    """Return a finite real number of a size that squares; booleans, texts and complex numbers are none."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise InputError(f"{name}: expected a real number, got {show(value)}; write it as 1 or 1.0")
    try:
        number = float(value)
    except OverflowError:
        number = np.inf
    if not np.isfinite(number):
        raise InputError(f"{name}: expected a finite number, got {number}; remove or replace it")
    if number and not 1 / LARGEST <= abs(number) <= LARGEST:
        raise InputError(
            f"{name}: expected 0 or a size between {1 / LARGEST:g} and {LARGEST:g}, got {number:g}; choose other units"
        )
    return number


def read_text(name: str, value: Any) -> str:
    """Return a text in one line, without characters that steer a terminal or that no file can hold."""
    if not isinstance(value, str):
        raise InputError(f'{name}: expected a text, got {show(value)}; write it in quotes, as "..."')
    text = " ".join(value.split())
    if not text.isprintable():
        raise InputError(f"{name}: expected printable characters, got {show(text)}; remove the others")
    return text


def read_names(name: str, value: Any, count: int) -> tuple[str, ...]:
    """Return `count` different texts; a single one needs no list."""
    if isinstance(value, str) and count == 1:
        value = [value]
    if isinstance(value, np.ndarray):
        value = [entry.item() if isinstance(entry, np.ndarray) else entry for entry in value.ravel().tolist()]
    if not isinstance(value, list | tuple):
        raise InputError(f'{name}: expected a list of {count} names, got {show(value)}; write ["...", "..."]')
    names = tuple(read_text(f"{name}[{i}]", entry).strip() for i, entry in enumerate(value, start=1))
    if not all(names):
        raise InputError(f"{name}: expected names, got an empty one in {show(list(names))}; name it")
    if len(names) != count:
        raise InputError(f"{name}: expected {count} names, got {len(names)}; give one for each")
    if len(set(names)) != count:
        raise InputError(f"{name}: expected different names, got {show(list(names))}; rename the repeated one")
    return names


def closest(word: str, known: Iterable[str]) -> str:
    """Return "did you mean X?", or the list of what is known."""
    known = tuple(known)
    folded = {name.casefold(): name for name in known}
    near = get_close_matches(word.casefold(), folded, n=1, cutoff=0.6)
    return f"did you mean {folded[near[0]]}?" if near else f"known are {', '.join(known)}"


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
        raise InputError(f"{name}: not positive semidefinite: {_eigenvalue(eigenvalues)}; {remedy}")
    return matrix


def positive_definite(name: str, matrix: Matrix, remedy: str = "every output needs some noise") -> Matrix:
    """Return the symmetric matrix when all eigenvalues are positive, whatever the units of its rows."""
    diagonal = np.diag(matrix)
    size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    if diagonal.min() <= 0 or np.linalg.eigvalsh(matrix / np.outer(size, size))[0] < SINGULAR_RTOL:
        raise InputError(f"{name}: not positive definite: {_eigenvalue(np.linalg.eigvalsh(matrix))}; {remedy}")
    return matrix


def _eigenvalue(eigenvalues: Matrix) -> str:
    relative = eigenvalues[0] / (np.abs(eigenvalues).max() or 1.0)
    return f"eigenvalue {eigenvalues[0]:.6g} (relative {relative:.3g})"


def show(value: Any) -> str:
    """Return a value for a message: short, in one line, texts in quotes."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 40 else text[:37] + "..."
