"""Run the benchmark and print one table; ends with 1 if a target is missed."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.benchmark.certificates import certificates
from tests.benchmark.claims import claims
from tests.benchmark.design import designs
from tests.benchmark.enclosures import enclosures
from tests.benchmark.gain import gain
from tests.benchmark.page import write_page
from tests.benchmark.programs import programs
from tests.benchmark.prover import prover
from tests.benchmark.riccati import riccati
from tests.benchmark.scalar import scalar
from tests.benchmark.startup import startup
from tests.benchmark.table import Row
from tests.benchmark.validate import validate

SECTIONS: dict[str, Callable[[], list[Row]]] = {
    "certificates": certificates,
    "claims": claims,
    "design": designs,
    "enclosures": enclosures,
    "gain": gain,
    "programs": programs,
    "prover": prover,
    "riccati": riccati,
    "scalar": scalar,
    "startup": startup,
    "validate": validate,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure the sections asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmark", description=__doc__)
    parser.add_argument("--only", action="append", choices=SECTIONS, metavar="SECTION", help=", ".join(SECTIONS))
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the tables into this page as well")
    options = parser.parse_args(arguments)
    results: dict[str, list[Row]] = {}
    for section in options.only or SECTIONS:
        results[section] = SECTIONS[section]()
        if options.page is not None:
            write_page(options.page, {section: results[section]})
    show(results)
    return 0 if all(row.ok for rows in results.values() for row in rows) else 1


def show(results: dict[str, list[Row]]) -> None:
    """Print the measurements."""
    from rich.console import Console
    from rich.table import Table

    table = Table("section", "measurement", "value", "target", "met")
    for section, rows in results.items():
        for row in rows:
            table.add_row(section, row.name, row.value, row.target, "yes" if row.ok else "[bold red]no[/]")
        table.add_section()
    Console(width=None if sys.stdout.isatty() else 150).print(table)


if __name__ == "__main__":
    sys.exit(main())
