"""How a fit searches."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from voldetail.detail.record import Record


class FitSettings(Record):
    """How the search is done."""

    solver: Literal["default", "paper"] = Field(default="default", description="Ours, or the one of GD10 section 7.")
    metric: str = Field(default="combined", min_length=1, description="The distance that is minimised.")
    evaluations: int | None = Field(
        default=None,
        ge=1,
        le=1_000_000,
        description="The most pictures that are rendered; null: the solver's own number.",
    )
    time_limit: float | None = Field(
        default=None,
        gt=0,
        le=1e6,
        json_schema_extra={"unit": "seconds"},
        description="The longest time for the search, in seconds; null for no limit.",
    )
    seeds: int = Field(default=2, ge=1, le=16, description="Noise seeds compared at once, so that none is overfitted.")
    specular: bool = Field(default=True, description="Whether the surface may have a highlight.")
    library: str = Field(
        default="auto", min_length=1, max_length=4096,
        description="Reliefs to start from: auto (built once and kept), none, or a library's path.",
    )  # fmt: skip
