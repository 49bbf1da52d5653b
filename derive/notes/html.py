"""HTML writer: one self-contained page, MathML with an embedded font, no script, no request that leaves it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape, unescape
from importlib.resources import files

from derive.latex.boxes import Box, Op, split, width
from derive.latex.boxes import row as beside
from derive.latex.layout import layout
from derive.latex.mathml import math, mathml
from derive.latex.plain import plain
from derive.notes.font import embedded
from derive.notes.model import SOURCES, Block, Display, Document, Figure, Inline, Link, Note, Para, Row, Section, Table
from derive.terms import Equation, Term

WIDE = 16  # em
LONG = 36  # characters of a left side that leaves no room for the right side beside it
PUNCTUATED = re.compile(
    r"(\(?(?:<a [^>]*>)?<math>(?:(?!</math>).)*</math>(?:</a>)?[,.;:)]+)"
)  # no break before a comma
SYMBOLS = {"proved": "✓", "definition": "≔", "hypothesis": "∗", "refuted": "✗", "incomplete": "!", "not proved": "?"}
LEGEND = {
    "proved": "a certificate was found and replayed by the kernel",
    "definition": "says what a symbol means",
    "hypothesis": "assumed by the theory",
    "refuted": "an exact counterexample is shown",
    "not proved": "the kernel did not accept the certificate",
    "incomplete": "true under more than the source says, or left open there",
}


def html(document: Document, *, lead: str = "", style: str = "") -> str:
    """Return the page; a lead, in HTML, says what it comes to before anything else, in a style of its own."""
    blocks = [b for b in document.blocks if not (isinstance(b, Section) and b.title == document.title)]
    body = "\n".join(map(block, blocks))
    count = f"{document.proved} of {document.total} steps proved and replayed" if document.total else lead
    sections = [b for b in blocks if isinstance(b, Section)]
    return whole_page(document.title, document.subtitle, count, body, _contents(sections), style=style)


def whole_page(
    title: str, subtitle: Inline, count: str, body: str, contents: str = "", *, style: str = "", script: str = ""
) -> str:
    """Return a self-contained page around a body, with the legend of its badges and the font that it needs."""
    page = _PAGE.format(
        title=escape(title),
        subtitle=inline(subtitle),
        count=count,
        legend="".join(f"<li>{badge(k)} {escape(v)}</li>" for k, v in LEGEND.items() if f"badge {k}" in body),
        contents=f'<nav aria-label="Contents">{contents}</nav>\n' if contents else "",
        body=body,
        style="{style}",
        font="{font}",
        script="{script}",
    )
    shown, letters, formulas = _characters(page)
    page = _outlines_once(page).replace("{script}", f"<script>\n{script}</script>\n" if script else "")
    return page.replace("{style}", resource("style.css") + style).replace("{font}", embedded(shown, letters, formulas))


def _characters(page: str) -> tuple[str, str, str]:
    """Return the text of a page, the letters that its formulas show in italics, and the rest of its formulas."""
    text = re.sub(r"<svg.*?</svg>", "", page, flags=re.DOTALL)
    letters = "".join(unescape(t) for t in re.findall(r"<mi>(.)</mi>", text))
    formulas = re.sub(r"<mi>.</mi>", "", "".join(re.findall(r"<math.*?</math>", text)))
    shown, formulas = (unescape(re.sub(r"<[^>]*>", "", t)) for t in (text, formulas))
    return shown, letters, formulas


def _outlines_once(page: str) -> str:
    """Leave each named outline to the first drawing that has it; in one page the others refer to that one."""
    seen: set[str] = set()

    def first(found: re.Match[str]) -> str:
        known = found[0] in seen
        seen.add(found[0])
        return "" if known else found[0]

    return re.sub(r'<path id="[^>]*/>', first, page)


def resource(name: str) -> str:
    """Return the text of a file that lies beside the writers."""
    return files("derive.notes").joinpath(name).read_text(encoding="utf-8")


_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>@font-face{{font-family:"Notes Math";src:url({font})}}
{style}</style>
</head>
<body>
<header><h1>{title}</h1><p class="subtitle">{subtitle}</p><p class="count">{count}</p><ul class="legend">{legend}</ul></header>
{contents}<main>
{body}
</main>
{script}</body>
</html>
"""  # noqa: E501


def _contents(sections: Sequence[Section]) -> str:
    """Return the table of contents: lectures, with their sections folded below, or the sections of a single one."""
    if all(section.level > 1 for section in sections):
        below = "".join(f'<li><a href="#{s.id}">{escape(s.title)}</a></li>' for s in sections)
        return f'<ol class="sections">{below}</ol>' if below else ""
    items: list[str] = []
    for i, section in enumerate(sections):
        if section.level != 1:
            continue
        below = []
        for other in sections[i + 1 :]:
            if other.level == 1:
                break
            below.append(f'<li><a href="#{other.id}">{escape(other.title)}</a></li>')
        title = f'<a href="#{section.id}">{escape(section.title)}</a>'
        items.append(f"<li>{title}<ol>{''.join(below)}</ol></li>" if below else f"<li>{title}</li>")
    return f"<ol>{''.join(items)}</ol>"


def block(content: Block) -> str:
    """Print a block of a page."""
    match content:
        case Section(title, level, anchor):
            return f'<h{level + 1} id="{anchor}">{escape(title)}</h{level + 1}>'
        case Para(text):
            return f"<p>{inline(text)}</p>"
        case Display(rows):
            long = any(r.lhs is not None and len(plain(r.lhs)) > LONG for r in rows)
            return f'<div class="eqs{" long" if long else ""}">{"".join(map(_row, rows))}</div>'
        case Table():
            return _table(content)
        case Figure(svg, caption, alt):
            drawing = svg[svg.index("<svg") :].replace("<svg", f'<svg role="img" aria-label="{escape(alt)}"', 1)
            return f"<figure>{drawing}<figcaption>{inline(caption)}</figcaption></figure>"
        case Note():
            return _note(content)


def _row(row: Row) -> str:
    lhs = mathml(row.lhs) if row.lhs is not None else ""
    rhs = _breakable(beside((Op(row.relation), layout(row.rhs))))
    number = f'<a class="n" href="#{row.id}">({escape(row.number)})</a>' if row.number else ""
    rests = [row.rule] * bool(row.rule) + [f"from {inline(row.uses)}"] * bool(row.uses)
    uses = f' <span class="uses">{", ".join(rests)}</span>' if rests else ""
    uses += f" <b>{escape(row.message)}</b>" if row.message else ""
    place = "aside" if row.badge in ("definition", "hypothesis") else "why"
    why = f'<div class="{place}">{badge(row.badge)} {inline(row.reason)}{uses}</div>' if row.badge else ""
    return f'<div class="row" id="{row.id}"><i>{lhs}</i><i>{rhs}</i>{number}{why}</div>'


def _breakable(box: Box) -> str:
    """Print mathematics; what is wider than a phone becomes several elements, and wraps between them like text."""
    pieces = split(box) if width(box) > WIDE else [box]
    return "".join(math(p).replace("<math><mo>", '<math><mo form="infix">', 1) for p in pieces)


def badge(word: str) -> str:
    """Print a badge: its sign and its word, so that colour is not needed."""
    return f'<b class="badge {word}">{SYMBOLS[word]} {word}</b>'


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(h)}</th>" for h in table.head)
    rows = "".join(f"<tr>{''.join(f'<td>{inline(c)}</td>' for c in row)}</tr>" for row in table.rows)
    caption = f'<p class="caption">{inline(table.caption)}</p>' if table.caption else ""
    return f'{caption}<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def _note(note: Note) -> str:
    number = f", equation ({note.number})" if note.number else ""
    title = f"{badge(note.badge)} {escape(SOURCES.get(note.source, note.source))}{escape(number)}"
    parts = [f'<p class="printed">As printed: {inline(note.printed)}</p>', f"<p>{inline(note.text)}</p>"]
    parts += map(_table, note.evidence)
    if note.true is not None:
        parts.append(f'<p class="true">{badge("proved")} {inline((note.true,))} {_link(note.proof)}</p>')
    elif note.proof is not None:
        parts.append(f'<p class="true">{badge("proved")} the statement with its hypotheses: {_link(note.proof)}</p>')
    return f'<aside class="note {note.badge}" id="{note.id}"><h4>{title}</h4>{"".join(parts)}</aside>'


def _link(link: Link | None) -> str:
    if link is None:
        return ""
    label = escape(link.label) if isinstance(link.label, str) else mathml(link.label)
    return f'<a href="{escape(link.address(".html"))}">{label}</a>'


def inline(text: Inline) -> str:
    """Print running text."""
    out: list[str] = []
    for part in text:
        match part:
            case str():
                out.append(escape(part))
            case Link():
                out.append(_link(part))
            case Term() | Equation():
                out.append(_breakable(layout(part)))
    return PUNCTUATED.sub(r"<i>\1</i>", "".join(out))
