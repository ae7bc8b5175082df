"""Pictures of height fields, many at once, in torch: light with cast shadows, a sky with occlusion, gloss.

The formulas are those of `render.heightfield` and `render.unit_components` (GD10 section 7), so that what is learnt is what is
rendered; the test renders by Mitsuba.

Shapes: B samples of N x N pixels. Heights in pixels, row 0 on top; x right, y up, z to the viewer.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor
from torch.nn import functional

SHADOW_STEPS = (1.0, 2.0, 3.0, 4.5, 6.5, 9.0, 12.0, 16.0, 21.0)
"""Pixels towards the light at which something may stand before it."""

PENUMBRA = 0.4
"""Pixels of height across which a shadow begins."""

HORIZON_STEPS = (1, 2, 4, 7, 12, 18)
AZIMUTHS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))


def slopes(height: Tensor) -> tuple[Tensor, Tensor]:
    """Return dh/dx and dh/dy (up), (B, N, N), central differences; the edges wrap and are cut off later."""
    p = 0.5 * (torch.roll(height, -1, 2) - torch.roll(height, 1, 2))
    q = 0.5 * (torch.roll(height, 1, 1) - torch.roll(height, -1, 1))
    return p, q


def normals(p: Tensor, q: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return the three parts of the unit normal (-p, -q, 1) / |.|."""
    inverse = torch.rsqrt(1.0 + p * p + q * q)
    return -p * inverse, -q * inverse, inverse


def lit(height: Tensor, light: Tensor) -> Tensor:
    """Return how much of the light reaches each point, 0 to 1: ``light`` (B, 3), its mean direction over the sample."""
    count, side = height.shape[0], height.shape[1]
    flat = torch.linalg.vector_norm(light[:, :2], dim=1).clamp_min(1e-4)
    dx, dy, rise = light[:, 0] / flat, -light[:, 1] / flat, light[:, 2] / flat
    theta = torch.zeros(count, 2, 3)
    theta[:, 0, 0] = theta[:, 1, 1] = 1.0
    over = torch.full_like(height, -1e3)
    for step in SHADOW_STEPS:
        theta[:, 0, 2], theta[:, 1, 2] = dx * (2.0 * step / side), dy * (2.0 * step / side)
        grid = functional.affine_grid(theta, [count, 1, side, side], align_corners=False)
        there = functional.grid_sample(height[:, None], grid, align_corners=False, padding_mode="border")[:, 0]
        over = torch.maximum(over, there - height - (step * rise)[:, None, None])
    return (0.5 - over / PENUMBRA).clamp(0.0, 1.0)


def sky(height: Tensor, n: tuple[Tensor, Tensor, Tensor]) -> Tensor:
    """Return the cosine-weighted share of the sky that is seen, as `HeightField` does."""
    total = torch.zeros_like(height)
    for ax, ay in AZIMUTHS:
        length = math.hypot(ax, ay)
        slope = torch.zeros_like(height)
        for step in HORIZON_STEPS:
            there = torch.roll(height, (ay * step, -ax * step), (1, 2))
            slope = torch.maximum(slope, (there - height) / (step * length))
        cosine_squared = 1.0 / (1.0 + slope * slope)
        along = (n[0] * ax + n[1] * ay) / length
        lobe = along * (0.5 * (0.5 * math.pi - torch.atan(slope)) - 0.5 * slope * cosine_squared)
        total = total + (lobe + 0.5 * n[2] * cosine_squared).clamp_min(0.0)
    return total * (2.0 / len(AZIMUTHS))


def parts(height: Tensor, light: Tensor, falloff: Tensor, exponent: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return the components A, D and S_n (B, N, N) for albedo 1.

    light (B, 3, N, N): unit vectors to the light; falloff (B, N, N): its irradiance over pi; exponent (B,): n of the lobe.
    """
    n = normals(*slopes(height))
    cosine = (n[0] * light[:, 0] + n[1] * light[:, 1] + n[2] * light[:, 2]).clamp_min(0.0)
    received = cosine * falloff * lit(height, light.mean(dim=(2, 3)))
    mirrored = (2.0 * cosine * n[2] - light[:, 2]).clamp_min(0.0)
    power = exponent[:, None, None]
    return sky(height, n), received, 0.5 * (power + 2.0) * mirrored**power * received
