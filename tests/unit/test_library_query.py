"""From a photo to its nearest structures: what is compared, what is found, and that its picture lies as the photo does."""

from dataclasses import replace

import numpy as np
import pytest

from voldetail.errors import InputError
from voldetail.image import resize, to_srgb
from voldetail.library import distance, entries, novelty_of, picture, query, rank, recolour, table, texture_of, vector_of
from voldetail.library.groups import Group
from voldetail.library.span import span_of, spanned
from voldetail.metric.gabor import REACH, SIGMAS
from voldetail.texture.structures import MODELS, structure

SIDE = 128
DARK, BRIGHT = (0.2, 0.1, 0.3), (0.9, 0.8, 0.4)


@pytest.fixture(scope="module")
def groups() -> dict[str, Group]:
    found = {}
    for name in ("brick", "rings", "grid"):
        made = entries(MODELS[name], 0, 12, side=SIDE)
        found[name] = Group(name, tuple(p.key for p in MODELS[name].parameters), made.values, table(made.vectors), made.seed)
    return found


def photo_of(group: Group, entry: int, steps: int = 0, swap: bool = False, size: int = SIDE) -> np.ndarray:
    """A photo of an entry in two tones; turned, and with the tones exchanged."""
    model = MODELS[group.model]
    s = structure(model, group.parameters(entry), size, rotation=steps * np.pi / 16, seed=group.seed)
    # The ends of a photo's line are its tones, so all of the range has to be there.
    s = (s - s.min()) / (s.max() - s.min())
    return recolour(1 - s if swap else s, DARK, BRIGHT)


def test_a_photo_is_brought_to_the_size_of_entries_and_a_small_one_is_left() -> None:
    rng = np.random.default_rng(0)
    large = rng.random((384, 512, 3)).astype(np.float32)
    found = query(large)
    assert found.photo.shape == (192, 256, 3)
    assert (found.scale, found.missing) == (0.5, 0)
    np.testing.assert_array_equal(found.photo, resize(large, (192, 256)))
    small = query(large[:100, :100])
    assert small.photo.shape == (100, 100, 3)
    assert (small.scale, small.missing) == (1.0, 1)
    fits = int(np.ceil(2 * REACH * SIGMAS[-1]))  # the coarsest filters
    assert query(large[:fits, :fits]).missing == 0
    assert query(large[:100, :100], scale=2.0).photo.shape == (200, 200, 3)


def test_a_zone_is_a_crop_and_what_a_mask_leaves_out_does_not_count(groups: dict[str, Group]) -> None:
    photo = photo_of(groups["brick"], 3, size=300)
    np.testing.assert_array_equal(
        query(photo, zone=(20, 30, 200, 150)).vector, query(photo[30:180, 20:220]).vector
    )  # fmt: skip
    mask = np.ones((300, 300), bool)
    mask[:, 260:] = False
    spoilt, other = photo.copy(), photo.copy()
    spoilt[~mask], other[~mask] = np.nan, 0.7
    # Also where it is made smaller, and pixels beside the border could run into each other.
    np.testing.assert_array_equal(query(spoilt, mask, scale=0.6).vector, query(other, mask, scale=0.6).vector)
    assert not np.array_equal(query(other, scale=0.6).vector, query(other, mask, scale=0.6).vector)


@pytest.mark.parametrize(
    ("name", "entry", "steps", "swap"), [("brick", 3, 3, False), ("rings", 5, 13, True), ("grid", 1, 6, True)]
)
def test_a_known_picture_is_found_and_its_answer_is_that_picture(
    groups: dict[str, Group], name: str, entry: int, steps: int, swap: bool
) -> None:
    photo = photo_of(groups[name], entry, steps, swap)
    asked = query(photo, trim=0.0)
    found = rank(groups, asked.vector, 5, tones=(asked.tones.dark, asked.tones.bright))
    best = found.answers[0]
    assert (best.model, best.entry, best.swapped) == (name, entry, swap)
    assert best.rotation == pytest.approx(steps * np.pi / 16)
    np.testing.assert_allclose(best.zero, BRIGHT if swap else DARK, atol=1e-3)
    made, shown = to_srgb(picture(best, SIDE)), to_srgb(photo)
    # The same noise, turned the same way, in the same tones: only the range of s differs.
    assert np.corrcoef(made.ravel(), shown.ravel())[0, 1] > 0.99
    assert np.abs(made - shown).mean() < 0.05
    mirrored = replace(best, rotation=np.pi - best.rotation)
    assert np.corrcoef(to_srgb(picture(mirrored, SIDE)).ravel(), shown.ravel())[0, 1] < 0.9


def test_a_model_that_uses_half_of_its_range_is_as_near_to_a_photo_of_itself() -> None:
    model = MODELS["turbulenceridge"]
    made = entries(model, 0, 6, side=SIDE)
    group = Group(model.name, tuple(p.key for p in model.parameters), made.values, table(made.vectors), made.seed)
    s = structure(model, group.parameters(4), SIDE)
    low, high = span_of(s)
    assert high - low < 0.9
    assert np.mean(s < low) == pytest.approx(0.005, abs=1e-3)
    assert np.mean(s > high) == pytest.approx(0.005, abs=1e-3)
    photo = recolour(s, DARK, BRIGHT)
    asked = query(photo)
    best = rank({model.name: group}, asked.vector, 1, tones=(asked.tones.dark, asked.tones.bright)).answers[0]
    assert best.entry == 4
    assert best.distance < 0.02
    assert distance(vector_of(s), asked.vector) > 5 * best.distance
    # The tones are the photo's and not the model's ends, and so is the picture.
    assert np.abs(to_srgb(picture(best, SIDE)) - to_srgb(photo)).mean() < 0.01
    texture = texture_of(best, (SIDE, SIDE))
    assert texture.span == pytest.approx(span_of(structure(model, group.parameters(4), 256)), abs=1e-6)


def test_a_map_of_one_value_has_a_span() -> None:
    flat = np.full((40, 40), 0.3, np.float32)
    assert np.isfinite(spanned(flat, span_of(flat))).all()
    speck = flat.copy()
    speck[3, 3] = 0.9
    assert span_of(speck) == pytest.approx((0.3, 0.9))


def test_specks_do_not_decide_on_the_tones(groups: dict[str, Group]) -> None:
    photo = 0.3 + 0.4 * photo_of(groups["brick"], 3)
    plain = query(photo)
    photo[::16, ::16] = 0.0
    photo[8::16, 8::16] = 1.0
    specked = query(photo)
    assert np.abs(specked.tones.dark - plain.tones.dark).max() < 0.05
    assert np.abs(specked.tones.bright - plain.tones.bright).max() < 0.07
    assert query(photo, trim=0.0).tones.dark[0] < 0.05


def test_answers_over_all_models_are_the_nearest_of_each_model_together(groups: dict[str, Group]) -> None:
    asked = query(photo_of(groups["rings"], 2))
    found = rank(groups, asked.vector, 6)
    assert set(found.by_model) == {"brick", "rings", "grid"}
    for name, answers in found.by_model.items():
        assert len(answers) == 6
        assert {a.model for a in answers} == {name}
    every = sorted(a.distance for answers in found.by_model.values() for a in answers)
    assert [a.distance for a in found.answers] == every[:6]
    # A library with fewer entries than are asked for gives them all.
    assert len(rank({"grid": groups["grid"]}, asked.vector, 50).answers) == 12
    still = rank(groups, asked.vector, 36, rotations=False, swap=False)
    assert {(a.rotation, a.swapped) for a in still.answers} == {(0.0, False)}
    nearer = {(a.model, a.entry): a.distance for a in rank(groups, asked.vector, 36).answers}
    assert all(nearer[a.model, a.entry] <= a.distance + 1e-9 for a in still.answers)


def test_a_stranger_is_told_from_a_picture_of_the_model(groups: dict[str, Group]) -> None:
    own = structure(MODELS["brick"], {"length": 40.0, "height": 17.0, "mortar": 0.2}, SIDE, seed=77)
    noise = np.random.default_rng(0).random((SIDE, SIDE)).astype(np.float32)
    told = []
    for s in (own, noise):
        best = rank({"brick": groups["brick"]}, vector_of(s), 1).answers[0]
        found = novelty_of(groups["brick"], best, side=SIDE)
        assert found is not None
        assert found.distance == best.distance
        assert found.novel == bool(found.sentence)
        told.append(found)
    assert not told[0].novel
    assert told[1].novel
    assert f"{told[1].distance:.3f} away" in told[1].sentence
    # The yardstick is of the model and the library, and not of what is asked for.
    assert told[0].farthest == told[1].farthest
    assert novelty_of(groups["brick"], replace(best, model="relief")) is None
    # Three entries are a coarser library, in which pictures are farther from their nearest.
    few = replace(groups["brick"], values=groups["brick"].values[:3], table=table(groups["brick"].table.vectors[:3]))
    coarse = novelty_of(few, best, side=SIDE)
    assert coarse is not None
    assert coarse.farthest > told[0].farthest


def test_refusals(groups: dict[str, Group]) -> None:
    photo = photo_of(groups["grid"], 0)
    for options, words in (
        ({"zone": (0, 0, 129, 10)}, "reaches outside the photo of 128 x 128"),
        ({"zone": (-1, 0, 64, 64)}, "reaches outside"),
        ({"zone": (0, 0, 40, 20)}, "40 x 20 pixels at a scale of 1; at least 32"),
        ({"scale": 0.1}, "at least 32"),
        ({"scale": 1e300}, "at most 2048"),
        ({"scale": 0.0}, "over 0"),
        ({"scale": float("nan")}, "over 0"),
        ({"mask": np.ones((128, 127), bool)}, "give one of its size"),
        ({"mask": np.zeros((128, 128), bool)}, "0 pixels"),
    ):
        with pytest.raises(InputError, match=words):
            query(photo, **options)
    with pytest.raises(InputError, match="one colour"):
        query(np.full((64, 64, 3), 0.5))
    with pytest.raises(InputError, match="no model to look in"):
        rank({}, np.zeros(750))
    best = rank({"grid": groups["grid"]}, query(photo).vector, 1).answers[0]
    with pytest.raises(InputError, match="'relief' is no structure model"):
        picture(replace(best, model="relief"))
