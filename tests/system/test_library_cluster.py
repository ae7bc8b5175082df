"""A library built by a Dask cluster, of which a worker is killed and then the scheduler goes away."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from voldetail.errors import InputError
from voldetail.library import StructureSource
from voldetail.library.building.build import BuildProgress, build, part_of
from voldetail.texture.structures import MODELS

distributed = pytest.importorskip("distributed")

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [StructureSource(MODELS["star"], side=104)]
COUNT, CHUNK = 32, 2


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return files_of(build(SOURCES, COUNT, tmp_path_factory.mktemp("expected") / "lib", workers=1))


@dataclass(frozen=True)
class Cluster:
    """A scheduler and two workers, processes of their own."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]]


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    said = tmp_path / "scheduler.json"
    # A try to reach a worker that was killed is over soon.
    settings = {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "2s", "PYTHONPATH": str(ROOT)}

    def start(*words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", *words, "--scheduler-file", str(said), "--no-dashboard"]
        return subprocess.Popen(command, cwd=tmp_path, env=os.environ | settings, stderr=subprocess.DEVNULL)

    processes = [start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0")]
    try:
        processes += [start("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1") for _ in range(2)]
        end = time.monotonic() + 60
        while not said.exists():
            assert processes[0].poll() is None
            assert time.monotonic() < end
            time.sleep(0.05)
        address = json.loads(said.read_text())["address"]
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield Cluster(address, processes[0], processes[1:])
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_killed_worker_and_a_scheduler_that_goes_away_lose_nothing(
    cluster: Cluster, tmp_path: Path, expected: dict[str, bytes]
) -> None:
    killed = []

    def kill_a_worker(progress: BuildProgress) -> None:
        if progress.done >= COUNT // 4 and not killed:
            cluster.workers[0].kill()
            killed.append(progress.done)

    found = build(SOURCES, COUNT, tmp_path / "one", chunk=CHUNK, scheduler=cluster.address, on_progress=kill_a_worker)
    assert killed
    assert killed[0] < COUNT
    assert cluster.workers[0].wait(10) == -signal.SIGKILL
    assert files_of(found) == expected

    def kill_the_scheduler(progress: BuildProgress) -> None:
        if progress.done >= COUNT // 4:
            cluster.scheduler.kill()

    lib = tmp_path / "two"
    with pytest.raises(InputError, match=r"scheduler tcp://.* went away; what is done is kept"):
        build(SOURCES, COUNT, lib, chunk=CHUNK, scheduler=cluster.address, on_progress=kill_the_scheduler)
    kept = len(list(part_of(lib).rglob("*.chunk")))
    assert COUNT // CHUNK // 4 <= kept < COUNT // CHUNK
    assert files_of(build(SOURCES, COUNT, lib, chunk=CHUNK, workers=1)) == expected


def test_a_scheduler_that_is_not_there_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voldetail.library.building.cluster.CONNECT_SECONDS", 0.2)
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
