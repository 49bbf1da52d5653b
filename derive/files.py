"""Files, read and written so that bad paths give one line and no half-written file is ever left behind."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from derive.errors import InputError

__all__ = ["check_place", "make_folder", "read_limited", "write"]


def write(path: Path, content: str | bytes) -> None:
    """Write a file under a temporary name and rename it.

    Raises:
        InputError: the folder does not exist, or the file cannot be written.
    """
    check_place(path)
    data = content.encode() if isinstance(content, str) else content
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}; choose another place") from None


def check_place(path: Path) -> None:
    """Check that a file can be at this path, before long work on what goes there.

    Raises:
        InputError: the folder does not exist, or a folder has that name.
    """
    if not path.parent.is_dir():
        raise InputError(f"{path}: expected an existing folder, got {str(path.parent)!r}; make it first")
    if path.is_dir():
        raise InputError(f"{path}: expected a file name, got a folder; name a file in it")


def make_folder(path: Path) -> None:
    """Make a folder unless it is there.

    Raises:
        InputError: its parent does not exist, or a file is in the way.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: expected a folder, got a file; choose another name")
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be made: {error.strerror or error}; choose another place") from None


def read_limited(path: Path, limit: int) -> str:
    """Read a text file of at most ``limit`` bytes.

    Raises:
        InputError: no such file, a folder, too large, not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(limit + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}; check the path") from None
    if len(data) > limit:
        raise InputError(f"{path}: expected at most {limit // 2**20} MB, got more; split the file")
    try:
        return data.decode()
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected text in UTF-8, got other bytes; is it the right file?") from None


def _umask() -> int:
    value = os.umask(0)
    os.umask(value)
    return value
