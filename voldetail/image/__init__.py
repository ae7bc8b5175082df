"""Pictures: read, saved, resampled; linear float32 inside, sRGB only here."""

from voldetail.image.load import MIN_SIDE, Photo, load_photo
from voldetail.image.mask import load_mask
from voldetail.image.photograph import MaskLike, PhotoLike, as_photo, load_masked, used_of, with_mask
from voldetail.image.pyramid import gaussian_pyramid, masked_pyramid
from voldetail.image.resize import resize, resize_mask
from voldetail.image.samples import MAX_PIXELS
from voldetail.image.save import check_suffix, save_exr, save_image, save_jpeg, save_png
from voldetail.image.srgb import luminance, to_linear, to_srgb

__all__ = [
    "MAX_PIXELS",
    "MIN_SIDE",
    "MaskLike",
    "Photo",
    "PhotoLike",
    "as_photo",
    "check_suffix",
    "gaussian_pyramid",
    "load_mask",
    "load_masked",
    "load_photo",
    "luminance",
    "masked_pyramid",
    "resize",
    "resize_mask",
    "save_exr",
    "save_image",
    "save_jpeg",
    "save_png",
    "to_linear",
    "to_srgb",
    "used_of",
    "with_mask",
]
