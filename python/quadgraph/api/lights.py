"""Lights, in physical units. docs/lights.md tells how the engine follows each; W are per channel."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal

from quadgraph import core
from quadgraph.api.values import RGB, Value, Vector


@dataclass(frozen=True, repr=False)
class Light(Value):
    """Base of all lights. Where one is wanted, the text that --light takes does as well.

    Numbers are checked by the engine, when the light is set: InputError names the member and what is allowed.
    """

    @staticmethod
    def parse(text: str) -> Light:
        """Return the light of a text as --light takes it, with all members. Raises InputError."""
        return light_from(json.loads(core.light_json(text)))

    @property
    def text(self) -> str:
        """The text as --light takes it. Raises InputError for numbers that are not allowed."""
        return core.light_text(json.dumps(self.to_dict()))


@dataclass(frozen=True, repr=False)
class DirectionalLight(Light):
    """Parallel light. direction: the way it travels; irradiance: W/mm^2 on a plane that faces it."""

    type: ClassVar[str] = "directional"
    direction: Vector
    irradiance: RGB


@dataclass(frozen=True, repr=False)
class PointLight(Light):
    """Isotropic light from a point: power / (4 pi d^2) at distance d. position: mm; power: W."""

    type: ClassVar[str] = "point"
    position: Vector
    power: RGB


@dataclass(frozen=True, repr=False)
class AmbientLight(Light):
    """Uniform light from all sides that the body does not hide. irradiance: W/mm^2."""

    type: ClassVar[str] = "ambient"
    irradiance: RGB


@dataclass(frozen=True, repr=False)
class SpotLight(Light):
    """A cone of light. position: mm; direction: of its axis, the way the light travels; power: W in the whole cone.

    angle: degrees from the axis to where it ends, above 0, at most 90; edge: share of the angle over which it fades.
    """

    type: ClassVar[str] = "spot"
    position: Vector
    direction: Vector
    angle: float
    power: RGB
    edge: float | None = None


@dataclass(frozen=True, repr=False)
class RectangleLight(Light):
    """A rectangle of uniform radiance power / (pi |u x v|) on the side to which u x v points.

    centre: mm; u, v: its edges, mm; power: W.
    """

    type: ClassVar[str] = "rectangle"
    centre: Vector
    u: Vector
    v: Vector
    power: RGB


@dataclass(frozen=True, repr=False)
class ProjectorLight(Light):
    """An image thrown on the body. position: mm; direction: of its axis; up: to the image's top.

    angle: degrees, height of the image as seen from there, above 0, below 170; file: .png (decoded from sRGB), .exr or
    .hdr; power: W if it is white all over.
    """

    type: ClassVar[str] = "projector"
    position: Vector
    direction: Vector
    angle: float
    file: str | Path
    power: RGB
    up: Vector | None = None


@dataclass(frozen=True, repr=False)
class EnvironmentLight(Light):
    """All that is around, a picture by longitude and latitude. file: .exr or .hdr, or "studio", which is built in.

    radiance: W/(mm^2 sr) of what is 1 in it; turn: degrees counter-clockwise about `up`. At 0 the middle of the picture
    is behind the object as seen from azimuth 0.
    """

    type: ClassVar[str] = "environment"
    file: str | Path
    radiance: RGB
    turn: float | None = None
    up: Literal["y", "z"] | None = None


LIGHTS: dict[str, type[Light]] = {
    kind.type: kind
    for kind in (
        DirectionalLight,
        PointLight,
        AmbientLight,
        SpotLight,
        RectangleLight,
        ProjectorLight,
        EnvironmentLight,
    )
}


def light_from(members: dict[str, Any]) -> Light:
    """Return the light with the members of a scene file's object."""
    others = {name: value for name, value in members.items() if name != "type"}
    return LIGHTS[members["type"]](**others)


def as_light(light: Light | str) -> Light:
    """Return a light, parsed if it is a text. Raises InputError."""
    return Light.parse(light) if isinstance(light, str) else light


def default_lights(view: str = "", up: Literal["y", "z"] = "y", front: float = 0.0) -> tuple[Light, ...]:
    """Return the lamps, which light what is no picture and what nobody lit.

    A warm key light from behind the object, a cool one from the side, a little ambient light. view:
    azimuth,elevation[,distance] in degrees and mm; without one the azimuth `front`, degrees. Raises InputError.
    """
    return tuple(map(Light.parse, core.default_lights(view, up, front)))
