"""A tree of boxes around triangles, for rays and nearest points, compiled by Numba: double precision, nothing shared.

Arrays alone, in a named tuple that compiled functions take. Rays see one side of the triangles only: those they leave
the body through, or those they enter by.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

LEAVING, ENTERING = 1.0, -1.0  # which triangles a ray meets: with its way along the outward normal, or against it
_LEAF = 4  # triangles
_FEW = 24  # triangles, which are halved without a search
_DEPTH = 128  # of the stack of a traversal
_EDGE = 1e-12  # by which triangles reach beyond their edges, in their own coordinates: no ray slips between two


class TriangleTree(NamedTuple):
    """Boxes (m, 6) lowest and highest corner, depth first: the left child follows its parent.

    right (m,): index of the right child, -1 at a leaf; first, held (m,): triangles of a leaf, from which on and how
    many. Triangles in the order of the leaves: corner, edges, normal (n, 3), unit, outward; number (n,): what each was
    in the mesh.
    """

    boxes: np.ndarray
    right: np.ndarray
    first: np.ndarray
    held: np.ndarray
    corner: np.ndarray
    along: np.ndarray
    across: np.ndarray
    normal: np.ndarray
    number: np.ndarray


def build(vertices: np.ndarray, triangles: np.ndarray) -> TriangleTree:
    """Sort triangles (n, 3) of vertices (v, 3) into a tree by the surface area heuristic."""
    corners = np.asarray(vertices, np.float64)[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    boxes: list[np.ndarray] = []
    right: list[int] = []
    leaves: list[tuple[int, int]] = []
    order: list[np.ndarray] = []
    taken = 0
    waiting = [(np.arange(len(triangles)), -1)]
    while waiting:
        part, parent = waiting.pop()
        if parent >= 0:
            right[parent] = len(boxes)
        boxes.append(np.concatenate([low[part].min(axis=0), high[part].max(axis=0)]))
        right.append(-1)
        leaves.append((taken, len(part)) if len(part) <= _LEAF else (0, 0))
        if len(part) <= _LEAF:
            order.append(part)
            taken += len(part)
        else:
            one, other = _split(part, low, high)
            waiting += [(other, len(boxes) - 1), (one, -1)]
    number = np.concatenate(order)
    a, b, c = (corners[number, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first, held = np.array(leaves, np.int64).T.copy()
    return TriangleTree(np.array(boxes), np.array(right), first, held, a.copy(), b - a, c - a, normal, number)


def _split(part: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two parts of triangles whose boxes' areas times numbers add up to least, cut across one axis; of few, halves."""
    if len(part) <= _FEW:
        axis = int((high[part].max(axis=0) - low[part].min(axis=0)).argmax())
        order = part[np.argsort(low[part, axis] + high[part, axis], kind="stable")]
        return order[: len(part) // 2], order[len(part) // 2 :]
    best, chosen = np.inf, (part, len(part) // 2)
    for axis in range(3):
        order = part[np.argsort(low[part, axis] + high[part, axis], kind="stable")]
        ahead = _areas(low[order], high[order])[:-1]
        behind = _areas(low[order[::-1]], high[order[::-1]])[::-1][1:]
        number = np.arange(1, len(part))
        cost = ahead * number + behind * number[::-1]
        at = int(np.argmin(cost))
        if cost[at] < best:
            best, chosen = cost[at], (order, at + 1)
    return chosen[0][: chosen[1]], chosen[0][chosen[1] :]


def _areas(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(n,) half the surface of the boxes around the first 1, 2, ... n."""
    x, y, z = (np.maximum.accumulate(high) - np.minimum.accumulate(low)).T
    return x * y + y * z + z * x


@njit(cache=True)
def _enters(box, ox, oy, oz, ix, iy, iz, far):
    """Distance at which a ray enters a box, from `far` on if it does not before; ix, iy, iz: 1 / its way."""
    x0, x1 = (box[0] - ox) * ix, (box[3] - ox) * ix
    y0, y1 = (box[1] - oy) * iy, (box[4] - oy) * iy
    z0, z1 = (box[2] - oz) * iz, (box[5] - oz) * iz
    near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), 0.0))
    beyond = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), far))
    return near if near <= beyond * (1 + 1e-12) else np.inf


@njit(cache=True)
def _meets(tree, k, ox, oy, oz, dx, dy, dz, side):
    """Distance at which a ray meets triangle k from the side asked for; infinite if it does not."""
    along, across, corner = tree.along[k], tree.across[k], tree.corner[k]
    px = dy * across[2] - dz * across[1]
    py = dz * across[0] - dx * across[2]
    pz = dx * across[1] - dy * across[0]
    det = along[0] * px + along[1] * py + along[2] * pz
    if det * side >= 0:
        return np.inf
    tx, ty, tz = ox - corner[0], oy - corner[1], oz - corner[2]
    u = (tx * px + ty * py + tz * pz) / det
    if u < -_EDGE or u > 1 + _EDGE:
        return np.inf
    qx = ty * along[2] - tz * along[1]
    qy = tz * along[0] - tx * along[2]
    qz = tx * along[1] - ty * along[0]
    v = (dx * qx + dy * qy + dz * qz) / det
    if v < -_EDGE or u + v > 1 + _EDGE:
        return np.inf
    distance = (across[0] * qx + across[1] * qy + across[2] * qz) / det
    return distance if distance >= 0 else np.inf


@njit(cache=True)
def _inverse(value):
    return 1 / value if abs(value) > 1e-300 else 1e300


@njit(cache=True)
def first_hit(tree, ox, oy, oz, dx, dy, dz, far, side, skip):
    """Triangle in the tree's order, -1 for none, and distance of what a ray of unit way meets first before `far`.

    side: LEAVING or ENTERING; skip: the triangle that it starts on, -1 for none.
    """
    ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
    nodes = np.empty(_DEPTH, np.int64)
    starts = np.empty(_DEPTH)
    found, nearest = -1, far
    size = 0
    start = _enters(tree.boxes[0], ox, oy, oz, ix, iy, iz, nearest)
    if start < np.inf:
        nodes[0], starts[0], size = 0, start, 1
    while size:
        size -= 1
        node = nodes[size]
        if starts[size] > nearest:
            continue
        if tree.right[node] < 0:
            for k in range(tree.first[node], tree.first[node] + tree.held[node]):
                if k != skip:
                    distance = _meets(tree, k, ox, oy, oz, dx, dy, dz, side)
                    if distance < nearest:
                        found, nearest = k, distance
            continue
        one, other = node + 1, tree.right[node]
        s1 = _enters(tree.boxes[one], ox, oy, oz, ix, iy, iz, nearest)
        s2 = _enters(tree.boxes[other], ox, oy, oz, ix, iy, iz, nearest)
        if s1 > s2:
            one, other, s1, s2 = other, one, s2, s1
        if s2 < np.inf:
            nodes[size], starts[size] = other, s2
            size += 1
        if s1 < np.inf:
            nodes[size], starts[size] = one, s1
            size += 1
    return found, nearest


@njit(cache=True)
def _from_box(box, x, y, z):
    """Squared distance of a point from a box."""
    a = max(max(box[0] - x, x - box[3]), 0.0)
    b = max(max(box[1] - y, y - box[4]), 0.0)
    c = max(max(box[2] - z, z - box[5]), 0.0)
    return a * a + b * b + c * c


@njit(cache=True)
def _from_edge(px, py, pz, ax, ay, az):
    """Squared distance of a point from the stretch between the origin and another point."""
    share = min(max((px * ax + py * ay + pz * az) / (ax * ax + ay * ay + az * az), 0.0), 1.0)
    return (px - share * ax) ** 2 + (py - share * ay) ** 2 + (pz - share * az) ** 2


@njit(cache=True)
def _from_triangle(tree, k, x, y, z):
    """Squared distance of a point from triangle k: from its inside, or from the nearest of its edges."""
    ax, ay, az = tree.along[k, 0], tree.along[k, 1], tree.along[k, 2]
    bx, by, bz = tree.across[k, 0], tree.across[k, 1], tree.across[k, 2]
    px, py, pz = x - tree.corner[k, 0], y - tree.corner[k, 1], z - tree.corner[k, 2]
    aa, ab, bb = ax * ax + ay * ay + az * az, ax * bx + ay * by + az * bz, bx * bx + by * by + bz * bz
    pa, pb = px * ax + py * ay + pz * az, px * bx + py * by + pz * bz
    u, v = bb * pa - ab * pb, aa * pb - ab * pa
    if u >= 0 and v >= 0 and u + v <= aa * bb - ab * ab:
        return (px * tree.normal[k, 0] + py * tree.normal[k, 1] + pz * tree.normal[k, 2]) ** 2
    one, other = _from_edge(px, py, pz, ax, ay, az), _from_edge(px, py, pz, bx, by, bz)
    return min(one, min(other, _from_edge(px - ax, py - ay, pz - az, bx - ax, by - ay, bz - az)))


@njit(cache=True)
def distance_to(tree, x, y, z, most):
    """Distance of a point from the surface, or `most` if that is less."""
    nodes = np.empty(_DEPTH, np.int64)
    nodes[0], size = 0, 1
    nearest = most * most
    while size:
        size -= 1
        node = nodes[size]
        if _from_box(tree.boxes[node], x, y, z) >= nearest:
            continue
        if tree.right[node] < 0:
            for k in range(tree.first[node], tree.first[node] + tree.held[node]):
                nearest = min(nearest, _from_triangle(tree, k, x, y, z))
            continue
        one, other = node + 1, tree.right[node]
        if _from_box(tree.boxes[one], x, y, z) > _from_box(tree.boxes[other], x, y, z):
            one, other = other, one
        nodes[size], nodes[size + 1] = other, one
        size += 2
    return np.sqrt(nearest)
