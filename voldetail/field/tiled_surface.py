"""The surface of a hypertexture whose grid is too large to fill: block by block, and only where the surface can be.

Each block is baked and marched alone, by the same code and to the same densities as the grid as a whole, so that the faces of
all blocks together are those of `isosurface`. What joins them is whose they are, not where: a vertex on the face between two
blocks lies on one step of the grid, and the step's number is its name in both. Memory goes with the surface.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from voldetail.backend import mitsuba
from voldetail.errors import InputError, VoldetailError
from voldetail.field.hypertexture import Hypertexture
from voldetail.field.shell import check_depth, on_block
from voldetail.field.shell_blocks import HALO, mesh_blocks, near_blocks
from voldetail.field.shell_grid import SIDE
from voldetail.field.shell_plan import BYTES_A_TILED_VERTEX, BYTES_AT_LEAST
from voldetail.geometry import isosurface as whole
from voldetail.geometry.isosurface import DEFAULT_BUDGET, LEAST_ISLAND, Isosurface
from voldetail.geometry.mesh_distance import Grid
from voldetail.geometry.topology import edges


@dataclass(frozen=True, eq=False)
class Piece:
    """The surface within one block.

    steps (V, 3): vertices, x first, in steps from the block's first middle, which has the number ``first``, z first. normals
    (V, 3), empty where they are found later. faces (F, 3). part: of each vertex, and volumes: of each part (see `bodies`).
    seam: the vertices on the block's sides, and names: of their steps in the grid. open_sides (E, 2): the names at the start
    and the end of each face's side that has no other in the block.
    """

    first: Grid
    steps: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.uint32]
    part: NDArray[np.int32]
    volumes: NDArray[np.float64]
    seam: NDArray[np.int64]
    names: NDArray[np.int64]
    open_sides: NDArray[np.int64]


def tiled_isosurface(
    hypertexture: Hypertexture,
    level: float | None = None,
    on_progress: Callable[[int, int], None] | None = None,
    least_island: float = LEAST_ISLAND,
    budget: int = DEFAULT_BUDGET,
) -> Isosurface:
    """Return where ``hypertexture`` has the density ``level`` (its own where none is given) on the grid of its plan.

    The same as `isosurface` of what it bakes to, with its `outward_at`, up to rounding and the order of vertices and faces.
    on_progress: told after each block how many are done, and how many there are. Raises InputError where there is no surface,
    where a mesh is thinner than the shell, and as soon as the vertices take more than ``budget`` bytes.
    """
    level = hypertexture.level if level is None else level
    whole.check_level(level)
    pieces: list[Piece] = []
    plan = hypertexture.shell.plan
    blocks = near_blocks(plan)
    count, densest, most = 0, 0.0, max(budget - BYTES_AT_LEAST, 0.0) / BYTES_A_TILED_VERTEX
    for done, (first, texture, density) in enumerate(_baked(hypertexture, blocks), 1):
        densest = max(densest, float(density.max()))
        if density.min() < level < density.max():
            pieces.append(_piece(texture, first, density, level))
            count += len(pieces[-1].steps)
        if count > most:
            share = done / len(blocks)
            raise InputError(
                f"After {share:.0%} of the grid its surface has {count} vertices, and needs more than the"
                f" {budget / 2**20:.0f} MB allowed: use an edge of {plan.edge * max(1.05, share**-0.5):.3g} scene units or more,"
                f" or allow {(count / share * BYTES_A_TILED_VERTEX + BYTES_AT_LEAST) / 2**20:.0f} MB."
            )
        if on_progress is not None:
            on_progress(done, len(blocks))
    whole.check_densest(densest, level)
    return _joined(hypertexture, pieces, least_island)


def _baked(hypertexture: Hypertexture, blocks: NDArray[np.int64]) -> Iterator[tuple[Grid, Hypertexture, NDArray[np.float32]]]:
    """Yield each block's first middle (z, y, x), the hypertexture with the distances about it, and its densities."""
    shell, count = hypertexture.shell, SIDE + 1
    numbers: list[Grid] = [(z, y, x) for z, y, x in blocks.tolist()]
    if shell.plan.mesh is None:
        for first in numbers:
            yield first, hypertexture, np.array(hypertexture.bake_block(first, count)).reshape(count, count, count)
        return
    deepest, inner = 0.0, slice(HALO, HALO + count)
    for first, values in zip(numbers, mesh_blocks(shell.plan, blocks), strict=True):
        deepest = max(deepest, -float(values.min()))
        z, y, x = (number - HALO for number in first)
        texture = replace(hypertexture, shell=on_block(shell, (z, y, x), values))
        # The values themselves, not interpolated: neighbours have the same to the bit.
        distance = mitsuba().Float(values[inner, inner, inner].ravel())
        yield first, texture, np.array(texture.bake_block(first, count, distance)).reshape(count, count, count)
    check_depth(shell.plan, deepest)


def _piece(texture: Hypertexture, first: Grid, density: NDArray[np.float32], level: float) -> Piece:
    plan = texture.shell.plan
    steps, faces = whole.march(density, level)
    cells = steps + np.asarray(first[::-1]) + 0.5
    normals = np.empty((0, 3))
    if plan.mesh is not None:  # its distances are known here and now only
        normals = whole.outward_normals((cells * plan.edge + np.asarray(plan.lower)).astype(np.float32), texture.outward_at)
    part, volumes = whole.bodies(cells, faces)
    on_side = ((steps == 0.0) | (steps == SIDE)).any(axis=1)
    seam = np.flatnonzero(on_side)
    names = np.full(len(steps), -1)
    names[seam] = _names(steps[seam], first, plan.shape)
    found = edges(faces)
    balance = np.bincount(found.number, found.upwards * 2.0 - 1.0)
    lone = found.sides[found.number] == 1
    open_sides = np.stack([names[faces.T.reshape(-1)[lone]], names[faces[:, [1, 2, 0]].T.reshape(-1)[lone]]], axis=1)
    if balance[found.sides > 1].any() or open_sides.min(initial=0) < 0:
        raise VoldetailError("The surface has a hole within a block of the grid, which is an error of this program.")
    return Piece(
        first,
        steps.astype(np.float32),
        normals.astype(np.float32),
        faces.astype(np.uint32),
        part,
        volumes,
        seam,
        names[seam],
        open_sides,
    )


def _names(steps: NDArray[np.float64], first: Grid, shape: Grid) -> NDArray[np.int64]:
    """Return the numbers, in the whole grid, of the steps on which vertices lie: from which middle, and along which axis."""
    start = np.floor(steps).astype(np.int64)
    along = steps != start
    if not (along.sum(axis=1) == 1).all():
        raise VoldetailError("A vertex lies on no step of the grid, which is an error of this program.")
    x, y, z = (start[:, axis] + first[2 - axis] + 1 for axis in range(3))
    # The grid and the empty layer about it; blocks end up to SIDE beyond, where nothing has a surface.
    _, ny, nx = shape
    return np.asarray(((z * (ny + 2) + y) * (nx + 2) + x) * 3 + along.argmax(axis=1))


def _joined(hypertexture: Hypertexture, pieces: list[Piece], least: float) -> Isosurface:
    """Return the pieces as one mesh without crumbs, and check that it is closed. ``pieces`` is emptied on the way."""
    plan = hypertexture.shell.plan
    names, where = np.unique(np.concatenate([piece.names for piece in pieces]), return_inverse=True)
    _check_closed(names, np.concatenate([piece.open_sides for piece in pieces]))
    ends = np.cumsum([len(piece.names) for piece in pieces])
    keeps, dropped = _kept_parts(pieces, where, len(names), least)
    # As long as all pieces together; what stays unused at the end takes no memory.
    cells = np.empty((sum(len(piece.steps) for piece in pieces), 3))
    normals = np.empty((len(cells), 3), np.float32)
    faces = np.empty((sum(len(piece.faces) for piece in pieces), 3), np.uint32)
    # The number of a seam's vertex in the whole is given by the first piece that has it.
    number = np.full(len(names), -1)
    count = used = 0
    flat = []
    pieces.reverse()
    for end, keep in zip(ends, keeps, strict=True):
        piece = pieces.pop()
        shared = where[end - len(piece.names) : end]
        mine = keep[piece.part]
        mine[piece.seam[number[shared] >= 0]] = False
        numbers = np.full(len(mine), -1)
        new = slice(count, count := count + int(mine.sum()))
        numbers[mine] = np.arange(new.start, count)
        fresh = number[shared] < 0
        number[shared[fresh]] = numbers[piece.seam[fresh]]
        numbers[piece.seam] = number[shared]
        cells[new] = piece.steps[mine].astype(np.float64) + np.asarray(piece.first[::-1])
        if len(piece.normals):
            normals[new] = piece.normals[mine]
        kept = piece.faces[keep[piece.part[piece.faces[:, 0]]]]
        flat.append(used + whole.flat(piece.steps, kept))
        faces[used : (used := used + len(kept))] = numbers[kept]
    cells, normals, faces = cells[:count], normals[:count], faces[:used]
    # Faces back to back in the side between two blocks; within a block they are gone.
    stays = whole.unpaired(cells, faces, np.concatenate(flat))
    if not stays.all():
        faces = faces[stays]
    cells += 0.5
    vertices = (cells * plan.edge + np.asarray(plan.lower)).astype(np.float32)
    if plan.mesh is None:
        normals = whole.outward_normals(vertices, hypertexture.outward_at).astype(np.float32)
    whole.mend_normals(normals, cells, faces, plan.shape)
    return Isosurface(vertices, faces, normals, dropped)


def _kept_parts(pieces: list[Piece], where: NDArray[np.int64], names: int, least: float) -> tuple[list[NDArray[np.bool_]], int]:
    """Return which parts of each piece belong to a body that is large enough, and how many bodies do not."""
    counts = [len(piece.volumes) for piece in pieces]
    starts = np.cumsum([0, *counts])
    part = np.concatenate([start + piece.part[piece.seam] for start, piece in zip(starts[:-1], pieces, strict=True)])
    # Parts and seams' vertices are the nodes of one graph.
    size = int(starts[-1])
    graph = sparse.coo_matrix((np.ones(len(part), np.int8), (part, size + where)), shape=(size + names,) * 2)
    _, label = csgraph.connected_components(graph, directed=False)
    body = label[:size]
    volume = np.bincount(body, np.concatenate([piece.volumes for piece in pieces])).astype(np.float64)
    keep = whole.large_enough(volume, least)
    return np.split(keep[body], starts[1:-1]), int(np.count_nonzero(~keep))


def _check_closed(names: NDArray[np.int64], open_sides: NDArray[np.int64]) -> None:
    """Refuse to return a surface with a hole: each side of a face at a seam needs one that runs the other way."""
    start, end = np.searchsorted(names, open_sides).T
    there, back = np.sort(start * len(names) + end), np.sort(end * len(names) + start)
    if not (np.array_equal(there, back) and (np.diff(there) > 0).all()):
        raise VoldetailError("The surface has a hole between two blocks of the grid, which is an error of this program.")
