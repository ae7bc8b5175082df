"""The detail: its parameters, declared once, its frozen record and its versioned file."""

from voldetail.detail.colour import ColourChannel, ColourTexture, Lobe
from voldetail.detail.curves import MONOTONE_CURVES, START_CURVES
from voldetail.detail.declaration import Parameter
from voldetail.detail.detail_colour import DetailColour
from voldetail.detail.file import detail_from_text, detail_to_text, load_detail, rounded, save_detail, schema
from voldetail.detail.parameters import (
    ALLOWED_NEIGHBOURS,
    PAPER_NEIGHBOURS,
    PARAMETERS,
    MediumParameters,
    NoiseParameters,
    Reflectance,
    ReliefParameters,
    bounds,
    parameter,
    parameters_of,
)
from voldetail.detail.provenance import NoiseFloor, Provenance
from voldetail.detail.record import LARGEST_SEED, Detail, detail_from, values_of, with_values
from voldetail.detail.structure_texture import StructureTexture, Texture
from voldetail.detail.words import describe_in_words, summary

__all__ = [
    "ALLOWED_NEIGHBOURS",
    "LARGEST_SEED",
    "MONOTONE_CURVES",
    "PAPER_NEIGHBOURS",
    "PARAMETERS",
    "START_CURVES",
    "ColourChannel",
    "ColourTexture",
    "Detail",
    "DetailColour",
    "Lobe",
    "MediumParameters",
    "NoiseFloor",
    "NoiseParameters",
    "Parameter",
    "Provenance",
    "Reflectance",
    "ReliefParameters",
    "StructureTexture",
    "Texture",
    "bounds",
    "describe_in_words",
    "detail_from",
    "detail_from_text",
    "detail_to_text",
    "load_detail",
    "parameter",
    "parameters_of",
    "rounded",
    "save_detail",
    "schema",
    "summary",
    "values_of",
    "with_values",
]
