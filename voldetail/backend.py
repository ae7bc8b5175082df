"""The only place that picks the Mitsuba variant, finds an LLVM that works, and sets threads."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from voldetail.errors import VoldetailError

MINIMUM_LLVM = 19
"""LLVM 15 and 16 abort the whole process at the first render ("Cannot select ... fminimum"); 19 and 23 work; 17 and 18
are not known, so they are not used."""

IMPLAUSIBLE_LLVM = 1000
"""A number in a library's name from which it is no version: a date, or a hash."""

CHOSEN: list[str] = []
"""The library that `prepare` chose by its name, so that it is not taken for the user's own choice."""

VARIANTS = ("llvm_ad_rgb", "cuda_ad_rgb")


class BackendError(VoldetailError):
    """No way to run Mitsuba on this machine; the text says what to install."""


@cache
def mitsuba() -> ModuleType:
    """Return the `mitsuba` module with its variant set: `VOLDETAIL_VARIANT` if given, else ``llvm_ad_rgb``.

    Raises BackendError if no usable LLVM is found (LLVM variants only) or the variant is unknown.
    """
    variant = os.environ.get("VOLDETAIL_VARIANT", VARIANTS[0])
    if variant not in VARIANTS:
        raise BackendError(f"VOLDETAIL_VARIANT={variant} is not one of {', '.join(VARIANTS)}: unset it or choose one")
    if variant.startswith("llvm"):
        os.environ["DRJIT_LIBLLVM_PATH"] = str(find_llvm())
    mi = import_module("mitsuba")
    if mi.variant() != variant:
        mi.set_variant(variant)
    if variant.startswith("llvm"):
        _refuse_loaded()
    mi.set_log_level(mi.LogLevel.Error)
    return mi


def _refuse_loaded() -> None:
    """Refuse the LLVM that Dr.Jit has loaded where a program imported Dr.Jit before voldetail could choose."""
    loaded = import_module("drjit").detail.llvm_version()
    if loaded and 0 < loaded[0] < MINIMUM_LLVM:
        raise BackendError(
            f"Dr.Jit was imported before voldetail and took LLVM {loaded[0]}, which can abort the process: import"
            " voldetail before drjit and mitsuba, or set DRJIT_LIBLLVM_PATH"
        )


def prepare() -> None:
    """Point Dr.Jit to a usable LLVM; called when voldetail is imported, since Dr.Jit reads the variable when it is.

    Where none is usable nothing happens yet: `mitsuba` says so when it is needed.
    """
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        return
    # By file names alone: an import starts no child process. `mitsuba` looks into the library before it is used.
    named = [path for path in candidates() if MINIMUM_LLVM <= _named_version(path) < IMPLAUSIBLE_LLVM]
    if named:
        CHOSEN[:] = [str(max(named, key=_named_version))]
        os.environ["DRJIT_LIBLLVM_PATH"] = CHOSEN[0]


def set_threads(count: int) -> None:
    """Limit the worker threads of Dr.Jit (0 = all cores)."""
    mitsuba()
    import_module("drjit").set_thread_count(count)


@contextmanager
def helpers_for_files() -> Iterator[None]:
    """Give Dr.Jit two worker threads at least while Mitsuba reads or writes OpenEXR, which with one waits for itself for ever."""
    mitsuba()
    drjit = import_module("drjit")
    count = drjit.thread_count()
    drjit.set_thread_count(max(count, 2))
    try:
        yield
    finally:
        drjit.set_thread_count(count)


@cache
def find_llvm() -> Path:
    """Return the LLVM library to use: the user's own, the wheel's, or the system's newest, each at least version 19.

    Raises BackendError with what to install; an LLVM that would abort the process is never returned.
    """
    own = os.environ.get("DRJIT_LIBLLVM_PATH")
    if own in CHOSEN:
        own = None  # not the user's
    if own:
        version = llvm_version(Path(own))
        if version is None:
            raise BackendError(
                f"DRJIT_LIBLLVM_PATH={own} cannot be loaded as an LLVM library, or is one older than 16, which aborts"
                f" Mitsuba: give {MINIMUM_LLVM} or newer, or unset it"
            )
        if version < MINIMUM_LLVM:
            raise BackendError(
                f"DRJIT_LIBLLVM_PATH={own} is LLVM {version}, which can abort Mitsuba: give {MINIMUM_LLVM} or newer, or unset it"
            )
        return Path(own)
    # Newest by its file name first, so that usually one library is asked.
    for path in sorted(candidates(), key=_named_version, reverse=True):
        version = llvm_version(path)
        if version is not None and version >= MINIMUM_LLVM:
            return path
    raise BackendError(
        f"no LLVM of version {MINIMUM_LLVM} or newer was found: install one with 'pip install karellen-llvm-core' "
        f"(Linux x86-64), 'apt install libllvm{MINIMUM_LLVM}' or 'brew install llvm', or set DRJIT_LIBLLVM_PATH to it"
    )


def candidates() -> list[Path]:
    """Return the LLVM libraries at the usual places: beside this Python first, then the system's."""
    places = [
        (Path(sys.prefix) / "lib", "libLLVM*.so*"),
        (Path("/usr/lib/x86_64-linux-gnu"), "libLLVM*.so*"),
        (Path("/usr/lib/aarch64-linux-gnu"), "libLLVM*.so*"),
        (Path("/usr/lib64"), "libLLVM*.so*"),
        (Path("/opt/homebrew/opt/llvm/lib"), "libLLVM*.dylib"),
        (Path("/usr/local/opt/llvm/lib"), "libLLVM*.dylib"),
        (Path(sys.prefix) / "Library" / "bin", "LLVM-C.dll"),
    ]
    places += [(folder, "libLLVM*.so*") for folder in sorted(Path("/usr/lib").glob("llvm-*/lib"))]
    found = {path.resolve() for folder, pattern in places if folder.is_dir() for path in folder.glob(pattern)}
    return sorted(found)


def _named_version(path: Path) -> int:
    numbers = re.findall(r"\d+", path.name)
    return int(numbers[0]) if numbers else 0


@cache
def llvm_version(path: Path) -> int | None:
    """Return the major version of an LLVM library, or None if it cannot be loaded or does not say (before 16).

    Asked in a child process: two LLVM libraries loaded side by side can clash.
    """
    try:
        result = subprocess.run(
            [sys.executable, "-I", "-c", _PROBE, str(path)], capture_output=True, text=True, timeout=60, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return int(result.stdout) if result.returncode == 0 and result.stdout.strip().isdigit() else None


_PROBE = """
import ctypes
import sys
major = ctypes.c_uint()
ctypes.CDLL(sys.argv[1]).LLVMGetVersion(ctypes.byref(major), None, None)
print(major.value)
"""
