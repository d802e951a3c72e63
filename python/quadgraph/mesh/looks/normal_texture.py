"""The normal texture of a glTF 2.0 file: read with its coordinates, and carried to a surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.gltf_file import GltfFile, read
from quadgraph.mesh.looks.carried import carried
from quadgraph.mesh.looks.gltf_looks import Looks, place_of
from quadgraph.mesh.looks.gltf_media import number_of
from quadgraph.mesh.looks.texture import MOST_UV, Texture
from quadgraph.mesh.surface import Surface

MOST_SIDE = 2048  # texels that are kept
MOST_SCALE = 10.0
_FLATTEST = 1e-4  # area of a triangle in the picture, twice, over the square of its longest edge there
_TRIANGLES = 4  # mode of a primitive


@dataclass(frozen=True, eq=False)
class NormalTexture:
    """A normal texture at the corners of a surface's triangles.

    pixels: (h, w, 3) uint8, repeated beyond 0 to 1; places: (m, 3, 3), the place in it, v downwards, and 1 where it
    lies, else all 0.
    """

    pixels: np.ndarray
    places: np.ndarray


def find(path: Path, surface: Surface, placed: Callable[[np.ndarray], np.ndarray]) -> tuple[NormalTexture | None, str]:
    """The normal texture of a file at the corners of `surface`, as `file_normals.find` finds normals, and a note.

    None of other files than glTF, and of one whose texture cannot be read, which the note says.
    """
    if path.suffix.lower() not in (".gltf", ".glb"):
        return None, ""
    try:
        found = read(path, _Found)
        chosen = found.chosen()
        if chosen is None:
            return None, ""
        corners, places = found.soups[chosen]
        pixels, places = _repeating(chosen[0], places)
    except InputError as error:
        return None, f"its normal texture is left out: {error}"
    lies = np.broadcast_to(_has_area(places)[:, None, None], (*places.shape[:2], 1))
    here = carried(placed(corners), np.where(lies, np.concatenate([places, np.ones(lies.shape)], axis=-1), 0), surface)
    if not here.any():
        return None, f"{path.name}: its normal texture lies on no triangle that is left"
    note = f"{path.name}: of {len(found.soups)} normal textures one is kept, of the largest part of the surface"
    return NormalTexture(_scaled(pixels, chosen[1]), here), note if len(found.soups) > 1 else ""


class _Found:
    """Triangles by their texture and its scale: corners (k, 3, 3), and places in it there (k, 3, 2)."""

    def __init__(self, file: GltfFile) -> None:
        self._file, self._looks = file, Looks(file)
        self._textures: dict[tuple, tuple[Texture, float]] = {}
        self.soups: dict[tuple[Texture, float], tuple[np.ndarray, np.ndarray]] = {}
        for number, transform in sorted(file.transforms().items()):
            for part in file.mesh(file.document["nodes"][number]).get("primitives", []):
                said = self._said(part)
                if said is not None and part.get("mode", _TRIANGLES) == _TRIANGLES:
                    self._add(part, transform, *said)

    def chosen(self) -> tuple[Texture, float] | None:
        """The texture of the largest area."""

        def area(key: tuple[Texture, float]) -> float:
            a, b, c = np.moveaxis(self.soups[key][0], 1, 0)
            return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

        return max(self.soups, key=area, default=None)

    def _said(self, part: dict) -> tuple[tuple[Texture, float], np.ndarray, int] | None:
        """Texture and scale of a primitive, and the transform (2, 3) and the set of its coordinates."""
        materials = self._file.document.get("materials", [])
        number = part.get("material")
        if not isinstance(number, int) or not 0 <= number < len(materials) or "normalTexture" not in materials[number]:
            return None
        info: dict[str, Any] = materials[number]["normalTexture"]
        where = f"{self._file.path}, material {materials[number].get('name') or number!r}"
        scale = number_of(where, info, "scale", 1.0, 0, MOST_SCALE)
        key = (info["index"], scale)
        if key not in self._textures:
            self._textures[key] = self._looks.texture(where, info, "normalTexture"), scale
        return self._textures[key], *place_of(where, info)

    def _add(self, part: dict, transform: np.ndarray, key: tuple[Texture, float], moved: np.ndarray, texcoord: int):
        attributes, linear = part["attributes"], transform[:3, :3]
        vertices, triangles = self._file.positions([part])
        uv = self._accessor(attributes, f"TEXCOORD_{texcoord}", (len(vertices), 2)) @ moved[:, :2].T + moved[:, 2]
        if not (np.abs(uv) <= MOST_UV).all():
            raise InputError(f"{self._file.path}, TEXCOORD_{texcoord}: allowed are finite numbers up to {MOST_UV:g}")
        corners, places = (vertices @ linear.T + transform[:3, 3])[triangles], uv[triangles]
        before = self.soups.get(key, (corners[:0], places[:0]))
        self.soups[key] = np.concatenate([before[0], corners]), np.concatenate([before[1], places])

    def _accessor(self, attributes: dict, name: str, shape: tuple[int, int]) -> np.ndarray:
        if name not in attributes:
            raise InputError(f"{self._file.path}: a normal texture by {name} found, which a primitive of it lacks")
        values = self._file.accessor(attributes[name]).astype(np.float64)
        if values.shape != shape:
            raise InputError(f"{self._file.path}, {name}: {values.shape} numbers found, {shape} are wanted")
        return values


def _has_area(places: np.ndarray) -> np.ndarray:
    """(k,) whether the coordinates (k, 3, 2) of a triangle say along which directions they grow."""
    u, v = (places[:, k] - places[:, 0] for k in (1, 2))
    longest = np.maximum((u**2).sum(axis=1), (v**2).sum(axis=1))
    return np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) > _FLATTEST * longest


def _repeating(texture: Texture, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pixels, and places in them, of a picture that is repeated, for one that goes on in another way."""
    pixels, places = texture.pixels, places.copy()
    for axis, wrap in ((0, texture.wrap[0]), (1, texture.wrap[1])):
        if wrap == "clamp":
            places[..., axis] = np.clip(places[..., axis], 0, 1)
        if wrap == "mirror":
            pixels = np.concatenate([pixels, np.flip(pixels, 1 - axis)], axis=1 - axis)
            places[..., axis] /= 2
    return pixels, places


def _scaled(pixels: np.ndarray, scale: float) -> np.ndarray:
    """Pixels of at most MOST_SIDE a side, means of those they stand for, whose slopes are multiplied."""
    from PIL import Image

    normals = pixels.astype(np.float64) / 255 * 2 - 1
    normals[..., :2] *= scale
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
    found = np.round((normals + 1) / 2 * 255).astype(np.uint8) if scale != 1 else pixels
    height, width = found.shape[:2]
    if max(height, width) <= MOST_SIDE:
        return found
    smaller = (min(width, MOST_SIDE), min(height, MOST_SIDE))
    return np.asarray(Image.fromarray(found).resize(smaller, Image.Resampling.BOX))
