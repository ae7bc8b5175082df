"""The rooms of the package, what each holds and which it uses: read from the imports of every module."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import voldetail
from from_code.markdown import code, plain, table

PACKAGE = Path(voldetail.__file__).parent
TOP = "api"
"""The one module on top of the rooms; the other single modules are what everything may stand on."""


@dataclass(frozen=True)
class Room:
    """A sub-package or module of voldetail: its first sentence, the rooms that it imports, its files and lines."""

    name: str
    sentence: str
    uses: frozenset[str]
    files: int
    lines: int

    @property
    def leaf(self) -> bool:
        """Whether it is a single module below all rooms."""
        return self.files == 1 and not (PACKAGE / self.name).is_dir() and self.name != TOP


def rooms() -> dict[str, Room]:
    """Return every room by name, in the order of the alphabet."""
    paths = sorted(p for p in PACKAGE.iterdir() if (p / "__init__.py").exists() or (p.suffix == ".py" and p.stem != "__init__"))
    known = {path.stem for path in paths}
    found = {}
    for path in paths:
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        texts = [file.read_text(encoding="utf-8") for file in files]
        trees = [ast.parse(text) for text in texts]
        uses = {name for tree in trees for name in _imports(tree) if name in known} - {path.stem}
        document = ast.get_docstring(trees[0]) or ""  # __init__.py sorts first
        lines = sum(text.count("\n") for text in texts)
        found[path.stem] = Room(path.stem, document.split("\n")[0], frozenset(uses), len(files), lines)
    return found


def rooms_page() -> str:
    """Return the table of rooms, those that use the others first."""
    all_rooms = rooms()
    uses = downward(all_rooms)
    order = sorted(all_rooms.values(), key=lambda r: (-height(r.name, uses), r.name))
    rows = [(code(r.name), plain(r.sentence), ", ".join(map(code, sorted(r.uses))), str(r.files), str(r.lines)) for r in order]
    return table(["room", "what it holds", "uses", "files", "lines"], rows)


def height(name: str, uses: dict[str, set[str]]) -> int:
    """Return the length of the longest way down from a room."""
    return max((height(below, uses) + 1 for below in uses[name]), default=0)


def downward(all_rooms: dict[str, Room]) -> dict[str, set[str]]:
    """Return what each room uses, but for what closes a circle, which no picture of layers can have."""
    uses: dict[str, set[str]] = {}
    above: list[str] = []

    def go(name: str) -> None:
        above.append(name)
        uses[name] = {below for below in all_rooms[name].uses if below in all_rooms and below not in above}
        for below in sorted(uses[name]):
            if below not in uses:
                go(below)
        above.pop()

    for name in sorted(all_rooms):
        if name not in uses:
            go(name)
    return uses


def needed(uses: dict[str, set[str]]) -> dict[str, set[str]]:
    """Return for each room the rooms that it uses and reaches by no other way: the lines worth drawing."""

    def reach(name: str) -> set[str]:
        return uses[name] | {far for near in uses[name] for far in reach(near)}

    return {name: below - {far for near in below for far in reach(near)} for name, below in uses.items()}


def _imports(tree: ast.AST) -> Iterator[str]:
    """Yield the rooms that a module imports at run time; what is imported for types alone does not count."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[1] for alias in node.names if alias.name.startswith("voldetail."))
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "voldetail":
            inner = node.module.split(".")[1:]
            yield from [inner[0]] if inner else [alias.name for alias in node.names]
        else:
            yield from _imports(node)
