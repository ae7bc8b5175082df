"""The commands, found in `cli/commands`, and the options that all of them share."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from typing import Annotated

import typer

from voldetail import __version__
from voldetail.cli import commands
from voldetail.cli.console import MANNER

MOST_THREADS = 1024
EVERYWHERE = "Also, before or after any command: --json, --quiet, --verbose, --debug."

app = typer.Typer(
    name="voldetail",
    help="Fit procedural relief to one photograph, and render it on any mesh under any light.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _add(group: typer.Typer, package: str, folder: list[str]) -> None:
    """Add the commands of a package: of each module the function that has its name, of each package in it a group."""
    for found in iter_modules(folder):
        module = import_module(f"{package}.{found.name}")
        if found.ispkg:
            words = (module.__doc__ or "").strip()
            below = typer.Typer(name=found.name, help=words, no_args_is_help=True)
            _add(below, f"{package}.{found.name}", list(module.__path__))
            group.add_typer(below)
        else:
            group.command(epilog=EVERYWHERE)(getattr(module, found.name))


_add(app, commands.__name__, list(commands.__path__))


def _version(wanted: bool) -> None:
    if wanted:
        print(f"voldetail {__version__}")
        raise typer.Exit()


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
    threads: Annotated[int, typer.Option(min=0, max=MOST_THREADS, help="Processor threads for rendering; 0 for all.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print results and errors alone.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", help="Say what is decided, and how long it took.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    MANNER.threads = threads
