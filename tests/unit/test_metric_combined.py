"""The default metric: what it must refuse, what it must accept, and that a search can follow it."""

import numpy as np
import pytest
from scipy import ndimage
from skimage import data

from voldetail.image import resize, to_linear, to_srgb
from voldetail.metric import METRICS, describe, distance
from voldetail.metric.floors import SMALLEST_FLOOR
from voldetail.metric.ingredients import COMBINED

PHOTOS = ("gravel", "grass")


def crop(name: str, y: int, x: int, side: int = 192) -> np.ndarray:
    photo = to_linear(getattr(data, name)() / np.float32(255))
    return np.ascontiguousarray(photo[y : y + side, x : x + side])


def random_phase(picture: np.ndarray) -> np.ndarray:
    """The picture's spectrum without its structure."""
    encoded = to_srgb(picture)
    phases = np.fft.fft2(np.random.default_rng(1).standard_normal(encoded.shape))
    phases /= np.abs(phases)
    phases[0, 0] = 1
    return to_linear(np.clip(np.fft.ifft2(np.fft.fft2(encoded) * phases).real, 0, 1).astype(np.float32))


def test_it_is_the_default_and_its_weights_add_up_to_one() -> None:
    assert METRICS[0] == describe(crop("gravel", 0, 0)).metric == "combined"
    assert sum(sum(parts.values()) for parts in COMBINED.values()) == pytest.approx(1)


@pytest.mark.parametrize("photo", PHOTOS)
def test_accepted_pictures_are_nearer_than_every_decoy(photo: str) -> None:
    picture = crop(photo, 0, 0)
    reference = describe(picture)
    accepted = {
        "crop": crop(photo, 0, 256),
        "another crop": crop(photo, 300, 256),
        "brighter": picture * np.float32(1.1),
        "smaller": crop(photo, 0, 0, 202),
        "mirrored": np.ascontiguousarray(picture[:, ::-1]),
    }
    accepted["smaller"] = resize(accepted["smaller"], (192, 192))
    encoded = to_srgb(picture)
    grain = np.random.default_rng(2).normal(0, 0.05, picture.shape)
    decoys = {
        "phase": random_phase(picture),
        "blur": to_linear(ndimage.gaussian_filter(encoded, 1.5)),
        "grain": to_linear(np.clip(encoded + grain, 0, 1).astype(np.float32)),
        "another photo": crop("grass" if photo == "gravel" else "gravel", 0, 0),
    }
    near = {name: distance(reference, describe(p, like=reference)) for name, p in accepted.items()}
    far = {name: distance(reference, describe(p, like=reference)) for name, p in decoys.items()}
    assert max(near.values()) < min(far.values()), (near, far)
    assert far["phase"] > 2 * np.mean([near["crop"], near["another crop"]])


def test_the_published_metric_takes_the_random_phases_for_the_photo_far_more_readily() -> None:
    """Why there is another default (the numbers are in results/metric)."""
    ratios = {}
    for metric in ("published", "combined"):
        reference = describe(crop("grass", 0, 0), metric=metric)
        other = distance(reference, describe(crop("grass", 300, 256), like=reference))
        ratios[metric] = distance(reference, describe(random_phase(crop("grass", 0, 0)), like=reference)) / other
    # M is a sum of squares, the default a mean of first powers: compared as lengths.
    assert ratios["combined"] > 1.5 * ratios["published"] ** 0.5


@pytest.mark.parametrize("family", ["blur", "contrast", "phase"])
def test_it_grows_along_a_family_from_the_photo_to_a_wrong_picture(family: str) -> None:
    picture = crop("gravel", 0, 0)
    reference, encoded, wrong = describe(picture), to_srgb(picture), to_srgb(random_phase(picture))
    steps, mean = np.linspace(0, 1, 7), encoded.mean()
    shown = {
        "blur": [ndimage.gaussian_filter(encoded, 3 * t) for t in steps],
        "contrast": [encoded.mean() + (encoded - encoded.mean()) * (1 - 0.8 * t) for t in steps],
        # Weights on a quarter circle keep the contrast, which a straight blend would lower in the middle.
        "phase": [mean + np.cos(t * np.pi / 2) * (encoded - mean) + np.sin(t * np.pi / 2) * (wrong - mean) for t in steps],
    }[family]
    found = [distance(reference, describe(to_linear(p.astype(np.float32)), like=reference)) for p in shown]
    assert np.all(np.diff(found) > 0), found


def test_it_is_smooth_enough_to_search() -> None:
    """Along a fine change of scale the distance has no jumps: steps are small beside the whole way."""
    picture = crop("gravel", 0, 0, 224)
    reference = describe(picture[:192, :192])
    sides = range(192, 224)
    found = [distance(reference, describe(resize(picture[:side, :side], (192, 192)), like=reference)) for side in sides]
    way = found[-1] - found[0]
    assert way > 1
    assert np.abs(np.diff(found[1:])).max() < 0.35 * way


def test_floors_are_positive_and_exist_for_small_and_masked_pictures() -> None:
    mask = np.zeros((64, 64), bool)
    mask[4:60, 4:60] = True
    for reference in (describe(crop("gravel", 0, 0, 36)), describe(crop("gravel", 0, 0, 64), mask)):
        assert set(reference.floors) >= {(name, part) for name, parts in COMBINED.items() for part in parts}
        assert min(reference.floors.values()) >= SMALLEST_FLOOR
