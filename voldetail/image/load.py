"""Photographs and masks from files that may hold anything."""

import logging
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.files import readable, sha256
from voldetail.image.decode_exr import MAGIC as EXR_MAGIC
from voldetail.image.decode_exr import decode_exr
from voldetail.image.decode_pillow import decode_pillow
from voldetail.image.decode_tiff import MAGICS as TIFF_MAGICS
from voldetail.image.decode_tiff import decode_float_tiff
from voldetail.image.samples import Samples, upright
from voldetail.image.srgb import to_linear
from voldetail.records.examples import picture_path

Encoding = Literal["auto", "srgb", "linear"]

MIN_SIDE = 32  # pixels: the largest window of the metric must fit into the photo
MAX_BYTES = 2**31  # of a file: 100 megapixels of RGB floats with alpha are 1.6 GB
_RADIANCE_MAGIC = b"#?"
_READ = "PNG, JPEG, TIFF, WebP, AVIF, BMP, PPM, GIF and OpenEXR"


@dataclass(frozen=True, eq=False)
class Photo:
    """A photograph as linear light.

    `pixels` (H, W, 3) float32, row 0 on top, 1 = the file's white, never negative, NaN or infinite; `sha256`
    of the file; `notes`, what was changed in reading it; `opaque` (H, W) bool, False where the file is fully
    transparent and so says nothing, or None if all of it is to be used.
    """

    pixels: NDArray[np.float32]
    sha256: str
    notes: tuple[str, ...] = field(default=())
    opaque: NDArray[np.bool_] | None = None


def load_photo(path: str | Path, *, encoding: Encoding = "auto") -> Photo:
    """Read a photograph: PNG, JPEG, TIFF, WebP, AVIF, BMP, PPM, GIF or OpenEXR, recognised by content.

    `path` may also name one that scikit-image ships: "skimage:gravel", ":grass", ":brick".

    `encoding` says what the numbers mean: "srgb", "linear", or "auto", by which integers are sRGB and
    floating-point numbers linear. Grey becomes three equal channels, CMYK and palettes RGB; alpha is dropped
    and EXIF's rotation applied. Raises InputError for anything that is not a photograph of 32 x 32 pixels to
    100 megapixels.
    """
    path = readable(picture_path(path), "photo", MAX_BYTES)
    samples = _decode(path, "photo")
    height, width = samples.values.shape[:2]
    if min(height, width) < MIN_SIDE:
        raise InputError(
            f"The photo {path} has {width} x {height} pixels; at least {MIN_SIDE} a side are needed, so give a larger photo."
        )
    notes = list(samples.notes)
    pixels = _linear(_finite(samples.values, path, "photo"), encoding)
    if pixels.size and pixels.min() < 0:
        notes.append(f"{np.count_nonzero(pixels < 0)} negative values set to 0")
        pixels = np.maximum(pixels, 0)
    opaque = None
    if samples.alpha is not None:
        notes.append("alpha dropped")
        opaque = samples.alpha > 0  # also False for NaN
        hidden = opaque.size - int(np.count_nonzero(opaque))
        if hidden == opaque.size:
            raise InputError(f"The photo {path} is fully transparent; save it without alpha.")
        if hidden:
            notes.append(f"{hidden} fully transparent pixels not used")
        opaque = np.ascontiguousarray(opaque) if hidden else None
    if pixels.ndim == 2:
        notes.append("grey")
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    return Photo(np.ascontiguousarray(pixels), sha256(path), tuple(notes), opaque)


def load_samples(path: str | Path, what: str) -> Samples:
    """Read a picture file's stored values as numbers of 0 to 1 (integers over their largest), upright, no NaN."""
    path = readable(path, what, MAX_BYTES)
    samples = _decode(path, what)
    values = _linear(_finite(samples.values, path, what), "linear")
    return Samples(values, samples.alpha, 1, samples.notes)


def _decode(path: Path, what: str) -> Samples:
    """Pick the decoder by content, and turn whatever it stumbles over into one sentence."""
    with open(path, "rb") as stream:
        start = stream.read(16)
    if start.startswith(_RADIANCE_MAGIC):
        raise InputError(f"The {what} {path} is a Radiance picture, which is not read; save it as OpenEXR.")
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)  # its complaints about odd tags are not for our user
    try:
        if start.startswith(EXR_MAGIC):
            samples = decode_exr(path, what)
        else:
            floating = decode_float_tiff(path, what) if start.startswith(TIFF_MAGICS) else None
            samples = floating or decode_pillow(path, what)
    except InputError:
        raise
    except Exception as error:  # the decoders raise nearly every kind of exception on damaged files
        raise _unreadable(path, what, error) from error
    if samples.orientation == 1:
        return samples
    alpha = None if samples.alpha is None else upright(samples.alpha, samples.orientation)
    notes = (*samples.notes, "rotated by EXIF") if 2 <= samples.orientation <= 8 else samples.notes
    return Samples(upright(samples.values, samples.orientation), alpha, 1, notes)


def _unreadable(path: Path, what: str, error: Exception) -> InputError:
    name = type(error).__name__
    if name == "DecompressionBombError":
        return InputError(f"The {what} {path} has more than the 100 megapixels allowed; crop or shrink it.")
    if name == "UnidentifiedImageError":
        return InputError(f"The {what} {path} is not a picture in a format that is read ({_READ}), or it is damaged.")
    reason = " ".join(str(error).split())[:160] or name
    return InputError(f"The {what} {path} is damaged or cut short ({reason}); save or copy it again.")


def _finite(values: NDArray[Any], path: Path, what: str) -> NDArray[Any]:
    if values.dtype.kind != "f":
        return values
    wrong = ~np.isfinite(values)
    if wrong.any():
        pixels = wrong if wrong.ndim == 2 else wrong.any(axis=2)
        row, column = (int(i) for i in np.unravel_index(np.argmax(pixels), pixels.shape))
        raise InputError(
            f"The {what} {path} has {np.count_nonzero(pixels)} pixels that are NaN or infinite, the first in column "
            f"{column} of row {row}; repair them and save it again."
        )
    return values


def _linear(values: NDArray[Any], encoding: Encoding) -> NDArray[np.float32]:
    if values.dtype.kind == "f":
        return to_linear(values) if encoding == "srgb" else values.astype(np.float32)
    largest = np.iinfo(values.dtype).max
    table = np.arange(largest + 1, dtype=np.float64) / largest
    linear = table.astype(np.float32) if encoding == "linear" else to_linear(table)
    return np.asarray(linear[values])
