"""Numbers that a picture takes, declared once with their bounds: refused in one sentence before anything is rendered."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from voldetail.detail.record import Record
from voldetail.errors import InputError
from voldetail.records.refusal import refusal

LARGEST_SCALE = 1000.0

_Side = Annotated[int, Field(ge=16, le=8192)]
_Turn = Annotated[float, Field(ge=-360, le=360)]
_Light = Annotated[float, Field(ge=0, le=1000)]


class PictureNumbers(Record):
    """What `render`, `relight`, `bake` and `export` take besides a detail, a shape and a light."""

    scale: float = Field(
        default=1.0, gt=0, le=LARGEST_SCALE, description="How many times larger the relief is than in the photo."
    )
    size: tuple[_Side, _Side] = Field(
        default=(640, 480),
        description="Columns and rows.",
        json_schema_extra={"allowed": "two whole numbers, columns and rows, each 16 to 8192"},
    )
    rotation: tuple[_Turn, _Turn, _Turn] = Field(
        default=(0.0, 0.0, 0.0),
        description="Turns about x, y, z.",
        json_schema_extra={"allowed": "three numbers, each -360 to 360 degrees"},
    )
    subsamples: int = Field(default=2, ge=1, le=8, description="Samples a pixel, each way, under a light.")
    samples: int = Field(default=64, ge=1, le=65536, description="Samples a pixel under an environment map.")
    shading: Literal["phong", "principled"] = Field(default="phong", description="As fitted, or physically based.")
    background: _Light | tuple[_Light, _Light, _Light] = Field(
        default=0.0,
        description="Light where there is nothing.",
        json_schema_extra={"allowed": "a number, or three for red, green and blue, each 0 to 1000"},
    )
    cells: int = Field(default=128, ge=16, le=1024, description="Cells to the 2 scene units that a shape is long.")


def checked(call: str, **numbers: Any) -> PictureNumbers:
    """Return the ``numbers`` given to the function ``call``; lists stand for tuples, and NumPy's numbers for Python's.

    Raises InputError for one that is out of range, of another kind, or of another length.
    """
    try:
        return PictureNumbers.model_validate({name: _plain(value) for name, value in numbers.items()})
    except ValidationError as error:
        raise InputError(refusal(_without_union(error), PictureNumbers, f"The call of {call}") + ".") from None


def _plain(value: Any) -> Any:
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(map(_plain, value)) if isinstance(value, list | tuple) else value


def _without_union(error: ValidationError) -> ValidationError:
    """Return the error with places that name a field, not the member of a union that was tried."""
    lines = [
        {"type": e["type"], "loc": e["loc"][:1], "input": e["input"], "ctx": e.get("ctx", {})}
        for e in error.errors(include_url=False)
    ]
    return ValidationError.from_exception_data(error.title, lines)  # type: ignore[arg-type]
