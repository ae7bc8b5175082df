"""Photographs from files of every kind."""

import hashlib
import struct
import zlib

import numpy as np
import OpenEXR
import pytest
import tifffile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from voldetail.errors import InputError
from voldetail.image import load_photo, save_image, to_linear

SIZE = (40, 48)
FUZZ = settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
ORIENTATION = 0x0112


@pytest.fixture
def rgb():
    return np.random.default_rng(7).integers(0, 256, (*SIZE, 3), dtype=np.uint8)


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def deep_png(values) -> bytes:
    """A 16-bit PNG of (H, W, C) uint16, every second row with the Up filter."""
    height, width, channels = values.shape
    rows = values.astype(">u2").view(np.uint8).reshape(height, -1)
    lines = [b"\0" + rows[0].tobytes()]
    lines += [b"\2" + (rows[i] - rows[i - 1]).tobytes() if i % 2 else b"\0" + rows[i].tobytes() for i in range(1, height)]
    colour_type = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, colour_type, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"".join(lines))) + chunk(b"IEND", b"")


def lzw(data: bytes) -> bytes:
    """TIFF's LZW without any compression: a clear code often enough that all codes keep 9 bits."""
    codes: list[int] = []
    for i in range(0, len(data), 200):
        codes += [256, *data[i : i + 200]]
    bits = "".join(f"{code:09b}" for code in [*codes, 257])
    return int(bits.ljust(-(-len(bits) // 8) * 8, "0"), 2).to_bytes(-(-len(bits) // 8), "big")


def lzw_tiff(values, order: str) -> bytes:
    """A 16-bit RGB TIFF compressed with LZW, in one strip."""
    height, width, _ = values.shape
    strip = lzw(values.astype(f"{order}u2").tobytes())
    entries = [(256, 4, 1, width), (257, 4, 1, height), (258, 3, 3, 0), (259, 3, 1, 5), (262, 3, 1, 2)]
    entries += [(273, 4, 1, 0), (277, 3, 1, 3), (278, 4, 1, height), (279, 4, 1, len(strip))]
    after = 8 + 2 + 12 * len(entries) + 4
    places = {258: after, 273: after + 6}
    table = b"".join(
        struct.pack(order + "HHI", tag, kind, n)
        + (struct.pack(order + "HH", v, 0) if kind == 3 and n == 1 else struct.pack(order + "I", places.get(tag, v)))
        for tag, kind, n, v in entries
    )
    start = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(order + "IH", 8, len(entries))
    return start + table + bytes(4) + struct.pack(order + "HHH", 16, 16, 16) + strip


@pytest.mark.parametrize("name", ["a.png", "a.bmp", "a.tif", "a.webp", "a.ppm", "wrong-suffix.jpg"])
def test_eight_bits_are_read_as_srgb(tmp_path, rgb, name):
    path = tmp_path / name
    kind = {"a.webp": {"format": "WEBP", "lossless": True}, "wrong-suffix.jpg": {"format": "PNG"}}.get(name, {})
    Image.fromarray(rgb).save(path, **kind)
    photo = load_photo(path)
    assert photo.pixels.dtype == np.float32
    np.testing.assert_array_equal(photo.pixels, to_linear(rgb / 255))
    np.testing.assert_allclose(load_photo(path, encoding="linear").pixels, rgb / 255, rtol=1e-6)
    assert photo.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert photo.notes == ()
    assert photo.opaque is None


def test_jpeg_is_near(tmp_path):
    smooth = np.tile(np.arange(48, dtype=np.uint8) * 5, (40, 1))
    Image.fromarray(smooth).save(tmp_path / "a.jpg", quality=95)
    photo = load_photo(tmp_path / "a.jpg")
    assert "grey" in photo.notes
    assert np.abs(photo.pixels - to_linear(smooth / 255)[..., None]).max() < 0.03


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_sixteen_bit_png_keeps_all_bits(tmp_path, channels):
    values = np.random.default_rng(channels).integers(0, 65536, (*SIZE, channels)).astype(np.uint16)
    if channels in (2, 4):
        values[..., -1] = 65535
    (tmp_path / "a.png").write_bytes(deep_png(values))
    pixels = load_photo(tmp_path / "a.png", encoding="linear").pixels
    expected = values[..., :3] if channels > 2 else values[..., :1].repeat(3, axis=2)
    np.testing.assert_allclose(pixels, expected / 65535, rtol=1e-6)
    np.testing.assert_array_equal(load_photo(tmp_path / "a.png").pixels, to_linear(expected / 65535))


@pytest.mark.parametrize("byteorder", ["<", ">"])
@pytest.mark.parametrize("how", ["stored", "zlib", "lzw", "grey"])
def test_sixteen_bit_tiff_keeps_all_bits(tmp_path, byteorder, how):
    values = np.random.default_rng(2).integers(0, 65536, (*SIZE, 3)).astype(np.uint16)
    if how == "lzw":
        (tmp_path / "a.tif").write_bytes(lzw_tiff(values, byteorder))
    elif how == "grey":
        values = values[..., :1].repeat(3, axis=2)
        tifffile.imwrite(tmp_path / "a.tif", values[..., 0], byteorder=byteorder)
    else:
        compression = None if how == "stored" else how
        tifffile.imwrite(tmp_path / "a.tif", values, byteorder=byteorder, compression=compression, photometric="rgb")
    pixels = load_photo(tmp_path / "a.tif", encoding="linear").pixels
    np.testing.assert_allclose(pixels, values / 65535, rtol=1e-6)


@pytest.mark.parametrize("dtype", ["float16", "float32"])
@pytest.mark.parametrize("options", [{}, {"compression": "zlib"}, {"planarconfig": "separate"}, {"tile": (16, 16)}])
def test_float_tiff_is_linear(tmp_path, dtype, options):
    values = (np.random.default_rng(2).random((*SIZE, 3)) * 4).astype(dtype)
    stored = np.moveaxis(values, -1, 0) if "planarconfig" in options else values
    tifffile.imwrite(tmp_path / "a.tif", stored, photometric="rgb", **options)
    np.testing.assert_array_equal(load_photo(tmp_path / "a.tif").pixels, values.astype(np.float32))
    np.testing.assert_allclose(load_photo(tmp_path / "a.tif", encoding="srgb").pixels, to_linear(values), rtol=1e-5)


@pytest.mark.parametrize("compression", ["DWAB", "DWAA", "PIZ", "ZIP", "RLE", "B44", "PXR24"])
def test_exr_is_linear_with_any_compression(tmp_path, compression):
    y, x = np.mgrid[0:64, 0:64] / 64
    values = np.stack([x, y, 3 * x * y], axis=-1).astype(np.float16)
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": values}).write(str(tmp_path / "a.exr"))
    np.testing.assert_allclose(load_photo(tmp_path / "a.exr").pixels, values, atol=0.02)


def write_exr(path, **channels):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {k: np.ascontiguousarray(v) for k, v in channels.items()}).write(str(path))


def test_exr_with_nan_is_refused_with_their_number_and_the_first(tmp_path, capfd):
    planes = {name: np.ones(SIZE, dtype=np.float32) for name in "RGB"}
    planes["G"][5, 7], planes["R"][9, 2], planes["B"][9, 2] = np.nan, np.inf, -np.inf
    write_exr(tmp_path / "a.exr", **planes)
    with pytest.raises(InputError, match=r"2 pixels that are NaN or infinite, the first in column 7 of row 5"):
        load_photo(tmp_path / "a.exr")


def test_exr_negative_light_grey_and_wrong_channels(tmp_path):
    dark = np.full(SIZE, 0.5, dtype=np.float32)
    dark[3, 4] = -0.25
    write_exr(tmp_path / "y.exr", Y=dark)
    photo = load_photo(tmp_path / "y.exr")
    assert photo.notes == ("1 negative values set to 0", "grey")
    assert photo.pixels[3, 4].tolist() == [0, 0, 0]
    assert photo.pixels[3, 5].tolist() == [0.5, 0.5, 0.5]
    write_exr(tmp_path / "z.exr", Z=dark, U=dark)
    with pytest.raises(InputError, match=r"channels 'U, Z'; save it with R, G and B"):
        load_photo(tmp_path / "z.exr")


def test_damaged_exr_is_one_sentence_and_the_library_says_nothing(tmp_path, rgb, capfd):
    ramp = (np.mgrid[0:64, 0:64][0] / 64).astype(np.float32)[..., None].repeat(3, 2)
    save_image(tmp_path / "a.exr", ramp)
    data = (tmp_path / "a.exr").read_bytes()
    for wrong in (data[:-1], data[:400], data[:100], data[:-200] + bytes(200)):
        (tmp_path / "a.exr").write_bytes(wrong)
        with pytest.raises(InputError, match=r"photo .*a\.exr"):
            load_photo(tmp_path / "a.exr")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", ["png", "jpg", "tif", "lzw.tif", "float.tif"])
def test_exif_rotation_is_applied_once(tmp_path, orientation, suffix):
    upright = np.zeros(SIZE, dtype=np.uint8)
    upright[:16, :24], upright[:16, 24:], upright[16:, :24] = 250, 120, 60  # no two corners alike
    stored = {  # how a camera stores it so that the tag turns it upright, EXIF 2.3 section 4.6.4
        1: upright, 2: upright[:, ::-1], 3: upright[::-1, ::-1], 4: upright[::-1],
        5: upright.T, 6: np.rot90(upright, 1), 7: upright[::-1, ::-1].T, 8: np.rot90(upright, -1),
    }[orientation]  # fmt: skip
    path = tmp_path / f"a.{suffix}"
    if suffix == "float.tif":
        tags = [(274, "H", 1, orientation, True)]
        values = np.ascontiguousarray(to_linear(stored / 255))
        tifffile.imwrite(path, values, photometric="minisblack", extratags=tags)
    else:
        exif = Image.Exif()
        exif[ORIENTATION] = orientation
        Image.fromarray(np.ascontiguousarray(stored)).save(
            path, exif=exif, **({"compression": "tiff_lzw"} if suffix == "lzw.tif" else {})
        )
    photo = load_photo(path)
    assert photo.notes.count("rotated by EXIF") == (orientation != 1)
    np.testing.assert_allclose(photo.pixels[..., 0], to_linear(upright / 255), atol=0.03)


def test_cmyk_palette_and_one_bit_become_rgb(tmp_path, rgb):
    red = Image.new("CMYK", (48, 40), (0, 255, 255, 0))
    red.save(tmp_path / "cmyk.jpg", quality=95)
    photo = load_photo(tmp_path / "cmyk.jpg")
    assert "CMYK" in photo.notes[0]
    np.testing.assert_allclose(photo.pixels[5, 5], [1, 0, 0], atol=0.02)

    palette = Image.fromarray(rgb).quantize(16)
    palette.save(tmp_path / "palette.png")
    photo = load_photo(tmp_path / "palette.png")
    assert photo.notes == ("palette expanded",)
    np.testing.assert_array_equal(photo.pixels, to_linear(np.asarray(palette.convert("RGB")) / 255))

    Image.fromarray(rgb[..., 0] > 100).save(tmp_path / "one.png")
    np.testing.assert_array_equal(load_photo(tmp_path / "one.png").pixels[..., 0], rgb[..., 0] > 100)


def test_alpha_is_dropped_and_transparent_pixels_are_marked(tmp_path, rgb):
    alpha = np.full((*SIZE, 1), 255, dtype=np.uint8)
    alpha[2, 3], alpha[4, 5] = 0, 1
    Image.fromarray(np.concatenate([rgb, alpha], axis=2)).save(tmp_path / "a.png")
    photo = load_photo(tmp_path / "a.png")
    assert photo.notes == ("alpha dropped", "1 fully transparent pixels not used")
    assert photo.opaque is not None
    assert np.argwhere(~photo.opaque).tolist() == [[2, 3]]
    np.testing.assert_array_equal(photo.pixels, to_linear(rgb / 255))

    Image.fromarray(np.concatenate([rgb, alpha * 0], axis=2)).save(tmp_path / "b.png")
    with pytest.raises(InputError, match="fully transparent"):
        load_photo(tmp_path / "b.png")


def test_another_colour_profile_and_more_frames_are_noted(tmp_path, rgb):
    from PIL import ImageCms

    picture = Image.fromarray(rgb)
    srgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    picture.save(tmp_path / "s.png", icc_profile=srgb)
    assert load_photo(tmp_path / "s.png").notes == ()
    picture.save(tmp_path / "x.png", icc_profile=b"rubbish")
    assert load_photo(tmp_path / "x.png").notes == ("colour profile ignored (unreadable), read as sRGB",)
    picture.save(tmp_path / "a.tif", save_all=True, append_images=[picture])
    assert load_photo(tmp_path / "a.tif").notes == ("the first of 2 frames used",)


@pytest.mark.parametrize("shape", [(1, 1), (31, 200), (200, 31)])
def test_too_small_is_refused_and_the_smallest_is_not(tmp_path, shape):
    Image.new("RGB", shape[::-1]).save(tmp_path / "a.png")
    with pytest.raises(InputError, match=rf"{shape[1]} x {shape[0]} pixels; at least 32 a side"):
        load_photo(tmp_path / "a.png")
    Image.new("RGB", (32, 32)).save(tmp_path / "a.png")
    assert load_photo(tmp_path / "a.png").pixels.shape == (32, 32, 3)


@pytest.mark.parametrize("width", [10_001, 60_000, 2**31 - 1])
def test_over_100_megapixels_is_refused_from_the_header(tmp_path, width):
    # The header announces it; there is no pixel, so that a decoder that begins would complain of something
    # else.
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, 10_000, 8, 2, 0, 0, 0))
    png = b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
    (tmp_path / "a.png").write_bytes(png)
    with pytest.raises(InputError, match=r"100 allowed|100 megapixels allowed"):
        load_photo(tmp_path / "a.png")


def test_over_100_megapixels_exr_and_tiff(tmp_path):
    write_exr(tmp_path / "a.exr", Y=np.zeros(SIZE, dtype=np.float32))
    data = (tmp_path / "a.exr").read_bytes()
    window = struct.pack("<4i", 0, 0, 47, 39)
    (tmp_path / "a.exr").write_bytes(data.replace(window, struct.pack("<4i", 0, 0, 20_000, 20_000)))
    with pytest.raises(InputError, match="20001 x 20001 = 400 megapixels"):
        load_photo(tmp_path / "a.exr")

    tifffile.imwrite(tmp_path / "a.tif", np.zeros((40, 40_961), dtype=np.float32), photometric="minisblack")
    data = bytearray((tmp_path / "a.tif").read_bytes())
    at = data.index(struct.pack("<HHI", 257, 4, 1)) if struct.pack("<HHI", 257, 4, 1) in data else -1
    at = at if at >= 0 else data.index(struct.pack("<HHI", 257, 3, 1))
    data[at + 8 : at + 12] = struct.pack("<I", 40_000)
    (tmp_path / "a.tif").write_bytes(data)
    with pytest.raises(InputError, match=r"40000 = .* megapixels, more than|40000 x .* megapixels, more than"):
        load_photo(tmp_path / "a.tif")


def test_a_tiff_strip_that_unpacks_to_too_much_is_refused(tmp_path):
    values = np.zeros(SIZE, dtype=np.float32)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, values, compression="zlib", photometric="minisblack")
    assert load_photo(path).pixels.max() == 0
    with tifffile.TiffFile(path) as tiff:
        page = tiff.pages.first
        places = [(page.tags[tag].valueoffset) for tag in (273, 279)]
    bomb = zlib.compress(bytes(50_000_000))
    data = bytearray(path.read_bytes())
    for place, value in zip(places, (len(data), len(bomb)), strict=True):
        data[place : place + 4] = struct.pack("<I", value)
    path.write_bytes(data + bomb)
    with pytest.raises(InputError, match="unpacks to too much"):
        load_photo(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "0 bytes"),
        (b"hello, I am no picture\n" * 50, "not a picture in a format that is read"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 40 +X 48\n", "Radiance"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 100 100\n", "not a picture"),
        (b"\x89PNG\r\n\x1a\n", "not a picture"),
    ],
)
def test_what_is_no_photo_is_refused(tmp_path, content, words):
    (tmp_path / "a.png").write_bytes(content)
    with pytest.raises(InputError, match=words):
        load_photo(tmp_path / "a.png")


def test_missing_and_folder_are_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        load_photo(tmp_path / "a.png")
    with pytest.raises(InputError, match="is a folder"):
        load_photo(tmp_path)


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.webp", "a.exr", "f.tif", "deep.png"])
@pytest.mark.parametrize("part", [0.3, 0.7, 0.97])
def test_truncated_is_refused(tmp_path, rgb, name, part):
    path = tmp_path / name
    if name == "a.exr":
        save_image(path, rgb / 255)
    elif name == "f.tif":
        tifffile.imwrite(path, (rgb / 255).astype(np.float32), photometric="rgb")
    elif name == "deep.png":
        path.write_bytes(deep_png(rgb.astype(np.uint16) * 257))
    else:
        Image.fromarray(rgb).save(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    with pytest.raises(InputError):
        load_photo(path)


def valid_files(tmp_path_factory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("valid")
    y, x = np.mgrid[0:40, 0:48]
    picture = np.stack([x * 5, y * 6, x + y], axis=-1).astype(np.uint8)
    for suffix in ("png", "jpg", "tif", "webp", "gif", "bmp", "ppm"):
        Image.fromarray(picture).save(folder / f"a.{suffix}")
    Image.fromarray(picture).save(folder / "lzw.tif", compression="tiff_lzw")
    tifffile.imwrite(folder / "f.tif", (picture / 255).astype(np.float32), compression="zlib", photometric="rgb")
    (folder / "deep.png").write_bytes(deep_png(picture.astype(np.uint16) * 257))
    save_image(folder / "a.exr", picture / 255)
    header = {"compression": OpenEXR.DWAB_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": picture.astype(np.float16)}).write(str(folder / "dwab.exr"))
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return valid_files(tmp_path_factory)


def check_photo_or_sentence(path):
    """Load; either it is a usable photo, or InputError; whatever else is raised fails the test."""
    sentence = photo = None
    try:
        photo = load_photo(path)
    except InputError as error:
        sentence = str(error)
    if photo is None:
        assert str(path) in sentence
        assert "\n" not in sentence
    else:
        assert photo.pixels.shape[2] == 3
        assert np.isfinite(photo.pixels).all()
        assert photo.pixels.min() >= 0


MAGICS = [
    b"",
    b"\x89PNG\r\n\x1a\n",
    b"\xff\xd8\xff\xe0",
    b"II*\0\x08\0\0\0",
    b"MM\0*\0\0\0\x08",
    b"RIFF    WEBP",
]
MAGICS += [
    b"\x76\x2f\x31\x01\x02\0\0\0",
    b"GIF89a",
    b"BM",
    b"P6 40 40 255\n",
    b"#?RADIANCE\n",
    b"II+\0\x08\0\0\0",
]


@FUZZ
@given(
    start=st.sampled_from(MAGICS),
    rest=st.binary(max_size=400),
    suffix=st.sampled_from(["png", "jpg", "tif", "exr", "hdr", "webp", "gif", "bmp", ""]),
)
def test_arbitrary_bytes_never_raise_anything_else(tmp_path, start, rest, suffix):
    path = tmp_path / f"fuzz.{suffix}"
    path.write_bytes(start + rest)
    check_photo_or_sentence(path)


@settings(FUZZ, max_examples=400)
@given(data=st.data())
def test_corrupted_files_never_raise_anything_else(tmp_path, files, data):
    name = data.draw(st.sampled_from(sorted(files)))
    content = bytearray(files[name])
    for _ in range(data.draw(st.integers(1, 6))):
        # Headers matter most: half of the damage goes to the first 400 bytes.
        reach = data.draw(st.sampled_from([min(400, len(content)), len(content)]))
        content[data.draw(st.integers(0, reach - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(1, len(content)))]
    path = tmp_path / f"fuzz-{name}"
    path.write_bytes(content)
    check_photo_or_sentence(path)


@settings(FUZZ, max_examples=40)
@given(
    shape=st.tuples(st.integers(32, 50), st.integers(32, 50)),
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from(["png", "deep.png", "exr", "tif"]),
)
def test_round_trips(tmp_path, shape, seed, kind):
    rng = np.random.default_rng(seed)
    path = tmp_path / f"a.{kind}"
    if kind == "deep.png":
        values = rng.integers(0, 65536, (*shape, 3)).astype(np.uint16)
        path.write_bytes(deep_png(values))
        expected = to_linear(values / 65535)
    elif kind == "exr":
        expected = np.exp(rng.normal(0, 5, (*shape, 3))).astype(np.float32)
        save_image(path, expected)
    else:
        values = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
        Image.fromarray(values).save(path)
        expected = to_linear(values / 255)
    np.testing.assert_array_equal(load_photo(path).pixels, expected)
