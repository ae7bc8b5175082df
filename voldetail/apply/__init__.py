"""The same detail in other setups: other meshes, other lights, and the pictures of a report."""

from voldetail.apply.bake import LEAST_SIDE, MOST_SIDE, bake
from voldetail.apply.gallery import gallery
from voldetail.apply.onmesh import Shading, relight, render
from voldetail.apply.painted import painted
from voldetail.results import Gallery

__all__ = ["LEAST_SIDE", "MOST_SIDE", "Gallery", "Shading", "bake", "gallery", "painted", "relight", "render"]
