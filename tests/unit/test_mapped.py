"""Maps at points of a surface: as the photo is, endless with what makes the photo what it is kept."""

import numpy as np
import pytest

from tests.unit.relief_examples import mapped
from voldetail.backend import mitsuba
from voldetail.detail.photo_relief import MappedDetail, domain_of, placed
from voldetail.field.hexagons import corners, hashed_place, offset_from
from voldetail.field.map_scores import scores_of
from voldetail.field.mapped import mapped_relief_and_albedo

GAP = 1e-4


def at(detail: MappedDetail, x: np.ndarray, y: np.ndarray, z: np.ndarray | None = None, **options: object) -> np.ndarray:
    """Height and colour factor (4, N) at points in scene units."""
    mi = mitsuba()
    third = np.zeros(x.size) if z is None else z
    points = tuple(mi.Float(np.ascontiguousarray(v, np.float32).ravel()) for v in (x, y, third))
    height, colour = mapped_relief_and_albedo(detail, points, **options)
    return np.stack([np.asarray(v) for v in (height, *colour)])


def centres(detail: MappedDetail) -> tuple[np.ndarray, np.ndarray]:
    """Where the middles of the maps' pixels are on the plane."""
    record = detail.record
    x = (np.arange(record.columns) + 0.5 - record.columns / 2) / record.texels_per_unit
    y = (record.rows / 2 - np.arange(record.rows) - 0.5) / record.texels_per_unit
    return np.meshgrid(x, y)


def test_the_photo_lies_on_the_plane_as_it_is() -> None:
    detail = mapped()
    found = at(detail, *centres(detail))
    assert np.allclose(found[0], detail.height.ravel(), atol=GAP)
    weights = np.array([0.2126, 0.7152, 0.0722])
    mean = float(detail.albedo.reshape(-1, 3).mean(0) @ weights)
    assert np.allclose(found[1:].T * mean, detail.albedo.reshape(-1, 3), atol=1e-3)


def test_between_pixels_it_is_bilinear() -> None:
    detail = mapped()
    x, y = centres(detail)
    half = 0.5 / detail.record.texels_per_unit
    found = at(detail, x[:, :-1] + half, y[:, :-1])[0].reshape(x[:, :-1].shape)
    assert np.allclose(found, 0.5 * (detail.height[:, 1:] + detail.height[:, :-1]), atol=GAP)


@pytest.mark.parametrize("periodic", [False, True])
def test_beyond_the_edges_it_is_mirrored_or_repeated(periodic: bool) -> None:
    detail = mapped(periodic=periodic)
    x, y = centres(detail)
    wide = detail.record.columns / detail.record.texels_per_unit
    found = at(detail, x + wide, y)[0].reshape(detail.height.shape)
    assert np.allclose(found, detail.height if periodic else detail.height[:, ::-1], atol=GAP)


def test_a_scale_makes_it_larger() -> None:
    detail = mapped()
    x, y = centres(detail)
    assert np.allclose(at(detail, 3 * x, 3 * y, scale=3.0)[0], detail.height.ravel(), atol=GAP)


class TestEndless:
    """Statistical, fixed seed: mean, deviation and quantiles of the maps are kept on shapes."""

    @staticmethod
    def points(count: int, wide: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x, y, z = np.random.default_rng(seed).uniform(-wide, wide, (3, count))
        return x, y, z

    @pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.577, 0.577, 0.577), (0.8, 0.0, 0.6)])
    def test_statistics_are_kept(self, normal: tuple[float, float, float]) -> None:
        detail = mapped((320, 320), seed=5).placed("solid", "endless")
        mi = mitsuba()
        count = 40_000
        x, y, z = self.points(count, 20.0)
        normals = tuple(mi.Float(np.full(count, v, np.float32)) for v in normal)
        found = at(detail, x, y, z, normals=normals)
        # Thousands of independent parts: their own spread is some hundredths.
        assert abs(found[0].mean() - detail.height.mean()) < 0.02
        assert found[0].std() == pytest.approx(detail.height.std(), rel=0.08)
        shares = (0.05, 0.25, 0.5, 0.75, 0.95)
        assert np.allclose(np.quantile(found[0], shares), np.quantile(detail.height, shares), atol=0.035)
        colours = found[1:] / found[1:].mean()
        assert colours.std() == pytest.approx((detail.albedo / detail.albedo.mean()).std(), rel=0.12)

    def test_nothing_repeats(self) -> None:
        detail = mapped((96, 96), seed=5).placed("solid", "endless")
        mi = mitsuba()
        x, y, _ = self.points(4000, 0.9)
        up = tuple(mi.Float(np.full(4000, v, np.float32)) for v in (0.0, 0.0, 1.0))
        one = at(detail, x, y, normals=up)[0]
        for shift in (2.0, 4.0, 8.0):
            other = at(detail, x + shift, y, normals=up)[0]
            assert abs(np.corrcoef(one, other)[0, 1]) < 0.25

    def test_another_seed_is_another_arrangement(self) -> None:
        mi = mitsuba()
        x, y, _ = self.points(4000, 3.0)
        up = tuple(mi.Float(np.full(4000, v, np.float32)) for v in (0.0, 0.0, 1.0))
        detail = mapped((96, 96), seed=5).placed("solid", "endless")
        other = MappedDetail(detail.record.model_copy(update={"seed": 9}), detail.height, detail.albedo, detail.roughness,
                             "solid", "endless")  # fmt: skip
        assert np.array_equal(at(detail, x, y, normals=up), at(detail, x, y, normals=up))
        assert abs(np.corrcoef(at(detail, x, y, normals=up)[0], at(other, x, y, normals=up)[0])[0, 1]) < 0.2

    def test_it_has_no_jumps(self) -> None:
        """Neighbouring points differ no more than in the photo, across the borders of parts and planes too."""
        detail = mapped((96, 96), seed=5).placed("solid", "endless")
        mi = mitsuba()
        t = np.linspace(-3, 3, 20_000)
        step = 6.0 / 20_000
        turn = np.stack([np.sin(t), np.zeros_like(t), np.cos(t)])
        normals = tuple(mi.Float(np.ascontiguousarray(v, np.float32)) for v in turn)
        found = at(detail, t, 0.3 * t, np.zeros_like(t), normals=normals)[0]
        steepest = np.abs(np.diff(detail.height, axis=1)).max() * detail.record.texels_per_unit
        assert np.abs(np.diff(found)).max() < 4 * steepest * step


class TestHexagons:
    def test_weights_are_shares_and_one_at_corners(self) -> None:
        mi = mitsuba()
        x, y = np.random.default_rng(0).uniform(-9, 9, (2, 500)).astype(np.float32)
        words, shares = corners(mi.Float(x), mi.Float(y), 2.0)
        total = np.sum([np.asarray(s) for s in shares], axis=0)
        assert np.allclose(total, 1, atol=1e-5)
        assert all((np.asarray(s) >= 0).all() for s in shares)
        assert len(words) == 3
        _, at_corner = corners(mi.Float([1e-4]), mi.Float([1e-4]), 2.0)
        assert max(float(s[0]) for s in at_corner) > 0.999

    def test_offsets_reach_no_farther_than_an_edge(self) -> None:
        mi = mitsuba()
        x, y = np.random.default_rng(1).uniform(-9, 9, (2, 500)).astype(np.float32)
        words, _ = corners(mi.Float(x), mi.Float(y), 2.0)
        for word in words:
            dx, dy = offset_from(word, mi.Float(x), mi.Float(y), 2.0)
            assert np.hypot(np.asarray(dx), np.asarray(dy)).max() < 2.0 + 1e-4

    def test_places_are_uniform(self) -> None:
        """Statistical: mean 1/2 and variance 1/12 within three deviations of 10 000 draws."""
        mi = mitsuba()
        index = np.arange(10_000, dtype=np.uint32)
        word = mi.UInt32(index % 100), mi.UInt32(index // 100)
        a, b = hashed_place(word, 0, mi.UInt32(7))
        for values in (np.asarray(a), np.asarray(b)):
            assert abs(values.mean() - 0.5) < 3 / np.sqrt(12 * 10_000)
            assert abs(values.var() - 1 / 12) < 0.003
        assert abs(np.corrcoef(np.asarray(a), np.asarray(b))[0, 1]) < 0.03


def test_scores_are_normal_and_uncorrelated() -> None:
    found = scores_of(mapped((96, 96), seed=5), 1.0)
    flat = found.values.reshape(-1, 4)
    assert np.allclose(flat.mean(0), 0, atol=0.01)
    assert np.allclose(flat.std(0), 1, atol=0.02)
    assert abs(np.corrcoef(flat[:, 1], flat[:, 2])[0, 1]) < 0.1


def test_far_points_see_means() -> None:
    detail = mapped((96, 96), seed=5)
    found = scores_of(detail, 4.3)
    assert found.factor == 4
    assert found.plain.shape == (24, 24, 4)
    assert found.plain[..., 0].mean() == pytest.approx(detail.height.mean(), abs=1e-5)


def test_where_a_detail_goes() -> None:
    detail = mapped()
    flat, round_ = placed(detail, flat=True), placed(detail, flat=False)
    assert (domain_of(flat), flat.arrangement) == ("surface", "photo")
    assert (domain_of(round_), round_.arrangement) == ("solid", "endless")


def test_an_even_map_stays_even() -> None:
    detail = mapped((48, 48))
    even = MappedDetail(detail.record, detail.height, np.full((48, 48, 3), 0.5, np.float32), detail.roughness, "solid", "endless")
    mi = mitsuba()
    x, y, z = TestEndless.points(2000, 5.0)
    up = tuple(mi.Float(np.full(2000, v, np.float32)) for v in (0.6, 0.0, 0.8))
    assert np.allclose(at(even, x, y, z, normals=up)[1:], 1.0, atol=1e-3)
