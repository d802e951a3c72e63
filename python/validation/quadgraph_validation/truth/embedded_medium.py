"""What bodies within one another are made of, as walks take it: by which closed surface encloses a point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh

from quadgraph.api.materials import Material
from quadgraph.mesh.surface import Surface, joined_surface
from quadgraph_validation.bodies.unseen_cases import UnseenMedium

_BESIDE = 3  # cells around what lies within, of the outer material


def embedded_medium(
    outer: Material, inner: Sequence[tuple[Surface, Material]], cell: float, channel: int = 0
) -> UnseenMedium:
    """Coefficients of one channel on cells of a side, mm, with the index of refraction of the outer material.

    inner: closed surfaces, mm, and what is inside each, where later ones replace earlier ones. Between the middles of
    two cells coefficients are linear, so that a step is a cell wide and lies right on average.
    """
    corners = joined_surface([surface for surface, _ in inner]).vertices
    first = corners.min(axis=0) - _BESIDE * cell
    count = np.ceil((corners.max(axis=0) - first) / cell).astype(int) + _BESIDE
    x, y, z = (low + cell * np.arange(n) for low, n in zip(first, count, strict=True))
    places = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1)[..., ::-1].reshape(-1, 3)
    found = np.tile(_coefficients(outer, channel), (len(places), 1))
    for surface, material in inner:
        mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
        found[mesh.contains(places)] = _coefficients(material, channel)
    scattering, absorption = (np.ascontiguousarray(each).reshape(count[::-1]) for each in found.T)
    return UnseenMedium("embedded", outer.eta, scattering, absorption, tuple(first.tolist()), cell)


def _coefficients(material: Material, channel: int) -> np.ndarray:
    """(2,) float32: sigma_s_prime and sigma_a, 1/mm."""
    both = [np.broadcast_to(each, 3)[channel] for each in (material.sigma_s_prime, material.sigma_a)]
    return np.array(both, np.float32)
