"""PatchMatch on small pictures, against all patches compared with all."""

import numpy as np
import pytest
from scipy import ndimage

from voldetail.errors import InputError
from voldetail.stationary.levels import TOP_ITERATIONS
from voldetail.stationary.patchmatch import allowed, centres, differences, enlarged, from_centres, search
from voldetail.stationary.patchmatch_arrays import PATCH, RADIUS, vote, wrapped
from voldetail.stationary.patchmatch_source import Source
from voldetail.stationary.patchmatch_vote import carry


def picture(shape: tuple[int, int], seed: int) -> np.ndarray:
    """Smooth noise (H, W, 3), periodic."""
    rough = np.random.default_rng(seed).standard_normal((*shape, 3))
    return (30 * ndimage.gaussian_filter(rough, (2, 2, 0), mode="wrap")).astype(np.float32)


def all_patches(image: np.ndarray) -> np.ndarray:
    """Every patch inside the image as a row."""
    views = np.lib.stride_tricks.sliding_window_view(image, (PATCH, PATCH), axis=(0, 1))
    return views.reshape(views.shape[0] * views.shape[1], -1).astype(np.float64)


def nearest(tile: np.ndarray, source: np.ndarray) -> np.ndarray:
    """The least squared difference of each patch of the tile to any patch of the source."""
    a, b = all_patches(wrapped(tile)), all_patches(source)
    return ((a**2).sum(1)[:, None] + (b**2).sum(1)[None, :] - 2 * a @ b.T).min(axis=1).reshape(tile.shape[:2])


def everywhere(image: np.ndarray, tile_pixels: int = 1) -> Source:
    return Source(image, np.ones(image.shape[:2], bool), tile_pixels)


def matched(tile: np.ndarray, source: Source, sweeps: int = TOP_ITERATIONS, **options: float) -> tuple:
    rng = np.random.default_rng(5)
    field = source.random(rng, tile[..., 0].size).reshape(tile.shape[:2])
    for sweep in range(sweeps):
        field, found = search(tile, source, field, rng=rng, sweep=sweep, **options)
    return field, found


def test_it_finds_nearly_the_nearest_patches() -> None:
    tile, image = picture((24, 28), 0), picture((48, 56), 1)
    _, found = matched(tile, everywhere(image))
    best = nearest(tile, image)
    assert (found > best - 1e-2 * best.mean()).all()
    assert found.mean() < 1.05 * best.mean()


def test_differences_are_those_of_the_field() -> None:
    tile, image = picture((20, 20), 2), picture((33, 37), 3)
    source = everywhere(image)
    field, found = matched(tile, source, sweeps=2)
    np.testing.assert_allclose(differences(tile, source, field), found, rtol=1e-4)
    row, column = divmod(int(field[0, 0]), image.shape[1])
    here = wrapped(tile)[:PATCH, :PATCH]
    assert found[0, 0] == pytest.approx(((here - image[row : row + PATCH, column : column + PATCH]) ** 2).sum(), rel=1e-4)


def test_a_source_holding_the_tile_gives_it_back() -> None:
    tile = picture((24, 24), 4)
    source = np.tile(tile, (3, 3, 1))
    field, found = matched(tile, everywhere(source))
    assert found.mean() < 1e-2 * nearest(tile, picture((60, 60), 5)).mean()
    assert np.abs(vote(field, source, 2.0) - tile).mean() < 0.1 * tile.std()


def test_the_same_seed_gives_the_same_field() -> None:
    tile, source = picture((20, 20), 6), everywhere(picture((40, 40), 7))
    np.testing.assert_array_equal(matched(tile, source, 3)[0], matched(tile, source, 3)[0])


def test_votes_are_those_of_the_overlapping_patches() -> None:
    """The definition, as a loop."""
    image = picture((30, 34), 8)
    field = everywhere(image).random(np.random.default_rng(9), 12 * 13).reshape(12, 13)
    weight = np.exp(-((np.arange(PATCH) - RADIUS) ** 2) / (2 * 2.0**2))
    weight /= weight.sum()
    expected = np.zeros((12, 13, 3))
    for y in range(12):
        for x in range(13):
            row, column = divmod(int(field[y, x]), 34)
            for i in range(PATCH):
                for j in range(PATCH):
                    place = (y + i - RADIUS) % 12, (x + j - RADIUS) % 13
                    expected[place] += weight[i] * weight[j] * image[row + i, column + j]
    np.testing.assert_allclose(vote(field, image, 2.0), expected, atol=1e-4)


def test_votes_wrap_around() -> None:
    image = picture((30, 34), 10)
    field = everywhere(image).random(np.random.default_rng(11), 16 * 16).reshape(16, 16)
    rolled = vote(np.roll(field, (3, 9), (0, 1)), image, 2.0)
    np.testing.assert_array_equal(rolled, np.roll(vote(field, image, 2.0), (3, 9), (0, 1)))


def test_holes_are_never_used() -> None:
    tile, image = picture((24, 24), 12), picture((60, 60), 13)
    use = np.ones((60, 60), bool)
    use[20:30, 25:33], use[:8, 50:] = False, False
    image[~use] = np.nan  # whatever is read there would spoil the tile
    source = Source(np.nan_to_num(image), use, 24 * 24)
    field, _ = matched(tile, source, 6, uniformity=0.1)
    assert source.free.ravel()[field].all()
    assert np.isfinite(vote(field, image, 2.0)).all()
    assert source.free.ravel()[allowed(np.arange(3000, dtype=np.uint32), source)].all()


def test_uniformity_spreads_the_use_of_the_source() -> None:
    """A tile of one colour would take the one patch that is nearest everywhere."""
    tile, image = np.zeros((48, 48, 3), np.float32), picture((64, 64), 14)
    source = everywhere(image, 48 * 48)
    greedy, even = (source.usage(matched(tile, source, 12, uniformity=u)[0])[source.free] for u in (0.0, 1.0))
    assert even.std() < 0.5 * even.mean() < 0.5 * greedy.std()
    assert even.max() < 3 * even.mean() < greedy.max()
    assert (even > 0).mean() > 0.99


def test_usage_is_the_mean_cover_of_a_patch() -> None:
    source = everywhere(picture((30, 30), 15), 1)
    used = np.array([[4 * 30 + 7]], np.uint32)
    usage = source.usage(used)
    assert usage[4, 7] == pytest.approx(1 / source.best_use)
    assert usage[4, 8] == pytest.approx(10 / 11 / source.best_use)
    assert usage[4 + PATCH, 7] == pytest.approx(0, abs=1e-12)


def test_each_pixel_may_be_used_once() -> None:
    """Eq. 6: omega_best does not fall below what one use makes."""
    assert everywhere(picture((40, 40), 16), 100).best_use == PATCH**2
    assert everywhere(picture((40, 40), 16), 6400).best_use == 4 * PATCH**2


def test_an_enlarged_field_keeps_its_matches() -> None:
    """Where the field is a shift, the larger one is the larger shift."""
    small, large = everywhere(picture((40, 44), 17)), everywhere(picture((80, 88), 18))
    y, x = np.mgrid[:16, :16]
    field = small.inside(y + 3, x + 5)
    row, column = np.divmod(enlarged(field, small.shape, large, 32), 88)
    grown = np.mgrid[:32, :32]
    inner = (slice(2, 28), slice(2, 28))
    assert np.ptp((row - grown[0])[inner]) <= 1
    assert np.ptp((column - grown[1])[inner]) <= 1
    assert row[10, 10] - 10 == pytest.approx(2 * (3 + RADIUS) - RADIUS, abs=1)


def test_centres_and_first_pixels_are_inverse() -> None:
    field = everywhere(picture((40, 44), 19)).random(np.random.default_rng(0), 64).reshape(8, 8)
    np.testing.assert_array_equal(from_centres(centres(field, 44), 44), field)


def test_carried_maps_follow_the_colours() -> None:
    image = picture((40, 44), 20)
    where = centres(everywhere(image).random(np.random.default_rng(1), 144).reshape(12, 12), 44)
    tile = carry(where, image)
    np.testing.assert_allclose(carry(where, image[..., 0]), tile[..., 0], atol=1e-5)
    many = np.concatenate([image, 2 * image, image[..., :1]], axis=2)
    np.testing.assert_allclose(carry(where, many), np.concatenate([tile, 2 * tile, tile[..., :1]], axis=2), atol=1e-4)
    normals = carry(where, image / np.linalg.norm(image, axis=2, keepdims=True), normals=True)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-5)
    np.testing.assert_array_equal(carry(where, np.zeros((40, 44, 3)), normals=True)[3, 3], [0, 0, 1])


@pytest.mark.parametrize(
    ("shape", "normals", "words"), [((39, 20), False, "photo's"), ((40, 44), True, "three channels"), ((40,), False, "shape")]
)
def test_maps_that_do_not_belong_are_refused(shape: tuple[int, ...], normals: bool, words: str) -> None:
    where = np.full((12, 12, 2), 30)
    with pytest.raises(InputError, match=words):
        carry(where, np.zeros(shape, np.float32), normals=normals)


def test_a_mask_without_room_is_refused() -> None:
    image, use = picture((40, 40), 21), np.zeros((40, 40), bool)
    use[::2] = True
    with pytest.raises(InputError, match="no place for a patch"):
        Source(image, use, 1)
    with pytest.raises(InputError, match="less than a patch"):
        Source(image[:8], use[:8], 1)
