"""The colour photographs of the benchmark `colour_photographs`: where they are, how they are cut, what may be shown.

Photographs are read from ../shared/data, or from scikit-image, which ships them. Large ones are reduced, so that a crop holds
what makes the texture, and cut into disjoint crops around the middle of a region: the first is the example.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from skimage import data as skimage_data

from tests.benchmarks.relit import SHARED
from voldetail.image import load_photo, resize, to_linear

Picture = NDArray[np.float32]
Kind = Literal["stochastic", "structured"]

FLASH = "none stated (research release)"
WEB = "rights of the single pictures not stated (collected by Zhou et al. 2018)"


@dataclass(frozen=True)
class ColourPhoto:
    """A photograph; `region` is left, top, width and height in its own pixels, `scale` what those are reduced by.

    `kind`: "structured" ones have edges, weaves or courses that no noise has, and are shown as failures.
    """

    name: str
    path: str
    kind: Kind
    about: str
    licence: str
    shown: bool
    scale: float = 1.0
    side: int = 256
    region: tuple[int, int, int, int] | None = None


PHOTOS = (
    ColourPhoto("rock_plants", "photos/duion_rock_rough_plants_01/photo.jpg", "stochastic", "crumbly rock",
                "CC-BY 3.0, Christian Femmer aka Duion", True, 0.6),
    ColourPhoto("rock_weathered", "photos/duion_rock_rough_weathered_01/photo.jpg", "stochastic", "weathered rock, lichen",
                "CC-BY 3.0, Christian Femmer aka Duion", True, 0.6),
    ColourPhoto("stone_slab", "photos/nmo_stone_slab/photo.jpg", "stochastic", "limestone with stains",
                "MIT, Christian Petry", True, 0.6),
    ColourPhoto("sand", "pbr/cc0textures_sand/albedo.jpg", "stochastic", "sand", "CC0, cc0textures.com", True, 0.6),
    ColourPhoto("grave_stone", "pbr/polyhaven_grave_stone/albedo.jpg", "stochastic", "plastered stone",
                "CC0, Poly Haven", True, 0.6),
    ColourPhoto("star_field", "skimage:hubble_deep_field.jpg", "stochastic", "far galaxies on black",
                "public domain, NASA and ESA, scikit-image", True, 0.7),
    ColourPhoto("aggregate", "photos/flash_test_2014/flash.jpg", "stochastic", "speckled aggregate", FLASH, False, 0.8,
                region=(450, 250, 700, 700)),
    ColourPhoto("pitted_rock", "photos/flash_test_2020/flash.jpg", "stochastic", "reddish rock with pits", FLASH, False, 0.8,
                region=(450, 250, 700, 700)),
    ColourPhoto("mossy_stone", "photos/flash_test_2061/flash.jpg", "stochastic", "mossy stone", FLASH, False, 0.8,
                region=(450, 250, 700, 700)),
    ColourPhoto("sandy_lichen", "photos/flash_train_2041/flash.jpg", "stochastic", "sandy ground with lichen", FLASH, False,
                0.8, region=(450, 250, 700, 700)),
    ColourPhoto("knit", "photos/flash_train_0253/flash.jpg", "stochastic", "coarse blue knit", FLASH, False, 0.8,
                region=(290, 130, 700, 700)),
    ColourPhoto("sea_foam", "textures/nonstationary_zhou2018/222.jpg", "stochastic", "foam on the sea", WEB, False, side=192,
                region=(0, 30, 589, 412)),
    ColourPhoto("veined_rock", "pbr/ambientCG_Rock058/albedo.jpg", "structured", "marble-like: light veins on blue",
                "CC0, ambientCG", True, 0.6),
    ColourPhoto("agate", "textures/nonstationary_zhou2018/89.jpg", "structured", "marble-like: rust-coloured bands", WEB, False,
                side=192),
    ColourPhoto("gravel_leaves", "photos/ns_gravel_leaves/photo.jpg", "structured", "pebbles and leaves, each with its edge",
                WEB, False, side=192),
    ColourPhoto("grey_rocks", "pbr/polyhaven_gray_rocks/albedo.jpg", "structured", "stones, each with its edge",
                "CC0, Poly Haven", True, 0.6),
    ColourPhoto("bark", "pbr/ambientCG_Bark014/albedo.jpg", "structured", "bark: fibres along one direction",
                "CC0, ambientCG", True, 0.6),
    ColourPhoto("wood", "textures/nonstationary_zhou2018/209.jpg", "structured", "wood: grain and cracks along one direction",
                WEB, False, side=160),
    ColourPhoto("wicker", "photos/nmo_wicker/photo.jpg", "structured", "woven", "MIT, Christian Petry", True, 0.5,
                region=(0, 150, 1600, 1050)),
    ColourPhoto("brick_wall", "pbr/polyhaven_stone_brick_wall_001/albedo.jpg", "structured", "courses of hewn stone",
                "CC0, Poly Haven", True, 0.6),
)  # fmt: skip


def is_there(photo: ColourPhoto) -> bool:
    """Whether the photograph can be read here."""
    return photo.path.startswith("skimage:") or (SHARED / photo.path).exists()


def load(photo: ColourPhoto) -> Picture:
    """Return the photograph's region (H, W, 3), linear, reduced."""
    if photo.path.startswith("skimage:"):
        name = photo.path.removeprefix("skimage:").partition(".")[0]
        pixels = to_linear(getattr(skimage_data, name)() / np.float32(255))
    else:
        pixels = load_photo(SHARED / photo.path).pixels
    if photo.region is not None:
        left, top, width, height = photo.region
        pixels = pixels[top : top + height, left : left + width]
    rows, columns = (round(side * photo.scale) for side in pixels.shape[:2])
    return pixels if photo.scale == 1 else resize(pixels, (rows, columns))


def crops(picture: Picture, side: int) -> list[Picture]:
    """Return up to 2 x 2 disjoint square crops around the picture's middle, the example first."""
    rows, columns = (min(length // side, 2) for length in picture.shape[:2])
    top, left = (picture.shape[0] - rows * side) // 2, (picture.shape[1] - columns * side) // 2
    return [
        np.ascontiguousarray(picture[top + side * r : top + side * (r + 1), left + side * c : left + side * (c + 1)])
        for r in range(rows) for c in range(columns)
    ]  # fmt: skip
