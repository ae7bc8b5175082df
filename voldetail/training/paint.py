"""Albedos of samples: even, strong and fine as in nature, tied to height or hollows, of two tones, in colour or grey."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

LUMINANCE = (0.2126, 0.7152, 0.0722)

EVEN, GREY = 0.3, 0.3
"""Shares of samples without any pattern of albedo, and without colour."""


def blurred(values: Tensor, sigma: float) -> Tensor:
    """Return ``values`` (B, C, N, N) under a Gaussian of ``sigma`` pixels, mirrored at the edges."""
    radius = min(int(3.0 * sigma + 0.5), values.shape[-1] - 1)
    x = torch.arange(-radius, radius + 1, dtype=torch.float32)
    kernel = torch.exp(-0.5 * (x / sigma) ** 2)
    kernel = kernel / kernel.sum()
    count = values.shape[1]
    wide = functional.pad(values, (radius, radius, radius, radius), mode="reflect")
    wide = functional.conv2d(wide, kernel.view(1, 1, 1, -1).expand(count, 1, 1, -1), groups=count)
    return functional.conv2d(wide, kernel.view(1, 1, -1, 1).expand(count, 1, -1, 1), groups=count)


def uniform(generator: torch.Generator, low: float, high: float, count: int) -> Tensor:
    """Return ``count`` numbers (B, 1, 1, 1) between ``low`` and ``high``."""
    return (low + (high - low) * torch.rand(count, generator=generator)).view(-1, 1, 1, 1)


def chance(generator: torch.Generator, share: float, count: int) -> Tensor:
    """Return 1 for a ``share`` of ``count`` samples, else 0, (B, 1, 1, 1)."""
    return (torch.rand(count, generator=generator) < share).float().view(-1, 1, 1, 1)


def _shaped(pattern: Tensor, generator: torch.Generator) -> Tensor:
    """Return a pattern (B, 1, N, N) of mean 0 with tones of its own: as it is, saturated, or in two tones."""
    count = pattern.shape[0]
    hard = torch.exp2(uniform(generator, -1.0, 4.0, count))
    shift = uniform(generator, -1.0, 1.0, count)
    return torch.tanh(hard * (pattern - shift)) / torch.tanh(hard).clamp_min(0.3)


def albedo(height: Tensor, patterns: tuple[Tensor, Tensor], generator: torch.Generator) -> Tensor:
    """Return albedos (B, 3, N, N), 0.02 to 0.95, for reliefs ``height`` (B, N, N) of deviation 1, patterned by other fields."""
    count, side = height.shape[0], height.shape[1]
    h = height[:, None]
    first, second = (_shaped(p[:, None], generator) for p in patterns)
    hollow = h - blurred(h, 4.0)
    hollow = hollow / hollow.std(dim=(1, 2, 3), keepdim=True).clamp_min(1e-3)
    speckle = torch.randn(count, 1, side, side, generator=generator)
    speckle = blurred(speckle, 0.8) * 2.5
    painted = 1.0 - chance(generator, EVEN, count)

    def strength(most: float, share: float) -> Tensor:
        return painted * chance(generator, share, count) * most * torch.exp2(uniform(generator, -4.5, 0.0, count))

    log = strength(0.6, 0.7) * first + strength(0.4, 0.4) * second + strength(0.25, 0.4) * speckle
    log = log + strength(0.5, 0.35) * (2.0 * (torch.rand(count, 1, 1, 1, generator=generator) < 0.7).float() - 1.0) * torch.tanh(
        h
    )
    log = log + strength(0.4, 0.35) * torch.tanh(hollow)
    level = torch.exp(uniform(generator, -2.3, -0.4, count))
    # Two colours, mixed where the first pattern changes; half of the samples hardly change their hue.
    base = 1.0 + 0.45 * (torch.rand(count, 3, 1, 1, generator=generator) - 0.5)
    other = torch.rand(count, 3, 1, 1, generator=generator) - 0.5
    change = torch.exp2(uniform(generator, -4.0, 0.0, count)) * painted
    share = torch.sigmoid(2.0 * torch.where(chance(generator, 0.6, count) > 0, first, second))
    colour = base * (1.0 + change * other * share)
    grey = chance(generator, GREY, count)
    colour = grey + (1.0 - grey) * colour
    weights = torch.tensor(LUMINANCE).view(1, 3, 1, 1)
    colour = colour / (colour * weights).sum(dim=1, keepdim=True)
    return (level * torch.exp(log) * colour).clamp(0.02, 0.95)
