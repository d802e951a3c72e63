"""A scene as a value, and its file, which may change it from frame to frame (docs/scene.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from quadgraph import core
from quadgraph.api.deformers import Deformer, Twist, as_dict, deformer_from, in_memory
from quadgraph.api.lights import Light, as_light, light_from
from quadgraph.api.materials import Material
from quadgraph.api.options import Camera, PictureOptions, SolveOptions
from quadgraph.api.values import plain_members
from quadgraph.base.errors import InputError

_STILL = Twist(0).to_dict()


@dataclass(frozen=True)
class Scene:
    """All that is shown. body: a baked .qgraph; what is None or left out is as in a scene file.

    material: a `Material` or a text as --material takes it; materials: of bodies by their names, where the file has
    several; placements: {"position": mm, "rotation": degrees} of bodies by their names, where they are put from where
    they lie in the file; lights: None for the studio, and the ground with it, [] for darkness; edits, or layers of
    them, and cuts: objects as scene files have them. Raises InputError naming the member and what is allowed.
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
    materials: Mapping[str, Material | str] = field(default_factory=dict)
    placements: Mapping[str, Mapping[str, Sequence[float]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check. Raises InputError."""
        core.check_scene(json.dumps(self._nameable()))

    def to_dict(self) -> dict[str, Any]:
        """Return the content of a scene file that shows this. Raises InputError for shapes in memory."""
        if self._in_memory:
            raise InputError(
                "deformation: shapes in memory, which a scene file cannot hold: show the scene on a Stage, or name a "
                ".qshapes file (quadgraph shapes makes them)"
            )
        return self._nameable()

    @property
    def _in_memory(self) -> bool:
        return any(map(in_memory, self.deformation))

    def _nameable(self) -> dict[str, Any]:
        """The content of a scene file, with steps that move nothing in place of those with shapes in memory."""
        document: dict[str, Any] = {"body": str(self.body)}
        if self.material is not None:
            document["material"] = _text(self.material)
        if self.materials:
            document["materials"] = {name: _text(material) for name, material in self.materials.items()}
        if self.placements:
            document["placements"] = plain_members(self.placements)
        if self.lights is not None:
            document["lights"] = [as_light(light).to_dict() for light in self.lights]
        document["deformation"] = [_STILL if in_memory(step) else as_dict(step) for step in self.deformation]
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

    def _compiled(self) -> core.Scene:
        """This value as the compiled engine holds it. Raises FormatError, InputError."""
        scene = core.scene_file(json.dumps(self._nameable())).at(0)
        return scene.with_deformation(list(map(as_dict, self.deformation))) if self._in_memory else scene


def _text(material: Material | str) -> str:
    return material.text if isinstance(material, Material) else material


class SceneFile:
    """A scene that may change from frame to frame."""

    def __init__(self, source: str | Path | Scene) -> None:
        """Read a file, or hold a scene that does not change.

        The body is looked for at once, beside the file or from the working directory. Raises FormatError, and
        InputError naming file, path into it, what was found and what is allowed.
        """
        if isinstance(source, Scene):
            self._file = core.scene_file(json.dumps(source._nameable()))
            self._scene = source if source._in_memory else None
        else:
            self._scene = None
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
        scene = Scene.from_dict(json.loads(self._file.at(frame).json()))
        return replace(scene, deformation=self._scene.deformation) if self._scene else scene

    def set(self, pointer: str, value: object) -> None:
        """Put a value at a JSON pointer, e.g. set("/camera/fov", 40); a track that changes it is left out.

        Raises InputError, and changes nothing, for what is not allowed, for a part of what a track changes as a whole,
        and for a deformation by shapes in memory.
        """
        if self._scene and pointer.startswith("/deformation"):
            self._scene.to_dict()
        self._file.set(pointer, json.dumps(value))

    def save(self, path: str | Path) -> None:
        """Write the file at once. Raises InputError, also for shapes in memory."""
        if self._scene:
            self._scene.to_dict()
        self._file.save(Path(path))
