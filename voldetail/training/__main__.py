"""`python -m voldetail.training`: the pool of heights, the training, the export; each in a process of its own.

torch (the extra `train`) and Dr.Jit's LLVM clash in one process, so the pool, which needs Dr.Jit, is made before.
"""

from __future__ import annotations

import shutil
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from voldetail.files import atomic

POOL, CHECKPOINT, CURVE = "heights.npy", "checkpoint.pt", "curve.json"
POOL_SEED, TRAINING_SEED = 20, 1

app = typer.Typer(no_args_is_help=True, help=__doc__, pretty_exceptions_enable=False)

Folder = Annotated[Path, typer.Argument(help="The folder of the training.")]


@app.command()
def pool(folder: Folder, count: Annotated[int, typer.Option(min=1, help="How many heights.")] = 1600) -> None:
    """Make the pool of heights, some minutes and 131 kB for each."""
    from voldetail.training.heights import pool as heights

    folder.mkdir(parents=True, exist_ok=True)
    made = heights(count, POOL_SEED)
    with atomic(folder / POOL) as temporary, open(temporary, "wb") as stream:
        np.save(stream, made)


@app.command()
def train(
    folder: Folder,
    steps: Annotated[int, typer.Option(min=1, help="Batches in all; the learning rate falls towards their end.")] = 6000,
    threads: Annotated[int, typer.Option(min=1, help="Threads; one more process makes the samples.")] = 2,
) -> None:
    """Train, or go on from the folder's checkpoint; Ctrl-C loses at most two minutes."""
    from voldetail.training.train import train as run

    run(folder, steps, seed=TRAINING_SEED, threads=threads)


@app.command()
def export(
    folder: Folder, output: Annotated[Path | None, typer.Option(help="Default: where voldetail reads its weights.")] = None
) -> None:
    """Write the checkpoint's averaged weights for recover.network, and the curve beside them in the folder."""
    from voldetail.training.export import export as write

    target = output or Path(str(files("voldetail.recover").joinpath("weights.npz")))
    steps = write(folder / CHECKPOINT, folder / "weights.npz", folder / CURVE)
    shutil.copyfile(folder / "weights.npz", target)
    typer.echo(f"{target}  after {steps} batches")


if __name__ == "__main__":
    app()
