"""Which LLVM is given to Dr.Jit, and what is said where there is none."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from voldetail import backend
from voldetail.backend import BackendError, find_llvm, llvm_version

OLD_LLVM = Path("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, int | None]]:
    """A machine whose LLVM libraries are the entries: path to version, None where it cannot be loaded."""
    libraries: dict[str, int | None] = {}
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(backend, "candidates", lambda: [Path(p) for p in libraries])
    monkeypatch.setattr(backend, "llvm_version", lambda path: libraries.get(str(path)))
    find_llvm.cache_clear()
    yield libraries
    find_llvm.cache_clear()


def test_the_newest_is_taken(machine: dict[str, int | None]) -> None:
    machine |= {"/a/libLLVM-15.so.1": 15, "/a/libLLVM.so.23.1": 23, "/b/libLLVM-19.so.1": 19}
    assert find_llvm() == Path("/a/libLLVM.so.23.1")


def test_a_newer_one_that_cannot_be_loaded_is_passed_over(machine: dict[str, int | None]) -> None:
    machine |= {"/a/libLLVM-20.so": None, "/b/libLLVM-19.so": 19}
    assert find_llvm() == Path("/b/libLLVM-19.so")


@pytest.mark.parametrize("version", [14, 15, 16, 17, 18, None])
def test_one_that_would_abort_is_never_taken(machine: dict[str, int | None], version: int | None) -> None:
    machine["/usr/lib/libLLVM.so.1"] = version
    with pytest.raises(BackendError, match="no LLVM of version 19 or newer was found") as refused:
        find_llvm()
    for way in ("pip install karellen-llvm-core", "apt install libllvm19", "brew install llvm", "DRJIT_LIBLLVM_PATH"):
        assert way in str(refused.value)


def test_none_at_all_says_what_to_install(machine: dict[str, int | None]) -> None:
    assert machine == {}
    with pytest.raises(BackendError, match="pip install karellen-llvm-core"):
        find_llvm()


def test_the_users_own_wins(machine: dict[str, int | None], monkeypatch: pytest.MonkeyPatch) -> None:
    machine |= {"/a/libLLVM.so.23": 23, "/own/libLLVM.so": 19}
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/own/libLLVM.so")
    assert find_llvm() == Path("/own/libLLVM.so")


@pytest.mark.parametrize("version", [15, 18])
def test_the_users_own_is_refused_when_too_old(
    machine: dict[str, int | None], monkeypatch: pytest.MonkeyPatch, version: int
) -> None:
    machine |= {"/a/libLLVM.so.23": 23, "/own/libLLVM.so": version}
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/own/libLLVM.so")
    with pytest.raises(BackendError, match=f"is LLVM {version}, which can abort Mitsuba: give 19 or newer, or unset"):
        find_llvm()


def test_the_users_own_is_refused_when_it_is_no_library(machine: dict[str, int | None], monkeypatch: pytest.MonkeyPatch) -> None:
    machine["/a/libLLVM.so.23"] = 23
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/own/nothing.so")
    with pytest.raises(BackendError, match=r"nothing[.]so cannot be loaded"):
        find_llvm()


def test_preparing_points_dr_jit_to_it(machine: dict[str, int | None]) -> None:
    machine["/a/libLLVM.so.23"] = 23
    backend.prepare()
    try:
        assert os.environ["DRJIT_LIBLLVM_PATH"] == "/a/libLLVM.so.23"
    finally:
        del os.environ["DRJIT_LIBLLVM_PATH"]


def test_preparing_without_one_is_silent(machine: dict[str, int | None]) -> None:
    backend.prepare()
    assert "DRJIT_LIBLLVM_PATH" not in os.environ


def test_no_library_has_no_version(tmp_path: Path) -> None:
    text = tmp_path / "libLLVM-19.so"
    text.write_text("not a library")
    assert llvm_version(text) is None
    assert llvm_version(tmp_path / "missing.so") is None


def test_an_unknown_variant_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VOLDETAIL_VARIANT", "scalar_rgb")
    with pytest.raises(BackendError, match="VOLDETAIL_VARIANT=scalar_rgb is not one of llvm_ad_rgb, cuda_ad_rgb"):
        backend.mitsuba.__wrapped__()


RENDER = """
import voldetail.backend
import voldetail.errors
try:
    mi = voldetail.backend.mitsuba()
    import drjit as dr
    print("result", dr.minimum(mi.Float(1, 2), mi.Float(2, 1)))
except voldetail.errors.VoldetailError as error:
    print("refused", error)
"""


def run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {k: v for k, v in os.environ.items() if k not in ("DRJIT_LIBLLVM_PATH", "VOLDETAIL_VARIANT")}
    return subprocess.run(
        [sys.executable, "-c", code], env=kept | environment, cwd=ROOT, capture_output=True, text=True, timeout=120,
        check=False,
    )  # fmt: skip


def test_importing_voldetail_sets_the_path_in_a_fresh_process() -> None:
    done = run("import os, voldetail; print(os.environ['DRJIT_LIBLLVM_PATH'])")
    assert done.returncode == 0, done.stderr
    version = llvm_version(Path(done.stdout.strip()))
    assert version is not None
    assert version >= backend.MINIMUM_LLVM


@pytest.mark.skipif(not OLD_LLVM.exists(), reason="this machine has no LLVM 15 to try it with")
def test_an_old_llvm_of_the_system_is_refused_and_aborts_nothing() -> None:
    assert llvm_version(OLD_LLVM) is None  # it does not say its version, which came with 16
    done = run(RENDER, DRJIT_LIBLLVM_PATH=str(OLD_LLVM))
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"refused DRJIT_LIBLLVM_PATH={OLD_LLVM} cannot be loaded")


@pytest.mark.skipif(not OLD_LLVM.exists(), reason="this machine has no LLVM 15 to try it with")
@pytest.mark.parametrize("first", ["drjit", "mitsuba"])
def test_an_llvm_that_was_loaded_before_us_is_refused_too(first: str) -> None:
    # What a program gets that imports Dr.Jit first, on a machine where that finds the system's LLVM 15.
    done = run(f"import {first}\n" + "import os; os.environ.pop('DRJIT_LIBLLVM_PATH', None)\n" + RENDER)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(("result", "refused Dr.Jit was imported before voldetail"))


THREADS = """
from pathlib import Path
import numpy as np
import voldetail.backend
from voldetail.image import save_exr
from voldetail.render.environment import environment_emitter
voldetail.backend.set_threads(1)
import drjit as dr
path = Path(r"{path}")
save_exr(path, np.ones((32, 64, 3), np.float32))
environment_emitter(path)
print("threads", dr.thread_count())
"""


def test_one_thread_reads_an_environment_map_and_waits_for_nobody(tmp_path: Path) -> None:
    """Mitsuba's reader of OpenEXR never came back where Dr.Jit had one thread."""
    done = run(THREADS.replace("{path}", str(tmp_path / "sky.exr")))
    assert (done.returncode, done.stdout) == (0, "threads 1\n"), done.stderr
