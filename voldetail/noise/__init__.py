"""Cellular-Gabor noise (GD10 eq. 2 and 3) on any Dr.Jit array type; nothing here imports Mitsuba."""

from voldetail.noise.cells import cell_value, number_of, specks
from voldetail.noise.curve import evaluate_curve
from voldetail.noise.gabor import KERNEL_RADIUS, NoiseSettings, single_octave
from voldetail.noise.lattice import cell_hash, feature_point, nearest_points, search_table
from voldetail.noise.moments import moments
from voldetail.noise.plates import PlateShape, plate_numbers
from voldetail.noise.relief import OCTAVE_NUMBERS, relief_function
from voldetail.noise.stones import StoneShape

__all__ = [
    "KERNEL_RADIUS",
    "OCTAVE_NUMBERS",
    "NoiseSettings",
    "PlateShape",
    "StoneShape",
    "cell_hash",
    "cell_value",
    "evaluate_curve",
    "feature_point",
    "moments",
    "nearest_points",
    "number_of",
    "plate_numbers",
    "relief_function",
    "search_table",
    "single_octave",
    "specks",
]
