"""One octave of cellular-Gabor noise, GD10 eq. 2: envelope times stripes over the closest feature points.

Symbols
    N_{k,k',phi,theta}(x)   one octave, summed over the k-th to k'-th closest feature points P_i
    D       Euclidean distance in cells           sigma   envelope, SIGMA, chosen once (section 4)
    phi     stripes per cell                      theta_i stripe orientation of point i, in [0, theta]

Choices that the paper leaves open, or that are ours:
- The cosine runs about the feature point, with a hashed phase, and not about the origin: the statistics are
  the same (the position of a random point is the random phase) while gradients stay sane far from the origin.
  The phase is 2 pi phi u with u uniform in [0, 1), so phi = 0 gives cos = 1 as in the paper.
- (k, k') = (1, 50): the envelope reaches zero, with its slope, at KERNEL_RADIUS. No ball of that radius meets
  more than 50 cells, so the sum over the support is the sum over the 50 closest points, exactly,
  without jumps.
- k' <= 3 with stripes: where the rank of a point leaves the set, one stripe pattern would jump to another.
  The stripes fade to the plain envelope within RANK_FADE of such a change, which keeps N continuous. With phi
  = 0 nothing changes.
- In 3D the lattice is turned by TURN against the axes of X. A plane through a lattice that is aligned with it
  would cut every cell at one height and see its own statistics; turned, it cuts them at all heights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.noise.lattice import FOURTH_POINT_RADIUS, RANKS, UNIT_16, Neighbourhood, nearest_points
from voldetail.noise.plates import PlateShape, plate
from voldetail.noise.stones import StoneShape, highest_stone

SIGMA = 0.25
"""Envelope deviation in cells: exp(-D / 2 sigma) has fallen to 1/e at half a cell, about the mean distance to
the closest point (0.43 in 2D, 0.53 in 3D), so that single points stay visible without lone spikes."""

GAUSSIAN_SIGMA = 0.35
"""Deviation of the squared-distance envelope, in cells; chosen so that the closest point's kernel has about
the mean of the plain envelope's (0.49 for 0.45 in 2D, 0.37 for 0.37 in 3D). The round envelope falls off
faster beyond a cell, so deviation over mean is 1.4 to 2.9 times the plain envelope's, most where k = 2."""

KERNEL_RADIUS = {2: 1.8, 3: 1.118}
"""Support of the (1, 50) kernel in cells: at most 22 and 39 cells can meet it, both fewer than 50."""

RANK_FADE = 0.15
"""Width in cells over which stripes fade before the set of points changes; tuned by eye."""

FLOOR = 1e-12
"""Least squared distance: the square root's slope is infinite at zero, this keeps gradients finite."""


def _turn() -> NDArray[np.float64]:
    """Return the rotation of a fixed quaternion with irrational ratios."""
    quaternion = np.array([math.sqrt(2.0), 1.0, math.sqrt(0.75), (math.sqrt(5.0) - 1.0) / 2.0])
    a, b, c, d = quaternion / math.sqrt(2.0 + 1.0 + 0.75 + quaternion[3] ** 2)
    return np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
        ]
    )


TURN = _turn()
"""Rotation from the axes of X = S Q x to those of the 3D lattice."""


@dataclass(frozen=True)
class NoiseSettings:
    """What is discrete in the noise: decides which kernel is compiled or how often it runs.

    dims: 2 on surface parameters, 3 in space. everywhere: True for (1, 50). weights: signed weight of the 1st
    to 3rd closest point, used when not everywhere; (k, k') is ones from k to k'. octaves: n >= 1. gaussian:
    envelope of the squared distance (round tops) instead of eq. 2's plain distance (pointed tops). highest: the
    coarsest octave is made of stones (noise.stones), of which the highest counts, and `everywhere` holds. plates: each
    cell of the coarsest octave has a plane of its own (noise.plates), and `everywhere` does not hold.
    """

    dims: int = 3
    everywhere: bool = True
    weights: tuple[float, float, float] = (1.0, 1.0, 0.0)
    octaves: int = 1
    gaussian: bool = False
    highest: bool = False
    plates: bool = False

    @staticmethod
    def from_ranks(
        dims: int,
        first: int,
        last: int,
        octaves: int = 1,
        gaussian: bool = False,
        signs: tuple[float, ...] = (1.0, 1.0, 1.0),
        highest: bool = False,
        plates: bool = False,
    ) -> NoiseSettings:
        """Return the settings for GD10's k = first, k' = last: (1, 50) or any 1 <= k <= k' <= 3.

        ``signs`` weighs the first to third point where it is in the set; the paper's are all 1. With (1, -1) the noise
        falls to zero where two points are equally close: the border between cells.
        """
        if plates and (first, last) == (1, 50):
            raise ValueError("plates belong to cells: (k, k') = (1, 50) has none")
        if (first, last) == (1, 50):
            return NoiseSettings(dims, True, (1.0, 1.0, 1.0), octaves, gaussian, highest)
        if highest:
            raise ValueError(f"the highest of all stones needs (k, k') = (1, 50), not ({first}, {last})")
        if not 1 <= first <= last <= RANKS - 1:
            raise ValueError(f"(k, k') = ({first}, {last}) is neither (1, 50) nor 1 <= k <= k' <= 3")
        w = tuple(float(signs[i - 1]) if first <= i <= last else 0.0 for i in (1, 2, 3))
        return NoiseSettings(dims, False, (w[0], w[1], w[2]), octaves, gaussian, plates=plates)

    def of_octave(self, octave: int) -> NoiseSettings:
        """Return the settings of an octave; stones are the coarsest, and what is finer is their roughness; so are plates."""
        return replace(self, octaves=1, highest=self.highest and octave == 0, plates=self.plates and octave == 0)


def single_octave(x: tuple[Any, ...], settings: NoiseSettings, salt: Any, *numbers: Any) -> Any:
    """Return N(x), eq. 2, for ``x`` in cells; continuous everywhere, differentiable almost everywhere.

    ``numbers`` are the stripes' frequency phi and spread theta, and those of a `PlateShape` where there are plates; or those
    of a `StoneShape` where the highest counts.
    """
    return octave_and_owner(x, settings, salt, *numbers)[0]


def octave_and_owner(x: tuple[Any, ...], settings: NoiseSettings, salt: Any, *numbers: Any) -> tuple[Any, Any | None]:
    """Return `single_octave` and the hash word of the cell or stone that ``x`` belongs to, None where all points count."""
    if settings.highest:
        return highest_stone(x, salt, StoneShape(*numbers), settings.gaussian)
    if settings.everywhere:
        return _sum_of_all(x, settings, salt, *numbers), None
    total, owner, nearest = _sum_of_ranks(x, settings, salt, *numbers[:2])
    if settings.plates:
        total += plate(x, salt, nearest, PlateShape(*numbers[2:]))
    return total, owner


def _sum_of_all(x: tuple[Any, ...], settings: NoiseSettings, salt: Any, phi: Any, theta: Any) -> Any:
    radius = KERNEL_RADIUS[settings.dims]
    around = Neighbourhood(x, salt, radius)
    uint_type, float_type = type(salt), around.float_type
    width = dr.width(x[0])

    def body(index: Any, total: Any) -> tuple[Any, Any]:
        vector, word = around.vector(index)
        squared = _squared(vector)
        distance = dr.sqrt(dr.maximum(squared, FLOOR))
        window = dr.square(dr.maximum(1.0 - squared * (1.0 / radius**2), 0.0))
        value = _envelope(distance, settings.gaussian) * window * _stripes(vector, word, float_type, phi, theta)
        return index + 1, total + value

    _, total = dr.while_loop(
        (dr.zeros(uint_type, width), dr.zeros(float_type, width)),
        lambda index, total: index < around.count,
        body,
        max_iterations=around.count,
        label="sum over the support",
    )
    return total


def _sum_of_ranks(x: tuple[Any, ...], settings: NoiseSettings, salt: Any, phi: Any, theta: Any) -> tuple[Any, Any, Any]:
    weights = (*settings.weights, 0.0)
    last = max((i + 1 for i, w in enumerate(weights) if w != 0.0), default=1)
    # The point after the last one is needed only to know where stripes must fade.
    needed = dr.select(dr.detach(phi) != 0.0, type(salt)(last + 1), type(salt)(last))
    _, indices, _ = nearest_points(x, salt, needed)
    around = Neighbourhood(x, salt, FOURTH_POINT_RADIUS[settings.dims])
    float_type = around.float_type
    vectors = [around.vector(index) for index in indices]
    distances = [dr.sqrt(dr.maximum(_squared(v), FLOOR)) for v, _ in vectors]
    total = dr.zeros(float_type, dr.width(x[0]))
    for rank in range(RANKS - 1):
        if weights[rank] == 0.0:
            continue
        fade: Any = float_type(1.0)
        for border in range(RANKS - 1):  # between rank `border` and the next, counted from zero
            if weights[border] != weights[border + 1]:
                near, far = (rank, border + 1) if rank <= border else (border, rank)
                fade = fade * dr.clip((distances[far] - distances[near]) * (1.0 / RANK_FADE), 0.0, 1.0)
        stripes = _stripes(*vectors[rank], float_type, phi, theta)
        total += weights[rank] * _envelope(distances[rank], settings.gaussian) * (1.0 + (stripes - 1.0) * fade)
    return total, vectors[0][1], indices[0]


def _squared(vector: tuple[Any, ...]) -> Any:
    squared = vector[0] * vector[0]
    for component in vector[1:]:
        squared = dr.fma(component, component, squared)
    return squared


def _envelope(distance: Any, gaussian: bool) -> Any:
    if gaussian:
        return dr.exp(dr.square(distance) * (-0.5 / GAUSSIAN_SIGMA**2))
    return dr.exp(distance * (-0.5 / SIGMA))


def _stripes(vector: tuple[Any, ...], word: Any, float_type: Any, phi: Any, theta: Any) -> Any:
    """Return cos(2 pi phi (d . direction + u)), direction at a hashed angle in [0, theta], u hashed."""
    direction = float_type(word >> 16) * UNIT_16 * theta
    phase = float_type(word & 0xFFFF) * UNIT_16
    s, c = dr.sincos(direction)
    if len(vector) == 2:
        along = vector[0] * c + vector[1] * s
    else:  # the direction (c, s, 0), turned with the lattice
        along = sum(v * (c * float(TURN[row, 0]) + s * float(TURN[row, 1])) for row, v in enumerate(vector))
    # `vector` points from x to the feature point; the offset from the point is its negative.
    return dr.cos((2.0 * math.pi) * phi * (phase - along))
