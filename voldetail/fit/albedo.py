"""Colour apart from relief: what of a photo's colours the fitted relief's shading does not account for.

    log p = log a + log s            p photo, a albedo, s shading; of each pixel and channel
    log a_k = G * l + (log p_k - l)   l = log luminance of p

Light that falls on grey relief changes luminance and leaves chromaticity, so chromaticity is albedo's alone. Of luminance
the fitted relief makes a part whose pattern is not the photo's pixel by pixel, but whose power spectrum is known; albedo and
relief being independent, their powers add, and albedo's is what is left:

    |G(f)|^2 = max(0, 1 - P_s(f) / P_l(f))

P_s, P_l: power of log s (the fit's own pictures, over seeds) and of l at the frequency f. So a relit picture is as contrasted
as the photo was, band by band, and shading is not there twice. A band's power is known but to chance, of which one deviation
is added to the shading's: albedo that may be chance is left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from voldetail.image import luminance

DARK = 0.01
"""Linear luminance below which an 8-bit photo's colour is mostly noise, and is drawn towards the mean."""

LEAST = 1e-3
"""Of linear light: below it a logarithm tells of the camera's noise alone."""

BANDS_AN_OCTAVE = 3
"""Of the spectra's comparison: wider hides that relief is coarse or fine, narrower follows chance."""

WINDOW_LOSS = 2.0 * 2.25
"""Cells of a spectrum for each that is independent: of a real field's, half; of those under a Hann window, 1 / 1.5^2."""

BRIGHTEST = 0.98
"""Quantile of the brightest channel that becomes an albedo of 1: what is above is a highlight more often than paint."""


def albedo_apart(
    pixels: NDArray[np.float32], mask: NDArray[np.bool_], shadings: Sequence[NDArray[np.float32]]
) -> NDArray[np.float32]:
    """Return the albedo (H, W, 3) in [0, 1], up to one factor, of a photo whose relief has the ``shadings``.

    ``pixels`` (H, W, 3) linear; ``mask`` (H, W), outside of which the mean is returned; ``shadings``: luminances (H, W) of the
    fitted relief under the photo's light, of several seeds; with none, the photo itself is taken for albedo.
    """
    light = luminance(pixels)
    level = np.log(np.maximum(light, LEAST))
    mean = level[mask].mean()
    chroma = np.log(np.maximum(pixels, LEAST * 0.1)) - level[..., None]
    usual = chroma[mask].mean(axis=0)
    trust = (light / (light + DARK))[..., None]
    chroma = usual + trust * (chroma - usual)
    detail = np.where(mask, level - mean, 0.0)
    if shadings:
        detail = _remaining(detail, mask, [np.log(np.maximum(s, LEAST)) for s in shadings])
    colour = np.exp(np.where(mask[..., None], detail[..., None] + chroma, usual))
    return np.asarray(np.minimum(colour / np.quantile(colour[mask].max(axis=-1), BRIGHTEST), 1.0), dtype=np.float32)


def _remaining(
    level: NDArray[np.float32], mask: NDArray[np.bool_], shadings: Sequence[NDArray[np.float32]]
) -> NDArray[np.float32]:
    """Return ``level`` filtered by G."""
    photo = _power(level, mask)
    relief = np.mean([_power(np.where(mask, s - s[mask].mean(), 0.0), mask) for s in shadings], axis=0)
    band = np.rint(_octaves(level.shape, level.shape)).astype(np.int64)
    count = int(band.max()) + 1
    cells, total, shaded = (np.bincount(band.ravel(), p, count) for p in (None, photo.ravel(), relief.ravel()))
    chance = np.sqrt(WINDOW_LOSS / np.maximum(cells, 1.0) * (1.0 + 1.0 / len(shadings)))
    gain = np.sqrt(np.clip(1.0 - shaded * (1.0 + chance) / np.maximum(total, 1e-12), 0.0, 1.0))
    # Mirrored at its edges, where a photo does not go on with its other side.
    rows, columns = level.shape
    padded = np.pad(level, ((0, rows), (0, columns)), mode="symmetric")
    filtered = np.fft.fft2(padded) * np.interp(_octaves(padded.shape, level.shape), np.arange(count), gain)
    return np.asarray(np.fft.ifft2(filtered).real[:rows, :columns], np.float32)


def _power(level: NDArray[np.float32], mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the power spectrum under a window that hides the jump from edge to edge."""
    rows, columns = level.shape
    window = np.outer(np.hanning(rows + 2)[1:-1], np.hanning(columns + 2)[1:-1])
    return np.asarray(np.abs(np.fft.fft2(level * window * mask)) ** 2, np.float64)


def _octaves(shape: tuple[int, ...], of: tuple[int, ...]) -> NDArray[np.float64]:
    """Return where each frequency lies, in bands from one cycle across a picture of the shape ``of``."""
    rows, columns = shape
    lowest = 1.0 / max(of)
    radius = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)[None, :])
    return np.asarray(np.log2(np.maximum(radius, lowest) / lowest) * BANDS_AN_OCTAVE)
