"""The shortest-path method on the chart: as published, and each of our changes to it (docs/shortest-path.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base.pass_report import ms_by_pass
from quadgraph_validation.bodies.scenes import FOV, PIXELS, bounding_sphere
from quadgraph_validation.chart.chart_body import ChartBody, light_at
from quadgraph_validation.chart.chart_method import (
    SWING,
    ChartMethod,
    MethodChain,
    PreparedMethod,
    bake_settings,
    register,
)

if TYPE_CHECKING:
    from quadgraph.core import Engine

_SAMPLES = 96  # points along a side of the grid on which it gets the scene's coefficients


@dataclass
class PathMethod(PreparedMethod):
    """Shortest paths through `cells` voxels along the longest side, in the words of Engine.solve."""

    cost: str = "transport"
    paths: str = "eikonal"
    cells: int = 64

    @property
    def family(self) -> str:
        """All its settings."""
        return "shortest-path"

    @property
    def name(self) -> str:
        """Family and settings."""
        return f"{self.family} · {self.cost} · {self.paths} · {self.cells} cells"

    @property
    def settings(self) -> dict[str, Any]:
        """The settings as given; the method approximates diffusion, and is judged on the faces of level 0."""
        told = {name: value for name, value in asdict(replace(self, _given=None)).items() if name[0] != "_"}
        equations = {"method": "shortest-path", "model": "diffusion", "source": "buried", "solver": self.paths}
        display = {"level": 0, "inter_reflection": False, "radiance": "lambertian", "cycles": 0, "tolerance": None}
        return told | equations | display | bake_settings(None) | {"runs_on": "device"}

    def prepare(self, body: ChartBody) -> None:
        """Give it the coefficients on a grid; a first frame compiles shaders and makes room."""
        if self._given is body:
            return
        self._given = body
        centre, radius = bounding_sphere(body.display)
        axis = np.linspace(-radius, radius, _SAMPLES)
        points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)[..., ::-1] + centre
        values = body.scene.in_channels(points.reshape(-1, 3))
        scattering, absorption = (value.reshape(points.shape).astype(np.float32) for value in values)
        spacing = axis[1] - axis[0]
        self._engine.set_grid(scattering, absorption, (spacing,) * 3, tuple(centre - radius), body.scene.eta)
        self.frame(SWING[0])

    def frame(self, step: int) -> dict[str, float]:
        """Shadow maps, voxels, cost, light, paths, picture."""
        self._engine.set_lights([light_at(self._body.scene, step)])
        self._engine.solve(method="shortest-path", path_cost=self.cost, path_solver=self.paths, path_cells=self.cells)
        self._show(next(iter(self._body.scene.views.values())).text, self._body.pixels)
        return ms_by_pass(self._engine.passes)

    def exitance(self) -> np.ndarray:
        """(n_f, 3) W/mm^2, at the middles of the faces of level 0."""
        sections = self._body.file.sections
        return self._engine.exitance_at(sections["level0/vertices"][sections["level0/faces"]].mean(axis=1))

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr)."""
        return np.asarray(self._show(self._body.scene.views[view].text, PIXELS).scattered, np.float64)

    @property
    def _engine(self) -> Engine:
        return self._body.engine(0, ("shortest-path",))

    def _show(self, view: str, pixels: int) -> Any:
        size = {"width": pixels, "height": pixels, "samples": 4}
        return self._engine.render(view=view, vertical_fov=FOV, **size, radiance="lambertian")


@register
def path_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """Methods as published and as implemented here, each change alone, and finer and coarser voxels."""
    yield from (PathMethod(cost, paths) for cost in ("transport", "extinction") for paths in ("eikonal", "lattice"))
    yield from (PathMethod(cells=cells) for cells in (32, 96))
