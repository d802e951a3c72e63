"""Skinned meshes of a glTF 2.0 file, frame by frame (glTF 2.0, 3.7.3.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.gltf_animation import animation_of
from quadgraph.mesh.gltf_file import GltfFile
from quadgraph.mesh.gltf_morph import targets_of


@dataclass(frozen=True)
class SkinnedFrames:
    """vertices (n, 3) as the file has them unposed, triangles (m, 3), frames (f, n, 3), times (f,) in s.

    Places are in the unit of the file's world.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    frames: np.ndarray
    times: np.ndarray


def has_skin(file: GltfFile) -> bool:
    """Whether a mesh of the scene has one."""
    return bool(_skinned(file))


def read_frames(file: GltfFile, rate: float, name: str | None = None) -> SkinnedFrames:
    """All skinned meshes of the scene, `rate` times a second, in the animation of that name, or the only one.

    Vertices are weighted sums of joint matrices (linear blend skinning), morph targets before that. Raises InputError.
    """
    animation = animation_of(file, name)
    skins = [_Skin(file, number) for number in _skinned(file)]
    count = int(np.floor((animation.end - animation.begin) * rate + 1e-6)) + 1
    times = animation.begin + np.arange(count) / rate
    frames = []
    for time in times:
        posed = animation.at(time)
        world = file.transforms(posed)
        frames.append(np.concatenate([skin.at(world, posed) for skin in skins]))
    rest = file.transforms()
    offsets = np.cumsum([0] + [len(skin.vertices) for skin in skins])
    return SkinnedFrames(
        np.concatenate([_moved(skin.vertices, rest[skin.number]) for skin in skins]),
        np.concatenate([skin.triangles + offset for skin, offset in zip(skins, offsets, strict=False)]),
        np.array(frames),
        times,
    )


def _skinned(file: GltfFile) -> list[int]:
    nodes = file.document.get("nodes", [])
    return sorted(number for number in file.transforms() if "skin" in nodes[number] and "mesh" in nodes[number])


class _Skin:
    """One mesh, its joints, and how much each of its vertices follows each of them."""

    def __init__(self, file: GltfFile, number: int):
        node = file.document["nodes"][number]
        skin, mesh = file.document["skins"][node["skin"]], file.mesh(node)
        self.number = number
        self.joints = skin["joints"]
        self.inverse_bind = np.broadcast_to(np.eye(4), (len(self.joints), 4, 4))
        if "inverseBindMatrices" in skin:
            matrices = file.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4)
            self.inverse_bind = matrices.transpose(0, 2, 1)[: len(self.joints)]
        missing = [joint for joint in self.joints if joint not in file.transforms()]
        if missing or len(self.inverse_bind) != len(self.joints):
            raise InputError(f"{file.path}: a skin needs all its joints in the scene, and a matrix for each")
        parts = mesh["primitives"]
        self.vertices, self.triangles = file.positions(parts)
        self.targets = targets_of(file, parts)
        self.resting = np.array(node.get("weights", mesh.get("weights", [0] * len(self.targets))), np.float64)
        influences = [_influences(file, part["attributes"]) for part in parts]
        width = max(joint.shape[1] for joint, _ in influences)
        self.joint, self.weight = (np.concatenate([_widened(pair[k], width) for pair in influences]) for k in (0, 1))
        if self.joint.min() < 0 or self.joint.max() >= len(self.joints):
            raise InputError(f"{file.path}: joint {self.joint.max():.0f} found, the skin has {len(self.joints)}")

    def at(self, world: dict[int, np.ndarray], posed: dict[int, dict[str, np.ndarray]]) -> np.ndarray:
        """(n, 3), where the vertices are with these transforms of all nodes."""
        weights = posed.get(self.number, {}).get("weights", self.resting)
        vertices = self.vertices + np.einsum("t,tnk->nk", weights, self.targets)
        matrices = np.array([world[joint] for joint in self.joints]) @ self.inverse_bind
        moved = np.zeros_like(vertices)
        for joint, weight in zip(self.joint.T, self.weight.T, strict=True):
            matrix = matrices[joint]
            moved += weight[:, None] * (np.einsum("nij,nj->ni", matrix[:, :3, :3], vertices) + matrix[:, :3, 3])
        return moved


def _influences(file: GltfFile, attributes: dict) -> tuple[np.ndarray, np.ndarray]:
    """Joints (n, 4 k) int64 and weights of that shape, whose rows sum to 1, of all sets that a primitive has."""
    sets = [k for k in range(len(attributes)) if f"JOINTS_{k}" in attributes and f"WEIGHTS_{k}" in attributes]
    if not sets:
        raise InputError(f"{file.path}: a skinned mesh has no JOINTS_0 and WEIGHTS_0")
    joint = np.concatenate([file.accessor(attributes[f"JOINTS_{k}"]) for k in sets], axis=1).astype(np.int64)
    weight = np.concatenate([file.accessor(attributes[f"WEIGHTS_{k}"]) for k in sets], axis=1).astype(np.float64)
    total = weight.sum(axis=1, keepdims=True)
    if not np.all(np.isfinite(weight)) or weight.min() < 0 or total.min() <= 0:
        raise InputError(f"{file.path}: a vertex has no weight, or one below 0")
    return np.where(weight > 0, joint, 0), weight / total


def _widened(values: np.ndarray, width: int) -> np.ndarray:
    return np.pad(values, ((0, 0), (0, width - values.shape[1])))


def _moved(points: np.ndarray, transform: np.ndarray) -> np.ndarray:
    return points @ transform[:3, :3].T + transform[:3, 3]
