"""From a file's suffix to its writer: a format is one module and one row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from voldetail.detail.photo_relief import AnyDetail
from voldetail.errors import InputError
from voldetail.export import density, mesh
from voldetail.export.options import ExportOptions

Writer = Callable[[Path, AnyDetail, str | Path, ExportOptions], str]


@dataclass(frozen=True)
class Format:
    """suffixes: that the writer knows, with their dots. what: is in such a file, in words."""

    suffixes: tuple[str, ...]
    what: str
    write: Writer


FORMATS: tuple[Format, ...] = (
    Format((".vol",), "densities of a volume, as Mitsuba's gridvolume reads them", density.write),
    Format((".ply", ".obj", ".stl", ".off"), "the displaced shape as triangles", mesh.write),
)


def suffixes() -> tuple[str, ...]:
    """Return all suffixes that are known."""
    return tuple(suffix for row in FORMATS for suffix in row.suffixes)


def export(detail: AnyDetail, shape: str | Path, path: str | Path, options: ExportOptions | None = None) -> str:
    """Write ``detail`` on ``shape`` (a kind or a mesh file) to ``path`` in the format of its suffix; return a line about it.

    Raises InputError for a suffix that is not known, and for what the format cannot hold.
    """
    path = Path(path)
    for row in FORMATS:
        if path.suffix.lower() in row.suffixes:
            return row.write(path, detail, shape, options or ExportOptions())
    found = f"the suffix {path.suffix}" if path.suffix else "no suffix"
    raise InputError(f"Cannot export to {path}: it has {found}; use one of {', '.join(suffixes())}.")
