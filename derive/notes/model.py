"""Document model of the notes: what a page shows, before any format.

A badge comes from the replay of a step and from nothing else: ``document_of`` takes the outcomes of the replay.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal

from derive.catalogue import DOCUMENTS
from derive.context import Declared, DeclaredAtom, DeclaredFact, DeclaredInverse
from derive.derivation import Derived, Erratum, Evidence, Given, Heading, Item, Lecture, Outcome, Paragraph, Rule, Step
from derive.terms import Dot, Equation, Expect, Inverse, Number, Symbol, Term

__all__ = [
    "SOURCES",
    "Badge",
    "Block",
    "Display",
    "Document",
    "Figure",
    "Inline",
    "Link",
    "Note",
    "Para",
    "Row",
    "Section",
    "Table",
    "document_of",
    "join",
    "slug",
    "visible",
    "with_sources",
]

Badge = Literal["proved", "definition", "hypothesis", "refuted", "incomplete", "not proved", ""]
FINDINGS: dict[str, Badge] = {
    "false": "refuted",
    "incomplete": "incomplete",
    "assumption": "incomplete",
    "silent": "incomplete",
}
RULES: dict[Rule, str] = {
    "identity": "identity",
    "apply": "on both sides",
    "trace": "under the trace",
    "gradient": "gradient",
    "positivity": "sum of squares",
    "comparison": "comparison",
    "uniqueness": "uniqueness",
    "chain": "chain",
    "scalar": "identity of real numbers",
    "same rate": "equal derivatives, equal start",
    "sign": "signs",
    "both": "both inequalities",
    "squeeze": "limit by comparison",
    "integral": "antiderivative and its limits",
    "same argument": "equal arguments",
    "instance": "for this number",
    "sum over": "sum",
    "linear": "integral of a sum",
    "conjugate": "conjugate roots",
    "same roots": "equal roots",
    "modulus": "distances to the roots",
    "mirrored": "conjugates on the circle",
    "trace of roots": "trace",
    "determinant": "determinant of a product",
    "exchange": "determinant",
    "single": "one entry",
    "positive": "positive matrix",
    "resolvent": "strictly proper",
    "parameter": "derivative under the integral",
    "any sign": "for every real number",
    "logarithms": "logarithm of a product",
    "induction": "induction",
}
ANCHORS = {" ": "-", "≠": "ne", "=": "eq", ">": "gt", "<": "lt", "≥": "ge", "≤": "le", "(": "_", ")": "_", ",": "_"}
SOURCES = {number: title for number, (_, title) in DOCUMENTS.items()}


@dataclass(frozen=True)
class Link:
    """A reference by a label: to an anchor of this page, or of another one in the same folder.

    ``page`` names the other page without its suffix, which each format adds, or any file with its suffix.
    """

    label: str | Term | Equation
    target: str
    page: str = ""

    def address(self, suffix: str) -> str:
        """Return where the link leads in a format whose pages have a suffix."""
        page = self.page + suffix * bool(self.page and "." not in self.page)
        return page + f"#{self.target}" * bool(self.target)


Inline = tuple["str | Term | Equation | Link", ...]


@dataclass(frozen=True)
class Row:
    """One displayed line: [lhs] relation rhs, its number, the reason under it, the rule and what it rests on.

    ``message`` is what the kernel said of a step that it did not accept.
    """

    lhs: Term | None
    relation: str
    rhs: Term
    id: str
    number: str = ""
    badge: Badge = ""
    reason: Inline = ()
    rule: str = ""
    uses: Inline = ()
    message: str = ""


@dataclass(frozen=True)
class Display:
    """Rows one under the other, aligned at their relations."""

    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Section:
    """A heading; level 1 is a lecture, level 2 a section of it."""

    title: str
    level: int
    id: str


@dataclass(frozen=True)
class Para:
    """Running text."""

    text: Inline


@dataclass(frozen=True)
class Table:
    """A table with a caption; cells are inline."""

    head: tuple[str, ...]
    rows: tuple[tuple[Inline, ...], ...]
    caption: Inline = ()


@dataclass(frozen=True)
class Figure:
    """A drawing as SVG text, with a caption and words for those who cannot see it."""

    svg: str
    caption: Inline
    alt: str


@dataclass(frozen=True)
class Note:
    """A finding on a formula of a source."""

    id: str
    source: str
    number: str
    finding: str
    badge: Badge
    printed: Inline
    text: Inline
    evidence: tuple[Table, ...] = ()
    true: Equation | None = None
    proof: Link | None = None


Block = Section | Para | Display | Table | Figure | Note


@dataclass(frozen=True)
class Document:
    """A page: title, a line under it, and its blocks."""

    title: str
    subtitle: Inline
    blocks: tuple[Block, ...]
    proved: int = 0
    total: int = 0
    authors: tuple[str, ...] = field(default=())


def slug(*parts: str) -> str:
    """Return an anchor of ASCII letters, digits and . - _; signs are spelled by a name, or else by their code."""
    spelled = (c if re.match("[A-Za-z0-9.-]", c) else ANCHORS.get(c, f"_{ord(c):x}") for c in "-".join(parts))
    return "".join(spelled)


def visible(number: str) -> str:
    """Return the number as the reader sees it: an equation that its source does not number (u1, u2, ...) has none."""
    return "" if number.startswith("u") else number


def readable(name: str) -> str:
    """Return the name of a step as the page shows it, with proper signs."""
    return name.replace(">=", "≥").replace("<=", "≤")


def document_of(lecture: Lecture, outcomes: Sequence[Outcome]) -> Document:
    """Lay out a lecture; every badge of a derived row comes from the outcome of its replay."""
    verdicts = {o.step: o for o in outcomes}
    anchors, numbers = _anchors(lecture)
    layout = _Layout(lecture, verdicts, anchors, numbers)
    blocks: list[Block] = [Section(lecture.title, 1, slug(lecture.key))]
    for item in lecture.items:
        blocks += layout.block(item)
    sources = "; ".join(SOURCES[s] for s in lecture.sources if s in SOURCES)
    proved = sum(layout.accepted(s) for s in lecture.steps)
    return Document(lecture.title, (sources,), tuple(_named_once(blocks)), proved, len(lecture.steps))


def _named_once(blocks: Sequence[Block]) -> Iterator[Block]:
    """Number the anchors of what is displayed again; links lead to where it stands first."""
    seen = Counter[str]()
    for block in blocks:
        if isinstance(block, Display):
            rows: list[Row] = []
            for row in block.rows:
                seen[row.id] += 1
                rows.append(replace(row, id=f"{row.id}-{seen[row.id]}") if seen[row.id] > 1 else row)
            block = Display(tuple(rows))
        yield block


def join(title: str, subtitle: Inline, documents: Sequence[Document], extra: Sequence[Block] = ()) -> Document:
    """Bind several documents into one page, each with its sources, and further blocks at its end."""
    blocks = tuple(b for d in documents for b in with_sources(d))
    return Document(
        title, subtitle, (*blocks, *extra), sum(d.proved for d in documents), sum(d.total for d in documents)
    )


def with_sources(document: Document) -> tuple[Block, ...]:
    """Return the blocks of a document, its sources named under its title."""
    named = (Para(("Source: ", *document.subtitle)),) if any(document.subtitle) else ()
    return (*document.blocks[:1], *named, *document.blocks[1:])


def _anchors(lecture: Lecture) -> tuple[dict[str, str], dict[str, str]]:
    """Return the anchor and the number of every declaration that is displayed and of every step."""
    anchors: dict[str, str] = {}
    numbers: dict[str, str] = {}
    for item in lecture.items:
        if isinstance(item, Given):
            for row in item.rows:
                anchors.setdefault(row.name, slug(lecture.key, row.name))
                numbers.setdefault(row.name, row.number)
        if isinstance(item, Derived):
            for step in item.steps:
                shown = item.steps[-2].name if step.rule == "chain" and len(item.steps) > 1 else step.name
                anchors[step.name], numbers[step.name] = slug(lecture.key, shown), step.number
    return anchors, numbers


@dataclass(frozen=True)
class _Layout:
    lecture: Lecture
    verdicts: Mapping[str, Outcome]
    anchors: Mapping[str, str]
    numbers: Mapping[str, str]

    def verdict(self, name: str) -> Outcome:
        return self.verdicts.get(name, Outcome(name, False, "not replayed"))

    def accepted(self, step: Step) -> bool:
        return self.verdict(step.name).accepted

    def block(self, item: Item) -> list[Block]:
        match item:
            case Heading(title):
                return [Section(title, 2, slug(self.lecture.key, title))]
            case Paragraph(text):
                return [Para(text)]
            case Given(rows):
                return [
                    Display(
                        tuple(
                            Row(
                                r.statement.lhs,
                                r.statement.relation,
                                r.statement.rhs,
                                self.anchors[r.name],
                                visible(r.number),
                                r.kind,
                                r.reason,
                            )
                            for r in rows
                        )
                    )
                ]
            case Derived(steps):
                return [Display(tuple(self.rows(steps)))]
            case Erratum():
                return [self.note(item)]

    def rows(self, steps: Sequence[Step]) -> list[Row]:
        """Show a chain: the left side once; the lemma that closes it lends its number and verdict to the last row."""
        closing = steps[-1] if steps[-1].rule == "chain" and len(steps) > 1 else None
        shown = steps[:-1] if closing else steps
        rows: list[Row] = []
        for i, step in enumerate(shown):
            continues = i > 0 and shown[i - 1].statement.rhs == step.statement.lhs
            last = closing if closing and i == len(shown) - 1 else None
            rejected = [v for s in (step, last) if s and not (v := self.verdict(s.name)).accepted]
            rows.append(
                Row(
                    None if continues else step.statement.lhs,
                    step.statement.relation,
                    step.statement.rhs,
                    slug(self.lecture.key, step.name),
                    visible((last.number if last else "") or step.number),
                    "not proved" if rejected else "proved",
                    step.reason,
                    RULES[step.rule],
                    self.uses(step.uses),
                    rejected[0].message if rejected else "",
                )
            )
        return rows

    def uses(self, names: Sequence[str]) -> Inline:
        """Return references to what a step rests on; identity matrices and the like go without saying."""
        out: list[str | Term | Equation | Link] = []
        for name in names:
            label = self.label(name)
            if label is None:
                continue
            out += [", "] if out else []
            target = self.anchors.get(name)
            out.append(Link(label, target) if target else label)
        return tuple(out)

    def label(self, name: str) -> str | Term | Equation | None:
        """Return how a declaration or lemma is called in running text: its number, its symbol, or its name."""
        if visible(self.numbers.get(name, "")):
            return f"({self.numbers[name]})"
        item = self.lecture.theory.declared.get(name)
        step = next((s for s in self.lecture.steps if s.name == name), None)
        if step is not None:
            lhs = step.statement.lhs
            return lhs if step.statement.relation == "=" and isinstance(lhs, (Symbol, Expect, Dot)) else readable(name)
        if isinstance(item, DeclaredInverse):
            return Inverse(item.of)
        if isinstance(item, DeclaredAtom):
            return None
        if isinstance(item, Declared):
            lhs = item.statement.lhs
            if item.statement.relation in ("⪰", "≻", "≥", ">", "≠"):
                return item.statement
            return lhs if isinstance(lhs, (Symbol, Expect, Dot)) else item.text or name
        if item is None or (re.fullmatch(r"I\w+", name) and name not in self.anchors):
            return None  # what holds of an identity matrix, or of a function where it is defined
        return f"“{item.text}”" if isinstance(item, DeclaredFact) and item.text else name

    def note(self, item: Erratum) -> Note:
        key = self.lecture.key
        printed: Inline = (item.printed,) if isinstance(item.printed, Equation) else item.printed
        proof = Link("proved here", self.anchors[item.proved_by]) if item.proved_by else None
        if item.proved_by and not self.verdict(item.proved_by).accepted:
            proof = None
        return Note(
            slug(key, "finding", item.source, item.number or "text", item.finding),
            item.source,
            visible(item.number),
            item.finding,
            FINDINGS[item.finding] if item.evidence else "incomplete",
            printed,
            item.text,
            tuple(_evidence(e) for e in item.evidence),
            item.true if proof else None,
            proof,
        )


def _evidence(evidence: Evidence) -> Table:
    values: list[str | Term | Equation | Link] = []
    for i, (name, value) in enumerate(evidence.values):
        values += [", "] if i else []
        number = _value(value)
        if isinstance(name, Term) and isinstance(number, Term):
            values.append(Equation(name, "=", number))
        else:
            values += [name, " = ", number]
    rows = tuple(((label,), (_value(value),)) for label, value in evidence.results)
    return Table(("counterexample" if len(rows) > 1 else "evidence", "value"), rows, tuple(values))


def _value(text: str) -> str | Term:
    """Return a rational number as a term, anything else as text with proper minus signs."""
    return Number(Fraction(text)) if re.fullmatch(r"-?\d+(/\d+)?", text) else re.sub(r"(?<!\w)-(?=\d)", "−", text)
