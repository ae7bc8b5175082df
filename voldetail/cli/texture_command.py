"""`voldetail texture`: a procedural colour texture from a photo, its pictures, edits and morphs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.arguments import numbers, size, whole_numbers
from voldetail.cli.console import output, remarks
from voldetail.cli.outputs import check_file, check_folder, make_folder, remove
from voldetail.cli.shape_options import MESH_HELP, shape_of
from voldetail.cli.threads import use_threads
from voldetail.detail.texture_file import load_example, load_texture, save_texture
from voldetail.errors import InputError
from voldetail.records.refusal import shown

MOST_STEPS = 200
NUMBERS_A_LOBE = 5
LARGEST_SEED = 2**32 - 1

_Texture = Annotated[Path, typer.Argument(metavar="TEXTURE", help="A texture file, as texture fit makes it.")]
_Seed = Annotated[int | None, typer.Option(min=0, max=LARGEST_SEED, help="The seed of the noise.")]
_Size = Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")]
_Solid = Annotated[bool, typer.Option("--solid", help="A slice of the solid texture.")]

texture_app = typer.Typer(
    name="texture", help="A procedural colour texture from one photo: endless, a few numbers.", no_args_is_help=True
)


@texture_app.command()
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
    seed: _Seed = None,
) -> None:
    """Analyse a photo: about seventy numbers that make the texture."""
    from voldetail.image import load_masked
    from voldetail.image.examples import picture_path
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
    _say(f"{out}  {count} numbers from {pixels.shape[1]} x {pixels.shape[0]} pixels{words}")


@texture_app.command()
def render(
    context: typer.Context,
    texture: _Texture,
    out: Annotated[Path, typer.Option("--output", "-o", help="The picture: .png, .jpg or .exr (linear).")],
    pixels: _Size = "512x512",
    offset: Annotated[str, typer.Option(help="X,Y in texels, right and up.")] = "0,0",
    zoom: Annotated[float, typer.Option(min=1e-3, max=1e3, help="Pixels a texel of the photo.")] = 1.0,
    solid: _Solid = False,
    shape: Annotated[str | None, typer.Option("--on", metavar="MESH", help="Show it on a shape: " + MESH_HELP)] = None,
    texels: Annotated[
        float | None,
        typer.Option(min=1e-2, max=1e4, help="Texels a scene unit, with --on; a shape is 2 long. Default: the photo spans it."),
    ] = None,
) -> None:
    """Make a picture of a texture, of any size, or of a shape that is coloured by it."""
    from voldetail.apply import painted
    from voldetail.apply import render as picture_of
    from voldetail.image import check_suffix, save_image
    from voldetail.texture import picture

    check_suffix(out)
    check_file(out)
    record = load_texture(texture)
    columns, rows = size(pixels)
    x, y = numbers(offset, 2, "--offset", "X,Y in texels")
    if max(abs(x), abs(y)) > 1e6:
        raise InputError(f"--offset {shown(offset)} is too far; allowed: -1000000 to 1000000 texels.")
    if shape is None and texels is not None:
        raise InputError("--texels is for a shape; give --on as well, or --zoom instead.")
    shape = None if shape is None else shape_of(shape)
    use_threads(context.obj)
    with remarks().status("making the picture"):
        if shape is None:
            made = picture(record, (columns, rows), (x, y), zoom, solid)
        else:
            made = picture_of(painted(record, texels), shape, size=(columns, rows))
        save_image(out, made)
    _say(f"{out}  {columns} x {rows} pixels")


@texture_app.command()
def edit(
    texture: _Texture,
    out: Annotated[Path, typer.Option("--output", "-o", help="The new texture file, .json.")],
    gain: Annotated[
        list[str] | None,
        typer.Option(metavar="BAND=FACTOR", help="BAND: 0 (the finest) and up, 0-2, fine, middle or coarse. Repeat it."),
    ] = None,
    contrast: Annotated[float, typer.Option(min=0, max=10, help="Of the colours about their mean.")] = 1.0,
    seed: _Seed = None,
) -> None:
    """Make bands of a texture stronger or weaker; the histogram stays, --contrast changes it."""
    from voldetail.texture import edit as edited

    check_file(out)
    gains: dict[int | str, float] = {}
    for text in gain or []:
        band, factor = _gain(text)
        gains[band] = gains.get(band, 1.0) * factor
    save_texture(out, edited(load_example(texture), gains, contrast=contrast, seed=seed))
    _say(str(out))


@texture_app.command()
def morph(
    context: typer.Context,
    first: Annotated[Path, typer.Argument(metavar="A", help="The texture file to begin with.")],
    last: Annotated[Path, typer.Argument(metavar="B", help="The texture file to end with.")],
    folder: Annotated[Path, typer.Option("--output", "-o", help="The folder for the pictures and texture files.")],
    steps: Annotated[int, typer.Option(min=2, max=MOST_STEPS, help="Pictures, both ends included.")] = 5,
    pixels: _Size = "256x256",
    solid: _Solid = False,
    force: Annotated[bool, typer.Option("--force", help="Replace the steps in the folder.")] = False,
) -> None:
    """Go from one texture to another: a picture and a texture file for each step."""
    from voldetail.image import save_png
    from voldetail.texture import morph as between
    from voldetail.texture import picture

    check_folder(folder)
    a, b = load_example(first), load_example(last)
    columns, rows = size(pixels)
    old = sorted([*folder.glob("step_*.png"), *folder.glob("step_*.json")]) if folder.is_dir() else []
    if old and not force:
        raise InputError(f"The folder {folder} has {old[0].name} in it; give another, or --force to replace the steps.")
    make_folder(folder)
    remove(old)
    use_threads(context.obj)
    with remarks().status("making the pictures"):
        for step in range(steps):
            made = between(a, b, step / (steps - 1))
            save_texture(folder / f"step_{step:03d}.json", made)
            save_png(folder / f"step_{step:03d}.png", picture(made, (columns, rows), solid=solid))
    _say(f"{folder}  {steps} steps")


def _gain(text: str) -> tuple[str, float]:
    band, _, factor = text.partition("=")
    try:
        return band.strip(), float(factor)
    except ValueError:
        raise InputError(f"--gain {shown(text)} is not understood; give BAND=FACTOR, e.g. 0=0.5 or coarse=2.") from None


def _zone(text: str, columns: int, rows: int) -> tuple[int, int, int, int]:
    x, y, width, height = whole_numbers(text, 4, "--zone", "X,Y,WIDTH,HEIGHT in pixels")
    if min(x, y) < 0 or min(width, height) < 1 or x + width > columns or y + height > rows:
        raise InputError(f"--zone {shown(text)} reaches outside the photo of {columns} x {rows} pixels; give a part of it.")
    return x, y, width, height


def _say(line: str) -> None:
    output().print(line, markup=False, soft_wrap=True)
