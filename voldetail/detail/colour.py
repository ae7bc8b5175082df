"""The frozen record of a colour texture by example: all that its evaluation needs, about seventy numbers.

    colour(x) = sum_c axes_c H_c(Phi(M_c(x) / deviation of M_c)),      M_c(x) = sum_i w_i N_i(x)

LVLD10 (Lagae et al. 2009, 2010) sections 4 to 7: M_c a noise of one decorrelated channel, H_c that channel's inverse
cumulative histogram, Phi the normal law's cumulative distribution, axes_c the channel's direction in colour space.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from voldetail.detail.provenance import Record

COLOUR_VERSION: Literal[1] = 1
CURVE_SAMPLES = 10
"""LVLD10, 2010 article, section 5.2: "a small number of samples, typically 10"."""

MOST_BANDS = 14
"""Octaves of wavelengths from 2 texels: the coarsest is 2^14 texels long, the longest side of a photo."""

MOST_LOBES = 64
ORTHONORMAL_TOLERANCE = 1e-4

Finite = Annotated[float, Field(allow_inf_nan=False)]
Weight = Annotated[float, Field(ge=0, le=1e4, allow_inf_nan=False)]


class Lobe(Record):
    """One Gaussian pair in the power spectrum of an anisotropic noise: a Gabor kernel's, at plus and minus its frequency.

    Its ellipse lies along and across its frequency: fibres and ripples have spectra thin one way, which a few ellipses
    follow and circles do not.
    """

    frequency: float = Field(ge=0, le=0.75, description="The radial frequency of its centre, in cycles per texel.")
    angle: float = Field(
        ge=0, le=3.141593, description="The direction of the frequency, counter-clockwise from x (y up), in radians."
    )
    bandwidth: float = Field(gt=0, le=0.5, description="The Gaussian's standard deviation along its frequency, cycles per texel.")
    across: float | None = Field(
        default=None, gt=0, le=0.5, description="The same at right angles to its frequency; left out where both are equal."
    )
    variance: float = Field(ge=0, le=1e8, description="The variance that the lobe adds to the noise.")


class ColourChannel(Record):
    """One decorrelated channel: a noise of unit or any deviation, and the curve that gives it the photo's histogram.

    weights: w_i of the wavelet bands, the finest (wavelengths of 2 to 4 texels) first, 1 to 14 of them.
    lobes: in place of the bands where the texture is anisotropic; then weights is empty.
    curve: values of the channel at ten probabilities (`texture.curve.CURVE_PROBABILITIES`: equal steps of the normal law's
        quantile from -3.2 to 3.2), not decreasing.
    """

    weights: tuple[Weight, ...] = Field(max_length=MOST_BANDS, description="Weights of the wavelet bands, finest first.")
    lobes: tuple[Lobe, ...] = Field(default=(), max_length=MOST_LOBES, description="Gabor lobes in place of the bands.")
    curve: tuple[Finite, ...] = Field(
        min_length=CURVE_SAMPLES, max_length=CURVE_SAMPLES, description="Samples of the inverse cumulative histogram."
    )

    @model_validator(mode="after")
    def _usable(self) -> ColourChannel:
        if bool(self.weights) == bool(self.lobes):
            raise ValueError("a channel needs either the weights of bands or lobes, and not both")
        if any(b < a for a, b in zip(self.curve, self.curve[1:], strict=False)):
            raise ValueError("the curve decreases; each of its numbers has to be at least the one before")
        return self


class ColourTexture(Record):
    """A procedural colour texture: three decorrelated channels (one for grey) and where they came from."""

    version: Literal[1] = Field(default=COLOUR_VERSION, description="The version of the record.")
    name: str = Field(default="texture", min_length=1, max_length=200, description="A name for people.")
    seed: int = Field(default=0, ge=0, le=2**32 - 1, description="The seed of the noise.")
    encoding: Literal["linear", "srgb"] = Field(
        default="srgb", description="The encoding of the colours that the channels add up to."
    )
    axes: tuple[Finite, ...] = Field(
        default=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        min_length=9,
        max_length=9,
        description="The direction of each channel in colour space, three numbers a channel: a rotation.",
    )
    channels: tuple[ColourChannel, ColourChannel, ColourChannel] = Field(description="The channels, the most varied first.")
    texels: tuple[int, int] = Field(description="Columns and rows of the photo that was analysed.")
    photo: str = Field(default="", max_length=400, description="The file name of the photo, without its folder.")

    @model_validator(mode="after")
    def _rotation(self) -> ColourTexture:
        rows = [self.axes[i : i + 3] for i in (0, 3, 6)]
        for i, a in enumerate(rows):
            for j, b in enumerate(rows):
                product = sum(p * q for p, q in zip(a, b, strict=True))
                if abs(product - (i == j)) > ORTHONORMAL_TOLERANCE:
                    raise ValueError("the axes are no rotation: each needs length 1, at right angles to the others")
        return self
