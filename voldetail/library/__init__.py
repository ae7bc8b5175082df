"""Libraries of procedural textures, searched by a photo's descriptor: parameters retrieved, not optimised (GKHF14)."""

from voldetail.library.compare import Match, distance, nearest
from voldetail.library.entries import Entries, entries, entry, grid_values, random_values
from voldetail.library.groups import Group, Groups
from voldetail.library.source import Source, StructureSource
from voldetail.library.store import Library, open_library
from voldetail.library.tables import Table, table
from voldetail.library.two_tone import TwoTone, recolour, two_tone
from voldetail.library.vectors import published_w_global, swapped, turned, vector_of, weights

__all__ = [
    "Entries", "Group", "Groups", "Library", "Match", "Source", "StructureSource", "Table", "TwoTone", "distance", "entries",
    "entry", "grid_values", "nearest", "open_library", "published_w_global", "random_values", "recolour", "swapped",
    "table", "turned", "two_tone", "vector_of", "weights",
]  # fmt: skip
