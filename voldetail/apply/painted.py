"""A colour texture alone, as a detail without relief: any shape is coloured by it."""

from __future__ import annotations

from voldetail.detail import Detail, DetailColour, StructureTexture, Texture, with_values

SKY, BEAM = 0.35, 1.0
"""Ambient and diffuse coefficient: a light and half as much sky, under which a texture is seen on all sides."""


def painted(texture: Texture, texels_per_unit: float | None = None) -> Detail:
    """Return a Detail without relief whose albedo is ``texture``, solid, with ``texels_per_unit`` texels a scene unit.

    By default the longest side of the photo is as long as a shape, 2 scene units.
    """
    structure = texture if isinstance(texture, StructureTexture) else None
    colour = DetailColour(
        texels_per_unit=texels_per_unit or max(texture.texels) / 2, gain=(1.0, 1.0, 1.0),
        texture=None if isinstance(texture, StructureTexture) else texture, structure=structure,
    )  # fmt: skip
    values = {"relief.amplitude": 0.0, "reflectance.ambient": SKY, "reflectance.diffuse": BEAM}
    return with_values(Detail(name=texture.name), values).model_copy(update={"colour": colour})
