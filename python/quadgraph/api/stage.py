"""An engine that shows one scene after the other."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self, TypeAlias

import numpy as np

from quadgraph import core
from quadgraph.api.engine import Engine
from quadgraph.api.picture import Picture
from quadgraph.api.scene import Scene, SceneFile
from quadgraph.api.solution import Solution
from quadgraph.base.array_types import Doubles
from quadgraph.base.errors import InputError

Gesture: TypeAlias = Literal["orbit", "pan", "zoom", "turn"]


class Stage:
    """Shows scenes on a device, and sets only what differs from one to the next. Use it in a `with` block."""

    def __init__(self, *, device: str = "", validation: bool = False) -> None:
        """Choose a device: cpu, or part of a Vulkan device's name; default: a GPU, else cpu. validation: load the
        validation layer of a Vulkan device.
        """
        self._stage: core.Stage | None = core.Stage(device, validation)
        self._engine: Engine | None = None
        self._scene: Scene | None = None

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close."""
        self.close()

    def __repr__(self) -> str:
        """Return what is shown, in one line."""
        return "Stage(closed)" if self._stage is None else f"Stage({self._engine or 'no scene is shown'})"

    def close(self) -> None:
        """Free the device's memory; whatever is asked afterwards raises InputError."""
        self._forget()
        self._stage = None

    def _forget(self) -> None:
        if self._engine is not None:
            self._engine.close()
        self._engine, self._scene = None, None

    @property
    def _open(self) -> core.Stage:
        if self._stage is None:
            raise InputError("the stage is closed")
        return self._stage

    @property
    def scene(self) -> Scene | None:
        """The scene that is shown, with all members filled in; None before the first."""
        return self._scene

    @property
    def engine(self) -> Engine:
        """The engine that shows the scene; closed where another body is shown. Raises InputError before the first."""
        if self._engine is None:
            raise InputError("no scene is shown")
        return self._engine

    def show(self, scene: Scene | SceneFile | str | Path, frame: float = 0) -> None:
        """Show a scene, or a frame of a scene file. Raises FormatError, InputError, DeviceError."""
        file = scene if isinstance(scene, SceneFile) else SceneFile(scene)
        wanted = file.at(frame)
        if self._scene is None or self._scene.body != wanted.body:
            self._forget()
        self._open.show(wanted._compiled())
        shapes = [(scene.deformation, scene.placements) for scene in (self._scene, wanted) if scene is not None]
        moved = shapes[0] != shapes[-1]
        self._scene = wanted
        if self._engine is not None and moved:
            self._engine._solution = None
        if self._engine is None:
            self._engine = Engine._around(self._open.engine, Path(wanted.body).name)

    def moved(self, gesture: Gesture, right: float, up: float, light: int = 0) -> Scene:
        """Return the scene that is shown after a hand moved its camera, or turned one of its lights, as in the window.

        right, up: degrees of orbit and turn, shares of the picture's height of pan, and `up` steps nearer, an eighth of
        the distance each, of zoom. Show it to see it. Raises InputError for another gesture, for a light that is not
        there, and before the first scene.
        """
        document = json.loads(self._open.after_gesture(gesture, right, up, light))
        moved = Scene.from_dict(document)
        return replace(moved, deformation=self._scene.deformation) if self._scene else moved

    def body_at(self, x: float, y: float) -> str | None:
        """Return the name of the body that the scene's picture shows at (x, y), as `Engine.body_at`.

        Raises InputError.
        """
        return core.stage_body_at(self._open, float(x), float(y))

    def painted(
        self, brush: Mapping[str, Any], places: Sequence[tuple[float, float]], *, begins: bool = True
    ) -> tuple[Scene, dict[str, Any]]:
        """Return the scene that is shown after a brush went over places of its picture, pixels right and down from its
        corner, at most 64 at once, as in the window; `begins`: a stroke begins, else the last one goes on there.

        brush: `usual_brush` with other values, "tool" paint, erase or pick, "mirror" one of `mirrors`, and the number
        of a "layer", from 0; the first stroke of a scene without layers makes one. It may have "depth_from", mm; "mask"
        and "pattern", images' files that it stamps, where it is led to, as wide as the radius to either side; and in
        place of colour, distance and strength "coefficients": {"operation": "multiply", "sigma_a": .5,
        "sigma_s_prime": 2}, as an edit of a scene (docs/scene.md) has these. Returned beside the scene:
        "touched", whether the first place lies on a body, the "layer", and "colour" and "distance" of the brush, which
        `pick` takes up. Show the scene to see it. Raises InputError, also for a layer that is hidden.
        """
        return self._edited(core.after_brush(self._open, _brush_text(brush), list(places), begins))

    def brush_rings(self, brush: Mapping[str, Any], place: tuple[float, float]) -> list[Doubles]:
        """Return rings, (48, 2) pixels, that show how far a brush reaches at a place of the picture of the scene that
        is shown: on the body, and where the mirror image is seen. None beside the body. Raises InputError.
        """
        return [np.array(ring) for ring in core.brush_rings(self._open, _brush_text(brush), *map(float, place))]

    def relayered(self, change: Mapping[str, Any]) -> tuple[Scene, dict[str, Any]]:
        """Return the scene that is shown after a change of its layers: {"layer": 0, "change": "add"}, and alike remove,
        up, down, and with a "value" name, visible, opacity; and the number of the "layer" then. Raises InputError.
        """
        return self._edited(core.after_layer(self._open, json.dumps(dict(change))))

    def _edited(self, told: str) -> tuple[Scene, dict[str, Any]]:
        state = json.loads(told)
        edits = state.pop("edits")
        if self._scene is None:
            raise InputError("no scene is shown")
        return replace(self._scene, edits=edits), state

    @property
    def usual_brush(self) -> dict[str, Any]:
        """The brush that a body of this size has at first: "tool", "colour" (linear), "distance" that light goes in it,
        "radius", "depth" and "falloff", mm, "strength" 0 to 1, "mirror" off. Raises InputError before the first scene.
        """
        brush: dict[str, Any] = json.loads(core.usual_brush(self._open))
        return brush

    @property
    def mirrors(self) -> dict[str, str]:
        """What "mirror" of a brush may be: off, or an axis across which it paints both sides, and what a user calls
        these sides of the body. Raises InputError before the first scene.
        """
        return core.mirrors_of_body(self._open)

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods that the body's file has levels for. Raises InputError before the first scene."""
        return tuple(core.methods_of_body(self._open))

    def solve(self) -> Solution:
        """Solve with the scene's options. Raises InputError, SolverError."""
        return self.engine._take(self._open.solve())

    def render(self) -> Picture:
        """Return a picture with the scene's camera and options. Raises InputError before a solve."""
        shown, layers = self.engine._engine, self._open.render()
        if layers.convergence:
            self.engine._take(layers.convergence["solve"])
        return Picture(layers, shown.metadata, dict(self._scene.picture) if self._scene else {})


def _brush_text(brush: Mapping[str, Any]) -> str:
    return json.dumps(dict(brush), default=os.fspath)
