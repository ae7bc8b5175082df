"""Pictures of details, on shapes and under lights, and details as files for other programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from voldetail import apply, report
from voldetail.api.checks import checked
from voldetail.api.inputs import LightLike, ShapeLike, as_light, as_shape
from voldetail.apply.onmesh import Colour, Picture, Shading
from voldetail.detail import Detail
from voldetail.detail.photo_relief import AnyDetail
from voldetail.export import ExportOptions
from voldetail.export import export as exported
from voldetail.geometry.density_grid import DensityGrid
from voldetail.results import FitResult, Gallery
from voldetail.setup.camera import CameraSetup

Rotation = tuple[float, float, float]
UPRIGHT: Rotation = (0.0, 0.0, 0.0)


def render(
    detail: AnyDetail,
    shape: ShapeLike = "sphere",
    *,
    light: LightLike | None = None,
    envmap: str | Path | None = None,
    scale: float = 1.0,
    size: tuple[int, int] = (640, 480),
    camera: CameraSetup | None = None,
    rotation: Rotation = UPRIGHT,
    subsamples: int = 2,
    samples: int = 64,
    shading: Shading = "phong",
    background: float | Colour = 0.0,
) -> Picture:
    """Return a linear picture (rows, columns, 3) of a detail on a shape, under a light or an environment map.

    shape: a kind ("plane", "sphere", "torus", ...), a mesh file, a trimesh mesh or (vertices, faces). light: as for `fit`;
    default: from the upper left. envmap: an .exr or .hdr file instead, path-traced with ``samples`` a pixel. scale: how many
    times larger the relief is than in the photo. size: columns, rows. rotation: the shape's turns about x, y, z in degrees.
    shading: "phong" is what was fitted, "principled" a physically based material near to it. background: where nothing is.

    >>> render(Detail(), "torus", light="135,40", size=(48, 32)).shape
    (32, 48, 3)

    Raises InputError for a shape, light or number that cannot be used.
    """
    n = checked(
        "render", scale=scale, size=size, rotation=rotation, subsamples=subsamples, samples=samples, shading=shading,
        background=background,
    )  # fmt: skip
    with as_shape(shape) as file:
        return apply.render(
            detail, file, light=None if light is None else as_light(light), envmap=None if envmap is None else Path(envmap),
            scale=n.scale, size=n.size, camera=camera, rotation=n.rotation, subsamples=n.subsamples, samples=n.samples,
            shading=n.shading, background=n.background,
        )  # fmt: skip


def relight(
    detail: AnyDetail,
    shape: ShapeLike = "plane",
    *,
    azimuths: Sequence[float],
    elevations: Sequence[float],
    scale: float = 1.0,
    size: tuple[int, int] = (480, 480),
    camera: CameraSetup | None = None,
    rotation: Rotation = UPRIGHT,
    subsamples: int = 2,
    background: float | Colour = 0.0,
) -> Iterator[tuple[float, float, Picture]]:
    """Yield (azimuth, elevation, picture) for each pair of angles in degrees; the shape is made once.

    >>> frames = relight(Detail(), azimuths=[0, 90], elevations=[30], size=(32, 32))
    >>> [(azimuth, elevation) for azimuth, elevation, _ in frames]
    [(0, 30), (90, 30)]

    Raises InputError as `render` does, and for an elevation that is not over 0, at most 90.
    """
    n = checked("relight", scale=scale, size=size, rotation=rotation, subsamples=subsamples, background=background)
    with as_shape(shape) as file:
        yield from apply.relight(
            detail, file, azimuths=azimuths, elevations=elevations, scale=n.scale, size=n.size, camera=camera,
            rotation=n.rotation, subsamples=n.subsamples, background=n.background,
        )  # fmt: skip


def bake(
    detail: Detail, shape: ShapeLike = "sphere", *, cells: int = 128, scale: float = 1.0, rotation: Rotation = UPRIGHT
) -> DensityGrid:
    """Return the densities, 0 to 1, of a volumetric detail on a closed shape, ``cells`` to its 2 scene units.

    >>> bake(Detail(mode="volume"), "sphere", cells=16).array().ndim
    3

    Raises InputError for a detail that displaces, an open mesh and numbers out of range.
    """
    n = checked("bake", cells=cells, scale=scale, rotation=rotation)
    with as_shape(shape) as file:
        return apply.bake(detail, file, cells=n.cells, scale=n.scale, rotation=n.rotation)


def export(
    detail: AnyDetail, shape: ShapeLike, path: str | Path, *, cells: int = 128, scale: float = 1.0, rotation: Rotation = UPRIGHT
) -> str:
    """Write a detail on a shape for other programs, in the format that the file's suffix names; return a line about it.

    .vol: densities of a volume. .ply, .obj, .stl, .off: the displaced shape as triangles. cells: to the 2 scene units that a
    shape is long. Raises InputError for another suffix (the known ones are listed), and for what a format cannot hold.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     export(Detail(), "box", f"{folder}/box.ply", cells=16)
    '3074 vertices, 6144 faces'
    """
    n = checked("export", cells=cells, scale=scale, rotation=rotation)
    with as_shape(shape) as file:
        return exported(detail, file, path, ExportOptions(cells=n.cells, scale=n.scale, rotation=n.rotation))


def gallery(result: FitResult, on_progress: Callable[[str], None] = lambda what: None, mesh: str | Path = "cylinder") -> Gallery:
    """Return the pictures of a fit's report: the photo, the fit, other lights, a grazing view, a sphere and ``mesh``."""
    return apply.gallery(result, on_progress, mesh)


def write_report(folder: str | Path, result: FitResult, pictures: Gallery) -> tuple[Path, Path]:
    """Write report.html and sheet.png of a fit into ``folder``; return their paths."""
    return report.write_report(Path(folder), result, pictures)
