"""Notes of lectures as one file; its suffix chooses the format."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from derive.derivation import Lecture, Outcome
from derive.document import lecture_to_json
from derive.errors import InputError
from derive.files import check_place, write
from derive.theory import LECTURES, lecture

__all__ = ["FORMATS", "page", "write_notes"]

if TYPE_CHECKING:
    from derive.notes.model import Document

Replayed = Sequence[tuple[Lecture, Sequence[Outcome]]]


def page(keys: Sequence[str]) -> Document:
    """Return the notes of some lectures, each replayed by the kernel, as one document."""
    return _page([(lecture(key), lecture(key).verify()) for key in keys])


def write_notes(
    keys: Sequence[str], path: Path, flavour: str | None = None, progress: Callable[[str], None] = lambda _: None
) -> bool:
    """Write the notes of lectures; returns whether every step is proved.

    Args:
        keys: lectures, in the order in which they are shown.
        path: file with a suffix that is a format.
        flavour: of Markdown; None is the usual one.
        progress: called with the name of each lecture as it starts.

    Raises:
        InputError: an unknown lecture, suffix or flavour, or a place that cannot be written to.
    """
    if path.suffix not in FORMATS:
        raise InputError(f"{path}: expected a suffix {', '.join(FORMATS)}, got {path.suffix or 'none'!r}; rename it")
    if flavour and path.suffix != ".md":
        raise InputError(f"--to {flavour}: expected a file ending in .md, got {path.suffix!r}; leave --to out")
    unknown = [key for key in keys if key not in LECTURES]
    if unknown:
        raise InputError(f"lecture {unknown[0]!r}: unknown; known are {', '.join(LECTURES)}")
    check_place(path)
    replayed: list[tuple[Lecture, Sequence[Outcome]]] = []
    for key in dict.fromkeys(keys):
        progress(f"proving {key}")
        replayed.append((lecture(key), lecture(key).verify()))
    write(path, FORMATS[path.suffix](replayed))
    return all(outcome.accepted for _, outcomes in replayed for outcome in outcomes)


def _json(replayed: Replayed) -> str:
    data = [lecture_to_json(lecture) for lecture, _ in replayed]
    return json.dumps(data[0] if len(data) == 1 else data, ensure_ascii=False, indent=1) + "\n"


def _html(replayed: Replayed) -> str:
    from derive.notes.html import html

    return html(_page(replayed))


def _markdown(replayed: Replayed) -> str:
    from derive.notes.markdown import markdown

    return markdown(_page(replayed))


def _page(replayed: Replayed) -> Document:
    from derive.notes.model import document_of, join

    documents = [document_of(lecture, outcomes) for lecture, outcomes in replayed]
    return documents[0] if len(documents) == 1 else join("Notes on optimal estimation", (), documents)


FORMATS: dict[str, Callable[[Replayed], str]] = {".md": _markdown, ".html": _html, ".json": _json}
