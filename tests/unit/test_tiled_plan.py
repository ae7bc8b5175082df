"""What a surface by tiles takes is said before, and refused where it is too much."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

from tests.unit.tiled_objects import SMALL, plan_of, texture_of
from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.field.shell_blocks import near_blocks
from voldetail.field.shell_plan import DEFAULT_BUDGET

mi: ModuleType = mitsuba()


def test_the_plan_says_what_tiles_take() -> None:
    plan = plan_of("sphere", Path(), 0.002, tiles=True)
    assert plan.blocks == len(near_blocks(plan))
    assert plan.sentence.startswith(f"1105 x 1105 x 1105 cells of 0.002 scene units, in at most {plan.blocks} of 5832 blocks, ")
    assert plan.byte_count < 2 << 30
    assert plan.byte_count < 4 * plan.cells / 2
    assert plan.seconds > 0.01 * plan.blocks
    finer = plan_of("sphere", Path(), 0.001, tiles=True, budget=10**10)
    assert 3.5 < (finer.byte_count - 2e8) / (plan.byte_count - 2e8) < 4.5  # as the surface
    assert plan_of("sphere", Path(), 0.05, tiles=True).blocks == 0  # small enough as a whole


def test_who_needs_the_grid_is_refused_as_ever(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf"more than the {DEFAULT_BUDGET / 2**20:.0f} MB allowed: use an edge of at least"):
        plan_of("sphere", tmp_path, 0.002)
    for name in ("sphere", "mesh"):
        texture = texture_of(plan_of(name, tmp_path, budget=SMALL, tiles=True))
        for bake in (texture.bake, texture.shell.bake):
            with pytest.raises(InputError, match="planned for its surface by tiles alone: plan it without tiles to fill it"):
                bake()
    with pytest.raises(InputError, match="known block by block only"):
        texture.density_at((mi.Float(0.0), mi.Float(0.0), mi.Float(0.0)))


def test_what_tiles_cannot_do_either_is_refused_with_advice(tmp_path: Path) -> None:
    for edge in (1e-4, 1e-200):
        with pytest.raises(InputError, match=r"needs \d+ MB by tiles, more than the 2048 MB allowed: use an edge of") as refused:
            plan_of("sphere", tmp_path, edge, 0.02, tiles=True)
        fitting = float(str(refused.value).split("use an edge of at least ")[1].split(" ")[0].rstrip(",:"))
        assert 0 < plan_of("sphere", tmp_path, fitting, 0.02, tiles=True).byte_count <= 2 << 30
