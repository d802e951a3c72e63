"""What was solved, on the mesh that it was solved on, as other programs take it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from quadgraph.api.fields import SurfaceField
from quadgraph.api.values import Floats
from quadgraph.base.optional_package import optional_package

if TYPE_CHECKING:
    import meshio
    import pyvista

Part: TypeAlias = Literal["body", "surface"]
Indices: TypeAlias = npt.NDArray[np.integer[Any]]


@dataclass(frozen=True, eq=False)
class MeshFields:
    """points: (n, 3) mm; cells: (m, 4) tets or (m, 3) triangles, their points; point_data: (n, 3) each; cell_data:
    (m, 3) each.
    """

    points: Floats
    cells: Indices
    point_data: Mapping[str, Floats]
    cell_data: Mapping[str, Floats]

    def to_meshio(self) -> meshio.Mesh:
        """Return it as a mesh of meshio. Raises InputError without that package."""
        made = optional_package("meshio", "meshio")
        kind = "tetra" if self.cells.shape[1] == 4 else "triangle"
        cell_data = {name: [values] for name, values in self.cell_data.items()}
        return made.Mesh(self.points, [(kind, self.cells)], dict(self.point_data), cell_data)

    def to_pyvista(self) -> pyvista.UnstructuredGrid | pyvista.PolyData:
        """Return it as a grid of PyVista, of triangles as its surface mesh. Raises InputError without that package."""
        made = optional_package("pyvista", "pyvista")
        if self.cells.shape[1] == 4:
            mesh = made.UnstructuredGrid({made.CellType.TETRA: self.cells}, self.points)
        else:
            mesh = made.PolyData.from_regular_faces(self.points, self.cells)
        mesh.point_data.update(self.point_data)
        mesh.cell_data.update(self.cell_data)
        return mesh


def of_body(vertices: Floats, tets: Indices, phi: Floats, sigma_s_prime: Floats, sigma_a: Floats) -> MeshFields:
    """Tets (m, 4) with fluence and their coefficients.

    phi: the unknowns of the method, (n, 3) at the vertices, or of the tets first, then of outside faces, which are not
    looked at: which of both is told by their number, as there are more nodes than vertices.
    """
    if len(phi) == len(vertices):
        at_points, in_cells = phi, phi[tets].mean(axis=1)
    else:
        in_cells = phi[: len(tets)]
        at_points = _around(vertices, tets, in_cells)
    cell_data = {"fluence": in_cells, "sigma_s_prime": sigma_s_prime, "sigma_a": sigma_a}
    return MeshFields(vertices, tets.astype(np.int64), {"fluence": at_points}, cell_data)


def _around(vertices: Floats, tets: Indices, values: Floats) -> Floats:
    """Means at the vertices of what the tets around have, (m, 3), weighted by their volumes."""
    corners = vertices[tets].astype(np.float64)
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    sums, weights = np.zeros((len(vertices), 3)), np.zeros(len(vertices))
    for corner in tets.T:
        np.add.at(sums, corner, volume[:, None] * values)
        np.add.at(weights, corner, volume)
    return (sums / weights[:, None]).astype(np.float32)


def of_surface(vertices: Floats, faces: Indices, surface: SurfaceField) -> MeshFields:
    """Outside triangles (m, 3), with the vertices that they have, and what a solve left on them."""
    used, places = np.unique(faces, return_inverse=True)
    names = ("q", "phi", "exitance", "unscattered")
    return MeshFields(vertices[used], places.reshape(faces.shape), {}, {each: getattr(surface, each) for each in names})
