"""Structure models of GKHF14 section 6: ranges, any point in any order, turns, and both kinds of arrays."""

import numpy as np
import pytest

from voldetail.errors import InputError
from voldetail.texture.structures import MODELS, StructureModel, structure
from voldetail.texture.structures.arrays import functions
from voldetail.texture.structures.noise import ABSOLUTE_MEAN, DEVIATION, gradient_noise

EVERY = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def random_values(model: StructureModel, seed: int) -> dict[str, float]:
    shares = np.random.default_rng(seed).random(len(model.parameters))
    return {p.key: p.at(share) for p, share in zip(model.parameters, shares, strict=True)}


def test_there_are_the_twelve_models_with_the_paper_s_grids() -> None:
    assert len(MODELS) == 12
    # Table 2 of the paper; grid and rings are sampled at random there.
    sizes = {
        "brick": 224_422, "cellular grid": 101_871, "perlin": 12_221, "star": 44, "symbol": 16_830, "turbulence": 23_331,
        "turbulenceridge": 4_851, "woodlines": 121, "woodplanks": 20_402, "woodstreaks": 11,
    }  # fmt: skip
    assert {name: MODELS[name].grid_size for name in sizes} == sizes
    assert all(1 <= len(model.parameters) <= 7 for model in MODELS.values())


@EVERY
def test_structures_are_from_0_to_1_and_vary(model: StructureModel) -> None:
    corners = [
        {p.key: p.lower for p in model.parameters},
        {p.key: p.upper for p in model.parameters},
        *(random_values(model, seed) for seed in range(4)),
    ]
    for values in corners:
        found = structure(model, values, 96)
        assert found.dtype == np.float32
        assert found.shape == (96, 96)
        assert found.min() >= 0
        assert found.max() <= 1
    assert structure(model, None, 96).std() > 0.03


@EVERY
def test_a_part_of_a_picture_is_the_picture_of_that_part(model: StructureModel) -> None:
    values = random_values(model, 7)
    whole = structure(model, values, (96, 80), rotation=0.4, seed=3, offset=(-48, -40))
    part = structure(model, values, (30, 24), rotation=0.4, seed=3, offset=(-48 + 11, -40 + 17))
    assert np.array_equal(part, whole[11:41, 17:41])
    assert np.array_equal(whole, structure(model, values, (96, 80), rotation=0.4, seed=3))


@EVERY
def test_points_come_in_any_order_and_the_seed_moves_what_is_random(model: StructureModel) -> None:
    values = model.checked(random_values(model, 1))
    rng = np.random.default_rng(0)
    x, y = (rng.uniform(-200, 200, 500).astype(np.float32) for _ in range(2))
    order = rng.permutation(500)
    assert np.array_equal(model.evaluate(x, y, values, 5)[order], model.evaluate(x[order], y[order], values, 5))
    if model.name in ("perlin", "turbulence", "turbulenceridge", "brick", "woodplanks", "woodlines", "woodstreaks", "rings"):
        assert not np.array_equal(model.evaluate(x, y, values, 5), model.evaluate(x, y, values, 6))


@EVERY
def test_drjit_arrays_give_the_same_structure(model: StructureModel) -> None:
    from voldetail.backend import mitsuba

    mi = mitsuba()
    values = model.checked(random_values(model, 4))
    rng = np.random.default_rng(1)
    x, y = (rng.uniform(-100, 100, 2000).astype(np.float32) for _ in range(2))
    found = np.array(model.evaluate(mi.Float(x), mi.Float(y), values, 9))
    expected = model.evaluate(x, y, values, 9)
    # The same words, so the same cells; a point on a rim may round to its other side.
    assert np.mean(np.abs(found - expected) > 1e-3) < 0.002


@EVERY
def test_a_quarter_turn_of_the_picture_is_a_quarter_turn_of_the_plane(model: StructureModel) -> None:
    values = random_values(model, 2)
    turned = structure(model, values, 64, rotation=np.pi / 2)
    # Positions differ in their last bits, which decides on the side of a rim.
    assert np.mean(np.abs(turned - np.rot90(structure(model, values, 64))) > 1e-2) < 0.01


def test_regular_models_repeat_with_their_spacing() -> None:
    for name, values, period in (
        ("star", {"size": 20.0}, (20, 20)),
        ("symbol", {"spacing": 24.0, "kind": 6}, (24, 24)),
        ("grid", {"column_spacing": 16.0, "row_spacing": 10.0}, (10, 16)),
        ("cellular grid", {"spacing": 12.0, "aspect": 2.0}, (12, 24)),
    ):
        found = structure(MODELS[name], values, 96)
        assert found[period[0] :, period[1] :] == pytest.approx(found[: -period[0], : -period[1]], abs=2e-3)


def test_gradient_noise_has_the_moments_that_are_used_and_is_0_on_its_lattice() -> None:
    rng = np.random.default_rng(3)
    x, y = (rng.uniform(-500, 500, 100_000).astype(np.float32) for _ in range(2))
    n = gradient_noise(x, y, 11)
    assert n.mean() == pytest.approx(0, abs=0.005)
    assert n.std() == pytest.approx(DEVIATION, abs=0.004)
    assert np.abs(n).mean() == pytest.approx(ABSOLUTE_MEAN, abs=0.004)
    assert np.abs(gradient_noise(np.floor(x), np.floor(y), 11)).max() == 0


def test_parameters_stay_within_their_ranges_and_grids_have_both_ends() -> None:
    for model in MODELS.values():
        for p in model.parameters:
            shares = [p.at(share) for share in np.linspace(0, 1, 37)]
            stops = [p.stop(k) for k in range(p.stops)]
            assert min(shares) == pytest.approx(p.lower)
            assert max(shares) == pytest.approx(p.upper)
            assert stops[0] == pytest.approx(p.lower)
            assert stops[-1] == pytest.approx(p.upper)
            assert len(set(stops)) == p.stops
            for value in (*shares, *stops, p.default):
                model.checked({p.key: value})


@pytest.mark.parametrize(
    ("values", "size", "complaint"),
    [
        ({"colour": 1.0}, 8, "has no parameter 'colour'"),
        ({"length": 1.0}, 8, "length is 1"),
        ({"phase": 0.5}, 8, "a whole number"),
        ({"length": float("nan")}, 8, "length is nan"),
        ({}, 0, "not possible"),
        ({}, (8, 100_000), "not possible"),
    ],
)
def test_what_cannot_be_drawn_is_refused(values: dict[str, float], size: int, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        structure(MODELS["brick"], values, size)
    with pytest.raises(InputError, match="finite"):
        structure(MODELS["brick"], rotation=float("inf"))


def test_whole_numbers_wrap_below_0() -> None:
    f = functions(np.zeros(1, np.float32))
    assert f.whole(np.array([-1.0], np.float32)).tolist() == [2**32 - 1]
