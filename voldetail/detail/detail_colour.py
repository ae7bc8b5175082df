"""The frozen record of what colours a detail's surface, and how: a texture, its scale, and what moves it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from voldetail.detail.colour import CURVE_SAMPLES, ColourTexture, Weight
from voldetail.detail.provenance import Record
from voldetail.detail.structure_texture import StructureTexture, Texture


class DetailColour(Record):
    """The colour of a detail's surface: a factor on what it reflects of the sky and the light's beam.

        Kd tint f(x),    f(x) = gain colour(texels_per_unit x)

    driver: what moves the first channel of the texture: its own noise (by example), the relief's height, the depth of its
    hollows (height, the other way round), or the cell's own number; the others always have their noise. heights: R at the
    probabilities of the curve, where it drives. structure: in place of the texture, a two-tone structure, which nothing drives.
    """

    driver: Literal["noise", "height", "hollow", "cell"] = Field(
        default="noise", description="What moves the most varied channel: noise, the relief's height or hollows, or the cell."
    )
    texels_per_unit: float = Field(gt=0, le=1e5, description="Texels of the photo in one scene unit.")
    gain: tuple[Weight, Weight, Weight] = Field(
        description="Linear red, green and blue that the texture is multiplied by: one over its mean."
    )
    heights: tuple[Annotated[float, Field(ge=0, le=1)], ...] = Field(
        default=(), max_length=CURVE_SAMPLES, description="The relief's height at the curve's probabilities, where it drives."
    )
    texture: ColourTexture | None = Field(default=None, description="The texture by example.")
    structure: StructureTexture | None = Field(default=None, description="In its place, a two-tone structure.")

    @property
    def source(self) -> Texture:
        """The texture, of whichever kind."""
        found = self.texture if self.structure is None else self.structure
        assert found is not None
        return found

    @model_validator(mode="after")
    def _one_kind(self) -> DetailColour:
        if (self.texture is None) == (self.structure is None):
            raise ValueError("a colour needs a texture or a structure, and not both")
        if self.structure is not None and self.driver != "noise":
            raise ValueError(f"nothing drives a structure: set the driver to 'noise', and not {self.driver!r}")
        return self

    @model_validator(mode="after")
    def _heights(self) -> DetailColour:
        driven = self.driver in ("height", "hollow")
        if len(self.heights) != (CURVE_SAMPLES if driven else 0):
            wanted = f"{CURVE_SAMPLES} heights" if driven else "no heights"
            raise ValueError(f"a colour with the driver {self.driver!r} needs {wanted}, and {len(self.heights)} are given")
        if any(b < a for a, b in zip(self.heights, self.heights[1:], strict=False)):
            raise ValueError("the heights decrease; each of them has to be at least the one before")
        return self
