"""The colour of a texture at any point (LVLD10 report, section 7), with frequency clamping, on Dr.Jit arrays.

    colour(x) = sum_c axes_c Hbar_c(z_c, r_c),      z_c = sum_i w_ci t_i N_ci(x) / s_c,      r_c = sum_i v_ci (1 - t_i^2)

Symbols
    N_ci    band i of channel c's wavelet noise            w_ci    its weight; v_ci its share of the channel's variance
    s_c     deviation of the channel's noise, sigma_N sqrt(sum_i w_ci^2): the article's eq. 14 prints w_i for its square
    t_i     what of a band's amplitude a pixel lets through (texture.clamping)
    Hbar_c  the curve averaged over what was removed (texture.filtered)

Where the channels add up to sRGB, what is wanted is the mean of the decoded colour. Over the removed parts the sRGB colour
has the mean m = sum_c axes_c Hbar_c and the variance V = sum_c axes_c^2 V_c, and

    E[decode(m + e)] = decode(m) + decode''(m) V / 2

to second order. The power 2.4 is nearly a square, of which that is exact; what remains is the clip to 0 to 1 and the curve's
straight foot near black.
"""

from __future__ import annotations

import math
import sys
from functools import lru_cache
from typing import Any

import drjit as dr
import numpy as np

from voldetail.detail.colour import ColourTexture
from voldetail.detail.structure_texture import StructureTexture, Texture
from voldetail.noise.lobes import LobeTable, lobe_noise, lobe_table
from voldetail.noise.triplanar import triplanar
from voldetail.noise.wavelet import held, wavelet_noise
from voldetail.noise.wavelet_spectrum import variance
from voldetail.texture.clamping import LARGEST_LOG, SMALLEST_LOG, STEPS, passed_table
from voldetail.texture.decoding import decoded
from voldetail.texture.filtered import COLUMNS, FARTHEST, ROWS, filtered_curve
from voldetail.texture.lobes import lobe_rows
from voldetail.texture.solid import slice_weights
from voldetail.texture.structures.colour import structure_colour

CHANNEL_SALT = 0x7FEB352D
"""Step of the seed from channel to channel of lobes; odd, else arbitrary."""

BOX_DEVIATION = 1.0 / math.sqrt(12.0)
"""Of a square pixel of side 1, each way."""

LEAST_SHARE = 1e-4
"""Beyond the curve's own first sample, and far enough from 0 for the normal quantile."""


def colour_at(
    texture: Texture,
    points: tuple[Any, ...],
    footprint: Any = 0.0,
    *,
    first: Any = None,
    normals: tuple[Any, ...] | None = None,
) -> tuple[Any, Any, Any]:
    """Return the linear colour, three Dr.Jit floats in 0 to 1, at ``points`` in texels of the analysed photo.

    points: 2 coordinates, or 3 for the solid texture, of which every plane has the 2D texture's histogram and, where a solid
    can, its spectrum. footprint: the side of a pixel in texels, a number or an array; 0 (default) is the value at a point.
    The photo's own pixels are values at points here: for one pixel a texel give 0. first: in place of the first channel's noise,
    the share of its values that lie below, in (0, 1), an array; it is not clamped. normals: of the surface at 3 coordinates,
    where channels of lobes, which have no solid form, are laid on it from three sides; without them they are seen along z.
    A two-tone structure is treated so as well; it knows no footprint and no first channel.
    """
    if isinstance(texture, StructureTexture):
        return structure_colour(texture, points, normals)
    float_type: Any = type(points[0])
    return evaluator(texture, len(points), float_type).colour(points, footprint, first, normals)


class Evaluator:
    """A texture's numbers on the device: one for each texture, number of coordinates and array type."""

    def __init__(self, texture: ColourTexture, dims: int, float_type: Any) -> None:
        self.float_type, self.dims = float_type, dims
        self.uint_type = dr.uint32_array_t(float_type)
        module = sys.modules[float_type.__module__]
        self.pair, self.packet = module.Array2f, module.Array4f
        self.noise = wavelet_noise(dims, float_type)
        amplitudes = band_amplitudes(texture, dims)
        self.amplitudes = held(amplitudes, float_type)
        self.count = dr.opaque(self.uint_type, band_total(texture))
        self.seed = dr.opaque(self.uint_type, texture.seed)
        self.passed = held(passed_table(dims), float_type)
        self.curves = held(np.stack([filtered_curve(channel.curve) for channel in texture.channels]), float_type)
        self.axes = [[dr.opaque(float_type, texture.axes[3 * c + k]) for k in range(3)] for c in range(3)]
        self.encoded = texture.encoding == "srgb"
        self.lobes = [lobe_table(lobe_rows(c.lobes), float_type) if c.lobes else None for c in texture.channels]

    def colour(self, points: tuple[Any, ...], footprint: Any, first: Any = None, normals: Any = None) -> tuple[Any, Any, Any]:
        """Return the linear colour at ``points``; see `colour_at`."""
        clamped = not (isinstance(footprint, (int, float)) and footprint == 0)
        if isinstance(footprint, (int, float)):
            footprint = dr.opaque(self.float_type, float(footprint))
        noise, removed = self._channels(points, footprint if clamped else None)
        for c, table in enumerate(self.lobes):
            if table is not None:
                noise[c], removed[c] = self._lobed(points, table, c, footprint if clamped else None, normals)
        if first is not None:
            # The normal score of a share: the curve takes those.
            score = math.sqrt(2.0) * dr.erfinv(2.0 * dr.clip(first, LEAST_SHARE, 1.0 - LEAST_SHARE) - 1.0)
            noise = self.packet(score, noise[1], noise[2], noise[3])
            removed = self.packet(0.0, removed[1], removed[2], removed[3])
        means, spreads = zip(*(self._curve(c, noise[c], removed[c] if clamped else None) for c in range(3)), strict=True)
        colour = []
        for k in range(3):
            mean = sum(self.axes[c][k] * means[c] for c in range(3))
            if self.encoded:
                spread = sum(dr.square(self.axes[c][k]) * spreads[c] for c in range(3)) if clamped else None
                mean = decoded(mean, spread)
            colour.append(dr.clip(mean, 0.0, 1.0))
        return colour[0], colour[1], colour[2]

    def _channels(self, points: tuple[Any, ...], footprint: Any) -> tuple[Any, Any]:
        """Return z and r, four values each of which three are used."""
        width = max(dr.width(p) for p in points)
        if footprint is not None:
            width = max(width, dr.width(footprint))
        packet = self.packet
        band, scale = dr.zeros(self.uint_type, width), dr.full(self.float_type, 1.0, width)
        state = (band, scale, dr.zeros(packet, width), dr.zeros(packet, width))

        def body(band: Any, scale: Any, total: Any, removed: Any) -> tuple[Any, ...]:
            amplitude = dr.gather(packet, self.amplitudes, band)
            values = self.noise.band(points, scale, band, self.seed)
            if footprint is not None:
                share = self._passed(footprint * scale)
                removed = removed + dr.square(amplitude) * ((1.0 - share) * self.float_type(variance(self.dims)))
                amplitude = amplitude * dr.sqrt(share)
            return band + 1, scale * 0.5, dr.fma(amplitude, values, total), removed

        _, _, total, removed = dr.while_loop(
            state, lambda band, scale, total, removed: band < self.count, body, label="bands of wavelet noise"
        )
        return total, removed

    def _lobed(self, points: tuple[Any, ...], table: LobeTable, channel: int, footprint: Any, normals: Any) -> tuple[Any, Any]:
        """Return z and r of a channel of lobes."""
        seed = self.seed + dr.opaque(self.uint_type, (channel + 1) * CHANNEL_SALT & 0xFFFFFFFF)
        sigma = None if footprint is None else footprint * BOX_DEVIATION
        if self.dims == 3 and normals is not None:
            value, left = triplanar(points, normals, table, seed, sigma)
        else:
            value, left = lobe_noise((points[0], points[1]), table, seed, sigma)
        return value / dr.sqrt(table.variance), 1.0 - left / table.variance

    def _passed(self, side: Any) -> Any:
        place = (dr.log2(dr.maximum(side, 1e-9)) - SMALLEST_LOG) * ((STEPS - 1) / (LARGEST_LOG - SMALLEST_LOG))
        place = dr.clip(place, 0.0, STEPS - 1.0)
        index = dr.minimum(self.uint_type(place), STEPS - 2)
        low, high = (dr.gather(self.float_type, self.passed, index + k) for k in (0, 1))
        return dr.fma(high - low, place - self.float_type(index), low)

    def _curve(self, channel: int, z: Any, removed: Any) -> tuple[Any, Any]:
        """Return mean and variance of the channel's curve over the removed noise."""
        along = dr.clip((z + FARTHEST) * ((COLUMNS - 1) / (2.0 * FARTHEST)), 0.0, COLUMNS - 1.0)
        column = dr.minimum(self.uint_type(along), COLUMNS - 2)
        along = along - self.float_type(column)
        first = self.uint_type(channel * ROWS * COLUMNS) + column
        if removed is None:
            value = self._between(first, along)
            return value[0], None
        down = dr.clip(removed * (ROWS - 1.0), 0.0, ROWS - 1.0)
        row = dr.minimum(self.uint_type(down), ROWS - 2)
        down = down - self.float_type(row)
        above, below = (self._between(first + (row + k) * COLUMNS, along) for k in (0, 1))
        value = dr.fma(below - above, self.pair(down), above)
        return value[0], value[1]

    def _between(self, index: Any, along: Any) -> Any:
        low, high = (dr.gather(self.pair, self.curves, index + k) for k in (0, 1))
        return dr.fma(high - low, self.pair(along), low)


@lru_cache(maxsize=64)
def evaluator(texture: ColourTexture, dims: int, float_type: Any) -> Evaluator:
    """Return the texture's `Evaluator`, made once: a second call with another texture compiles nothing."""
    return Evaluator(texture, dims, float_type)


def band_total(texture: ColourTexture) -> int:
    """Return how many wavelet bands have to be evaluated: none where all channels are of lobes."""
    return max(len(channel.weights) for channel in texture.channels)


def band_amplitudes(texture: ColourTexture, dims: int) -> Any:
    """Return w_ci / s_c (bands, 4) in 2 or 3 dimensions: the noise that they weigh has unit variance; the fourth is 0."""
    amplitudes = np.zeros((max(band_total(texture), 1), 4), np.float64)
    for c, channel in enumerate(texture.channels):
        weights = np.asarray(slice_weights(channel.weights) if dims == 3 else channel.weights)
        deviation = float(np.sqrt(variance(dims) * np.sum(weights**2)))
        if deviation > 0:
            amplitudes[: len(weights), c] = weights / deviation
    return amplitudes
