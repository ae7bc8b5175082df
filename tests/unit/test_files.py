"""Atomic writing and the checks before reading."""

import hashlib
import os
import resource
from pathlib import Path

import pytest

from voldetail.errors import InputError
from voldetail.files import atomic, readable, sha256, write_bytes, write_text


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_writes_the_data_under_the_name_and_leaves_nothing_else(tmp_path):
    write_text(tmp_path / "a.txt", "grün")
    assert (tmp_path / "a.txt").read_bytes() == "grün".encode()
    assert names(tmp_path) == ["a.txt"]


def test_the_temporary_file_lies_beside_with_the_same_suffix(tmp_path):
    with atomic(tmp_path / "a.png") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".png"
        assert temporary.name != "a.png"
        assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize("failure", [ValueError, KeyboardInterrupt])
def test_a_failure_in_the_block_keeps_the_old_file(tmp_path, failure):
    (tmp_path / "a").write_text("old")

    def fail_half_way():
        with atomic(tmp_path / "a") as temporary:
            temporary.write_text("half")
            raise failure

    with pytest.raises(failure):
        fail_half_way()
    assert (tmp_path / "a").read_text() == "old"
    assert names(tmp_path) == ["a"]


def test_a_full_disk_is_one_sentence_and_keeps_the_old_file(tmp_path):
    (tmp_path / "a").write_text("old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))  # the system's own "no more"
    try:
        with pytest.raises(InputError, match=r"Cannot write .*too large"):
            write_bytes(tmp_path / "a", bytes(100_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (tmp_path / "a").read_text() == "old"
    assert names(tmp_path) == ["a"]


@pytest.mark.parametrize("place", ["missing/a", "file/a", "folder"])
def test_a_place_that_cannot_be_written_is_refused(tmp_path, place):
    (tmp_path / "file").write_text("x")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="Cannot write"):
        write_bytes(tmp_path / place, b"x")
    assert names(tmp_path) == ["file", "folder"]


def test_a_device_is_not_replaced():
    with pytest.raises(InputError, match="not a regular file"):
        write_bytes(Path(os.devnull), b"x")
    assert not Path(os.devnull).is_file()


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to("target")
    write_text(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"


def test_a_new_file_has_the_permissions_of_the_umask(tmp_path):
    old = os.umask(0o027)
    try:
        write_text(tmp_path / "a", "x")
    finally:
        os.umask(old)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640


def test_sha256_is_that_of_the_content(tmp_path):
    (tmp_path / "a").write_bytes(b"abc" * 100_000)
    assert sha256(tmp_path / "a") == hashlib.sha256(b"abc" * 100_000).hexdigest()
    with pytest.raises(InputError):
        sha256(tmp_path / "missing")


def test_readable_refuses_what_is_no_file_of_the_right_size(tmp_path):
    (tmp_path / "empty").touch()
    (tmp_path / "large").write_bytes(bytes(101))
    (tmp_path / "right").write_bytes(bytes(100))
    os.mkfifo(tmp_path / "pipe")
    assert readable(tmp_path / "right", "photo", 100) == tmp_path / "right"
    for name, words in [
        ("missing", "does not exist"),
        ("", "is a folder"),
        ("empty", "0 bytes"),
        ("large", "more than"),
        ("pipe", "not a regular file"),
        ("a\0b", "Cannot read|does not exist"),
        ("a" * 5000, "Cannot read|does not exist"),
    ]:
        with pytest.raises(InputError, match=words):
            readable(tmp_path / name, "photo", 100)
