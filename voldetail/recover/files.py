"""The files of a photo's relief: `relief.json` and its four maps, in one folder."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from voldetail.detail import Detail, load_detail
from voldetail.detail.photo_relief import RELIEF_VERSION, MapFile, MappedDetail, PhotoRelief, ReliefMapFiles
from voldetail.detail.relief_maps import ALBEDO, HEIGHT, NORMAL, ROUGHNESS, normals_of
from voldetail.errors import InputError
from voldetail.files import sha256, write_text
from voldetail.image import save_exr, to_linear, to_srgb
from voldetail.image.load import load_samples
from voldetail.image.png16 import save_png16
from voldetail.records.json_text import Migration, json_text, migrated, of_format, parsed
from voldetail.records.reading import read_small_text
from voldetail.records.refusal import printable, refusal

RELIEF_FORMAT = "voldetail.relief"
RELIEF_FILE = "relief.json"
RELIEF_MIGRATIONS: dict[int, Migration] = {}
"""Entry n brings the parsed file of version n to version n + 1; version 1 is the first: none yet."""

_WHAT = "relief file"
NO_FILE = "0" * 64
"""In the place of a hash, of a relief that was not saved yet."""


def unsaved_maps() -> ReliefMapFiles:
    """Return the names that the maps will have, without hashes."""
    return ReliefMapFiles(**{
        key: MapFile(path=name, sha256=NO_FILE)
        for key, name in (("height", HEIGHT), ("normal", NORMAL), ("albedo", ALBEDO), ("roughness", ROUGHNESS))
    })  # fmt: skip


def save_relief(folder: Path, detail: MappedDetail) -> MappedDetail:
    """Write the maps, then `relief.json`, into ``folder``, which exists; return the detail with the hashes of its files.

    Height is in scene units, 0 at the lowest point. Raises InputError where nothing can be written.
    """
    record = detail.record
    height = detail.height * np.float32(record.relief.amplitude)
    save_exr(folder / HEIGHT, height)
    normals = normals_of(height, record.texels_per_unit, periodic=record.periodic)
    save_png16(folder / NORMAL, 0.5 * (normals + 1.0), text={"Description": "normals (n + 1) / 2, x right, y up"})
    save_png16(folder / ALBEDO, to_srgb(detail.albedo), srgb=True)
    save_png16(folder / ROUGHNESS, detail.roughness)
    maps = ReliefMapFiles(**{
        key: MapFile(path=getattr(record.maps, key).path, sha256=sha256(folder / getattr(record.maps, key).path))
        for key in ReliefMapFiles.model_fields
    })  # fmt: skip
    saved = record.model_copy(update={"maps": maps})
    write_text(folder / RELIEF_FILE, relief_to_text(saved))
    return MappedDetail(saved, detail.height, detail.albedo, detail.roughness, detail.domain, detail.arrangement)


def relief_to_text(record: PhotoRelief) -> str:
    """The text of the relief's file."""
    data = {"format": RELIEF_FORMAT, **record.model_dump(mode="json")}
    if data["provenance"] is None:
        del data["provenance"]
    return json_text(data)


def load_relief(path: Path | str) -> MappedDetail:
    """Return the relief in the JSON file at ``path``, or in `relief.json` of that folder, with its maps.

    Raises InputError for a file or map that is missing, damaged, of another size or with numbers out of range. A map whose hash
    is another than the file says was edited: that is taken, and said in the record's notes.
    """
    path = Path(path)
    path = path / RELIEF_FILE if path.is_dir() else path
    record = _record(read_small_text(path, _WHAT), printable(str(path)))
    edited: list[str] = []
    height = _map(path, record, "height", edited)
    top, bottom = float(height.max()), float(height.min())
    if not top > bottom:
        raise InputError(f"The height map of {path} is flat; give one with relief, or make it again with voldetail relief.")
    albedo = to_linear(_map(path, record, "albedo", edited, colour=True))
    roughness = np.clip(_map(path, record, "roughness", edited), 0.0, 1.0)
    notes = (*record.notes, *(f"The {name} was changed after it was made." for name in edited))
    amplitude = record.relief.model_copy(update={"amplitude": min(top - bottom, 1.0)})
    record = record.model_copy(update={"relief": amplitude, "notes": notes})
    relative = np.asarray((height - bottom) / (top - bottom), np.float32)
    return MappedDetail(record, relative, np.asarray(albedo, np.float32), np.asarray(roughness, np.float32))


def load_any(path: Path | str) -> Detail | MappedDetail:
    """Return the detail in a file, procedural or a photo's relief; a folder stands for the relief in it.

    Raises InputError as `load_detail` and `load_relief` do.
    """
    path = Path(path)
    if path.is_dir():
        return load_relief(path)
    text = read_small_text(path, "detail file")
    return load_relief(path) if f'"{RELIEF_FORMAT}"' in text[:200] else load_detail(path)


def _record(text: str, where: str) -> PhotoRelief:
    data = parsed(text, where, _WHAT)
    of_format(data, RELIEF_FORMAT, where, _WHAT)
    data = migrated(data, RELIEF_VERSION, RELIEF_MIGRATIONS, where)
    del data["format"]
    try:
        # Through JSON again, since only there "strict" takes a list for a tuple and still refuses "3" for 3.
        return PhotoRelief.model_validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise InputError(refusal(error, PhotoRelief, where) + ".") from None
    except (ValueError, RecursionError):
        raise InputError(f"{where} holds a value that is too large or too deeply nested.") from None


def _map(path: Path, record: PhotoRelief, name: str, edited: list[str], *, colour: bool = False) -> NDArray[np.float32]:
    """Return a map's stored numbers (H, W), or (H, W, 3) of a ``colour``, of the size that the file says."""
    file: MapFile = getattr(record.maps, name)
    beside = path.parent / file.path
    values = np.asarray(load_samples(beside, f"{name} map").values, np.float32)
    if values.shape[:2] != (record.rows, record.columns):
        raise InputError(
            f"The {name} map {beside} has {values.shape[1]} x {values.shape[0]} pixels where {path} says"
            f" {record.columns} x {record.rows}; put back the one that was made with it."
        )
    if sha256(beside) != file.sha256:
        edited.append(f"{name} map {file.path}")
    if colour:
        return values if values.ndim == 3 else np.repeat(values[..., None], 3, axis=2)
    return values if values.ndim == 2 else np.asarray(values[..., :3].mean(axis=-1))
