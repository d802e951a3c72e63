"""The dipole on the chart: a matrix from the irradiance of the faces to the exitance of the vertices, by numpy."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph_validation.chart.chart_body import ChartBody, light_at
from quadgraph_validation.chart.chart_method import (
    SWING,
    ChartMethod,
    MethodChain,
    PreparedMethod,
    bake_settings,
    register,
)
from quadgraph_validation.chart.dipole import Dipole, transport

if TYPE_CHECKING:
    from quadgraph.core import Engine

_MOST_BYTES = 256 << 20  # of the matrix of one channel
_LIGHT = ("shadow maps", "irradiance")
_PICTURE = ("visibility", "coverage", "shading")


@dataclass
class DipoleMethod(PreparedMethod):
    """The dipole on the surface of a level, its matrix kept from frame to frame, as long as the material stays.

    Light and picture are the engine's, and so is their time; the product is timed as numpy does it on the CPU.
    """

    level: int
    name: str = ""
    family: str = "dipole per vertex"
    _matrices: list[np.ndarray] = field(default_factory=list, repr=False)
    _exitance: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)), repr=False)

    def __post_init__(self) -> None:
        self.name = self.name or f"{self.family} · level {self.level} · numpy"

    @property
    def settings(self) -> dict[str, Any]:
        """The settings as given; the model is the one that the dipole solves in a half-space."""
        told = {
            "method": "dipole",
            "model": "diffusion",
            "source": "buried",
            "solver": "matrix",
            "level": self.level,
        }
        told |= bake_settings(None) | {
            "inter_reflection": False,
            "radiance": "lambertian",
            "cycles": 0,
            "tolerance": None,
        }
        return told | bake_settings(None) | {"runs_on": "CPU (numpy); light and picture on the device"}

    def prepare(self, body: ChartBody) -> None:
        """Make the matrix, and an engine that has something to show."""
        if self._given is not body:
            self._given = body
            self._engine.set_lights([light_at(body.scene, SWING[0])])
            self._engine.solve(method="fem", model="diffusion", source="diffuse", inter_reflection=False)
            self._matrices = self._make()
            self.frame(SWING[0])

    def frame(self, step: int) -> dict[str, float]:
        """Irradiance, product, picture."""
        engine, scene = self._engine, self._body.scene
        engine.set_lights([light_at(scene, step)])
        engine.update_irradiance()
        q = np.asarray(engine.surface_field()["q"], np.float32)
        start = time.perf_counter()
        found = [matrix @ q[:, c] for matrix, c in zip(self._by_channel(), range(3), strict=True)]
        product = 1e3 * (time.perf_counter() - start) * len(self._matrices) / 3
        self._exitance = np.column_stack(found).astype(np.float64)
        view, pixels = next(iter(scene.views.values())).text, self._body.pixels
        engine.render(view=view, width=pixels, height=pixels, samples=4, radiance="lambertian")
        passes = {p["name"]: p["time_ms"] for p in engine.passes if p["name"] in (*_LIGHT, *_PICTURE)}
        return passes | {"dipole": product}

    def exitance(self) -> np.ndarray:
        """(n_f, 3) W/mm^2: of each face, the mean of its corners."""
        return self._exitance[self._faces].mean(axis=1)

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr), as from a diffuser, on the display mesh."""
        shown = self._body.level_display(self.level)
        values = np.einsum("ik,ikc->ic", shown.barycentric, self._exitance[self._faces[shown.face]])
        return self._body.hits(view).lambertian(self._body.display.triangles, values, self._body.scene.eta)

    @property
    def _engine(self) -> Engine:
        return self._body.engine(self.level, ("fem", "diffusion", "diffuse"))

    @property
    def _faces(self) -> np.ndarray:
        return self._body.file.sections[f"level{self.level}/faces"]

    def _by_channel(self) -> list[np.ndarray]:
        """One matrix per channel; the same three times where the scene is grey."""
        return self._matrices * (3 // len(self._matrices))

    def _make(self) -> list[np.ndarray]:
        faces = self._faces
        vertices = self._body.file.sections[f"level{self.level}/vertices"][: faces.max() + 1].astype(np.float64)
        scene, corners = self._body.scene, vertices[faces]
        channels = range(3 if scene.coloured else 1)
        sigma_s_prime, sigma_a = scene.in_channels(vertices)
        media = (Dipole(sigma_s_prime[:, c], sigma_a[:, c], scene.eta) for c in channels)
        return [transport(medium, vertices, corners) for medium in media]


@register
def dipole_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """On every level whose matrix is not too large: a closed surface has half as many vertices as faces."""
    for level, faces in enumerate(chain.faces):
        if faces * (faces // 2 + 2) * 4 <= _MOST_BYTES:
            yield DipoleMethod(level)
