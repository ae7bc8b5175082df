"""`voldetail texture edit`: bands made stronger or weaker."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.console import result
from voldetail.cli.outputs import check_file
from voldetail.cli.texture_options import Seed, TextureFile
from voldetail.detail.texture_file import load_example, save_texture
from voldetail.errors import InputError
from voldetail.records.refusal import shown


def edit(
    texture: TextureFile,
    out: Annotated[Path, typer.Option("--output", "-o", help="The new texture file, .json.")],
    gain: Annotated[
        list[str] | None,
        typer.Option(metavar="BAND=FACTOR", help="BAND: 0 (the finest) and up, 0-2, fine, middle or coarse. Repeat it."),
    ] = None,
    contrast: Annotated[float, typer.Option(min=0, max=10, help="Of the colours about their mean.")] = 1.0,
    seed: Seed = None,
) -> None:
    """Make bands of a texture stronger or weaker; the histogram stays, --contrast changes it."""
    from voldetail.texture import edit as edited

    check_file(out)
    gains: dict[int | str, float] = {}
    for text in gain or []:
        band, factor = _gain(text)
        gains[band] = gains.get(band, 1.0) * factor
    save_texture(out, edited(load_example(texture), gains, contrast=contrast, seed=seed))
    result({"file": str(out)}, str(out))


def _gain(text: str) -> tuple[str, float]:
    band, _, factor = text.partition("=")
    try:
        return band.strip(), float(factor)
    except ValueError:
        raise InputError(f"--gain {shown(text)} is not understood; give BAND=FACTOR, e.g. 0=0.5 or coarse=2.") from None
