"""The command line of the convex programs: `lmi validate PLANT`."""

import sys
from typing import Any, NoReturn

import click

from derive._version import __version__

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
def validate(plant: str, form: str) -> int:
    """Compute the optimal error covariance of PLANT by every route and compare them in one table.

    PLANT is a file (.toml, .json, .npz, .mat) with time, A, C, W, V and optionally N, M, B, D_u.
    """
    from rich.console import Console

    from derive.errors import InputError
    from lmi.validation import validate as run

    try:
        with Console(stderr=True).status("plant") as status:  # shows nothing unless standard error is a terminal
            validation = run(plant, progress=status.update)
    except InputError as error:
        raise click.ClickException(str(error)) from None
    if form == "json":
        import json

        click.echo(json.dumps(validation.as_dict(), indent=2, allow_nan=False))
    else:
        from lmi.report import print_table

        print_table(validation)
    return validation.verdict.exit_code


def main() -> NoReturn:
    """Run the command line and exit."""
    cli.main()
