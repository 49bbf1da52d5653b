"""Lecture notes: one document model and its writers.

>>> import derive
>>> page = derive.notes.page(["observer"])
>>> page.proved == page.total
True
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from derive.errors import InputError
from derive.files import write

if TYPE_CHECKING:
    from derive.notes.model import Document

__all__ = ["SUFFIXES", "page", "write_notes"]

SUFFIXES = (".html", ".json", ".md")


def page(keys: Sequence[str]) -> Document:
    """Return the notes of some lectures, each replayed by the kernel, as one document."""
    from derive.notes.model import document_of, join
    from derive.theory import lecture

    found = [lecture(key) for key in keys]
    documents = [document_of(item, item.verify()) for item in found]
    return documents[0] if len(documents) == 1 else join("Equations of optimal estimation", (), documents)


def write_notes(keys: Sequence[str], path: Path) -> Document | None:
    """Write the notes of some lectures; the suffix of the path chooses the format.

    Raises:
        InputError: an unknown lecture or suffix, or a path that cannot be written.
    """
    if path.suffix not in SUFFIXES:
        raise InputError(
            f"{path}: expected a name that ends in {', '.join(SUFFIXES)}, got {path.suffix or 'no suffix'!r}"
        )
    if path.suffix == ".json":
        write(path, _json(keys))
        return None
    document = page(keys)
    if path.suffix == ".html":
        from derive.notes.html import html

        write(path, html(document))
    else:
        from derive.notes.markdown import markdown

        write(path, markdown(document))
    return document


def _json(keys: Sequence[str]) -> str:
    from json import dumps

    from derive.document import lecture_to_json
    from derive.theory import lecture

    data = [lecture_to_json(lecture(key)) for key in keys]
    return dumps(data[0] if len(data) == 1 else data, ensure_ascii=False, indent=1) + "\n"
