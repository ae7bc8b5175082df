"""The space that is searched: every vector is a detail within bounds, and back."""

import itertools
import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voldetail.detail import (
    PAPER_NEIGHBOURS,
    PARAMETERS,
    START_CURVES,
    bounds,
    load_detail,
    parameter,
    parameters_of,
    rounded,
    save_detail,
)
from voldetail.detail.record import Detail
from voldetail.fit.candidates import DIMENSIONS
from voldetail.fit.profiles import FOLDS, SHAPE_COUNT, fold, profile, shape_of
from voldetail.fit.ranges import (
    FOLD_PENALTY,
    PIGMENT_PENALTY,
    SHAPE_RANGE,
    STONE_GAIN,
    STONE_HEIGHT,
)
from voldetail.fit.space import Kind, Space
from voldetail.noise import OCTAVE_NUMBERS, PlateShape, StoneShape

SPACE = Space("solid", (1.0, 60.0), 120.0)
KINDS = st.builds(
    lambda ranks, *rest: Kind(*ranks, *rest), st.sampled_from(PAPER_NEIGHBOURS),
    st.sampled_from(["exponential", "gaussian"]), st.integers(1, 4), st.booleans(), st.sampled_from(FOLDS),
    st.booleans(), st.booleans(),
) | st.builds(
    lambda *free: Kind(1, 50, *free, stones=True), st.sampled_from(["exponential", "gaussian"]), st.integers(1, 4),
    st.booleans(), st.just("none"), st.just(False), st.booleans(),
) | st.builds(
    lambda *free: Kind(1, 2, *free, plates=True), st.sampled_from(["exponential", "gaussian"]), st.integers(1, 4),
    st.booleans(), st.just("none"), st.booleans(), st.booleans(),
)  # fmt: skip
UNIT = st.floats(-0.5, 1.5)


def vectors(kind: Kind, space: Space = SPACE) -> st.SearchStrategy[np.ndarray]:
    return st.lists(UNIT, min_size=len(space.names(kind)), max_size=len(space.names(kind))).map(np.array)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.data(), KINDS, st.sampled_from([None, 0.03]), st.sampled_from(["solid", "surface"]))
def test_every_vector_is_a_valid_detail_of_its_kind(
    data: st.DataObject, kind: Kind, amplitude: float | None, domain: str
) -> None:
    space = Space(domain, (1.0, 60.0), 120.0, amplitude)
    detail = space.decode(kind, data.draw(vectors(kind, space)))
    assert rounded(Detail.model_validate(detail.model_dump())).noise.domain == domain
    noise = detail.noise
    assert (noise.first_neighbour, noise.last_neighbour, noise.envelope) == (kind.first, kind.last, kind.envelope)
    assert 1.0 <= noise.scale <= 60.0 * (1 + 1e-12)
    assert noise.octaves <= kind.octaves
    # The finest octave that is kept can still be seen.
    assert noise.octaves == 1 or noise.scale * noise.lacunarity ** (noise.octaves - 1) <= 120.0 * (1 + 1e-9)
    if amplitude is not None:
        assert detail.relief.amplitude == amplitude
    else:
        low, high = STONE_HEIGHT if kind.stones else space.roughness
        assert low * 0.999 <= detail.relief.amplitude * noise.scale <= high * 1.001
    assert (noise.stripe_frequency > 0) == kind.striped
    if not kind.pigment:
        pigment = detail.reflectance
        assert (pigment.height_albedo, pigment.cell_albedo, pigment.speckle) == (0.0, 0.0, 0.0)
    assert (noise.weights[1] < 0) == kind.bordered
    assert (noise.joining == "highest") == kind.stones
    if not kind.plates:
        assert (noise.cell_height, noise.cell_tilt) == (0.0, 0.0)
    curve = np.array(noise.curve)
    assert curve.min() >= 0
    assert curve.max() <= 1
    if kind.fold == "none":
        assert (np.diff(curve) >= 0).all()  # H rises, whatever the vector
        assert (curve[0], curve[-1]) == (0.0, 1.0)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.data(), KINDS)
def test_decoding_undoes_encoding(data: st.DataObject, kind: Kind) -> None:
    vector = np.clip(data.draw(vectors(kind)), 0.0, 0.999)
    if kind.stones:
        vector[0] = max(vector[0], 0.2)  # on coarser cells the highest stones meet the bound of the amplitude
    detail = SPACE.decode(kind, vector)
    values: dict[str, float] = {}
    for name, unit in zip(SPACE.names(kind), vector, strict=True):
        group, _, field = name.partition(".")
        low, high, _ = SPACE.range_of(name)
        if group == "shape" or name == "stone_profile":
            values[name] = low + unit * (high - low)
        elif name == "stone_stretch":
            values[name] = detail.noise.anisotropy
        elif name == "plate_dust":
            values[name] = detail.reflectance.height_albedo
        elif name in ("stone_gain", "plate_gain"):
            values[name] = detail.noise.gain
        elif name in ("roughness", "stone_height"):
            values[name] = detail.relief.amplitude * detail.noise.scale
        else:
            values[name] = getattr(getattr(detail, group), field)
    assert SPACE.encode(kind, values) == pytest.approx(vector, abs=1e-6)


def test_the_ends_of_the_box_are_the_bounds() -> None:
    kind = Kind(1, 2, "gaussian", 3, True, pigment=True)
    names = SPACE.names(kind)
    low, high = (SPACE.decode(kind, np.full(len(names), v)) for v in (0.0, 1.0 - 1e-12))
    assert (low.noise.scale, high.noise.scale) == pytest.approx((1.0, 60.0))
    assert (low.noise.anisotropy, high.noise.anisotropy) == pytest.approx(SPACE.anisotropy)
    assert (low.noise.stripe_frequency, high.noise.stripe_frequency) == pytest.approx(SPACE.stripes)
    assert (low.noise.lacunarity, high.noise.lacunarity) == pytest.approx(bounds("noise.lacunarity"))
    assert (low.noise.angle, high.noise.angle) == pytest.approx((0.0, math.pi), abs=1e-5)


def test_stones_are_as_high_as_wide_and_rise_steeply_from_narrow_gaps() -> None:
    kind = Kind(1, 50, "exponential", 2, False, pigment=True, stones=True)
    names = SPACE.names(kind)
    assert not any(name.startswith("shape.") for name in names)
    low, high = (SPACE.decode(kind, np.full(len(names), v)) for v in (0.0, 1.0))
    assert low.noise.curve == pytest.approx(np.linspace(0, 1, 11))
    assert np.diff(high.noise.curve)[0] > 5 * np.diff(high.noise.curve)[-1]
    assert (low.noise.gain, high.noise.gain) == pytest.approx(STONE_GAIN)
    assert (low.noise.elongation, high.noise.elongation) == pytest.approx(parameter("noise.elongation").searched)
    assert (low.relief.amplitude * low.noise.scale) == pytest.approx(STONE_HEIGHT[0])


def test_plates_have_a_height_a_tilt_and_a_bevel() -> None:
    kind = Kind(1, 2, "gaussian", 1, False, bordered=True, plates=True)
    low, high = (SPACE.decode(kind, np.full(len(SPACE.names(kind)), v)).noise for v in (0.0, 1.0))
    for declaration in parameters_of("plates"):
        assert (getattr(low, declaration.name), getattr(high, declaration.name)) == pytest.approx(declaration.searched)
    assert len(SPACE.names(kind)) == len(SPACE.names(replace(kind, plates=False))) + 3


def test_a_number_of_the_noise_is_a_parameter_and_is_searched_with_its_part() -> None:
    """A field of the noise's own record and a declaration are all that one takes: record, relief and search follow."""
    stones, plates, striped = (
        Kind(1, 50, "gaussian", 2, False, stones=True), Kind(1, 2, "gaussian", 2, False, plates=True),
        Kind(1, 50, "gaussian", 2, True),
    )  # fmt: skip
    for part, names, kind in (
        ("stones", [f.name for f in fields(StoneShape)], stones), ("plates", [f.name for f in fields(PlateShape)], plates),
        ("stripes", [n for n in OCTAVE_NUMBERS if n.startswith("stripe")], striped),
    ):  # fmt: skip
        declared = parameters_of(part)
        assert [p.name for p in declared] == names
        assert {p.key for p in declared} <= set(SPACE.names(kind))
        changed = replace(kind, stones=False, plates=False, striped=False)
        assert not {p.key for p in declared} & set(SPACE.names(changed))
        vector = np.full(len(SPACE.names(kind)), 0.7)
        noise = SPACE.decode(kind, vector).noise
        assert all(getattr(noise, p.name) == pytest.approx(SPACE.at(p.key, 0.7)) for p in declared)


def test_what_covers_a_range_lies_in_it_mostly() -> None:
    """Samples beyond it are held at its end, which is right for a few and not for half of them."""
    for declaration in PARAMETERS:
        if declaration.cover is not None:
            low, high, _ = SPACE.range_of(declaration.key)
            values = np.array([declaration.cover.at(u) for u in np.linspace(0, 1, 101)])
            assert 0 <= declaration.cover.dimension < DIMENSIONS
            assert ((values >= low - 1e-9) & (values <= high + 1e-9)).mean() > 0.5


def test_a_plain_space_has_the_papers_numbers_only() -> None:
    plain = Space("solid", (1.0, 60.0), 120.0, plain=True)
    kind = Kind(1, 2, "exponential", 3, True)
    assert "noise.gain" in SPACE.names(kind)
    assert "noise.gain" not in plain.names(kind)
    assert plain.decode(kind, np.full(len(plain.names(kind)), 0.4)).noise.gain == 1.0


def test_what_seldom_looks_like_nature_has_to_pay_for_itself() -> None:
    plain = Kind(1, 2, "gaussian", 2, False)
    assert plain.penalty == 1.0
    assert Kind(1, 2, "gaussian", 2, True).penalty > 1.0
    assert Kind(1, 50, "gaussian", 2, True).penalty == 1.0
    assert Kind(1, 50, "gaussian", 2, False, stones=True).penalty < 1.0
    assert replace(plain, plates=True).penalty > 1.0
    assert Kind(1, 2, "gaussian", 2, False, "ridge", False, True).penalty == pytest.approx(FOLD_PENALTY * PIGMENT_PENALTY)


def test_angles_wrap_and_the_rest_is_clipped() -> None:
    kind = Kind(1, 2, "gaussian", 1, False)
    vector = np.full(len(SPACE.names(kind)), 0.3)
    once, around = vector.copy(), vector.copy()
    around[SPACE.names(kind).index("noise.angle")] += 1.0
    assert SPACE.decode(kind, around).noise.angle == pytest.approx(SPACE.decode(kind, once).noise.angle)
    beyond = vector.copy()
    beyond[SPACE.names(kind).index("noise.scale")] = 1.7
    assert SPACE.decode(kind, beyond).noise.scale == pytest.approx(60.0)


def test_what_is_not_given_is_in_the_middle() -> None:
    kind = Kind(1, 2, "gaussian", 1, False)
    assert (SPACE.encode(kind, {}) == 0.5).all()
    assert SPACE.decode(kind, SPACE.encode(kind, {})).noise.curve == pytest.approx(np.linspace(0, 1, 11))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.floats(-SHAPE_RANGE, SHAPE_RANGE), min_size=SHAPE_COUNT, max_size=SHAPE_COUNT))
def test_a_profile_rises_from_nothing_to_one_and_is_found_again(shape: list[float]) -> None:
    curve = profile(np.array(shape))
    assert (curve[0], curve[-1]) == (0.0, 1.0)
    assert (np.diff(curve) >= 0).all()
    if np.diff(curve).min() > 0.011:  # `shape_of` sees no smaller steps
        assert shape_of(tuple(curve)) == pytest.approx(shape, abs=1e-6)


@pytest.mark.parametrize("name", ["linear", "square", "root", "smoothstep", "plateau", "ramp", "step"])
def test_a_starting_curve_is_met_about(name: str) -> None:
    curve = np.array(START_CURVES[name])
    assert np.abs(profile(shape_of(START_CURVES[name])) - curve).mean() < 0.12


def test_folding() -> None:
    rising = np.linspace(0, 1, 11)
    assert fold(rising, "none") is rising
    ridge, billow = fold(rising, "ridge"), fold(rising, "billow")
    assert ridge == pytest.approx(1 - np.abs(np.linspace(-1, 1, 11)))
    assert billow == pytest.approx(np.abs(np.linspace(-1, 1, 11)))
    assert ridge + billow == pytest.approx(1.0)


def test_a_decoded_detail_survives_its_file(tmp_path) -> None:  # type: ignore[no-untyped-def]
    for first, (kind_fold, pigment) in itertools.product(PAPER_NEIGHBOURS, [("none", False), ("ridge", True)]):
        kind = Kind(*first, "gaussian", 2, True, kind_fold, False, pigment)
        detail = rounded(SPACE.decode(kind, np.linspace(0, 1, len(SPACE.names(kind)))))
        save_detail(tmp_path / "detail.json", detail)
        assert load_detail(tmp_path / "detail.json") == detail
