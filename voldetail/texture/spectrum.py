"""The power spectrum of a picture with edges and holes, after Blackman and Tukey (The Measurement of Power Spectra, 1958).

Symbols
    z, m     the picture, and 1 where it counts, 0 elsewhere; the mean over m is taken off z first
    C(t)     sum_x m z(x) m z(x + t) / sum_x m(x) m(x + t), the covariance at the shift t: the picture's edges and holes divide
             out, so nothing leaks across them and no window eats the border
    L        deviation of the lag window exp(-t^2 / 2 L^2), in texels
    S(f)     the Fourier transform of C times the lag window: the spectrum blurred by a Gaussian of deviation 1 / (2 pi L)

The blur lowers the variance (a value is a mean of about (shorter side / L)^2 / 4 pi independent ones) and is known, so that who
fits Gaussians can take its variance off theirs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from voldetail.errors import InputError

LAG_SHARE = 1 / 8
"""L over the shorter side: shifts up to four L are read, half the side, where enough pairs of texels are left."""

LAG_REACH = 4.0
"""Deviations of the lag window that are kept: exp(-8) is beyond any spectrum's own errors."""

LEAST_SIDE = 32
"""Texels: below this a lag window spans only a few, and a spectrum says nothing."""

LEAST_TEXELS = 512
"""Texels that have to be in the mask."""


@dataclass(frozen=True)
class Spectrum:
    """power: (n, n / 2 + 1) variance a bin, all frequencies of the half plane fx >= 0, none negative; their sum, with the
    columns of 0 < fx < 1/2 counted twice, is ``variance``. fx, fy: cycles per texel, y up. blur: deviation of the blur."""

    power: NDArray[np.float64]
    fx: NDArray[np.float64]
    fy: NDArray[np.float64]
    blur: float
    variance: float


def checked(channel: NDArray[np.float64], mask: NDArray[np.bool_] | None) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return (channel less its mean and zero outside of the mask, mask), (H, W) both.

    Raises InputError for a picture that is no (H, W) array of finite numbers, is too small, or does not vary.
    """
    z = np.asarray(channel, np.float64)
    if z.ndim != 2 or min(z.shape) < LEAST_SIDE:
        raise InputError(f"a texture's channel has the shape {z.shape}, and needs two sides of at least {LEAST_SIDE} texels")
    m = np.ones(z.shape, bool) if mask is None else np.asarray(mask, bool)
    if m.shape != z.shape:
        raise InputError(f"the mask has the shape {m.shape} and the channel {z.shape}; they have to be the same")
    if m.sum() < LEAST_TEXELS:
        raise InputError(f"the mask keeps {m.sum()} texels of the texture, and at least {LEAST_TEXELS} are needed")
    if not np.isfinite(z[m]).all():
        raise InputError("the texture's channel has numbers that are not finite")
    z = np.where(m, z - z[m].mean(), 0.0)
    if not z.any():
        raise InputError("the texture's channel is the same everywhere: it has no spectrum")
    return z, m


def power_spectrum(channel: NDArray[np.float64], mask: NDArray[np.bool_] | None = None) -> Spectrum:
    """Return the `Spectrum` of ``channel`` (H, W), row 0 on top, of which the texels of ``mask`` (H, W) count.

    Raises InputError as `checked` does.
    """
    z, m = checked(channel, mask)
    lag = LAG_SHARE * min(z.shape)
    reach = int(min(LAG_REACH * lag, min(z.shape) - 1))
    size = [fft.next_fast_len(side + reach, real=True) for side in z.shape]
    pairs = fft.irfft2(np.abs(fft.rfft2(m.astype(np.float64), size)) ** 2, size)
    products = fft.irfft2(np.abs(fft.rfft2(z, size)) ** 2, size)
    n = 2 * reach
    shifts = np.fft.fftfreq(n, 1 / n).round().astype(int)
    window = np.exp(-0.5 * (shifts / lag) ** 2)
    # Shifts that hardly any pair of texels has (holes) tell nothing: they count as none.
    here = np.ix_(shifts, shifts)
    common = np.maximum(pairs[here], 0.5)
    covariance = np.where(common > 1e-3 * m.sum(), products[here] / common, 0.0) * np.outer(window, window)
    power = np.maximum(fft.rfft2(covariance).real, 0.0)
    power = power[np.r_[np.argsort(np.fft.fftfreq(n))]]
    # Row 0 is on top, so the rows' frequencies change their sign for y up.
    fy = -np.sort(np.fft.fftfreq(n))
    fx = np.arange(n // 2 + 1) / n
    twice = np.where((fx > 0) & (fx < 0.5), 2.0, 1.0)
    variance = float((z**2).sum() / m.sum())
    power *= variance / (power * twice).sum()
    return Spectrum(power, fx, fy, 1 / (2 * math.pi * lag), variance)
