"""Matrices in pieces: rows as from the array that they make up, and queries with the same answers."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.library import Table, nearest, table
from voldetail.library.pieces import Columns, Rows
from voldetail.library.tables import BLOCK, TOGETHER, worked_out
from voldetail.library.vectors import LENGTH, turned


def rows_of(matrix: NDArray[np.float32], step: int) -> Rows[np.float32]:
    return Rows(matrix.shape, step, np.float32, lambda k: matrix[k * step : (k + 1) * step])


def in_pieces(whole: Table, step: int) -> Table:
    columns = Columns(whole.outlines.shape, step, lambda k: np.asarray(whole.outlines)[:, k * step : (k + 1) * step].copy())
    return Table(rows_of(whole.vectors, step), whole.weights, rows_of(whole.norms, step), columns)


@pytest.mark.parametrize("step", [1, 3, 10, 29, 100])
def test_rows_are_taken_as_from_the_array(step: int) -> None:
    matrix = np.arange(29 * 4, dtype=np.float32).reshape(29, 4)
    rows = rows_of(matrix, step)
    assert (len(rows), rows.shape) == (29, (29, 4))
    for numbers in (7, slice(5, 23), slice(None), [28, 0, 3, 3, 27], np.arange(29)[::-1], np.array([], int)):
        assert np.array_equal(rows[numbers], matrix[numbers])
    assert np.array_equal(np.asarray(rows), matrix)
    for number in (29, -1, [3, 29]):
        with pytest.raises(IndexError):
            rows[number]


@pytest.mark.parametrize("step", [7, 1000, 4000])
def test_a_table_in_pieces_answers_as_the_whole(step: int) -> None:
    rng = np.random.default_rng(3)
    vectors = rng.random((4000, LENGTH), dtype=np.float32)
    query = rng.random(LENGTH, dtype=np.float32)
    vectors[::50] = turned(query, 5) + 0.01 * vectors[::50]
    whole = table(vectors)
    assert nearest(in_pieces(whole, step), query, top=20) == nearest(whole, query, top=20)


def test_what_is_worked_out_of_an_entry_hangs_neither_on_its_neighbours_nor_on_blocks() -> None:
    vectors = np.random.default_rng(4).random((BLOCK + 5, LENGTH), dtype=np.float32)
    whole = table(vectors)
    for first in (0, TOGETHER, 160, BLOCK):
        norms, outlines = worked_out(vectors[first : first + 4 * TOGETHER], whole.weights)
        assert np.array_equal(norms, whole.norms[first : first + 4 * TOGETHER])
        assert np.array_equal(outlines, whole.outlines[:, first : first + 4 * TOGETHER])
