"""A scene that turns: its camera, or its lights, about the axis that points up through the middle of the picture."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from quadgraph.commands import converging, picture_output, scene_options, turning
from quadgraph.core import load_core

if TYPE_CHECKING:
    from quadgraph.core import Picture, SceneFile, Stage


class SceneTurn:
    """A stage that shows a scene from any side of a turn, and solves only where the light has changed."""

    def __init__(self, stage: Stage, file: SceneFile, turns: str) -> None:
        """Show the first frame of a file; turns: one of `turning.kinds`. Raises InputError, FormatError."""
        self.report: dict[str, Any] = {}
        self._stage = stage
        stage.show(file.at(0))
        scene = json.loads(file.at(0).json())
        if turns != "light" and scene["camera"]["framing"] == "auto":
            scene["camera"]["framing"] = "turned"
        self._scene = scene
        self._angles = turning.kinds()[turns]
        self._middle = _middle(scene["camera"], turning.middle(stage.engine))
        self._solved: float | None = None
        self._exposure = scene["picture"]["exposure"]
        scene_options.tell_map(stage.map_report)

    @property
    def engine(self) -> Any:
        """That of the stage."""
        return self._stage.engine

    @property
    def wants_exposure(self) -> bool:
        """Whether the exposure is to be found from pictures."""
        return bool(self._exposure == "auto")

    def expose(self, stops: float) -> None:
        """Show all pictures by one exposure."""
        self._exposure = stops

    def auto_exposure(self, picture: Picture) -> float:
        """The exposure that a picture would have by itself, stops."""
        return float(picture.auto_exposure(self._tone()))

    def at(self, degrees: float, share: float = 1.0) -> Picture:
        """The picture when it has turned so far, with a share of its width and height."""
        of_camera, of_lights = self._angles(degrees)
        scene = self._scene
        up = scene["camera"]["up"]
        picture = dict(scene["picture"])
        if share != 1:
            picture |= {side: max(16, int(share * picture[side])) for side in ("width", "height")}
        lights = turning.lights_of_scene(scene["lights"], up, of_lights, self._middle)
        camera = _turned(scene["camera"], of_camera)
        turned = scene | {"camera": camera, "lights": lights, "picture": picture}
        self._stage.show(load_core().scene_file(json.dumps(turned)).at(0))
        if self._solved != of_lights:
            self.report = self._stage.solve()
            self._solved = of_lights
        made = self._stage.render(told=converging.tell)
        scene_options.check_validation(self._stage.engine)
        return made

    def shown(self) -> picture_output.Shown:
        """How its pictures become files."""
        return picture_output.shown(self._stage.engine, self._tone())

    def _tone(self) -> str:
        return json.dumps({"picture": self._scene["picture"] | {"exposure": self._exposure}})


def _middle(camera: dict[str, Any], centre: np.ndarray) -> np.ndarray:
    """What the middle of the picture shows, mm in the coordinates of the body; centre: that of its box."""
    if "look_at" in camera:
        return np.array(camera["look_at"], float)
    return centre + np.array(camera.get("target", (0.0, 0.0, 0.0)))


def _turned(camera: dict[str, Any], degrees: float) -> dict[str, Any]:
    """The camera of a scene gone around the middle of its picture."""
    if "eye" not in camera:
        return camera | {"azimuth": (camera["azimuth"] + degrees) % 360}
    eye, middle = np.array(camera["eye"]), np.array(camera["look_at"])
    return camera | {"eye": (middle + turning.rotation(camera["up"], degrees) @ (eye - middle)).tolist()}
