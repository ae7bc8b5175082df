"""A detail of maps at points of a surface: as the photo is, or endless on any shape.

On a surface with two parameters the maps lie on the plane of these; elsewhere on three coordinate planes, weighted by the fourth
power of the normal's parts (noise.triplanar), each with places of its own. What is mixed are Gaussian scores (field.hexagons):

    g = sum_pk W_p w_pk g_pk / sqrt(sum_pk (W_p w_pk)^2)

W_p: the plane's weight, w_pk that of its part k. Scores become heights and colours again by the maps' own quantiles, so that no
mixture has less contrast than the photo.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import drjit as dr

from voldetail.detail.photo_relief import MappedDetail
from voldetail.field.hexagons import EDGE_SHARE, corners, hashed_place, offset_from
from voldetail.field.map_scores import CHANNELS, QUANTILES, Scores, scores_of
from voldetail.noise.triplanar import PLANES, plane_weights
from voldetail.noise.wavelet import held

LEAST_WEIGHT = 1e-4
"""Weight of a plane, of the largest, below which its maps are not looked up."""

Points = tuple[Any, ...]


class MapField:
    """The maps of a detail on the device, at the level whose texels are about ``spacing`` apart.

    spacing: between the points that will be asked for, in texels of the maps.
    """

    def __init__(self, detail: MappedDetail, spacing: float, float_type: Any) -> None:
        self.float_type, self.uint_type = float_type, dr.uint32_array_t(float_type)
        self.scores: Scores = scores_of(detail, spacing)
        self.rows, self.columns = self.scores.values.shape[:2]
        self.periodic = detail.record.periodic
        self.per_unit = detail.record.texels_per_unit / self.scores.factor
        self.channels = [held(self.scores.values[..., c], float_type) for c in range(CHANNELS)]
        self.own = [held(self.scores.plain[..., c], float_type) for c in range(CHANNELS)]
        self.quantiles = held(self.scores.quantiles, float_type)
        self.seed = dr.opaque(self.uint_type, detail.seed)

    def as_photo(self, x: Any, y: Any) -> list[Any]:
        """Return height, red, green and blue at (x, y), scene units from the photo's middle; mirrored or repeated beyond it."""
        column, row = x * self.per_unit + 0.5 * self.columns, 0.5 * self.rows - y * self.per_unit
        return self._between(self.own, column, row, mirror=not self.periodic)

    def endless(self, points: Points, normals: Points | None) -> list[Any]:
        """Return height, red, green and blue at ``points`` (scene units): from three sides where there are ``normals``."""
        total: list[Any] = [self.float_type(0.0)] * CHANNELS
        squares: Any = self.float_type(0.0)
        edge = EDGE_SHARE * min(self.rows, self.columns)
        if normals is None:
            planes = [(0, self.float_type(1.0), points[0], points[1])]
        else:
            planes = [
                (plane, weight, points[first], points[second])
                for plane, (weight, (first, second)) in enumerate(zip(plane_weights(normals), PLANES, strict=True))
            ]
        for plane, weight, x, y in planes:
            seen = weight > LEAST_WEIGHT
            column, row = x * self.per_unit, -y * self.per_unit
            words, shares = corners(column, row, edge)
            for word, share in zip(words, shares, strict=True):
                dx, dy = offset_from(word, column, row, edge)
                a, b = hashed_place(word, plane, self.seed)
                at = self._place(a, self.columns, edge) + dx, self._place(b, self.rows, edge) + dy
                values = self._between(self.channels, *at, mirror=not self.periodic, active=seen)
                both = weight * share
                total = [dr.fma(both, value, sum_) for value, sum_ in zip(values, total, strict=True)]
                squares = dr.fma(both, both, squares)
        scale = 1.0 / dr.sqrt(squares)
        return self._colours([value * scale for value in total])

    def _place(self, unit: Any, side: int, edge: float) -> Any:
        """Return where a part's middle is: anywhere in a tile, one edge from the border of a photo that has one."""
        return unit * float(side) if self.periodic else edge + unit * (side - 2.0 * edge)

    def _between(self, maps: list[Any], column: Any, row: Any, *, mirror: bool, active: Any = True) -> list[Any]:
        """Return the maps at texel places (0 at the first texel's left edge), bilinear."""
        c, r = column - 0.5, row - 0.5
        left, upper = dr.floor(c), dr.floor(r)
        fx, fy = c - left, r - upper
        columns = [self._index(left + k, self.columns, mirror) for k in (0, 1)]
        rows = [self._index(upper + k, self.rows, mirror) for k in (0, 1)]
        out = []
        for values in maps:
            a, b, c_, d = (dr.gather(self.float_type, values, i * self.columns + j, active) for i in rows for j in columns)
            out.append(dr.lerp(dr.lerp(a, b, fx), dr.lerp(c_, d, fx), fy))
        return out

    def _index(self, place: Any, side: int, mirror: bool) -> Any:
        """Return a whole ``place`` as an index of ``side`` texels: mirrored at the edges, or repeated."""
        period = 2.0 * side if mirror else float(side)
        within = place - period * dr.floor(place / period)
        if mirror:
            within = dr.minimum(within, period - 1.0 - within)
        return self.uint_type(dr.clip(within, 0.0, side - 1.0))

    def _colours(self, scores: list[Any]) -> list[Any]:
        """Return height and colour of Gaussian scores: each channel's quantiles, then the colour's axes."""
        found = []
        for channel, score in enumerate(scores):
            place = (score + self.scores.farthest) * ((QUANTILES - 1) / (2.0 * self.scores.farthest))
            along = dr.clip(place, 0.0, QUANTILES - 1.0)
            index = dr.minimum(self.uint_type(along), QUANTILES - 2)
            low, high = (dr.gather(self.float_type, self.quantiles, index + (channel * QUANTILES + k)) for k in (0, 1))
            found.append(dr.lerp(low, high, along - self.float_type(index)))
        axes, mean = self.scores.axes, self.scores.mean
        colour = [dr.clip(sum(float(axes[k, c]) * found[1 + c] for c in range(3)) + float(mean[k]), 0.0, 1.0) for k in range(3)]
        return [found[0], *colour]


def mapped_relief_and_albedo(
    detail: MappedDetail, domain: Points, scale: float = 1.0, *, spacing: float = 0.0, normals: Points | None = None
) -> tuple[Any, tuple[Any, Any, Any]]:
    """Return R in [0, 1] and the factor on the albedo in three channels at ``domain``, as `relief_and_albedo` does for noise.

    The factor is the albedo over its own mean luminance, which the reflectance's Ka and Kd hold. ``spacing``: of the points in
    scene units, between which the maps are averaged. ``normals``: of the bare shape, for the domain "solid".
    """
    float_type: Any = type(domain[0])
    field = map_field(detail, spacing / scale * detail.record.texels_per_unit, float_type)
    points = tuple(v * dr.opaque(float_type, 1.0 / scale) for v in domain)
    if detail.arrangement == "photo":
        height, *colour = field.as_photo(points[0], points[1])
    else:
        height, *colour = field.endless(points, normals if detail.domain == "solid" else None)
    inverse = dr.opaque(float_type, 1.0 / field.scores.luminance)
    r, g, b = (v * inverse for v in colour)
    return height, (r, g, b)


@lru_cache(maxsize=8)
def map_field(detail: MappedDetail, spacing: float, float_type: Any) -> MapField:
    """Return the detail's `MapField`, made once."""
    return MapField(detail, spacing, float_type)
