"""`python -m voldetail.training.make_pool FOLDER [COUNT]`: the pool of heights as a file, without torch in the process."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from voldetail.training.heights import pool

COUNT, SEED = 1600, 20

POOL = "heights.npy"


def main(folder: Path, count: int = COUNT) -> None:
    """Write the pool into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / POOL, pool(count, SEED))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else COUNT)
