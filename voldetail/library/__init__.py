"""Libraries of procedural textures, searched by a photo's descriptor: parameters retrieved, not optimised (GKHF14)."""

from voldetail.library.answers import Answer, Ranking, picture, rank, structure_map, texture_of
from voldetail.library.building.source import Source, StructureSource
from voldetail.library.compare import Match, distance, nearest
from voldetail.library.entries import Entries, entries, entry, grid_values, random_values
from voldetail.library.groups import Group, Groups
from voldetail.library.novelty import Novelty, novelty_of
from voldetail.library.query import Query, query
from voldetail.library.store import Library, open_library
from voldetail.library.tables import Table, table
from voldetail.library.two_tone import TwoTone, recolour, two_tone
from voldetail.library.vectors import published_w_global, swapped, turned, vector_of, weights

__all__ = [
    "Answer",
    "Entries",
    "Group",
    "Groups",
    "Library",
    "Match",
    "Novelty",
    "Query",
    "Ranking",
    "Source",
    "StructureSource",
    "Table",
    "TwoTone",
    "distance",
    "entries",
    "entry",
    "grid_values",
    "nearest",
    "novelty_of",
    "open_library",
    "picture",
    "published_w_global",
    "query",
    "random_values",
    "rank",
    "recolour",
    "structure_map",
    "swapped",
    "table",
    "texture_of",
    "turned",
    "two_tone",
    "vector_of",
    "weights",
]  # fmt: skip
