"""How far a texture is from being the same everywhere (MJHRW17 section 3, eq. 1 to 4).

Symbols: f, one channel of the picture in CIE L*a*b*; S(f)(x), its features around the point x; w_d, the Gaussian
window of standard deviation sigma; s, the mean difference of the features of two points.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from voldetail.errors import InputError
from voldetail.stationary.colour import to_lab, usable
from voldetail.stationary.local import Neighbourhoods, neighbourhoods
from voldetail.stationary.steerable import REACH, bands, bands_of_photo
from voldetail.types import Array, Mask

Measure = Literal["mean", "moments2", "moments3", "moments4", "histogram", "steerable"]

MEASURES: tuple[Measure, ...] = get_args(Measure)
ORDERS: dict[str, int] = {"mean": 1, "moments2": 2, "moments3": 3, "moments4": 4}
"""The highest order p of the moments in each measure that has moments."""

BINS = 32
"""n of eq. 3, between a channel's lowest and highest value."""

POINTS_PER_SIGMA = 4
"""Points x along each axis within a sigma: a window changes little from one to the next."""

DEFAULT_SIGMA = 1 / 12
"""Of the picture's shorter side: the standard deviation of a window if none is given. The paper gives none; chosen on
three photographs of the test data: at 1/8 patches of another colour are still seen to repeat, at 1/16 shapes begin to suffer."""

LEAST_SIGMA = 1.0


@dataclass(frozen=True, eq=False)
class Stationarity:
    """A texture's deviation from stationarity: `value` is s of eq. 1 (0: the same everywhere) and `map` (H, W) its inner
    integral at each pixel (their mean is `value`, but for interpolation), NaN outside the mask; `sigma` in pixels;
    `sentence`, what was left out, or "". The unit is that of CIE L*a*b* for histograms, its square for moments."""

    value: float
    map: Array
    measure: Measure
    sigma: float
    sentence: str = ""


def stationarity(
    photo: NDArray[Any],
    mask: NDArray[Any] | None = None,
    *,
    measure: Measure = "histogram",
    sigma: float | None = None,
    toroidal: bool = False,
) -> Stationarity:
    """Measure how much a picture's features differ from place to place, s(f) = mean of S(f)(x1) - S(f)(x2) over all
    pairs of places, the sum over the channels of CIE L*a*b* (MJHRW17 eq. 1).

    `photo` is (H, W, 3) linear, `mask` (H, W), True = use, holes allowed; NaN and infinite pixels are left out.
    `measure` names S: "mean" and "moments2" to "moments4", local moments up to that order (eq. 2), compared by squared
    difference; "histogram", local histograms (eq. 3), and "steerable", local histograms of the responses of steerable
    filters (eq. 4), both compared by earth mover's distance. `sigma` is the window's standard deviation in pixels,
    default a twelfth of the shorter side. `toroidal`: opposite edges meet, as in a tile. Raises InputError for a photo
    or mask that cannot be used, an unknown measure, and a sigma below one pixel or above the longer side.
    """
    check_measure(measure)
    pixels, use, left_out = usable(photo, mask)
    sigma = checked_sigma(sigma, use.shape)
    near = neighbourhoods(use.shape, sigma, max(sigma / POINTS_PER_SIGMA, 1), toroidal)
    planes, use = _planes(to_lab(pixels), use, measure, toroidal)
    weight = use.astype(np.float32)
    share = _share_of(use, near)
    field = np.zeros(near.grid)
    for plane in planes:
        if measure in ORDERS:
            field += _moments(plane, weight, near, share, ORDERS[measure])
        else:
            field += _histograms(plane, weight, near, share)
    value = float((field * share).sum())
    pixel_map = np.where(use, near.between(_reaching(field, share)), np.nan).astype(np.float32)
    sentence = f"{left_out} pixels that are NaN or infinite were left out." if left_out else ""
    return Stationarity(value, pixel_map, measure, sigma, sentence)


def check_measure(measure: str) -> None:
    """Raise InputError unless `measure` is one of MEASURES."""
    if measure not in MEASURES:
        raise InputError(f"The measure {measure!r} is not known; use one of {', '.join(MEASURES)}.")


def checked_sigma(sigma: float | None, shape: tuple[int, int]) -> float:
    """`sigma` in pixels, or the default for a picture of `shape`; raises InputError where it is out of range."""
    if sigma is None:
        return max(min(shape) * DEFAULT_SIGMA, LEAST_SIGMA)
    if not LEAST_SIGMA <= sigma <= max(shape):  # also refuses NaN
        raise InputError(
            f"sigma {sigma:g} is out of range; it has to be {LEAST_SIGMA:g} to {max(shape)} pixels, the picture's longer side."
        )
    return float(sigma)


def _planes(lab: Array, use: Mask, measure: Measure, toroidal: bool) -> tuple[Iterator[Array], Mask]:
    """The pictures whose local statistics are compared, and where they can be trusted."""
    channels = (np.ascontiguousarray(lab[..., c]) for c in range(3))
    if measure != "steerable":
        return channels, use
    respond = bands if toroidal else bands_of_photo
    if not use.all():  # a response beside a hole is the hole's
        inner = ndimage.binary_erosion(use, iterations=REACH // 4, border_value=1)
        use = inner if inner.any() else use
    return (band for channel in channels for band in respond(channel)), use


def _moments(plane: Array, weight: Array, near: Neighbourhoods, share: NDArray[np.float64], highest: int) -> NDArray[np.float64]:
    """Eq. 1 with eq. 2 at every point (R, C): squared differences of local moments of orders 1 to `highest`.

    A moment of order p is taken about the picture's mean and divided by its standard deviation to the power p - 1:
    all orders then have the unit of the channel, as the mean has, and none drowns the others.
    """
    used = plane[weight > 0].astype(np.float64)
    mean, spread = used.mean(), used.std()
    out = np.zeros(near.grid)
    if spread <= 1e-6 * (1 + abs(mean)):  # a constant, but for rounding
        return out
    scaled = ((plane - mean) / spread).astype(np.float32)
    for order in range(1, highest + 1):
        local = spread * near.mean(scaled**order, weight).astype(np.float64)
        centre = (local * share).sum()
        out += (local - centre) ** 2 + ((local - centre) ** 2 * share).sum()
    return out


def _histograms(plane: Array, weight: Array, near: Neighbourhoods, share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Eq. 1 with eq. 3 at every point (R, C): earth mover's distances of local histograms.

    In one dimension it is the area between two cumulative histograms, so each bin's border adds the mean difference
    of their heights there.
    """
    used = plane[weight > 0]
    low, high = float(used.min()), float(used.max())
    out = np.zeros(near.grid)
    if high - low <= 1e-5 * (1 + abs(low)):
        return out
    width = (high - low) / BINS
    for border in low + width * (np.arange(BINS) + 0.5):
        below = np.clip((border - plane) / width + 0.5, 0, 1)  # Parzen window: a box of a bin's width
        out += width * mean_difference(near.mean(below, weight).astype(np.float64), share)
    return out


def mean_difference(values: NDArray[np.float64], share: NDArray[np.float64]) -> NDArray[np.float64]:
    """sum_j share_j |v_i - v_j| for every i, over all pairs, by sorting; `share` adds up to one; the shape of `values`."""
    flat, portion = values.ravel(), share.ravel()
    order = np.argsort(flat, kind="stable")
    v, p = flat[order], portion[order]
    below, sum_below = np.cumsum(p), np.cumsum(p * v)
    out = np.empty_like(flat)
    out[order] = v * (2 * below - below[-1]) - (2 * sum_below - sum_below[-1])
    return out.reshape(values.shape)


def _share_of(use: Mask, near: Neighbourhoods) -> NDArray[np.float64]:
    """How much of the used area belongs to each point (R, C): it adds up to one."""
    rows, columns = near.grid
    r = np.arange(use.shape[0]) * rows // use.shape[0]
    c = np.arange(use.shape[1]) * columns // use.shape[1]
    counts = np.zeros(near.grid)
    np.add.at(counts, (r[:, None], c[None, :]), use)
    return counts / counts.sum()


def _reaching(field: NDArray[np.float64], share: NDArray[np.float64]) -> Array:
    """The field with points outside the mask taking the value of the nearest inside, for interpolation."""
    if share.all():
        return field.astype(np.float32)
    place = ndimage.distance_transform_edt(share == 0, return_distances=False, return_indices=True)
    return np.asarray(field[tuple(place)], np.float32)
