"""The photo as the fit sees it: the zone at working resolution, its mask, light, colour and descriptor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.errors import InputError
from voldetail.fit.evenness import evened, unevenness
from voldetail.fit.zone import around, check_zone, default_zone
from voldetail.image import Photo, as_photo, luminance, resize, resize_mask, used_of, with_mask
from voldetail.metric import describe, distance
from voldetail.render.build import faces_camera
from voldetail.results.target import Target
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import lamp_of
from voldetail.setup.setup import Setup
from voldetail.setup.view import View, Zone, view_of

SLOW_SHADING = 0.12
"""Blur, in zone widths, that separates a near light's fall-off from the texture; tuned on the flash photographs, where the main
wavelength is a tenth of this."""

REACH = 3.0
"""How many times the zone's side the part of the photo is long that an even picture of the zone is made of."""

BLACK = 1e-6
"""Mean luminance of a photo below which it has no colour; a hundredth of the darkest 8-bit value but black."""


def reduced(target: Target, metric: str, size: tuple[int, int]) -> Target:
    """Return the same target at fewer pixels (rows, columns), for the coarse pass."""
    pixels = resize(target.pixels, size)
    light = luminance(pixels)
    mask = resize_mask(target.mask, size)
    return replace(
        target, pixels=pixels, luminance=light, mask=mask, descriptor=describe(light, mask, metric=metric),
        photo_halves=None, unevenness=None,
    )  # fmt: skip


def load_photo_of(setup: Setup) -> Photo:
    """Return the photo of a Setup: a file, or one that scikit-image ships."""
    return as_photo(setup.photo.path, encoding=setup.photo.encoding)


def mask_of(setup: Setup, photo: Photo) -> NDArray[np.bool_]:
    """Return which pixels (H, W) of the whole photo are used: the mask's, where they are opaque."""
    return used_of(with_mask(photo, setup.mask))


def make_target(setup: Setup, photo: Photo | None = None) -> Target:
    """Return the Target of a Setup.

    Raises InputError for a photo, mask or zone that cannot be used.
    """
    photo = photo or load_photo_of(setup)
    rows, columns = photo.pixels.shape[:2]
    mask = mask_of(setup, photo)
    zone = setup.photo.zone or default_zone(luminance(photo.pixels), mask, setup.photo.resolution)
    check_zone(zone, (rows, columns))
    factor = setup.photo.resolution / max(zone[2:])
    pixels, inside = _cut(photo.pixels, mask, zone, factor)
    size = (inside.shape[0], inside.shape[1])
    if not inside.any():
        raise InputError("The mask leaves nothing of the zone to compare: use a larger mask or another --zone.")
    lamp = lamp_of(setup.light, luminance(photo.pixels))
    if lamp.near and faces_camera(setup):
        view = view_of(setup.camera, (rows, columns), zone, setup.photo.resolution)
        pixels = _with_falloff_of(lamp, pixels, inside, view)
    uneven = unevenness(pixels, inside) if faces_camera(setup) and not setup.medium else None
    if setup.photo.stationarize:
        source, seen = pixels, inside
        if setup.photo.zone is None and not lamp.near:
            # A zone that the user drew says what is meant; else there is more of the surface beside it.
            source, seen = _cut(photo.pixels, mask, around(zone, (rows, columns), REACH), factor)
        pixels, inside = evened(source, seen, size, setup.seed), np.ones_like(inside)
    light = luminance(pixels)
    mean = pixels[inside].mean(axis=0).astype(np.float64)
    brightness = float(luminance(mean[None, None, :].astype(np.float32))[0, 0])
    tint = mean / brightness if brightness > BLACK else np.ones(3)
    descriptor = describe(light, inside, metric=setup.fit.metric)
    return Target(
        photo=photo,
        pixels=pixels,
        luminance=light,
        mask=inside,
        shape=(rows, columns),
        zone=zone,
        lamp=lamp,
        tint=(float(tint[0]), float(tint[1]), float(tint[2])),
        descriptor=descriptor,
        photo_halves=halves_apart(light, inside, setup.fit.metric),
        white=max(1.0, float(light.max())),
        unevenness=uneven,
    )


def _cut(
    pixels: NDArray[np.float32], mask: NDArray[np.bool_], zone: Zone, factor: float
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return a part of the photo and of its mask, resized."""
    x, y, w, h = zone
    size = (max(1, round(h * factor)), max(1, round(w * factor)))
    return resize(pixels[y : y + h, x : x + w], size), resize_mask(mask[y : y + h, x : x + w], size)


def _with_falloff_of(lamp: Lamp, pixels: NDArray[np.float32], mask: NDArray[np.bool_], view: View) -> NDArray[np.float32]:
    """Return ``pixels`` with the slow fall-off of their light replaced by that of ``lamp`` on a bare plane.

    A flash's true height, its lobe and the lens's vignetting are not known; what they do to the photo belongs to the
    scene and must not be fitted as relief. Burnt-out pixels stay as they are.
    """
    sigma = SLOW_SHADING * max(mask.shape)
    weight = np.maximum(gaussian_filter(mask.astype(np.float32), sigma, mode="nearest"), 1e-3)
    slow = gaussian_filter(np.where(mask, luminance(pixels), 0.0), sigma, mode="nearest") / weight
    x, y = view.coordinates(1)
    wanted = lamp.on_plane(x, y).reshape(mask.shape)
    gain = wanted / np.maximum(slow, 1e-4)
    gain *= np.mean(slow[mask]) / np.mean(wanted[mask])
    return np.asarray(np.minimum(pixels * np.clip(gain, 0.25, 4.0)[..., None], 1.0), dtype=np.float32)


def halves_apart(light: NDArray[np.float32], mask: NDArray[np.bool_], metric: str) -> float | None:
    """Return the distance between the left and the right half, described like the left; None where one is too small."""
    half = light.shape[1] // 2
    try:
        left = describe(np.ascontiguousarray(light[:, :half]), np.ascontiguousarray(mask[:, :half]), metric=metric)
        right = describe(np.ascontiguousarray(light[:, -half:]), np.ascontiguousarray(mask[:, -half:]), like=left)
    except InputError:
        return None
    return distance(left, right)
