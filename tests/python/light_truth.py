"""Irradiance that lights bring into a body, by definition: sums over points of lights and faces, every ray cast.

Independent of the engine: NumPy in double precision; Embree says what a ray meets first, through trimesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import trimesh

from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.meshes import face_frames
from quadgraph_validation.truth.fresnel import gauss, transmittance_from_outside

# Per point (n, 3) mm, and place (n, 2) in [0, 1)^2 on the light: where what falls on the point begins (n, 3), mm or, at
# infinity, far away, and what irradiance (n, 3) W/mm^2 it brings to a plane that faces it, as if all began there.
Emitter = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]

FAR = 1e4  # mm
# Multiples of these fill the four-dimensional cube evenly: powers of the root of x^5 = x + 1 (M. Roberts 2018).
_STEP = 1.1673039782614187 ** -np.arange(1.0, 5.0)


def lit_from_above(level) -> np.ndarray:
    """Clamped-cosine irradiance from +z, (n_f, 3) W/mm^2."""
    _, normal, _ = face_frames(level)
    return np.clip(normal[:, 2:], 0, None) * np.array([1.0, 0.8, 0.6])


@dataclass(frozen=True)
class Body:
    """A closed surface that light falls on and that hides light from itself."""

    surface: Surface

    def q(self, faces: np.ndarray, emitter: Emitter, eta: float, count: int, seed: int = 1) -> np.ndarray:
        """(n, 3) W/mm^2: the mean over each of the faces (n,) by `count` points, each with light of its own."""
        generator = np.random.default_rng(seed)
        corners = self.surface.vertices[self.surface.triangles[faces]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal = np.repeat(normal / np.linalg.norm(normal, axis=1)[:, None], count, axis=0)
        places = (generator.random((len(faces), 1, 4)) + np.arange(count)[:, None] * _STEP) % 1
        u, v = places[..., 0], places[..., 1]
        flip = u + v > 1
        u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
        weight = np.stack([1 - u - v, u, v], axis=-1)
        points = np.einsum("fpk,fkd->fpd", weight, corners).reshape(-1, 3)
        source, facing = emitter(points, places[..., 2:].reshape(-1, 2))
        way = source - points
        distance = np.linalg.norm(way, axis=1)
        way /= distance[:, None]
        cosine = np.clip(np.einsum("ij,ij->i", way, normal), 0, 1)
        lit = np.flatnonzero((cosine > 0) & (facing.max(axis=1) > 0))
        share = np.zeros(len(points))
        share[lit] = cosine[lit] * transmittance_from_outside(cosine[lit], eta)
        share[lit] *= self.free(points[lit], normal[lit], way[lit], distance[lit])
        return (share[:, None] * facing).reshape(len(faces), count, 3).mean(axis=1)

    def free(self, points: np.ndarray, normals: np.ndarray, ways: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """(n,) whether nothing is met on the way from points of the surface to light at that distance."""
        mesh = trimesh.Trimesh(self.surface.vertices, self.surface.triangles, process=False)
        hit = mesh.ray.intersects_first(points + 1e-5 * np.ptp(self.surface.vertices) * normals, ways)
        met = hit >= 0
        plane = mesh.face_normals[hit]
        slope = np.einsum("ij,ij->i", plane, ways)
        to_plane = np.einsum("ij,ij->i", self.surface.vertices[self.surface.triangles[hit, 0]] - points, plane)
        behind = slope > 0  # slipped through the face that it began on
        return ~met | behind | (to_plane <= slope * distance)


def unit(vector: tuple[float, float, float] | np.ndarray) -> np.ndarray:
    """A vector scaled to length 1."""
    return np.array(vector, float) / np.linalg.norm(vector)


def spot(position, direction, angle: float, edge: float, power: np.ndarray) -> Emitter:
    """A cone of light, `angle` degrees from the axis; its intensity follows from its power by quadrature."""
    outer = np.cos(np.radians(angle))
    inner = np.cos(np.radians((1 - edge) * angle))

    def fading(cosine: np.ndarray) -> np.ndarray:
        s = np.clip((cosine - outer) / (inner - outer), 0, 1)
        return s * s * (3 - 2 * s)

    nodes, weights = (
        np.concatenate(parts) for parts in zip(gauss(32, outer, inner), gauss(4, inner, 1.0), strict=True)
    )
    intensity = np.array(power) / (2 * np.pi * (weights * fading(nodes)).sum())

    def emit(points: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        way = points - np.array(position, float)
        square = (way**2).sum(axis=1)
        share = fading(way @ unit(direction) / np.sqrt(square)) / square
        return np.broadcast_to(np.array(position, float), points.shape), share[:, None] * intensity

    return emit


def rectangle(centre, u, v, power: np.ndarray) -> Emitter:
    """A Lambertian rectangle with edges u and v, mm, that shines to where their cross product points."""
    centre, u, v = (np.array(value, float) for value in (centre, u, v))
    area = np.linalg.norm(np.cross(u, v))
    radiance = np.array(power) / (np.pi * area)

    def emit(points: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        source = centre + (place[:, :1] - 0.5) * u + (place[:, 1:] - 0.5) * v
        way = points - source
        square = (way**2).sum(axis=1)
        cosine = np.clip(way @ unit(np.cross(u, v)) / np.sqrt(square), 0, None)
        return source, (area * cosine / square)[:, None] * radiance

    return emit


def projector(position, direction, up, angle: float, image: np.ndarray, power: np.ndarray) -> Emitter:
    """An image (rows, columns, 3) `angle` degrees high, linear between its texels' middles, that lights a plane across
    its axis as it is; `power` W if it is white.
    """
    ahead = unit(direction)
    right = unit(np.cross(ahead, up))
    above = np.cross(right, ahead)
    rows, columns = image.shape[:2]
    high = np.tan(np.radians(angle) / 2)
    wide = high * columns / rows

    def emit(points: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        way = points - np.array(position, float)
        depth = way @ ahead
        x, y = way @ right / (depth * wide), way @ above / (depth * high)
        inside = (depth > 0) & (np.abs(x) <= 1) & (np.abs(y) <= 1)
        colour = _between(image, (0.5 + 0.5 * x) * columns - 0.5, (0.5 - 0.5 * y) * rows - 0.5)
        across = np.array(power) / (4 * high * wide * depth[:, None] ** 2)  # on a plane across the axis
        facing = across * (np.linalg.norm(way, axis=1) / depth)[:, None]
        return np.broadcast_to(np.array(position, float), points.shape), np.where(inside[:, None], colour * facing, 0)

    return emit


def _between(image: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Bilinear, (n, 3), at texels (n,) and (n,); what lies outside is as the edge."""
    x, y = (np.clip(value, 0, size - 1) for value, size in ((x, image.shape[1]), (y, image.shape[0])))
    left, top = np.minimum(x.astype(int), image.shape[1] - 2), np.minimum(y.astype(int), image.shape[0] - 2)
    u, v = (x - left)[:, None], (y - top)[:, None]
    upper = image[top, left] * (1 - u) + image[top, left + 1] * u
    return upper * (1 - v) + (image[top + 1, left] * (1 - u) + image[top + 1, left + 1] * u) * v


def environment(picture: np.ndarray, turn: float, radiance: np.ndarray) -> Emitter:
    """A picture (rows, columns, 3) of all that is around, y up, its middle at -z, turned counter-clockwise, degrees."""
    rows, columns = picture.shape[:2]
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    solid = np.repeat((edges[:-1] - edges[1:]) * 2 * np.pi / columns, columns)
    texels = picture.reshape(-1, 3).astype(float)
    chance = solid * texels.mean(axis=1)
    chance /= chance.sum()
    begin = np.concatenate([[0], np.cumsum(chance)])
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))

    def emit(points: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        texel = np.clip(np.searchsorted(begin, place[:, 0], side="right") - 1, 0, len(texels) - 1)
        across = np.clip((place[:, 0] - begin[texel]) / chance[texel], 0, 1)
        row, column = texel // columns, texel % columns
        height = edges[row] + (edges[row + 1] - edges[row]) * place[:, 1]
        longitude = 2 * np.pi * (column + across) / columns - np.pi
        flat = np.sqrt(1 - height**2)
        right, ahead = flat * np.sin(longitude), flat * np.cos(longitude)
        way = np.stack([c * right - s * ahead, height, -s * right - c * ahead], axis=1)
        return points + FAR * way, texels[texel] * radiance * (solid / chance)[texel, None]

    return emit


def write_hdr(path, picture: np.ndarray) -> np.ndarray:
    """Write a Radiance picture without runs; what it then holds, (rows, columns, 3)."""
    rows, columns = picture.shape[:2]
    largest = np.maximum(picture.max(axis=2), 1e-30)
    exponent = np.floor(np.log2(largest)) + 1
    mantissa = np.minimum(np.floor(picture / np.exp2(exponent)[..., None] * 256), 255)
    rgbe = np.concatenate([mantissa, exponent[..., None] + 128], axis=2).astype(np.uint8)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n"
    path.write_bytes(header.encode() + rgbe.tobytes())
    return (mantissa + 0.5) * np.exp2(exponent - 8)[..., None]


def directional(direction) -> Emitter:
    """1 W/mm^2 on a plane that faces it."""

    def emit(points: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return points - FAR * unit(direction), np.ones((len(points), 3))

    return emit
