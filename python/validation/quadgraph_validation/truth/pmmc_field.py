"""pmmc's walks of parallel light that falls on a square of a block: where they leave, and the fluence in each tet.

pmmc starts walks of wide light in tets outside the body that are labelled so: a layer of prisms on the lit face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import pmmc_walk

_LAYER = 1.0  # mm of air in front of the lit face
_PRISM = np.array([[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]])


@dataclass(frozen=True)
class LeftWalks:
    """Of (n,) walks that left after they had scattered: weight, and where, (n, 3) mm; entered: how many of `walks` went
    in; fluence: (n_t,) 1/mm^2 of one walk in each tet.
    """

    weight: np.ndarray
    position: np.ndarray
    entered: int
    walks: int
    fluence: np.ndarray


def square(body: Graph, medium: Medium, eta: float, half: float, walks: int, seed: int) -> LeftWalks:
    """Walks of parallel light along z onto the square |x|, |y| < half, mm, of the body's lowest face, which is flat.

    Raises InputError as `pmmc_walk.load` does.
    """
    pmmc = pmmc_walk.load()
    vertices, tets = _with_air(body)
    low = float(body.vertices[:, 2].min())
    options = pmmc_walk.leaving_options(medium, eta, np.zeros(3), walks, seed) | {
        "node": vertices.astype(np.float32),
        "elem": (tets + 1).astype(np.int32),
        "elemprop": np.where(np.arange(len(tets)) < len(body.tets), 1, -1).astype(np.int32),
        "srctype": "planar",
        "srcpos": [-half, -half, low - _LAYER / 2],
        "srcdir": [0, 0, 1],
        "srcparam1": [2 * half, 0, 0, 0],
        "srcparam2": [0, 2 * half, 0, 0],
        "basisorder": 0,
        "outputtype": "fluence",
    }
    with pmmc_walk.silent():
        result = pmmc.run(options)
    weight, scattered, position = pmmc_walk.that_left(result, medium)
    turned_back = int((~scattered & (position[:, 2] < low + 1e-3)).sum())
    fluence = np.asarray(result["flux"], np.float64).ravel()[: len(body.tets)]
    return LeftWalks(weight[scattered], position[scattered], walks - turned_back, walks, fluence)


def _with_air(body: Graph) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and tets of a body and, behind its own, of a layer of air below its lowest face."""
    vertices, low = body.vertices, body.vertices[:, 2].min()
    lit = np.sort(body.faces[(vertices[body.faces][:, :, 2] < low + 1e-6).all(axis=1)], axis=1)
    below = np.full(len(vertices), -1)
    used = np.unique(lit)
    below[used] = len(vertices) + np.arange(len(used))
    # Cut from corner to corner in the order of their numbers, so that neighbouring prisms meet.
    prisms = np.column_stack([below[lit], lit])[:, _PRISM].reshape(-1, 4)
    every = np.concatenate([vertices, vertices[used] - [0, 0, _LAYER]])
    corners = every[prisms]
    inverted = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    prisms[inverted] = prisms[inverted][:, [0, 2, 1, 3]]
    return every, np.concatenate([body.tets, prisms])
