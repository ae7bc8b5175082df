"""Reliefs and photos of them for the tests of recover: made here, so that the truth is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.detail.photo_relief import MappedDetail, PhotoRelief
from voldetail.detail.record import Reflectance, ReliefParameters
from voldetail.image import Photo
from voldetail.recover.files import unsaved_maps
from voldetail.recover.light_map import LightMap, light_map
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.view import View

Array = NDArray[np.float32]


def smooth_noise(shape: tuple[int, int], shortest: float, seed: int = 0) -> Array:
    """Gaussian noise that repeats, of wavelengths from ``shortest`` to six times that in pixels, mean 0 and deviation 1."""
    rng = np.random.default_rng(seed)
    fy, fx = np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None, :]
    frequency = np.hypot(fy, fx)
    inside = (frequency < 1.0 / shortest) & (frequency > 1.0 / (6.0 * shortest))
    phase = rng.standard_normal(inside.shape) + 1j * rng.standard_normal(inside.shape)
    made = np.fft.irfft2(inside * phase / np.maximum(frequency, 1e-6), s=shape)
    return np.asarray((made - made.mean()) / made.std(), np.float32)


def slopes_of(height: Array) -> tuple[Array, Array]:
    """dh/dx and dh/dy (up) of heights that repeat."""
    p = 0.5 * (np.roll(height, -1, 1) - np.roll(height, 1, 1))
    q = 0.5 * (np.roll(height, 1, 0) - np.roll(height, -1, 0))
    return p, q


def view_of_size(shape: tuple[int, int]) -> View:
    """A picture of ``shape`` (rows, columns) whose longest side is 2 units."""
    unit = 1.0 / max(shape)
    return View(-shape[1] * unit, shape[1] * unit, -shape[0] * unit, shape[0] * unit, shape[1], shape[0])


def distant(shape: tuple[int, int], azimuth: float, elevation: float) -> LightMap:
    """A distant light over a picture."""
    return light_map(Lamp(direction_of(azimuth, elevation)), view_of_size(shape))


def lambert(height: Array, azimuth: float, elevation: float, sky: float = 0.3) -> Array:
    """Light of a matt relief without shadows, 1 where it is flat: ``sky`` from everywhere, the rest by the cosine."""
    p, q = slopes_of(height)
    x, y, z = direction_of(azimuth, elevation)
    cosine = np.maximum((-p * x - q * y + z) / np.sqrt(1 + p * p + q * q), 0.0)
    return np.asarray(sky + (1 - sky) * cosine / z, np.float32)


def photo_of(light: Array, level: float = 0.3) -> Photo:
    """A grey photo, mean ``level``."""
    grey = np.clip(light * (level / float(light.mean())), 0, 1)
    return Photo(np.repeat(grey[..., None], 3, axis=2).astype(np.float32), "a" * 64)


def mapped(shape: tuple[int, int] = (48, 64), *, periodic: bool = False, seed: int = 3) -> MappedDetail:
    """A relief of maps, not saved."""
    height = smooth_noise(shape, 8.0, seed)
    relative = (height - height.min()) / np.ptp(height)
    colour = 0.3 + 0.1 * np.stack([smooth_noise(shape, 6.0, seed + k) for k in (1, 2, 3)], axis=-1)
    record = PhotoRelief(
        name="made", seed=seed, columns=shape[1], rows=shape[0], texels_per_unit=max(shape) / 2, periodic=periodic,
        relief=ReliefParameters(amplitude=0.1), reflectance=Reflectance(ambient=0.1, diffuse=0.4), light="135,45",
        confidence=0.5, maps=unsaved_maps(),
    )  # fmt: skip
    return MappedDetail(record, relative.astype(np.float32), np.clip(colour, 0.02, 0.95).astype(np.float32),
                        np.full(shape, 0.4, np.float32))  # fmt: skip


def apart(normals: Array, true: Array, rim: int = 8) -> float:
    """The mean angle between unit normals in degrees, but for a rim."""
    cosine = np.clip((normals * true).sum(-1), -1, 1)[rim:-rim, rim:-rim]
    return float(np.degrees(np.arccos(cosine)).mean())
