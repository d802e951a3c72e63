"""Meshes with their colours: parts of one look each, and the linear colour at any place of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph.mesh.looks.texture import MOST_UV, Texture


@dataclass(frozen=True)
class StatedMedium:
    """What a file says of the inside of a part: sigma_s_prime, sigma_a, (3,) each, per unit of the file's lengths."""

    sigma_s_prime: tuple[float, float, float]
    sigma_a: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Look:
    """A material of a file.

    colour: (3,) linear, which multiplies that of texture and vertices; medium: where the file states one; eta:
    refractive index, roughness: GGX alpha, both None where the file says nothing of them.
    """

    name: str = ""
    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    texture: Texture | None = None
    medium: StatedMedium | None = None
    eta: float | None = None
    roughness: float | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """Triangles with one look, in the file's coordinates.

    vertices: (n, 3); triangles: (m, 3); colours: (n, 3) linear RGB at the vertices; uv: (n, 2), v downwards from the
    first row of the texture.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    look: Look
    colours: np.ndarray | None = None
    uv: np.ndarray | None = None

    @property
    def coloured(self) -> bool:
        """Whether its colour differs from place to place."""
        return self.colours is not None or self.look.texture is not None

    def colour_at(self, triangle: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Linear RGB (k, 3) in triangles (k,) at barycentric weights (k, 3)."""
        found = np.broadcast_to(np.asarray(self.look.colour, np.float64), (len(triangle), 3)).copy()
        corners = self.triangles[triangle]
        if self.colours is not None:
            found *= np.einsum("kc,kcj->kj", weights, self.colours[corners])
        if self.look.texture is not None and self.uv is not None:
            found *= self.look.texture.at(np.einsum("kc,kcj->kj", weights, self.uv[corners]))
        return found

    def check(self, where: str) -> Part:
        """This part, unless its colours or coordinates are no numbers or too large: InputError."""
        if self.uv is not None:
            bad = np.flatnonzero(~(np.abs(self.uv) <= MOST_UV).all(axis=1))
            if len(bad):
                raise InputError(
                    f"{where}, texture coordinate {bad[0]}: {self.uv[bad[0]].tolist()} found, allowed are finite "
                    f"numbers up to {MOST_UV:g}; unwrap it again"
                )
        if self.colours is not None:
            bad = np.flatnonzero(~((self.colours >= 0) & (self.colours <= 1)).all(axis=1))
            if len(bad):
                raise InputError(f"{where}, colour {bad[0]}: {self.colours[bad[0]].tolist()} found, allowed are 0 to 1")
        return self


@dataclass(frozen=True, eq=False)
class ColouredMesh:
    """All parts of a file; notes: what of it was left out, in sentences; files: those beside it that were read."""

    parts: list[Part]
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)

    @cached_property
    def vertices(self) -> np.ndarray:
        """Of all parts, (n, 3), in the file's coordinates."""
        return np.concatenate([part.vertices for part in self.parts])

    @cached_property
    def triangles(self) -> np.ndarray:
        """Of all parts, (m, 3), in their order."""
        offsets = _begins(len(part.vertices) for part in self.parts)
        return np.concatenate([part.triangles + offset for part, offset in zip(self.parts, offsets, strict=False)])

    @cached_property
    def begins(self) -> np.ndarray:
        """Where the triangles of each part begin, and their count."""
        return _begins(len(part.triangles) for part in self.parts)

    def part_of(self, triangle: np.ndarray) -> np.ndarray:
        """The part of each of (k,) triangles."""
        return np.searchsorted(self.begins, triangle, side="right") - 1

    def colour_at(self, triangle: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Linear RGB (k, 3) in triangles (k,) at barycentric weights (k, 3)."""
        found, part_of = np.empty((len(triangle), 3)), self.part_of(triangle)
        for number, part in enumerate(self.parts):
            rows = np.flatnonzero(part_of == number)
            if len(rows):
                found[rows] = part.colour_at(triangle[rows] - self.begins[number], weights[rows])
        return found

    def check(self, path: Path) -> ColouredMesh:
        """This mesh, unless it has no triangles or says nothing of colour: InputError."""
        self.parts[:] = [part for part in self.parts if len(part.triangles)]
        if not self.parts:
            raise InputError(f"{path}: no triangles found, a mesh with colours is wanted")
        if not any(part.coloured or part.look.name or part.look.medium for part in self.parts):
            raise InputError(
                f"{path}: no colours found; a texture, colours at the vertices or a material is wanted: write it as "
                ".glb with its materials"
            )
        return self


def _begins(counts: Iterable[int]) -> np.ndarray:
    return np.cumsum([0, *counts])
