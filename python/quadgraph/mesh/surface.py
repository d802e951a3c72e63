"""Closed triangle surfaces in millimetres: the data that passes between reading, repair, level of detail and mesher."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class EdgeTopology:
    """Undirected edges of a surface and how many faces share each.

    edges: (e, 2) int64, smaller index first, sorted; uses: (e,) faces per edge;
    face_edges: (m, 3) edge index; entry k joins corners k and k+1;
    balance: (e,) uses from small to large index minus uses from large to small (0 where two faces agree).
    """

    edges: np.ndarray
    uses: np.ndarray
    face_edges: np.ndarray
    balance: np.ndarray

    @property
    def boundary(self) -> np.ndarray:
        """(b, 2) edges with one face."""
        return self.edges[self.uses == 1]

    @property
    def non_manifold(self) -> np.ndarray:
        """(b, 2) edges with more than two faces."""
        return self.edges[self.uses > 2]


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles, counter-clockwise seen from outside.

    vertices: (n, 3) float64, mm; triangles: (m, 3) int64.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    @cached_property
    def corners(self) -> np.ndarray:
        """(m, 3, 3) corner positions of each triangle, mm."""
        return self.vertices[self.triangles]

    @cached_property
    def doubled_normals(self) -> np.ndarray:
        """(m, 3) outward normals, twice the triangle's area long, mm²."""
        p = self.corners
        return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])

    @cached_property
    def topology(self) -> EdgeTopology:
        """Edges and their faces."""
        t = self.triangles
        directed = np.stack([t, np.roll(t, -1, axis=1)], axis=2).reshape(-1, 2)
        forward = directed[:, 0] < directed[:, 1]
        count = len(self.vertices)
        keys = directed.min(axis=1) * count + directed.max(axis=1)
        unique, inverse, uses = np.unique(keys, return_inverse=True, return_counts=True)
        balance = np.bincount(inverse, weights=np.where(forward, 1, -1), minlength=len(unique)).astype(np.int64)
        edges = np.stack([unique // max(count, 1), unique % max(count, 1)], axis=1)
        return EdgeTopology(edges, uses, inverse.reshape(-1, 3), balance)

    @property
    def area(self) -> float:
        """mm²."""
        return float(0.5 * np.linalg.norm(self.doubled_normals, axis=1).sum())

    @property
    def volume(self) -> float:
        """Signed enclosed volume, mm³ (divergence theorem, about the box centre); positive if faces look outward."""
        if not len(self.triangles):
            return 0.0
        centre = 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))
        return float(np.einsum("ij,ij->", self.corners[:, 0] - centre, self.doubled_normals) / 6)

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, mm."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @cached_property
    def angles(self) -> np.ndarray:
        """(m, 3) angles at the corners, degrees; 0 in degenerate triangles."""
        p = self.corners
        to_next = np.roll(p, -1, axis=1) - p
        to_last = np.roll(p, 1, axis=1) - p
        cross = np.linalg.norm(np.cross(to_next, to_last), axis=2)
        return np.degrees(np.arctan2(cross, np.einsum("ijk,ijk->ij", to_next, to_last)))

    @property
    def min_angle(self) -> float:
        """Smallest angle of all triangles, degrees."""
        return float(self.angles.min()) if len(self.triangles) else 0.0

    @cached_property
    def vertex_components(self) -> tuple[int, np.ndarray]:
        """Number of pieces connected through shared vertices, and (n,) labels; unreferenced vertices are pieces too."""
        edges = self.topology.edges
        return _pieces(edges[:, 0], edges[:, 1], len(self.vertices))

    @property
    def components(self) -> int:
        """Number of connected pieces with at least one triangle."""
        return len(np.unique(self.vertex_components[1][self.triangles[:, 0]])) if len(self.triangles) else 0

    @property
    def euler(self) -> int:
        """Euler characteristic, vertices - edges + faces, of the referenced vertices."""
        return len(np.unique(self.triangles)) - len(self.topology.edges) + len(self.triangles)

    @property
    def genus(self) -> int:
        """Handles of a closed 2-manifold, all components together."""
        return self.components - self.euler // 2

    def fans(self, cut: np.ndarray) -> np.ndarray:
        """(m, 3) which fan each corner of a triangle is of, from 0 on.

        Two corners at one vertex are of the same where their triangles share an edge that ends there and is not `cut`,
        (e,) by the topology.
        """
        corner = np.arange(self.triangles.size).reshape(-1, 3)
        edge = self.topology.face_edges
        ends = np.stack([edge, np.roll(edge, 1, axis=1)], axis=2)
        vertex = np.repeat(self.triangles[:, :, None], 2, axis=2)
        key = (ends * len(self.vertices) + vertex).ravel()
        corner_of_end = np.repeat(corner[:, :, None], 2, axis=2).ravel()
        order = np.argsort(key, kind="stable")
        same = (key[order][1:] == key[order][:-1]) & ~cut[ends.ravel()[order][1:]]
        a, b = corner_of_end[order][1:][same], corner_of_end[order][:-1][same]
        return _pieces(a, b, self.triangles.size)[1].reshape(-1, 3)

    @cached_property
    def non_manifold_vertices(self) -> np.ndarray:
        """Indices of vertices whose faces form more than one fan (counted through shared edges)."""
        fan = self.fans(np.zeros(len(self.topology.edges), bool)).ravel()
        vertex_of = np.empty(fan.max(initial=-1) + 1, np.int64)
        vertex_of[fan] = self.triangles.ravel()  # all corners of a fan are at one vertex
        return np.flatnonzero(np.bincount(vertex_of) > 1)

    @property
    def is_closed_manifold(self) -> bool:
        """Whether each edge has two faces of agreeing orientation and each vertex one fan."""
        edges = self.topology
        return bool(len(self.triangles) and (edges.uses == 2).all() and (edges.balance == 0).all()) and not len(
            self.non_manifold_vertices
        )

    def compacted(self) -> Surface:
        """This surface without unreferenced vertices, in the order of the old indices."""
        used, inverse = np.unique(self.triangles, return_inverse=True)
        return Surface(self.vertices[used], inverse.reshape(-1, 3).astype(np.int64))

    def rounded(self) -> Surface:
        """This surface with coordinates that float32 can hold exactly."""
        return Surface(self.vertices.astype(np.float32).astype(np.float64), self.triangles)


def joined_surface(surfaces: Sequence[Surface]) -> Surface:
    """Several surfaces as one, their vertices and triangles one after the other."""
    offsets = np.cumsum([0] + [len(surface.vertices) for surface in surfaces])
    triangles = [surface.triangles + offset for surface, offset in zip(surfaces, offsets, strict=False)]
    return Surface(np.concatenate([surface.vertices for surface in surfaces]), np.concatenate(triangles))


@dataclass(frozen=True)
class FileFrame:
    """How a file has what we have in mm with y up. unit_mm: length of one unit of the file, mm; up: "y" or "z"."""

    unit_mm: float = 1.0
    up: str = "y"

    def placed(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (..., 3) of the file in mm with y up."""
        if self.up == "z":
            vectors = np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)
        return vectors * self.unit_mm

    def box(self, places: np.ndarray) -> str:
        """Say where places (k, 3), mm, lie between, in the file's coordinates."""
        found = np.asarray(places) / self.unit_mm
        if self.up == "z":
            found = np.stack([found[:, 0], -found[:, 2], found[:, 1]], axis=-1)
        low, high = (", ".join(f"{x:.4g}" for x in corner) for corner in (found.min(axis=0), found.max(axis=0)))
        unit = "mm" if self == MILLIMETRES else f"of the file, whose unit is {self.unit_mm:.4g} mm"
        return f"between ({low}) and ({high}) {unit}"


MILLIMETRES = FileFrame()


@dataclass(frozen=True)
class SourceMesh:
    """A surface as read from a file: `vertices` and `triangles` count what the file held.

    frame: of the file's coordinates; sha256: of the file's bytes, hexadecimal; size_note: a sentence on the size where
    nobody chose it.
    """

    surface: Surface
    name: str
    sha256: str
    frame: FileFrame
    vertices: int
    triangles: int
    size_note: str = ""

    @property
    def unit_mm(self) -> float:
        """Length of one unit of the file, mm."""
        return self.frame.unit_mm

    def metadata(self) -> dict[str, str | int]:
        """What a .qgraph keeps of it as `source`."""
        return {key: getattr(self, key) for key in ("name", "sha256", "vertices", "triangles")}


@dataclass(frozen=True)
class Repair:
    """One kind of repair and how often it was done, as told in the bake's report and metadata."""

    what: str
    count: int


@dataclass(frozen=True)
class MesherInfo:
    """Which program made the tetrahedra: `options` as given to it."""

    name: str
    version: str
    options: str


NO_MESHER = MesherInfo("", "", "")  # of tets that no program made


@dataclass(frozen=True, eq=False)
class TetMesh:
    """Tetrahedra of one closed surface.

    vertices: (n, 3) float64, mm, exactly representable in float32;
    tets: (m, 4) int64, det(v1-v0, v2-v0, v3-v0) > 0; regions: (m,) int64, which of the surfaces within it each lies in,
    counted from 1, and 0 in none; None where there is no such surface.
    """

    vertices: np.ndarray
    tets: np.ndarray
    mesher: MesherInfo = NO_MESHER
    regions: np.ndarray | None = None

    @cached_property
    def determinants(self) -> np.ndarray:
        """(m,) six times the volume of each tet, mm³."""
        v = self.vertices[self.tets]
        edges = v[:, 1:] - v[:, :1]
        return np.einsum("ij,ij->i", edges[:, 0], np.cross(edges[:, 1], edges[:, 2]))

    @property
    def volume(self) -> float:
        """mm³."""
        return float(self.determinants.sum() / 6)

    def boundary(self) -> Surface:
        """Faces with one tet, counter-clockwise seen from outside; vertices keep their tet-mesh indices."""
        # Face opposite to corner k of a positive tet, seen from outside.
        faces = self.tets[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
        ordered = np.sort(faces, axis=1)
        n = len(self.vertices)
        _, first, uses = np.unique(
            (ordered[:, 0] * n + ordered[:, 1]) * n + ordered[:, 2], return_index=True, return_counts=True
        )
        return Surface(self.vertices, faces[np.sort(first[uses == 1])])


def _pieces(a: np.ndarray, b: np.ndarray, count: int) -> tuple[int, np.ndarray]:
    """Number of pieces that links from a to b leave of `count` things, and (count,) labels."""
    from scipy import sparse  # here, as programs that only hold surfaces would take twice as long to start
    from scipy.sparse.csgraph import connected_components

    graph = sparse.coo_matrix((np.ones(len(a), bool), (a, b)), shape=(count, count))
    return connected_components(graph, directed=False)
