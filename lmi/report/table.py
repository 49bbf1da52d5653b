"""A validation as text for a terminal: one table, the reasons beneath it, what is proved, and the verdict."""

from textwrap import fill
from typing import TextIO

from rich.console import Console
from rich.table import Table
from rich.text import Text

from lmi.comparison import Route
from lmi.report.lines import filter_line, proved_lines, status_lines, verdict_line, weighted
from lmi.report.rows import columns, table_rows
from lmi.validation import Validation, Verdict

__all__ = ["print_table", "proved_lines", "verdict_line"]

VERDICT_WIDTH = 80  # columns
WIDE = 100
"""Columns of the whole table; a narrower terminal gets it without the spare ones."""

STYLES = {Verdict.AGREE: "bold green", Verdict.DISAGREE: "bold red", Verdict.UNCONFIRMED: "bold yellow"}
LEGEND = "diff: relative, from the enclosure, or from riccati where nothing is enclosed"


def print_table(validation: Validation, file: TextIO | None = None) -> None:
    """Print the table of routes; plain text when the file is no terminal."""
    console = Console(file=file, highlight=False)
    if not console.is_terminal:
        console = Console(file=file, highlight=False, width=WIDE)
    plant = validation.plant
    console.print(Text(f"{plant.name}: {plant.time} time, states {plant.n}, outputs {plant.l}"), soft_wrap=True)
    console.print(_table(validation, console.width >= WIDE))
    certified = validation.certificate.line(weighted(validation))
    lines = (LEGEND, *status_lines(validation), filter_line(validation), *proved_lines(validation), certified)
    for line in filter(None, lines):
        console.print(Text(line), soft_wrap=True)
    said = fill(verdict_line(validation), VERDICT_WIDTH, subsequent_indent="  ", break_on_hyphens=False)
    console.print(Text(said, style=STYLES[validation.verdict]), soft_wrap=True)


def _table(validation: Validation, wide: bool) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    for column in columns(validation):
        if wide or not column.spare:
            table.add_column(column.head, justify="right" if column.number else "left", no_wrap=True)
    for route, cells in table_rows(validation, wide):
        style = _style(route)
        table.add_row(*(Text(text, style=style if i == _STATUS[wide] else "") for i, text in enumerate(cells)))
    return table


_STATUS = {True: 8, False: 7}


def _style(route: Route) -> str:
    if route.disagrees:
        return "bold red"
    return "" if route.agrees else "dim"
