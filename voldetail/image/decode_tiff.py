"""Stored values of floating-point TIFF files, which Pillow does not read in colour."""

import zlib
from pathlib import Path

import numpy as np
import tifffile

from voldetail.errors import InputError
from voldetail.image.samples import Samples, check_pixels

MAGICS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_ORIENTATION_TAG = 274
# TIFF 6.0 and its technical notes. The other compressions need codecs that are no dependency of ours.
_STORED, _DEFLATE = (1,), (8, 32946)
_GREY, _RGB = 1, 2


def decode_float_tiff(path: Path, what: str) -> Samples | None:
    """Decode the first page of a TIFF of half, float or double values; None if its values are not floating-point."""
    with tifffile.TiffFile(path) as tiff:
        page = tiff.pages.first
        if page.dtype is None or page.dtype.kind != "f":
            return None
        width, height, channels = int(page.imagewidth), int(page.imagelength), int(page.samplesperpixel)
        check_pixels(width, height, what, path)
        if int(page.imagedepth) != 1 or channels > 4 or int(page.photometric) not in (_GREY, _RGB):
            raise InputError(f"The {what} {path} is a TIFF of {channels} channels that are not grey or RGB; save it so.")
        if int(page.compression) not in _STORED + _DEFLATE:
            raise InputError(
                f"The {what} {path} is a floating-point TIFF compressed by a method that is not read; save it "
                "uncompressed, with Deflate, or as OpenEXR."
            )
        if int(page.compression) in _DEFLATE:
            _check_deflate(tiff, page, width * height, channels * page.dtype.itemsize, what, path)
        orientation = page.tags.valueof(_ORIENTATION_TAG, 1)
        values = page.asarray()
        count = len(tiff.pages)
    if values.ndim == 3 and values.shape[0] == channels and values.shape != (height, width, channels):
        values = np.moveaxis(values, 0, -1)  # one plane a channel
    values = values.reshape(height, width, channels).astype(np.float32)
    notes = (f"the first of {count} pages used",) if count > 1 else ()
    colour = values[..., :3] if channels >= 3 else values[..., 0]
    alpha = values[..., -1] if channels in (2, 4) else None
    return Samples(colour, alpha, int(orientation), notes)


def _check_deflate(
    tiff: tifffile.TiffFile, page: tifffile.TiffPage, pixels: int, bytes_a_pixel: int, what: str, path: Path
) -> None:
    """Refuse a page of which a strip or tile unpacks to more than it can hold: tifffile would unpack all of it."""
    held = int(page.tilewidth) * int(page.tilelength) if page.is_tiled else pixels
    if held > 4 * pixels + 2**20:
        raise InputError(f"The {what} {path} has tiles far larger than the picture; save it again.")
    for offset, count in zip(page.dataoffsets, page.databytecounts, strict=True):
        tiff.filehandle.seek(offset)
        unpacker = zlib.decompressobj()
        unpacker.decompress(tiff.filehandle.read(count), held * bytes_a_pixel + 1)
        if not unpacker.eof:
            raise InputError(f"The {what} {path} is damaged: a strip is cut short or unpacks to too much; save it again.")
