r"""Markdown writer for GitHub: display mathematics between $$, numbers as text, reasons as a list under each display.

\tag and \label have no place inside aligned displays, so the number stands at the end of its line. GitHub reads \\ as
an escaped backslash unless it ends a line, and \, as a comma; neither is written outside protected spans.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from derive.latex.boxes import Op
from derive.latex.boxes import row as beside
from derive.latex.layout import layout
from derive.latex.tex import latex, tex
from derive.notes.html import SYMBOLS
from derive.notes.model import SOURCES, Block, Display, Document, Figure, Inline, Link, Note, Para, Row, Section, Table
from derive.terms import Equation, Term


def markdown(document: Document, figures: Sequence[str] = ()) -> str:
    """Return the document as GitHub flavoured Markdown; ``figures`` are the files of its drawings, in order."""
    files = iter(figures)
    lines = [f"# {_text(document.title)}", "", _inline(document.subtitle), ""]
    if document.total:
        lines += [f"**{document.proved} of {document.total} steps proved and replayed.**", ""]
    for block in document.blocks:
        if isinstance(block, Figure):
            name = next(files, "")
            lines += [f"![{_text(block.alt)}]({name})" if name else "", "", f"*{_inline(block.caption)}*", ""]
        else:
            lines += [*_block(block), ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def _block(block: Block) -> list[str]:
    match block:
        case Section(title, level, anchor):
            return [f'<a id="{anchor}"></a>', "", f"{'#' * (level + 1)} {_text(title)}"]
        case Para(text):
            return [_inline(text)]
        case Display(rows):
            return _display(rows)
        case Table():
            return _table(block)
        case Note():
            return [("> " + line).rstrip() for line in _note(block)]
        case Figure():
            return []


def _display(rows: Sequence[Row]) -> list[str]:
    lines = [
        f"{latex(r.lhs) if r.lhs is not None else ''} &{tex(beside((Op(r.relation), layout(r.rhs))))}"
        + (rf" \qquad\text{{({r.number})}}" if r.number else "")
        for r in rows
    ]
    anchors = "".join(f'<a id="{r.id}"></a>' for r in rows)
    body = " \\\\\n".join(lines).replace(r" \\ ", " \\\\\n").replace(r"\,", " ")
    out = [anchors, "", "$$", r"\begin{aligned}", body, r"\end{aligned}", "$$", ""]
    for row in rows:
        if row.badge:
            number = f"({row.number}) " if row.number else ""
            rests = [row.rule] * bool(row.rule) + [f"from {_inline(row.uses)}"] * bool(row.uses)
            uses = f" · {', '.join(rests)}" if rests else ""
            uses += f" **{_text(row.message)}**" if row.message else ""
            out.append(f"- {number}{SYMBOLS[row.badge]} *{row.badge}* {_inline(row.reason)}{uses}".rstrip())
    return out


def _table(table: Table) -> list[str]:
    caption = [_inline(table.caption), ""] if table.caption else []
    rows = ["| " + " | ".join(_inline(c).replace("|", r"\|") for c in row) + " |" for row in table.rows]
    return [*caption, "| " + " | ".join(map(_text, table.head)) + " |", "|" + " :-- |" * len(table.head), *rows]


def _note(note: Note) -> list[str]:
    number = f", equation ({note.number})" if note.number else ""
    source = _text(SOURCES.get(note.source, note.source))
    out = [f'<a id="{note.id}"></a>', f"**{SYMBOLS[note.badge]} {note.badge}: {source}{number}**", ""]
    out += [f"As printed: {_inline(note.printed)}", "", _inline(note.text), ""]
    for table in note.evidence:
        out += [*_table(table), ""]
    if note.true is not None:
        out.append(f"✓ *proved* {_math(note.true)} {_link(note.proof)}")
    elif note.proof is not None:
        out.append(f"✓ *proved* with its hypotheses: {_link(note.proof)}")
    return out


def _link(link: Link | None) -> str:
    if link is None:
        return ""
    label = _text(link.label) if isinstance(link.label, str) else _math(link.label)
    return f"[{label}]({link.address('.md')})"


def _math(formula: Term | Equation) -> str:
    """Print inline mathematics, between dollars, protected by backquotes where Markdown would take a backslash away."""
    text = latex(formula)
    return f"$`{text}`$" if re.search(r"\\[^A-Za-z]", text) else f"${text}$"


def _text(text: str) -> str:
    """Escape what Markdown would read as markup."""
    return re.sub(r"([\\`*_\[\]<>$#|])", r"\\\1", text)


def _inline(text: Inline) -> str:
    out: list[str] = []
    for part in text:
        match part:
            case str():
                out.append(_text(part))
            case Link():
                out.append(_link(part))
            case Term() | Equation():
                out.append(_math(part))
    return "".join(out)
