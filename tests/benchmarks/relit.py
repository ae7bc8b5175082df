"""What the benchmarks of unseen lights share: distances in units of a photo's own halves, height maps and sheets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import binary_erosion, gaussian_filter, map_coordinates

from tests.benchmarks.kept import keep
from tests.benchmarks.yardsticks import reference
from voldetail.backend import mitsuba
from voldetail.detail import Reflectance
from voldetail.fit.reflectance import solve
from voldetail.image import to_srgb
from voldetail.render.heightfield import MARGIN, HeightField
from voldetail.render.unit_components import Components, components
from voldetail.results import AmplitudeInterval, Target
from voldetail.setup.lamp import Lamp

Picture = NDArray[np.float32]
Mask = NDArray[np.bool_]

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"

SUBSAMPLES = 2
"""As in the fit, so that fit and photo are as sharp as they were there."""

BRIGHTNESS_BLUR = 1.0
"""Pixels by which brightness is blurred before it is taken for height: sensor grain would be spikes."""

SIDE_BLUR = 1.0
"""Pixels of blur for `side`: on the pebble wall's four photos one pixel tells the sides apart best, of 1, 2 and 4."""


class Yardstick:
    """Distances from one picture, in units of the distance between its own left and right half."""

    def __init__(self, luminance: Picture, mask: Mask, metrics: Sequence[str]) -> None:
        self.mask = mask
        self._references = {metric: reference(luminance, metric, mask) for metric in metrics}
        half = luminance.shape[1] // 2
        one, other = (np.ascontiguousarray(luminance[:, part]) for part in (slice(None, half), slice(-half, None)))
        one_mask, other_mask = (np.ascontiguousarray(mask[:, part]) for part in (slice(None, half), slice(-half, None)))
        self.halves = {metric: reference(one, metric, one_mask).distance(other, other_mask) for metric in metrics}

    def ratios(self, luminance: Picture) -> dict[str, float]:
        """Return the distance of another picture by each metric, in units of the halves' own."""
        return {
            metric: round(one.distance(luminance, self.mask) / self.halves[metric], 3) for metric, one in self._references.items()
        }


def side(luminance: Picture, mask: Mask) -> NDArray[np.float64]:
    """Return from which side a picture looks lit: E(|g|^2 g) / E(|g|^2)^(3/2), g the slope of its brightness, y up.

    Shadows and turned faces are sharper away from the light, so the number points away from a side light, and is 0 for
    a picture as steep one way as the other. Texture metrics hardly see the difference: they are made of even statistics.
    """
    down, right = np.gradient(gaussian_filter(to_srgb(luminance).astype(np.float64), SIDE_BLUR))
    # What the blur brings in from outside the mask does not count.
    inside = binary_erosion(mask, iterations=round(3 * SIDE_BLUR), border_value=1)
    gradient = np.stack([right[inside], -down[inside]])
    squared = np.sum(gradient**2, axis=0)
    return np.asarray((gradient * squared).mean(axis=1) / max(float(squared.mean()) ** 1.5, 1e-12))


def exposed(picture: Picture, like: Picture, mask: Mask, white: float) -> Picture:
    """Return ``picture`` (H, W) or (H, W, 3) at the mean of ``like`` over the mask, clipped at ``white``."""
    gain = float(like[mask].mean() / max(float(picture[mask].mean()), 1e-9))
    return np.asarray(np.minimum(picture * gain, white), dtype=np.float32)


def lit_picture(surface: HeightField, lamp: Lamp, reflectance: Reflectance) -> Picture:
    """Return the picture (H, W, 3) of a surface as it was last raised."""
    parts = components(surface, lamp, subsamples=SUBSAMPLES, shininess=(reflectance.shininess,))
    return parts.colour(reflectance)


def heights_of(surface: HeightField, margin: int = 0) -> NDArray[np.float64]:
    """Return the heights over the window and ``margin`` pixels around it, (rows + 1, columns + 1) without one."""
    z = np.asarray(surface.z, dtype=np.float64).reshape(surface.rows, surface.columns)
    first, end = MARGIN - margin, MARGIN + margin + 1
    return z[first : surface.view.rows + end, first : surface.view.columns + end]


def height_record(found: AmplitudeInterval, fitted: float, needed: float) -> dict[str, Any]:
    """Return an interval as factors of the ``fitted`` amplitude, and whether the factor ``needed`` for the truth is inside.

    needed_rise: the distance at that factor over the lowest one, the least tolerance that would have let it in.
    """
    factors, distances = np.array(found.amplitudes) / fitted, np.array(found.distances_any)
    rise = float(np.interp(np.log(needed), np.log(factors), distances) / min(*found.distances, *distances))
    ends = {key: round(value / fitted, 3) for key, value in found.ends.items()}
    return {
        "needed": round(needed, 3),
        "needed_rise": round(rise, 3),
        **ends,
        "inside": ends["low"] <= needed <= ends["high"],
        "inside_any": ends["low_any"] <= needed <= ends["high_any"],
        "factors": [round(float(f), 3) for f in factors],
        "distances": [round(d, 3) for d in found.distances],
        "distances_any": [round(d, 3) for d in found.distances_any],
    }


def raise_to(surface: HeightField, heights: NDArray[np.floating]) -> None:
    """Raise a surface to heights (rows, columns) of all its vertices, its margin included."""
    surface.raise_to(mitsuba().Float(np.ascontiguousarray(heights, dtype=np.float32).ravel()))


def slopes(heights: NDArray[np.floating], step: float) -> NDArray[np.float64]:
    """Return how steep a height map is, the length of its gradient, where central differences exist."""
    down, right = np.gradient(heights, step)
    return np.asarray(np.hypot(down, right)[1:-1, 1:-1], dtype=np.float64)


def raise_by_brightness(surface: HeightField, flat: Picture, steepness: float) -> None:
    """Take brightness for height: what is done where there is one photo and nothing else.

    ``flat`` is the luminance with the light's own fall-off taken away; it is encoded, as such programs read it, and
    scaled so that its slopes over the window have the root mean square ``steepness``. Outside the window it is mirrored.
    """
    blurred = gaussian_filter(to_srgb(flat).astype(np.float64), BRIGHTNESS_BLUR, mode="reflect")
    # Vertices are at the corners of pixels.
    row, column = (np.arange(n) - MARGIN - 0.5 for n in (surface.rows, surface.columns))
    height = map_coordinates(blurred, np.meshgrid(row, column, indexing="ij"), order=1, mode="reflect")
    window = height[MARGIN : MARGIN + flat.shape[0] + 1, MARGIN : MARGIN + flat.shape[1] + 1]
    found = float(np.sqrt(np.mean(slopes(window, surface.step) ** 2)))
    raise_to(surface, height * (steepness / max(found, 1e-9)))


def reflectance_under(surface: HeightField, target: Target, *, specular: bool) -> Reflectance:
    """Return the reflectance that the fit's own solve finds for a surface under the photo's light."""
    parts: Components = components(surface, target.lamp, subsamples=SUBSAMPLES)
    found = solve(target.luminance, parts, target.mask, specular=specular)
    return Reflectance(
        ambient=found.ambient, diffuse=found.diffuse, specular=found.specular, shininess=found.shininess, tint=target.tint
    )


def save_sheet(path: Path, rows: Sequence[Sequence[Picture]], gap: int = 4) -> None:
    """Save pictures (H, W, 3), linear, as a table with white gaps."""
    lines = []
    for row in rows:
        spaced = [np.pad(np.clip(to_srgb(p), 0, 1), ((0, gap), (0, gap), (0, 0)), constant_values=1) for p in row]
        lines.append(np.concatenate(spaced, axis=1))
    page = Image.fromarray(np.round(np.concatenate(lines) * 255).astype(np.uint8))
    keep(path, page)


def markdown(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"
