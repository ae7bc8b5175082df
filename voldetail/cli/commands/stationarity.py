"""`voldetail stationarity`: how even a texture is."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from voldetail.cli.console import output, remarks, result
from voldetail.cli.even_photo import MaskFile, PhotoName, read_even
from voldetail.cli.outputs import check_file

MEASURED_SIDE = 1024  # pixels: a larger photo is measured smaller, in seconds instead of minutes
UNITS = {"histogram": "L*a*b*", "steerable": "L*a*b*"}


def stationarity(
    photo: PhotoName,
    heat: Annotated[Path | None, typer.Option(help="A picture of where the photo differs from the rest: .png or .jpg.")] = None,
    measure: Annotated[str, typer.Option(help="The measure of --heat.")] = "histogram",
    sigma: Annotated[
        float | None, typer.Option(help="Size of the neighbourhoods in pixels; default a twelfth of the shorter side.")
    ] = None,
    mask: MaskFile = None,
    tile: Annotated[bool, typer.Option("--tile", help="The photo is a tile: its opposite edges meet.")] = False,
) -> None:
    """Measure how far a texture is from being the same everywhere; 0 is perfectly even."""
    from voldetail.image import check_suffix, resize, resize_mask, save_image
    from voldetail.report.heat import heat as coloured
    from voldetail.stationary.measure import MEASURES, check_measure, checked_sigma
    from voldetail.stationary.measure import stationarity as measured

    check_measure(measure)
    if heat is not None:
        check_suffix(heat)
        check_file(heat)
    picture, use = read_even(photo, mask)
    width = checked_sigma(sigma, use.shape)
    shrink = min(1.0, MEASURED_SIDE / max(use.shape))
    if shrink < 1:
        shape = (round(use.shape[0] * shrink), round(use.shape[1] * shrink))
        picture, use = resize(picture, shape), resize_mask(use, shape)
        remarks().print(f"The photo was measured at {shape[1]} x {shape[0]} pixels.", markup=False, soft_wrap=True)
    measures: dict[str, float] = {}
    table = Table(box=None, padding=(0, 2, 0, 0))
    for heading in ("measure", "value", "unit"):
        table.add_column(heading, no_wrap=True)
    with remarks().status("measuring") as status:
        for name in MEASURES:
            status.update(f"measuring: {name}")
            found = measured(picture, use, measure=name, sigma=max(width * shrink, 1.0), toroidal=tile)
            measures[name] = found.value
            table.add_row(name, f"{found.value:.4g}", UNITS.get(name, "L*a*b* squared"))
            if heat is not None and name == measure:
                save_image(heat, coloured(found.map, picture))
    output().print(table)
    where = f"  {heat}" if heat else ""
    result({"measures": measures, "sigma": width, "heat": str(heat) if heat else None}, f"sigma {width:.3g} pixels{where}")
