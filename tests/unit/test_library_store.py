"""Library files: what was built is what is read, nothing is read before it is needed, and damage is refused."""

import json
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from library_sources import Counted, files_of

from voldetail.errors import InputError
from voldetail.library import Group, StructureSource, nearest, open_library, table
from voldetail.library.building.build import build
from voldetail.library.check import check
from voldetail.library.layout import arrays_of, step_of
from voldetail.library.store import read_header
from voldetail.library.tables import BLOCK
from voldetail.texture.structures import MODELS

COUNT = BLOCK + 100
"""Entries: two chunks of each array, the second filled up."""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    small = StructureSource(MODELS["cellular grid"], side=104)
    return build([Counted(), small], [COUNT, 3], tmp_path_factory.mktemp("built") / "lib", workers=1, chunk=1024)


@pytest.fixture
def copied(built: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(built, tmp_path / "lib"))


def test_what_was_built_is_what_is_read(built: Path) -> None:
    library = open_library(built)
    values, vectors = Counted().chunk(0, COUNT)
    group = library.groups["counted"]
    assert np.array_equal(group.values, values)
    assert np.array_equal(group.table.vectors, vectors)
    assert group.parameters(4242) == {"number": 4242.0, "share": 4242.5}
    whole = table(vectors)
    # Products of other numbers of rows are rounded otherwise by some processors.
    assert np.allclose(np.asarray(group.table.norms), whole.norms, rtol=1e-5)
    outlines = np.concatenate(list(group.table.outlines.pieces()), axis=1)  # type: ignore[union-attr]
    assert np.allclose(outlines, whole.outlines, rtol=1e-5)
    query = vectors[BLOCK + 50] + np.float32(0.01)
    assert nearest(group.table, query) == nearest(whole, query)
    other = library.groups["cellular grid"]
    assert isinstance(other, Group)
    assert (other.model, other.seed, len(other.values)) == ("cellular grid", 0, 3)
    assert other.keys == tuple(p.key for p in MODELS["cellular grid"].parameters)
    assert library.header.entries == COUNT + 3
    assert library.header.bytes == sum(len(b) for name, b in files_of(built).items() if not name.endswith(".json"))


def test_other_programs_read_it(built: Path) -> None:
    zarr = pytest.importorskip("zarr")
    root = zarr.open_group(str(built), mode="r")
    values, vectors = Counted().chunk(0, COUNT)
    assert np.array_equal(root["counted/values"][:], values)
    assert np.array_equal(root["counted/vectors"][:], vectors)
    assert root["counted"].attrs["entries"] == COUNT


def test_chunks_are_even_and_hold_a_block_at_most() -> None:
    for count in (1, 5, BLOCK, BLOCK + 1, 100_000, 1_000_000):
        step = step_of(count)
        assert step <= BLOCK
        files = len(arrays_of(count, 3, "structures")["values"].files)
        assert files == -(-count // BLOCK)
        assert 0 <= files * step - count < files


def test_zeros_have_files_as_all_else(tmp_path: Path) -> None:
    group = open_library(build([Counted(trouble="zeros")], 5, tmp_path / "lib", workers=1)).groups["counted"]
    assert not np.asarray(group.values).any()
    assert nearest(group.table, np.zeros(750), swap=False)[0].distance == 0.0


def test_opening_reads_no_chunk(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []
    monkeypatch.setattr(np, "memmap", lambda *args, **rest: read.append("memmap"))
    monkeypatch.setattr(np, "fromfile", lambda *args, **rest: read.append("fromfile"))
    library = open_library(built)
    assert read == []
    with pytest.raises(Exception):  # noqa: B017, PT011 - whatever comes of it, it was tried
        library.groups["counted"].values[0]
    assert read == ["memmap"]


def change(file: Path, *place: str, to: Any) -> None:
    data = json.loads(file.read_text())
    here = data
    for key in place[:-1]:
        here = here[key]
    here[place[-1]] = to
    file.write_text(json.dumps(data))


GZIP = [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "gzip", "configuration": {"level": 5}}]


@pytest.mark.parametrize(
    ("file", "place", "to", "says"),
    [
        ("", ["attributes", "format"], "photos", r'"format" is \'photos\''),
        ("", ["attributes", "version"], 2, "has version 2, and this voldetail reads 1; build it again"),
        ("", ["attributes"], None, "not a group of Zarr"),
        ("", ["zarr_format"], 2, "not a group of Zarr"),
        ("", ["attributes", "sources"], ["counted", "../lib/counted"], "wrong length or form"),
        ("", ["attributes", "sources"], ["counted", "counted"], "names a source twice"),
        ("", ["attributes", "sources"], ["other"], "incomplete: .*other"),
        ("", ["attributes", "descriptor", "reach"], 3.0, "date: its descriptors.*library build counted 'cellular"),
        ("", ["attributes", "weights", "pixels_a_degree"], 60.0, "out of date: its weights"),
        ("", ["attributes", "weights"], {}, "out of date: its weights"),
        ("counted", ["attributes", "entries"], 10**9, "entries = 1000000000 is out of range"),
        ("counted", ["attributes", "entries"], COUNT - 1, "shape = .* where .* is needed"),
        ("counted", ["attributes", "entries"], float(COUNT), "of the wrong kind"),
        ("counted", ["attributes", "keys"], ["number"], "shape = .* where .* is needed"),
        ("counted", ["attributes", "seed"], -1, "seed = -1 is out of range"),
        ("counted", ["attributes", "more"], 1, "there is no setting more"),
        ("counted/vectors", ["data_type"], "variable_length_bytes", "data_type = 'variable_length_bytes' where 'float32'"),
        ("counted/vectors", ["codecs"], GZIP, "codecs = "),
        ("counted/vectors", ["shape"], [COUNT, 75000], "shape = "),
        ("counted/vectors", ["storage_transformers"], [{"name": "x"}], "storage_transformers"),
        ("counted/norms", ["chunk_grid", "configuration", "chunk_shape"], [1, 12], "chunk_grid = "),
        ("counted/norms", ["node_type"], "group", "node_type = "),
    ],
)
def test_other_metadata_are_refused(file: str, place: list[str], to: Any, says: str, copied: Path) -> None:
    change(copied / file / "zarr.json", *place, to=to)
    with pytest.raises(InputError, match=says) as refused:
        open_library(copied)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "not valid JSON"),
        ("[1]", "holds .* not a table"),
        ("[" * 100_000, "too deeply"),
        ("1" * 2**20 + "1", "at most 1048576"),
    ],
)
def test_metadata_that_are_none_are_refused(text: str, says: str, copied: Path) -> None:
    for file in ("zarr.json", "counted/zarr.json", "counted/values/zarr.json"):
        before = (copied / file).read_bytes()
        (copied / file).write_text(text)
        with pytest.raises(InputError, match=says):
            open_library(copied)
        (copied / file).write_bytes(before)
    open_library(copied)


def test_missing_short_and_long_files_and_links_are_refused(copied: Path) -> None:
    for name in ("values/c/1/0", "vectors/c/0/0", "norms/c/1/0", "outlines/c/0/1", "outlines/zarr.json"):
        file = copied / "counted" / name
        before = file.read_bytes()
        file.unlink()
        with pytest.raises(InputError, match=r"is incomplete: .*copy it again or build it again"):
            open_library(copied)
        (copied / "elsewhere").write_bytes(before)
        file.symlink_to(copied / "elsewhere")
        with pytest.raises(InputError, match="no regular file"):
            open_library(copied)
        file.unlink()
        os.mkfifo(file)
        with pytest.raises(InputError, match="no regular file"):
            open_library(copied)
        file.unlink()
        if file.name != "zarr.json":
            for wrong in (before[:-1], before + b"0"):
                file.write_bytes(wrong)
                with pytest.raises(InputError, match=f"damaged: .* has {len(wrong)} bytes where {len(before)} are needed"):
                    open_library(copied)
        file.write_bytes(before)
    (copied / "elsewhere").unlink()
    (copied / "counted").rename(copied / "moved")
    (copied / "counted").symlink_to(copied / "moved")
    with pytest.raises(InputError, match="no folder"):
        open_library(copied)


def test_what_is_no_library_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        open_library(tmp_path / "none")
    (tmp_path / "file").write_text("x")
    for path in (tmp_path, tmp_path / "file"):
        with pytest.raises(InputError, match=r"is no library: it has to be a folder with zarr.json"):
            open_library(path)


def test_a_file_cut_short_while_the_library_is_open_is_refused(copied: Path) -> None:
    library = open_library(copied)
    (copied / "counted/vectors/c/1/0").write_bytes(b"short")
    with pytest.raises(InputError, match="changed since it was opened"):
        library.groups["counted"].table.vectors[COUNT - 1]


def test_a_stale_library_still_tells_what_it_is(copied: Path) -> None:
    change(copied / "zarr.json", "attributes", "descriptor_sha256", to="0" * 64)
    header = read_header(copied)
    assert header.stale == "its descriptors"
    assert header.entries == COUNT + 3


@pytest.mark.parametrize("array", ["values", "vectors", "norms", "outlines"])
def test_a_changed_number_is_found_by_the_check(array: str, copied: Path) -> None:
    library = open_library(copied)
    seen: list[int] = []
    check(library, seen.append)
    assert seen[-1] == COUNT + 3
    file = copied / "counted" / array / "c" / ("0/1" if array == "outlines" else "1/0")
    data = bytearray(file.read_bytes())
    data[3 if array != "values" else 6] ^= 0x40
    file.write_bytes(data)
    open_library(copied)
    with pytest.raises(InputError, match=rf"source counted, entries {step_of(COUNT)} to {COUNT - 1}|counted.*not those"):
        check(open_library(copied))
