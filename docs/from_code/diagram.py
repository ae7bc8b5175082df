"""The rooms as a picture: boxes in layers, each above what it uses; arrows that follow from others are left out."""

from __future__ import annotations

from html import escape
from itertools import pairwise

from from_code.rooms import downward, height, needed, rooms

WIDTH, BOX, GAP, LAYER, MARGIN = 760, (104, 30), 18, 74, 16
"""Of the picture, a box, the least distance of boxes, and the distance of layers, in pixels."""

SWEEPS = 24

_STYLE = (
    ".rooms rect{fill:var(--color-background-secondary,#f4f4f4);stroke:var(--color-brand-primary,#2962ff)}"
    ".rooms text{fill:var(--color-foreground-primary,#111);font:14px monospace;text-anchor:middle}"
    ".rooms path{fill:none;stroke:var(--color-foreground-muted,#888);stroke-width:1.2}"
)


def diagram() -> str:
    """Return the picture as SVG; a box's title is the room's sentence. Colours are those of the page around it."""
    every = rooms()
    upper = {name: room for name, room in every.items() if not room.leaf}
    uses = downward(upper)
    layers, chains = _layers(uses, needed(uses))
    places = _places(layers, chains)
    bottom = MARGIN + LAYER * len(layers)
    parts = [_path([places[name] for name in chain]) for chain in chains]
    parts += [_box(*places[name], name, room.sentence) for name, room in upper.items()]
    parts.append(_foot(bottom, sorted(name for name, room in every.items() if room.leaf)))
    total = bottom + 52
    return (
        f'<svg class="rooms" viewBox="0 0 {WIDTH} {total}" width="100%" role="img" xmlns="http://www.w3.org/2000/svg">'
        f"<title>The rooms of voldetail; each uses those that its lines lead down to</title><style>{_STYLE}</style>"
        + "".join(parts)
        + "</svg>\n"
    )


def _layers(uses: dict[str, set[str]], arrows: dict[str, set[str]]) -> tuple[list[list[str]], list[list[str]]]:
    """Return the layers from the top and, for each arrow, its chain of places: one in each layer between its ends."""
    level = {name: height(name, uses) for name in uses}
    count = max(level.values()) + 1
    layers: list[list[str]] = [[] for _ in range(count)]
    for name in sorted(uses):
        layers[count - 1 - level[name]].append(name)
    chains = []
    for name in sorted(arrows):
        for below in sorted(arrows[name]):
            first, last = count - 1 - level[name], count - 1 - level[below]
            bends = [f"{name}>{below}@{k}" for k in range(first + 1, last)]
            for k, bend in enumerate(bends, start=first + 1):
                layers[k].append(bend)
            chains.append([name, *bends, below])
    return layers, chains


def _places(layers: list[list[str]], chains: list[list[str]]) -> dict[str, tuple[float, float]]:
    """Return the centre of each box and bend: each near the mean of what it is tied to, kept apart from its neighbours."""
    ties: dict[str, list[str]] = {name: [] for layer in layers for name in layer}
    for chain in chains:
        for a, b in pairwise(chain):
            ties[a].append(b)
            ties[b].append(a)
    x = {name: WIDTH * (i + 1) / (len(layer) + 1) for layer in layers for i, name in enumerate(layer)}
    for sweep in range(SWEEPS):
        for layer in layers if sweep % 2 == 0 else layers[::-1]:
            wished = {name: sum(x[t] for t in ties[name]) / len(ties[name]) if ties[name] else x[name] for name in layer}
            layer.sort(key=lambda name: wished[name])
            _spread(layer, wished, x)
    aside = WIDTH / 2 - (min(x.values()) + max(x.values())) / 2
    return {name: (x[name] + aside, MARGIN + LAYER * k + BOX[1] / 2) for k, layer in enumerate(layers) for name in layer}


def _spread(layer: list[str], wished: dict[str, float], x: dict[str, float]) -> None:
    """Put the places of a layer as near to where they are wished as their widths and the picture allow."""
    widths = [BOX[0] if "@" not in name else GAP for name in layer]
    for name in layer:
        x[name] = wished[name]
    for _ in range(50):
        for i in range(len(layer) - 1):
            least = (widths[i] + widths[i + 1]) / 2 + GAP
            missing = least - (x[layer[i + 1]] - x[layer[i]])
            if missing > 0:
                x[layer[i]] -= missing / 2
                x[layer[i + 1]] += missing / 2
        for i, name in enumerate(layer):
            side = widths[i] / 2 + 2
            x[name] = min(max(x[name], side), WIDTH - side)


def _path(points: list[tuple[float, float]]) -> str:
    """Return a smooth line from the foot of the first box through the bends to the head of the last."""
    (x0, y0), (x1, y1) = points[0], points[-1]
    ends = [(x0, y0 + BOX[1] / 2), *points[1:-1], (x1, y1 - BOX[1] / 2)]
    text = f"M{ends[0][0]:.1f} {ends[0][1]:.1f}"
    for (ax, ay), (bx, by) in pairwise(ends):
        middle = (ay + by) / 2
        text += f"C{ax:.1f} {middle:.1f} {bx:.1f} {middle:.1f} {bx:.1f} {by:.1f}"
    return f'<path d="{text}"/>'


def _box(x: float, y: float, name: str, sentence: str) -> str:
    left, top = x - BOX[0] / 2, y - BOX[1] / 2
    return (
        f'<g><title>{escape(sentence)}</title><rect x="{left:.1f}" y="{top:.1f}" width="{BOX[0]}" height="{BOX[1]}" rx="4"/>'
        f'<text x="{x:.1f}" y="{y + 5:.1f}">{name}</text></g>'
    )


def _foot(top: float, names: list[str]) -> str:
    words = "below all: " + ", ".join(names)
    return (
        f'<g><rect x="{MARGIN}" y="{top}" width="{WIDTH - 2 * MARGIN}" height="34" rx="4"/>'
        f'<text x="{WIDTH / 2}" y="{top + 22}">{words}</text></g>'
    )
