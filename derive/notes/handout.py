"""Notes of lectures as one file; its suffix chooses the format."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from derive.derivation import Lecture, Outcome
from derive.document import lecture_to_json
from derive.errors import InputError
from derive.files import check_place, make_folder, write
from derive.theory import LECTURES, lecture

__all__ = ["FORMATS", "page", "write_figures", "write_notes"]

if TYPE_CHECKING:
    from derive.notes.model import Block, Document

Replayed = Sequence[tuple[Lecture, Sequence[Outcome]]]


def page(keys: Sequence[str]) -> Document:
    """Return the notes of some lectures, each replayed by the kernel, as one document."""
    return _page([(lecture(key), lecture(key).verify()) for key in keys])


def write_notes(
    keys: Sequence[str],
    path: Path,
    flavour: str | None = None,
    progress: Callable[[str], None] = lambda _: None,
    example: Callable[[], Sequence[Block]] | None = None,
) -> bool:
    """Write the notes of lectures; returns whether every step is proved.

    Args:
        keys: lectures, in the order in which they are shown.
        path: file with a suffix that is a format.
        flavour: of Markdown; None is the usual one.
        progress: called with the name of each lecture as it starts.
        example: gives the blocks of a worked example, which end the notes; the drawings of Markdown are files.

    Raises:
        InputError: an example in a format without pages, an unknown lecture, suffix or flavour, or a place that
            cannot be written to.
    """
    if path.suffix not in FORMATS:
        raise InputError(f"{path}: expected a suffix {', '.join(FORMATS)}, got {path.suffix or 'none'!r}; rename it")
    if flavour and path.suffix != ".md":
        raise InputError(f"--to {flavour}: expected a file ending in .md, got {path.suffix!r}; leave --to out")
    if example and path.suffix not in PAGES:
        raise InputError(f"--plant: expected a file ending in {' or '.join(PAGES)}, got {path.suffix!r}; rename it")
    unknown = [key for key in keys if key not in LECTURES]
    if unknown:
        raise InputError(f"lecture {unknown[0]!r}: unknown; known are {', '.join(LECTURES)}")
    check_place(path)
    replayed: list[tuple[Lecture, Sequence[Outcome]]] = []
    for key in dict.fromkeys(keys):
        progress(f"proving {key}")
        replayed.append((lecture(key), lecture(key).verify()))
    if path.suffix in PAGES:
        PAGES[path.suffix](path, _page(replayed, example() if example else ()))
    else:
        write(path, _json(replayed))
    return all(outcome.accepted for _, outcomes in replayed for outcome in outcomes)


def _json(replayed: Replayed) -> str:
    data = [lecture_to_json(lecture) for lecture, _ in replayed]
    return json.dumps(data[0] if len(data) == 1 else data, ensure_ascii=False, indent=1) + "\n"


def _html(path: Path, page: Document) -> None:
    from derive.notes.html import html

    write(path, html(page))


def _markdown(path: Path, page: Document) -> None:
    from derive.notes.markdown import markdown

    write(path, markdown(page, write_figures(path.parent, path.stem, page)))


def write_figures(folder: Path, page_name: str, page: Document) -> list[str]:
    """Write the drawings of a page as files for its Markdown; returns their names."""
    from derive.notes.model import Figure

    figures = [block.svg for block in page.blocks if isinstance(block, Figure)]
    if figures:
        make_folder(folder / "figures")
    names = [f"figures/{page_name}-{i}.svg" for i in range(1, len(figures) + 1)]
    for name, svg in zip(names, figures, strict=True):
        write(folder / name, svg)
    return names


def _page(replayed: Replayed, example: Sequence[Block] = ()) -> Document:
    from derive.notes.model import document_of, join

    documents = [document_of(lecture, outcomes) for lecture, outcomes in replayed]
    if len(documents) == 1:
        return replace(documents[0], blocks=(*documents[0].blocks, *example))
    return join("Notes on optimal estimation", (), documents, example)


PAGES: dict[str, Callable[[Path, Document], None]] = {".md": _markdown, ".html": _html}
FORMATS = (*PAGES, ".json")
