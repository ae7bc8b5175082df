"""A library opened: its records checked, its numbers left on disk until a query needs them.

Nothing in a library is executed or unpickled, and nothing outside its folder is read: metadata are JSON of a bounded size, and
chunks are files of known length, one kind of number each.
"""

from __future__ import annotations

import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from voldetail.errors import InputError
from voldetail.library.groups import Group, Series
from voldetail.library.layout import (
    FORMAT,
    FORMAT_VERSION,
    MOST_METADATA,
    ArrayLayout,
    LibraryRecord,
    SourceRecord,
    arrays_of,
    bytes_on_disk,
)
from voldetail.library.measures import MEASURES
from voldetail.library.pieces import Columns, Rows
from voldetail.library.tables import Table
from voldetail.library.vectors import digest, weights, weights_definition
from voldetail.records.json_text import parsed
from voldetail.records.refusal import printable, refusal, shown

Read = TypeVar("Read", LibraryRecord, SourceRecord)


@dataclass(frozen=True)
class Header:
    """What a library says of itself: its record, and its sources' by name. Its files are there and have their sizes."""

    path: Path
    record: LibraryRecord
    sources: Mapping[str, SourceRecord]

    @property
    def entries(self) -> int:
        """How many there are in all."""
        return sum(source.entries for source in self.sources.values())

    @property
    def bytes(self) -> int:
        """Size of its chunks on disk."""
        entries, keys = zip(*((s.entries, len(s.keys)) for s in self.sources.values()), strict=True)
        return bytes_on_disk(entries, keys, self.record.measure)

    @property
    def w_global(self) -> float:
        """Weight of brightness and contrast in the norms, see `vectors.weights`; -1 where it is missing."""
        found = self.record.weights.get("w_global")
        return float(found) if isinstance(found, (int, float)) else -1.0

    @property
    def stale(self) -> str:
        """Empty, or what of this voldetail's is not what the library was made with."""
        definition = MEASURES[self.record.measure].definition()
        if self.record.descriptor_sha256 != digest(definition) or self.record.descriptor != definition:
            return "its descriptors"
        if self.record.weights != weights_definition(self.w_global):
            return "its weights"
        return ""

    @property
    def sha256(self) -> str:
        """Of everything in it, by its sources' own hashes."""
        return digest([self.record.model_dump(), {name: source.model_dump() for name, source in self.sources.items()}])


@dataclass(frozen=True, eq=False)
class Library:
    """A library: its header, and what queries are made against, by source: groups of structures, or series of reliefs."""

    header: Header
    groups: dict[str, Group]
    series: dict[str, Series]


def open_library(path: str | Path) -> Library:
    """Return the library at ``path``; its vectors are not read.

    Raises InputError where it is no library, of another version, incomplete or damaged, or made with other descriptors or
    weights than this voldetail's.
    """
    header = read_header(path)
    if header.stale:
        names = " ".join(f"'{name}'" if " " in name else name for name in header.sources)
        if header.record.measure == "reliefs":
            names = "relief"
        most = max(source.entries for source in header.sources.values())
        raise InputError(
            f"The library {path} is out of date: {header.stale} are not this voldetail's; build it again with: "
            f"voldetail library build {names} --entries {most} -o {path} --force"
        )
    folders = {name: (header.path / name, source) for name, source in header.sources.items()}
    if header.record.measure == "reliefs":
        return Library(header, {}, {name: _series(folder, name, source) for name, (folder, source) in folders.items()})
    w = weights(header.w_global)
    return Library(header, {name: _group(folder, name, source, w) for name, (folder, source) in folders.items()}, {})


def read_header(path: str | Path) -> Header:
    """Return the header of the library at ``path``, of whatever descriptors.

    Raises InputError where it is no library, of another version, incomplete or damaged.
    """
    path = Path(path)
    where = f"The library {printable(str(path))}"
    if not path.exists():
        raise InputError(f"{where} does not exist; check the path, or build it with voldetail library build.")
    if not path.is_dir() or not (path / "zarr.json").exists():
        raise InputError(f"{where} is no library: it has to be a folder with zarr.json in it, as voldetail library build makes.")
    header = _attributes(path, where)
    if header.get("format") != FORMAT:
        raise InputError(f'{where} is no library: its "format" is {shown(header.get("format"))}, not "{FORMAT}".')
    if header.get("version") != FORMAT_VERSION:
        raise InputError(
            f"{where} has version {shown(header.get('version'))}, and this voldetail reads {FORMAT_VERSION}; build it again."
        )
    record = _checked(LibraryRecord, header, where)
    if len(set(record.sources)) < len(record.sources):
        raise InputError(f"{where} names a source twice; build it again.")
    sources = {}
    for name in record.sources:
        within = f"{where}, source {name}"
        _must_be(path / name, folder=True, size=None, where=where)
        sources[name] = _checked(SourceRecord, _attributes(path / name, within), within)
        for array in arrays_of(sources[name].entries, len(sources[name].keys), record.measure).values():
            _check_array(path / name / array.name, array, within)
    return Header(path, record, sources)


def is_library(path: Path) -> bool:
    """Whether a library is at ``path``, of whatever version and however damaged."""
    try:
        return path.is_dir() and _attributes(path, str(path)).get("format") == FORMAT
    except InputError:
        return False


def _group(folder: Path, name: str, record: SourceRecord, w: NDArray[np.float64]) -> Group:
    arrays = arrays_of(record.entries, len(record.keys), "structures")
    outlines = arrays["outlines"]
    columns = Columns(outlines.shape, outlines.chunk[1], _Mapped(folder / outlines.name, outlines, np.float32))
    table = Table(_rows(folder, arrays["vectors"], np.float32), w, _rows(folder, arrays["norms"], np.float32), columns)
    return Group(name, tuple(record.keys), _rows(folder, arrays["values"], np.float64), table, record.seed)


def _series(folder: Path, name: str, record: SourceRecord) -> Series:
    arrays = arrays_of(record.entries, len(record.keys), "reliefs")
    values, vectors = _rows(folder, arrays["values"], np.float64), _rows(folder, arrays["vectors"], np.float16)
    return Series(name, tuple(record.keys), values, vectors, record.seed, record.definition)


def _rows(folder: Path, array: ArrayLayout, kind: Any) -> Rows[Any]:
    return Rows(array.shape, array.chunk[0], kind, _Mapped(folder / array.name, array, kind))


@dataclass(frozen=True)
class _Mapped:
    """The chunks of one array, mapped one at a time without what they are filled up with."""

    folder: Path
    array: ArrayLayout
    kind: Any

    def __call__(self, k: int) -> NDArray[Any]:
        array = self.array
        file = self.folder / array.files[k]
        try:
            whole = np.asarray(np.memmap(file, np.dtype(self.kind).newbyteorder("<"), "r", shape=array.chunk))
        except (OSError, ValueError) as error:
            raise InputError(f"Cannot read {file}: {error}; the library changed since it was opened, try again.") from error
        if array.chunk[1] == array.shape[1]:
            return whole[: array.shape[0] - k * array.chunk[0]]
        return whole[:, : array.shape[1] - k * array.chunk[1]]


def _checked(model: type[Read], found: dict[str, Any], where: str) -> Read:
    try:
        return model.model_validate(found)
    except ValidationError as error:
        raise InputError(refusal(error, model, where) + "; build it again.") from None


def _attributes(folder: Path, where: str) -> dict[str, Any]:
    """The attributes of a group."""
    data = _metadata(folder, where)
    found = data.get("attributes")
    if data.get("zarr_format") != 3 or data.get("node_type") != "group" or not isinstance(found, dict):
        raise InputError(f"{where} is no library: {folder.name}/zarr.json is not a group of Zarr version 3 with attributes.")
    return found


def _metadata(folder: Path, where: str) -> dict[str, Any]:
    file = folder / "zarr.json"
    size = _must_be(file, folder=False, size=None, where=where)
    if size > MOST_METADATA:
        raise InputError(f"{where} has a zarr.json of {size} bytes; at most {MOST_METADATA} are read, build it again.")
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{where}: cannot read {file}: {error}; build it again.") from error
    return parsed(text, f"{where}: {folder.name}/zarr.json", "table of metadata")


def _check_array(folder: Path, array: ArrayLayout, where: str) -> None:
    """Raise InputError unless an array's metadata and its files' kinds and sizes are what they have to be."""
    _must_be(folder, folder=True, size=None, where=where)
    found = _metadata(folder, where)
    for key, wanted in array.metadata.items():
        if found.get(key) != wanted:
            raise InputError(
                f"{where}: {array.name} has {key} = {shown(found.get(key))} where {shown(wanted)} is needed; build it again."
            )
    if found.get("storage_transformers"):
        raise InputError(f"{where}: {array.name} has storage_transformers, which are not read; build it again.")
    parents: set[Path] = set()
    for file in array.files:
        parents.update(Path(file).parents)
        _must_be(folder / file, folder=False, size=array.chunk_bytes, where=where)
    for parent in parents:
        _must_be(folder / parent, folder=True, size=None, where=where)


def _must_be(path: Path, *, folder: bool, size: int | None, where: str) -> int:
    """Return a file's size. Raises InputError for one that is missing, a link, of another kind or of another size."""
    try:
        status = path.lstat()
    except OSError as error:
        raise InputError(f"{where} is incomplete: {path}: {error.strerror}; copy it again or build it again.") from None
    if not (stat.S_ISDIR if folder else stat.S_ISREG)(status.st_mode):
        raise InputError(f"{where} is damaged: {path} is no {'folder' if folder else 'regular file'}; build it again.")
    if size is not None and status.st_size != size:
        raise InputError(
            f"{where} is damaged: {path} has {status.st_size} bytes where {size} are needed; copy it again or build it again."
        )
    return status.st_size
