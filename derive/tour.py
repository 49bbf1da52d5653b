"""The tour: every lecture with its certificates, the findings on its sources, and one plant by every route.

The first page holds the lectures but the long ones, which have pages of their own beside it; links lead there and back.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import Any

from derive.catalogue import DOCUMENTS
from derive.derivation import Lecture
from derive.document import lecture_to_json
from derive.files import make_folder, write
from derive.notes.handout import write_figures
from derive.notes.html import html
from derive.notes.markdown import markdown
from derive.notes.model import (
    Block,
    Document,
    Inline,
    Link,
    Note,
    Para,
    Section,
    Table,
    document_of,
    slug,
    with_sources,
)
from derive.notes.parts import anchors, parts
from derive.notes.sliders import slider_page
from derive.numeric.plant import Plant
from derive.replay import Report, verify_file
from derive.theory import LECTURES, OWN_PAGE, lecture
from derive.worked import worked_example

__all__ = ["Summary", "write_certificates", "write_tour"]

TITLE = "Equations of optimal estimation"
SUBTITLE = "Every row carries the reason why it is true, and a certificate that the kernel has replayed."
ABOUT_EXAMPLE = (
    "A control problem read as an estimation problem: by duality the transposes of the aircraft's state and input "
    "matrix are A and C, its state and input weight are the noise intensities W and V. The states are those of the "
    "dual system. The published state weight is rounded to three decimals and thereby indefinite, which no noise is; W "
    "is positive definite and differs from it by 0.0003 in each entry."
)


ABOUT_SLIDERS = (
    "One state and one output: move the parameters and the start, and see the error covariance and its way to the "
    "steady state. The curves are computed by programs exported from the proved closed forms. "
)


@dataclass(frozen=True)
class Chapter:
    """A lecture as the tour shows it: laid out with the verdicts of its replay from the file."""

    lecture: Lecture
    report: Report
    document: Document
    seconds: float = 0.0
    pages: Mapping[str, Document] = field(default_factory=dict[str, Document])

    @property
    def page(self) -> str:
        """The page on which it begins, none if it is the first one of the tour."""
        return next(iter(self.pages), "")

    def places(self) -> dict[str, str]:
        """Return the page of each anchor."""
        return {anchor: name for name, page in self.pages.items() for anchor in anchors(page.blocks)}

    @property
    def count(self) -> str:
        """How many steps are proved."""
        return f"{self.document.proved} of {self.document.total} steps proved and replayed"


@dataclass(frozen=True)
class Summary:
    """What the tour wrote and found."""

    folder: Path
    chapters: tuple[Chapter, ...]
    plant: str
    verdict: str
    seconds: float

    @property
    def expected(self) -> bool:
        """Whether every step is proved and the plant's routes agree."""
        return all(c.report.accepted for c in self.chapters) and self.verdict == "agree"

    def lines(self) -> Iterator[str]:
        """Iterate over the lines of the summary, which fits on one screen."""
        width = max(len(c.lecture.title) for c in self.chapters)
        for c in self.chapters:
            errata = len(c.lecture.errata)
            yield (
                f"{c.lecture.title:{width}}  {c.report.proved:3} of {c.report.total:3} steps proved, "
                f"{errata} finding{'s' * (errata != 1)} on the source, {c.seconds:.1f} s"
            )
        proved, total = (sum(getattr(c.report, name) for c in self.chapters) for name in ("proved", "total"))
        yield f"{'All lectures':{width}}  {proved:3} of {total:3} steps proved and replayed by the kernel"
        yield f"{self.plant}: the routes to the optimal error covariance {self.verdict}"
        yield f"Open {self.folder / 'index.html'} (or index.md); certificates/*.json replay with: derive verify"
        yield f"{self.seconds:.1f} s"


def write_tour(
    folder: Path,
    plant: Plant,
    validate: Callable[[Plant], Mapping[str, Any]],
    about: str = ABOUT_EXAMPLE,
    progress: Callable[[str], None] = lambda _: None,
) -> Summary:
    """Write index.html, index.md, the pages of long lectures, sliders, figures and certificates into a folder.

    Args:
        folder: made unless it exists.
        plant: the worked example.
        validate: returns what every route says of a plant, as data of schema lmi-validate/1.
        about: what to know of the plant.
        progress: called with the name of each piece of work as it starts.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    start = perf_counter()
    make_folder(folder)
    chapters = write_certificates(folder, progress)
    progress(f"validating {plant.name}")
    validation = validate(plant)
    progress("writing the pages")
    write_page(folder, "index", bind(chapters, worked_example(plant, validation, about)))
    for chapter in chapters:
        for name, page in chapter.pages.items():
            write_page(folder, name, page)
        if chapter.lecture.key == "scalar":
            sliders = slider_page(chapter.report.outcomes, chapter.page or "index", "index", chapter.places())
            write(folder / "sliders.html", sliders)
    return Summary(folder, tuple(chapters), plant.name, str(validation["verdict"]), perf_counter() - start)


def write_certificates(folder: Path, progress: Callable[[str], None] = lambda _: None) -> list[Chapter]:
    """Write each lecture with its certificates, replay the file, and lay the lecture out with those verdicts."""
    make_folder(folder / "certificates")
    chapters: list[Chapter] = []
    for key in LECTURES:
        progress(f"proving {key}")
        start = perf_counter()
        current, path = lecture(key), folder / "certificates" / f"{key}.json"
        write(path, json.dumps(lecture_to_json(current), ensure_ascii=False, indent=1) + "\n")
        (report,) = verify_file(path)
        document = document_of(current, report.outcomes)
        pages = own_pages(document, key) if key in OWN_PAGE else {}
        chapters.append(Chapter(current, report, document, perf_counter() - start, pages))
    return chapters


def write_page(folder: Path, name: str, page: Document) -> None:
    """Write a page as HTML, and as Markdown with its drawings in files."""
    write(folder / f"{name}.html", html(page))
    write(folder / f"{name}.md", markdown(page, write_figures(folder, name, page)))


def bind(chapters: Sequence[Chapter], example: Sequence[Block]) -> Document:
    """Bind the lectures, or a line that leads to their pages, the findings and the worked example into one page."""
    blocks = [block for c in chapters for block in (reference(c) if c.page else with_sources(c.document))]
    if any(c.lecture.key == "scalar" for c in chapters):
        there = Link("Open the page", "", "sliders.html")
        blocks += [Section("The scalar filter by sliders", 1, "sliders"), Para((ABOUT_SLIDERS, there, "."))]
    blocks += [*findings(chapters), *example]
    proved, total = (sum(getattr(c.document, name) for c in chapters) for name in ("proved", "total"))
    return Document(TITLE, (SUBTITLE,), tuple(blocks), proved, total)


def reference(chapter: Chapter) -> list[Block]:
    """Return what the first page says of a lecture with a page of its own."""
    key, errata = chapter.lecture.key, len(chapter.lecture.errata)
    found = f", {errata} finding{'s' * (errata != 1)} on the source" if errata else ""
    certificates = Link("certificates", "", f"certificates/{key}.json")
    text = (Link("A page of its own", "", chapter.page), f": {chapter.count}{found}; its ", certificates, ".")
    return [Section(chapter.lecture.title, 1, slug(key)), Para(text)]


def own_pages(document: Document, key: str) -> dict[str, Document]:
    """Return the pages of a long lecture, each with the way back."""
    sources = ("Source: ", *document.subtitle) if any(document.subtitle) else ()
    there = replace(document, subtitle=sources)
    back = Link("All lectures", "", "index")
    return {name: replace(page, subtitle=(back, " · ", *page.subtitle)) for name, page in parts(there, key).items()}


def findings(chapters: Iterable[Chapter]) -> list[Block]:
    """Return the table of what the sources print and what is true."""
    pages = [item for c in chapters for item in (c.pages or {"": c.document}).items()]
    notes = [(block, name) for name, page in pages for block in page.blocks if isinstance(block, Note)]
    rows: list[tuple[Inline, ...]] = [
        (
            (DOCUMENTS.get(note.source, ("", note.source))[1], f", ({note.number})" if note.number else ""),
            (note.badge,),
            note.printed,
            (Link("why", note.id, page),),
        )
        for note, page in sorted(notes, key=lambda found: found[0].source)
    ]
    return [
        Section("Findings on the sources", 1, "findings"),
        Para(("What the sources print was derived again. Here the result differs, needs more, or goes further.",)),
        Table(("source", "finding", "as printed", ""), tuple(rows)),
    ]
