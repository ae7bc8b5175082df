"""What the noise looks like on average; every number is for the fixed seeds here."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.noise import (  # noqa: E402
    NoiseSettings,
    gabor,
    moments,
    nearest_points,
    relief_function,
    single_octave,
)
from voldetail.noise.relief import ETA, OCTAVE_SALT, frame  # noqa: E402

SETS = [(1, 50), (1, 2), (2, 2), (2, 3)]
PLAIN = {
    "scale": 1.0,
    "anisotropy": 1.0,
    "angle": 0.0,
    "lacunarity": 2.0,
    "stripe_frequency": 0.0,
    "stripe_spread": 0.0,
}
SIDE, STEP = 384, 0.125


def plane(height: float | None) -> tuple[Any, ...]:
    """A square grid of 48 x 48 cells; 2D where ``height`` is None."""
    y, x = np.mgrid[:SIDE, :SIDE] * STEP
    planar = (mi.Float(x.ravel()), mi.Float(y.ravel()))
    return planar if height is None else (*planar, mi.Float(np.full(SIDE * SIDE, height)))


def argument(points: tuple[Any, ...], settings: NoiseSettings, seed: int = 1, **changed: float) -> np.ndarray:
    """The argument t of H, from R with the straight curve."""
    values = {name: dr.opaque(mi.Float, value) for name, value in (PLAIN | changed).items()}
    curve = mi.Float(np.linspace(0, 1, 11))
    r, _ = relief_function(points, settings, dr.opaque(mi.UInt32, seed), curve=curve, **values)
    return 2 * r.numpy().astype(np.float64) - 1


def standard_score(t: np.ndarray) -> np.ndarray:
    """(sum - mean) / deviation, back from t = z / sqrt(1 + z^2)."""
    return ETA * t / np.sqrt(1 - t**2)


def autocorrelation(t: np.ndarray, lag: int, axis: int) -> float:
    field = np.moveaxis(t.reshape(SIDE, SIDE), axis, 0)
    field = field - field.mean()
    return float((field[lag:] * field[:-lag]).mean() / field.var())


@pytest.mark.parametrize("octaves", [1, 4])
@pytest.mark.parametrize("phi", [0.0, 2.0])
@pytest.mark.parametrize("ranks", SETS)
def test_argument_of_the_curve_is_within_bounds_and_uses_them(ranks: tuple[int, int], phi: float, octaves: int) -> None:
    t = argument(plane(0.3), NoiseSettings.from_ranks(3, *ranks, octaves), stripe_frequency=phi, stripe_spread=3.0)
    assert np.abs(t).max() <= 1.0
    assert np.quantile(t, 0.01) < -0.6
    assert np.quantile(t, 0.99) > 0.6
    score = standard_score(t)
    assert abs(score.mean()) < 0.1
    assert score.std() == pytest.approx(1.0, abs=0.07)


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("ranks", SETS)
def test_mean_and_deviation_do_not_depend_on_the_seed(ranks: tuple[int, int], dims: int) -> None:
    points = plane(0.3 if dims == 3 else None)
    fields = [argument(points, NoiseSettings.from_ranks(dims, *ranks), seed) for seed in range(8)]
    means, deviations = [f.mean() for f in fields], [f.std() for f in fields]
    assert np.ptp(means) < 0.05
    assert np.ptp(deviations) < 0.03
    assert abs(np.mean(means)) < 0.08


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("ranks", SETS)
def test_same_correlation_along_both_axes(ranks: tuple[int, int], dims: int) -> None:
    points = plane(0.3 if dims == 3 else None)
    settings = NoiseSettings.from_ranks(dims, *ranks)
    fields = [argument(points, settings, seed) for seed in range(4)]
    for lag in (2, 4, 6):
        x, y = (np.mean([autocorrelation(f, lag, axis) for f in fields]) for axis in (1, 0))
        assert x == pytest.approx(y, abs=0.03)
    stretched = argument(points, settings, anisotropy=2.0)
    assert autocorrelation(stretched, 2, 1) < autocorrelation(stretched, 2, 0) - 0.1
    turned = argument(points, settings, anisotropy=2.0, angle=np.pi / 2)
    assert autocorrelation(turned, 2, 0) < autocorrelation(turned, 2, 1) - 0.1


def spread_over_heights(ranks: tuple[int, int]) -> tuple[float, float]:
    """Range of mean and deviation of single_octave over planes at several heights of the lattice."""
    settings = NoiseSettings.from_ranks(3, *ranks)
    fields = []
    for height in np.arange(8) / 8 + 5:
        x = frame(plane(float(height)), 1.0, 1.0, mi.Float(0.0))
        fields.append(single_octave(x, settings, mi.UInt32(9), mi.Float(0), mi.Float(0)).numpy())
    means, deviations = [f.mean() for f in fields], [f.std() for f in fields]
    return float(np.ptp(means) / np.mean(means)), float(np.ptp(deviations) / np.mean(deviations))


@pytest.mark.parametrize("ranks", SETS)
def test_a_plane_looks_the_same_at_every_height(ranks: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    mean, deviation = spread_over_heights(ranks)
    assert mean < 0.04
    assert deviation < 0.04
    monkeypatch.setattr("voldetail.noise.relief.TURN", np.eye(3))  # the turn of the lattice is what does it
    assert spread_over_heights(ranks)[1] > 0.1


def test_octaves_are_independent() -> None:
    x = plane(0.3)
    settings = NoiseSettings.from_ranks(3, 1, 50)
    for lacunarity in (1.0, 1.5, 2.0):
        scaled = tuple(v * lacunarity for v in x)
        first, second = (
            single_octave(p, settings, mi.UInt32(s), mi.Float(0), mi.Float(0)).numpy()
            for p, s in ((x, 4), (scaled, 4 + OCTAVE_SALT))
        )
        assert abs(np.corrcoef(first, second)[0, 1]) < 0.03


def test_twice_the_scale_halves_the_correlation_length() -> None:
    settings = NoiseSettings.from_ranks(3, 1, 2)
    t = argument(plane(0.0), settings, scale=0.5), argument(plane(0.0), settings, scale=1.0)

    def length(field: np.ndarray) -> float:
        rho = np.array([1.0] + [autocorrelation(field, lag, 1) for lag in range(1, 16)])
        return float(np.interp(-0.5, -rho[: int(np.argmin(rho)) + 1], np.arange(int(np.argmin(rho)) + 1)))

    assert length(t[0]) / length(t[1]) == pytest.approx(2.0, rel=0.08)
    doubled = tuple(2.0 * v for v in plane(0.3))
    assert np.array_equal(argument(doubled, settings), argument(plane(0.3), settings, scale=2.0))


@pytest.mark.parametrize(("dims", "claimed"), [(2, 0.43), (3, 0.53)])
def test_mean_distance_to_the_closest_point(dims: int, claimed: float) -> None:
    # Stated beside SIGMA.
    x = tuple(mi.Float(c) for c in np.random.default_rng(2).uniform(-50, 50, (dims, 200_000)))
    assert float(dr.mean(nearest_points(x, mi.UInt32(3), 1)[0][0])[0]) == pytest.approx(claimed, abs=0.01)


def test_what_is_said_of_the_round_envelope() -> None:
    # Stated beside GAUSSIAN_SIGMA.
    def of(dims: int, ranks: tuple[int, int], gaussian: bool) -> tuple[float, float]:
        return moments(NoiseSettings.from_ranks(dims, *ranks, 1, gaussian), mi.Float, 0.0, 0.0)

    for dims, round_mean, plain_mean in ((2, 0.49, 0.45), (3, 0.37, 0.37)):
        assert of(dims, (1, 1), True)[0] == pytest.approx(round_mean, abs=0.01)
        assert of(dims, (1, 1), False)[0] == pytest.approx(plain_mean, abs=0.01)
    ratios = []
    for dims in (2, 3):
        for ranks in SETS:
            (m, s), (m_plain, s_plain) = of(dims, ranks, True), of(dims, ranks, False)
            ratios.append((s / m) / (s_plain / m_plain))
    assert min(ratios) == pytest.approx(1.4, abs=0.05)
    assert max(ratios) == pytest.approx(2.9, abs=0.05)
    assert gabor.GAUSSIAN_SIGMA == 0.35
