"""Files in and out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from voldetail import detail as details
from voldetail import image
from voldetail.detail import Detail
from voldetail.detail.photo_relief import AnyDetail
from voldetail.errors import InputError
from voldetail.geometry import meshes
from voldetail.geometry.meshes import Mesh
from voldetail.image import MaskLike, Photo, PhotoLike, load_masked
from voldetail.image.load import Encoding
from voldetail.recover.files import load_any
from voldetail.setup import file as setup_files
from voldetail.setup.setup import Setup

ENCODINGS = get_args(Encoding)


def load_photo(photo: PhotoLike, mask: MaskLike | None = None, *, encoding: Encoding = "auto") -> Photo:
    """Return a photo as linear light, with what is used of it.

    photo: a file, "skimage:gravel" (":grass", ":brick"), or an array (H, W, 3) or (H, W): floats are linear, uint8 and uint16
    sRGB, unless ``encoding`` ("auto", "srgb", "linear") says otherwise. mask: a file whose white is used, or an array (H, W).

    >>> load_photo("skimage:brick").pixels.shape
    (512, 512, 3)

    Raises InputError for what is no photo or mask.
    """
    if encoding not in ENCODINGS:
        raise InputError(f"There is no encoding {encoding!r}; use one of {', '.join(ENCODINGS)}.")
    return load_masked(photo, mask, encoding=encoding)


def save_image(path: str | Path, linear: NDArray[np.floating]) -> None:
    """Save a linear picture (H, W) or (H, W, 3) of floats: .png and .jpg as sRGB of 8 bits, .exr as it is.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_image(f"{folder}/grey.png", np.full((32, 32), 0.5))
    ...     float(load_photo(f"{folder}/grey.png").pixels.mean().round(2))
    0.5

    Raises InputError for another suffix, whole numbers (they would be taken for light) and another shape.
    """
    pixels = np.asarray(linear)
    if pixels.dtype.kind != "f":
        raise InputError(f"The picture for {path} is an array of {pixels.dtype}; give linear light as floats, 1 is white.")
    if pixels.ndim not in (2, 3) or (pixels.ndim == 3 and pixels.shape[2] != 3) or not pixels.size:
        raise InputError(f"The picture for {path} has the shape {pixels.shape}; give (H, W) or (H, W, 3).")
    image.save_image(path, pixels)


def load_detail(path: str | Path) -> AnyDetail:
    """Return the detail in a file, or the photo's relief in a `relief.json` or its folder.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_detail(f"{folder}/one.json", Detail(name="one"))
    ...     load_detail(f"{folder}/one.json").name
    'one'

    Raises InputError for a file that is missing or no detail.
    """
    return load_any(path)


def save_detail(path: str | Path, detail: Detail) -> None:
    """Write a detail to a file, whole or not at all; `load_detail` reads it."""
    details.save_detail(path, detail)


def load_setup(path: str | Path, overrides: Sequence[str] = ()) -> Setup:
    """Return the setup in a scene file (.toml), changed by ``overrides`` of the form "key.sub=value".

    Raises InputError for a file that is missing, and for what is no setting.
    """
    return setup_files.load_setup(path, overrides)


def load_mesh(path: str | Path) -> Mesh:
    """Return the mesh in a file, welded, turned outwards, with smooth normals; its ``notes`` say what was mended.

    Raises InputError for a file that is no mesh.
    """
    return meshes.load_mesh(path)
