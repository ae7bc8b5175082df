"""The cache of libraries: built once, built again when anything that decides it changes or it is damaged."""

from pathlib import Path

import pytest
from library_sources import Counted

from voldetail.errors import InputError
from voldetail.library import cache
from voldetail.library.building.build import BuildProgress


def test_a_library_is_built_once_and_again_when_it_is_damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VOLDETAIL_CACHE", str(tmp_path / "some" / "where"))
    seen: list[BuildProgress] = []
    first = cache.cached([Counted()], 9, "small", workers=1, on_progress=seen.append)
    assert first.header.path.parent == tmp_path / "some" / "where"
    assert first.header.path.name.startswith("small-")
    count = len(seen)
    assert count > 1
    again = cache.cached([Counted()], 9, "small", workers=1, on_progress=seen.append)
    assert (len(seen), again.header.sha256) == (count, first.header.sha256)
    (first.header.path / "counted" / "norms" / "c" / "0" / "0").write_bytes(b"")
    again = cache.cached([Counted()], 9, "small", workers=1, on_progress=seen.append)
    assert len(seen) > count
    assert again.header.sha256 == first.header.sha256
    assert len(list(first.header.path.parent.iterdir())) == 1


def test_all_that_decides_a_library_is_in_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    paths = [
        cache.cached_path(*asked)
        for asked in (
            ([Counted()], 9), ([Counted()], 10), ([Counted(seed=1)], 9), ([Counted("other")], 9), ([Counted(keys=("a",))], 9),
            ([Counted(), Counted("other")], 9), ([Counted()], 9, "another"),
        )
    ]  # fmt: skip
    monkeypatch.setattr("voldetail.library.vectors.VECTORS_VERSION", 2)
    paths.append(cache.cached_path([Counted()], 9))
    monkeypatch.undo()
    monkeypatch.setattr("voldetail.metric.gabor.REACH", 2.6)
    paths.append(cache.cached_path([Counted()], 9))
    assert len(set(paths)) == len(paths)


def test_the_folder_is_the_users_unless_it_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("VOLDETAIL_CACHE", raising=False)
    assert cache.cache_folder().name == "voldetail"
    monkeypatch.setenv("VOLDETAIL_CACHE", "elsewhere")
    assert cache.cache_folder() == Path("elsewhere")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("VOLDETAIL_CACHE", str(tmp_path / "file" / "under"))
    with pytest.raises(InputError, match="name another in VOLDETAIL_CACHE"):
        cache.cached([Counted()], 9)
