"""The photo's own relief."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from voldetail.api.inputs import LightLike, as_light
from voldetail.detail.photo_relief import MappedDetail
from voldetail.errors import InputError
from voldetail.image import MaskLike, PhotoLike, load_masked
from voldetail.image.load import Encoding
from voldetail.recover import files
from voldetail.recover import recovery as recovering
from voldetail.recover.recovery import Recovery
from voldetail.recover.slopes import Method
from voldetail.recover.tile import tile_of

METHODS = get_args(Method)


def recover(
    photo: PhotoLike,
    light: LightLike,
    *,
    mask: MaskLike | None = None,
    zone: tuple[int, int, int, int] | None = None,
    size: int | None = 1024,
    encoding: Encoding = "auto",
    method: Method = "network",
    seed: int = 0,
) -> Recovery:
    """Return height, normals, albedo and roughness of every pixel of a photo of something flat, seen head-on.

    photo, mask: as for `load_photo`; light: as for `fit`, but for "auto". zone: x, y, width, height in pixels. size: the longest
    side of the maps, None for the photo's own. method: "network" or "linear". The `detail` of the answer renders on any shape.

    >>> found = recover("skimage:gravel", "70,50", zone=(0, 0, 128, 128))
    >>> found.height.shape, found.normal.shape, found.albedo.shape, found.roughness.shape
    ((128, 128), (128, 128, 3), (128, 128, 3), (128, 128))

    Raises InputError for input that cannot be used.
    """
    if method not in METHODS:
        raise InputError(f"There is no method {method!r}; use one of {', '.join(METHODS)}.")
    name = Path(photo).name if isinstance(photo, str | Path) else "array"
    loaded = load_masked(photo, mask, encoding=encoding)
    return recovering.recover(loaded, as_light(light), zone=zone, size=size, method=method, name=name, seed=seed)


def tile(relief: Recovery, side: int, *, seed: int = 0) -> MappedDetail:
    """Return a recovered relief as a tile of ``side`` pixels whose opposite edges meet, in all its maps.

    >>> found = recover("skimage:gravel", "70,50", zone=(0, 0, 128, 128))
    >>> tile(found, 64).record.periodic
    True

    Raises InputError for a side that the photo does not hold.
    """
    return tile_of(relief, side, seed=seed)


def save_relief(folder: str | Path, detail: MappedDetail) -> MappedDetail:
    """Write `relief.json` and its maps into ``folder``, which is made if it is not there; `load_detail` reads them.

    Raises InputError where nothing can be written.
    """
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"Cannot make the folder {place}: {error.strerror or error}; give another.") from error
    return files.save_relief(place, detail)
