"""Stored values of everyday picture files, all bits of them."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms

from voldetail.errors import InputError
from voldetail.image.samples import Samples, check_pixels

# Only formats whose decoders run inside the library: no PostScript, nothing that starts a program.
FORMATS = ("PNG", "JPEG", "TIFF", "WEBP", "AVIF", "BMP", "PPM", "GIF")
_ORIENTATION_TAG = 0x0112
_LOW_BYTE_ORDER = {"B": "L", "L": "B", "N": "B" if sys.byteorder == "little" else "L"}
_COLOURLESS = ("1", "L", "LA", "La", "I;16", "I;16B", "I;16L", "I;16N", "I", "F")


def decode_pillow(path: Path, what: str) -> Samples:
    """Decode the first frame of a picture file, 8 or 16 bits a channel, its size checked before any pixel is."""
    with _open(path) as picture:
        check_pixels(*picture.size, what, path)
        if picture.format == "TIFF":  # Pillow turns TIFFs (and nothing else) itself while it decodes
            turned = 2 <= _orientation(picture) <= 8
            notes = ["rotated by EXIF"] if turned else []
        else:
            turned, notes = False, []
        rawmode = _rawmode(picture)
        frames = int(getattr(picture, "n_frames", 1))
        if frames > 1 and picture.format != "MPO":  # MPO: a JPEG followed by its preview or depth map
            notes.append(f"the first of {frames} frames used")
        if ";16" in rawmode and not picture.mode.startswith("I"):
            values, alpha = _sixteen_bits(path, picture, rawmode, what)
        else:
            picture.load()
            values, alpha = _pixels(picture, what, path, notes)
        return Samples(values, alpha, 1 if turned else _orientation(picture), tuple(notes + _profile(picture)))


@contextmanager
def _open(path: Path) -> Iterator[Image.Image]:
    # A stream and not the name: by name, Pillow maps uncompressed TIFFs into memory and garbles those on
    # their side.
    with open(path, "rb") as stream, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a large picture is our own check's affair, odd metadata nobody's
        with Image.open(stream, formats=FORMATS) as picture:
            yield picture


def _rawmode(picture: Any) -> str:
    """Return how Pillow will unpack the file's samples: "RGB", "RGB;16B", ..."""
    arguments = picture.tile[0].args if getattr(picture, "tile", None) else ""
    first = arguments[0] if isinstance(arguments, tuple) and arguments else arguments
    return first if isinstance(first, str) else ""


def _sixteen_bits(path: Path, high: Any, rawmode: str, what: str) -> tuple[NDArray[np.uint16], NDArray[np.float32] | None]:
    """Decode 16-bit colour, which Pillow cuts to its high bytes: decode twice, the second time for the low bytes.

    Naming the other byte order to the unpacker makes it keep the other byte. Grey with alpha has no such
    twin, but its four bytes a pixel pass as RGBA.
    """
    if rawmode == "LA;16B":
        high.tile = [tile._replace(args="RGBA") for tile in high.tile]
        high.load()
        pairs = np.asarray(high).astype(np.uint16)
        both = (pairs[..., 0::2] << 8 | pairs[..., 1::2]).astype(np.uint16)
        return both[..., 0], both[..., 1].astype(np.float32) / np.float32(65535)
    mode, order = rawmode.split(";16")
    if mode not in ("RGB", "RGBA") or order not in _LOW_BYTE_ORDER:
        raise InputError(f"The {what} {path} stores 16-bit samples as {rawmode}, which is not read; save it as RGB.")
    other = f"{mode};16{_LOW_BYTE_ORDER[order]}"
    with _open(path) as low:
        low_any: Any = low
        low_any.tile = [tile._replace(args=_with_rawmode(tile.args, other)) for tile in low_any.tile]
        low.load()
        high.load()
        both = (np.asarray(high).astype(np.uint16) << 8 | np.asarray(low)).astype(np.uint16)
    alpha = both[..., 3].astype(np.float32) / np.float32(65535) if both.shape[2] == 4 else None
    return both[..., :3], alpha


def _with_rawmode(arguments: Any, rawmode: str) -> Any:
    return (rawmode, *arguments[1:]) if isinstance(arguments, tuple) else rawmode


def _pixels(picture: Image.Image, what: str, path: Path, notes: list[str]) -> tuple[NDArray[Any], NDArray[np.float32] | None]:
    mode = picture.mode
    transparent = "transparency" in picture.info or mode in ("LA", "La", "PA", "RGBA", "RGBa")
    if mode in ("P", "PA"):
        notes.append("palette expanded")
    elif mode == "CMYK":
        notes.append("converted from CMYK without its colour profile")
        transparent = False
    elif mode in ("I", "F") or mode.startswith("I;16"):
        return _deep_grey(np.asarray(picture), what, path), None
    elif mode not in ("1", "L", "LA", "La", "RGB", "RGBA", "RGBa", "RGBX", "YCbCr"):
        raise InputError(f"The {what} {path} is in the colour space {mode}, which is not read; save it as RGB.")
    grey = mode in _COLOURLESS
    if transparent:
        pixels = np.asarray(picture.convert("RGBA"))
        alpha = pixels[..., 3].astype(np.float32) / np.float32(255)
        return (pixels[..., 0] if grey else pixels[..., :3]), alpha
    return np.asarray(picture.convert("L" if grey else "RGB")), None


def _deep_grey(values: NDArray[Any], what: str, path: Path) -> NDArray[Any]:
    if values.dtype.kind == "f":
        return values.astype(np.float32)
    if values.min() < 0 or values.max() > 65535:
        raise InputError(f"The {what} {path} has samples of more than 16 bits; save it with 8 or 16, or as OpenEXR.")
    return values.astype(np.uint16)


def _orientation(picture: Image.Image) -> int:
    try:
        return int(picture.getexif().get(_ORIENTATION_TAG, 1))
    except Exception:
        return 1


def _profile(picture: Image.Image) -> list[str]:
    """Note a colour profile other than sRGB: the pixels are read as sRGB all the same."""
    profile = picture.info.get("icc_profile")
    if not profile:
        return []
    try:
        name = ImageCms.getProfileDescription(ImageCms.ImageCmsProfile(BytesIO(profile))).strip()
    except Exception:
        name = "unreadable"
    return [] if "srgb" in name.lower() else [f"colour profile ignored ({name[:60]}), read as sRGB"]
