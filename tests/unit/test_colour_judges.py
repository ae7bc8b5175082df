"""The judges of colour textures: nothing from itself, little from another crop, more where colours are put elsewhere."""

from collections.abc import Callable

import numpy as np
import pytest
from skimage import data

from tests.benchmarks.colour_judges import JUDGES, Components, Judge, Picture
from tests.benchmarks.colour_list import crops
from voldetail.image import to_linear, to_srgb

every_judge = pytest.mark.parametrize("judge", JUDGES.values(), ids=JUDGES.keys())


def stones(shift: int = 0) -> list[Picture]:
    """Gravel whose large forms are reddish and whose fine ones bluish, cut; `shift` moves the blue against the red."""
    grey = data.gravel()[:400, :400] / np.float32(255)
    coarse = np.asarray((grey + np.roll(grey, 1, 0) + np.roll(grey, 1, 1) + np.roll(grey, (1, 1), (0, 1))) / 4, np.float32)
    blue = np.roll(grey, shift, axis=1)
    return crops(to_linear(np.stack([coarse, 0.6 * coarse + 0.2 * blue, 0.7 * blue + 0.1], axis=2)), 192)


def test_components_are_centred_and_faint_ones_left_out() -> None:
    photo = stones()[0]
    planes = Components(photo).of(photo)
    assert len(planes) == 2  # green is a sum of the two others
    for plane in planes:
        assert to_srgb(plane).mean() == pytest.approx(0.5, abs=2e-3)
    assert Components(photo).weights == sorted(Components(photo).weights, reverse=True)
    assert sum(Components(photo).weights) == pytest.approx(1)


@every_judge
def test_another_crop_is_near_and_colours_moved_or_exchanged_are_far(judge: Callable[[Picture], Judge]) -> None:
    asking, *others = stones()
    asked = judge(asking)
    assert asked.distance(asking) == pytest.approx(0, abs=1e-5)
    farthest = max(asked.distance(crop) for crop in others)
    assert 0 < farthest < asked.distance(stones(shift=9)[0])
    assert farthest < asked.distance(np.ascontiguousarray(others[0][..., ::-1]))
