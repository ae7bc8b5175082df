"""Imports point one way: the table of packages, and who alone may import or call what."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "voldetail"

LEAVES = {"errors", "files", "types"}
VERSION = {"voldetail"}  # the package itself, for __version__
ALLOWED: dict[str, set[str]] = {
    "records": set(),  # what every versioned file and record stands on
    "noise": set(),
    "image": {"records"},
    "detail": {"records"},
    "metric": {"image"},
    "texture": {"noise", "detail", "image", "records"},
    "stationary": {"image"},
    "setup": {"detail", "image", "records", "backend"},
    "geometry": {"setup", "backend"},
    "field": {"geometry", "setup", "detail", "noise", "texture", "backend"},
    "render": {"field", "geometry", "setup", "detail", "texture", "backend"},
    "results": {"metric", "setup", "detail", "image"},
    "recover": {"render", "field", "setup", "stationary", "detail", "image", "records", "backend"} | VERSION,
    "library": {"texture", "metric", "image", "detail", "records"},  # detail: the texture of a structure
    "fit": {
        "library", "results", "render", "field", "geometry", "setup", "stationary", "texture", "metric", "detail", "image",
        "records", "backend",
    } | VERSION,
    "apply": {"results", "render", "field", "geometry", "setup", "detail", "image", "backend"},
    "export": {"apply", "geometry", "detail"},
    "report": {"results", "setup", "detail", "image"},
    "training": {"fit", "field", "recover", "backend"},  # torch, in a process of its own
    "backend": set(),
    "errors": set(),
    "files": set(),
    "types": set(),
    "voldetail": {"backend"},  # the package itself: points Dr.Jit to an LLVM on import
}  # fmt: skip
"""Which room may import which, from what everything stands on up; a room may import itself and LEAVES."""

ALLOWED["api"] = set(ALLOWED) | VERSION
ALLOWED["cli"] = set(ALLOWED) | VERSION

SEARCH = "fit/search.py"  # knows vectors and numbers only
CALLS = {"render", "ray_intersect", "ray_test", "ray_intersect_preliminary"}
TRACER = "render"
PLUGINS = {
    "scene", "path", "direct", "constant", "envmap", "directional", "point", "principled", "diffuse", "bitmap",
    "hdrfilm", "orthographic", "perspective", "rgb", "box", "mesh_attribute", "voldetail_phong",
    "heterogeneous", "gridvolume", "constvolume", "volpath", "hg", "cube", "null",
}  # fmt: skip
WITHOUT_ARRAYS = {"metric", "detail", "records", "results", "image", "library", "report", "cli", "fit", "apply"}
"""Parts that see NumPy arrays only. (noise uses Dr.Jit's functions on the arrays that it is given.)"""


def unit_of(relative: str) -> str:
    first = relative.split("/")[0].removesuffix(".py")
    return "voldetail" if first == "__init__" else first


def imports(tree: ast.AST, package: str) -> Iterator[str]:
    """Yield the full module name of every import at any depth, also of those for types; relative ones made absolute."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package.split(".")[: -node.level + 1 or None]) + "." if node.level else ""
            module = (base + (node.module or "")).rstrip(".")
            # "from voldetail import x" may name a module of the package, and "from voldetail.noise import x" one of the room.
            for alias in node.names:
                inner = PACKAGE.parent.joinpath(*module.split("."), f"{alias.name}.py").exists()
                yield f"{module}.{alias.name}" if module == "voldetail" or inner else module
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module") and node.args:
            argument = node.args[0]
            yield str(argument.value) if isinstance(argument, ast.Constant) else "?"


def broken(root: Path) -> list[str]:
    """Return what breaks a rule in the package at ``root``, one line each."""
    broken_rules = []
    for path in sorted(root.rglob("*.py")):
        relative = path.relative_to(root).as_posix()
        unit, tree = unit_of(relative), ast.parse(path.read_text(encoding="utf-8"))
        package = ".".join(["voldetail", *path.relative_to(root).parts[:-1]])
        for name in imports(tree, package):
            top, _, rest = name.partition(".")
            target = rest.split(".")[0] if rest.split(".")[0] in ALLOWED else "voldetail"
            if top == "voldetail":
                allowed = ALLOWED.get(unit, set()) | LEAVES | {unit}
                if target not in allowed:
                    broken_rules.append(f"{relative}: {unit} may not import {target}")
                if relative == SEARCH:
                    broken_rules.append(f"{relative}: the search knows nothing of ours, but imports {name}")
            if top == "matplotlib" and unit != "report":
                broken_rules.append(f"{relative}: only report imports matplotlib")
            if top == "mitsuba" and unit != "backend":
                broken_rules.append(f"{relative}: only backend imports mitsuba")
            if top == "drjit" and unit in WITHOUT_ARRAYS:
                broken_rules.append(f"{relative}: {unit} has no business with Dr.Jit")
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in CALLS:
                owner = ast.unparse(node.func.value)
                if unit != TRACER and (node.func.attr != "render" or owner in ("mi", "mitsuba()")):
                    broken_rules.append(f"{relative}: {owner}.{node.func.attr} belongs in {TRACER}")
            if isinstance(node, ast.Dict) and unit not in (TRACER, "setup", "detail"):
                for key, value in zip(node.keys, node.values, strict=True):
                    if isinstance(key, ast.Constant) and key.value == "type" and getattr(value, "value", 0) in PLUGINS:
                        broken_rules.append(f"{relative}: the plugin name {ast.unparse(value)} belongs in {TRACER}")
    return broken_rules


def test_the_package_keeps_the_rules() -> None:
    assert (PACKAGE / "backend.py").exists()
    assert broken(PACKAGE) == []


def test_every_part_is_in_the_table() -> None:
    parts = {unit_of(p.name) for p in PACKAGE.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()}
    assert parts <= set(ALLOWED)
    assert {"cli", "fit", "apply", "report", "setup", "geometry", "field", "render", "noise", "metric", "detail"} <= parts


def test_the_table_itself_has_no_circle() -> None:
    assert circles({room: allowed - VERSION for room, allowed in ALLOWED.items()}) == []


def files_imported(root: Path) -> dict[str, set[str]]:
    """Return for each module of the package at ``root`` those that it imports, for types alone included."""
    modules = {}
    for path in root.rglob("*.py"):
        name = ".".join(["voldetail", *path.relative_to(root).with_suffix("").parts]).removesuffix(".__init__")
        modules[name] = path
    graph: dict[str, set[str]] = {}
    for name, path in modules.items():
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        wanted = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                wanted |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                base = ".".join(package.split(".")[: len(package.split(".")) - node.level + 1]) if node.level else ""
                module = ".".join(filter(None, (base, node.module or "")))
                # A name that is a module is that one, and not the package it is taken from.
                wanted |= {f"{module}.{a.name}" if f"{module}.{a.name}" in modules else module for a in node.names}
        graph[name] = {module for module in wanted if module in modules} - {name}
    return graph


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Return the groups of nodes that reach each other (Tarjan 1972)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, set()):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                groups.append(sorted(group))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return groups


def test_no_two_files_import_each_other_by_any_way() -> None:
    assert circles(files_imported(PACKAGE)) == []


def test_a_circle_is_seen(tmp_path: Path) -> None:
    lines = {"a": "from voldetail.b import x", "b": "def f():\n    from voldetail import c", "c": "import voldetail.a"}
    for name, line in lines.items():
        (tmp_path / f"{name}.py").write_text(line + "\n")
    assert circles(files_imported(tmp_path)) == [["voldetail.a", "voldetail.b", "voldetail.c"]]


@pytest.mark.parametrize(
    ("place", "line", "complaint"),
    [
        ("noise/a.py", "from voldetail.image import luminance", "noise may not import image"),
        ("noise/a.py", "import mitsuba as mi", "only backend imports mitsuba"),
        ("field/a.py", "def f():\n    from voldetail.render.unit_components import components", "field may not import render"),
        ("setup/a.py", "from ..fit import objective", "setup may not import fit"),
        ("detail/a.py", "from voldetail import setup", "detail may not import setup"),
        ("apply/a.py", "from voldetail.fit.fitter import fit", "apply may not import fit"),
        ("apply/a.py", "import voldetail.metric.filters", "apply may not import metric"),
        ("fit/a.py", "from voldetail.apply import render", "fit may not import apply"),
        ("report/a.py", "from voldetail.fit.fitter import fit", "report may not import fit"),
        ("report/a.py", "if TYPE_CHECKING:\n    from voldetail.apply import Gallery", "report may not import apply"),
        ("library/a.py", "from voldetail.fit.space import Space", "library may not import fit"),
        ("library/a.py", "from voldetail.setup.setup import Setup", "library may not import setup"),
        ("image/a.py", "from voldetail import __version__", "image may not import voldetail"),
        ("fit/search.py", "from voldetail.fit.space import Space", "the search knows nothing of ours"),
        ("fit/a.py", "import importlib\nimportlib.import_module('matplotlib')", "only report imports matplotlib"),
        ("fit/a.py", "import drjit as dr", "fit has no business with Dr.Jit"),
        ("cli/a.py", "import matplotlib.pyplot as plt", "only report imports matplotlib"),
        ("fit/a.py", "picture = mi.render(scene)", "mi.render belongs in"),
        ("apply/a.py", "hit = surface.scene.ray_intersect(ray)", "surface.scene.ray_intersect belongs in"),
        ("apply/a.py", "light = {'type': 'directional'}", "the plugin name 'directional' belongs in render"),
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
        ("report/a.py", "from voldetail.results import FitResult"),
        ("fit/a.py", "from voldetail import __version__\nfrom voldetail.errors import InputError"),
        ("report/a.py", "from matplotlib.figure import Figure"),
        ("render/surface.py", "free = scene.ray_test(ray)\nx = {'type': 'scene'}"),
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
