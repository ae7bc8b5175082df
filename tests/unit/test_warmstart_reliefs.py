"""The reliefs of the relief library, and how one becomes a start of another fit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from voldetail.fit.space import Space
from voldetail.fit.warmstart.exposure import SHARES, TONES, exposed
from voldetail.fit.warmstart.reliefs import SPACE, WINDOW, library_relief, seen_through
from voldetail.image import to_linear, to_srgb


def test_relief_k_is_the_same_in_whatever_order_it_is_asked_for() -> None:
    late, early = library_relief(900), library_relief(3)
    again_early, again_late = library_relief(3), library_relief(900)
    for a, b in ((late, again_late), (early, again_early)):
        assert (a.kind, a.seed) == (b.kind, b.seed)
        np.testing.assert_array_equal(a.vector, b.vector)
    assert library_relief(3, seed=1).seed != early.seed


def test_reliefs_cover_all_families_and_a_quarter_turn_of_angles() -> None:
    reliefs = [library_relief(k) for k in range(400)]
    families = {replace(s.kind, octaves=1, envelope="", pigment=False) for s in reliefs}
    assert len(families) >= 20
    angles = [SPACE.at("noise.angle", s.vector[SPACE.names(s.kind).index("noise.angle")]) for s in reliefs]
    assert 0.0 <= min(angles) < 0.1
    assert math.pi / 2 - 0.1 < max(angles) <= math.pi / 2
    assert np.mean(angles) == pytest.approx(math.pi / 4, abs=4 * (math.pi / 2) / math.sqrt(12 * 400))
    assert len({s.seed for s in reliefs}) == len(reliefs)
    for s in reliefs:
        assert (np.clip(s.vector, 0.0, 1.0) == s.vector).all()
        s.detail()  # within a detail's bounds, or it would be refused


def test_a_start_is_the_relief_itself_through_the_librarys_window() -> None:
    for k in range(40):
        found = library_relief(k)
        start = seen_through(found, WINDOW, 0.0, mirrored=False)
        candidate = start.candidate(SPACE)
        assert candidate.kind == found.kind
        np.testing.assert_allclose(candidate.vector, found.vector, atol=1e-9)


def test_a_smaller_window_has_finer_cells_and_the_light_turns_the_angle() -> None:
    found = library_relief(6)
    wide, narrow = (seen_through(found, window, 0.0, mirrored=False).values for window in (WINDOW, WINDOW / 4))
    assert narrow["noise.scale"] == pytest.approx(4 * wide["noise.scale"])
    turned = seen_through(found, WINDOW, 1.0, mirrored=False).values["noise.angle"]
    mirrored = seen_through(found, WINDOW, 1.0, mirrored=True).values["noise.angle"]
    assert (turned - 1.0) % math.pi == pytest.approx(wide["noise.angle"])
    assert (1.0 - mirrored) % math.pi == pytest.approx(wide["noise.angle"])
    # Amplitudes are searched in cells: the same roughness of finer cells is a lower relief.
    space = Space(domain="solid", scale=(3.0, 128.0), finest=240.0)
    small = seen_through(found, WINDOW / 4, 0.0, mirrored=False).candidate(space)
    detail = space.decode(small.kind, small.vector)
    assert detail.relief.amplitude == pytest.approx(found.detail().relief.amplitude / 4, rel=1e-6)


def test_exposure_moves_three_tones_and_forgets_lamps_and_paint() -> None:
    picture = np.random.default_rng(0).gamma(3.0, 0.05, (64, 64)).astype(np.float32)
    found = to_srgb(exposed(picture))
    np.testing.assert_allclose(np.quantile(found, SHARES), TONES, atol=2e-3)
    order = np.argsort(picture.ravel(), kind="stable")
    assert (np.diff(found.ravel()[order]) >= -1e-6).all()
    # Gain and offset of the encoded picture, which paint and haze are about, change nothing.
    paler = to_linear((0.2 + 0.5 * to_srgb(picture)).astype(np.float32))
    inner = (found > 0.15) & (found < 0.85)
    np.testing.assert_allclose(to_srgb(exposed(paler))[inner], found[inner], atol=2e-3)


def test_exposure_knows_the_mask_and_an_even_picture() -> None:
    picture = np.random.default_rng(1).random((40, 40)).astype(np.float32)
    mask = np.zeros((40, 40), bool)
    mask[:, :20] = True
    brighter = picture.copy()
    brighter[:, 20:] = 1.0
    np.testing.assert_allclose(exposed(brighter, mask)[mask], exposed(picture[:, :20]).ravel().reshape(40, 20)[mask[:, :20]])
    assert np.isfinite(exposed(np.full((8, 8), 0.3, np.float32))).all()
