"""Hypertextures of every kind of object, small enough to make both whole and by tiles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import trimesh

from voldetail.detail import Detail
from voldetail.field.hypertexture import Hypertexture
from voldetail.field.shell import make_shell
from voldetail.field.shell_grid import ShellPlan
from voldetail.field.shell_plan import plan_shell
from voldetail.setup.proxy import ProxySetup

SMALL = 240_000_000
"""Bytes: enough for tiles, too little for the grid as a whole."""

PLACED: dict[str, Any] = {"rotation": (20, 30, 10), "position": (0.1, 0.2, -0.3)}
OBJECTS: dict[str, dict[str, Any]] = {
    "sphere": {"kind": "sphere", "position": (0.1, 0.2, -0.3)},
    "ellipsoid": {"kind": "ellipsoid", "size": (2.0, 1.4, 1.0), **PLACED},
    "box": {"kind": "box", "size": (2.0, 1.6, 1.2), **PLACED},
    "cylinder": {"kind": "cylinder", "size": (1.2, 2.0, 1.2), **PLACED},
    "slab": {"kind": "plane", "size": (1.7, 1.5, 0.0)},
    "thick slab": {"kind": "plane", "size": (1.9, 1.9, 1.9), **PLACED},
    "mesh": {"kind": "mesh", **PLACED},
}


def plan_of(name: str, folder: Path, edge: float = 0.02, amplitude: float = 0.1, **more: Any) -> ShellPlan:
    fields = dict(OBJECTS[name])
    if name == "mesh":
        fields["mesh"] = folder / "torus.ply"
        trimesh.creation.torus(0.7, 0.3, major_sections=48, minor_sections=24).export(fields["mesh"])
    return plan_shell(ProxySetup(**fields), edge, 3 * edge, amplitude, **more)


def texture_of(plan: ShellPlan, scale: float = 4.0, exponent: float = 1.0) -> Hypertexture:
    relief = {"amplitude": plan.amplitude}
    return Hypertexture(make_shell(plan), Detail.model_validate({"noise": {"scale": scale}, "relief": relief}), exponent)


def ball(edge: float = 0.02, **more: Any) -> Hypertexture:
    return texture_of(plan_of("sphere", Path(), edge, **more))
