"""All structure models by name."""

from __future__ import annotations

from voldetail.texture.structures.grids import CELLULAR_GRID, GRID
from voldetail.texture.structures.model import StructureModel
from voldetail.texture.structures.noisy import PERLIN, TURBULENCE, TURBULENCE_RIDGE
from voldetail.texture.structures.shapes import STAR, SYMBOL
from voldetail.texture.structures.tiled import BRICK, WOOD_PLANKS
from voldetail.texture.structures.wood import RINGS, WOOD_LINES, WOOD_STREAKS

MODELS: dict[str, StructureModel] = {
    model.name: model
    for model in (
        PERLIN, TURBULENCE, TURBULENCE_RIDGE, GRID, CELLULAR_GRID, BRICK, WOOD_PLANKS, WOOD_LINES, WOOD_STREAKS, RINGS, STAR,
        SYMBOL,
    )
}  # fmt: skip
"""The models by name, in the paper's order of classes."""
