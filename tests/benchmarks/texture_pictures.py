"""Photographs cut into crops, pictures a person accepts as the same texture, and decoys that a person does not."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage import data as skimage_data

from voldetail.image import load_photo, luminance, resize, to_linear, to_srgb

Picture = NDArray[np.float32]

SIDE = 192
"""Pixels of a crop, the fit's default zone."""

_SHORT_SIDE = 400
"""Larger photos are reduced to this: a crop then holds about half of what the photographer framed."""

NOT_TEXTURES = ("skimage_", "clouds_")
"""Photos left out: the first are scikit-image's own (taken from the package, so that they are always there), with its
picture of the moon; clouds are too flat to cut."""

DECOY_PHOTOS = (
    "gravel", "grass", "brick", "duion_rock_rough_plants_01", "duion_rock_rough_weathered_01", "flash_test_2014",
    "flash_test_2061", "flash_train_2062", "flash_train_0253", "nmo_stone_slab", "ns_cracked_ground", "ns_bark",
    "ambientCG_Rock058", "polyhaven_gray_rocks",
)  # fmt: skip
"""Photos whose phase-randomised copy looks wrong. Not so for sand ripples and fine bark, which are near Gaussian:
there a person takes the copy for another crop, and no metric should be asked to refuse it."""

LIT_PHOTOS = (
    "gravel", "duion_rock_rough_plants_01", "duion_rock_rough_weathered_01", "nmo_stone_slab", "ns_cracked_ground", "ns_bark",
    "ambientCG_Rock058", "polyhaven_gray_rocks",
)  # fmt: skip
"""Those lit from one side, whose other crops turned by half a turn look lit from the other, stones like dents. Not so
under a flash, and not for grass and bricks."""

SHEET_PHOTOS = ("gravel", "grass", "brick", "ambientCG_Rock058")
"""Shown in the sheet: CC0."""


def textures(shared: Path | None) -> dict[str, Picture]:
    """Linear luminance of every texture photo with at least two disjoint crops, by name."""
    found = {name: to_linear(getattr(skimage_data, name)() / np.float32(255)) for name in ("gravel", "grass", "brick")}
    if shared is not None:
        photos = [path for path in sorted((shared / "photos").iterdir()) if not path.name.startswith(NOT_TEXTURES)]
        found |= {path.name: _load(next(path.iterdir())) for path in photos}
        found |= {path.parent.name: _load(path) for path in sorted(shared.glob("pbr/*/albedo.jpg"))}
        zhou = sorted(shared.glob("textures/nonstationary_zhou2018/*.jpg"))
        found |= {f"zhou_{path.stem}": _load(path) for path in zhou}
    return {name: photo for name, photo in found.items() if len(corners(photo)) > 1}


def _load(path: Path) -> Picture:
    photo = luminance(load_photo(path).pixels)
    short = min(photo.shape)
    if short <= 1.08 * _SHORT_SIDE:
        return photo
    height, width = (round(side * _SHORT_SIDE / short) for side in photo.shape)
    return resize(photo, (height, width))


def corners(photo: Picture) -> list[tuple[int, int]]:
    """Top left corners of up to 2 x 2 disjoint crops that tile the photo's centre."""
    down, across = (min(side // SIDE, 2) for side in photo.shape)
    top, left = (photo.shape[0] - down * SIDE) // 2, (photo.shape[1] - across * SIDE) // 2
    return [(top + SIDE * row, left + SIDE * column) for row in range(down) for column in range(across)]


def crop(photo: Picture, corner: tuple[int, int], side: int = SIDE) -> Picture:
    """The square crop of `side` pixels at a corner, moved inside the photo where it would leave it."""
    y, x = (max(min(at, size - side), 0) for at, size in zip(corner, photo.shape, strict=True))
    return np.ascontiguousarray(photo[y : y + side, x : x + side])


def accepted(photo: Picture) -> dict[str, Picture]:
    """What a person takes for the same texture as the first crop."""
    first, *others = corners(photo)
    found = {f"crop {i + 2}": crop(photo, corner) for i, corner in enumerate(others)}
    for scale in (0.95, 1.05):
        side = round(SIDE / scale)
        centred = (first[0] - (side - SIDE) // 2, first[1] - (side - SIDE) // 2)
        found[f"scale {scale}"] = resize(crop(photo, centred, side), (SIDE, SIDE))
    return found | {f"exposure {factor}": crop(photo, first) * np.float32(factor) for factor in (0.9, 1.1)}


def in_8_bits(picture: NDArray[np.floating]) -> Picture:
    """A linear picture as it comes back from an 8-bit file."""
    return from_8_bits(np.round(np.clip(to_srgb(np.maximum(picture, 0)), 0, 1) * 255))


def from_8_bits(values: NDArray[Any]) -> Picture:
    """Linear light of 8-bit sRGB values."""
    return np.asarray(to_linear(values.astype(np.float32) / np.float32(255)), np.float32)


def decoys(picture: Picture, seed: int = 7) -> dict[str, Picture]:
    """What a person does not take for the same texture, linear; "noise" has both its spectrum and its histogram."""
    rng = np.random.default_rng(seed)
    encoded = to_srgb(picture).astype(np.float64)
    found = {
        "phase": random_phase(encoded, rng),
        "noise": _matched_noise(encoded, rng),
        "blur": ndimage.gaussian_filter(encoded, 1.5, mode="mirror"),
        "grain": encoded + rng.normal(0, max(0.04, 0.3 * encoded.std()), encoded.shape),
    }
    return {name: to_linear(np.clip(shown, 0, 1).astype(np.float32)) for name, shown in found.items()}


def turned(photo: Picture) -> Picture:
    """Return another crop of a photo turned by half a turn: the same texture lit from the other side."""
    return np.ascontiguousarray(crop(photo, corners(photo)[1])[::-1, ::-1])


def random_phase(encoded: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """The same spectrum with random phases, of the periodic component (Moisan 2011) so that borders leave no cross."""
    height, width = encoded.shape
    jumps = np.zeros_like(encoded)
    jumps[0] += encoded[-1] - encoded[0]
    jumps[-1] += encoded[0] - encoded[-1]
    jumps[:, 0] += encoded[:, -1] - encoded[:, 0]
    jumps[:, -1] += encoded[:, 0] - encoded[:, -1]
    laplace = 2 * np.cos(2 * np.pi * np.fft.fftfreq(height))[:, None] + 2 * np.cos(2 * np.pi * np.fft.fftfreq(width)) - 4
    laplace[0, 0] = 1
    smooth = np.fft.fft2(jumps) / laplace
    smooth[0, 0] = 0
    phases = np.fft.fft2(rng.standard_normal(encoded.shape))
    phases /= np.abs(phases)
    phases[0, 0] = 1
    return np.asarray(np.fft.ifft2((np.fft.fft2(encoded) - smooth) * phases).real)


def _matched_noise(encoded: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Noise with the picture's spectrum and, exactly, its histogram, by turns (Schreiber & Schmitz 1996)."""
    values, amplitude = np.sort(encoded.ravel()), np.abs(np.fft.fft2(encoded))
    noise = random_phase(encoded, rng)
    for _ in range(20):
        spectrum = np.fft.fft2(_ranked(noise, values))
        noise = np.fft.ifft2(spectrum * amplitude / np.maximum(np.abs(spectrum), 1e-12)).real
    return _ranked(noise, values)


def _ranked(noise: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    ranked = np.empty(values.size)
    ranked[np.argsort(noise.ravel())] = values
    return ranked.reshape(noise.shape)
