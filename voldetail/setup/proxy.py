"""The simple shape that stands for what is in the photo."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from voldetail.detail.record import Record
from voldetail.setup.light import FURTHEST, Length, Vector
from voldetail.setup.shapes import SHAPES, ShapeKind, ShapeRow

_Turn = Annotated[float, Field(ge=-360, le=360)]


class ProxySetup(Record):
    """The simple shape that stands for the object: `size` None means the kind's own (see `extent`)."""

    kind: ShapeKind = Field(default="plane", description="The kind of shape; a plane faces the camera.")
    mesh: Path | None = Field(default=None, description="The mesh file, for the kind mesh only.")
    size: Vector | None = Field(
        default=None,
        description="Width, height and depth, in scene units.",
        json_schema_extra={"allowed": f"three numbers over 0, at most {FURTHEST:g} scene units"},
    )
    position: tuple[Length, Length, Length] = Field(
        default=(0.0, 0.0, 0.0),
        description="Where its centre is, in scene units.",
        json_schema_extra={"allowed": f"three numbers, each -{FURTHEST:g} to {FURTHEST:g} scene units"},
    )
    rotation: tuple[_Turn, _Turn, _Turn] = Field(
        default=(0.0, 0.0, 0.0),
        description="Turns about x, then y, then z, in degrees.",
        json_schema_extra={"allowed": "three numbers, each -360 to 360 degrees"},
    )

    @property
    def row(self) -> ShapeRow:
        """What a setup knows of the kind."""
        return SHAPES[self.kind]

    @property
    def extent(self) -> Vector:
        """Width, height and depth in scene units: as given, or the kind's default."""
        return self.size or self.row.size

    @model_validator(mode="after")
    def _usable(self) -> ProxySetup:
        if self.row.of_file and self.mesh is None:
            raise ValueError(f'the kind "{self.kind}" needs the path of a mesh file as proxy.mesh')
        if not self.row.of_file and self.mesh is not None:
            raise ValueError(f'a mesh file is given but the kind is "{self.kind}"; set proxy.kind to "mesh"')
        thick = 2 if self.row.flat else 3  # a plane has no depth
        if self.size and not (min(self.size[:thick]) > 0 and self.size[2] >= 0 and max(self.size) <= FURTHEST):
            raise ValueError(
                f"the size {','.join(f'{v:g}' for v in self.size)} has to be over 0 and at most {FURTHEST:g} scene units each way"
            )
        if refused := self.row.refused(self.extent):
            raise ValueError(refused)
        return self
