"""`voldetail texture fit`: about seventy numbers from a photo."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.arguments import zone as zone_of
from voldetail.cli.console import result
from voldetail.cli.outputs import check_file
from voldetail.cli.texture_options import Seed
from voldetail.detail.texture_file import save_texture
from voldetail.errors import InputError
from voldetail.records.refusal import shown

NUMBERS_A_LOBE = 5


def fit(
    photo: Annotated[str, typer.Argument(metavar="PHOTO", help="The photo of a texture, or skimage:gravel, :grass, :brick.")],
    out: Annotated[Path, typer.Option("--output", "-o", help="The texture file, .json.")],
    mask: Annotated[Path | None, typer.Option(help="A picture of the photo's size; white is used.")] = None,
    zone: Annotated[str | None, typer.Option(help="X,Y,WIDTH,HEIGHT in pixels: the part to use. Default: all.")] = None,
    histogram: Annotated[
        bool, typer.Option("--histogram/--no-histogram", help="Match the photo's histogram, or take a Gaussian one.")
    ] = True,
    encoding: Annotated[str, typer.Option(help="srgb or linear: what the channels are sums of.")] = "srgb",
    directed: Annotated[
        bool | None,
        typer.Option(
            "--directed/--isotropic", help="Whether the noise has directions. Default: where the photo's spectrum has them."
        ),
    ] = None,
    seed: Seed = None,
) -> None:
    """Analyse a photo: about seventy numbers that make the texture."""
    from voldetail.image import load_masked
    from voldetail.records.examples import picture_path
    from voldetail.texture import analyse

    check_file(out)
    loaded = load_masked(photo, mask)
    path, pixels, used = picture_path(photo), loaded.pixels, loaded.opaque
    if zone is not None:
        x, y, width, height = _zone(zone, pixels.shape[1], pixels.shape[0])
        pixels = pixels[y : y + height, x : x + width]
        used = None if used is None else used[y : y + height, x : x + width]
    made = analyse(
        pixels, used, seed=seed or 0, name=path.stem[:200] or "texture", photo_name=path.name[:400],
        match_histogram=histogram, encoding=encoding, directed=directed,
    )  # fmt: skip
    save_texture(out, made)
    count = sum(len(c.weights) + NUMBERS_A_LOBE * len(c.lobes) + len(c.curve) for c in made.channels) + len(made.axes)
    words = ", with directions" if any(c.lobes for c in made.channels) else ""
    result(
        {"file": str(out), "numbers": count, "directed": bool(words)},
        f"{out}  {count} numbers from {pixels.shape[1]} x {pixels.shape[0]} pixels{words}",
    )


def _zone(text: str, columns: int, rows: int) -> tuple[int, int, int, int]:
    x, y, width, height = zone_of(text)
    if min(x, y) < 0 or min(width, height) < 1 or x + width > columns or y + height > rows:
        raise InputError(f"--zone {shown(text)} reaches outside the photo of {columns} x {rows} pixels; give a part of it.")
    return x, y, width, height
