"""What happens to light on its way into a photo: blur, sharpening, exposure, noise, 8 bits, JPEG, a tone curve slightly off."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from voldetail.training.paint import blurred, chance, uniform

BLOCK = 8


def encode(linear: Tensor) -> Tensor:
    """Return sRGB of linear light, 0 to 1."""
    x = linear.clamp(0.0, 1.0)
    return torch.where(x <= 0.0031308, 12.92 * x, 1.055 * x.clamp_min(0.0031308) ** (1.0 / 2.4) - 0.055)


def decode(stored: Tensor) -> Tensor:
    """Return linear light of sRGB."""
    x = stored.clamp(0.0, 1.0)
    return torch.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def photographed(light: Tensor, generator: torch.Generator) -> Tensor:
    """Return the linear light (B, 3, N, N) that a reader finds in a photo of ``light``."""
    count = light.shape[0]
    mean = light.mean(dim=(1, 2, 3), keepdim=True).clamp_min(1e-4)
    exposed = light / mean * torch.exp(uniform(generator, math.log(0.08), math.log(0.5), count))
    soft = float(torch.rand(1, generator=generator)) * 1.1
    if soft > 0.3:
        exposed = blurred(exposed, soft)
    stored = encode(exposed)
    sharp = uniform(generator, 0.0, 0.9, count) * chance(generator, 0.4, count)
    stored = stored + sharp * (stored - blurred(stored, 1.0))
    noise = uniform(generator, 0.0, 0.018, count)
    stored = stored + noise * torch.randn(stored.shape, generator=generator)
    stored = _jpeg(stored, uniform(generator, 0.0, 0.035, count) * chance(generator, 0.5, count))
    stored = torch.round(stored.clamp(0.0, 1.0) * 255.0) / 255.0
    gamma = uniform(generator, 0.87, 1.15, count)
    return decode(stored).clamp_min(1e-5) ** gamma


def _jpeg(stored: Tensor, step: Tensor) -> Tensor:
    """Return pictures whose 8 x 8 cosine blocks are rounded by ``step`` (B, 1, 1, 1), coarser for higher frequencies."""
    count, channels, side = stored.shape[:3]
    blocks = side // BLOCK
    k = torch.arange(BLOCK, dtype=torch.float32)
    matrix = torch.cos(math.pi / BLOCK * (k[None, :] + 0.5) * k[:, None]) * math.sqrt(2.0 / BLOCK)
    matrix[0] *= math.sqrt(0.5)
    cut = stored[..., : blocks * BLOCK, : blocks * BLOCK].reshape(count, channels, blocks, BLOCK, blocks, BLOCK)
    cosines = torch.einsum("uy,bciyjx,vx->bciujv", matrix, cut, matrix)
    quantum = step.view(-1, 1, 1, 1, 1, 1) * (0.4 + (k[:, None, None] + k[None, None, :]) / BLOCK)
    rounded = torch.where(quantum > 1e-4, torch.round(cosines / quantum.clamp_min(1e-4)) * quantum, cosines)
    back = torch.einsum("uy,bciujv,vx->bciyjx", matrix, rounded, matrix).reshape(count, channels, blocks * BLOCK, blocks * BLOCK)
    out = stored.clone()
    out[..., : blocks * BLOCK, : blocks * BLOCK] = back
    return out
