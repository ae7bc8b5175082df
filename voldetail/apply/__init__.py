"""The same detail in other setups: other meshes, other lights, and the pictures of a report."""

from voldetail.apply.gallery import Gallery, gallery
from voldetail.apply.onmesh import KINDS, Shading, relight, render

__all__ = ["KINDS", "Gallery", "Shading", "gallery", "relight", "render"]
