"""The photographs of the benchmark of stationary tiles, and which of them may be shown."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import skimage
from numpy.typing import NDArray

from tests.benchmarks.relit import SHARED
from voldetail.image import load_photo, resize

LONGEST = 1024
"""Pixels: larger photographs are shrunk to this, as one does before a texture of 256 pixels is made of them."""


@dataclass(frozen=True)
class Photograph:
    """A photograph in the test data; `credit` if its licence lets a sheet show it; `fails`, why it is expected to."""

    name: str
    path: str
    credit: str = ""
    fails: str = ""


SKIMAGE, POLY, DUION, PETRY = (
    "CC0, scikit-image", "CC0, Poly Haven and ambientCG", "CC-BY 3.0, Christian Femmer aka Duion", "MIT, Christian Petry",
)  # fmt: skip

DOTS = "gravel_with_dots"
"""Gravel with a few small red dots painted on it: what MJHRW17 name as too small for their measures to see."""

SHOWN = (
    Photograph("stone_slab", "photos/nmo_stone_slab/photo.jpg", PETRY),
    Photograph("rock_plants", "photos/duion_rock_rough_plants_01/photo.jpg", DUION),
    Photograph("rock_weathered", "photos/duion_rock_rough_weathered_01/photo.jpg", DUION),
    Photograph("pebble_wall", "multilight/nmo_pebble_wall_4light/left.jpg", PETRY),
    Photograph("gravel", "photos/skimage_gravel/gravel.png", SKIMAGE),
    Photograph("grass", "photos/skimage_grass/grass.png", SKIMAGE),
    Photograph("moon", "photos/skimage_moon/moon.png", "public domain, NASA"),
    Photograph("bark014", "pbr/ambientCG_Bark014/albedo.jpg", POLY),
    Photograph("rock058", "pbr/ambientCG_Rock058/albedo.jpg", POLY),
    Photograph("gray_rocks", "pbr/polyhaven_gray_rocks/albedo.jpg", POLY),
    Photograph("grave_stone", "pbr/polyhaven_grave_stone/albedo.jpg", POLY),
    Photograph("sand", "pbr/cc0textures_sand/albedo.jpg", POLY),
    Photograph("brick", "photos/skimage_brick/brick.png", SKIMAGE, "man-made structure"),
    Photograph("brick_wall", "pbr/polyhaven_stone_brick_wall_001/albedo.jpg", POLY, "man-made structure"),
    Photograph("wicker", "photos/nmo_wicker/photo.jpg", PETRY, "man-made structure"),
    Photograph(DOTS, "photos/skimage_gravel/gravel.png", SKIMAGE, "tiny salient dots"),
)

MEASURED = (
    *(Photograph(name, f"photos/{name}/flash.jpg") for name in (
        "flash_test_2020", "flash_test_2029", "flash_test_2061", "flash_test_2009", "flash_test_2014", "flash_train_2062",
        "flash_train_2041", "flash_train_0253",
    )),
    *(Photograph(f"ps_{name}", f"textures/portilla_simoncelli/{name}.png") for name in ("metal", "nuts", "reptil_skin")),
    *(Photograph(f"zhou_{n}", f"textures/nonstationary_zhou2018/{n}.jpg") for n in (
        11, 182, 200, 202, 204, 205, 209, 217, 22, 222, 23, 25, 27, 34, 401, 402, 403, 407, 414, 415, 418, 419, 421, 72, 89,
    )),
)  # fmt: skip
"""The licence of these does not let them be shown; the five ns_* sets are copies from the last collection."""

PHOTOGRAPHS = SHOWN + MEASURED

SHIPPED = Path(skimage.__file__).parent / "data"
ONLY_SHOWN = (
    Photograph("clouds", "photos/clouds_kloofendal/clouds.png", POLY),
    Photograph("hubble", str(SHIPPED / "hubble_deep_field.jpg"), "public domain, NASA and ESA", "single bright galaxies"),
    Photograph("coins", str(SHIPPED / "coins.png"), "no known copyright, Brooklyn Museum", "things, and few of them"),
    Photograph("tissue", str(SHIPPED / "ihc.png"), "CC0, Human Protein Atlas and scikit-image"),
)
"""More that may be shown, drawn where they are named; the figures' numbers are of PHOTOGRAPHS alone."""


def there(size: int) -> list[Photograph]:
    """The photographs that can be read here and are large enough for a tile of `size`."""
    found = [p for p in PHOTOGRAPHS if (SHARED / p.path).exists()]
    return [p for p in found if min(pixels(p).shape[:2]) >= size]


def pixels(photograph: Photograph, folder: Path = SHARED) -> NDArray[np.float32]:
    """A photograph (H, W, 3), linear, at most LONGEST pixels long."""
    picture = load_photo(folder / photograph.path).pixels
    height, width = picture.shape[:2]
    if max(height, width) > LONGEST:
        scale = LONGEST / max(height, width)
        picture = resize(picture, (round(height * scale), round(width * scale)))
    return _dotted(picture) if photograph.name == DOTS else picture


def _dotted(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The picture with 40 red dots of 5 pixels."""
    out = picture.copy()
    y, x = np.mgrid[-2:3, -2:3]
    dot = y**2 + x**2 <= 5
    rng = np.random.default_rng(0)
    for row, column in rng.integers(8, np.array(picture.shape[:2]) - 8, (40, 2)):
        out[row - 2 : row + 3, column - 2 : column + 3][dot] = (0.5, 0.02, 0.02)
    return out
