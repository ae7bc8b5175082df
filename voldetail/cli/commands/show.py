"""`voldetail show`: a detail file in words and units."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from voldetail.cli.console import MANNER, output, result
from voldetail.cli.shape_options import DETAIL_HELP
from voldetail.detail import Detail, describe_in_words, detail_to_text, summary
from voldetail.detail.photo_relief import MappedDetail


def show(
    detail: Annotated[Path, typer.Argument(help=DETAIL_HELP)],
) -> None:
    """Show the parameters of a detail in words and units, or what is known of a photo's relief."""
    from voldetail.recover.files import load_any

    record = load_any(detail)
    if isinstance(record, MappedDetail):
        _show_relief(record)
        return
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


def _show_relief(relief: MappedDetail) -> None:
    record, r = relief.record, relief.reflectance
    kind = "a tile" if record.periodic else "the photo as it is"
    result(
        record.model_dump(mode="json"),
        record.name,
        f"The photo's own relief, {kind}: {record.columns} x {record.rows} pixels, {record.texels_per_unit:.4g} a scene unit.",
        f"Amplitude {record.relief.amplitude:.3g} scene units, light {record.light}, confidence {record.confidence:.2f}.",
        f"Ka {r.ambient:.3g}, Kd {r.diffuse:.3g}, Ks {r.specular:.3g}, N {r.shininess:.3g}.",
        *record.notes,
    )


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
