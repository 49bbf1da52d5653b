"""The table of a validation as text, one row a route, before any format."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from math import floor, log10

from lmi.comparison import Route
from lmi.report.lines import weighted
from lmi.validation import Validation

__all__ = ["Column", "columns", "spread", "table_rows"]


@dataclass(frozen=True)
class Column:
    """A column: its head, whether it holds numbers, and whether it is left out where there is little room."""

    head: str
    number: bool = True
    spare: bool = False


def columns(validation: Validation) -> tuple[Column, ...]:
    """Return the columns of the table."""
    value = "tr MP" if weighted(validation) else "tr P"
    output = "tr CPC'V^-1" if validation.plant.is_continuous else "ln|CPC'+R|"
    return (
        Column("route", number=False),
        Column("#", spare=True),
        *(Column(head) for head in (value, output, "digits", "diff", "residual", "sec")),
        Column("status", number=False),
        Column("independent of", number=False, spare=True),
    )


def table_rows(validation: Validation, wide: bool = True) -> Iterator[tuple[Route, tuple[str, ...]]]:
    """Iterate over the routes and their cells.

    Args:
        validation: the validation.
        wide: whether there is room for spare columns, and for the half width of a sampled value.
    """
    numbers = {route.name: i for i, route in enumerate(validation.routes, start=1)}
    kept = [i for i, column in enumerate(columns(validation)) if wide or not column.spare]
    for route in validation.routes:
        cells = _cells(route, weighted(validation), wide, numbers)
        yield route, tuple(cells[i] for i in kept)


def _cells(route: Route, is_weighted: bool, wide: bool, numbers: dict[str, int]) -> tuple[str, ...]:
    independent = [numbers[name] for name in route.independent_of if name in numbers]
    return (
        route.name,
        str(numbers[route.name]),
        _value(route, is_weighted, wide),
        _number(route.output, ".6g"),
        _number(route.output_digits, "d"),
        _number(route.difference, ".0e"),
        _number(route.residual, ".0e"),
        f"{route.seconds:.2f}",
        route.status.partition(":")[0],
        ranges(independent),
    )


def _value(route: Route, is_weighted: bool, wide: bool) -> str:
    if route.sample is None:
        return _number(route.cost if is_weighted else route.trace, ".6g")
    estimate = route.sample.cost if is_weighted else route.sample.trace
    return spread(estimate.value, estimate.half_width if wide else 0.0)


def _number(value: float | int | None, form: str) -> str:
    return "-" if value is None else f"{value:{form}}"


def spread(value: float, half_width: float) -> str:
    """Return a value with its half width, 7.19+-0.20, to the second digit of that, or 8.70e+07+-3e+05 to the first."""
    if not half_width > 0:
        return f"{value:.6g}"
    place = floor(log10(half_width)) - 1
    if -4 <= place <= 0 and abs(value) < 1e6:
        return f"{value:.{-place}f}+-{half_width:.{-place}f}"
    digits = max(0, floor(log10(max(abs(value), half_width))) - place - 1)
    return f"{value:.{digits}e}+-{half_width:.0e}"


def ranges(numbers: list[int]) -> str:
    """Return numbers with runs of three or more drawn together: 2-4 6 7 9."""
    runs = [list(group) for _, group in groupby(enumerate(sorted(numbers)), lambda pair: pair[1] - pair[0])]
    ends = [(run[0][1], run[-1][1]) for run in runs]
    return " ".join(f"{a}-{b}" if b > a + 1 else f"{a} {b}" if b > a else f"{a}" for a, b in ends) or "-"
