"""A long document on several pages: cut before sections, with links that lead from one page to another."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from derive.notes.html import block
from derive.notes.model import Block, Display, Document, Figure, Link, Note, Para, Row, Section, Table

__all__ = ["LIMIT", "anchors", "parts"]

LIMIT = 480_000  # bytes of the blocks of a page; style and font come on top


def parts(document: Document, name: str, limit: int = LIMIT) -> dict[str, Document]:
    """Return the pages of a document by their names: ``name`` alone if it is short, else also ``name-2`` and so on.

    A section is never cut, and no page has blocks of more than ``limit`` bytes unless a single section has.
    """
    groups = list(_filled(_sections(document.blocks), limit))
    if len(groups) == 1:
        return {name: document}
    names = [name, *(f"{name}-{i}" for i in range(2, len(groups) + 1))]
    place = {anchor: page for page, blocks in zip(names, groups, strict=True) for anchor in anchors(blocks)}
    others = tuple(piece for i, page in enumerate(names, 1) for piece in (Link(f"Part {i}", "", page), " · "))
    return {
        page: replace(
            document,
            title=document.title if page == name else f"{document.title}, part {i}",
            subtitle=(*others, *document.subtitle),
            blocks=tuple(_relinked(b, page, place) for b in blocks),
        )
        for i, (page, blocks) in enumerate(zip(names, groups, strict=True), 1)
    }


def anchors(blocks: Iterable[Block]) -> Iterator[str]:
    """Iterate over the anchors in some blocks."""
    for content in blocks:
        if isinstance(content, (Section, Note)):
            yield content.id
        elif isinstance(content, Display):
            yield from (row.id for row in content.rows)


def _sections(blocks: Sequence[Block]) -> Iterator[list[Block]]:
    """Iterate over what stands from one heading to the next; a heading right after another stays with it."""
    group: list[Block] = []
    for content in blocks:
        if isinstance(content, Section) and not all(isinstance(b, Section) for b in group):
            yield group
            group = []
        group.append(content)
    if group:
        yield group


def _filled(sections: Iterable[list[Block]], limit: int) -> Iterator[list[Block]]:
    """Fill page after page with sections."""
    page, size = list[Block](), 0
    for section in sections:
        more = sum(len(block(content).encode()) for content in section)
        if page and size + more > limit:
            yield page
            page, size = [], 0
        page, size = [*page, *section], size + more
    yield page


def _relinked(value: Any, page: str, place: Mapping[str, str]) -> Any:
    """Let the links in a block lead to the page where their anchor is."""
    match value:
        case Link(target=target, page="") if place.get(target, page) != page:
            return replace(value, page=place[target])
        case tuple():
            return tuple(_relinked(v, page, place) for v in value)
        case Display() | Row() | Para() | Note() | Table() | Figure():
            return replace(value, **{f.name: _relinked(getattr(value, f.name), page, place) for f in fields(value)})
        case _:
            return value
