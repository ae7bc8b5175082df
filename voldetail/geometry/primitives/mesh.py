"""A mesh from a file, or one that is in memory."""

from __future__ import annotations

import numpy as np

from voldetail.geometry.closed_mesh import closed_mesh
from voldetail.geometry.meshes import Mesh, load_mesh, normalise
from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton
from voldetail.geometry.topology import crosses

UV_UNITS = 2.0
"""Scene units that texture coordinates of 0 to 1 span: a shape is about that long."""


class MeshShape(Primitive):
    """A mesh, its longest side that of the extent."""

    exact = False

    def skeleton(self) -> Skeleton:
        """Return the mesh as its file has it. Raises InputError for one that cannot be used."""
        assert self.proxy.mesh is not None
        mesh = normalise(load_mesh(self.proxy.mesh), max(self.extent))
        return Skeleton(mesh.vertices, mesh.normals, mesh.faces.astype(np.int64), mesh.uv, mesh.notes)

    def parameters(self, positions: Floats, uv: Floats | None) -> Floats:
        """Return the texture coordinates, (x, y) where it has none."""
        return positions[:, :2] if uv is None else UV_UNITS * uv

    def area(self) -> float:
        """Return that of its triangles."""
        mesh = self.mesh()
        return 0.5 * float(np.linalg.norm(crosses(mesh.vertices, mesh.faces), axis=1).sum())

    def thinnest(self) -> float | None:
        """Return None: it is known once the distances are."""
        return None

    def mesh(self) -> Mesh:
        """Return the mesh, which has to be closed."""
        return closed_mesh(self.proxy)

    def hull(self, depth: float, above: float) -> tuple[Floats, float]:
        """Return the mesh's vertices."""
        return self.mesh().vertices, above


PRIMITIVE = MeshShape
