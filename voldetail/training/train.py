"""The training: seeded batches, a falling rate, an average of the weights, checkpoints to go on from, and a curve."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from voldetail.training.model import ReliefNet
from voldetail.training.samples import Batch, make_batch

COUNT = 12
"""Samples a batch."""

RATE, WARM_UP, DECAY = 8.0e-4, 150, 1e-4
AVERAGE = 0.996
"""Of the running average of the weights, which is what is kept."""

LARGEST_STEP = 0.5
"""Norm beyond which a gradient is shortened: without, single batches of deep shadows threw the weights far away."""

CHECKPOINT_SECONDS = 90.0
PAINT_WEIGHT = 0.5
CERTAIN, UNCERTAIN = -3.5, 1.0
"""Bounds of the logarithm of the likely error of a normal's part."""


def loss_of(out: Tensor, batch: Batch) -> tuple[Tensor, Tensor]:
    """Return the loss and the mean angle between the normals in degrees.

    Laplace's likelihood of the normals' parts, |n - n'|_1 / b + 2 log b, with the b that the network says, and the mean absolute
    difference of log albedo.
    """
    kept = out[:, 4]
    p, q = batch.features[:, 6] * kept + out[:, 0], batch.features[:, 7] * kept + out[:, 1]
    log_b, paint = out[:, 2].clamp(CERTAIN, UNCERTAIN), out[:, 3]
    made, wanted = torch.rsqrt(1 + p * p + q * q), torch.rsqrt(1 + batch.p**2 + batch.q**2)
    apart = (p * made - batch.p * wanted).abs() + (q * made - batch.q * wanted).abs()
    slopes = (apart * torch.exp(-log_b) + 2.0 * log_b).mean()
    cosine = (made * wanted * (1 + p * batch.p + q * batch.q)).clamp(-1, 1)
    return slopes + 2.0 * apart.mean() + PAINT_WEIGHT * (paint - batch.paint).abs().mean(), torch.rad2deg(
        torch.acos(cosine)
    ).mean()


def rate_at(step: int, steps: int) -> float:
    """Return the learning rate: up within WARM_UP steps, then down as half a cosine."""
    if step < WARM_UP:
        return RATE * (step + 1) / WARM_UP
    return RATE * (0.01 + 0.99 * 0.5 * (1.0 + math.cos(math.pi * min(step / steps, 1.0))))


class Loader(torch.utils.data.IterableDataset[Batch]):
    """Batches from ``first`` on, each of the seed that is its number."""

    def __init__(self, pool: Path, first: int, steps: int) -> None:
        self.pool, self.first, self.steps = pool, first, steps

    def __iter__(self):  # type: ignore[no-untyped-def]
        torch.set_num_threads(1)
        pool = np.load(self.pool, mmap_mode="r", allow_pickle=False)
        worker = torch.utils.data.get_worker_info()
        start, stride = (worker.id, worker.num_workers) if worker else (0, 1)
        for step in range(self.first + start, self.steps, stride):
            yield make_batch(pool, COUNT, 1_000_003 * (step + 1))


def train(folder: Path, steps: int, *, seed: int = 1, threads: int = 2) -> None:
    """Train on ``folder``/heights.npy for ``steps`` batches, going on from ``folder``/checkpoint.pt if it is there."""
    torch.set_num_threads(threads)
    torch.manual_seed(seed)
    net = ReliefNet().to(memory_format=torch.channels_last)
    mean = ReliefNet().to(memory_format=torch.channels_last)
    mean.load_state_dict(net.state_dict())
    optimiser = torch.optim.AdamW(net.parameters(), lr=RATE, weight_decay=DECAY)
    first, curve = 0, []
    saved = folder / "checkpoint.pt"
    if saved.exists():
        state = torch.load(saved, weights_only=True)
        net.load_state_dict(state["net"])
        mean.load_state_dict(state["mean"])
        optimiser.load_state_dict(state["optimiser"])
        first, curve = int(state["step"]), json.loads(state["curve"])
    loader = torch.utils.data.DataLoader(
        Loader(folder / "heights.npy", first, steps), batch_size=None, num_workers=1, prefetch_factor=4
    )
    seen: list[tuple[float, float]] = []
    last = time.monotonic()
    for step, batch in enumerate(loader, first):
        for group in optimiser.param_groups:
            group["lr"] = rate_at(step, steps)
        loss, angle = loss_of(net(batch.features.to(memory_format=torch.channels_last)), batch)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), LARGEST_STEP)
        optimiser.step()
        keep = min(AVERAGE, (step + 1) / (step + 10))
        with torch.no_grad():
            for kept, new in zip(mean.parameters(), net.parameters(), strict=True):
                kept.lerp_(new, 1.0 - keep)
        seen.append((loss.item(), angle.item()))
        if time.monotonic() - last > CHECKPOINT_SECONDS or step == steps - 1:
            last = time.monotonic()
            curve.append([step + 1, *(round(float(v), 4) for v in np.mean(seen, axis=0))])
            seen.clear()
            print(curve[-1], flush=True)
            state = {"net": net.state_dict(), "mean": mean.state_dict(), "optimiser": optimiser.state_dict(), "step": step + 1}
            torch.save({**state, "curve": json.dumps(curve)}, folder / "checkpoint.tmp")
            (folder / "checkpoint.tmp").replace(saved)
