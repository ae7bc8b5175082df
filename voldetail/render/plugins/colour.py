"""A colour texture, by example or of a structure, as a Mitsuba texture, `voldetail_colour`, for any BSDF of any scene.

    {"type": "voldetail_colour", "filename": "wall.json", "texels_per_unit": 96.0, "mapping": "solid"}

mapping: "solid" (default) evaluates the solid texture at the point of the surface, in world units, so that no texture
coordinates are needed; "uv" the 2D texture at the mesh's own, one unit of which counts as ``texels_per_unit`` texels.
footprint: texels that a pixel covers, 0 for none: what is finer is averaged.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from voldetail.backend import mitsuba
from voldetail.detail import StructureTexture, Texture
from voldetail.detail.texture_file import texture_from_text, texture_to_text
from voldetail.errors import InputError
from voldetail.texture import colour_at, load_texture
from voldetail.texture.structures import checked_structure

PLUGIN = "voldetail_colour"
MAPPINGS = ("solid", "uv")


@cache
def register_colour() -> str:
    """Make ``voldetail_colour`` known to Mitsuba, once, and return its name; call before a scene is loaded."""
    mi = mitsuba()
    mi.register_texture(PLUGIN, _plugin(mi))
    return PLUGIN


def colour_dict(texture: Texture, texels_per_unit: float, mapping: str = "solid", footprint: float = 0.0) -> dict[str, Any]:
    """Return the Mitsuba dictionary of a texture at hand. Raises InputError for another mapping, and for a structure whose model
    or parameters are not known or out of range."""
    if isinstance(texture, StructureTexture):
        checked_structure(texture, "The texture")
    if mapping not in MAPPINGS:
        raise InputError(f"The mapping {mapping!r} is not known; use {' or '.join(MAPPINGS)}.")
    return {
        "type": register_colour(),
        "text": texture_to_text(texture),
        "texels_per_unit": float(texels_per_unit),
        "mapping": mapping,
        "footprint": float(footprint),
    }


def _plugin(mi: Any) -> type:
    """Return the class; Mitsuba's own base class exists only once a variant is set."""

    class ProceduralColour(mi.Texture):
        """A Texture at the points of a surface."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            if "text" in props:
                self.texture = texture_from_text(props["text"], "The texture")
            else:
                self.texture = load_texture(props["filename"])
            if isinstance(self.texture, StructureTexture):
                checked_structure(self.texture, "The texture")
            self.texels = mi.Float(props.get("texels_per_unit", 1.0))
            self.mapping = props.get("mapping", "solid")
            self.footprint = float(props.get("footprint", 0.0))
            if self.mapping not in MAPPINGS:
                raise InputError(f"The mapping {self.mapping!r} is not known; use {' or '.join(MAPPINGS)}.")

        def eval(self, si: Any, active: Any = True) -> Any:
            place = (si.uv.x, si.uv.y) if self.mapping == "uv" else (si.p.x, si.p.y, si.p.z)
            normals = None if self.mapping == "uv" else (si.n.x, si.n.y, si.n.z)
            texels = tuple(v * self.texels for v in place)
            return mi.Color3f(*colour_at(self.texture, texels, self.footprint, normals=normals))

        def eval_3(self, si: Any, active: Any = True) -> Any:
            return self.eval(si, active)

        def eval_1(self, si: Any, active: Any = True) -> Any:
            return mi.luminance(self.eval(si, active))

        def mean(self) -> Any:
            return mi.Float(0.5)

        def is_spatially_varying(self) -> bool:
            return True

        def to_string(self) -> str:
            return f"ProceduralColour[{self.texture.name}, {self.mapping}]"

    return ProceduralColour
