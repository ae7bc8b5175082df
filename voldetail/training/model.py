"""The network: a U-Net whose widest layers are where pixels are few."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

WIDTHS = (16, 32, 64, 128, 160)
"""Channels at 1, 1/2, 1/4, 1/8 and 1/16 of the resolution: 1.4 million weights, and each level costs about the same."""

INPUTS, OUTPUTS = 8, 5
"""In: samples.Batch.features. Out: what is added to the linear step's p and q, the logarithm of the normals' likely error, log
albedo, and the share of the linear step's slopes that is kept."""

LEAK = 0.1


class Double(nn.Module):
    """Two convolutions 3 x 3, each followed by a leaky rectifier."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, padding=1)
        self.second = nn.Conv2d(outputs, outputs, 3, padding=1)

    def forward(self, x: Tensor) -> Tensor:
        x = functional.leaky_relu(self.first(x), LEAK)
        return functional.leaky_relu(self.second(x), LEAK)


class ReliefNet(nn.Module):
    """From features (B, 8, N, N), N a multiple of 16, to (B, 5, N, N)."""

    def __init__(self) -> None:
        super().__init__()
        inputs = (INPUTS, *WIDTHS)
        self.down = nn.ModuleList(Double(inputs[k], WIDTHS[k]) for k in range(len(WIDTHS)))
        self.up = nn.ModuleList(Double(WIDTHS[k] + WIDTHS[k + 1], WIDTHS[k]) for k in range(len(WIDTHS) - 1))
        self.last = nn.Conv2d(WIDTHS[0], OUTPUTS, 1)
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, a=LEAK)
                nn.init.zeros_(module.bias)
        nn.init.normal_(self.last.weight, std=0.02)

    def forward(self, x: Tensor) -> Tensor:
        kept = []
        for k, double in enumerate(self.down):
            x = double(x if k == 0 else functional.avg_pool2d(x, 2))
            kept.append(x)
        for k in range(len(WIDTHS) - 2, -1, -1):
            x = functional.interpolate(x, scale_factor=2, mode="nearest")
            x = self.up[k](torch.cat([kept[k], x], dim=1))
        return self.last(x)
