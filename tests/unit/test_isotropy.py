"""The test of isotropy: how often it is wrong about isotropic fields, what it sees, and what it says about photos."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from voldetail.errors import InputError
from voldetail.image import load_photo, luminance
from voldetail.texture import isotropy
from voldetail.texture.isotropy import EFFECT, isotropy_of


def gaussian_field(side: int, slope: float, seed: int, stretch: float = 1.0, square: bool = False) -> np.ndarray:
    """A part of a Gaussian field of power |f|^-slope, its frequencies stretched along 0.4 radians; not periodic."""
    n = 2 * side
    fx, fy = np.meshgrid(np.fft.rfftfreq(n), np.fft.fftfreq(n))
    c, s = np.cos(0.4), np.sin(0.4)
    u, v = (fx * c + fy * s) * np.sqrt(stretch), (fy * c - fx * s) / np.sqrt(stretch)
    radius = np.maximum(np.abs(fx), np.abs(fy)) if square else np.hypot(u, v)
    filtered = np.maximum(radius, 1 / n) ** (-slope / 2)
    filtered[0, 0] = 0
    white = np.random.default_rng(seed).standard_normal((n, n))
    return np.fft.irfft2(np.fft.rfft2(white) * filtered, s=(n, n))[:side, :side]


@pytest.mark.parametrize("slope", [0.0, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("side", [64, 160])
def test_isotropic_fields_pass(side: int, slope: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # Without the size of effect: what the statistics alone get wrong.
    monkeypatch.setattr(isotropy, "EFFECT", 0.0)
    wrong = sum(not isotropy_of(gaussian_field(side, slope, seed)).isotropic for seed in range(40))
    assert wrong <= 3


def test_a_stretched_field_is_seen() -> None:
    for stretch, least in ((1.5, 6), (2.0, 12)):
        found = [isotropy_of(gaussian_field(256, 2.0, seed, stretch)) for seed in range(12)]
        assert sum(f.statistic > 0.8 * EFFECT for f in found) >= least
    assert not any(f.isotropic for f in found)


def test_a_hardly_stretched_field_is_let_pass() -> None:
    assert all(isotropy_of(gaussian_field(256, 2.0, seed, 1.1)).isotropic for seed in range(6))


def test_square_bands_count_as_isotropic() -> None:
    assert all(isotropy_of(gaussian_field(192, 3.0, seed, square=True)).isotropic for seed in range(6))


def test_a_mask_and_its_shape_are_no_direction() -> None:
    mask = np.zeros((256, 256), bool)
    mask[40:200, 20:240] = True
    mask[90:130, 60:100] = False
    x = np.mgrid[:256, :256][1]
    field = np.where(mask, gaussian_field(256, 2.0, 5), 50 * np.sin(x))
    assert isotropy_of(field, mask).isotropic
    stripes = np.where(mask, gaussian_field(256, 2.0, 5) + 30 * np.sin(0.5 * x), 0.0)
    assert not isotropy_of(stripes, mask).isotropic


def test_scale_mean_and_a_quarter_turn_change_nothing() -> None:
    field = gaussian_field(128, 2.0, 3, 1.6)
    first = isotropy_of(field)
    assert isotropy_of(5 * field - 3).statistic == pytest.approx(first.statistic)
    assert isotropy_of(np.rot90(field)).statistic == pytest.approx(first.statistic, rel=0.02)


def test_the_record_says_what_was_found() -> None:
    x = np.mgrid[:128, :128][1]
    found = isotropy_of(np.sin(x * 2 * np.pi / 12.0) + 0.1 * np.random.default_rng(1).standard_normal((128, 128)))
    assert not found.isotropic
    assert found.threshold >= EFFECT
    assert "has a direction" in found.sentence
    assert "8 to 16 texels" in found.sentence
    assert sum(share for _, share, _ in found.bands) == pytest.approx(1)
    assert found.bands[0][0] == 4.0
    assert "all directions" in isotropy_of(gaussian_field(128, 2.0, 1)).sentence


@pytest.mark.parametrize(
    ("name", "isotropic"),
    [
        ("skimage_gravel/gravel.png", True), ("skimage_grass/grass.png", True), ("skimage_brick/brick.png", False),
        ("ns_bark/photo.jpg", False), ("ns_sand_ripples/photo.jpg", False), ("ns_cracked_ground/photo.jpg", True),
        ("nmo_wicker/photo.jpg", False), ("nmo_stone_slab/photo.jpg", True), ("flash_train_0253/flash.jpg", False),
    ],
)  # fmt: skip
def test_photos(shared_data: Path, name: str, isotropic: bool) -> None:
    grey = luminance(load_photo(shared_data / "photos" / name).pixels)[:512, :512].astype(float)
    order = grey.ravel().argsort(kind="stable").argsort(kind="stable")
    found = isotropy_of(norm.ppf((order + 0.5) / grey.size).reshape(grey.shape))
    assert found.isotropic == isotropic, found.sentence


def test_a_constant_channel_is_refused() -> None:
    with pytest.raises(InputError, match="same everywhere"):
        isotropy_of(np.ones((64, 64)))
