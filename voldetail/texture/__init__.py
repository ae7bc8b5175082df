"""Colour textures by example: analysed from one photo, evaluated at any point, edited and morphed."""

from voldetail.texture.analysis import analyse
from voldetail.texture.curve import CURVE_PROBABILITIES
from voldetail.texture.picture import picture
from voldetail.texture.synthesis import colour_at

__all__ = ["CURVE_PROBABILITIES", "analyse", "colour_at", "picture"]
