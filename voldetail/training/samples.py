"""Training samples: what a photo shows, and the slopes and albedo that it was made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from voldetail.recover.gates import BRIGHTEST, DARKEST
from voldetail.recover.linear import slope_filter
from voldetail.recover.network import SLOWEST
from voldetail.training.camera import photographed
from voldetail.training.paint import LUMINANCE, albedo, blurred, chance, uniform
from voldetail.training.shade import parts, slopes

SIDE = 128
"""Pixels a side of a sample."""

MARGIN = 24
"""Pixels about it from which shadows fall in."""

SLOW = 16.0
"""Pixels: deviation of the local mean, over which luminance and chroma are taken. The same in recover.network."""

FLASH = 0.2
"""Share of samples under a near light."""

SEEN_BLUR = 0.6
"""Pixels: what is finer in the relief no photo shows."""


@dataclass(frozen=True)
class Batch:
    """features (B, 8, N, N): log luminance and two of chroma over their local means, the light as it is said to be, and the
    slopes that the linear step finds under it.

    p, q, paint (B, N, N): slopes, and log albedo over its local mean.
    """

    features: Tensor
    p: Tensor
    q: Tensor
    paint: Tensor


def _crops(
    pool: NDArray[np.float16], count: int, rng: np.random.Generator, closest: float = -0.6, farthest: float = 0.6
) -> Tensor:
    """Return random parts of the pool (B, N, N) of mean 0 and deviation 1, turned, mirrored and resized."""
    wide = SIDE + 2 * MARGIN
    out = torch.empty(count, wide, wide)
    for k in range(count):
        entry = pool[rng.integers(len(pool))]
        side = int(np.clip(wide * 2.0 ** rng.uniform(closest, farthest), 64, entry.shape[0]))
        top, left = rng.integers(0, entry.shape[0] - side + 1, 2)
        part = entry[top : top + side, left : left + side]
        part = np.rot90(part, int(rng.integers(4)))
        part = part[:, ::-1] if rng.random() < 0.5 else part
        values = torch.from_numpy(np.ascontiguousarray(part, np.float32))[None, None]
        out[k] = functional.interpolate(values, size=(wide, wide), mode="bicubic", antialias=side > wide, align_corners=False)[
            0, 0
        ]
    out = out - out.mean(dim=(1, 2), keepdim=True)
    return out / out.std(dim=(1, 2), keepdim=True).clamp_min(1e-4)


def _lights(count: int, generator: torch.Generator) -> tuple[Tensor, Tensor, Tensor]:
    """Return unit vectors (B, 3, N, N), the irradiance over pi (B, N, N), and vectors some degrees off, as a user says them."""
    wide = SIDE + 2 * MARGIN
    azimuth = uniform(generator, -0.3 * math.pi, 0.3 * math.pi, count)
    elevation = uniform(generator, math.radians(13), math.radians(82), count)
    axis = (torch.arange(wide, dtype=torch.float32) + 0.5) / wide - 0.5
    y, x = torch.meshgrid(-axis, axis, indexing="ij")
    near = chance(generator, FLASH, count)
    away = torch.exp2(uniform(generator, 0.0, 3.0, count))

    def vectors(az: Tensor, el: Tensor) -> tuple[Tensor, Tensor]:
        source = torch.cat([torch.cos(el) * torch.cos(az), torch.cos(el) * torch.sin(az), torch.sin(el)], dim=1) * away
        offset = source - near * torch.stack([x, y, torch.zeros_like(x)])[None]
        length = torch.linalg.vector_norm(offset, dim=1, keepdim=True)
        return offset / length, (away / length) ** 2

    def off() -> Tensor:
        return math.radians(5.0) * torch.randn(count, 1, 1, 1, generator=generator).clamp(-2.0, 2.0)

    light, falloff = vectors(azimuth, elevation)
    said, _ = vectors(azimuth + off(), (elevation + off()).clamp(math.radians(8), math.radians(88)))
    return light, falloff[:, 0], said


def make_batch(pool: NDArray[np.float16], count: int, seed: int) -> Batch:
    """Return ``count`` samples; the same seed and pool give the same."""
    rng = np.random.default_rng(seed)
    generator = torch.Generator().manual_seed(seed)
    shape = _crops(pool, count, rng)
    if rng.random() < 0.5:
        finer = _crops(pool, count, rng, -0.2, 0.6)
        shape = shape + uniform(generator, 0.0, 0.35, count)[:, 0] * finer
    raw_p, raw_q = slopes(shape)
    inner = slice(MARGIN, MARGIN + SIDE)
    steep = torch.sqrt((raw_p**2 + raw_q**2)[:, inner, inner].mean(dim=(1, 2), keepdim=True)).clamp_min(1e-3)
    height = shape / steep * torch.exp(uniform(generator, math.log(0.1), math.log(1.0), count))[:, 0]
    light, falloff, said = _lights(count, generator)
    exponent = torch.exp(uniform(generator, math.log(4.0), math.log(150.0), count)).view(-1)
    ambient, diffuse, lobe = parts(height, light, falloff, exponent)
    paint = albedo(shape, (_crops(pool, count, rng, -0.8, 0.6), _crops(pool, count, rng, 0.0, 0.6)), generator)
    share = uniform(generator, 0.0, 0.65, count)
    sun = 1.0 + 0.12 * uniform(generator, -0.3, 1.0, count) * torch.tensor([1.0, 0.0, -1.0]).view(1, 3, 1, 1)
    matt = paint * (
        (1.0 - share) * diffuse[:, None] * sun + share * ambient[:, None] * (2.0 - sun) * light[:, 2:].mean((2, 3), True)
    )
    gloss = chance(generator, 0.4, count) * torch.exp(uniform(generator, math.log(0.003), math.log(0.12), count))
    photo = photographed(matt + gloss * lobe[:, None], generator)
    log = torch.log(paint.mul(torch.tensor(LUMINANCE).view(1, 3, 1, 1)).sum(1, keepdim=True))
    seen = blurred(height[:, None], SEEN_BLUR)[:, 0]
    p, q = slopes(seen)
    part = (slice(None), inner, inner)
    found = features(photo)
    return Batch(
        torch.cat([found, said, linear_slopes(found[:, 0], said)], dim=1)[:, :, inner, inner].contiguous(),
        p[part].contiguous(), q[part].contiguous(), (log - blurred(log, SLOW))[:, 0][part].contiguous(),
    )  # fmt: skip


def linear_slopes(log: Tensor, said: Tensor) -> Tensor:
    """Return p and q (B, 2, N, N) of the linear step, from log luminance over its local mean and the light as it is said to
    be."""
    side = log.shape[-1]
    wy = -2.0 * np.pi * np.fft.fftfreq(side)[:, None]
    wx = 2.0 * np.pi * np.fft.rfftfreq(side)[None, :]
    directions = functional.normalize(said.mean(dim=(2, 3)), dim=1).tolist()
    filters = np.stack([slope_filter(wx, wy, (x, y, z), SLOWEST) for x, y, z in directions])
    detail = (torch.exp(log) - 1.0).clamp(DARKEST, BRIGHTEST)
    common = torch.fft.rfft2(detail) * torch.from_numpy(filters)
    waves = (torch.from_numpy(np.broadcast_to(w, filters.shape[1:]).astype(np.float32)) for w in (wx, wy))
    return torch.stack([torch.fft.irfft2(common * w, s=(side, side)) for w in waves], dim=1)


def features(photo: Tensor) -> Tensor:
    """Return log luminance and log R/G, B/G (B, 3, N, N) over their local means, of linear light."""
    luminance = photo.mul(torch.tensor(LUMINANCE).view(1, 3, 1, 1)).sum(1, keepdim=True)
    level = luminance.mean(dim=(1, 2, 3), keepdim=True)
    floor = 0.02 * level
    logs = torch.log(photo + floor)
    values = torch.cat([torch.log(luminance + floor), logs[:, :1] - logs[:, 1:2], logs[:, 2:] - logs[:, 1:2]], dim=1)
    return values - blurred(values, SLOW)
