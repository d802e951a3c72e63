"""The rule of a `.qgraph` file that some rows of what faces see are what their rays meet.

The same as in engine/file/validate_seen.cpp, with the same numbers.
"""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import FormatError
from quadgraph.tets import exchange

MOST_ROWS, LEAST_ROWS = 32, 4
PAIR_BUDGET = 1 << 22  # rays times faces, where that leaves LEAST_ROWS
MOST_CANDIDATES, MOST_PLACES = 64, 2048  # faces that rows are chosen from, and vertices by which
RELIEF = 1e-3  # of the body's size, how far above a face a vertex counts
DIFFERING_SHARE, LEAST_DIFFERING = 0.01, 2  # of all these rays: those that graze an edge, by another rounding


def check_some(vertices: np.ndarray, faces: np.ndarray, seen: np.ndarray, rays: int, where: str) -> None:
    """Hold some rows against rays that are cast again.

    vertices: (n_v, 3), mm; faces: (n_f, 3); seen: rows whose indices are in range (docs/qgraph-format.md).
    Raises FormatError, beginning with `where`, if too many rays meet other faces than the rows tell.
    """
    surface = vertices[: int(faces.max()) + 1].astype(np.float64)
    size = float(np.linalg.norm(np.ptp(surface, axis=0)))
    rows = _rows(surface, faces, rays, size)
    count, lift = len(rows), exchange.LIFT * size
    frames = exchange.frames(surface, faces[rows])
    ways = exchange.directions(np.broadcast_to(np.eye(3), frames.shape), rows, rays)
    missing = invented = 0
    for face, frame, way in zip(rows.tolist(), frames, ways, strict=True):
        origin = surface[faces[face]].mean(axis=0) + lift * frame[2]
        stored = np.bincount(seen[int(seen[face]) : int(seen[face + 1])], minlength=len(faces))
        met = np.bincount(_met((surface - origin) @ frame.T, faces, face, way), minlength=len(faces))
        missing += int(np.maximum(met.astype(np.int64) - stored, 0).sum())
        invented += int(np.maximum(stored.astype(np.int64) - met, 0).sum())
    differing, allowed = max(missing, invented), max(int(DIFFERING_SHARE * count * rays), LEAST_DIFFERING)
    if differing > allowed:
        raise FormatError(
            f"{where}: {differing} of the {count * rays} rays of {count} rows meet other faces than are stored, "
            f"allowed are {allowed}; bake the body again"
        )


def _rows(surface: np.ndarray, faces: np.ndarray, rays: int, size: float) -> np.ndarray:
    """Faces whose rays are cast again: some with the most of the body above them, some with less, some with none."""
    candidates = np.arange(min(MOST_CANDIDATES, len(faces))) * len(faces) // min(MOST_CANDIDATES, len(faces))
    normals = exchange.frames(surface, faces[candidates])[:, 2]
    levels = np.einsum("ij,ij->i", normals, surface[faces[candidates]].mean(axis=1))
    heights = normals @ surface[:: max(len(surface) // MOST_PLACES, 1)].T - levels[:, None]
    order = np.argsort(-(heights > RELIEF * size).sum(axis=1), kind="stable")
    wanted = PAIR_BUDGET // (len(faces) * rays)
    count = min(max(LEAST_ROWS, min(wanted, MOST_ROWS)), len(candidates))
    return candidates[order[np.arange(count) * len(candidates) // count]]


def _met(vertices: np.ndarray, faces: np.ndarray, own: int, ways: np.ndarray) -> np.ndarray:
    """Faces that (n, 3) `ways` meet first and from outside, in no order.

    vertices: in the frame of the face `own`, the origin of all rays, z along its normal; ways: ascending by their
    angles from it.
    """
    above = (vertices[:, 2] > 0)[faces].any(axis=1)
    above[own] = False
    others = np.flatnonzero(above)
    a, b, c = (vertices[faces[others, k]] for k in range(3))
    # Normals of the planes through the origin and an edge; a ray between all three meets the face.
    planes = np.cross(a, b), np.cross(b, c), np.cross(c, a)
    volume = np.einsum("ij,ij->i", a, planes[1])  # six times that of the tet with the origin; negative from outside
    begin, end = _ray_ranges(np.stack([a, b, c], axis=1), len(ways))
    lengths = np.where(volume != 0, end - begin, 0)
    pair = np.repeat(np.arange(len(others)), lengths)
    ray = np.arange(len(pair)) - np.repeat(np.cumsum(lengths) - lengths - begin, lengths)
    along = [np.einsum("ij,ij->i", plane[pair], ways[ray]) * np.sign(volume)[pair] for plane in planes]
    hit = np.flatnonzero(np.minimum(np.minimum(along[0], along[1]), along[2]) >= 0)
    nearness = (along[0] + along[1] + along[2])[hit] / np.abs(volume[pair[hit]])  # 1 / distance
    hit = hit[nearness > 0][np.lexsort((nearness[nearness > 0], ray[hit[nearness > 0]]))]
    first = hit[np.append(np.diff(ray[hit]) > 0, True)] if len(hit) else hit
    return others[pair[first[volume[pair[first]] < 0]]]


def _ray_ranges(corners: np.ndarray, rays: int) -> tuple[np.ndarray, np.ndarray]:
    """First ray and the one after the last at the angles from z of cones around spheres around (n, 3, 3) triangles."""
    middle = corners.mean(axis=1)
    radius = np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=2).max(axis=1))
    distance = np.maximum(np.linalg.norm(middle, axis=1), 1e-300)
    sine, z = np.minimum(radius / distance, 1), np.clip(middle[:, 2] / distance, -1, 1)
    cosine, across = np.sqrt(1 - sine**2), np.sqrt(1 - z**2) * sine
    wide = sine >= 1
    highest = np.where(wide | (z >= cosine), 1, np.clip(z * cosine + across, 0, 1))
    lowest = np.where(wide, 0, np.clip(z * cosine - across, 0, 1))
    # z of ray i is sqrt(1 - (i + 1/2) / rays); one more on either side for rounding.
    begin = np.floor((1 - highest**2) * rays - 1.5).astype(np.int64)
    end = np.ceil((1 - lowest**2) * rays + 1.5).astype(np.int64)
    return np.clip(begin, 0, rays), np.clip(end, 0, rays)
