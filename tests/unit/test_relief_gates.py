"""What of a photo is read as shading: not paint by its colour, not what is burnt out, not what the mask leaves out."""

import numpy as np

from tests.unit.relief_examples import distant, lambert, smooth_noise
from voldetail.recover.evidence import evidence
from voldetail.recover.gates import gate

SHAPE = (128, 160)
ALL = np.ones(SHAPE, bool)


def coloured(light: np.ndarray, colour: np.ndarray | tuple[float, float, float] = (1.0, 1.0, 1.0)) -> np.ndarray:
    return (0.3 * light[..., None] * np.asarray(colour)).astype(np.float32)


def test_grey_shading_is_kept() -> None:
    shading = 1 + 0.2 * smooth_noise(SHAPE, 8.0)
    found = gate(coloured(shading, (1.1, 1.0, 0.8)), ALL)
    assert found.paint < 0.05
    assert np.corrcoef(found.detail.ravel(), shading.ravel())[0, 1] > 0.95


def test_paint_that_has_a_colour_is_taken_out() -> None:
    pattern, shading = smooth_noise(SHAPE, 8.0, 1), 0.05 * smooth_noise(SHAPE, 8.0, 2)
    red = np.exp(0.3 * pattern[..., None] * np.array([1.0, 0.5, 0.2]))
    found = gate((0.3 * (1 + shading)[..., None] * red).astype(np.float32), ALL)
    assert found.paint > 0.8
    left = np.corrcoef(found.detail.ravel(), pattern.ravel())[0, 1]
    assert abs(left) < 0.5
    assert np.corrcoef(found.detail.ravel(), shading.ravel())[0, 1] > 0.6


def test_exposure_changes_nothing() -> None:
    pixels = coloured(1 + 0.2 * smooth_noise(SHAPE, 8.0))
    assert np.allclose(gate(pixels, ALL).detail, gate(pixels * 0.25, ALL).detail, atol=1e-3)


def test_what_is_burnt_out_counts_for_nothing() -> None:
    pixels = coloured(1 + 0.2 * smooth_noise(SHAPE, 8.0))
    pixels[:, :80] = 1.0
    found = gate(pixels, ALL)
    assert found.burnt == 0.5
    assert found.weight[:, :80].max() == 0
    assert np.abs(found.detail[:, :60]).max() < 0.05


def test_outside_the_mask_there_is_nothing() -> None:
    used = ALL.copy()
    used[40:80, 40:80] = False
    pixels = coloured(1 + 0.2 * smooth_noise(SHAPE, 8.0))
    pixels[~used] = 0.9
    found = gate(pixels, used)
    assert np.all(found.detail[~used] == 0)
    alone = gate(np.where(used[..., None], pixels, 0.0).astype(np.float32), used)
    assert np.allclose(found.detail, alone.detail, atol=1e-3)


class TestEvidence:
    """Statistical, fixed seeds: one half for shading under the right light, none for paint, below for a light from the side."""

    def test_shading_is_a_half(self) -> None:
        light = lambert(0.5 * smooth_noise((256, 256), 8.0, 5), 30, 45)
        found = evidence(light / light.mean() - 1, np.ones((256, 256), np.float32), distant((256, 256), 30, 45))
        assert found.ratio is not None
        assert abs(found.ratio - 0.5) < 0.08
        assert found.confidence > 0.8
        assert found.notes == ()

    def test_paint_is_none(self) -> None:
        found = evidence(0.2 * smooth_noise((256, 256), 8.0, 6), np.ones((256, 256), np.float32), distant((256, 256), 30, 45))
        assert found.ratio is not None
        assert abs(found.ratio) < 0.06
        assert "Little relief" in found.notes[0]

    def test_a_light_from_elsewhere_contradicts(self) -> None:
        light = lambert(0.5 * smooth_noise((256, 256), 8.0, 5), 120, 45)
        found = evidence(light / light.mean() - 1, np.ones((256, 256), np.float32), distant((256, 256), 30, 45))
        assert found.ratio is not None
        assert found.ratio < -0.3
        assert found.confidence == 0
        assert "contradicts" in found.notes[0]

    def test_an_even_photo_and_a_light_in_front_are_said(self) -> None:
        ones = np.ones(SHAPE, np.float32)
        assert "even" in evidence(0 * ones, ones, distant(SHAPE, 30, 45)).notes[0]
        assert "front" in evidence(0.2 * smooth_noise(SHAPE, 8.0), ones, distant(SHAPE, 0, 90)).notes[0]
