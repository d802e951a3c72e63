"""The analytic dipole of Jensen et al. 2001, per vertex: what a game would use. It knows no shape but distances.

One source and its mirror image stand for the light below a point of a flat, homogeneous half-space; on any other body
that is applied as if the straight distance from point to point were one along such a plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from quadgraph_validation.truth.boundary import published_reflectance

_NEAR = 4.0  # edges of the largest face: nearer faces are split, as the reflectance varies over them
_SPLIT = 4  # parts of an edge of those
_AT_ONCE = 1 << 21  # pairs of points


@dataclass(frozen=True)
class Dipole:
    """The medium below every point (n,), or the same below all (): sigma_s_prime and sigma_a, 1/mm; eta."""

    sigma_s_prime: np.ndarray
    sigma_a: np.ndarray
    eta: float

    def reflectance(self, r: np.ndarray) -> np.ndarray:
        """R_d, 1/mm^2: exitance at a distance r, mm, from 1 W that enters at a point [Jensen et al. 2001, Eq. 4]."""
        sigma_t = self.sigma_s_prime + self.sigma_a
        sigma_tr = np.sqrt(3 * self.sigma_a * sigma_t)
        f_dr = published_reflectance(self.eta)
        real = 1 / sigma_t
        image = real * (1 + 4 / 3 * (1 + f_dr) / (1 - f_dr))
        pair = 0.0
        for depth in (real, image):
            distance = np.sqrt(r**2 + depth**2)
            pair = pair + depth * (sigma_tr + 1 / distance) * np.exp(-sigma_tr * distance) / distance**2
        return self.sigma_s_prime / sigma_t * pair / (4 * np.pi)

    def total(self) -> np.ndarray:
        """The integral of R_d over the plane: the share of evenly entering light that leaves again."""
        albedo = self.sigma_s_prime / (self.sigma_s_prime + self.sigma_a)
        f_dr = published_reflectance(self.eta)
        root = np.sqrt(3 * (1 - albedo))
        return albedo / 2 * (1 + np.exp(-4 / 3 * (1 + f_dr) / (1 - f_dr) * root)) * np.exp(-root)

    def at(self, chosen: np.ndarray | slice) -> Dipole:
        """The medium below some of the points, as columns."""
        return Dipole(self.sigma_s_prime[chosen, None], self.sigma_a[chosen, None], self.eta)


def transport(medium: Dipole, points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The matrix (n, n_f) float32 from q (n_f,) on the faces, corners (n_f, 3, 3) mm, to exitance at points (n, 3) mm.

    Row i is the integral of R_d of the medium below point i over each face: at the centroid, or at those of the parts
    of a face that is near.
    """
    centroids = corners.mean(axis=1)
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(doubled, axis=1) / 2
    matrix = np.empty((len(points), len(corners)), np.float32)
    rows = max(1, _AT_ONCE // len(corners))
    for start in range(0, len(points), rows):
        part = slice(start, start + rows)
        distance = np.linalg.norm(points[part, None] - centroids, axis=2)
        matrix[part] = medium.at(part).reflectance(distance) * areas
    _integrate_near(matrix, medium, points, corners, areas)
    return matrix


def _integrate_near(
    matrix: np.ndarray, medium: Dipole, points: np.ndarray, corners: np.ndarray, areas: np.ndarray
) -> None:
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    near = cKDTree(corners.mean(axis=1)).query_ball_point(points, _NEAR * edge)
    point = np.repeat(np.arange(len(points)), [len(faces) for faces in near])
    face = np.concatenate([np.asarray(faces, np.int64) for faces in near])
    weights = _part_centroids(_SPLIT)
    pairs = max(1, _AT_ONCE // len(weights))
    for start in range(0, len(face), pairs):
        i, f = point[start : start + pairs], face[start : start + pairs]
        places = np.einsum("pk,nkx->npx", weights, corners[f])
        distance = np.linalg.norm(points[i, None] - places, axis=2)
        matrix[i, f] = medium.at(i).reflectance(distance).mean(axis=1) * areas[f]


def _part_centroids(split: int) -> np.ndarray:
    """Barycentric coordinates (split^2, 3) of the centroids of the equal parts of a triangle."""
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(split) for j in range(split - i)]
    turned = [(i + 2 / 3, j + 2 / 3) for i in range(split) for j in range(split - i - 1)]
    both = np.array(upright + turned) / split
    return np.column_stack([both, 1 - both.sum(axis=1)])
