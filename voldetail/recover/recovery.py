"""From one photo and its light to height, normals, albedo and gloss of every pixel."""

from __future__ import annotations

import importlib.metadata
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from voldetail import __version__
from voldetail.detail.photo_relief import MappedDetail, PhotoRelief
from voldetail.detail.provenance import Provenance
from voldetail.detail.record import ReliefParameters
from voldetail.detail.relief_maps import normals_of
from voldetail.errors import InputError
from voldetail.image import Photo, luminance, used_of
from voldetail.recover.evidence import Evidence, evidence
from voldetail.recover.files import unsaved_maps
from voldetail.recover.gates import Gated, gate
from voldetail.recover.integrate import integrate, without_plane
from voldetail.recover.light_map import light_map
from voldetail.recover.place import about_middle, box_of, cut, lamp_about
from voldetail.recover.reflectance import Surface, surface_of
from voldetail.recover.shading import SHININESS, Shading, shading_of
from voldetail.recover.slopes import Method, slopes_of
from voldetail.setup.camera import CameraSetup
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, lamp_of, light_text
from voldetail.setup.view import View, Zone, view_of

DEFAULT_SIZE, LEAST_SIZE, MOST_SIZE = 1024, 64, 8192
"""Pixels of the longest side of the maps."""

LEAST_READ = 0.02
"""Share of the photo that has to be readable."""

BURNT_SAID = 0.05
"""Share of burnt-out pixels from which it is said."""

PAINT_SAID = 0.25
"""Share of the pattern's variance that goes with colour from which it is said."""

FLATTEST = 1e-4
"""Pixels: height of what counts as flat."""


@dataclass(frozen=True, eq=False)
class Recovery:
    """The photo's own relief.

    detail: the maps as a detail that renders anywhere. height (H, W): scene units, 0 at the lowest point. normal (H, W, 3): unit,
    x right, y up. albedo (H, W, 3): linear. roughness (H, W). photo (H, W, 3): the photo at the maps' size, linear. mask (H, W).
    again (H, W, 3): the maps rendered under the photo's light. lamp: that light, about the maps' middle. confidence: 0 to 1.
    notes: what the user should know. seconds: how long it took.
    """

    detail: MappedDetail
    photo: NDArray[np.float32]
    mask: NDArray[np.bool_]
    again: NDArray[np.float32]
    lamp: Lamp
    seconds: float

    @property
    def height(self) -> NDArray[np.float32]:
        """Height in scene units."""
        return np.asarray(self.detail.height * np.float32(self.detail.relief.amplitude))

    @property
    def normal(self) -> NDArray[np.float32]:
        """Unit normals."""
        return normals_of(self.height, self.detail.record.texels_per_unit, periodic=self.detail.record.periodic)

    @property
    def albedo(self) -> NDArray[np.float32]:
        """Albedo."""
        return self.detail.albedo

    @property
    def roughness(self) -> NDArray[np.float32]:
        """Roughness alpha."""
        return self.detail.roughness

    @property
    def confidence(self) -> float:
        """How sure the relief is."""
        return self.detail.record.confidence

    @property
    def notes(self) -> tuple[str, ...]:
        """What was seen on the way."""
        return self.detail.record.notes


def recover(
    photo: Photo,
    light: Light,
    *,
    zone: Zone | None = None,
    size: int | None = DEFAULT_SIZE,
    method: Method = "network",
    name: str = "relief",
    seed: int = 0,
    on_step: Callable[[str], None] = lambda what: None,
) -> Recovery:
    """Return the relief of ``photo``, flat and seen head-on, under ``light``.

    zone: x, y, width, height in pixels; None for all that is used. size: the longest side of the maps in pixels, at most the
    zone's; None for the zone's own. Raises InputError for a zone or size that cannot be used, and for a photo that is burnt out.
    """
    started = time.monotonic()
    if size is not None and not LEAST_SIZE <= size <= MOST_SIZE:
        raise InputError(f"The size {size} is out of range; it has to be {LEAST_SIZE} to {MOST_SIZE} pixels.")
    rows, columns = photo.pixels.shape[:2]
    zone = zone or box_of(used_of(photo))
    lamp = lamp_of(light, luminance(photo.pixels))
    on_step("reading the photo")
    longest = min(max(zone[2:]), size or max(zone[2:]), MOST_SIZE)
    view = view_of(CameraSetup(), (rows, columns), zone, longest)
    pixels, used = cut(photo, zone, (view.rows, view.columns))
    seen, lights = gate(pixels, used), light_map(lamp, view)
    if seen.weight.mean() < LEAST_READ:
        burnt = f"{100 * seen.burnt:.0f} % of what is used is burnt out"
        raise InputError(f"Too little of the photo can be read ({burnt}): expose it less, or choose another --zone or --mask.")
    on_step("height")
    found = evidence(seen.detail, seen.weight, lights)
    slopes = slopes_of(pixels, used, seen, lights, method, found)
    height = without_plane(integrate(slopes.p, slopes.q), used)
    on_step("reflectance")
    own = about_middle(view)
    shading = shading_of(height * np.float32(own.pixel), lamp_about(lamp, view), own)
    surface = surface_of(pixels, seen.weight, seen.slow if lamp.near else None, shading)
    again = _again(surface, shading)
    notes = (*photo.notes, *found.notes, *_notes(seen))
    detail = _detail(height, surface, found, notes[:50], light, name, seed, own)
    seconds = time.monotonic() - started
    record = detail.record.model_copy(
        update={"provenance": _provenance(photo, light, zone, longest, name, seconds, pixels, again)}
    )
    detail = MappedDetail(record, detail.height, detail.albedo, detail.roughness)
    return Recovery(detail, pixels, used, again, lamp_about(lamp, view), seconds)


def _again(surface: Surface, shading: Shading) -> NDArray[np.float32]:
    """Return the maps under the photo's light."""
    r = surface.reflectance
    weights = luminance(surface.albedo)
    factor = surface.albedo / max(float(weights.mean()), 1e-6)
    matt = (r.ambient * shading.ambient + r.diffuse * shading.diffuse)[..., None] * factor
    if r.specular > 0:
        matt = matt + (r.specular * shading.specular[SHININESS.index(r.shininess)])[..., None]
    return np.asarray(matt, np.float32)


def _notes(seen: Gated) -> tuple[str, ...]:
    notes = []
    if seen.burnt > BURNT_SAID:
        notes.append(f"{100 * seen.burnt:.0f} % of the photo is burnt out: its relief there is filled in from around.")
    if seen.paint > PAINT_SAID:
        notes.append(f"{100 * seen.paint:.0f} % of the pattern goes with colour and was taken for paint, not for relief.")
    return tuple(notes)


def _detail(
    height: NDArray[np.float32], surface: Surface, found: Evidence, notes: tuple[str, ...], light: Light, name: str, seed: int,
    view: View,
) -> MappedDetail:  # fmt: skip
    bottom = float(height.min())
    span = float(height.max()) - bottom
    flat = span < FLATTEST
    amplitude = max(FLATTEST if flat else span, FLATTEST) * view.pixel
    relative = np.zeros_like(height) if flat else (height - bottom) / np.float32(span)
    record = PhotoRelief(
        name=name[:200] or "relief", seed=seed, columns=view.columns, rows=view.rows, texels_per_unit=1.0 / view.pixel,
        relief=ReliefParameters(amplitude=min(amplitude, 1.0)), reflectance=surface.reflectance, light=light_text(light),
        confidence=found.confidence, notes=notes, maps=unsaved_maps(),
    )  # fmt: skip
    roughness = np.full(height.shape, surface.roughness, np.float32)
    return MappedDetail(record, np.asarray(relative, np.float32), surface.albedo, roughness)


def _provenance(
    photo: Photo, light: Light, zone: Zone, resolution: int, name: str, seconds: float, pixels: NDArray[np.float32],
    again: NDArray[np.float32],
) -> Provenance:  # fmt: skip
    version = importlib.metadata.version
    off = float(np.sqrt(np.mean((luminance(pixels) - luminance(again)) ** 2)) / max(float(luminance(pixels).mean()), 1e-6))
    return Provenance(
        voldetail=__version__, created=datetime.now(UTC).isoformat(timespec="seconds"), photo=name, photo_sha256=photo.sha256,
        zone=zone, resolution=resolution, light=light_text(light), proxy="plane", solver="relief",
        metric="relative difference of the photo and the maps under its light", evaluations=1, seconds=round(seconds, 2),
        distance=off, mitsuba=version("mitsuba"), drjit=version("drjit"), numpy=version("numpy"),
    )  # fmt: skip
