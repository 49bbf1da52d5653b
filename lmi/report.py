"""A validation as text for a terminal: one table, the reasons beneath it, what is proved, and the verdict."""

from collections.abc import Iterator
from textwrap import fill
from typing import TextIO

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from lmi.comparison import AGREEMENT, Route
from lmi.enclosure import Number
from lmi.validation import Validation, Verdict

__all__ = ["print_table"]

WIDTH = 80  # columns of the verdict
STYLES = {Verdict.AGREE: "bold green", Verdict.DISAGREE: "bold red", Verdict.UNCONFIRMED: "bold yellow"}


def print_table(validation: Validation, file: TextIO | None = None) -> None:
    """Print the table of routes; plain text when the file is no terminal."""
    console = Console(file=file, highlight=False)
    plant = validation.plant
    console.print(Text(f"{plant.name}: {plant.time} time, states {plant.n}, outputs {plant.l}"), soft_wrap=True)
    console.print(_table(validation))
    for route in validation.routes:
        if ":" in route.status:
            console.print(Text(f"{route.name}: {route.status}"), soft_wrap=True)
    for line in (*proved_lines(validation), validation.certificate.line(_weighted(validation))):
        console.print(Text(line), soft_wrap=True)
    said = fill(verdict_line(validation), WIDTH, subsequent_indent="  ", break_on_hyphens=False)
    console.print(Text(said, style=STYLES[validation.verdict]), soft_wrap=True)


def proved_lines(validation: Validation) -> Iterator[str]:
    """Iterate over what is proved of the optimum, and why the rest is not."""
    plant, proved = validation.plant, validation.enclosure
    output = "tr(CPC'V^-1)" if plant.is_continuous else "ln det(CPC'+R)"
    weighted = _weighted(validation)
    if proved.found is None or proved.output is None:
        yield f"{output}: not enclosed: {proved.status}"
    else:
        yield f"{output} = {proved.output}"
        yield f"  = {_sum(validation)}"
        if validation.reads_as_boundary:
            yield "  for the plant's numbers as they are; the routes read modes beside the boundary as on it"
    covariance = proved.cost if weighted else proved.trace
    if covariance is not None:
        yield f"{'tr(MP)' if weighted else 'tr P'} = {covariance}"
    elif proved.reason:
        yield f"{'tr(MP)' if weighted else 'tr P'}: not enclosed: {proved.reason}"


def _sum(validation: Validation) -> str:
    """Return the terms that make up the output cost."""
    terms = validation.enclosure.terms
    text = f"{_short(terms['integral'])} (integral) + {_short(terms['unstable_term'])} (unstable modes)"
    if not (validation.plant.N.any() and validation.plant.is_continuous):
        return text
    cross = _short(terms["cross_term"])
    return f"{text} {f'+ {cross[1:]}' if cross[0] == '-' else f'- {cross}'} (tr CNV^-1)"


def _short(number: Number | None) -> str:
    return "?" if number is None else f"{float(number.value):.6g}"


def _weighted(validation: Validation) -> bool:
    return bool((np.eye(validation.plant.n) != validation.plant.M).any())


def verdict_line(validation: Validation) -> str:
    """Return the verdict in one line: who confirms, or who disagrees and by how much."""
    riccati = validation.routes[0]
    confirming = validation.confirming
    match validation.verdict:
        case Verdict.AGREE:
            worst = max(route.relative_difference or 0.0 for route in confirming)
            strong = " (strong solution)" if riccati.status == "strong" else ""
            names = ", ".join(route.name for route in confirming)
            return f"agree: {names} confirm riccati{strong} to {worst:.0e}"
        case Verdict.DISAGREE:
            if validation.excluded:
                return "disagree: the certificate proves the tr P of riccati wrong"
            wrong = [route for route in validation.routes if route.disagrees]
            names = ", ".join(
                f"{route.name} is proved wrong"
                if route.excluded
                else f"{route.name} differs from riccati by {route.relative_difference:.0e}"
                for route in wrong
            )
            return f"disagree: tolerance {AGREEMENT:.0e}, {names}"
        case Verdict.UNCONFIRMED if confirming:
            return "unconfirmed: there is no certificate"
        case Verdict.UNCONFIRMED:
            return "unconfirmed: no route independent of riccati is accurate enough"


def _table(validation: Validation) -> Table:
    plant = validation.plant
    weighted = _weighted(validation)
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    table.add_column("route", no_wrap=True)
    numbers = ("tr MP" if weighted else "tr P", "tr CPC'V^-1" if plant.is_continuous else "ln|CPC'+R|")
    for name in (*numbers, "digits", "diff", "residual", "sec"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("status", no_wrap=True)
    for route in validation.routes:
        value = route.cost if weighted else route.trace
        table.add_row(
            route.name,
            _number(value, ".6g"),
            _number(route.output, ".6g"),
            _number(route.output_digits, "d"),
            _number(route.relative_difference, ".0e"),
            _number(route.residual, ".0e"),
            f"{route.seconds:.2f}",
            Text(route.status.partition(":")[0], style=_style(route)),
        )
    return table


def _number(value: float | int | None, form: str) -> str:
    return "-" if value is None else f"{value:{form}}"


def _style(route: Route) -> str:
    if route.disagrees:
        return "bold red"
    return "" if route.trusted else "dim"
