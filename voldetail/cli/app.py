"""The commands and the options that all of them share."""

from __future__ import annotations

from typing import Annotated

import typer

from voldetail import __version__
from voldetail.cli.bake_command import bake
from voldetail.cli.compare_command import compare
from voldetail.cli.fit_command import fit
from voldetail.cli.library_command import library_app
from voldetail.cli.render_command import relight, render
from voldetail.cli.retrieve_command import retrieve
from voldetail.cli.show_command import schema, show
from voldetail.cli.stationarize_command import stationarity, stationarize
from voldetail.cli.texture_command import texture_app

MOST_THREADS = 1024

app = typer.Typer(
    name="voldetail",
    help="Fit procedural relief to one photograph, and render it on any mesh under any light.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (fit, render, relight, bake, compare, stationarize, stationarity, retrieve, show, schema):
    app.command()(command)
app.add_typer(texture_app)
app.add_typer(library_app)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"voldetail {__version__}")
        raise typer.Exit()


@app.callback()
def options(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
    threads: Annotated[
        int, typer.Option(min=0, max=MOST_THREADS, help="Processor threads for rendering; 0 for all.")
    ] = 0,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    context.obj = threads
