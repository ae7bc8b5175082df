"""Dr.Jit's derivatives of R, both modes, against central differences in double precision."""

from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402
from drjit.llvm.ad import Float64  # noqa: E402

from voldetail.noise import NoiseSettings, StoneShape, feature_point, relief_function, single_octave  # noqa: E402

COUNT = 200
STEP = 1e-6
VALUES = {
    "scale": 3.1,
    "anisotropy": 1.4,
    "angle": 0.6,
    "lacunarity": 1.9,
    "gain": 0.8,
    "facets": 0.6,
    "elongation": 1.7,
    "size_spread": 0.4,
    "stripe_frequency": 1.7,
    "stripe_spread": 2.2,
}
CURVE = np.array([0.0, 0.05, 0.2, 0.1, 0.4, 0.5, 0.7, 0.65, 0.9, 0.95, 1.0])
POINTS = np.random.default_rng(11).uniform(-2, 2, (3, COUNT))
MIX = np.random.default_rng(12).normal(size=COUNT)  # the output is reduced with these for the reverse mode
STONES = ("facets", "elongation", "size_spread")
Case = tuple[int, int, int, int, bool, bool]  # dimensions, k, k', octaves, round envelope, stones
# Two octaves where the kernels compile quickly; the others are unrolled over four points.
CASES: list[Case] = [
    (3, 1, 50, 2, True, False), (2, 2, 3, 1, False, False), (3, 1, 2, 1, False, False), (3, 1, 50, 2, False, True),
]  # fmt: skip
NAMES = [*VALUES, "x", "y", "z", "curve 3", "curve 5", "curve 8"]


def offsets_of(float_type: Any, **steps: float) -> dict[str, Any]:
    return {name: dr.opaque(float_type, steps.get(name.replace(" ", "_"), 0.0)) for name in NAMES}


def relief(case: Case, offsets: dict[str, Any], **changed: float) -> Any:
    """R at POINTS with an offset added to all it depends on, so that every derivative shares a kernel."""
    dims, first, last, octaves, gaussian, stones = case
    float_type: Any = type(offsets["x"])
    values = {key: dr.opaque(float_type, v) + offsets[key] for key, v in (VALUES | changed).items()}
    shape = StoneShape(*(values.pop(name) for name in STONES))
    points = tuple(float_type(POINTS[axis]) + offsets["xyz"[axis]] for axis in range(dims))
    curve = float_type(CURVE)
    for name in NAMES[-3:]:
        curve = curve + offsets[name] * float_type(np.eye(11)[int(name.split()[1])])
    settings = NoiseSettings.from_ranks(dims, first, last, octaves, gaussian, highest=stones)
    return relief_function(points, settings, mi.UInt32(5), curve=curve, shape=shape, **values)[0]


def difference(case: Case, name: str) -> np.ndarray:
    key = name.replace(" ", "_")
    high, low = (relief(case, offsets_of(Float64, **{key: sign * STEP})).numpy() for sign in (1, -1))
    return (high - low) / (2 * STEP)


def forward(case: Case, name: str, float_type: Any = Float64, **changed: float) -> np.ndarray:
    offsets = offsets_of(float_type)
    dr.enable_grad(offsets[name])
    value = relief(case, offsets, **changed)
    dr.set_grad(offsets[name], 1.0)
    dr.forward_to(value)
    return np.array(dr.grad(value))


@cache
def reverse(case: Case, float_type: Any = Float64) -> dict[str, float]:
    """The derivatives of the values' mix, all in one pass."""
    offsets = offsets_of(float_type)
    dr.enable_grad(offsets)
    dr.backward(dr.sum(relief(case, offsets) * float_type(MIX)))
    return {name: float(dr.grad(offset)[0]) for name, offset in offsets.items()}


def tolerance(name: str) -> float:
    # The moments' slope in phi, theta and the stones' numbers is itself a difference quotient, of step 0.01.
    return 2e-3 if name.startswith("stripe") or name in STONES else 1e-5


def has(case: Case, name: str) -> bool:
    dims, _, _, octaves, _, stones = case
    if name in STONES:
        return stones
    return not (name == "z" and dims == 2) and not (name in ("lacunarity", "gain") and octaves == 1)


@pytest.mark.parametrize(("case", "name"), [(case, name) for case in CASES for name in NAMES if has(case, name)], ids=str)
def test_both_modes_against_differences(case: Case, name: str) -> None:
    expected = difference(case, name)
    size = np.abs(expected).max()
    assert size > 1e-2  # a derivative that is zero everywhere would prove nothing
    assert np.abs(forward(case, name) - expected).max() < tolerance(name) * size
    error = abs(reverse(case)[name] - MIX @ expected)
    assert error < tolerance(name) * np.linalg.norm(MIX) * np.linalg.norm(expected)


@pytest.mark.parametrize("name", ["stripe_frequency", "stripe_spread"])
def test_no_stripes_is_an_extremum_in_their_frequency(name: str) -> None:
    assert np.abs(forward(CASES[2], name, stripe_frequency=0.0)).max() < 1e-9


@pytest.mark.parametrize("name", ["scale", "x", "stripe_frequency"])
def test_single_precision_agrees_with_double(name: str) -> None:
    case = CASES[0]
    double, single = forward(case, name), forward(case, name, mi.Float)
    assert np.median(np.abs(single - double)) < 1e-4 * np.abs(double).max()
    assert reverse(case, mi.Float)[name] == pytest.approx(reverse(case)[name], rel=1e-2)


def test_gradients_are_finite_at_a_feature_point() -> None:
    origin = tuple(mi.Int32(0) for _ in range(3))
    point, _ = feature_point(origin, mi.UInt32(5), 3, mi.Float)
    x = [mi.Float(p) for p in point]
    dr.enable_grad(x)
    value = single_octave(tuple(x), NoiseSettings.from_ranks(3, 1, 1), mi.UInt32(5), mi.Float(2), mi.Float(1))
    dr.backward(value)
    assert np.isfinite([float(dr.grad(v)[0]) for v in x]).all()
