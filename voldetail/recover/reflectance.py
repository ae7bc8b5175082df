"""How the recovered relief reflects: three coefficients for the photo, and an albedo for each pixel.

The picture is linear in the coefficients (GD10 section 7), so they are found by least squares under bounds:

    L = Ka A + Kd D + Ks S_n,    albedo = (I - Ks S_n) / (Ka A + Kd D)

with the components A, D, S_n of the relief under the photo's light. Where the relief lies in shadow the quotient says little;
there the albedo is filled from around.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.optimize import nnls

from voldetail.detail.record import Reflectance
from voldetail.image import luminance
from voldetail.recover.gates import SLOW
from voldetail.recover.shading import SHININESS, Shading

SAMPLES = 40_000
"""Pixels by which the coefficients are solved."""

GLOSS_GAIN = 0.95
"""Share of the matt surface's residual that a highlight has to leave at most: for less it is not believed."""

GLOSS_LIMIT = 0.06
"""Largest Ks: what a dielectric of index 1.65 reflects head-on."""

LEAST_AMBIENT = 0.2
"""Least share of Ka in Ka + Kd: without any sky, shadows would be black and the albedo in them endless."""

DARK = 0.35
"""Shading, of its median, below which the albedo is filled in more and more."""

FILL = 0.02
"""Standard deviation of the filling mean over the shorter side."""

MATT = 0.9
"""Roughness where no highlight was seen."""


@dataclass(frozen=True, eq=False)
class Surface:
    """reflectance: Ka, Kd, Ks, N. albedo (H, W, 3): linear, 0 to 1. roughness: alpha of the highlight."""

    reflectance: Reflectance
    albedo: NDArray[np.float32]
    roughness: float


def surface_of(
    pixels: NDArray[np.float32],
    weight: NDArray[np.float32],
    slow: NDArray[np.float32] | None,
    shading: Shading,
) -> Surface:
    """Return the reflectance and albedo of ``pixels`` (H, W, 3) whose relief has ``shading``.

    weight (H, W): which pixels count. slow (H, W): under a near lamp the photo's slow mean luminance, None under a distant one. A
    near lamp's true fall-off, its lobe and the lens's vignetting are not known: what is slow in the photo is taken for theirs,
    and the relief's own shading brought to the same. Under a distant light it is paint.
    """
    read = weight > 0
    if not read.any():
        read = np.ones_like(read)
    light = luminance(pixels)
    level = float(light[read].mean())
    fall = np.float32(1.0) if slow is None else np.asarray(slow / float(slow[read].mean()), np.float32)
    even = np.asarray(light / fall, np.float32)
    own = shading.diffuse
    if slow is not None:
        own = np.asarray(own / np.maximum(_slow(own), 1e-3) * np.float32(own[read].mean()), np.float32)
    ambient, diffuse, specular, lobe = _coefficients(even, own, shading, read, level)
    shade = np.asarray(ambient * shading.ambient + diffuse * own, np.float32)
    gloss = np.zeros_like(light) if lobe < 0 else specular * shading.specular[lobe]
    flat = pixels / np.atleast_1d(fall)[..., None] - gloss[..., None]
    quotient = np.maximum(flat, 0.0) / np.maximum(shade, 1e-4)[..., None]
    found = _filled(np.asarray(quotient, np.float32), shade, read)
    # The map's factor has mean 1; the coefficients take what it had over that.
    gain = max(float(luminance(found)[read].mean()), 1e-6)
    brightest = float(np.percentile(found[read] / gain, 99.8))
    base = min(max(diffuse * gain, 1e-3), 1.0)
    albedo = np.clip(found / gain * min(base, 1.0 / max(brightest, 1e-6)), 0.0, 1.0)
    exponent = SHININESS[max(lobe, 0)]
    reflectance = Reflectance(
        ambient=min(ambient * gain, 1.0), diffuse=base, specular=specular, shininess=exponent, tint=(1.0, 1.0, 1.0)
    )
    return Surface(reflectance, albedo.astype(np.float32), MATT if specular == 0 else math.sqrt(2.0 / (exponent + 2.0)))


def _slow(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(gaussian_filter(values, SLOW * min(values.shape), truncate=3.0), np.float32)


def _coefficients(
    even: NDArray[np.float32], own: NDArray[np.float32], shading: Shading, read: NDArray[np.bool_], level: float
) -> tuple[float, float, float, int]:
    """Return Ka, Kd, Ks and the number of the lobe, -1 for none."""
    index = np.flatnonzero(read.ravel())
    index = index[:: max(1, len(index) // SAMPLES)]
    wanted = even.ravel()[index].astype(np.float64)
    matt = np.stack([shading.ambient.ravel()[index], own.ravel()[index]], axis=1).astype(np.float64)
    (ambient, diffuse), residual = nnls(matt, wanted)
    specular, lobe = 0.0, -1
    for number, lobes in enumerate(shading.specular):
        columns = np.column_stack([matt, lobes.ravel()[index]])
        (a, d, s), left = nnls(columns, wanted)
        if 0 < s <= GLOSS_LIMIT and left < residual * (GLOSS_GAIN if lobe < 0 else 1.0):
            ambient, diffuse, specular, lobe, residual = a, d, s, number, left
    # A sky is always there, and so is a lamp: shares are kept within what photographs have.
    total = float(ambient * matt[:, 0].mean() + diffuse * matt[:, 1].mean())
    total = total if total > 1e-9 else level
    share = float(np.clip(ambient * matt[:, 0].mean() / total, LEAST_AMBIENT, 0.9))
    return (
        share * total / max(float(matt[:, 0].mean()), 1e-6), (1.0 - share) * total / max(float(matt[:, 1].mean()), 1e-6),
        float(specular), lobe,
    )  # fmt: skip


def _filled(albedo: NDArray[np.float32], shade: NDArray[np.float32], read: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return ``albedo`` (H, W, 3) with what lies in shadow or was not read filled from around."""
    median = float(np.median(shade[read]))
    trust = np.clip(shade / max(DARK * median, 1e-6), 0.0, 1.0) ** 2 * read
    sigma = max(FILL * min(shade.shape), 2.0)
    near = gaussian_filter(trust.astype(np.float32), sigma)
    mean = albedo[read].mean(axis=0)
    out = np.empty_like(albedo)
    for c in range(3):
        around = gaussian_filter((albedo[..., c] * trust).astype(np.float32), sigma)
        smooth = (around + 1e-3 * mean[c]) / (near + 1e-3)
        out[..., c] = trust * albedo[..., c] + (1.0 - trust) * smooth
    return out
