"""The command line of the convex programs: `lmi validate PLANT`, `lmi design PLANT`, `lmi certify FILE`."""

import sys
from typing import TYPE_CHECKING, Any, NoReturn

import click

from derive._version import __version__

if TYPE_CHECKING:
    from lmi.validation import Validation

__all__ = ["cli", "main"]

BAD_INPUT = 2
"""Exit code for bad input or usage."""


class OneLineErrors(click.Group):
    """A group of commands that reports every error as one line on standard error."""

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run the command line and exit."""
        try:
            code = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.ClickException as error:
            message = " ".join(error.format_message().split())
            click.echo(f"lmi: {message}", err=True)
            code = BAD_INPUT
        except click.Abort:
            click.echo("lmi: stopped", err=True)
            code = 130
        sys.exit(code if isinstance(code, int) else 0)


@click.group(cls=OneLineErrors, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="lmi")
@click.pass_context
def cli(context: click.Context) -> None:
    """Convex programs for optimal estimation.

    Exit codes: 0 confirmed and none disagrees, 1 a route disagrees, 2 bad input or usage, 3 nothing could be confirmed.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@cli.command()
@click.argument("plant")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="What to print."
)
@click.option("--certificate", metavar="FILE", help="Where to write the exact certificate; lmi certify verifies it.")
@click.option("-o", "--output", metavar="REPORT.html", help="Where to write the report as a page, with its figures.")
def validate(plant: str, form: str, certificate: str | None, output: str | None) -> int:
    """Compute the optimal error covariance of PLANT by every route and compare them in one table.

    PLANT is a file (.toml, .json, .npz, .mat) with time, A, C, W, V and optionally N, M, B, D_u.
    """
    from rich.console import Console

    from derive.errors import InputError
    from lmi.validation import validate as run

    try:
        _check_places(certificate)
        if output is not None:
            _check_page(output)
        with Console(stderr=True).status("plant") as status:  # shows nothing unless standard error is a terminal
            validation = run(plant, progress=status.update)
            if output is not None:
                status.update("page")
                _write_page(output, validation)
        if certificate is not None and validation.certificate.certified is not None:
            from lmi.certificate.file import write_certificate

            write_certificate(validation.certificate.certified.certificate, certificate)
        elif certificate is not None:
            _say_not_written(certificate, "nothing was certified")
    except InputError as error:
        raise click.ClickException(str(error)) from None
    if form == "json":
        import json

        click.echo(json.dumps(validation.as_dict(), indent=2, allow_nan=False))
    else:
        from lmi.report.table import print_table

        print_table(validation)
    return validation.verdict.exit_code


def _check_places(*places: str | None) -> None:
    """Refuse places where no file can be, before long work on what goes there."""
    from pathlib import Path

    from derive.files import check_place

    for place in places:
        if place is not None:
            check_place(Path(place))


def _say_not_written(place: str, reason: str) -> None:
    """Say that a file that was asked for is not written; an older one may be there."""
    click.echo(f"lmi: {place}: not written, as {reason}", err=True)


def _check_page(output: str) -> None:
    from pathlib import Path

    from derive.validation_page import check_page

    check_page(Path(output))


def _write_page(output: str, validation: "Validation") -> None:
    from pathlib import Path

    from derive.validation_page import write_page

    write_page(Path(output), validation.plant, validation.as_dict())


@cli.command()
@click.argument("plant")
@click.option("--objective", type=click.Choice(["h2", "hinf"]), default="h2", show_default=True, help="What is small.")
@click.option("--gamma", type=float, help="An H-infinity norm that suffices; without it the smallest is sought.")
@click.option("--decay", type=float, help="Rate [1/s] at which every mode falls at least.")
@click.option("--dual", is_flag=True, help="Read A, B, Q, R and design state feedback u = -Kx.")
@click.option("-o", "--output", metavar="FILE", help="Where to write the design; lmi certify verifies it.")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="What to print."
)
def design(
    plant: str, objective: str, gamma: float | None, decay: float | None, dual: bool, output: str | None, form: str
) -> int:
    """Find an observer gain for PLANT and prove what it achieves.

    The cost tr MP is the square of the H2 norm from noise to M^(1/2) e, the error weighted; the H-infinity norm is that
    of the same transfer matrix. Both are recomputed from the gain, and certified exactly.

    Exit codes: 0 certified, 1 proved that no gain meets the request, 2 bad input or usage, 3 not certified.
    """
    from rich.console import Console

    from derive.errors import InputError
    from lmi.synthesis.command import design_lines
    from lmi.synthesis.designs import design as run
    from lmi.synthesis.file import design_text, write_design

    try:
        _check_places(output)
        with Console(stderr=True).status("plant") as status:  # shows nothing unless standard error is a terminal
            found = run(plant, objective, gamma=gamma, decay=decay, dual=dual, progress=status.update)
        if output is not None and found.gain is not None:
            write_design(found, output)
        elif output is not None:
            _say_not_written(output, "no gain was found")
        text = design_text(found) if form == "json" else "\n".join(design_lines(found))
    except InputError as error:
        raise click.ClickException(str(error)) from None
    click.echo(text)
    return found.verdict.exit_code


@cli.command()
@click.argument("file", required=False)
@click.option("--plant", metavar="PLANT", help="The plant that FILE must be about, or that --gain is for.")
@click.option(
    "--gain", metavar="L.csv", help="A gain from anywhere: one line for each state, one column for each output."
)
@click.option("-o", "--output", metavar="FILE", help="Where to write the certificate of --gain.")
def certify(file: str | None, plant: str | None, gain: str | None, output: str | None) -> int:
    """Verify FILE, a certificate or a design, in integers and print what it proves, or certify a gain for a plant.

    Nothing in FILE is believed: the inequalities are decided and the bounds computed from its matrices. With --plant
    and --gain instead of FILE, a bound on the gain is proved, or that it does not stabilise.

    Exit codes: 0 proved, 1 rejected or proved not to stabilise, 2 bad input or usage, 3 nothing proved.
    """
    from derive.errors import InputError

    if (
        (file is None) == (gain is None)
        or (gain is not None and plant is None)
        or (file is not None and output is not None)
    ):
        raise click.UsageError(
            "expected FILE [--plant PLANT] or --plant PLANT --gain L.csv [-o FILE]; try lmi certify -h"
        )
    try:
        lines, code = _certified_file(file, plant) if file is not None else _certified_gain(plant, gain, output)
    except InputError as error:
        raise click.ClickException(str(error)) from None
    click.echo("\n".join(lines))
    return code


def _certified_file(file: str, plant: str | None) -> tuple[list[str], int]:
    from lmi.certificate.command import certify_file

    return certify_file(file, plant)


def _certified_gain(plant: str | None, gain: str | None, output: str | None) -> tuple[list[str], int]:
    from rich.console import Console

    from derive.numeric.plant import as_plant
    from lmi.certification.command import certify_gain, read_gain

    _check_places(output)
    loaded = as_plant(plant or "")
    matrix = read_gain(gain or "", loaded)
    with Console(stderr=True).status("certificate"):  # shows nothing unless standard error is a terminal
        lines, code = certify_gain(loaded, matrix, output)
    if output is not None and code:
        _say_not_written(output, "nothing was certified")
    return lines, code


def main() -> NoReturn:
    """Run the command line and exit."""
    cli.main()
