"""The noise of lobes: its second implementation, its variance, law and spectrum, its seeds, and what a pixel filter leaves."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from lobes_reference import noise

from voldetail.backend import mitsuba, set_threads

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.noise.lobes import CELL_BANDWIDTH, LobeTable, lobe_noise, lobe_table, passed  # noqa: E402
from voldetail.noise.triplanar import triplanar  # noqa: E402

ONE = np.array([[0.11, 0.6, 0.02, 0.012, 1.0]])
SOME = np.array(
    [
        [0.0, 0.3, 0.01, 0.03, 0.5],
        [0.05, 2.9, 0.012, 0.006, 0.8],
        [0.21, 1.5, 0.05, 0.04, 0.3],
        [0.4, 0.0, 0.03, 0.2, 0.4],
    ]
)


def table(rows: np.ndarray) -> LobeTable:
    return lobe_table(rows, mi.Float)


def columns(*arrays: np.ndarray) -> Any:
    return tuple(mi.Float(np.ascontiguousarray(a, np.float32)) for a in arrays)


def seeded(seed: int) -> Any:
    return dr.opaque(mi.UInt32, seed)


def field(rows: np.ndarray, seed: int, side: int = 512, step: float = 1.0, footprint: float | None = None) -> np.ndarray:
    y, x = np.mgrid[:side, :side] * step
    sigma = None if footprint is None else dr.opaque(mi.Float, footprint)
    value, _ = lobe_noise(columns(x.ravel(), y.ravel()), table(rows), seeded(seed), sigma)
    return value.numpy().reshape(side, side).astype(float)


def scattered(count: int, reach: float = 1e5) -> tuple[np.ndarray, np.ndarray]:
    """Places so far apart that hardly two share a cell: independent samples."""
    rng = np.random.default_rng(5)
    x, y = rng.uniform(-reach, reach, (2, count)).astype(np.float32).astype(float)
    return x, y


@pytest.mark.parametrize("rows", [ONE, SOME], ids=["one", "some"])
def test_it_is_what_its_second_implementation_says(rows: np.ndarray) -> None:
    x, y = (v.astype(np.float32).astype(float) for v in np.random.default_rng(1).uniform(-300, 300, (2, 20_000)))
    value, left = lobe_noise(columns(x, y), table(rows), seeded(77))
    # A place within rounding of a cell's border may fall on its other side, where the blend is the same.
    assert np.abs(value.numpy() - noise(x, y, rows, 77)).max() < 2e-3
    assert left.numpy() == pytest.approx([rows[:, 4].sum()])


def test_the_envelope_has_the_stated_bandwidth() -> None:
    t = (np.arange(100_000) + 0.5) / 100_000
    weights = np.stack([0.5 * (1 - t) ** 2, 0.75 - (t - 0.5) ** 2, 0.5 * t**2])
    slopes = np.stack([t - 1, 1 - 2 * t, t])
    size = np.sqrt((weights**2).sum(0))
    slopes = slopes / size - weights * (weights * slopes).sum(0) / size**3
    assert np.sqrt((slopes**2).sum(0).mean()) / (2 * np.pi) == pytest.approx(CELL_BANDWIDTH, rel=1e-3)


@pytest.mark.parametrize("rows", [ONE, SOME], ids=["one", "some"])
def test_variance_and_law_everywhere(rows: np.ndarray) -> None:
    value = lobe_noise(columns(*scattered(1_000_000)), table(rows), seeded(3))[0].numpy().astype(float)
    deviation = np.sqrt(rows[:, 4].sum())
    assert abs(value.mean()) < 0.006 * deviation
    assert value.var() == pytest.approx(rows[:, 4].sum(), rel=0.01)
    assert (value**3).mean() / deviation**3 == pytest.approx(0, abs=0.02)
    assert (value**4).mean() / deviation**4 == pytest.approx(3, rel=0.03)


def test_the_variance_is_the_same_in_all_parts_of_a_cell() -> None:
    # Many seeds at a few places; the lattice's cells are about 11 x 18 texels.
    x, y = (v.ravel().astype(float) for v in np.mgrid[:12, :12])
    values = np.stack([lobe_noise(columns(x, y), table(ONE), seeded(s))[0].numpy() for s in range(1000)])
    assert values.var(0) == pytest.approx(np.ones(144), abs=0.22)  # five deviations of the estimate, sqrt(2 / 1000)


@pytest.mark.parametrize("row", [ONE[0], *SOME], ids=["oblique", "zero", "thin", "fine", "broad"])
def test_the_covariance_is_that_of_the_gaussian_pair(row: np.ndarray) -> None:
    x, y = scattered(400_000)
    frequency, angle, bandwidth, across, variance = row
    c, s = np.cos(angle), np.sin(angle)
    here = lobe_noise(columns(x, y), table(row[None]), seeded(9))[0].numpy()
    for along, aside in ((0.5, 0), (1, 0), (0, 1), (1, 1)):
        du, dv = along / (2 * np.pi * bandwidth), aside / (2 * np.pi * across)
        there = lobe_noise(columns(x + du * c - dv * s, y + du * s + dv * c), table(row[None]), seeded(9))[0].numpy()
        law = np.exp(-0.5 * (along**2 + aside**2)) * np.cos(2 * np.pi * frequency * du)
        # 0.02 for the B-spline's spectrum, which is not quite a Gaussian, the rest for chance and rounded places.
        assert (here * there).mean() / variance == pytest.approx(law, abs=0.03)


def test_the_spectrum_has_its_centre_where_the_lobe_has_it() -> None:
    power = sum(np.abs(np.fft.fft2(field(ONE, s, 512) * np.outer(np.hanning(512), np.hanning(512)))) ** 2 for s in range(4))
    fy, fx = np.meshgrid(np.fft.fftfreq(512), np.fft.fftfreq(512), indexing="ij")
    c, s = np.cos(0.6), np.sin(0.6)
    half = fx * c + fy * s > 0
    power = power[half] / power[half].sum()
    u, v = (fx * c + fy * s)[half], (fy * c - fx * s)[half]
    assert power @ u == pytest.approx(0.11, abs=0.002)
    assert power @ v == pytest.approx(0, abs=0.002)
    assert np.sqrt(power @ (u - 0.11) ** 2) == pytest.approx(0.02, rel=0.06)
    assert np.sqrt(power @ v**2) == pytest.approx(0.012, rel=0.06)


def test_seeds_and_lobes_are_independent() -> None:
    places = columns(*scattered(300_000))
    a, b = (lobe_noise(places, table(ONE), seeded(s))[0].numpy() for s in (0, 1))
    assert abs((a * b).mean()) < 0.01
    twice = lobe_noise(places, table(np.repeat(ONE, 2, axis=0)), seeded(0))[0].numpy()
    assert twice.var() == pytest.approx(2.0, rel=0.02)


def test_the_same_bits_for_any_thread_count_and_order() -> None:
    x, y = scattered(100_003)
    first = lobe_noise(columns(x, y), table(SOME), seeded(4))[0].numpy()
    set_threads(1)
    try:
        alone = lobe_noise(columns(x[::-1], y[::-1]), table(SOME), seeded(4))[0].numpy()
    finally:
        set_threads(0)
    assert np.array_equal(first, alone[::-1])


def test_another_number_of_lobes_compiles_nothing() -> None:
    places = columns(*scattered(4096))
    dr.eval(lobe_noise(places, table(SOME), seeded(1))[0])
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        dr.eval(lobe_noise(places, table(ONE), seeded(2))[0])
        kernels = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
    assert kernels
    assert all(k["cache_hit"] for k in kernels)


@pytest.mark.parametrize("sigma", [0.5, 2.0, 10.0])
def test_what_passes_a_filter_is_the_integral(sigma: float) -> None:
    for frequency, _, bandwidth, across, _ in (ONE[0], *SOME):
        f = np.linspace(-12, 12, 4001)
        u, v = frequency + bandwidth * f, across * f
        bell = np.exp(-0.5 * f**2)
        law = [(bell * np.exp(-4 * np.pi**2 * sigma**2 * w**2)).sum() / bell.sum() for w in (u, v)]
        found = passed(*(mi.Float(float(w)) for w in (sigma, frequency, bandwidth, across))).numpy()[0]
        assert found == pytest.approx(law[0] * law[1], rel=1e-3, abs=1e-12)


def test_the_variance_left_is_that_of_the_filtered_noise() -> None:
    places = columns(*scattered(400_000))
    value, left = lobe_noise(places, table(SOME), seeded(6), dr.opaque(mi.Float, 1.0))
    assert value.numpy().var() == pytest.approx(left.numpy()[0], rel=0.015)
    assert 0 < left.numpy()[0] < 0.8 * SOME[:, 4].sum()
    # The noise as a picture of fine samples under the same filter.
    from scipy.ndimage import gaussian_filter

    fine = np.mean([gaussian_filter(field(SOME, s, 1024, 0.5), 2.0, mode="wrap")[40:-40, 40:-40].var() for s in range(3)])
    assert fine == pytest.approx(left.numpy()[0], rel=0.06)


def test_a_footprint_of_nothing_filters_nothing() -> None:
    assert np.allclose(field(SOME, 1, 64), field(SOME, 1, 64, footprint=0.0), atol=1e-5)


def test_on_three_planes_the_variance_is_kept() -> None:
    rng = np.random.default_rng(2)
    normal = rng.standard_normal((3, 600_000))
    places = rng.uniform(-1e5, 1e5, (3, 600_000))
    value, left = triplanar(columns(*places), columns(*normal), table(SOME), seeded(1))
    value = value.numpy().astype(float)
    assert left.numpy() == pytest.approx(np.full(len(value), 2.0), rel=1e-5)
    mixed = np.sort(np.abs(normal), axis=0)[1] > 0.9 * np.abs(normal).max(0)
    for part in (mixed, ~mixed):
        assert value[part].var() == pytest.approx(2.0, rel=0.03)
    assert (value**4).mean() / value.var() ** 2 == pytest.approx(3, rel=0.03)


def test_along_an_axis_it_is_the_noise_of_that_plane() -> None:
    x, y = scattered(1000, 300)
    z = np.zeros(1000)
    value, _ = triplanar(columns(x, y, z), columns(z, z, z + 1e-30), table(ONE), seeded(0))
    plane, _ = lobe_noise(columns(x, y), table(ONE), seeded(0) + (2 * 0x9E3779B9 & 0xFFFFFFFF))
    assert np.allclose(value.numpy(), plane.numpy(), atol=1e-6)
    nowhere, _ = triplanar(columns(x, y, z), columns(z, z, z), table(ONE), seeded(0))
    assert np.array_equal(nowhere.numpy(), value.numpy())


@pytest.mark.parametrize(
    "rows", [np.zeros((0, 5)), np.zeros((65, 5)), np.ones((2, 4)), np.full((1, 5), np.nan), -np.ones((1, 5))]
)
def test_what_is_no_table_is_refused(rows: np.ndarray) -> None:
    with pytest.raises(ValueError, match="lobe"):
        table(rows)
