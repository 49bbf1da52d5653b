"""The tour: every lecture with its certificates, the findings on its sources, and one plant by every route."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any

from derive.catalogue import DOCUMENTS
from derive.derivation import Lecture
from derive.document import lecture_to_json
from derive.files import make_folder, write
from derive.notes.html import html
from derive.notes.markdown import markdown
from derive.notes.model import Block, Document, Figure, Inline, Link, Note, Para, Section, Table, document_of, join
from derive.numeric.plant import Plant
from derive.replay import Report, verify_file
from derive.theory import IN_TOUR, lecture
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


@dataclass(frozen=True)
class Chapter:
    """A lecture as the tour shows it: laid out with the verdicts of its replay from the file."""

    lecture: Lecture
    report: Report
    document: Document


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
                f"{errata} finding{'s' * (errata != 1)} on the source"
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
    """Write index.html, index.md, figures and certificates into a folder.

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
    progress("writing the page")
    page = bind(chapters, worked_example(plant, validation, about))
    write(folder / "index.html", html(page))
    write(folder / "index.md", markdown(page, write_figures(folder, page)))
    return Summary(folder, tuple(chapters), plant.name, str(validation["verdict"]), perf_counter() - start)


def write_certificates(folder: Path, progress: Callable[[str], None] = lambda _: None) -> list[Chapter]:
    """Write each lecture with its certificates, replay the file, and lay the lecture out with those verdicts."""
    make_folder(folder / "certificates")
    chapters: list[Chapter] = []
    for key in IN_TOUR:
        progress(f"proving {key}")
        current, path = lecture(key), folder / "certificates" / f"{key}.json"
        write(path, json.dumps(lecture_to_json(current), ensure_ascii=False, indent=1) + "\n")
        (report,) = verify_file(path)
        chapters.append(Chapter(current, report, document_of(current, report.outcomes)))
    return chapters


def write_figures(folder: Path, page: Document) -> list[str]:
    """Write the drawings of a page as files for its Markdown; returns their names."""
    figures = [block.svg for block in page.blocks if isinstance(block, Figure)]
    make_folder(folder / "figures")
    names = [f"figures/{i}.svg" for i in range(1, len(figures) + 1)]
    for name, svg in zip(names, figures, strict=True):
        write(folder / name, svg)
    return names


def bind(chapters: Sequence[Chapter], example: Sequence[Block]) -> Document:
    """Bind the lectures, the findings on their sources and the worked example into one page."""
    documents = [c.document for c in chapters]
    page = join(TITLE, (SUBTITLE,), documents)
    return replace(page, blocks=(*page.blocks, *findings(page.blocks), *example))


def findings(blocks: Sequence[Block]) -> list[Block]:
    """Return the table of what the sources print and what is true."""
    notes = [block for block in blocks if isinstance(block, Note)]
    rows: list[tuple[Inline, ...]] = [
        (
            (DOCUMENTS.get(note.source, ("", note.source))[1], f", ({note.number})" if note.number else ""),
            (note.badge,),
            note.printed,
            (Link("why", note.id),),
        )
        for note in sorted(notes, key=lambda note: note.source)
    ]
    return [
        Section("Findings on the sources", 1, "findings"),
        Para(("What the sources print was derived again. Here the result differs, needs more, or goes further.",)),
        Table(("source", "finding", "as printed", ""), tuple(rows)),
    ]
