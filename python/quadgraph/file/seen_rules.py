"""The rule of a `.qgraph` file that some rows of what faces see are what their rays meet.

The same as in engine/file/validate_seen.cpp, with the same numbers.
"""

from __future__ import annotations

import numpy as np

from quadgraph.base.errors import FormatError
from quadgraph.tets import exchange

MOST_ROWS, LEAST_ROWS = 16, 4
PAIR_BUDGET = 1 << 24  # rays times faces, where that leaves LEAST_ROWS
DIFFERING_SHARE, LEAST_DIFFERING = 0.01, 2  # of all these rays: those that graze an edge, by another rounding


def check_some(vertices: np.ndarray, faces: np.ndarray, seen: np.ndarray, rays: int, where: str) -> None:
    """Hold rows spread evenly over the faces against rays that are cast again.

    vertices: (n_v, 3), mm; faces: (n_f, 3); seen: rows whose indices are in range (docs/qgraph-format.md).
    Raises FormatError, beginning with `where`, if too many rays meet other faces than the rows tell.
    """
    wanted = PAIR_BUDGET // (len(faces) * rays)
    count = min(max(LEAST_ROWS, min(wanted, MOST_ROWS)), len(faces))
    rows = np.arange(count) * len(faces) // count
    surface = vertices[: int(faces.max()) + 1].astype(np.float64)
    lift = exchange.LIFT * float(np.linalg.norm(np.ptp(surface, axis=0)))
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
    """First ray, and the one after the last, at the angles from z of cones around (n, 3, 3) triangles."""
    units = corners / np.maximum(np.linalg.norm(corners, axis=2, keepdims=True), 1e-300)
    middle = units.sum(axis=1)
    middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-300)
    cosine = np.clip(np.einsum("ijk,ik->ij", units, middle).min(axis=1), -1, 1)
    sine, z = np.sqrt(1 - cosine**2), np.clip(middle[:, 2], -1, 1)
    across = np.sqrt(1 - z**2) * sine
    highest = np.where(z >= cosine, 1.0, np.maximum(z * cosine + across, 0))
    lowest = np.maximum(z * cosine - across, 0)
    wide = cosine <= 0
    highest[wide], lowest[wide] = 1, 0
    # z of ray i is sqrt(1 - (i + 1/2) / rays); one more on either side for rounding.
    begin = np.floor((1 - highest**2) * rays - 1.5).astype(np.int64)
    end = np.ceil((1 - lowest**2) * rays + 1.5).astype(np.int64)
    return np.clip(begin, 0, rays), np.clip(end, 0, rays)
