"""Colour textures by example: analysed from one photo, evaluated at any point, edited and morphed."""

from voldetail.detail.texture_file import load_example, load_texture, save_texture
from voldetail.texture.analysis import analyse
from voldetail.texture.curve import CURVE_PROBABILITIES
from voldetail.texture.edit import band_count, edit, morph
from voldetail.texture.picture import picture
from voldetail.texture.synthesis import colour_at

__all__ = [
    "CURVE_PROBABILITIES",
    "analyse",
    "band_count",
    "colour_at",
    "edit",
    "load_example",
    "load_texture",
    "morph",
    "picture",
    "save_texture",
]
