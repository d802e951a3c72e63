"""What a capture.json says: a body and its pose, cameras, lights, and photographs of it (docs/acquisition.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph import core
from quadgraph.acquisition.capture.strict_json import Member
from quadgraph.base import json_text
from quadgraph.base.errors import InputError
from quadgraph.base.regular_file import read_bytes
from quadgraph.base.units import UNITS_MM

VERSION = 1
MOST_PHOTOGRAPHS, MOST_SIDE = 1024, 4096
MOST_PIXELS = 50_000_000  # of all photographs together
_LARGEST = 1e15  # of any number, as of the power of lights
_FIXED = ("correction", "error", "cycles", "method", "source", "path")  # of the solver: what acquire itself decides


@dataclass(frozen=True)
class NoiseModel:
    """Variance of a pixel of value v: read_out^2 + shot * max(v, 0), in the units of the photograph's values."""

    read_out: float
    shot: float


@dataclass(frozen=True)
class Photograph:
    """One photograph as the capture states it.

    path: into the capture, as errors say it; camera, lights: names; exposure: what its values are times the radiance in
    W/(mm^2 sr), apart from the gain; gain: a known factor, or the name of those that share an unknown one; saturation:
    values from there on are left out; noise: a model, or a file of variances; mask: a file, black where pixels are left
    out.
    """

    path: str
    file: Path
    camera: str
    lights: tuple[str, ...]
    exposure: float
    gain: float | str
    saturation: float | None
    noise: NoiseModel | Path
    mask: Path | None


@dataclass(frozen=True)
class Capture:
    """A whole capture. body: a .qgraph, or a mesh of this unit or height; deformation, lights, cameras and solver as a
    scene file has them; sizes: pixels of each camera, width and height; polarised: whether crossed polarisers took what
    the surface reflects away.
    """

    path: Path
    body: Path
    unit: str | None
    height_mm: float | None
    eta: float
    deformation: list[Any]
    cameras: Mapping[str, dict[str, Any]]
    sizes: Mapping[str, tuple[int, int]]
    lights: Mapping[str, dict[str, Any]]
    solver: dict[str, Any]
    polarised: bool
    photographs: tuple[Photograph, ...]

    def files(self) -> list[Path]:
        """All files that it names, and its own."""
        found = [self.path, self.body]
        for photograph in self.photographs:
            found += [photograph.file, *([photograph.mask] if photograph.mask else [])]
            found += [photograph.noise] if isinstance(photograph.noise, Path) else []
        return found + [Path(light["file"]) for light in self.lights.values() if "file" in light]


def read(path: Path) -> Capture:
    """Read and check a capture; no photograph is opened.

    Raises InputError naming the file, the path into it, what was found, what is allowed and the next step.
    """
    try:
        text = read_bytes(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    try:
        document = json_text.loads(text)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return _capture(path, Member(str(path), "", document))


def _capture(path: Path, document: Member) -> Capture:
    required = ("quadgraph_capture", "body", "eta", "cameras", "lights", "photographs")
    members = document.members(required, ("unit", "height", "deformation", "solver", "polarised"))
    members["quadgraph_capture"].whole(VERSION, VERSION, "the version of this format")
    folder = path.parent
    cameras = {name: _camera(each) for name, each in members["cameras"].named().items()}
    lights = {name: light(each, folder) for name, each in members["lights"].named().items()}
    photographs = tuple(
        _photograph(each, folder, cameras, lights) for each in members["photographs"].items(MOST_PHOTOGRAPHS)
    )
    pixels = sum(cameras[each.camera][1][0] * cameras[each.camera][1][1] for each in photographs)
    if pixels > MOST_PIXELS:
        raise InputError(
            f"{path}: photographs: found {pixels} pixels in all, allowed are {MOST_PIXELS}; scale the photographs "
            "down, which costs homogeneous coefficients nothing"
        )
    polarised = members.get("polarised")
    if polarised is not None and not isinstance(polarised.value, bool):
        polarised.wrong("allowed are true and false")
    unit, height = members.get("unit"), members.get("height")
    if unit and height:
        height.wrong("allowed is it or unit, not both")
    return Capture(
        path,
        file_of(members["body"], folder, "a baked .qgraph or a mesh"),
        unit.one_of(tuple(UNITS_MM), "say the unit of the mesh's coordinates") if unit else None,
        height.number(0, 1e6, "mm, extent of the mesh upwards", above=True) if height else None,
        members["eta"].number(1, 3, "index of refraction inside over outside"),
        _checked(members["deformation"], "deformation") if "deformation" in members else [],
        {name: camera for name, (camera, _) in cameras.items()},
        {name: size for name, (_, size) in cameras.items()},
        lights,
        _solver(members["solver"]) if "solver" in members else {},
        bool(polarised and polarised.value),
        photographs,
    )


def _camera(field: Member) -> tuple[dict[str, Any], tuple[int, int]]:
    """Members of a scene's camera, and the size of its pictures."""
    if not isinstance(field.value, dict):
        field.wrong("allowed is an object")
    size = []
    for name in ("width", "height"):
        if name not in field.value:
            raise InputError(f"{field.file}: {field.path}.{name}: is missing, it has to be there (pixels)")
        size.append(Member(field.file, f"{field.path}.{name}", field.value[name]).whole(8, MOST_SIDE, "pixels"))
    camera = {name: value for name, value in field.value.items() if name not in ("width", "height")}
    _checked(Member(field.file, field.path, camera), "camera")
    return camera, (size[0], size[1])


def light(field: Member, folder: Path) -> dict[str, Any]:
    """A scene's light, whose file is looked for beside the capture."""
    _checked(Member(field.file, field.path, [field.value]), "lights", "/lights/0")
    light = dict(field.value)
    if "file" in light:
        light["file"] = str(folder / light["file"])
    return light


def _solver(field: Member) -> dict[str, Any]:
    if isinstance(field.value, dict):
        for name in field.value.keys() & set(_FIXED):
            Member(field.file, f"{field.path}.{name}", field.value[name]).wrong(
                "allowed is nothing: acquire decides it"
            )
    return _checked(field, "solver")


def _checked(field: Member, member: str, pointer: str = "") -> Any:
    """The value of a member that scene files have too. Raises InputError with the path into this document."""
    try:
        core.check_scene(json.dumps({member: field.value}))
    except InputError as error:
        place, colon, rest = str(error).partition(": ")
        inside = place.removeprefix(pointer or f"/{member}").replace("/", ".")
        raise InputError(f"{field.file}: {field.path}{inside}{colon}{rest}") from None
    return field.value


def file_of(field: Member, folder: Path, what: str) -> Path:
    """A file that is there, beside the document. Raises InputError."""
    found = folder / field.text(what)
    if not found.is_file():
        field.wrong(f"allowed is the name of a file that is there ({what}), looked for beside the capture: {found}")
    return found


def _photograph(field: Member, folder: Path, cameras: Mapping[str, Any], lights: Mapping[str, Any]) -> Photograph:
    optional = ("exposure", "gain", "saturation", "variance", "noise", "mask")
    members = field.members(("file", "camera", "lights"), optional)
    lit = [
        each.one_of(tuple(lights), "name one of `lights`, or add it there")
        for each in members["lights"].items(MOST_PHOTOGRAPHS)
    ]
    if len(set(lit)) < len(lit):
        members["lights"].wrong("allowed is every light once")
    if ("variance" in members) == ("noise" in members):
        raise InputError(
            f"{field.file}: {field.path}: {'both' if 'noise' in members else 'neither'} of variance and noise found, "
            'allowed is one: a file of variances, or a model, as {"read_out": 0.001, "shot": 0.0001}'
        )
    exposure, saturation = members.get("exposure"), members.get("saturation")
    return Photograph(
        field.path,
        file_of(members["file"], folder, "a linear .exr, .hdr, .npz or 16-bit .png"),
        members["camera"].one_of(tuple(cameras), "name one of `cameras`, or add it there"),
        tuple(lit),
        exposure.number(0, _LARGEST, "value over radiance", above=True) if exposure else 1.0,
        gain_of(members.get("gain"), field.path),
        saturation.number(0, _LARGEST, "a value of the photograph", above=True) if saturation else None,
        noise_of(members["noise"]) if "noise" in members else file_of(members["variance"], folder, "an image"),
        file_of(members["mask"], folder, "a mask, an image") if "mask" in members else None,
    )


def gain_of(field: Member | None, own: str) -> float | str:
    """A known factor, or the name of an unknown one; without a word a photograph has one of its own."""
    if field is None:
        return own
    if isinstance(field.value, str):
        return field.text("the name of those photographs that share an unknown gain")
    return field.number(0, _LARGEST, "a known gain; or a text, the name of an unknown one", above=True)


def noise_of(field: Member) -> NoiseModel:
    """A noise model. Raises InputError."""
    members = field.members(("read_out", "shot"), ())
    read_out = members["read_out"].number(0, _LARGEST, "standard deviation of a black pixel's value")
    shot = members["shot"].number(0, _LARGEST, "variance over value")
    if read_out == 0 and shot == 0:
        field.wrong("allowed is some noise: read_out or shot above 0")
    return NoiseModel(read_out, shot)
