"""A validation as a table for notebooks: plain HTML that inherits the notebook's look."""

from html import escape

from lmi.report.lines import filter_line, proved_lines, status_lines, verdict_line, weighted
from lmi.report.rows import columns, table_rows
from lmi.validation import Validation, Verdict

__all__ = ["as_html"]

COLOURS = {Verdict.AGREE: "#137333", Verdict.DISAGREE: "#b3261e", Verdict.UNCONFIRMED: "#7a5200"}


def as_html(validation: Validation) -> str:
    """Return the verdict, the table, and what is proved."""
    plant, shown = validation.plant, columns(validation)
    title = f"{plant.name}: {plant.time} time, states {plant.n}, outputs {plant.l}"
    aligned = ["right" if column.number else "left" for column in shown]
    head = "".join(_cell("th", column.head, side) for column, side in zip(shown, aligned, strict=True))
    rows = "".join(
        f"<tr>{''.join(_cell('td', text, side) for text, side in zip(cells, aligned, strict=True))}</tr>"
        for _, cells in table_rows(validation)
    )
    certified = validation.certificate.line(weighted(validation))
    lines = filter(None, (*status_lines(validation), filter_line(validation), *proved_lines(validation), certified))
    colour = COLOURS[validation.verdict]
    return (
        f"<div><p>{escape(title)}<br><strong style='color:{colour}'>{escape(verdict_line(validation))}</strong></p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        f"<p>{'<br>'.join(map(escape, lines))}</p></div>"
    )


def _cell(tag: str, text: str, side: str) -> str:
    return f"<{tag} style='text-align:{side}'>{escape(text)}</{tag}>"
