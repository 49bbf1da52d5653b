"""HTML writer: one self-contained page, MathML with an embedded font, no script, no request that leaves it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape, unescape
from importlib.resources import files

from derive.latex.layout import Box, Op, layout, split, width
from derive.latex.layout import row as beside
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


def html(document: Document) -> str:
    """Return the page."""
    body = "\n".join(map(_block, document.blocks))
    sections = [b for b in document.blocks if isinstance(b, Section)]
    page = _PAGE.format(
        title=escape(document.title),
        subtitle=_inline(document.subtitle),
        count=f"{document.proved} of {document.total} steps proved and replayed" if document.total else "",
        legend="".join(f"<li>{_badge(k)} {escape(v)}</li>" for k, v in LEGEND.items() if f"badge {k}" in body),
        contents=_contents(sections),
        body=body,
        style="{style}",
        font="{font}",
    )
    style = files("derive.notes").joinpath("style.css").read_text(encoding="utf-8")
    shown = unescape(re.sub(r"<[^>]*>", "", re.sub(r"<svg.*?</svg>", "", page, flags=re.DOTALL)))
    letters = "".join(unescape(t) for t in re.findall(r"<mi>(.)</mi>", page))
    return page.replace("{style}", style).replace("{font}", embedded(shown, letters))


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
<nav aria-label="Contents">{contents}</nav>
<main>
{body}
</main>
</body>
</html>
"""  # noqa: E501


def _contents(sections: Sequence[Section]) -> str:
    """Return the table of contents: lectures, with their sections folded below."""
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


def _block(block: Block) -> str:
    match block:
        case Section(title, level, anchor):
            return f'<h{level + 1} id="{anchor}">{escape(title)}</h{level + 1}>'
        case Para(text):
            return f"<p>{_inline(text)}</p>"
        case Display(rows):
            long = any(r.lhs is not None and len(plain(r.lhs)) > LONG for r in rows)
            return f'<div class="eqs{" long" if long else ""}">{"".join(map(_row, rows))}</div>'
        case Table():
            return _table(block)
        case Figure(svg, caption, alt):
            drawing = svg[svg.index("<svg") :].replace("<svg", f'<svg role="img" aria-label="{escape(alt)}"', 1)
            return f"<figure>{drawing}<figcaption>{_inline(caption)}</figcaption></figure>"
        case Note():
            return _note(block)


def _row(row: Row) -> str:
    lhs = mathml(row.lhs) if row.lhs is not None else ""
    rhs = _breakable(beside((Op(row.relation), layout(row.rhs))))
    number = f'<a class="n" href="#{row.id}">({escape(row.number)})</a>' if row.number else ""
    rests = [row.rule] * bool(row.rule) + [f"from {_inline(row.uses)}"] * bool(row.uses)
    uses = f' <span class="uses">{", ".join(rests)}</span>' if rests else ""
    uses += f" <b>{escape(row.message)}</b>" if row.message else ""
    reason = f"<span>{_inline(row.reason)}</span>" if row.reason else ""
    place = "aside" if row.badge in ("definition", "hypothesis") else "why"
    why = f'<div class="{place}">{_badge(row.badge)} {reason}{uses}</div>' if row.badge else ""
    return f'<div class="row" id="{row.id}"><span class="l">{lhs}</span><span class="r">{rhs}</span>{number}{why}</div>'


def _breakable(box: Box) -> str:
    """Print mathematics; what is wider than a phone becomes several elements, and wraps between them like text."""
    pieces = split(box) if width(box) > WIDE else [box]
    return "".join(math(p).replace("<math><mo>", '<math><mo form="infix">', 1) for p in pieces)


def _badge(badge: str) -> str:
    return f'<b class="badge {badge}">{SYMBOLS[badge]} {badge}</b>'


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(h)}</th>" for h in table.head)
    rows = "".join(f"<tr>{''.join(f'<td>{_inline(c)}</td>' for c in row)}</tr>" for row in table.rows)
    caption = f'<p class="caption">{_inline(table.caption)}</p>' if table.caption else ""
    return f'{caption}<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def _note(note: Note) -> str:
    number = f", equation ({note.number})" if note.number else ""
    title = f"{_badge(note.badge)} {escape(SOURCES.get(note.source, note.source))}{escape(number)}"
    parts = [f'<p class="printed">As printed: {_inline(note.printed)}</p>', f"<p>{_inline(note.text)}</p>"]
    parts += map(_table, note.evidence)
    if note.true is not None:
        parts.append(f'<p class="true">{_badge("proved")} {_inline((note.true,))} {_link(note.proof)}</p>')
    elif note.proof is not None:
        parts.append(f'<p class="true">{_badge("proved")} the statement with its hypotheses: {_link(note.proof)}</p>')
    return f'<aside class="note {note.badge}" id="{note.id}"><h4>{title}</h4>{"".join(parts)}</aside>'


def _link(link: Link | None) -> str:
    if link is None:
        return ""
    label = escape(link.label) if isinstance(link.label, str) else mathml(link.label)
    return f'<a href="#{link.target}">{label}</a>'


def _inline(text: Inline) -> str:
    out: list[str] = []
    for part in text:
        match part:
            case str():
                out.append(escape(part))
            case Link():
                out.append(_link(part))
            case Term() | Equation():
                out.append(_breakable(layout(part)))
    return PUNCTUATED.sub(r'<span class="nb">\1</span>', "".join(out))
