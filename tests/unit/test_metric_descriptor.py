"""What holds for every metric: identity, masks, shifts, units, errors."""

import dataclasses
import pickle

import numpy as np
import pytest
from skimage import data

from voldetail.errors import InputError
from voldetail.image import to_linear
from voldetail.metric import METRICS, describe, distance, distance_by_level
from voldetail.metric.descriptor import FORMER_NAMES

every_metric = pytest.mark.parametrize("metric", METRICS)


def gravel(y: int = 0, x: int = 0, side: int = 128) -> np.ndarray:
    return to_linear(data.gravel()[y : y + side, x : x + side] / np.float32(255))


def grass(side: int = 128) -> np.ndarray:
    return to_linear(data.grass()[:side, :side] / np.float32(255))


@every_metric
def test_a_picture_is_at_no_distance_from_itself_and_at_some_from_another(metric: str) -> None:
    reference = describe(gravel(), metric=metric)
    assert distance(reference, reference) == 0
    assert distance(reference, describe(gravel(), like=reference)) == 0
    assert distance(reference, describe(grass(), like=reference)) > 0


@every_metric
def test_a_crop_a_few_pixels_on_is_nearer_than_another_texture(metric: str) -> None:
    reference = describe(gravel(side=192), metric=metric)
    shifted = distance(reference, describe(gravel(5, 3, 192), like=reference))
    assert shifted < 0.5 * distance(reference, describe(grass(192), like=reference))


@every_metric
def test_parts_add_up_and_order_does_not_matter(metric: str) -> None:
    reference = describe(gravel(), metric=metric)
    other = describe(grass(), like=reference)
    parts = distance_by_level(reference, other)
    assert distance(reference, other) == pytest.approx(sum(parts.values()))
    assert min(parts.values()) >= 0
    assert distance(other, reference) == pytest.approx(distance(reference, other), rel=1e-6)


@every_metric
def test_what_lies_outside_the_mask_does_not_matter(metric: str) -> None:
    mask = np.zeros((128, 128), bool)
    mask[20:110, 16:120] = True
    reference = describe(gravel(), mask, metric=metric)
    spoilt = np.where(mask, gravel(), np.float32(0.9))
    assert distance(reference, describe(spoilt, mask, like=reference)) == 0
    assert distance(reference, describe(spoilt, like=reference)) > 0
    unknown = np.where(mask, gravel(), np.nan)
    assert distance(reference, describe(unknown, mask, metric=metric)) == 0


@every_metric
def test_a_full_mask_is_no_mask_and_a_one_pixel_hole_is(metric: str) -> None:
    mask = np.ones((128, 128), bool)
    reference = describe(gravel(), metric=metric)
    assert distance(reference, describe(gravel(), mask, like=reference)) == 0
    mask[64, 64] = False
    assert distance(reference, describe(gravel(), mask, like=reference)) > 0


def test_descriptors_survive_another_process_and_do_not_change() -> None:
    reference = describe(gravel())
    copied = pickle.loads(pickle.dumps(reference))
    assert distance(copied, describe(gravel(), like=reference)) == 0
    with pytest.raises(dataclasses.FrozenInstanceError):
        reference.metric = "published"  # type: ignore[misc]


def test_like_brings_its_own_metric() -> None:
    reference = describe(gravel(), metric="published")
    assert describe(grass(), like=reference, metric="combined").metric == "published"


def test_a_blank_picture_is_described_and_far_from_texture() -> None:
    blank = np.full((64, 64), 0.2, np.float32)
    reference = describe(gravel(side=64))
    assert np.isfinite(distance(reference, describe(blank, like=reference)))
    assert distance(reference, describe(blank, like=reference)) > 5
    assert np.isfinite(distance(describe(blank), describe(blank, like=describe(blank))))


def small_mask() -> np.ndarray:
    mask = np.zeros((128, 128), bool)
    mask[40:60, 40:60] = True
    return mask


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"luminance": np.zeros((128, 128, 3), np.float32)}, "luminance"),
        ({"luminance": np.zeros((20, 128), np.float32)}, "at least 32 x 32"),
        ({"luminance": np.full((64, 64), np.nan, np.float32)}, "NaN"),
        ({"luminance": gravel(), "mask": np.ones((64, 64), bool)}, "mask has shape"),
        ({"luminance": gravel(), "mask": np.ones((128, 128), np.uint8)}, "must be boolean"),
        ({"luminance": gravel(), "mask": np.zeros((128, 128), bool)}, "smaller than the metric's filters"),
        ({"luminance": gravel(), "mask": small_mask()}, "smaller than the metric's filters"),
        ({"luminance": gravel(), "metric": "euclid"}, "use one of"),
    ],
)
def test_unusable_input_is_refused_in_one_sentence(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        describe(**arguments)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_descriptors_of_different_references_are_not_compared() -> None:
    with pytest.raises(InputError, match="like="):
        distance(describe(gravel(), metric="published"), describe(grass(), metric="published"))
    with pytest.raises(InputError, match="like="):
        distance(describe(gravel(), metric="published"), describe(gravel(), metric="marginals"))


@pytest.mark.parametrize(("former", "name"), FORMER_NAMES.items())
def test_former_names_are_still_known(former: str, name: str) -> None:
    assert former not in METRICS
    assert describe(gravel(), metric=former).metric == describe(gravel(), metric=name).metric == name
