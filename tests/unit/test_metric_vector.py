"""Vectors of the default metric: the same numbers and distances as descriptors, many at once."""

import numpy as np
import pytest
import skimage.data
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image import resize, to_linear
from voldetail.metric import describe, distance
from voldetail.metric.vector import BLOCK, combined_vector, definition, distances, parts, vector_length

Array = NDArray[np.float32]


def crop(name: str, at: int) -> Array:
    photo = to_linear(getattr(skimage.data, name)().astype(np.float32) / 255)
    return resize(photo[at : at + 192, at : at + 192], (96, 96))


def test_a_vector_does_not_hang_on_the_reference_and_gives_the_metrics_own_distance() -> None:
    gravel, grass, picture = crop("gravel", 0), crop("grass", 0), crop("brick", 90)
    one, other = describe(gravel), describe(grass)
    row = combined_vector(describe(picture, like=one))
    assert row.shape == (vector_length(),)
    np.testing.assert_array_equal(row, combined_vector(describe(picture, like=other)))
    wanted = [distance(one, describe(picture, like=one)), 0.0]
    found = distances(one, np.stack([row, combined_vector(one)]))
    np.testing.assert_allclose(found, wanted, rtol=1e-5, atol=1e-9)


def test_many_vectors_are_compared_as_one_by_one_across_blocks() -> None:
    one = describe(crop("gravel", 0))
    rows = np.stack([combined_vector(describe(crop("grass", 10 * k), like=one)) for k in range(3)])
    many = np.tile(rows, (BLOCK, 1))
    single = [distances(one, row[None])[0] for row in rows]
    np.testing.assert_allclose(distances(one, many), np.tile(single, BLOCK), rtol=1e-6)


def test_halves_keep_a_thousandth() -> None:
    one = describe(crop("gravel", 0))
    row = combined_vector(describe(crop("grass", 50), like=one))[None]
    np.testing.assert_allclose(distances(one, row.astype(np.float16)), distances(one, row), rtol=2e-3)


def test_every_weighed_part_is_in_a_vector_once() -> None:
    assert len(parts()) == len({(name, part) for name, part, _ in parts()})
    assert sum(int(np.prod(shape)) for _, _, shape in parts()) == vector_length()


def test_what_is_no_vector_is_refused() -> None:
    published = describe(crop("gravel", 0), metric="published")
    with pytest.raises(InputError, match="of the metric combined"):
        combined_vector(published)
    with pytest.raises(InputError, match="of the metric combined"):
        distances(published, np.zeros((1, vector_length())))
    with pytest.raises(InputError, match=rf"\(2, 7\); \(vectors, {vector_length()}\) is needed"):
        distances(describe(crop("gravel", 0)), np.zeros((2, 7)))


def test_libraries_that_were_made_under_former_names_are_no_others() -> None:
    names = {name for name, _, _ in definition()["parts"]}
    assert "swells" in names
    assert "low-pass" not in names
