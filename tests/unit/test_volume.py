"""A volumetric detail about a proxy: closed forms of its slabs and sheets, and what is kept from one look to the next."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from voldetail.backend import mitsuba
from voldetail.detail import Detail, with_values
from voldetail.errors import InputError
from voldetail.field.shell_plan import OverBudgetError
from voldetail.render import volume as volume_module
from voldetail.render.unit_components import Components, components
from voldetail.render.volume import SOLID_CELLS, Volume, fitting_edge, medium_of, windowed
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.view import View

VIEW = View(-0.5, 0.5, -0.5, 0.5, 48, 48)
LAMP = Lamp(direction=direction_of(30, 50))
FLAT = {"noise.curve": (0.0,) * 11}
BUMPS = {"noise.scale": 5.0, "relief.amplitude": 0.08, "noise.octaves": 1, "noise.last_neighbour": 50}
MEDIUM = {"medium.thickness": 0.3, "medium.extinction": 10.0}


def solid(**values: object) -> Detail:
    return with_values(Detail(mode="volume", seed=5), {key.replace("__", "."): value for key, value in values.items()})


def look(detail: Detail, proxy: ProxySetup, view: View = VIEW, *, whole_plane: bool = False, scale: float = 1.0) -> Components:
    seen = Volume(proxy, view, whole_plane=whole_plane, scale=scale)
    seen.update(detail)
    return components(seen, LAMP, subsamples=1)


def test_a_flat_slab_is_a_matt_plane_to_the_edge_of_the_picture() -> None:
    found = look(with_values(solid(), FLAT), ProxySetup(), whole_plane=True)
    assert found.covered.min() == 1.0
    assert found.diffuse == pytest.approx(math.sin(math.radians(50)), rel=0.05)  # 4 % are lost in its own soft edge
    # Of the sky, which is looked for on a coarse copy, a slab as thin as this box hides some itself.
    assert found.ambient == pytest.approx(0.9, abs=0.08)


@pytest.mark.parametrize("thickness", [0.2, 0.5])
def test_a_flat_sheet_lets_light_through_by_its_profile(thickness: float) -> None:
    """Of d = 1 - S(|z| / T + 1/2), the integral over z is 2 T (1/2 - [u^3 - u^4 / 2] from 1/2 to 1) = 3 T / 16."""
    detail = with_values(Detail(), FLAT | {"medium.thickness": thickness, "medium.extinction": 12.0})
    found = look(detail, ProxySetup(), whole_plane=True)
    wanted = 1.0 - math.exp(-12.0 * 3.0 * thickness / 16.0)
    # Ten cells to the thinner one; the sheet's own body adds half a percent.
    assert found.covered == pytest.approx(wanted, rel=0.03)
    # Also in the corners: its sides are beyond the window.
    assert found.covered[0, 0] == pytest.approx(found.covered[24, 24], rel=1e-3)


def test_the_scale_makes_lengths_longer_and_extinction_less() -> None:
    detail = with_values(solid(), BUMPS | MEDIUM)
    small = look(detail, ProxySetup(), View(-0.25, 0.25, -0.25, 0.25, 48, 48), whole_plane=True)
    large = look(detail, ProxySetup(), whole_plane=True, scale=2.0)
    assert large.covered == pytest.approx(small.covered, abs=0.01)
    assert large.diffuse == pytest.approx(small.diffuse, abs=0.01)
    assert medium_of(detail, 0.1, 2.0).extinction == pytest.approx(5.0)


def test_the_window_leaves_out_only_what_is_not_seen() -> None:
    view = View(-0.1, 0.4, 0.0, 0.5, 48, 48)
    proxy, detail = ProxySetup(kind="sphere"), with_values(solid(), BUMPS)
    part = Volume(proxy, view)
    whole = Volume(proxy, view)
    thickness, amplitude = part.lengths(detail)
    plan = part.plan(thickness, amplitude, True)
    full = volume_module.plan_shell(proxy, view.pixel, thickness, amplitude, 1 << 40)
    assert plan.cells < 0.3 * full.cells
    assert plan.byte_count < full.byte_count
    # On the same cells: the picture is the same but for the sky, which is taken from a coarse copy.
    offset = [(a - b) / plan.edge for a, b in zip(plan.lower, full.lower, strict=True)]
    assert offset == pytest.approx(np.round(offset), abs=1e-3)
    part.update(detail)
    whole.plan = lambda *_: full  # type: ignore[method-assign]
    whole.update(detail)
    one, other = (components(seen, LAMP, subsamples=1) for seen in (part, whole))
    assert one.covered == pytest.approx(other.covered, abs=1e-3)
    assert float(np.abs(one.diffuse - other.diffuse).mean()) < 2e-3


def test_windowed_keeps_all_of_what_is_within() -> None:
    plan = Volume(ProxySetup(kind="box", size=(0.4, 0.4, 0.4)), VIEW).plan(SOLID_CELLS * VIEW.pixel, 0.05, True)
    kept = windowed(plan, VIEW, 0.1)
    assert (kept.shape, kept.lower, kept.byte_count) == (plan.shape, plan.lower, plan.byte_count)


def test_a_meshs_distances_are_computed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=3).export(path)
    made = []
    make = volume_module.make_shell
    monkeypatch.setattr(volume_module, "make_shell", lambda plan: made.append(plan) or make(plan))
    ball = Volume(ProxySetup(kind="sphere"), VIEW, edge=0.05)
    ball.update(with_values(solid(), BUMPS))
    made.clear()
    seen = Volume(ProxySetup(kind="mesh", mesh=path), VIEW, edge=0.05)
    detail = with_values(solid(), BUMPS)
    for amplitude in (0.08, 0.02, 0.05, 0.08):
        seen.update(with_values(detail, {"relief.amplitude": amplitude}))
    assert len(made) == 1
    # A ball of radius 1 in either way.
    one, other = (components(v, LAMP, subsamples=1) for v in (seen, ball))
    assert float(np.abs(one.diffuse - other.diffuse).mean()) < 0.03
    seen.update(with_values(detail, {"relief.amplitude": 0.3}))
    assert len(made) == 2


def test_cells_are_pixels_where_there_is_time_and_larger_where_not() -> None:
    assert fitting_edge(ProxySetup(), VIEW, solid=True, whole_plane=True) == pytest.approx(VIEW.pixel)
    assert fitting_edge(ProxySetup(), VIEW, solid=False, whole_plane=True) == pytest.approx(2 * VIEW.pixel)
    fine = View(-1.0, 1.0, -1.0, 1.0, 1024, 1024)
    edge = fitting_edge(ProxySetup(kind="sphere"), fine, solid=True, whole_plane=False)
    assert edge > 2 * fine.pixel


def test_a_second_look_with_other_numbers_compiles_nothing() -> None:
    import drjit as dr

    mitsuba()
    seen = Volume(ProxySetup(), VIEW, whole_plane=True)
    detail = with_values(solid(), BUMPS | MEDIUM)

    def see(step: int) -> None:
        changed = {"medium.thickness": 0.3 + 0.02 * step, "medium.exponent": 2.0 + step, "relief.amplitude": 0.08 + 0.01 * step}
        seen.update(with_values(detail, changed))
        components(seen, LAMP, subsamples=1)

    see(0)
    see(1)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        dr.kernel_history_clear()
        see(2)
        kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    assert kernels
    assert [entry["operation_count"] for entry in kernels if not entry["cache_hit"]] == []


def test_what_cannot_be_a_volume_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "sheet.ply"
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).export(path)
    with pytest.raises(InputError, match=r"sheet\.ply is not closed"):
        look(with_values(solid(), BUMPS), ProxySetup(kind="mesh", mesh=path))
    with pytest.raises(InputError, match="as much as the box itself"):
        look(with_values(solid(), BUMPS), ProxySetup(kind="box", size=(1.0, 1.0, 0.01)))
    with pytest.raises(OverBudgetError, match="more than the"):
        Volume(ProxySetup(kind="sphere"), VIEW, edge=1e-3, budget=1 << 20).update(with_values(solid(), BUMPS))
