"""Relief files: maps and JSON back as they were, and what is said of files that are wrong."""

import json
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pydantic import ValidationError

from tests.unit.relief_examples import mapped
from voldetail.detail import Detail, Reflectance, save_detail
from voldetail.detail.photo_relief import PhotoRelief
from voldetail.detail.relief_maps import normals_of
from voldetail.errors import InputError, VoldetailError
from voldetail.image import save_exr
from voldetail.image.load import load_samples
from voldetail.image.png16 import save_png16
from voldetail.recover.files import load_any, load_relief, save_relief


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_relief(tmp_path, mapped())
    return tmp_path


def changed(folder: Path, **values: object) -> None:
    path = folder / "relief.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def test_a_relief_comes_back(folder: Path) -> None:
    made, read = mapped(), load_relief(folder)
    assert np.allclose(read.height, made.height, atol=1e-5)
    assert np.allclose(read.albedo, made.albedo, atol=2e-5)
    assert np.allclose(read.roughness, made.roughness, atol=1e-4)
    assert read.relief.amplitude == pytest.approx(0.1, rel=1e-5)
    assert read.record.notes == ()
    assert read.record.model_copy(update={"relief": made.record.relief, "maps": made.record.maps}) == made.record


def test_folder_file_and_detail_are_told_apart(folder: Path) -> None:
    assert load_any(folder).name == load_any(folder / "relief.json").name == "made"
    save_detail(folder / "noise.json", Detail(name="noise"))
    assert load_any(folder / "noise.json").name == "noise"


def test_an_edited_map_is_taken_and_said(folder: Path) -> None:
    save_png16(folder / "roughness.png", np.full((48, 64), 0.7))
    read = load_relief(folder)
    assert read.roughness.mean() == pytest.approx(0.7, abs=1e-3)
    assert read.record.notes == ("The roughness map roughness.png was changed after it was made.",)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"version": 99}, "version"),
        ({"columns": 63}, "64 x 48 pixels where"),
        ({"confidence": 2.0}, "confidence"),
        ({"texels_per_unit": 0}, "texels_per_unit"),
        ({"surprise": 1}, "surprise"),
        ({"maps": {}}, "maps"),
        ({"reflectance": {"speckle": 0.5}}, "speckle"),
    ],
)
def test_a_wrong_file_is_refused_in_one_sentence(folder: Path, values: dict[str, object], words: str) -> None:
    changed(folder, **values)
    with pytest.raises(InputError) as refused:
        load_relief(folder)
    assert words in str(refused.value)
    assert str(refused.value).count("\n") == 0


def test_a_path_out_of_the_folder_is_refused(folder: Path) -> None:
    data = json.loads((folder / "relief.json").read_text())
    data["maps"]["height"]["path"] = "../height.exr"
    changed(folder, maps=data["maps"])
    with pytest.raises(InputError, match=r"maps\.height\.path"):
        load_relief(folder)


def test_missing_flat_and_damaged_maps_are_refused(folder: Path) -> None:
    save_exr(folder / "height.exr", np.full((48, 64), 0.2, np.float32))
    with pytest.raises(InputError, match="is flat"):
        load_relief(folder)
    (folder / "height.exr").write_bytes(b"not a picture")
    with pytest.raises(InputError, match="height"):
        load_relief(folder)
    (folder / "height.exr").unlink()
    with pytest.raises(InputError, match="does not exist"):
        load_relief(folder)
    with pytest.raises(InputError, match="does not exist"):
        load_relief(folder / "elsewhere")


def test_a_record_has_relief_and_its_patterns_in_maps() -> None:
    record = mapped().record
    with pytest.raises(ValidationError, match="flat photo"):
        PhotoRelief.model_validate(record.model_dump() | {"relief": {"amplitude": 0.0}})
    with pytest.raises(ValidationError, match="cell_albedo"):
        PhotoRelief.model_validate(record.model_dump() | {"reflectance": Reflectance(cell_albedo=0.2).model_dump()})


class TestNormals:
    def test_of_a_plane(self) -> None:
        """Height 0.5 x + 0.25 y over a grid of 10 texels a unit: n = (-0.5, -0.25, 1) / 1.1456."""
        y, x = np.mgrid[0:12, 0:15] / 10.0
        found = normals_of((0.5 * x - 0.25 * y).astype(np.float32), 10.0)  # rows run down
        assert np.allclose(found, np.array([-0.5, -0.25, 1.0]) / 1.1456439, atol=1e-4)

    def test_of_a_tile(self) -> None:
        x = np.arange(32) / 32
        height = np.broadcast_to(np.sin(2 * np.pi * x), (16, 32)).astype(np.float32) * 0.1
        found = normals_of(height, 32.0, periodic=True)
        assert np.allclose(np.roll(found, 8, axis=1), normals_of(np.roll(height, 8, axis=1), 32.0, periodic=True))


class TestPng16:
    """Read back by a decoder of its own, and by Pillow where it can."""

    @staticmethod
    def decoded(path: Path) -> tuple[np.ndarray, dict[bytes, bytes]]:
        data, chunks, at = path.read_bytes(), {}, 8
        while at < len(data):
            (size,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
            body = data[at + 8 : at + 8 + size]
            assert struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0] == zlib.crc32(kind + body)
            chunks[kind] = chunks.get(kind, b"") + body
            at += 12 + size
        columns, rows, depth, colour = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
        assert depth == 16
        channels = {0: 1, 2: 3}[colour]
        raw = zlib.decompress(chunks[b"IDAT"])
        width, lines = columns * channels * 2, []
        for row in range(rows):
            kind_, line = raw[row * (width + 1)], np.frombuffer(raw[row * (width + 1) + 1 : (row + 1) * (width + 1)], np.uint8)
            assert kind_ == 2
            lines.append(line if row == 0 else (line + lines[-1]).astype(np.uint8))
        return np.stack(lines).view(">u2").reshape(rows, columns, channels), chunks

    def test_colours(self, tmp_path: Path) -> None:
        values = np.random.default_rng(0).random((7, 11, 3))
        save_png16(tmp_path / "a.png", values, srgb=True, text={"Title": "a"})
        found, chunks = self.decoded(tmp_path / "a.png")
        assert np.array_equal(found, np.rint(values * 65535))
        assert chunks[b"sRGB"] == b"\x00"
        assert chunks[b"tEXt"] == b"Title\x00a"
        assert np.allclose(load_samples(tmp_path / "a.png", "map").values, values, atol=1e-5)

    def test_grey(self, tmp_path: Path) -> None:
        values = np.linspace(-0.1, 1.1, 60).reshape(6, 10)
        save_png16(tmp_path / "a.png", values)
        assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), np.rint(np.clip(values, 0, 1) * 65535))

    def test_refused(self, tmp_path: Path) -> None:
        with pytest.raises(VoldetailError, match="NaN"):
            save_png16(tmp_path / "a.png", np.full((4, 4), np.nan))
        with pytest.raises(ValueError, match=r"\(4, 4, 2\)"):
            save_png16(tmp_path / "a.png", np.zeros((4, 4, 2)))
        assert not (tmp_path / "a.png").exists()
