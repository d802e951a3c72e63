"""The engine's methods on the chart: discretisations, models, sources, solvers, levels, budgets of cycles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base.pass_report import ms_by_pass
from quadgraph_validation.bodies.scene_bakes import Choice
from quadgraph_validation.bodies.scenes import FOV, PIXELS
from quadgraph_validation.chart.chart_body import ChartBody, light_at
from quadgraph_validation.chart.chart_method import (
    SETTLED,
    SWING,
    ChartMethod,
    MethodChain,
    PreparedMethod,
    bake_settings,
    register,
)

if TYPE_CHECKING:
    from quadgraph.core import Engine

_MODELS = {"diffusion": "diffusion", "sp3": "SP₃"}
_MOST_ITERATIONS = 100_000
_FINEST_PUBLISHED = 3  # levels on which the methods that do not converge with refinement are shown


@dataclass
class EngineMethod(PreparedMethod):
    """A way to solve and show, in the words of Engine.solve.

    cycles: 0 for as many as SETTLED takes; choice: how the body is baked, None for the chain that the PDE truth knows.
    """

    method: str = "fem"
    model: str = "sp3"
    source: str = "buried"
    solver: str = "fmg-pcg"
    level: int = 0
    inter_reflection: bool = False
    radiance: str = "gathered"
    cycles: int = 0
    active_layers: int = 0
    choice: Choice | None = None

    @property
    def family(self) -> str:
        """Discretisation, model and source, and whether inter-reflection is computed."""
        if self.method in ("quadgraph-fdm", "polygrid"):
            return f"{self.method}, as published"
        if self.source == "diffuse":
            return f"{self.method}, {_MODELS[self.model]}, published source"
        return f"{self.method}, {_MODELS[self.model]}" + (", inter-reflection" if self.inter_reflection else "")

    @property
    def name(self) -> str:
        """Family, level, and what is not usual."""
        parts = [self.family, *self._bake_words, f"level {self.level}", self.solver]
        parts += [f"{self.cycles} cycle{'s' if self.cycles > 1 else ''} a frame"] if self.cycles else []
        parts += [f"{self.active_layers} layers"] if self.active_layers else []
        parts += ["Lambertian"] if self.radiance == "lambertian" and self._can_gather else []
        parts += ["single scattering"] if self.radiance == "single" else []
        return " · ".join(parts)

    @property
    def settings(self) -> dict[str, Any]:
        """The settings as given, and what frames iterate to."""
        told = {name: value for name, value in asdict(replace(self, _given=None)).items() if name[0] != "_"}
        del told["choice"]
        return told | bake_settings(self.choice) | {"tolerance": None if self.cycles else SETTLED, "runs_on": "device"}

    def prepare(self, body: ChartBody) -> None:
        """Solve for the light two frames ago."""
        first, self._given = self._given is not body, body
        self._engine.set_lights([light_at(body.scene, SWING[0])])
        quickest = {"fem": "fmg-pcg", "polygrid": "cascade", "polygrid-divergence": "cascade"}.get(self.method, "dpcg")
        self._engine.solve(**self._options | {"solver": quickest, "tolerance": SETTLED, "cycles": 0, "bounces": 0})
        if first:
            # A first frame compiles shaders and makes room.
            self.frame(SWING[0])

    def frame(self, step: int) -> dict[str, float]:
        """Light, source walk, warm solve, exitance, picture."""
        self._engine.set_lights([light_at(self._body.scene, step)])
        self._engine.solve(**self._options)
        self._show(next(iter(self._body.scene.views.values())).text, self._body.pixels)
        return ms_by_pass(self._engine.passes)

    def exitance(self) -> np.ndarray:
        """(n_f, 3) W/mm^2."""
        return np.asarray(self._engine.surface_field()["exitance"], np.float64)

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr). Parallel light that crosses the body stays parallel: no camera sees it."""
        found = self._show(self._body.scene.views[view].text, PIXELS)
        shown = np.asarray(found.scattered, np.float64)
        return shown if self._body.scene.direction else shown + np.asarray(found.unscattered, np.float64)

    @property
    def _bake_words(self) -> list[str]:
        if self.choice is None:
            return []
        if self.choice.cells is not None:
            return ["polygrid"]
        return ["default bake" if self.choice.grading is None else f"K = {self.choice.grading:g}"]

    @property
    def _can_gather(self) -> bool:
        return self.method in ("fem", "polygrid", "polygrid-divergence") and self.source == "buried"

    @property
    def _engine(self) -> Engine:
        return self._body.engine(self.level, (self.method, self.model, self.source), self.choice)

    @property
    def _options(self) -> dict[str, Any]:
        names = ("method", "model", "source", "solver", "inter_reflection", "cycles", "active_layers")
        bounces = 1 if self.inter_reflection and self.cycles else 0
        options = {"tolerance": SETTLED, "max_iterations": _MOST_ITERATIONS, "warm": True, "bounces": bounces}
        return {name: getattr(self, name) for name in names} | options

    def _show(self, view: str, pixels: int) -> Any:
        radiance = self.radiance if self._can_gather or self.radiance == "single" else "lambertian"
        return self._engine.render(view=view, vertical_fov=FOV, width=pixels, height=pixels, radiance=radiance)


@register
def engine_methods(chain: MethodChain) -> Iterator[ChartMethod]:
    """Every axis once from the default of each model, not their product."""
    levels = range(len(chain.faces))
    for model in ("sp3", "diffusion"):
        default = EngineMethod(model=model)
        seeing = [level for level in levels if chain.seen is not None and level <= chain.seen]
        yield from (replace(default, level=level) for level in levels)
        yield from (replace(default, level=level, inter_reflection=True) for level in seeing)
        yield from (replace(default, cycles=cycles) for cycles in (1, 2))
        yield from (replace(default, cycles=1, level=1) for _ in levels[1:2])
        yield from (replace(default, cycles=1, inter_reflection=True) for _ in seeing[:1])
        yield replace(default, radiance="lambertian")
        yield replace(default, solver="dpcg")
        yield from (replace(default, method="quadgraph-fv", solver="dpcg", level=level) for level in levels[:2])
    diffusion = EngineMethod(model="diffusion")
    yield from (replace(diffusion, solver=solver) for solver in ("vcycle", "cascade", "jacobi"))
    published = replace(diffusion, source="diffuse")
    yield from (replace(published, level=level) for level in levels[:2])
    fdm = replace(published, method="quadgraph-fdm", solver="cascade")
    yield from (replace(fdm, level=level) for level in levels[:_FINEST_PUBLISHED])
    yield replace(fdm, solver="dpcg")
    for choice in chain.others:
        if choice.cells is not None:
            grid = replace(published, method="polygrid", solver="cascade", choice=choice)
            yield from (grid, replace(grid, active_layers=2), replace(grid, radiance="single"))
            yield replace(diffusion, method="polygrid-divergence", solver="cascade", choice=choice)
            yield replace(diffusion, choice=choice)
            continue
        frame = EngineMethod(inter_reflection=True, cycles=1, choice=choice)
        yield from (frame, replace(frame, cycles=0), replace(frame, model="diffusion"), replace(fdm, choice=choice))
