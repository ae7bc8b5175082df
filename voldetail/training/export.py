"""From a checkpoint to the arrays that recover.network reads: float16, no pickle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch

from voldetail.files import write_text


def export(checkpoint: Path, target: Path, curve: Path) -> int:
    """Write the averaged weights of ``checkpoint`` to ``target`` (.npz) and its ``curve``; return how many batches they have
    seen.

    The curve is a JSON list of [batches, mean loss, mean angle between normals in degrees], each since the entry before.
    """
    state = torch.load(checkpoint, weights_only=True)
    arrays = {name: value.contiguous().numpy().astype(np.float16) for name, value in state["mean"].items()}
    with open(target, "wb") as stream:
        np.savez_compressed(stream, **arrays)
    write_text(curve, str(state["curve"]) + "\n")
    return int(state["step"])
