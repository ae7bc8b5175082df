"""The noise models of GKHF14 section 6: perlin, turbulence, turbulenceridge (Perlin 1985).

All have a size and an anisotropic stretch along x, as the paper says; its contrast control is a smooth curve here, so that
nothing is cut off at 0 and 1.
"""

from __future__ import annotations

from typing import Any

from voldetail.texture.structures.arrays import clip, functions
from voldetail.texture.structures.model import StructureModel, StructureParameter, Values
from voldetail.texture.structures.noise import ABSOLUTE_MEAN, DEVIATION, gradient_noise, octaves, turbulence

P = StructureParameter

LARGEST = 48.0
"""Texels: five of the largest cells a side of the 256 that the paper's pictures have."""


def _perlin(x: Any, y: Any, values: Values, seed: int) -> Any:
    """s = (1 + tanh(c n / deviation)) / 2, one octave."""
    n = gradient_noise(x / (values["size"] * values["stretch"]), y / values["size"], seed)
    return 0.5 + 0.5 * functions(x).tanh(values["contrast"] / DEVIATION * n)


def _turbulence(x: Any, y: Any, values: Values, seed: int) -> Any:
    """s = t^p with t the turbulence, three times its mean being 1; p < 1 brighter, p > 1 darker with bright peaks."""
    f = functions(x)
    t = clip(turbulence(x, y, values["size"], seed, values["stretch"]) / (3.0 * ABSOLUTE_MEAN), 1e-6, 1.0)
    # A power of an array, written so that both kinds of array have it.
    return f.maximum(t, 0.0) ** values["power"]


def _ridge(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Octaves of exp(-k |n|), the ridges along which gradient noise changes sign; k their sharpness."""
    f = functions(x)
    return octaves(x, y, values["size"], seed, lambda n: f.exp(-values["sharpness"] * f.maximum(n, -n)), values["stretch"])


PERLIN = StructureModel(
    "perlin", "noise",
    (
        P("size", 2.5, LARGEST, 16.0, "log", 101, "Texels a cell of the noise; a wave is about two cells."),
        P("stretch", 1.0, 6.0, 1.0, "log", 11, "How many times longer cells are along x than across."),
        P("contrast", 0.25, 5.0, 0.7, "log", 11, "Deviations' share of the range; large ones leave two tones only."),
    ),
    "Smooth blotches of one size.", _perlin,
)  # fmt: skip

TURBULENCE = StructureModel(
    "turbulence", "noise",
    (
        P("size", 3.0, LARGEST, 24.0, "log", 101, "Texels a cell of the coarsest octave."),
        P("stretch", 1.0, 6.0, 1.0, "log", 21, "How many times longer cells are along x than across."),
        P("power", 0.3, 4.0, 1.0, "log", 11, "Power of the turbulence: above 1 darker with few bright spots."),
    ),
    "Billows of many sizes, with dark creases.", _turbulence,
)  # fmt: skip

TURBULENCE_RIDGE = StructureModel(
    "turbulenceridge", "noise",
    (
        P("size", 6.0, LARGEST, 24.0, "log", 21, "Texels a cell of the coarsest octave."),
        P("stretch", 1.0, 6.0, 1.0, "log", 21, "How many times longer cells are along x than across."),
        P("sharpness", 2.0, 24.0, 8.0, "log", 11, "How thin and how bright beside the rest the ridges are."),
    ),
    "Bright veins of many sizes.", _ridge,
)  # fmt: skip
