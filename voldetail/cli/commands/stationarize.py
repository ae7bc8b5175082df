"""`voldetail stationarize`: tiles that repeat unseen."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from voldetail.cli.console import Json, output, remarks, result
from voldetail.cli.even_photo import MaskFile, PhotoName, read_even
from voldetail.cli.outputs import check_file
from voldetail.cli.threads import use_threads
from voldetail.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from voldetail.cli.progress import ProgressView
    from voldetail.stationary.tile import Tile, TileProgress

MEASURE_HELP = (
    "What has to be alike everywhere: histogram, moments2, moments3, moments4, mean, steerable; or none, for plain PatchMatch."
)

_Pairs = list[str] | None


def stationarize(
    photo: PhotoName,
    out: Annotated[Path, typer.Option("--output", "-o", help="The tile: .png, .jpg or .exr (linear).")],
    measure: Annotated[str, typer.Option(help=MEASURE_HELP)] = "histogram",
    sigma: Annotated[
        float | None,
        typer.Option(help="Pixels across which everything has to be alike; default a twelfth of the tile; less is evener."),
    ] = None,
    levels: Annotated[
        int | None, typer.Option(help="Make so many tiles instead, from the evenest to the least even: TILE-1.png and so on.")
    ] = None,
    pixels: Annotated[int, typer.Option("--size", help="The tile's side in pixels.")] = 256,
    mask: MaskFile = None,
    carry: Annotated[
        _Pairs, typer.Option(metavar="MAP=OUT", help="Tile a map of the photo's size (height, albedo) along with it.")
    ] = None,
    carry_normals: Annotated[_Pairs, typer.Option(metavar="MAP=OUT", help="The same for a map of normals.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="The root of all random numbers.")] = 0,
) -> None:
    """Make a tile from a photo that repeats without seams and without a visible pattern.

    Ctrl-C ends the search with the best so far.
    """
    from voldetail.cli.progress import ProgressView
    from voldetail.image import check_suffix
    from voldetail.stationary.control import palette
    from voldetail.stationary.levels import checked_size
    from voldetail.stationary.tile import stationarize as make

    if sigma is not None and levels is not None:
        raise InputError("--sigma and --levels were both given; choose one.")
    targets = [out] if levels is None else [out.with_stem(f"{out.stem}-{i + 1}") for i in range(max(levels, 0))]
    if levels is not None and (carry or carry_normals):
        raise InputError("--carry and --levels were both given; choose a level's sigma first, then carry maps with --sigma.")
    maps = [(*_pair(text, "--carry"), False) for text in carry or []]
    maps += [(*_pair(text, "--carry-normals"), True) for text in carry_normals or []]
    for target in [*targets, *(to for _, to, _ in maps)]:
        check_suffix(target)
        check_file(target)
    picture, use = read_even(photo, mask)
    checked_size(pixels, use.shape)
    carried = [(_read_map(path, use.shape, normals), target, normals) for path, target, normals in maps]
    options: dict[str, Any] = {"measure": None if measure == "none" else measure, "mask": use, "seed": seed}
    use_threads()
    with ProgressView(remarks()) as view:
        tell = _teller(view)
        if levels is None:
            tile = make(picture, pixels, sigma=sigma, on_progress=lambda p: tell(0, 1, p), **options)
            tiles, stopped = [tile], tile.interrupted
        else:
            found = palette(picture, pixels, levels=levels, on_progress=tell, **options)
            tiles, stopped = list(found.tiles), found.interrupted
    written = [_write(tile, target) for tile, target in zip(tiles, targets, strict=False)]
    for values, target, normals in carried:
        _write_map(tiles[0], values, target, normals)
    result({"tiles": written, "maps": [str(target) for _, target, _ in carried], "stopped": stopped})
    if stopped:
        output().print("Stopped by you: this is the best so far.")


def _pair(text: str, option: str) -> tuple[Path, Path]:
    """The two files of "MAP=OUT"; a name with = in it may be the first's."""
    first, _, second = text.rpartition("=")
    if not first or not second:
        raise InputError(f"{option} {text!r} is not understood; give MAP=OUT, e.g. height.png=height-tile.exr.")
    return Path(first), Path(second)


def _read_map(path: Path, shape: tuple[int, ...], normals: bool) -> NDArray[np.float32]:
    """A map's stored values (H, W) or (H, W, 3); normals as vectors of -1 to 1."""
    import numpy as np

    from voldetail.image.load import load_samples

    values = np.asarray(load_samples(path, "map").values, np.float32)
    if values.shape[:2] != shape:
        raise InputError(
            f"The map {path} has {values.shape[1]} x {values.shape[0]} pixels and the photo {shape[1]} x {shape[0]};"
            " give one of the photo's size."
        )
    if not normals:
        return values
    if values.ndim != 3:
        raise InputError(f"The map {path} is grey; normals have three channels, so use --carry for it.")
    return values if values.min() < 0 else 2 * values - 1  # files without negative numbers hold (n + 1) / 2


def _write(tile: Tile, target: Path) -> Json:
    from voldetail.image import save_image
    from voldetail.report.facts import duration

    save_image(target, tile.tile)
    costs = tile.costs
    output().print(
        f"{target}  {tile.tile.shape[1]} x {tile.tile.shape[0]} pixels, sigma {tile.sigma:.3g}: stationarity"
        f" {costs.stationarity:.3g}, texture {costs.texture:.3g}, {duration(tile.seconds)}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    if tile.sentence:
        remarks().print(tile.sentence, markup=False, soft_wrap=True)
    return {
        "file": str(target), "columns": tile.tile.shape[1], "rows": tile.tile.shape[0], "sigma": tile.sigma,
        "stationarity": costs.stationarity, "texture": costs.texture, "seconds": tile.seconds,
    }  # fmt: skip


def _write_map(tile: Tile, values: NDArray[np.float32], target: Path, normals: bool) -> None:
    """Write a map's tile with the numbers as they were stored: no sRGB curve comes between."""
    from voldetail.image import save_image, to_linear
    from voldetail.stationary.patchmatch_vote import carry

    found = carry(tile.correspondence, values, normals=normals)
    if target.suffix.lower() != ".exr":
        found = to_linear((found + 1) / 2 if normals else found)
    save_image(target, found)
    output().print(f"{target}  the map's tile", markup=False, soft_wrap=True)


def _teller(view: ProgressView) -> Callable[[int, int, TileProgress], None]:
    """Return what shows how far a tile is, of how many, with the time left: always on a terminal, else now and then."""
    from voldetail.cli.progress import LINE_SECONDS
    from voldetail.report.facts import duration

    last = view.clock()

    def tell(number: int, count: int, progress: TileProgress) -> None:
        nonlocal last
        if view.live is None and view.clock() - last < LINE_SECONDS:
            return
        last = view.clock()
        one = progress.seconds + progress.seconds_left
        left = progress.seconds_left + (count - number - 1) * one
        which = f"tile {number + 1} of {count}: " if count > 1 else ""
        at = f"{progress.done} of {progress.planned} rounds, at {progress.side} pixels"
        view.step(f"{which}{at}, about {duration(left)} left")

    return tell
