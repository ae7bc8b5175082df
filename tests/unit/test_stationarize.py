"""Projections, tiles, palettes, and the two commands, on small photos."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage, stats

from voldetail.cli.main import main
from voldetail.errors import InputError
from voldetail.image import load_photo, save_image, save_png, to_linear
from voldetail.stationary.colour import from_lab, to_lab
from voldetail.stationary.control import distance, even_sigmas, palette, ramp, spread
from voldetail.stationary.levels import levels
from voldetail.stationary.measure import MEASURES, stationarity
from voldetail.stationary.patchmatch_vote import carry
from voldetail.stationary.pearson import cumulative
from voldetail.stationary.project import match_histogram, project
from voldetail.stationary.tile import Tile, TileProgress, stationarize

SMALL = 48  # side of a tile


def photo(side: int = 96, seed: int = 0) -> np.ndarray:
    """Blotchy noise that is dark on the left and reddish below, (side, side, 3) linear."""
    rough = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((side, side)), 1.5)
    grey = 0.35 + 0.12 * rough / rough.std()
    across, down = np.linspace(0.5, 1.3, side), np.linspace(0.8, 1.2, side)[:, None]
    picture = np.stack([grey * across * down, grey * across, grey * across / down], axis=-1)
    return np.clip(picture, 0.01, 1).astype(np.float32)


@pytest.fixture(scope="module")
def tile() -> Tile:
    return stationarize(photo(), SMALL, sigma=5, seed=3)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_projection_lowers_its_measure(measure: str) -> None:
    before = photo(64)
    after = from_lab(project(to_lab(before), measure, 6.0))
    values = [stationarity(p, measure=measure, sigma=6, toroidal=True).value for p in (before, after)]
    assert values[1] < 0.75 * values[0]


@pytest.mark.parametrize("measure", MEASURES)
def test_what_is_stationary_is_hardly_projected(measure: str) -> None:
    even = to_lab(np.tile(photo(8), (8, 8, 1)))
    assert np.abs(project(even, measure, 12.0) - even).mean() < 0.06 * even[..., 0].std()


@pytest.mark.parametrize("measure", MEASURES)
def test_a_projection_wraps_around(measure: str) -> None:
    """With the blocks' spacing dividing the roll."""
    lab = to_lab(photo(60))
    rolled = project(np.roll(lab, (10, 25), (0, 1)), measure, 6.0, spacing=5)
    np.testing.assert_allclose(rolled, np.roll(project(lab, measure, 6.0, spacing=5), (10, 25), (0, 1)), atol=0.02)


def test_a_projection_matches_local_histograms_to_the_global_one() -> None:
    """c' = G^-1(F(c)) at one pixel, with F and G from weighted samples, over all blocks that it lies in."""
    lab = to_lab(photo(24))
    found = project(lab, "histogram", 4.0, spacing=1)
    plane, sigma = lab[..., 0].astype(np.float64), 4.0
    offset = np.arange(24)[:, None] - np.arange(24)[None, :]
    window = sum(np.exp(-((offset + 24 * k) ** 2) / (2 * sigma**2)) for k in (-1, 0, 1))
    place, total, weights = (7, 18), 0.0, 0.0
    order = np.sort(plane.ravel())
    for y in range(24):
        for x in range(24):
            weight = np.outer(window[y], window[x])
            below = (weight * ((plane < plane[place]) + 0.5 * (plane == plane[place]))).sum() / weight.sum()
            total += weight[place] * np.interp(below, (np.arange(order.size) + 0.5) / order.size, order)
            weights += weight[place]
    assert found[(*place, 0)] == pytest.approx(total / weights, abs=np.ptp(plane) / 64)


def test_a_map_of_sigmas_lies_between_its_ends() -> None:
    lab = to_lab(photo(48))
    narrow, wide = project(lab, "mean", 3.0), project(lab, "mean", 12.0)
    both = project(lab, "mean", ramp(48, 3.0, 12.0))
    np.testing.assert_allclose(both[:, 0], narrow[:, 0], atol=1e-3)
    np.testing.assert_allclose(both[:, -1], wide[:, -1], atol=1e-3)


def test_pearsons_histograms_are_the_known_distributions() -> None:
    """Normal, gamma (type III), beta (type I) and Student (type VII), from their moments."""
    x = np.linspace(-3, 3, 25)
    gamma, beta, student = stats.gamma(4), stats.beta(2, 3), stats.t(9)
    for law, three in ((stats.norm(), True), (gamma, True), (gamma, False), (beta, False), (student, False)):
        mean, variance, skewness, excess = (float(v) for v in law.stats("mvsk"))
        one = (np.array([v]) for v in (mean, variance**0.5, skewness))
        found = cumulative(*one, None if three else np.array([3 + excess]), mean + variance**0.5 * x)[0]
        np.testing.assert_allclose(found, law.cdf(mean + variance**0.5 * x), atol=0.01)


def test_a_histogram_is_moved_by_its_share() -> None:
    lab, target = to_lab(photo(32, 1)), to_lab(photo(32, 2) * 0.5)
    quantiles = np.quantile(target.reshape(-1, 3), np.linspace(0, 1, 1025), axis=0)
    moved = match_histogram(lab, quantiles, 1.0)
    np.testing.assert_allclose(np.sort(moved[..., 0].ravel()), np.sort(target[..., 0].ravel()), atol=3)
    assert abs(moved[..., 0].mean() - target[..., 0].mean()) < 0.05
    np.testing.assert_allclose(match_histogram(lab, quantiles, 0.5), (moved + lab) / 2, atol=1e-3)


def test_levels_grow_by_the_factor_to_the_size() -> None:
    sides = [level.side for level in levels(256, (1024, 1024))]
    assert sides[0] == 64
    assert sides[-1] == 256
    assert all(1.2 < b / a < 1.4 for a, b in pairwise(sides))
    assert levels(96, (100, 100))[0].side >= 22


def test_a_tile_is_of_the_photo_and_more_stationary_than_plain_patchmatch(tile: Tile) -> None:
    plain = stationarize(photo(), SMALL, None, sigma=5, seed=3)
    assert tile.tile.shape == (SMALL, SMALL, 3)
    assert tile.tile.dtype == np.float32
    assert np.isfinite(tile.tile).all()
    assert tile.costs.stationarity < 0.8 * plain.costs.stationarity
    assert abs(float(to_lab(tile.tile)[..., 0].mean() - to_lab(photo())[..., 0].mean())) < 8


def test_its_edges_meet(tile: Tile) -> None:
    """Steps across the edge are like those inside."""
    lightness = to_lab(tile.tile)[..., 0]
    for axis in (0, 1):
        steps = np.abs(np.diff(np.concatenate([lightness, lightness.take([0], axis)], axis), axis=axis)).mean(axis=1 - axis)
        assert steps[-1] < 1.3 * steps[:-1].max()


def test_the_correspondence_makes_the_tile(tile: Tile) -> None:
    np.testing.assert_array_equal(carry(tile.correspondence, photo()), tile.tile)
    rolled = carry(np.roll(tile.correspondence, (7, 20), (0, 1)), photo())
    np.testing.assert_array_equal(rolled, np.roll(tile.tile, (7, 20), (0, 1)))


def test_the_same_seed_gives_the_same_tile(tile: Tile) -> None:
    again = stationarize(photo(), SMALL, sigma=5, seed=3)
    np.testing.assert_array_equal(again.correspondence, tile.correspondence)
    assert again.costs == tile.costs
    assert (stationarize(photo(), SMALL, sigma=5, seed=4).correspondence != tile.correspondence).any()


def test_holes_of_the_mask_are_not_used() -> None:
    picture, mask = photo(), np.ones((96, 96), bool)
    mask[30:50, 40:60], mask[:12, :12] = False, False
    picture[~mask] = (0, 1, 0)
    picture[80, 80] = np.nan
    found = stationarize(picture, 32, mask=mask)
    assert np.isfinite(found.tile).all()
    assert found.tile[..., 1].max() < 0.9
    assert "1 pixels" in found.sentence


def test_a_constant_photo_makes_a_constant_tile() -> None:
    found = stationarize(np.full((64, 64, 3), 0.25, np.float32), 32)
    np.testing.assert_allclose(found.tile, 0.25, atol=1e-5)
    assert found.costs.stationarity == pytest.approx(0, abs=1e-4)


def test_stopping_keeps_the_best_so_far() -> None:
    def stop_at(side: int) -> Tile:
        def stop(progress: TileProgress) -> None:
            if progress.side >= side:
                raise KeyboardInterrupt

        return stationarize(photo(), SMALL, on_progress=stop)

    found = stop_at(SMALL - 10)
    assert found.interrupted
    assert found.tile.shape == (SMALL, SMALL, 3)
    with pytest.raises(KeyboardInterrupt):
        stop_at(0)


def test_progress_tells_costs_and_ends_at_the_plan() -> None:
    seen: list[TileProgress] = []
    stationarize(photo(), 32, with_costs=True, on_progress=seen.append)
    assert seen[-1].done == seen[-1].planned == len(seen)
    assert seen[-1].seconds_left == 0
    assert all(p.costs is not None and p.costs.texture >= 0 for p in seen)


def test_even_sigmas_invert_the_distances() -> None:
    assert even_sigmas([2, 4, 8], [1, 1], 3) == pytest.approx((2, 4, 8))
    assert even_sigmas([2, 4, 8], [3, 1], 3)[1] == pytest.approx(2 ** (1 + 2 / 3))
    assert even_sigmas([2, 4, 8], [0, 0], 3) == pytest.approx((2, 4, 8))
    assert spread(64, 3) == pytest.approx((2, 8, 32))


def test_a_palette_goes_from_even_to_uneven() -> None:
    found = palette(photo(), 32, levels=2, even=False)
    assert len(found.tiles) == 2
    assert found.distances == (pytest.approx(distance(found.tiles[0].tile, found.tiles[1].tile)),)
    assert found.sigmas[0] < found.sigmas[1]
    assert distance(photo(), photo()[::-1, ::-1]) == pytest.approx(0, abs=1e-4)


@pytest.mark.parametrize(
    ("picture", "options", "words"),
    [
        (photo(96)[:10], {"size": 32}, "less than a patch"),
        (photo(), {"size": 128}, "give 16 to 96"),
        (photo(), {"size": 2}, "give 16 to 96"),
        (photo(), {"size": 32, "measure": "beauty"}, "use one of"),
        (photo(), {"size": 32, "sigma": 0.2}, "1 to 32 pixels"),
        (photo(), {"size": 32, "sigma": np.full((5, 5), 3.0)}, "map of sigmas"),
        (photo(), {"size": 32, "sigma": np.full((32, 32), np.nan)}, "out of range"),
        (photo(), {"size": 32, "alpha": 2.0}, "0 to 1"),
        (photo(), {"size": 32, "mask": np.zeros((96, 96), bool)}, "mask is empty"),
        (photo(), {"size": 32, "mask": np.eye(96, dtype=bool)}, "no place for a patch"),
        (np.full((96, 96, 3), np.nan), {"size": 32}, "finite"),
    ],
)
def test_what_cannot_be_tiled_is_refused(picture: np.ndarray, options: dict, words: str) -> None:
    with pytest.raises(InputError) as refusal:
        stationarize(picture, **options)
    assert words in str(refusal.value)


@pytest.fixture
def files(tmp_path: Path) -> Path:
    save_png(tmp_path / "photo.png", photo())
    height = np.linspace(0, 1, 96, dtype=np.float32)[None, :].repeat(96, 0)
    save_png(tmp_path / "height.png", to_linear(height))
    save_image(tmp_path / "normals.exr", np.dstack([0 * height, 0 * height - 0.6, 0 * height + 0.8]))
    return tmp_path


def test_the_command_makes_a_tile_and_carries_maps(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = main([
        "stationarize", str(files / "photo.png"), "-o", str(files / "tile.png"), "--size", "32",
        "--carry", f"{files / 'height.png'}={files / 'h.exr'}",
        "--carry-normals", f"{files / 'normals.exr'}={files / 'n.exr'}",
    ])  # fmt: skip
    assert code == 0
    assert "32 x 32 pixels" in capsys.readouterr().out
    assert load_photo(files / "tile.png").pixels.shape == (32, 32, 3)
    found = stationarize(load_photo(files / "photo.png").pixels, 32)
    height = carry(found.correspondence, np.linspace(0, 1, 96, dtype=np.float32)[None, :].repeat(96, 0))
    np.testing.assert_allclose(load_photo(files / "h.exr").pixels[..., 0], height, atol=0.004)


def test_the_command_makes_a_palette(files: Path) -> None:
    assert main(["stationarize", str(files / "photo.png"), "-o", str(files / "t.png"), "--size", "32", "--levels", "2"]) == 0
    assert (files / "t-1.png").exists()
    assert (files / "t-2.png").exists()


def test_the_other_command_measures(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stationarity", str(files / "photo.png"), "--heat", str(files / "heat.png")]) == 0
    told = capsys.readouterr().out
    assert all(measure in told for measure in MEASURES)
    assert load_photo(files / "heat.png").pixels.shape == (96, 96, 3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--sigma", "4", "--levels", "3"], "choose one"),
        (["--size", "400"], "give 16 to 96"),
        (["--measure", "beauty"], "use one of"),
        (["--levels", "1"], "2 to 20"),
        (["--mask", "missing.png"], "does not exist"),
        (["--carry", "missing.png=x.png"], "does not exist"),
        (["--carry", "missing.png"], "give MAP=OUT"),
    ],
)
def test_the_command_refuses_in_one_sentence(
    files: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(files)
    assert main(["stationarize", "photo.png", "-o", "tile.png", "--size", "32", *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
    assert not (files / "tile.png").exists()


def test_a_stopped_palette_keeps_its_tiles() -> None:
    def stop(number: int, count: int, progress: TileProgress) -> None:
        if number == 1:
            raise KeyboardInterrupt

    found = palette(photo(), 32, levels=3, on_progress=stop)
    assert found.interrupted
    assert len(found.tiles) == 1
