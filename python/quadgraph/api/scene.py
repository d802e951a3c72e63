"""A scene as a value, and its file, which may change it from frame to frame (docs/scene.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from quadgraph import core
from quadgraph.api.deformers import Deformer, as_dict, deformer_from
from quadgraph.api.engine import plain_members
from quadgraph.api.lights import Light, as_light, light_from
from quadgraph.api.materials import Material
from quadgraph.api.options import Camera, PictureOptions, SolveOptions


@dataclass(frozen=True)
class Scene:
    """All that is shown. body: a baked .qgraph; what is None or left out is as in a scene file.

    material: a `Material` or a text as --material takes it; lights: None for `default_lights` of the camera, [] for
    darkness; edits and cuts: objects as scene files have them. Raises InputError naming the member and what is allowed.
    """

    body: str | Path
    material: Material | str | None = None
    lights: Sequence[Light | str] | None = None
    edits: Sequence[Mapping[str, Any]] = ()
    deformation: Sequence[Deformer | Mapping[str, Any]] = ()
    cuts: Sequence[Mapping[str, Any]] = ()
    camera: Camera = field(default_factory=lambda: Camera())
    solver: SolveOptions = field(default_factory=lambda: SolveOptions())
    picture: PictureOptions = field(default_factory=lambda: PictureOptions())

    def __post_init__(self) -> None:
        """Check. Raises InputError."""
        core.check_scene(json.dumps(self.to_dict()))

    def to_dict(self) -> dict[str, Any]:
        """Return the content of a scene file that shows this."""
        document: dict[str, Any] = {"body": str(self.body)}
        if self.material is not None:
            document["material"] = self.material.text if isinstance(self.material, Material) else self.material
        if self.lights is not None:
            document["lights"] = [as_light(light).to_dict() for light in self.lights]
        document["deformation"] = [plain_members(as_dict(step)) for step in self.deformation]
        document |= {name: list(map(plain_members, getattr(self, name))) for name in ("edits", "cuts")}
        return document | {name: plain_members(getattr(self, name)) for name in ("camera", "solver", "picture")}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Self:
        """Return the scene of a scene file's content, apart from what changes in it. Raises InputError."""
        members = {name: document[name] for name in cls.__dataclass_fields__ if name in document}
        core.check_scene(json.dumps(members))
        if "lights" in members:
            members["lights"] = tuple(map(light_from, members["lights"]))
        if "deformation" in members:
            members["deformation"] = tuple(map(deformer_from, members["deformation"]))
        return cls(**members)


class SceneFile:
    """A scene that may change from frame to frame."""

    def __init__(self, source: str | Path | Scene) -> None:
        """Read a file, or hold a scene that does not change.

        The body is looked for at once, beside the file or from the working directory. Raises FormatError, and
        InputError naming file, path into it, what was found and what is allowed.
        """
        if isinstance(source, Scene):
            self._file = core.scene_file(json.dumps(source.to_dict()))
        else:
            self._file = core.SceneFile(Path(source))

    @property
    def frames(self) -> int:
        """How many frames it has."""
        return self._file.frames

    @property
    def frames_per_second(self) -> float:
        """How quickly a film shows them."""
        return self._file.frames_per_second

    def at(self, frame: float) -> Scene:
        """Return the scene of a frame, which need not be whole, with all members filled in. Raises InputError."""
        return Scene.from_dict(json.loads(self._file.at(frame).json()))

    def set(self, pointer: str, value: object) -> None:
        """Put a value at a JSON pointer, e.g. set("/camera/fov", 40). Raises InputError, and changes nothing."""
        self._file.set(pointer, json.dumps(value))

    def save(self, path: str | Path) -> None:
        """Write the file at once. Raises InputError."""
        self._file.save(Path(path))
