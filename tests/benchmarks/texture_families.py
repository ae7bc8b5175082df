"""Families of pictures that lead, step by step, from another sample of a reference's texture to a wrong one."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.stats import spearmanr

from tests.benchmarks import texture_pictures as pictures
from tests.benchmarks.yardsticks import reference
from voldetail.backend import mitsuba
from voldetail.detail import Detail, with_values
from voldetail.fit.space import profile
from voldetail.image import to_linear, to_srgb
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.view import View

STEPS = np.linspace(0, 1, 7)

SEEDS = (11, 12, 13)
"""Of the noise: the first is the reference's, the others are those of the paths."""

PHOTOS = pictures.DECOY_PHOTOS[::2]
"""Every second of them, for time."""

AZIMUTH, ELEVATION = 135.0, 40.0
"""Of the light, in degrees."""

TRUTHS: dict[str, dict[str, Any]] = {
    "lumps": {"noise.first_neighbour": 1, "noise.last_neighbour": 2, "noise.envelope": "gaussian", "noise.scale": 9.0,
              "noise.octaves": 2, "noise.lacunarity": 2.2, "relief.amplitude": 0.05},
    "crust": {"noise.first_neighbour": 1, "noise.last_neighbour": 2, "noise.envelope": "exponential", "noise.scale": 6.0,
              "noise.octaves": 3, "noise.lacunarity": 2.5, "relief.amplitude": 0.08, "reflectance.cell_albedo": 0.2},
}  # fmt: skip
"""Details whose renderings are references: two of few kernels a point, so that they can go from a sum to cells."""


@dataclass(frozen=True)
class Family:
    """A reference and pictures at STEPS on a path away from it, all linear."""

    name: str
    reference: pictures.Picture
    path: list[pictures.Picture]


def rendered() -> Iterator[Family]:
    """Paths of a known detail: scale, amplitude, H, stretch, the light's azimuth, and from a sum of kernels to cells."""
    mitsuba()
    surface = HeightField(View(-1.0, 1.0, -1.0, 1.0, pictures.SIDE, pictures.SIDE))
    for truth in TRUTHS.values():
        detail = with_values(Detail(seed=SEEDS[0]), truth)
        seen = _picture(surface, detail, AZIMUTH)
        for seed in SEEDS[1:]:
            other = detail.model_copy(update={"seed": seed})
            for name in ("scale", "amplitude", "profile", "stretch", "azimuth", "cells"):
                path = []
                for t in STEPS:
                    changed = with_values(other, _changed(detail, name, float(t)))
                    path.append(_picture(surface, changed, AZIMUTH + (90.0 * float(t) if name == "azimuth" else 0.0)))
                yield Family(name, seen, path)


def photographed(photos: dict[str, pictures.Picture]) -> Iterator[Family]:
    """Paths of a photo's second crop away from its first: to random phases, into a blur, into grain."""
    rng = np.random.default_rng(3)
    for name in PHOTOS:
        if name not in photos:
            continue
        photo = photos[name]
        first, second, *_ = pictures.corners(photo)
        seen, encoded = pictures.crop(photo, first), to_srgb(pictures.crop(photo, second)).astype(np.float64)
        noise = rng.standard_normal(encoded.shape)
        paths = {
            "phase": _phases(encoded, noise),
            "blur": [ndimage.gaussian_filter(encoded, 2 * t, mode="mirror") for t in STEPS],
            "grain": [encoded + 0.6 * t * encoded.std() * noise for t in STEPS],
        }
        for kind, path in paths.items():
            yield Family(kind, seen, [to_linear(np.clip(p, 0, 1).astype(np.float32)) for p in path])


def order(families: list[Family], metric: str) -> dict[str, dict[str, float]]:
    """By family, and "all": the mean rank correlation of distance and step, and the share of steps that go up, %."""
    found: dict[str, list[tuple[float, float]]] = {}
    for family in families:
        one = reference(family.reference, metric)
        ways = [one.distance(picture) for picture in family.path]
        pair = float(spearmanr(STEPS, ways).statistic), 100 * float(np.mean(np.diff(ways) > 0))
        found.setdefault(family.name, []).append(pair)
    means = {name: np.mean(pairs, axis=0) for name, pairs in found.items()}
    means["all"] = np.mean(list(means.values()), axis=0)
    return {name: {"rank": round(float(m[0]), 3), "steps": round(float(m[1]), 1)} for name, m in means.items()}


def _changed(detail: Detail, name: str, t: float) -> dict[str, Any]:
    noise, amplitude = detail.noise, detail.relief.amplitude
    ways: dict[str, dict[str, Any]] = {
        "scale": {"noise.scale": noise.scale * 2.5**t},
        "amplitude": {"relief.amplitude": amplitude * 0.15**t},
        "profile": {"noise.curve": tuple(float(v) for v in profile(np.array([1.5 * t, 0.0, 0.0])))},
        "stretch": {"noise.anisotropy": 3**t, "noise.angle": 0.5},
        "azimuth": {},
        "cells": {"noise.weights": (1.0, 1.0 - 2.0 * t, 1.0)},
    }
    return ways[name]


def _picture(surface: HeightField, detail: Detail, azimuth: float) -> pictures.Picture:
    surface.update(detail)
    parts, matt = components(surface, Lamp(direction=direction_of(azimuth, ELEVATION))), detail.reflectance
    return pictures.in_8_bits(parts.luminance(matt.ambient, matt.diffuse, 0.0, 0.0))


def _phases(encoded: np.ndarray, noise: np.ndarray) -> list[np.ndarray]:
    """The picture with its phases turned by growing shares of a random turn of -pi to pi: its spectrum stays."""
    spectrum, turn = np.fft.fft2(encoded), np.angle(np.fft.fft2(noise))
    turn[0, 0] = 0
    return [np.fft.ifft2(spectrum * np.exp(1j * t * turn)).real for t in STEPS]
