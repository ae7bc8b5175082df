"""From a checkpoint to the arrays that recover.network reads: float16, no pickle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch


def export(checkpoint: Path, target: Path) -> int:
    """Write the averaged weights of ``checkpoint`` to ``target`` (.npz); return how many batches they have seen."""
    state = torch.load(checkpoint, weights_only=True)
    arrays = {name: value.contiguous().numpy().astype(np.float16) for name, value in state["mean"].items()}
    with open(target, "wb") as stream:
        np.savez_compressed(stream, **arrays)
    return int(state["step"])
