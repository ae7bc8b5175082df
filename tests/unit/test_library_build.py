"""Building libraries: the same bytes however it was done, and nothing lost when something goes wrong."""

import multiprocessing
import resource
from dataclasses import replace
from pathlib import Path

import pytest
from library_sources import Counted, files_of

from voldetail.errors import InputError
from voldetail.library.building.build import BuildProgress, build, part_of
from voldetail.library.building.plan import Plan
from voldetail.library.building.source import Source, StructureSource
from voldetail.library.building.staging import Staging
from voldetail.texture.structures import MODELS

SOURCES = (Counted(), Counted("other", keys=("a",), seed=7, parallel=False))
COUNTS = (90, 17)


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return files_of(build(SOURCES, COUNTS, tmp_path_factory.mktemp("expected") / "lib", workers=1, chunk=10))


def test_any_number_of_workers_and_any_chunks_give_the_same_bytes(tmp_path: Path, expected: dict[str, bytes]) -> None:
    seen: list[BuildProgress] = []
    path = build(SOURCES, COUNTS, tmp_path / "lib", workers=2, chunk=7, on_progress=seen.append)
    assert files_of(path) == expected
    assert [p.name for p in tmp_path.iterdir()] == ["lib"]
    done = [p.done for p in seen if p.stage == "computing"]
    assert done == sorted(done)
    assert (done[0], done[-1], seen[-1].total) == (0, 107, 107)
    assert seen[0].seconds_left is None
    assert seen[2].seconds_left is not None
    assert multiprocessing.active_children() == []


def test_structures_are_the_same_from_one_process_and_from_two(tmp_path: Path) -> None:
    sources = [StructureSource(MODELS[name], side=104) for name in ("star", "cellular grid")]
    one, two = (build(sources, 10, tmp_path / str(n), workers=n, chunk=4) for n in (1, 2))
    assert files_of(one) == files_of(two)


def test_a_stopped_build_goes_on(tmp_path: Path, expected: dict[str, bytes]) -> None:
    stopping = (replace(SOURCES[0], trouble="stop", at=55, marks=tmp_path), SOURCES[1])
    lib = tmp_path / "lib"
    with pytest.raises(KeyboardInterrupt):
        build(stopping, COUNTS, lib, workers=1, chunk=10)
    kept = sorted(part_of(lib).rglob("*.chunk"))
    assert len(kept) == 5
    assert not lib.exists()
    # Cut off, altered, and one of the right length that is not what it was.
    kept[0].write_bytes(kept[0].read_bytes()[:-1])
    broken = bytearray(kept[1].read_bytes())
    broken[1000] ^= 1
    kept[1].write_bytes(broken)
    seen: list[BuildProgress] = []
    build(stopping, COUNTS, lib, workers=1, chunk=10, on_progress=seen.append)
    assert seen[0].done == 30
    assert files_of(lib) == expected
    assert not part_of(lib).exists()


def test_a_process_that_is_killed_is_replaced(tmp_path: Path, expected: dict[str, bytes]) -> None:
    dying = (replace(SOURCES[0], trouble="die", at=55, times=2, marks=tmp_path), SOURCES[1])
    assert files_of(build(dying, COUNTS, tmp_path / "lib", workers=2, chunk=10)) == expected
    assert len(list(tmp_path.glob("mark*"))) == 2


def test_a_chunk_that_kills_every_process_is_given_up(tmp_path: Path) -> None:
    dying = replace(SOURCES[0], trouble="die", at=55, times=99, marks=tmp_path)
    with pytest.raises(InputError, match=r"3 processes ended while they computed entries 50 to 59 of counted.*signal 9.*kept"):
        build([dying], 90, tmp_path / "lib", workers=2, chunk=10)
    assert len(list(part_of(tmp_path / "lib").rglob("*.chunk"))) >= 5
    assert multiprocessing.active_children() == []


@pytest.mark.parametrize(
    ("trouble", "workers", "error", "says"),
    [
        ("refuse", 1, InputError, "There is no such entry"),
        ("refuse", 2, InputError, "There is no such entry"),
        ("fail", 1, ZeroDivisionError, "by nothing"),
        ("fail", 2, RuntimeError, "counted, entries from 30 on: ZeroDivisionError: by nothing"),
        ("nan", 1, InputError, "Entry 55 of counted has numbers that are NaN"),
    ],
)
def test_what_a_source_raises_is_raised(trouble: str, workers: int, error: type[Exception], says: str, tmp_path: Path) -> None:
    failing = replace(SOURCES[0], trouble=trouble, at=55, marks=tmp_path)
    with pytest.raises(error, match=says):
        build([failing], 90, tmp_path / "lib", workers=workers, chunk=30)


def test_a_full_disk_is_one_sentence_and_keeps_the_chunks(tmp_path: Path, expected: dict[str, bytes]) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        # Less than a chunk, then more than that and less than the library's.
        for most, says in ((20_000, r"Cannot write in .*lib\.part: .*kept: free some space"), (100_000, "entries are kept")):
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, limits[1]))
            with pytest.raises(InputError, match=says):
                build(SOURCES, COUNTS, tmp_path / "lib", workers=1, chunk=10)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not (tmp_path / "lib").exists()
    again = replace(SOURCES[0], trouble="refuse", at=0, marks=tmp_path)  # nothing has to be computed again
    assert files_of(build((again, SOURCES[1]), COUNTS, tmp_path / "lib", chunk=10)) == expected


def test_chunks_of_another_plan_are_left_alone(tmp_path: Path) -> None:
    lib = tmp_path / "lib"
    stopping = replace(SOURCES[0], trouble="stop", at=55, marks=tmp_path)
    with pytest.raises(KeyboardInterrupt):
        build([stopping], 90, lib, workers=1)
    for source, count in ((Counted(seed=1), 90), (Counted(), 91), (SOURCES[1], 90)):
        with pytest.raises(InputError, match=r"lib\.part holds chunks of another library.*delete the folder"):
            build([source], count, lib)
    assert part_of(lib).is_dir()


def test_two_builds_do_not_work_in_one_folder(tmp_path: Path) -> None:
    staging = Staging(part_of(tmp_path / "lib"), Plan((Counted(),), (90,)))
    with pytest.raises(InputError, match="Another process builds in"):
        build([Counted()], 90, tmp_path / "lib")
    staging.close()
    build([Counted()], 90, tmp_path / "lib", workers=1)


def test_what_is_there_is_replaced_on_request_only_and_only_a_library(tmp_path: Path) -> None:
    lib = build([Counted()], 8, tmp_path / "lib")
    before = files_of(lib)
    with pytest.raises(InputError, match="it is there already; give another, or --force"):
        build([Counted(seed=1)], 8, lib)
    assert files_of(lib) == before
    build([Counted(seed=1)], 8, lib, force=True)
    assert files_of(lib) != before
    assert [p.name for p in tmp_path.iterdir()] == ["lib"]
    other = tmp_path / "folder"
    other.mkdir()
    (other / "mine.txt").write_text("mine")
    for target in (other, other / "mine.txt"):
        with pytest.raises(InputError, match="no library of voldetail's"):
            build([Counted()], 8, target, force=True)
    (tmp_path / "link").symlink_to(lib)
    with pytest.raises(InputError, match="no library of voldetail's"):
        build([Counted()], 8, tmp_path / "link", force=True)
    assert (other / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("sources", "counts", "complaint"),
    [
        ([], 5, "1 to 100 are allowed"),
        ([Counted(), Counted(seed=1)], 5, "counted is there twice"),
        ([Counted("../up")], 5, "cannot be called '../up'"),
        ([Counted(keys=())], 5, "have 0 numbers"),
        ([Counted()], 0, "0 entries of counted"),
        ([Counted()], 20_000_001, "1 to 20000000"),
        ([Counted()], [5, 6], "2 numbers of entries are given for 1 sources"),
        ([StructureSource(MODELS["star"], sampling="grid")], 45, "and it has 44"),
    ],
)
def test_plans_that_are_not_possible(sources: list[Source], counts: int | list[int], complaint: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=complaint):
        build(sources, counts, tmp_path / "lib")
    assert not list(tmp_path.iterdir())


def test_pictures_too_small_for_all_scales_are_refused() -> None:
    with pytest.raises(InputError, match="lack scales; at least 103"):
        StructureSource(MODELS["star"], side=64)
