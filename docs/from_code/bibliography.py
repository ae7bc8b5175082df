"""The works that the code cites, and what each equation or section of the four papers is, in a few words."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Paper:
    """One of the four papers: its authors, a title by which it is cited besides its short name, and its places in words."""

    authors: str
    title: str
    places: MappingProxyType[str, str]


@dataclass(frozen=True)
class Work:
    """Another work: the first author's surname as the code has it, the year, the authors in full, and what it is used for."""

    surname: str
    year: int
    authors: str
    what: str


PAPERS: dict[str, Paper] = {
    "GD10": Paper("G. Gilet, J.-M. Dischler, 2010", "An Image-Based Approach for Stochastic Volumetric", MappingProxyType({
        "eq. 1": "a relief function as a weighted sum of noises of different scales",
        "section 4": "the noise's symbols: points, kernel, envelope, the curve H",
        "eq. 2": "one octave: kernels with stripes, summed over the k-th to k'-th closest points",
        "eq. 3": "the relief function R: octaves of eq. 2, turned and scaled, through the curve H",
        "section 5": "the published metric: 17 frequencies, 3 levels, histograms of 32 bins",
        "eq. 4": "windowed Fourier responses of a picture",
        "section 6": "displacement, hypertexture, the transfer function, ambient, diffuse and specular light",
        "section 7": "the fit: reflectance at each evaluation, elongation from the spectrum, coarse samples, gradient descent",
        "figure 4": "the starting curves H",
        "figure 5": "what k, k', stripes and H do",
    })),
    "LVLD10": Paper("A. Lagae, P. Vangorp, T. Lenaerts, P. Dutré, 2009 and 2010", "Isotropic Stochastic Procedural Textures by",
                    MappingProxyType({
        "eq. 1": "multiresolution noise: a weighted sum of bands",
        "eq. 2": "a band: the noise scaled by a power of two",
        "section 4": "weights of the bands from the power spectrum (report)",
        "section 5": "matching the distribution of intensities (report)",
        "section 6": "channels without correlation (report)",
        "section 7": "analysis and synthesis as a whole (report)",
        "section 8": "results, among them morphs (report)",
        "section 5.1": "several channels (article)",
        "section 5.2": "the inverse histogram in few samples (article)",
        "section 5.3": "synthesis by analysis (article)",
        "eq. 12": "the weight of a band from the spectrum's energy (article)",
        "eq. 13": "the band that a frequency is in (article)",
        "eq. 14": "the deviation of the noise (article)",
    })),
    "GKHF14": Paper("L. Gieseke, S. Koch, J.-U. Hahn, M. Fuchs, 2014", "Interactive Parameter Retrieval for Two-Tone",
                    MappingProxyType({
        "section 3": "a photo as a blend of two tones",
        "eq. 2": "the colour between two tones",
        "eq. 3": "the structure function",
        "eq. 4": "its parameters and their ranges",
        "section 4": "the descriptor: 374 Gabor responses, their means and deviations",
        "eq. 5": "one response over the area that its filter does not leave",
        "eq. 6": "the distance of two descriptors",
        "section 5": "retrieval: all turns, both orders of tones",
        "section 6": "the models: noises, grids, tiles, wood, shapes",
    })),
    "MJHRW17": Paper("J. Moritz, S. James, T. Haines, T. Ritschel, T. Weyrich, 2017", "Texture Stationarization",
                     MappingProxyType({
        "section 3": "colours in which evenness is measured, and the measures",
        "eq. 1": "evenness: differences of local statistics over all pairs of places",
        "eq. 2": "local moments",
        "eq. 3": "local histograms",
        "section 3.3": "orientations and magnitudes of the steerable filters",
        "eq. 4": "local histograms of steerable filters' responses",
        "section 4.1": "costs and the sizes of tile and patch",
        "eq. 5": "texture cost: the nearest patch of the photo",
        "section 4.2": "PatchMatch over a pyramid, toroidal",
        "eq. 6": "all of the photo used alike",
        "algorithm 1": "the whole of it",
        "section 4.3": "projection onto even pictures",
        "section 4.4": "a palette of window sizes",
        "figure 10": "evenness that changes across a tile",
    })),
}  # fmt: skip

OTHERS: tuple[Work, ...] = (
    Work("Barnes", 2009, "C. Barnes et al.", "PatchMatch"),
    Work("Blackman", 1958, "R. Blackman, J. Tukey", "power spectra of pictures with edges and holes"),
    Work("Burley", 2012, "B. Burley", "the physically based stand-in's reflectance"),
    Work("Burt", 1983, "P. Burt, E. Adelson", "pyramids"),
    Work("Chantler", 1995, "M. Chantler", "the light's direction in textures"),
    Work("Cook", 2005, "R. Cook, T. DeRose", "wavelet noise"),
    Work("Dempster", 1977, "A. Dempster, N. Laird, D. Rubin", "mixtures fitted to a spectrum"),
    Work("Dowson", 1982, "D. Dowson, B. Landau", "the distance of two Gaussians"),
    Work("Eberly", 2013, "D. Eberly", "the distance to an ellipsoid"),
    Work("Fritsch", 1980, "F. Fritsch, R. Carlson", "monotone cubic curves"),
    Work("Galerne", 2012, "B. Galerne et al.", "Gabor noise by example"),
    Work("Hart", 1999, "J. Hart et al.", "the mean of a curve's values in a pixel"),
    Work("Heeger", 1995, "D. Heeger, J. Bergen", "a steerable pyramid, inverted"),
    Work("Heitz", 2018, "E. Heitz, F. Neyret", "blending that keeps the histogram"),
    Work("Henyey", 1941, "L. Henyey, J. Greenstein", "scattering forwards and backwards"),
    Work("Hestenes", 1952, "M. Hestenes, E. Stiefel", "conjugate gradients"),
    Work("Johnson", 1970, "N. Johnson, S. Kotz", "distributions of given moments"),
    Work("Kay", 1986, "T. Kay, J. Kajiya", "rays through a box"),
    Work("Kniss", 2003, "J. Kniss et al.", "volume rendering"),
    Work("Koenderink", 2003, "J. Koenderink, S. Pont", "the light's azimuth from gradients"),
    Work("Lafortune", 1994, "E. Lafortune, Y. Willems", "Phong reflection that keeps energy"),
    Work("Lewiner", 2003, "T. Lewiner et al.", "marching cubes"),
    Work("Lewis", 1993, "R. Lewis", "Phong reflection that keeps energy"),
    Work("Mannos", 1974, "J. Mannos, D. Sakrison", "how well the eye sees contrast"),
    Work("Matheron", 1975, "G. Matheron", "granulometry"),
    Work("Matusik", 2005, "W. Matusik et al.", "histograms between two"),
    Work("Norton", 1982, "A. Norton et al.", "frequency clamping"),
    Work("Ojala", 2002, "T. Ojala, M. Pietikäinen, T. Mäenpää", "local binary patterns"),
    Work("Perlin", 1985, "K. Perlin", "gradient noise and turbulence"),
    Work("Perlin", 1989, "K. Perlin, E. Hoffert", "hypertexture"),
    Work("Portilla", 2000, "J. Portilla, E. Simoncelli", "correlations of magnitudes"),
    Work("Ramamoorthi", 2001, "R. Ramamoorthi, P. Hanrahan", "a sky's light on a surface"),
    Work("Serra", 1982, "J. Serra", "openings and closings"),
    Work("Simoncelli", 1995, "E. Simoncelli, W. Freeman", "steerable pyramids"),
    Work("Sobolev", 1963, "V. Sobolev", "light that escapes"),
    Work("Stam", 1995, "J. Stam", "multiple scattering as diffusion"),
    Work("Thuermer", 1998, "G. Thürmer, C. Wüthrich", "normals at vertices"),
    Work("Hulst", 1980, "H. van de Hulst", "the albedo of a deep medium"),
    Work("Walter", 2007, "B. Walter et al.", "rough reflection"),
    Work("Worley", 1996, "S. Worley", "cells of nearest points"),
    Work("Wrenninge", 2013, "M. Wrenninge, C. Kulla, V. Lundqvist", "octaves of scattering"),
    Work("Wyman", 1989, "D. Wyman, M. Patterson, B. Wilson", "similarity of scattering media"),
)
