"""Whether a channel's power spectrum is the same in all directions, octave by octave: a test with a size of effect.

Symbols
    P(f)     the periodogram of the channel times a window (a Tukey taper along the photo's edges, zero in the mask's holes)
    rho      the radius of f: round, sqrt(fx^2 + fy^2), or square, max(|fx|, |fy|)
    m(rho)   the mean of P over all directions at that radius
    r_bs     the mean of P / m over octave b and sector s of directions, 1 for an isotropic field
    n_bs     independent bins in it: those of the half plane, times (sum w^2)^2 / (n sum w^4) for the window w
    A_b      sqrt(mean_s (r_bs - 1)^2 - its mean under isotropy), the anisotropy of a band: 0 none, 1 the sectors' power
             strays from the mean by as much as the mean
    A        sqrt(sum_b p_b A_b^2), p_b the bands' shares of the power, less where a band has few bins (RELIABLE_BINS)

The periodogram of an isotropic Gaussian field has r_bs near Gamma(n_bs) / n_bs whatever its radial spectrum, so the law of the
statistic A^2 under isotropy is drawn from Gamma numbers. A large photo would see the least tilt of the camera, which makes
no isotropic noise look wrong: A also has to pass EFFECT. Wavelet bands are square in frequency and photos' pixels too, and
neither is a direction that an eye sees: A is the smaller of the two kinds of radius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from voldetail.texture.spectrum import checked

SECTORS = 12
"""Sectors of 15 degrees over the half circle."""

TAPER = 0.5
"""Share of each side under the Tukey taper: a steep spectrum's edges leak below it, and half of the photo keeps its weight."""

LEAST_CYCLES = 3.0
"""Cycles across the shorter side below which directions are not compared: a sector has no whole bin there."""

LEVEL = 0.05
"""Probability that an isotropic field passes the statistical part of the test."""

EFFECT = 0.25
"""A below which a spectrum counts as isotropic in any case; tuned on photos: gravel has 0.10 and grass 0.23, layered rock 0.38
and 0.48, bark and ripples 1 and more. A field of power f^-2 has it when it is stretched by 1.5 (0.10 at 1.3, 0.46 at 2)."""

RELIABLE_BINS = 24
"""Independent bins at which a band counts with half of its share: the coarsest octave has most of a steep spectrum's power and
hardly a bin a sector, and its chance would drown what the others tell."""

DRAWS = 2000
RING_BINS = 1.5
"""Width of the rings in which m is found, in bins of the shorter side."""


@dataclass(frozen=True)
class Isotropy:
    """What the test found: ``statistic`` A, isotropic where it is at most ``threshold``.

    bands: (longest wavelength of the octave in texels, share of the power, A_b), the finest octave first. sentence: for people.
    """

    statistic: float
    threshold: float
    bands: tuple[tuple[float, float, float], ...]
    sentence: str

    @property
    def isotropic(self) -> bool:
        """Whether an isotropic noise can stand for the texture."""
        return self.statistic <= self.threshold


def isotropy_of(channel: NDArray[np.float64], mask: NDArray[np.bool_] | None = None) -> Isotropy:
    """Return the `Isotropy` of ``channel`` (H, W), of which the texels of ``mask`` (H, W) count.

    Raises InputError for a channel that is too small, not finite or constant.
    """
    z, m = checked(channel, mask)
    w = np.outer(*(_tukey(side) for side in z.shape)) * m
    # The mean under the window, else the window's own spectrum would show.
    power = np.abs(fft.rfft2((z - (z * w).sum() / w.sum()) * w)) ** 2
    efficiency = float((w**2).sum() ** 2 / (w.size * (w**4).sum()))
    fy, fx = np.meshgrid(np.fft.fftfreq(z.shape[0]), np.fft.rfftfreq(z.shape[1]), indexing="ij")
    angle = np.arctan2(fy, fx) % np.pi
    sector = np.minimum((angle * (SECTORS / np.pi) + 0.5).astype(int) % SECTORS, SECTORS - 1)
    # On the first column a frequency and its negative both stand there: one of the two counts.
    once = (fx > 0) | (fy > 0)
    found = [
        _measured(power[once], radius[once], sector[once], efficiency, min(z.shape))
        for radius in (np.hypot(fx, fy), np.maximum(np.abs(fx), np.abs(fy)))
    ]
    statistic, chance, bands = min(found, key=lambda v: v[0])
    threshold = max(EFFECT, chance)
    return Isotropy(statistic, threshold, bands, _sentence(statistic, threshold, bands))


def _measured(
    power: NDArray[np.float64], radius: NDArray[np.float64], sector: NDArray[np.intp], efficiency: float, side: int
) -> tuple[float, float, tuple[tuple[float, float, float], ...]]:
    """Return (A, what A an isotropic field passes with probability LEVEL, the bands)."""
    kept = (radius >= LEAST_CYCLES / side) & (radius <= 0.5)
    power, radius, sector = power[kept], radius[kept], sector[kept]
    ring = (radius * (side / RING_BINS)).astype(int)
    level = np.bincount(ring, power) / np.maximum(np.bincount(ring), 1)
    ratio = power / np.maximum(level[ring], np.finfo(float).tiny)
    octave = np.floor(-np.log2(np.minimum(radius, 0.4999))).astype(int)
    rng = np.random.default_rng(0)
    squares, shares, bins, waves, law = [], [], [], [], []
    for band in range(1, octave.max() + 1):
        here = octave == band
        count = np.bincount(sector[here], minlength=SECTORS)
        if count.min() < 1:
            continue
        mean = np.bincount(sector[here], ratio[here], minlength=SECTORS) / count
        shape = np.maximum(count * efficiency, 0.5)
        drawn = rng.gamma(shape, 1 / shape, (DRAWS, SECTORS))
        drawn = ((drawn / drawn.mean(1, keepdims=True) - 1) ** 2).mean(1)
        squares.append(float(((mean - 1) ** 2).mean() - drawn.mean()))
        law.append(drawn - drawn.mean())
        shares.append(float(power[here].sum()))
        bins.append(float(count.sum() * efficiency))
        waves.append(2.0 ** (band + 1))
    share = np.array(shares) / max(sum(shares), np.finfo(float).tiny)
    weight = share * np.array(bins) / (np.array(bins) + RELIABLE_BINS)
    weight /= max(weight.sum(), np.finfo(float).tiny)
    chance = float(np.quantile(weight @ np.array(law), 1 - LEVEL))
    bands = tuple((w, float(p), float(np.sqrt(max(s, 0.0)))) for w, p, s in zip(waves, share, squares, strict=True))
    return float(np.sqrt(max(weight @ np.array(squares), 0.0))), float(np.sqrt(max(chance, 0.0))), bands


def _tukey(side: int) -> NDArray[np.float64]:
    """Return the Tukey (tapered cosine) window at the centres of ``side`` texels."""
    edge = np.minimum((np.arange(side) + 0.5) / side, (side - np.arange(side) - 0.5) / side)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.minimum(edge / (TAPER / 2), 1.0)))


def _sentence(statistic: float, threshold: float, bands: tuple[tuple[float, float, float], ...]) -> str:
    worst = max(bands, key=lambda v: v[1] * v[2] ** 2)
    if statistic <= threshold:
        return f"the spectrum is the same in all directions (anisotropy {statistic:.2f}, at most {threshold:.2f})"
    return (
        f"the spectrum has a direction (anisotropy {statistic:.2f}, more than {threshold:.2f}),"
        f" most of it at wavelengths of {worst[0] / 2:.0f} to {worst[0]:.0f} texels"
    )
