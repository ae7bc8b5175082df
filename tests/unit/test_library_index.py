"""The index: exact where it looks everywhere, nearly so in some cells, and refused where it is not the library's."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from library_sources import Counted

from voldetail.errors import InputError
from voldetail.library import Library, nearest, open_library, swapped, turned
from voldetail.library.building.build import build
from voldetail.library.building.source import Chunk
from voldetail.library.index import ENTRIES_A_CELL, HEAD, nearest_by_index, open_index, write_index
from voldetail.library.measures import MeasureName

COUNT = 12 * ENTRIES_A_CELL + 7


@dataclass(frozen=True)
class Clouds:
    """Entries about 60 centres."""

    name: str = "clouds"
    keys: tuple[str, ...] = ("number",)
    seed: int = 0
    measure: MeasureName = "structures"
    parallel: bool = False
    definition: dict[str, Any] = field(default_factory=dict)

    def chunk(self, first: int, count: int) -> Chunk:
        centres = np.random.default_rng(1).random((60, 750))
        rng = np.random.default_rng([2, first])
        vectors = centres[rng.integers(60, size=count)] + 0.05 * rng.standard_normal((count, 750))
        return np.arange(first, first + count)[:, None].astype(float), vectors.astype(np.float32)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    path = build([Clouds(), Counted()], [COUNT, 30], tmp_path_factory.mktemp("indexed") / "lib", workers=1, chunk=4096)
    seen: list[int] = []
    write_index(open_library(path), seen.append)
    assert seen == [COUNT, COUNT + 30]
    return open_library(path)


def queries(library: Library) -> list[np.ndarray]:
    vectors = library.groups["clouds"].table.vectors
    rng = np.random.default_rng(5)
    return [
        turned(swapped(v) if k % 2 else v, k % 16) + np.float32(0.02) * rng.standard_normal(750, dtype=np.float32)
        for k, v in enumerate(vectors[np.arange(0, COUNT, 800)])
    ]


def test_every_entry_is_in_one_cell(library: Library) -> None:
    index = open_index(library)["clouds"]
    assert len(index.centres) == 12
    assert np.array_equal(np.sort(index.numbers), np.arange(COUNT))
    assert index.ends[-1] == COUNT


def test_looking_into_all_cells_and_at_all_entries_is_exact(library: Library) -> None:
    index, group = open_index(library)["clouds"], library.groups["clouds"]
    for query in queries(library)[:3]:
        among = index.candidates(query, cells=12, count=COUNT)
        assert np.array_equal(among, np.arange(COUNT))
        assert nearest(group.table, query, among=among) == nearest(group.table, query)
    small = library.groups["counted"]
    query = queries(library)[1]
    assert nearest_by_index(small, open_index(library)["counted"], query) == nearest(small.table, query)


def test_a_few_cells_have_nearly_all_that_is_near(library: Library) -> None:
    index, group = open_index(library)["clouds"], library.groups["clouds"]
    shares = []
    for query in queries(library):
        exact = {match.entry for match in nearest(group.table, query)}
        among = index.candidates(query, cells=3, count=500)
        assert len(among) <= 1000
        found = nearest(group.table, query, among=among)
        assert [match.distance for match in found] == sorted(match.distance for match in found)
        shares.append(len(exact & {match.entry for match in found}) / len(exact))
    assert np.mean(shares) > 0.9


def test_scales_that_a_query_lacks_are_left_out(library: Library) -> None:
    from voldetail.library.vectors import scales

    index, group = open_index(library)["clouds"], library.groups["clouds"]
    query = queries(library)[2]
    query[scales() >= 4] = np.nan
    assert nearest_by_index(group, index, query)[0] == nearest(group.table, query)[0]
    with pytest.raises(InputError, match="has the shape"):
        nearest_by_index(group, index, query[:5])


def test_an_index_that_is_not_the_librarys_is_refused(library: Library, tmp_path: Path) -> None:
    own = (library.header.path / "index").read_bytes()
    other = open_library(build([Clouds(seed=1), Counted()], [COUNT, 30], tmp_path / "other", workers=1, chunk=4096))
    with pytest.raises(InputError, match="has no index; make one with: voldetail library index"):
        open_index(other)
    place = other.header.path / "index"
    for data, says in (
        (own, "belongs to another library"),
        (b"x" + own[1:], "not valid JSON"),
        (own.replace(b'"version": 1', b'"version": 7', 1), "of another version"),
        (b"", "is empty"),
    ):
        place.write_bytes(data)
        with pytest.raises(InputError, match=says):
            open_index(other)
    write_index(other)
    whole = place.read_bytes()
    ends = HEAD + 12 * 60 * 4
    for data, says in (
        (whole[:-1], "cut short"), (whole + b"0", "are needed"),
        (whole[:ends] + b"\xff" * 8 + whole[ends + 8 :], "is damaged"),
    ):  # fmt: skip
        place.write_bytes(data)
        with pytest.raises(InputError, match=says):
            open_index(other)
    numbers = ends + 12 * 8
    place.write_bytes(whole[:numbers] + b"\x7f" * (8 * COUNT) + whole[numbers + 8 * COUNT :])
    with pytest.raises(InputError, match="names entries that its library lacks"):
        open_index(other)["clouds"].candidates(queries(library)[0])
