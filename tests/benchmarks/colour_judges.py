"""Two judges of colour textures: distances of other pictures from a photo, in units of the photo's own other crops.

    metric      the package's metric on each decorrelated channel
    statistics  those of Portilla & Simoncelli 2000 on each of them, and how the channels' bands go together

Both read a picture as the principal components of the photo's sRGB-encoded colours. Run as a program, it says how well each
knows other crops of six photographs from other photographs and from altered crops:

    python -m tests.benchmarks.colour_judges -o results/colour

A third, sliced Wasserstein distances of 7 x 7 patches in colour at four scales, was tried too: it knows all photographs apart
but told only three in four altered crops from true ones, as projections at random hardly see what is no Gaussian.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from tests.benchmarks.colour_list import PHOTOS, crops, is_there, load
from tests.benchmarks.rivals import portilla
from tests.benchmarks.rivals.heeger_bergen import decorrelated
from tests.benchmarks.rivals.steerable import pyramid
from tests.benchmarks.texture_pictures import random_phase
from voldetail.files import write_text
from voldetail.image import to_linear, to_srgb
from voldetail.metric import Descriptor, describe, distance
from voldetail.metric.layers import Layers, layers
from voldetail.metric.quantiles import Array, Parts

Picture = NDArray[np.float32]

FAINT_CHANNEL = 0.03
"""A channel that deviates less than this share of the first is left out: it would be judged by its grain."""

ASKED = ("rock_plants", "stone_slab", "sand", "mossy_stone", "sea_foam", "bark")
SIDE = 192


class Components:
    """A photo's decorrelated channels, as grey pictures in linear light whose encoded mean is a half for the photo."""

    def __init__(self, photo: Picture) -> None:
        self._mean, self._axes = decorrelated(to_srgb(photo))
        deviations = ((to_srgb(photo) - self._mean) @ self._axes).std(axis=(0, 1))
        self.kept = [c for c in range(3) if deviations[c] >= FAINT_CHANNEL * deviations[0]]
        self.weights = [float(deviations[c]) / float(deviations[self.kept].sum()) for c in self.kept]

    def of(self, picture: Picture) -> list[Picture]:
        """Return the channels of any picture (H, W, 3)."""
        # Decoded, as whoever describes a grey picture encodes it first.
        components = to_linear((to_srgb(picture) - self._mean) @ self._axes + 0.5)
        return [components[..., c] for c in self.kept]


class Judge(Protocol):
    """Distances of other pictures (H, W, 3), linear, from one photo's."""

    def distance(self, other: Picture) -> float: ...


class Metric:
    """d(other) = sum_c s_c d(photo_c, other_c) / sum_c s_c: the package's metric, s_c the deviation of channel c."""

    def __init__(self, photo: Picture) -> None:
        self._components = Components(photo)
        self._seen: list[Descriptor] = [describe(plane) for plane in self._components.of(photo)]

    def distance(self, other: Picture) -> float:
        found = [
            distance(seen, describe(plane, like=seen)) for seen, plane in zip(self._seen, self._components.of(other), strict=True)
        ]
        return float(np.dot(found, self._components.weights))


class Statistics:
    """Portilla & Simoncelli's: the sum of the parts' differences, weighted by channel, and that of the correlations.

    Its pyramid is of the kind that Heeger & Bergen's synthesis imposes the marginals of, which may favour that one.
    """

    def __init__(self, photo: Picture) -> None:
        self._components = Components(photo)
        seen = [layers(plane) for plane in self._components.of(photo)]
        self._bases: list[Parts] = [portilla.basis(channel) for channel in seen]
        self._channels, self._across = self._measured(seen)

    def distance(self, other: Picture) -> float:
        channels, across = self._measured([layers(plane) for plane in self._components.of(other)])
        apart = [
            sum(portilla.compare(a[name], b[name], basis.get(name)) for name in a)
            for a, b, basis in zip(self._channels, channels, self._bases, strict=True)
        ]
        crossed = float(np.sqrt(np.mean((self._across - across) ** 2))) if across.size else 0.0
        return float(np.dot(apart, self._components.weights)) + crossed

    def _measured(self, channels: list[Layers]) -> tuple[list[Parts], Array]:
        parts = [portilla.measure(channel, basis) for channel, basis in zip(channels, self._bases, strict=True)]
        return parts, across_channels([channel.images[0] for channel in channels])


def across_channels(planes: Sequence[Array]) -> Array:
    """Return the correlations between channels of each band's real parts and of its magnitudes."""
    pyramids = [pyramid(plane - plane.mean())[1] for plane in planes]
    found = [
        np.corrcoef(part(a).ravel(), part(b).ravel())[0, 1]
        for i in range(len(planes)) for j in range(i)
        for level_a, level_b in zip(pyramids[i], pyramids[j], strict=True)
        for a, b in zip(level_a, level_b, strict=True)
        for part in (np.real, np.abs)
    ]  # fmt: skip
    return np.asarray(found, np.float32)


JUDGES: Mapping[str, Callable[[Picture], Judge]] = {"metric": Metric, "statistics": Statistics}


def altered(crop: Picture, seed: int = 5) -> dict[str, Picture]:
    """Return what a person would not take for the same photo's."""
    encoded = to_srgb(crop).astype(np.float64)
    mean, axes = decorrelated(encoded)
    unpaired = (encoded - mean) @ axes
    unpaired[..., 1], unpaired[..., 2] = unpaired[::-1, ::-1, 1], unpaired[:, ::-1, 2]
    # The same random phases for the three colours, which then go together as in the photo.
    phases = [random_phase(encoded[..., c], np.random.default_rng(seed)) for c in range(3)]
    found = {
        "random phases": np.stack(phases, axis=2),
        "blurred": ndimage.gaussian_filter(encoded, (1.2, 1.2, 0)),
        "grain": encoded + np.random.default_rng(seed).normal(0, 0.03, encoded.shape),
        "channels turned apart": unpaired @ axes.T + mean,
    }
    return {name: to_linear(np.clip(shown, 0, 1)) for name, shown in found.items()}


def trustworthy(judge: Callable[[Picture], Judge], photos: Mapping[str, Sequence[Picture]]) -> dict[str, float]:
    """Return the shares of questions answered rightly: first and last crop of each photo ask, four crops a photo.

    nearest: the nearest of all is a crop of the same photo. other photos, and each way of altering a crop: one is farther
    than another crop of the same photo.
    """
    answers: dict[str, list[float]] = {}
    for name, own in photos.items():
        for asking in (0, len(own) - 1):
            asked = judge(own[asking])
            same = [asked.distance(crop) for k, crop in enumerate(own) if k != asking]
            others = [asked.distance(crop) for other, many in photos.items() if other != name for crop in many[:2]]
            answers.setdefault("nearest", []).append(float(min(same) < min(others)))
            answers.setdefault("other photos", []).append(float(np.mean([[a < b for b in others] for a in same])))
            for way, picture in altered(own[1]).items():
                far = asked.distance(picture)
                answers.setdefault(way, []).append(float(np.mean([a < far for a in same])))
    return {question: round(float(np.mean(given)), 3) for question, given in answers.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/colour"))
    output = parser.parse_args().output
    found = [photo for photo in PHOTOS if photo.name in ASKED and is_there(photo)]
    photos = {photo.name: [crop[:SIDE, :SIDE] for crop in crops(load(photo), photo.side)] for photo in found}
    record = {"photos": list(photos)} | {name: trustworthy(judge, photos) for name, judge in JUDGES.items()}
    output.mkdir(parents=True, exist_ok=True)
    write_text(output / "judges.json", json.dumps(record, indent=1) + "\n")
    print(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
