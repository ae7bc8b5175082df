"""A library built by a Dask cluster, of which a worker is killed and then the scheduler goes away."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from voldetail.errors import InputError
from voldetail.library import StructureSource
from voldetail.library.build import BuildProgress, build, part_of
from voldetail.texture.structures import MODELS

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

SOURCES = [StructureSource(MODELS["star"], side=104)]
COUNT, CHUNK = 96, 4


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return files_of(build(SOURCES, COUNT, tmp_path_factory.mktemp("expected") / "lib", workers=1))


@pytest.fixture
def cluster() -> Iterator[Any]:
    # Else half a minute is spent on asking the killed worker for what it had.
    with dask.config.set({"distributed.comm.timeouts.connect": "2s"}), distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as running:  # fmt: skip
        yield running


def test_a_killed_worker_and_a_scheduler_that_goes_away_lose_nothing(
    cluster: Any, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
        processes = list(client.run(os.getpid).values())
    assert len(set(processes)) == 2
    assert os.getpid() not in processes
    killed = []

    def kill(progress: BuildProgress) -> None:
        if progress.done >= COUNT // 4 and not killed:
            os.kill(processes[0], signal.SIGKILL)
            killed.append(progress.done)

    found = build(SOURCES, COUNT, tmp_path / "one", chunk=CHUNK, scheduler=cluster.scheduler_address, on_progress=kill)
    assert killed
    assert killed[0] < COUNT
    assert files_of(found) == expected

    def leave(progress: BuildProgress) -> None:
        if progress.done >= COUNT // 4:
            cluster.close()

    lib = tmp_path / "two"
    with pytest.raises(InputError, match=r"scheduler tcp://.* went away; what is done is kept"):
        build(SOURCES, COUNT, lib, chunk=CHUNK, scheduler=cluster.scheduler_address, on_progress=leave)
    kept = len(list(part_of(lib).rglob("*.chunk")))
    assert COUNT // CHUNK // 4 <= kept < COUNT // CHUNK
    assert files_of(build(SOURCES, COUNT, lib, chunk=CHUNK, workers=1)) == expected


def test_a_scheduler_that_is_not_there_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voldetail.library.cluster.CONNECT_SECONDS", 0.2)
    for address, says in (
        ("tcp://127.0.0.1:9", "cannot be reached"), ("tcp://nowhere.invalid:80", "cannot be reached"), ("here", "is no address"),
        ("", "is no address"), ("file://x:1", "is no address"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=says):
            build(SOURCES, COUNT, tmp_path / "lib", scheduler=address)


def test_without_dask_it_says_how_to_install_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'voldetail\[cluster\]'"):
        build(SOURCES, COUNT, tmp_path / "lib", scheduler="tcp://127.0.0.1:8786")
