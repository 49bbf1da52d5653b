"""Plant files: TOML, JSON, NumPy and MATLAB archives, each read to keys and values; nothing is ever unpickled.

In a MATLAB file an empty matrix is a key that is not given, a struct holds units by name, a cell array names.
"""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import InputError
from derive.numeric.fields import closest

__all__ = ["read_mapping"]


def read_mapping(path: Path) -> dict[str, Any]:
    """Read a file by its suffix.

    Raises:
        InputError: a missing, empty or unreadable file, a folder, an unknown suffix, text that is not TOML or JSON.
    """
    if path.is_dir():
        raise InputError(f"{path}: expected a file, got a folder; name the plant file in it")
    if path.suffix.lower() not in READERS:
        raise InputError(
            f"{path}: expected a file ending in {', '.join(READERS)}, got {path.suffix or 'no suffix'}; "
            f"{closest(path.suffix.lower(), READERS)}"
        )
    try:
        if path.stat().st_size == 0:
            raise InputError(f"{path}: expected a plant, got an empty file; it needs time, A, C, W and V")
        return READERS[path.suffix.lower()](path)
    except FileNotFoundError:
        raise InputError(f"{path}: expected a file, found none; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: expected a readable file, got {error.strerror or error}; check the file") from None


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected text in UTF-8, got other bytes; save it as UTF-8") from None


def _toml(path: Path) -> dict[str, Any]:
    text = _text(path)
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected TOML, got an error: {_line(error)}; correct that line") from None


def _json(path: Path) -> dict[str, Any]:
    text = _text(path)
    try:
        data = json.loads(text, object_pairs_hook=_unique)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected JSON, got an error: {_line(error)}; correct that line") from None
    if not isinstance(data, dict):
        raise InputError(f'{path}: expected a JSON object, got {type(data).__name__}; write {{"A": [[...]], ...}}')
    return data


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    repeated = {key for key in keys if keys.count(key) > 1}
    if repeated:
        raise ValueError(f"key {min(repeated)!r} is given twice")
    return dict(pairs)


def _npz(path: Path) -> dict[str, Any]:
    import zipfile

    try:
        archive = np.load(path, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise InputError(f"{path}: expected an .npz archive, got a single array; write it with numpy.savez")
        with archive:
            return {key: _plain(archive[key]) for key in archive.files}
    except InputError:
        raise
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(
            f"{path}: expected an .npz archive of numbers and texts, got an error: {_line(error)}; "
            "write it with numpy.savez"
        ) from None


def _mat(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        data = loadmat(path)
    except (NotImplementedError, MatReadError, ValueError, TypeError) as error:
        raise InputError(
            f"{path}: expected a MATLAB file of version 7 or older, got an error: {_line(error)}; save it with -v7"
        ) from None
    plain = {key: _plain(value) for key, value in data.items() if not key.startswith("__")}
    return {key: value for key, value in plain.items() if not (isinstance(value, np.ndarray) and value.size == 0)}


def _plain(value: Any) -> Any:
    """Return a text for an array that holds at most one text, keys and values for a MATLAB struct, else the array."""
    if not isinstance(value, np.ndarray):
        return value
    if value.dtype.names and value.size == 1:
        record = value.ravel()[0]
        return {name: _plain(record[name]) for name in value.dtype.names}
    return "".join(value.ravel().tolist()) if value.dtype.kind == "U" and value.size <= 1 else value


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


READERS: dict[str, Callable[[Path], dict[str, Any]]] = {".toml": _toml, ".json": _json, ".npz": _npz, ".mat": _mat}
