"""Imports point one way: the table of packages, and who alone may import or call what."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "voldetail"

LEAVES = {"errors", "files"}
VERSION = {"voldetail"}  # the package itself, for __version__
EVERYTHING = {
    "cli", "report", "apply", "export", "start", "fit", "library", "render", "scene", "texture", "metric", "noise", "detail",
    "image", "backend",
}  # fmt: skip
ALLOWED: dict[str, set[str]] = {
    "cli": EVERYTHING | VERSION,
    "report": {"detail", "image"},
    "apply": {"scene", "render", "detail", "image", "backend"},
    "export": {"scene", "render", "detail", "image", "backend"},
    "fit": {"scene", "render", "metric", "texture", "detail", "image", "backend"} | VERSION,
    "library": {"scene", "render", "metric", "texture", "detail", "image", "backend"},  # texture: what it has entries of
    "start": {"fit", "library", "render", "scene", "metric", "detail", "image", "backend"},  # brings fits and libraries together
    "render": {"scene", "detail", "backend"},  # scene: what it renders; detail: the reflectance it is seen with
    "scene": {"noise", "texture", "detail", "image", "backend"},
    "texture": {"noise", "detail", "image"},
    "metric": {"image"},
    "noise": set(),
    "detail": set(),
    "image": set(),
    "backend": set(),
    "errors": set(),
    "files": set(),
    "api": EVERYTHING - {"cli"},  # the names for Python, over all that they need
    "voldetail": {"backend", "api"},  # the package itself: picks an LLVM on import, and may pass on the names
}
TYPES_ONLY = {("report", "fit"), ("report", "apply"), ("report", "scene")}
"""Records that a report is given and reads, named for the type checker alone: nothing of them is loaded."""

SEARCH = "fit/search.py"  # knows vectors and numbers only
CALLS = {"render", "ray_intersect", "ray_test", "ray_intersect_preliminary"}
TRACERS = {"render.py", "scene/surface.py"}
PLUGINS = {
    "scene", "path", "direct", "constant", "envmap", "directional", "point", "principled", "diffuse", "bitmap",
    "hdrfilm", "orthographic", "perspective", "rgb", "box", "mesh_attribute", "voldetail_phong",
    "heterogeneous", "gridvolume", "constvolume", "volpath", "hg", "cube", "null",
}  # fmt: skip
WITHOUT_ARRAYS = {"metric", "detail", "image", "report", "cli", "fit", "apply"}
"""Parts that see NumPy arrays only. (noise uses Dr.Jit's functions on the arrays that it is given.)"""


def unit_of(relative: str) -> str:
    first = relative.split("/")[0].removesuffix(".py")
    return "voldetail" if first == "__init__" else first


def imports(tree: ast.AST, package: str) -> Iterator[tuple[str, bool]]:
    """Yield (full module name, only for types) of every import at any depth; relative ones made absolute."""
    typed = {
        id(inner) for node in ast.walk(tree) if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for statement in node.body for inner in ast.walk(statement)
    }  # fmt: skip
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, id(node) in typed) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package.split(".")[: -node.level + 1 or None]) + "." if node.level else ""
            module = (base + (node.module or "")).rstrip(".")
            # "from voldetail import x" may name a module of the package.
            for alias in node.names:
                yield (f"{module}.{alias.name}" if module == "voldetail" else module), id(node) in typed
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module") and node.args:
            argument = node.args[0]
            yield (argument.value if isinstance(argument, ast.Constant) else "?"), id(node) in typed


def broken(root: Path) -> list[str]:
    """Return what breaks a rule in the package at ``root``, one line each."""
    found = []
    for path in sorted(root.rglob("*.py")):
        relative = path.relative_to(root).as_posix()
        unit, tree = unit_of(relative), ast.parse(path.read_text(encoding="utf-8"))
        package = ".".join(["voldetail", *path.relative_to(root).parts[:-1]])
        for name, typed in imports(tree, package):
            top, _, rest = name.partition(".")
            target = rest.split(".")[0] if rest.split(".")[0] in ALLOWED else "voldetail"
            if top == "voldetail":
                allowed = ALLOWED.get(unit, set()) | LEAVES | {unit}
                if not (target in allowed or (typed and (unit, target) in TYPES_ONLY)):
                    found.append(f"{relative}: {unit} may not import {target}")
                if relative == SEARCH:
                    found.append(f"{relative}: the search knows nothing of ours, but imports {name}")
            if top == "matplotlib" and unit != "report":
                found.append(f"{relative}: only report imports matplotlib")
            if top == "mitsuba" and unit != "backend":
                found.append(f"{relative}: only backend imports mitsuba")
            if top == "drjit" and unit in WITHOUT_ARRAYS:
                found.append(f"{relative}: {unit} has no business with Dr.Jit")
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in CALLS:
                owner = ast.unparse(node.func.value)
                if relative not in TRACERS and (node.func.attr != "render" or owner in ("mi", "mitsuba()")):
                    found.append(f"{relative}: {owner}.{node.func.attr} belongs in {' or '.join(sorted(TRACERS))}")
            if isinstance(node, ast.Dict) and unit not in ("scene", "detail"):
                for key, value in zip(node.keys, node.values, strict=True):
                    if isinstance(key, ast.Constant) and key.value == "type" and getattr(value, "value", 0) in PLUGINS:
                        found.append(f"{relative}: the plugin name {ast.unparse(value)} belongs in scene")
    return found


def test_the_package_keeps_the_rules() -> None:
    assert (PACKAGE / "backend.py").exists()
    assert broken(PACKAGE) == []


def test_every_part_is_in_the_table() -> None:
    parts = {unit_of(p.name) for p in PACKAGE.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()}
    assert parts <= set(ALLOWED)
    assert {"cli", "fit", "apply", "report", "scene", "noise", "metric", "detail", "image", "render"} <= parts


@pytest.mark.parametrize(
    ("place", "line", "complaint"),
    [
        ("noise/a.py", "from voldetail.image import luminance", "noise may not import image"),
        ("noise/a.py", "import mitsuba as mi", "only backend imports mitsuba"),
        ("scene/a.py", "def f():\n    from voldetail.render.unit_components import components", "scene may not import render"),
        ("scene/a.py", "from ..fit import objective", "scene may not import fit"),
        ("detail/a.py", "from voldetail import scene", "detail may not import scene"),
        ("apply/a.py", "from voldetail.fit.fitter import FitResult", "apply may not import fit"),
        ("apply/a.py", "import voldetail.metric.filters", "apply may not import metric"),
        ("fit/a.py", "from voldetail.apply import render", "fit may not import apply"),
        ("report/a.py", "from voldetail.fit.fitter import FitResult", "report may not import fit"),
        ("image/a.py", "from voldetail import __version__", "image may not import voldetail"),
        ("fit/search.py", "from voldetail.fit.space import Space", "the search knows nothing of ours"),
        ("fit/a.py", "import importlib\nimportlib.import_module('matplotlib')", "only report imports matplotlib"),
        ("fit/a.py", "import drjit as dr", "fit has no business with Dr.Jit"),
        ("cli/a.py", "import matplotlib.pyplot as plt", "only report imports matplotlib"),
        ("fit/a.py", "picture = mi.render(scene)", "mi.render belongs in"),
        ("apply/a.py", "hit = surface.scene.ray_intersect(ray)", "surface.scene.ray_intersect belongs in"),
        ("apply/a.py", "light = {'type': 'directional'}", "the plugin name 'directional' belongs in scene"),
    ],
)
def test_a_broken_rule_is_seen(tmp_path: Path, place: str, line: str, complaint: str) -> None:
    file = tmp_path / place
    file.parent.mkdir(parents=True)
    file.write_text(line + "\n")
    assert [complaint in text for text in broken(tmp_path)] == [True]


@pytest.mark.parametrize(
    ("place", "line"),
    [
        ("report/a.py", "if TYPE_CHECKING:\n    from voldetail.fit.fitter import FitResult"),
        ("fit/a.py", "from voldetail import __version__\nfrom voldetail.errors import InputError"),
        ("report/a.py", "from matplotlib.figure import Figure"),
        ("scene/surface.py", "free = scene.ray_test(ray)\nx = {'type': 'scene'}"),
        ("noise/a.py", "import drjit as dr"),
        ("image/__init__.py", "from .srgb import to_linear"),
        ("fit/search.py", "import numpy as np"),
    ],
)
def test_what_is_allowed_passes(tmp_path: Path, place: str, line: str) -> None:
    file = tmp_path / place
    file.parent.mkdir(parents=True)
    file.write_text(line + "\n")
    assert broken(tmp_path) == []
