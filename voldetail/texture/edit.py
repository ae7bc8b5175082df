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

from voldetail.detail.colour import MOST_LOBES, ColourChannel, ColourTexture, Lobe
from voldetail.errors import InputError
from voldetail.texture.curve import curve_moments

NAMES = ("fine", "middle", "coarse")
"""Thirds of a texture's bands, from the finest."""

FACINGS = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
"""Signs of the three axes that leave a rotation one."""

LARGEST_GAIN = 1000.0
LARGEST_CONTRAST = 10.0


def band_count(texture: ColourTexture) -> int:
    """Return how many bands the texture has: those of its channel with the most; of lobes, the octaves that the photo showed."""
    lobed = any(channel.lobes for channel in texture.channels)
    octaves = max(1, math.ceil(math.log2(max(texture.texels)))) if lobed else 1
    return max(octaves, *(len(channel.weights) for channel in texture.channels))


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
    channels about their means. seed, name: new ones. A lobe belongs to the band of its frequency. Raises InputError for a number
    out of range, an unknown band, or where no band is left.
    """
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
    (LVLD10 report, section 8), the mean colour too; where one has fewer bands they count as 0, and spectra of lobes are mixed
    by their variances. Principal axes have no sign: those of ``b`` are taken, with their curves, in that of the four ways to
    face that turns least, so that t = 1 has the law of ``b`` and not its pixels. The noise keeps the seed of ``a``, so that a
    sequence of steps does not jump. Raises InputError for t outside 0 to 1, a channel of lobes beside one of bands, more lobes
    than a channel may have, or two encodings.
    """
    if a.encoding != b.encoding:
        raise InputError(f"The textures add up to {a.encoding} and {b.encoding} colours; analyse both in the same encoding.")
    if not 0.0 <= t <= 1.0:
        raise InputError(f"The step {t} is out of range; allowed: 0 (the first texture) to 1 (the second).")
    if t == 0.0:
        return a
    b = faced(b, a)
    turns = Rotation.from_matrix(np.stack([np.reshape(x.axes, (3, 3)) for x in (a, b)]))
    axes = Slerp([0.0, 1.0], turns)(t).as_matrix()
    wanted = axes @ (mean_colour(a) + t * (mean_colour(b) - mean_colour(a)))
    channels = []
    for p, q, mean in zip(a.channels, b.channels, wanted, strict=True):
        curve = np.maximum.accumulate(_between(p.curve, q.curve, t))
        curve = curve + (mean - curve_moments(tuple(curve.tolist()))[0])
        weights, lobes = _mixed(p, q, t)
        channels.append({"weights": weights, "lobes": lobes, "curve": tuple(curve.tolist())})
    texels = tuple(round(p + (q - p) * t) for p, q in zip(a.texels, b.texels, strict=True))
    return _made({**dict(a), "axes": tuple(axes.ravel().tolist()), "channels": tuple(channels), "texels": texels})


def mean_colour(texture: ColourTexture) -> NDArray[np.float64]:
    """Return the mean colour (3,) of the texture, in its encoding."""
    means = np.array([curve_moments(channel.curve)[0] for channel in texture.channels])
    return np.asarray(np.reshape(texture.axes, (3, 3)).T @ means)


def faced(texture: ColourTexture, other: ColourTexture) -> ColourTexture:
    """Return the same texture with two of its axes reversed, or none, so that they turn least from those of ``other``."""
    own, aim = (np.reshape(x.axes, (3, 3)) for x in (texture, other))
    # The trace of the turn between two rotations is 1 + 2 cos(angle).
    signs = max(FACINGS, key=lambda sign: float(np.sum(np.asarray(sign)[:, None] * own * aim)))
    channels = tuple(
        c if sign > 0 else c.model_copy(update={"curve": tuple(-v for v in reversed(c.curve))})
        for c, sign in zip(texture.channels, signs, strict=True)
    )
    axes = tuple((np.asarray(signs)[:, None] * own).ravel().tolist())
    return texture.model_copy(update={"axes": axes, "channels": channels})


def _mixed(p: ColourChannel, q: ColourChannel, t: float) -> tuple[tuple[float, ...], tuple[Lobe, ...]]:
    """Return the weights and lobes between two channels."""
    if not p.lobes and not q.lobes:
        return _between(p.weights, q.weights, t), ()
    if any(p.weights) or any(q.weights):
        raise InputError("One texture is made of lobes and the other of bands; analyse both alike, with or without directions.")
    parts = []
    for channel, share in ((p, 1.0 - t), (q, t)):
        total = sum(lobe.variance for lobe in channel.lobes) or 1.0
        parts += [v.model_copy(update={"variance": v.variance / total * share}) for v in channel.lobes]
    kept = sorted(parts, key=lambda lobe: -lobe.variance)[:MOST_LOBES]
    return (), tuple(kept)


def _edited(channel: ColourChannel, factors: NDArray[np.float64], contrast: float) -> ColourChannel:
    weights = np.asarray(channel.weights) * factors[: len(channel.weights)]
    lobes = tuple(
        lobe.model_copy(update={"variance": lobe.variance * factors[_band_of(lobe, len(factors))] ** 2}) for lobe in channel.lobes
    )
    if (any(channel.weights) and not weights.any()) or (lobes and not any(lobe.variance for lobe in lobes)):
        raise InputError("The gains leave a channel without any band; give at least one band over 0.")
    mean, _ = curve_moments(channel.curve)
    curve = mean + (np.asarray(channel.curve) - mean) * contrast
    largest = max(1.0, float(weights.max(initial=0.0)) / 1e4)  # the record's limit; only the weights' ratios count
    return ColourChannel(
        weights=tuple((weights / largest).tolist()), lobes=lobes, curve=tuple(np.maximum.accumulate(curve).tolist())
    )


def _band_of(lobe: Lobe, count: int) -> int:
    """Return the band whose wavelengths, from 2^(i + 1) texels on, hold the lobe's."""
    return min(max(math.floor(-math.log2(max(lobe.frequency, 2.0**-count))) - 1, 0), count - 1)


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
