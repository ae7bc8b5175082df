"""Wavelet noise (Cook and DeRose, Wavelet Noise, 2005) at any position and scale, on Dr.Jit arrays.

    N(x) = sum over the 3^d nearest coefficients n_j of n_j B(x_1 - j_1) ... B(x_d - j_d),      N_i(x) = N(x / 2^i + o_i)

Symbols
    N       the noise: a quadratic B-spline surface, B the spline, n its coefficients (noise.wavelet_tile)
    N_i     band i, of wavelengths of about 2^(i+1) to 2^(i+2) texels (LVLD10, eq. 1 and 2, with i counted from the finest)
    o_i     the band's offset

The coefficients come from a tile, which repeats. So that a band does not, each block of the lattice as large as the tile is
moved along each axis by an amount hashed from the block's place along the other axes, the band and the seed. That takes the
offsets' part too, a hash word a band. Splines join what was torn smoothly; what remains is that within about three
coefficients of a block's border (3 % of the area in 2D, 13 % of the volume in 3D) the noise is not band-limited.

In 3D the lattice is turned (octave.TURN). A plane z = constant of a straight lattice would cut every coefficient at one
height, and its variance would depend on that height; turned, all heights occur in every plane.
"""

from __future__ import annotations

import sys
from functools import cache
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.noise.gabor import TURN
from voldetail.noise.lattice import cell_hash
from voldetail.noise.wavelet_spectrum import PHASE
from voldetail.noise.wavelet_tile import CHANNELS, SIDES, wavelet_tile

FIRST_MOVED = 2
BAND_STEP = 0.618034
"""From band FIRST_MOVED on, each band's lattice is moved by this share of a coefficient against the one before, so that the
edges between coefficients of all bands do not meet in the same lines. A raster of texels meets four or more places in a
coefficient of those bands, and so their variance does not depend on the phase (noise.wavelet_spectrum.PHASE)."""


class WaveletNoise:
    """A tile on the device, and the noise made of it: ``dims`` coordinates, CHANNELS independent noises at once.

    Variance of each: `wavelet_spectrum.variance(dims)`. Only gathers and integer hashes: the same bits for any number of
    threads and any split of the positions. side: of the tile in coefficients, a power of two.
    """

    def __init__(self, dims: int, float_type: Any, side: int = 0) -> None:
        if dims not in (2, 3):
            raise ValueError(f"wavelet noise of {dims} coordinates; 2 or 3 are known")
        self.dims, self.float_type = dims, float_type
        self.side = side or SIDES[dims]
        self.uint_type, self.int_type = dr.uint32_array_t(float_type), dr.int32_array_t(float_type)
        self.packet = getattr(sys.modules[float_type.__module__], f"Array{CHANNELS}f")
        self.tile = held(wavelet_tile(dims, self.side), float_type)

    def band(self, points: tuple[Any, ...], scale: Any, band: Any, seed: Any) -> Any:
        """Return N_band (CHANNELS values) at ``points`` (texels; dims coordinates).

        scale: 2^-band, coefficients a texel. band, seed: UInt32, which of the many independent noises.
        """
        one = self.float_type(1.0)
        index = self.float_type(self.uint_type(band))
        phase = dr.select(index < FIRST_MOVED, PHASE, dr.fma(index, BAND_STEP, PHASE))
        turned = _turned(points) if self.dims == 3 else points
        nodes, weights = [], []
        for x in turned:
            place = dr.fma(x, scale * one, phase)
            nearest = dr.floor(place + 0.5)
            t = place - nearest
            nodes.append(self.int_type(nearest))
            weights.append((0.5 * dr.square(0.5 - t), 0.75 - dr.square(t), 0.5 * dr.square(0.5 + t)))
        return self._sum(self._indices(nodes, band, seed), weights)

    def _indices(self, nodes: list[Any], band: Any, seed: Any) -> list[list[list[Any]]]:
        """Return for each axis and step (-1, 0, 1) the words by which the node moves each axis (its own: the index)."""
        salt = seed + self.uint_type(band) * np.uint32(self.dims)
        shift = int(self.side).bit_length() - 1
        indices = []
        for axis, node in enumerate(nodes):
            first, last = node - 1, node + 1
            words = [
                cell_hash(dr.reinterpret_array(self.uint_type, place >> shift), self.uint_type(axis), self.uint_type(band), salt)
                for place in (first, last)
            ]
            steps = []
            for step in (-1, 0, 1):
                place = node + step
                # Three neighbours lie in at most two blocks.
                same = (place >> shift) == (first >> shift)
                moves = [dr.select(same, words[0][other], words[1][other]) for other in range(self.dims)]
                moves[axis] = dr.reinterpret_array(self.uint_type, place)
                steps.append(moves)
            indices.append(steps)
        return indices

    def _sum(self, moves: list[list[list[Any]]], weights: list[tuple[Any, ...]]) -> Any:
        mask = self.side - 1
        total: Any = None
        for choice in np.ndindex(*(3,) * self.dims):
            index: Any = None
            weight: Any = None
            # The tile's last axis of space is x, the first coordinate.
            for axis in reversed(range(self.dims)):
                word = moves[0][choice[0]][axis]
                for other in range(1, self.dims):
                    word = word + moves[other][choice[other]][axis]
                place = word & mask
                index = place if index is None else index * self.side + place
                part = weights[axis][choice[axis]]
                weight = part if weight is None else weight * part
            value = dr.gather(self.packet, self.tile, index)
            total = value * weight if total is None else dr.fma(value, self.packet(weight), total)
        return total


def held(values: NDArray[np.float32], float_type: Any) -> Any:
    """Return ``values`` as one flat Dr.Jit array in Dr.Jit's own memory.

    An array that NumPy owns may lie at any address, and Dr.Jit fetches a packet of four at once only where addresses are
    multiples of 16 bytes: another kernel would be compiled for each kind of address.
    """
    flat = float_type(np.ascontiguousarray(values, np.float32).ravel())
    copy = flat * dr.opaque(float_type, 1.0)
    dr.eval(copy)
    return copy


@cache
def wavelet_noise(dims: int, float_type: Any) -> WaveletNoise:
    """Return the noise of `SIDES`, made once for each array type."""
    return WaveletNoise(dims, float_type)


def _turned(points: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(dr.fma(points[0], float(row[0]), dr.fma(points[1], float(row[1]), points[2] * float(row[2]))) for row in TURN)
