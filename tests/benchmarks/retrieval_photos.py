"""The photographs of the benchmark of retrieval: which part, what they show, and whether they may be shown."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from tests.benchmarks.relit import SHARED
from voldetail.image import load_photo
from voldetail.library import Query, query
from voldetail.library.span import TRIM

SKIMAGE, POLY, DUION, PETRY = (
    "CC0, scikit-image", "CC0, Poly Haven and ambientCG", "CC-BY 3.0, Christian Femmer aka Duion", "MIT, Christian Petry",
)  # fmt: skip


@dataclass(frozen=True)
class Sought:
    """A photograph; `zone` x, y, width, height in its pixels; `credit` if its licence lets a sheet show it; `outside`: no
    model of the library is of its kind, in a few words why."""

    name: str
    path: str
    about: str
    credit: str = ""
    zone: tuple[int, int, int, int] | None = None
    outside: str = ""


SOUGHT = (
    Sought("brick", "photos/skimage_brick/brick.png", "bricks with light joints", SKIMAGE),
    Sought("wicker", "photos/nmo_wicker/photo.jpg", "woven rods", PETRY, (200, 200, 700, 700)),
    Sought("brick_wall", "pbr/polyhaven_stone_brick_wall_001/albedo.jpg", "courses of hewn stone", POLY),
    Sought("gray_rocks", "pbr/polyhaven_gray_rocks/albedo.jpg", "stones in a wall", POLY),
    Sought("pebble_wall", "multilight/nmo_pebble_wall_4light/left.jpg", "round pebbles", PETRY, (64, 0, 384, 384)),
    Sought("gravel", "photos/skimage_gravel/gravel.png", "gravel", SKIMAGE),
    Sought("grass", "photos/skimage_grass/grass.png", "grass", SKIMAGE),
    Sought("bark", "pbr/ambientCG_Bark014/albedo.jpg", "fibrous bark", POLY, (0, 0, 512, 512)),
    Sought("veined_rock", "pbr/ambientCG_Rock058/albedo.jpg", "light veins on blue rock", POLY, (0, 0, 700, 700)),
    Sought("sand", "pbr/cc0textures_sand/albedo.jpg", "sand", POLY, (0, 0, 512, 512)),
    Sought("stone_slab", "photos/nmo_stone_slab/photo.jpg", "limestone", PETRY, (400, 150, 700, 700)),
    Sought("rock_plants", "photos/duion_rock_rough_plants_01/photo.jpg", "crumbly rock", DUION, (0, 0, 600, 600)),
    Sought("clouds", "photos/clouds_kloofendal/clouds.png", "clouds", "CC0, Poly Haven", (60, 10, 340, 150)),
    Sought("star_field", "skimage:hubble_deep_field.jpg", "far galaxies", "public domain, NASA and ESA", (100, 100, 600, 600)),
    Sought("coins", "skimage:coins.png", "coins in rows", "no known restriction, Brooklyn Museum, scikit-image"),
    Sought("chessboard", "skimage:chessboard_GRAY.png", "squares", SKIMAGE),
    Sought("moon", "photos/skimage_moon/moon.png", "craters", "public domain, NASA", outside="a landscape"),
    Sought("cat", "skimage:chelsea.png", "a cat", SKIMAGE, (60, 0, 300, 300), outside="a portrait"),
    Sought("camera", "skimage:camera.png", "a man with a camera", SKIMAGE, outside="a picture of things"),
    Sought("coffee", "skimage:coffee.png", "a cup", SKIMAGE, (100, 0, 400, 400), outside="a picture of things"),
    Sought("weave", "textures/nonstationary_zhou2018/401.jpg", "woven strips of wood"),
    Sought("basket", "textures/nonstationary_zhou2018/182.jpg", "a woven basket", zone=(50, 50, 350, 350)),
    Sought("parquet", "textures/nonstationary_zhou2018/204.jpg", "herringbone parquet"),
    Sought("wood", "textures/nonstationary_zhou2018/209.jpg", "wood with cracks", zone=(80, 0, 320, 320)),
    Sought("paving", "textures/nonstationary_zhou2018/25.jpg", "square paving stones", zone=(0, 0, 350, 350)),
    Sought("stone_wall", "textures/nonstationary_zhou2018/402.jpg", "large stones with joints"),
    Sought("sky", "textures/nonstationary_zhou2018/415.jpg", "soft clouds"),
    Sought("caustics", "textures/nonstationary_zhou2018/34.jpg", "light on the bottom of water", zone=(50, 0, 450, 450)),
    Sought("cracked_ground", "photos/ns_cracked_ground/photo.jpg", "cracked ground", zone=(50, 0, 400, 400)),
    Sought("sand_ripples", "photos/ns_sand_ripples/photo.jpg", "ripples of sand", zone=(100, 0, 400, 400)),
    Sought("ridged_bark", "photos/ns_bark/photo.jpg", "bark in ridges"),
    Sought("slates", "textures/gimp_tiny/stone33.png", "slates with joints"),
    Sought("sawtooth", "textures/portilla_simoncelli/sawtooth.png", "slanting stripes"),
    Sought("checkerboard", "textures/portilla_simoncelli/checkerboard.png", "squares"),
    Sought("scales", "textures/portilla_simoncelli/reptil_skin.png", "scales of a reptile"),
    Sought("knit", "photos/flash_train_0253/flash.jpg", "coarse blue knit", zone=(290, 130, 600, 600)),
    Sought("agate", "textures/nonstationary_zhou2018/89.jpg", "rust-coloured bands", zone=(100, 0, 400, 400)),
    Sought("text", "textures/portilla_simoncelli/text.png", "print", outside="letters"),
    Sought("olives", "textures/nonstationary_zhou2018/407.jpg", "olives of three colours", outside="more than two tones"),
)
"""Textures first, those that may be shown before the others."""


def where(sought: Sought) -> Path:
    """The photograph's file."""
    if not sought.path.startswith("skimage:"):
        return SHARED / sought.path
    found = find_spec("skimage")
    assert found is not None
    assert found.origin is not None
    return Path(found.origin).parent / "data" / sought.path.removeprefix("skimage:")


def there() -> list[Sought]:
    """Those that can be read here."""
    return [sought for sought in SOUGHT if where(sought).exists()]


def ready(sought: Sought, trim: float = TRIM) -> Query:
    """The photograph as it is looked for."""
    return query(load_photo(where(sought)).pixels, zone=sought.zone, trim=trim)
