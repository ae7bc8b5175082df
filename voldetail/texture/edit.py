"""Textures changed by their numbers: bands louder or quieter, contrast, and steps from one texture to another.

A channel's noise is divided by its own deviation before its curve (texture.synthesis). A gain therefore moves power from the
other bands to one, and the histogram stays; contrast is what changes the histogram.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from scipy.spatial.transform import Rotation, Slerp

from voldetail.detail.colour import ColourChannel, ColourTexture
from voldetail.errors import InputError
from voldetail.texture.curve import curve_moments

NAMES = ("fine", "middle", "coarse")
"""Thirds of a texture's bands, from the finest."""

LARGEST_GAIN = 1000.0
LARGEST_CONTRAST = 10.0


def band_count(texture: ColourTexture) -> int:
    """Return how many bands the texture has: those of its channel with the most."""
    return max(len(channel.weights) for channel in texture.channels)


def bands_named(name: str | int, count: int) -> range:
    """Return the bands that ``name`` means: a number (0 the finest), "fine", "middle", "coarse", or a span as "2-4".

    Raises InputError for another.
    """
    text = str(name).strip()
    if text in NAMES:
        third = NAMES.index(text)
        return range(round(third * count / 3), round((third + 1) * count / 3))
    first, dash, last = text.partition("-")
    if first.isdecimal() and (not dash or last.isdecimal()) and len(text) < 12:
        found = range(int(first), int(last or first) + 1)
        if len(found) and found[-1] < count:
            return found
    raise InputError(
        f"There is no band {text[:40]!r}; the texture has 0 (the finest) to {count - 1}, spans as 0-1, and {', '.join(NAMES)}."
    )


def edit(
    texture: ColourTexture,
    gains: Mapping[int | str, float] | None = None,
    *,
    contrast: float = 1.0,
    seed: int | None = None,
    name: str | None = None,
) -> ColourTexture:
    """Return ``texture`` with its bands' weights multiplied and its colours' distance from their mean.

    gains: factor (0 to 1000) by band, as `bands_named` takes them; several for one band multiply. contrast: 0 to 10, of all
    channels about their means. seed, name: new ones. Raises InputError for a number out of range, an unknown band, a texture
    of lobes, or where no band is left.
    """
    refuse_lobes(texture)
    if not 0.0 <= contrast <= LARGEST_CONTRAST:
        raise InputError(f"The contrast {contrast} is out of range; allowed: 0 to {LARGEST_CONTRAST:g}.")
    count = band_count(texture)
    factors = np.ones(count)
    for key, gain in (gains or {}).items():
        if not (math.isfinite(gain) and 0.0 <= gain <= LARGEST_GAIN):
            raise InputError(f"The gain {gain} of band {key} is out of range; allowed: 0 to {LARGEST_GAIN:g}.")
        factors[list(bands_named(key, count))] *= gain
    channels = [_edited(channel, factors, contrast) for channel in texture.channels]
    changes = {"channels": tuple(channels)}
    if seed is not None:
        changes["seed"] = seed  # type: ignore[assignment]
    if name is not None:
        changes["name"] = name  # type: ignore[assignment]
    return _made({**dict(texture), **changes})


def morph(a: ColourTexture, b: ColourTexture, t: float) -> ColourTexture:
    """Return the texture ``t`` (0 to 1) of the way from ``a`` to ``b``.

    The rotation goes along the shortest arc between the two (slerp of quaternions), all other numbers along straight lines
    (LVLD10 report, section 8); where one has fewer bands they count as 0. The noise keeps the seed of ``a``, so that a
    sequence of steps does not jump. Raises InputError for t outside 0 to 1, lobes, or two encodings.
    """
    for texture in (a, b):
        refuse_lobes(texture)
    if a.encoding != b.encoding:
        raise InputError(f"The textures add up to {a.encoding} and {b.encoding} colours; analyse both in the same encoding.")
    if not 0.0 <= t <= 1.0:
        raise InputError(f"The step {t} is out of range; allowed: 0 (the first texture) to 1 (the second).")
    if t == 0.0:
        return a
    if t == 1.0:
        return b.model_copy(update={"seed": a.seed})
    turns = Rotation.from_matrix(np.stack([np.reshape(x.axes, (3, 3)) for x in (a, b)]))
    axes = Slerp([0.0, 1.0], turns)(t).as_matrix()
    channels = tuple(
        ColourChannel(
            weights=_between(p.weights, q.weights, t), curve=tuple(np.maximum.accumulate(_between(p.curve, q.curve, t)).tolist())
        )
        for p, q in zip(a.channels, b.channels, strict=True)
    )
    texels = tuple(round(p + (q - p) * t) for p, q in zip(a.texels, b.texels, strict=True))
    return _made({**dict(a), "axes": tuple(axes.ravel().tolist()), "channels": channels, "texels": texels})


def refuse_lobes(texture: ColourTexture) -> None:
    """Raise InputError for a texture of lobes: it has no bands."""
    if any(channel.lobes for channel in texture.channels):
        raise InputError(f"The texture {texture.name} is made of lobes and has no bands; give one that is made of bands.")


def _edited(channel: ColourChannel, factors: NDArray[np.float64], contrast: float) -> ColourChannel:
    weights = np.asarray(channel.weights) * factors[: len(channel.weights)]
    if any(channel.weights) and not weights.any():
        raise InputError("The gains leave a channel without any band; give at least one band over 0.")
    mean, _ = curve_moments(channel.curve)
    curve = mean + (np.asarray(channel.curve) - mean) * contrast
    largest = max(1.0, float(weights.max()) / 1e4)  # the record's limit; only the weights' ratios count
    return ColourChannel(weights=tuple((weights / largest).tolist()), curve=tuple(np.maximum.accumulate(curve).tolist()))


def _between(p: tuple[float, ...], q: tuple[float, ...], t: float) -> tuple[float, ...]:
    length = max(len(p), len(q))
    first, second = (np.pad(np.asarray(v, np.float64), (0, length - len(v))) for v in (p, q))
    return tuple((first + (second - first) * t).tolist())


def _made(values: dict[str, object]) -> ColourTexture:
    try:
        return ColourTexture.model_validate(values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise InputError(f"The texture cannot have this {'.'.join(map(str, first['loc']))}: {first['msg']}.") from None
