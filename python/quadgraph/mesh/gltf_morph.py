"""Morph targets of a glTF 2.0 file: a mesh, and where each of its targets takes the vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.gltf_file import GltfFile


@dataclass(frozen=True)
class MorphTargets:
    """vertices (n, 3), triangles (m, 3), targets (t, n, 3): displacements; all in the unit of the file's world."""

    vertices: np.ndarray
    triangles: np.ndarray
    targets: np.ndarray


def targets_of(file: GltfFile, parts: list[dict]) -> np.ndarray:
    """(t, n, 3), displacements of the vertices of all primitives; t may be 0. Raises InputError."""
    counts = {len(part.get("targets", [])) for part in parts}
    if len(counts) != 1:
        raise InputError(f"{file.path}: equally many morph targets in every primitive are wanted")
    vertex_count = sum(len(file.accessor(part["attributes"]["POSITION"])) for part in parts)
    targets = [
        np.concatenate([file.accessor(part["targets"][t]["POSITION"]) for part in parts]) for t in range(counts.pop())
    ]
    return np.array(targets).reshape(-1, vertex_count, 3)


def read_targets(file: GltfFile) -> MorphTargets:
    """The triangles of the only mesh that has morph targets, under its node's transform.

    Raises InputError naming what is missing or not supported.
    """
    found = [
        (node, transform)
        for node, transform in ((file.document["nodes"][i], t) for i, t in file.transforms().items())
        if any("targets" in part for part in file.mesh(node).get("primitives", []))
    ]
    if len(found) != 1:
        raise InputError(f"{file.path}: no skin and {len(found)} meshes with morph targets found, one is wanted")
    node, transform = found[0]
    parts = file.mesh(node)["primitives"]
    vertices, triangles = file.positions(parts)
    linear, shift = transform[:3, :3], transform[:3, 3]
    return MorphTargets(vertices @ linear.T + shift, triangles, targets_of(file, parts) @ linear.T)
