"""Fitting, with every setting as a keyword."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal

from voldetail import fit as fitting
from voldetail.api.inputs import LightLike, as_light
from voldetail.errors import InputError
from voldetail.fit import Progress
from voldetail.image import MaskLike, Photo, PhotoLike, as_photo, with_mask
from voldetail.results import FitResult
from voldetail.setup.camera import CameraSetup
from voldetail.setup.file import setup_from
from voldetail.setup.fit_settings import FitSettings
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.setup import Setup
from voldetail.setup.shapes import named_shape

IN_MEMORY = "array"
"""The name of a photo that is not a file."""


def fit(
    photo: PhotoLike | Setup,
    light: LightLike | None = None,
    *,
    mask: MaskLike | None = None,
    zone: tuple[int, int, int, int] | None = None,
    resolution: int = 192,
    encoding: Literal["auto", "srgb", "linear"] = "auto",
    stationarize: bool = False,
    proxy: ProxySetup | Mapping[str, object] | str = "plane",
    camera: CameraSetup | Mapping[str, object] | None = None,
    amplitude: float | None = None,
    domain: Literal["solid", "surface"] = "solid",
    mode: Literal["displacement", "volume"] = "displacement",
    look: Literal["surface", "medium"] = "surface",
    colour: Literal["auto", "by-example", "height", "cell", "none"] = "auto",
    fit: FitSettings | Mapping[str, object] | None = None,
    seed: int = 0,
    on_progress: Callable[[Progress], None] = lambda progress: None,
) -> FitResult:
    """Return what the search finds for a photo under a light, or for a whole Setup (then nothing else is given).

    photo, mask: as for `load_photo`. light: a text as on the command line ("AZ,EL" in degrees, "x,y,z", "flash",
    "point:x,y,z", "auto" to have it estimated), numbers, or a Light. zone: x, y, width, height in pixels. proxy: a kind of
    shape, or a record with size and place. fit: {"evaluations": 500, "library": "none"} and so on, see FitSettings. The others
    are those of a Setup. ``on_progress`` is called as it goes; Ctrl-C ends the search with the best so far.

    >>> small = {"zone": (0, 0, 96, 96), "resolution": 64, "fit": {"evaluations": 8}, "colour": "none"}
    >>> result = fit("skimage:grass", (140.0, 55.0), **small)
    >>> result.picture.shape, result.distance > 0
    ((64, 64), True)

    Raises InputError for input that cannot be used.
    """
    if isinstance(photo, Setup):
        return fitting.fit(photo, on_progress=on_progress)
    if light is None:
        raise InputError('A light is needed: "AZ,EL" in degrees, "x,y,z", "flash", "point:x,y,z" or "auto".')
    named = isinstance(photo, str | Path)
    in_memory = not named or not (mask is None or isinstance(mask, str | Path))
    setup = setup_from(
        {
            "photo": {
                "path": os.fspath(photo) if isinstance(photo, str | Path) else IN_MEMORY, "zone": zone,
                "resolution": resolution, "encoding": encoding, "stationarize": stationarize,
            },
            "mask": None if mask is None or in_memory else os.fspath(mask),  # type: ignore[arg-type]
            "light": as_light(light), "proxy": _proxy(proxy), "camera": camera or {}, "amplitude": amplitude,
            "domain": domain, "mode": mode, "look": look, "colour": colour, "fit": fit or {}, "seed": seed,
        },
        "The call of fit",
    )  # fmt: skip
    given: Photo | None = with_mask(as_photo(photo, encoding=encoding), mask) if in_memory else None
    return fitting.fit(setup, photo=given, on_progress=on_progress)


def _proxy(proxy: ProxySetup | Mapping[str, object] | str) -> ProxySetup | Mapping[str, object]:
    if not isinstance(proxy, str):
        return proxy
    return named_shape(proxy) or {"kind": proxy}  # refused there, with the kinds that are known
