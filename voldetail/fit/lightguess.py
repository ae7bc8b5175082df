"""The direction of the light, guessed from one photo of a flat, rough surface that faces the camera.

The azimuth up to a half turn is the main axis of the structure tensor: for isotropic Lambertian relief the mean square
gradient of the image is largest along the light (Koenderink & Pont, "Irradiation direction from texture", JOSA A 20(10),
2003; Chantler, "Why illuminant direction is fundamental to texture analysis", 1995). Which end of the axis the light is
at, second moments cannot tell. Two third moments do, in part, and both were chosen by measurement (see
tests/benchmarks/light_guess.py): the coarse extremes of brightness lie towards the light of where they would by chance
(lumps brightest on their lit side, gaps darkest beside it), and the sharp, curved edges of cast shadows are crossed from
bright to dark on the way to the light. The first is turned round where the relief is pits and not lumps.

Measured (results/light/light.md): the axis is right to 9 degrees in the median over 100 renderings and 11 over 66 lights of
real captures, the end for 76 and 95 in a hundred. Craters of the moon and other pits are what is taken the wrong way round.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, uniform_filter

from voldetail.fit.zone import main_wavelength
from voldetail.image import resize, resize_mask
from voldetail.results.light_guess import LightGuess

Picture = NDArray[np.float64]

ANALYSED = 512
"""Longest side in pixels at which a photo is looked at."""

SCALES = (0.07, 0.14)
"""Blurs before gradients are taken, in main wavelengths of the texture; tuned on captures of textured surfaces."""

SMALLEST_BLUR = 0.7  # pixels: below it a gradient is the camera's grain
SLOW = 3.0  # main wavelengths: what varies more slowly is the scene's shading and is divided out
COARSE = 2.0  # blurs: the coarser picture whose extremes are looked for

STRETCHED = 0.5
"""Coherence (e1 - e2) / (e1 + e2) of the structure tensor above which the texture itself has a direction: the largest
for isotropic Gaussian relief, where e1 : e2 is 3 : 1 at most (Koenderink & Pont 2003)."""

TRUSTED_AXIS = 0.45
"""Coherence from which the axis alone gives the line; below, the third moments have a say. Tuned as SCALES."""

SKEWNESS = 0.05
"""Share of the gradient's skewness in the direction of the third moments; tuned as SCALES."""

SHADOW = 3.0
"""Weight of the shadow edges against the coarse extremes in the choice of an end; tuned on rendered reliefs."""

SMALLEST_CELLS = 8.0
"""Main wavelengths squared that the picture must hold: fewer bumps than that have no statistics."""

FLAT = 1e-4
"""Variation (r.m.s., relative) below which a picture is blank; an 8-bit step at medium grey is a hundred times that."""

HALF_SURE, CHANCE, OVER = 0.12, 0.5, 0.1
"""Coherence of an axis that is right half the time, what chance makes of it, and the excess over STRETCHED that halves
its worth; tuned so that the confidence is
about the share of azimuths within 30 degrees over captures of textured surfaces and renderings."""

FLOOR = 0.1
"""Confidence below which the light is not known at all."""

FAIRLY_SURE, UNSURE, UNCERTAIN_SIGN = 0.5, 0.3, 0.7

ELEVATION_BAND = 20
"""Degrees within which the elevation was for some four in five captures, most of them 50 to 85 degrees high."""


@dataclass(frozen=True)
class Moments:
    """Averages over the used pixels and SCALES, of gradients in units of their r.m.s. value.

    tensor (2, 2); extremes (2,): E[grad I L^2], L the coarse picture; third (2, 2, 2): E[grad I x grad I x grad I].
    cells: used pixels in squared main wavelengths. turn: degrees between the axes of the two scales.
    """

    tensor: Picture
    extremes: Picture
    third: Picture
    cells: float
    turn: float

    @property
    def coherence(self) -> float:
        """(e1 - e2) / (e1 + e2) of the tensor's eigenvalues: 0 where no direction stands out."""
        low, high = np.linalg.eigvalsh(self.tensor)
        return float((high - low) / (high + low))


def guess_light(luminance: NDArray[np.floating], mask: NDArray[np.bool_] | None = None) -> LightGuess:
    """Return the LightGuess for linear ``luminance`` (H, W), of which ``mask`` (True = use) is looked at.

    Of use for a flat surface facing the camera under one distant light. The elevation is a rough one.
    """
    moments = moments_of(luminance, mask)
    if moments is None:
        return LightGuess(0.0, 60.0, 0.0, 0.5, "The picture is blank or holds too few bumps to show where its light is.")
    coherence = moments.coherence
    line, score = _direction(moments, min(coherence / TRUSTED_AXIS, 1.0) ** 2)
    azimuth = round(math.degrees(math.atan2(float(line[1]), float(line[0]))) % 360, 1) % 360
    elevation, sign = _elevation(coherence), _sign_confidence(score)
    confidence = _axis_confidence(moments) * sign
    remark = "the texture itself has a direction, which may not be the light's" if coherence > STRETCHED else ""
    sentence = _sentence(azimuth, elevation, confidence, sign, remark)
    return LightGuess(azimuth, elevation, round(float(confidence), 3), round(float(sign), 3), sentence)


def moments_of(luminance: NDArray[np.floating], mask: NDArray[np.bool_] | None = None) -> Moments | None:
    """Return the Moments of a picture; None for one that is blank, or holds too few bumps."""
    light, use = _reduced(luminance, mask)
    if use.sum() < SMALLEST_CELLS:
        return None
    light = np.where(use, light, np.mean(light[use]))
    wavelength = main_wavelength((light / max(4 * float(np.mean(light)), 1e-12)).astype(np.float32))
    cells = float(use.sum()) / wavelength**2
    level = _blurred(light, use, SLOW * wavelength)
    found = [_at(light, use, level, max(scale * wavelength, SMALLEST_BLUR)) for scale in SCALES]
    good = [m for m in found if m is not None]
    if len(good) < len(SCALES) or cells < SMALLEST_CELLS:
        return None
    axes = [_axis(tensor) for tensor, _, _ in good]
    turn = math.degrees(math.acos(min(1.0, abs(float(axes[0] @ axes[1])))))
    tensor, extremes, third = (np.mean([m[i] for m in good], axis=0) for i in range(3))
    return Moments(tensor, extremes, third, cells, turn)


def _reduced(luminance: NDArray[np.floating], mask: NDArray[np.bool_] | None) -> tuple[Picture, NDArray[np.bool_]]:
    """The picture and its mask at ANALYSED pixels at most."""
    light = np.asarray(luminance, np.float64)
    use = np.ones(light.shape, bool) if mask is None else np.asarray(mask, bool)
    use = use & np.isfinite(light)
    light = np.where(use, np.maximum(light, 0.0), 0.0)
    factor = ANALYSED / max(light.shape)
    if factor >= 1:
        return light, use
    size = (max(1, round(light.shape[0] * factor)), max(1, round(light.shape[1] * factor)))
    return resize(light, size).astype(np.float64), resize_mask(use, size)


def _blurred(light: Picture, use: NDArray[np.bool_], sigma: float) -> Picture:
    """The used pixels blurred, as if nothing were outside them."""
    weight = gaussian_filter(use.astype(np.float64), sigma, mode="constant", truncate=3)
    blurred = gaussian_filter(np.where(use, light, 0.0), sigma, mode="constant", truncate=3)
    return np.asarray(blurred / np.maximum(weight, 1e-9))


def _at(light: Picture, use: NDArray[np.bool_], level: Picture, blur: float) -> tuple[Picture, Picture, Picture] | None:
    """Tensor, extremes and third moments at one blur, in pixels; ``level`` is the slow shading."""
    smooth = _blurred(light, use, blur)
    # The square root is near enough to how pictures are encoded, and keeps highlights from ruling the moments.
    image = np.sqrt(np.maximum(smooth, 0.0) / np.maximum(level, 1e-12))
    width = 2 * int(3 * blur) + 3  # pixels that a blur and a gradient reach
    inside = uniform_filter(use.astype(np.float64), width, mode="constant") > 1 - 0.5 / width**2
    if inside.sum() < SMALLEST_CELLS or float(np.std(image[inside])) < FLAT:
        return None
    image = np.where(use, image - np.mean(image[inside]), 0.0)
    coarse = gaussian_filter(image, COARSE * blur)[inside]
    down, right = np.gradient(image)
    gradient = np.stack([right[inside], -down[inside]])  # rows run downwards, y upwards
    gradient /= math.sqrt(float(np.mean(gradient**2)))
    tensor = gradient @ gradient.T / gradient.shape[1]
    extremes = gradient @ (coarse**2 / np.mean(coarse**2)) / gradient.shape[1]
    products = (gradient[:, None] * gradient[None]).reshape(4, -1)
    third = (products @ gradient.T).reshape(2, 2, 2) / gradient.shape[1]
    return tensor, extremes, third


def _axis(tensor: Picture) -> Picture:
    return np.asarray(np.linalg.eigh(tensor)[1][:, 1])


def _direction(moments: Moments, trust: float) -> tuple[Picture, float]:
    """The unit vector of the azimuth, and the score (> 0) by which its end was chosen."""
    pull = moments.extremes - SKEWNESS * np.einsum("ijj->i", moments.third)
    pull = pull / max(float(np.hypot(*pull)), 1e-12)
    axis = _axis(moments.tensor)
    axis = axis * (1.0 if axis @ pull >= 0 else -1.0)
    line = trust * axis + (1 - trust) * pull
    line = line / max(float(np.hypot(*line)), 1e-12)
    across = np.array([-line[1], line[0]])
    along2, across2 = line @ moments.tensor @ line, across @ moments.tensor @ across
    edges = float(np.einsum("ijk,i,j,k", moments.third, line, across, across)) / (math.sqrt(along2) * across2)
    score = float(moments.extremes @ line) / math.sqrt(along2) - SHADOW * trust * edges
    return (line, score) if score >= 0 else (-line, -score)


def _axis_confidence(moments: Moments) -> float:
    """About how often the line is within 30 degrees of the light, from coherence c and what speaks against it."""
    coherence = moments.coherence
    # A picture without direction has a c of about CHANCE / cells squared all the same.
    squared = max(coherence**2 - CHANCE / moments.cells, 0.0)
    clear: float = 0.95 * squared / (squared + HALF_SURE**2)
    texture = 1.0 / (1.0 + max(coherence - STRETCHED, 0.0) / OVER)
    return clear * texture * math.exp(-((moments.turn / 25.0) ** 2))


def _sign_confidence(score: float) -> float:
    """About how often the end is right, from 300 renderings; even a clear score fails for one in seven (craters, say)."""
    return 0.5 + 0.4 * score / (score + 0.15)


def _elevation(coherence: float) -> float:
    """The elevation that the captures and renderings of that coherence had in the middle, to 5 degrees."""
    return 5.0 * round((45.0 + 30.0 * max(0.0, 1.0 - coherence / 0.3)) / 5.0)


def _sentence(azimuth: float, elevation: float, confidence: float, sign: float, remark: str) -> str:
    guess = "hardly more than a guess: give --light if you know it"
    sure = "fairly sure" if confidence >= FAIRLY_SURE else "not sure" if confidence >= UNSURE else guess
    notes = [remark] if remark else []
    if sign < UNCERTAIN_SIGN:
        notes.append(f"if bumps come out as pits, it is from the other side, {(round(azimuth) + 180) % 360} degrees")
    return (
        f"Light estimated: azimuth {round(azimuth) % 360} degrees, elevation about {elevation:g} (give or take"
        f" {ELEVATION_BAND}); {'; '.join([sure, *notes])}."
    )
