"""The frozen record of a two-tone structure as a colour texture: a structure model's name and numbers, and its two tones.

    colour(x) = decode((1 - s) zero + s one),      s = (s_a(R_-rotation x) - low) / (high - low), held in [0, 1]

(GKHF14 equations 2 and 3, the model's range brought to that of a photo's two tones.) x in texels. What the model's name and
numbers may be is known to the models: see `texture.structures.colour`.
"""

from __future__ import annotations

from math import tau
from typing import Annotated, Literal

from pydantic import Field, model_validator

from voldetail.detail.colour import ColourTexture, Finite
from voldetail.detail.provenance import Record

STRUCTURE_VERSION: Literal[1] = 1
MOST_PARAMETERS = 32

LEAST_SPAN = 5e-5
"""Half of what two tones differ by at least; a file has seven digits."""

Share = Annotated[float, Field(ge=0, le=1)]
Side = Annotated[int, Field(ge=1, le=2**16)]


class StructureTexture(Record):
    """A structure model with its parameters and two tones, as `voldetail retrieve` finds it."""

    version: Literal[1] = Field(default=STRUCTURE_VERSION, description="The version of the record.")
    name: str = Field(default="structure", min_length=1, max_length=200, description="A name for people.")
    model: str = Field(min_length=1, max_length=100, description="The name of the structure model.")
    parameters: dict[Annotated[str, Field(max_length=100)], Finite] = Field(
        max_length=MOST_PARAMETERS, description="The model's parameters by name; lengths in texels."
    )
    seed: int = Field(default=0, ge=0, le=2**32 - 1, description="The seed of the noise.")
    rotation: float = Field(default=0.0, ge=-tau, le=tau, description="The turn of the structure, radians counter-clockwise.")
    span: tuple[Share, Share] = Field(default=(0.0, 1.0), description="Low and high, the model's values that count as 0 and 1.")
    zero: tuple[Share, Share, Share] = Field(description="The sRGB-encoded colour where the structure is 0.")
    one: tuple[Share, Share, Share] = Field(description="The sRGB-encoded colour where the structure is 1.")
    texels: tuple[Side, Side] = Field(description="Columns and rows of the photo as it was compared.")
    photo: str = Field(default="", max_length=400, description="The file name of the photo, without its folder.")

    @model_validator(mode="after")
    def _rising(self) -> StructureTexture:
        if self.span[1] - self.span[0] < LEAST_SPAN:
            raise ValueError(f"the span's second number has to be over its first by {LEAST_SPAN:g} at least")
        return self


Texture = ColourTexture | StructureTexture
"""What a surface can be coloured by."""
