"""The engine's methods on the chart: discretisations, models, sources, solvers, levels, cycles, corrections."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.base.pass_report import ms_by_pass
from quadgraph_validation.bodies.scene_bakes import Choice
from quadgraph_validation.bodies.scenes import FOV, PIXELS, View
from quadgraph_validation.chart.chart_body import MOTION_SHARE, ChartBody, light_at, view_at
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
_MOTION_FRAMES = 16  # in motion before those that are timed: what they know comes from such frames, not from rest
_FINEST_PUBLISHED = 3  # levels on which the methods that do not converge with refinement are shown


@dataclass
class EngineMethod(PreparedMethod):
    """A way to solve and show, in the words of Engine.solve.

    cycles: 0 for as many as SETTLED takes; sweeps: of the transport equation that correct the solution; motion: frames
    are solved as the window does while something changes, with one cycle and, where they are corrected, one sweep of
    few samples; choice: how the body is baked, None for the chain that the PDE truth knows.
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
    sweeps: int = 0
    motion: bool = False
    choice: Choice | None = None

    @property
    def family(self) -> str:
        """Discretisation, model and source, and whether inter-reflection is computed and the solution corrected."""
        if self.method in ("quadgraph-fdm", "polygrid"):
            return f"{self.method}, as published"
        if self.source == "diffuse":
            return f"{self.method}, {_MODELS[self.model]}, published source"
        more = [", inter-reflection"] * self.inter_reflection + [", corrected"] * (self.sweeps > 0)
        return "".join([f"{self.method}, {_MODELS[self.model]}", *more])

    @property
    def name(self) -> str:
        """Family, level, and what is not usual."""
        parts = [self.family, *self._bake_words, f"level {self.level}", self.solver]
        parts += ["in motion"] if self.motion else self._work_words
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

    @property
    def moves(self) -> bool:
        """With one cycle a frame, which live programs have."""
        return self.cycles == 1 and self.level == 0

    @property
    def noisy(self) -> bool:
        """By the samples of a correction."""
        return self.sweeps > 0

    def prepare(self, body: ChartBody) -> None:
        """Solve for the light of some frames ago, and draw those before the ones that are timed."""
        first, self._given = self._given is not body, body
        before = _MOTION_FRAMES if self.motion else int(first)  # a first frame compiles shaders and makes room
        steps = range(SWING[0], SWING[0] + before)
        self._settle(max(steps, default=SWING[0]), self._share)
        for step in reversed(steps):
            self.frame(step)

    def frame(self, step: int) -> dict[str, float]:
        """Light, source walk, solve, correction, exitance, picture."""
        self._set_light(step, self._share)
        self._engine.solve(**self._options)
        self._show(next(iter(self._body.scene.views.values())).text, self._body.pixels)
        return ms_by_pass(self._engine.passes)

    def exitance(self) -> np.ndarray:
        """(n_f, 3) W/mm^2."""
        return np.asarray(self._engine.surface_field()["exitance"], np.float64)

    def picture(self, view: str) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr). Parallel light that crosses the body stays parallel: no camera sees it."""
        return self._picture(self._body.scene.views[view])

    def begin(self, body: ChartBody, step: float) -> None:
        """Solve for the light of some frames ago, and go on from there."""
        self._given = body
        self._settle(step + _MOTION_FRAMES, MOTION_SHARE)
        for before in reversed(range(_MOTION_FRAMES)):
            self._set_light(step + before, MOTION_SHARE)
            self._engine.solve(**self._options)

    def moving(self, step: float) -> np.ndarray:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr)."""
        self._set_light(step, MOTION_SHARE)
        self._engine.solve(**self._options)
        return self._picture(view_at(self._body.scene, step))

    def at_rest(self, light: float, views: Sequence[float], seed: int) -> list[np.ndarray]:
        """(PIXELS, PIXELS, 3) W/(mm^2 sr) each, of a solve to the tolerance, corrected where frames are."""
        self._settle(light, MOTION_SHARE, seed)
        return [self._picture(view_at(self._body.scene, step)) for step in views]

    @property
    def _bake_words(self) -> list[str]:
        if self.choice is None:
            return []
        if self.choice.cells is not None:
            return ["polygrid"]
        return ["default bake" if self.choice.grading is None else f"K = {self.choice.grading:g}"]

    @property
    def _work_words(self) -> list[str]:
        cycles = [f"{_counted(self.cycles, 'cycle')} a frame"] if self.cycles else []
        return cycles + ([_counted(self.sweeps, "sweep")] if self.sweeps else [])

    @property
    def _can_gather(self) -> bool:
        return self.method in ("fem", "polygrid", "polygrid-divergence") and self.source == "buried"

    @property
    def _engine(self) -> Engine:
        return self._body.engine(self.level, (self.method, self.model, self.source), self.choice)

    @property
    def _options(self) -> dict[str, Any]:
        names = ("method", "model", "source", "solver", "inter_reflection", "cycles", "active_layers", "sweeps")
        bounces = 1 if self.inter_reflection and self.cycles else 0
        options = {"tolerance": SETTLED, "max_iterations": _MOST_ITERATIONS, "bounces": bounces, "motion": self.motion}
        # A warm solve is corrected by the few samples of a frame in motion, however many sweeps are asked for.
        options |= {"correction": self.sweeps > 0, "warm": self.sweeps == 0}
        return {name: getattr(self, name) for name in names} | options

    @property
    def _share(self) -> float:
        return MOTION_SHARE if self.motion else 1.0

    def _set_light(self, step: float, share: float) -> None:
        self._engine.set_lights([light_at(self._body.scene, share * step)])

    def _settle(self, step: float, share: float, seed: int = 0) -> None:
        """Solve as for a body at rest, with the light at a step."""
        self._set_light(step, share)
        quickest = {"fem": "fmg-pcg", "polygrid": "cascade", "polygrid-divergence": "cascade"}.get(self.method, "dpcg")
        settled = {"solver": quickest, "tolerance": SETTLED, "cycles": 0, "bounces": 0, "motion": False}
        self._engine.solve(**self._options | settled | {"sweep_seed": seed})

    def _picture(self, view: View) -> np.ndarray:
        return self._seen(self._show(view.text, PIXELS))

    def _seen(self, found: Any) -> np.ndarray:
        """(n, n, 3) W/(mm^2 sr) of a picture as the truth has it."""
        shown = np.asarray(found.scattered, np.float64)
        return shown if self._body.scene.direction else shown + np.asarray(found.unscattered, np.float64)

    def _show(self, view: str, pixels: int, **more: float) -> Any:
        radiance = self.radiance if self._can_gather or self.radiance == "single" else "lambertian"
        size = {"width": pixels, "height": pixels, "samples": 4}
        return self._engine.render(
            view=view,
            vertical_fov=FOV,
            **size,
            radiance=radiance,
            transmission_roughness=0,  # as the truth has it
            **more,
        )


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number > 1 else ''}"


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
    corrected = EngineMethod(inter_reflection=chain.seen is not None, sweeps=1)
    yield from (corrected, replace(corrected, sweeps=2), replace(corrected, cycles=1, motion=True))
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
        if choice.grading is None:
            yield from (replace(frame, cycles=0, sweeps=1), replace(frame, sweeps=1, motion=True))
