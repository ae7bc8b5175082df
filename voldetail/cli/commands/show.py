"""`voldetail show`: a detail file in words and units."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from voldetail.cli.console import MANNER, output
from voldetail.detail import Detail, describe_in_words, detail_to_text, load_detail, summary


def show(
    detail: Annotated[Path, typer.Argument(help="A detail file, as fit makes it.")],
) -> None:
    """Show the parameters of a detail in words and units."""
    record = load_detail(detail)
    if MANNER.as_json:
        print(detail_to_text(record), end="")
        return
    console = output()
    console.print(Text(record.name, style="bold"))
    console.print(Text(summary(record)), soft_wrap=not console.is_terminal)
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("parameter", no_wrap=True)
    table.add_column("value", max_width=30)
    table.add_column("unit", no_wrap=True)
    table.add_column("meaning")
    for label, value, unit, sentence in describe_in_words(record):
        table.add_row(Text(label), Text(value), Text(unit), Text(sentence))
    console.print(table)
    for line in _origin(record):
        console.print(Text(line), soft_wrap=not console.is_terminal)


def _origin(record: Detail) -> list[str]:
    """Where a detail came from and how good it is, in lines."""
    from voldetail.report.verdict import verdict

    made = record.provenance
    if made is None:
        return []
    zone = f", zone {','.join(map(str, made.zone))}" if made.zone else ""
    return [
        f"Fitted to {made.photo}{zone} at {made.resolution} pixels, light {made.light}, proxy {made.proxy}.",
        f"Made {made.created} by voldetail {made.voldetail} ({made.solver} solver, metric {made.metric}): "
        f"{made.evaluations} pictures in {made.seconds:.0f} s.",
        verdict(made.distance, record.noise_floor).sentence,
    ]
