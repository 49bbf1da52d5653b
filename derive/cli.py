"""The command line: `derive tour`, `derive list`, `derive notes`, `derive check`, `derive verify`.

Each command imports what it needs when it runs. Exit codes: 0 everything as expected, 1 something refuted or rejected,
2 bad input or usage, 3 nothing refuted, something undecided; where several apply, 2 before 1 before 3.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import click

from derive._version import __version__
from derive.errors import InputError

__all__ = ["cli", "main"]

REFUTED, BAD_INPUT, UNDECIDED, INTERRUPTED = 1, 2, 3, 130


class OneLineErrors(click.Group):
    """A group of commands that reports every error as one line on standard error."""

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run the command line and exit."""
        try:
            code = super().main(*args, **{**kwargs, "standalone_mode": False})
        except (click.ClickException, InputError) as error:
            complain(error.format_message() if isinstance(error, click.ClickException) else str(error))
            code = BAD_INPUT
        except click.Abort:
            complain("stopped")
            code = INTERRUPTED
        sys.exit(code if isinstance(code, int) else 0)


def complain(message: str) -> None:
    """Print one line on standard error."""
    click.echo(f"derive: {' '.join(message.split())}", err=True)


@contextmanager
def progress(label: str) -> Iterator[Any]:
    """Show on a terminal what is going on; yields a function that names the present work."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True).status(label) as status:
        yield status.update


@click.group(cls=OneLineErrors, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="derive")
def cli() -> None:
    """Equations of optimal estimation, each with a proof that a machine can replay.

    Exit codes: 0 everything as expected, 1 something refuted or rejected, 2 bad input or usage, 3 undecided.
    """


@cli.command("list")
@click.option("--equations", metavar="DOCUMENT", help="List the equations of a source: 000, 001, 002 or 004.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def list_command(equations: str | None, as_json: bool) -> None:
    """List lectures and theories, or the numbered equations of a source with their verdicts."""
    from derive import catalogue

    if equations is not None:
        rows = [entry.as_dict() for entry in catalogue.equations(catalogue.document_key(equations))]
        click.echo(json.dumps(rows, indent=1) if as_json else aligned(rows))
        return
    with progress("deriving the lectures"):
        tables = {"lectures": catalogue.lectures(), "theories": catalogue.theories()}
    if as_json:
        click.echo(json.dumps(tables, indent=1, ensure_ascii=False))
    else:
        click.echo("\n\n".join(aligned(rows) for rows in tables.values()))


def aligned(rows: list[dict[str, str | int]]) -> str:
    """Return rows as a table of aligned columns."""
    table = [list(rows[0]), *([str(value) for value in row.values()] for row in rows)] if rows else []
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return "\n".join("  ".join(map(str.ljust, row, widths)).rstrip() for row in table)


@cli.command()
@click.option("-o", "folder", default="tour", show_default=True, type=click.Path(path_type=Path), help="Folder.")
def tour(folder: Path) -> int:
    """Write notes of every lecture, the findings on their sources and one plant validated by every route.

    The folder then holds index.html, which opens in a browser without network, pages of long lectures, sliders.html
    for the scalar filter, the same in Markdown, the figures, and certificates/*.json.
    """
    from derive.files import make_folder

    make_folder(folder)
    with progress("starting") as show:
        from derive.numeric.plant import example_plant
        from derive.tour import write_tour
        from lmi.validation import validate

        def validation(plant: Any) -> Any:
            return validate(plant, progress=lambda route: show(f"validating {plant.name}: {route}")).as_dict()

        summary = write_tour(folder, example_plant(), validation, progress=show)
    for line in summary.lines():
        click.echo(line)
    return 0 if summary.expected else REFUTED


@cli.command()
@click.argument("lectures", nargs=-1, required=True, metavar="LECTURE...")
@click.option("-o", "path", required=True, type=click.Path(path_type=Path), help="File; .md, .html or .json.")
@click.option("--to", "flavour", type=click.Choice(["gfm"]), help="Flavour of Markdown.")
@click.option("--plant", metavar="FILE", help="Add a worked example: the plant in FILE, validated by every route.")
def notes(lectures: tuple[str, ...], path: Path, flavour: str | None, plant: str | None) -> int:
    """Write the notes of each LECTURE (see `derive list`) to a file whose suffix chooses the format."""
    from derive.notes import write_notes

    with progress("deriving") as show:
        example = partial(example_of, plant, show) if plant else None
        return 0 if write_notes(lectures, path, flavour, show, example) else REFUTED


def example_of(path: str, show: Callable[[str], None]) -> Sequence[Any]:
    """Return the worked example of the plant in a file, validated by every route."""
    from derive.numeric.plant import load_plant
    from derive.worked import worked_example
    from lmi.validation import validate

    plant = load_plant(path)
    return worked_example(plant, validate(plant, progress=lambda route: show(f"validating: {route}")).as_dict())


@cli.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...", type=click.Path(path_type=Path))
def verify(files: tuple[Path, ...]) -> int:
    """Replay the certificates in each FILE with the kernel and the installed theories."""
    from derive.replay import verify_file

    codes = {0}
    for path in files:
        try:
            reports = verify_file(path)
        except InputError as error:
            complain(str(error))
            codes.add(BAD_INPUT)
            continue
        for report in reports:
            name = report.lecture or "certificate"
            click.echo(f"{path}: {name}: {report.proved} of {report.total} proved ({report.authority})")
            if not report.total:
                codes.add(UNDECIDED)
            for outcome in (o for o in report.outcomes if not o.accepted):
                click.echo(f"  rejected {outcome.step}: {outcome.message}")
                codes.add(REFUTED)
    return next(code for code in (BAD_INPUT, REFUTED, UNDECIDED, 0) if code in codes)


@cli.command()
@click.argument("claims", nargs=-1, required=True, metavar="CLAIM|FILE...")
@click.option("--theory", default="", metavar="KEY", help="Theory in which claims are read that name none.")
@click.option("--assume", multiple=True, metavar="FORMULA", help="Relation in LaTeX that is given; repeatable.")
@click.option("--scalar", is_flag=True, help="Read every dimension as 1, where factors commute.")
@click.option("--format", "form", type=click.Choice(["text", "json", "sarif"]), default="text", show_default=True)
@click.option("--certificates", metavar="DIR", type=click.Path(path_type=Path), help="Write certificates there.")
@click.option("--timeout", type=click.FloatRange(0.1, 86400), default=10.0, show_default=True, help="Seconds a claim.")
@click.option("--jobs", type=click.IntRange(1, 256), help="Processes that decide; by default one a core.")
def check(claims: tuple[str, ...], form: str, certificates: Path | None, jobs: int | None, **options: Any) -> int:
    """Check formulas: each CLAIM in LaTeX, and the equations of each FILE.

    What exists, or ends in .md, .tex, .ipynb or .jsonl, is a file; - reads standard input. Each claim is proved,
    refuted, supported or undecided. Exit codes: 0 all proved, 2 something cannot be read, 1 something is refuted,
    3 something is only supported or undecided; where several apply, 2 before 1 before 3.
    """
    from derive.check.certificates import write_certificates
    from derive.check.run import check as run
    from derive.check.run import usable_cores
    from derive.check.text import complaints
    from derive.files import make_folder

    if certificates:
        make_folder(certificates)
    with counting("deciding") as show:
        report = run(claims, jobs=jobs or usable_cores(), progress=show, **options)
    if certificates:
        write_certificates(report, certificates)
    forms = {"text": lambda: str(report), "json": lambda: as_json(report.to_json()),
             "sarif": lambda: as_json(report.to_sarif())}  # fmt: skip
    click.echo(forms[form]())
    for line in complaints(report):
        complain(line)
    return report.exit_code


def as_json(data: object) -> str:
    """Return data as JSON for people and programs; characters that no encoding has are escaped."""
    text = json.dumps(data, indent=1, ensure_ascii=False)
    return text.encode("utf-8", "backslashreplace").decode()


@contextmanager
def counting(label: str) -> Iterator[Callable[[int, int], None]]:
    """Show a bar on a terminal; yields a function that is told how much is done, and of how much."""
    if not sys.stderr.isatty():
        yield lambda done, of: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, of: bar.update(task, completed=done, total=of)


def main() -> NoReturn:
    """Run the command line and exit."""
    cli.main()
