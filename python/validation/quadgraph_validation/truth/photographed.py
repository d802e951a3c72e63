"""A scene's body photographed by a camera with noise: captures whose truth is known, to hold acquisition against."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from quadgraph import core
from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.truth import known_material
from quadgraph_validation.truth.camera_walks import CameraPicture, CameraWalker, Eye
from quadgraph_validation.truth.known_material import KnownMaterial

WHITE = 0.8  # value of the brightest pixel of a photograph: its exposure sees to that
SATURATION = 1.0
_MARGIN = 1.08  # of a view's distance over that from which the body fits
SWEEP_POINTS = 160_000  # of the engine's correction, whose noise would be another of the camera's
_READ_OUT = 0.2  # of the noise of a white pixel


@dataclass(frozen=True)
class PhotographOptions:
    """How photographs are made. azimuths: of the views, degrees, None: the scene's and the opposite; size: pixels,
    None: the scene's; walks: of each pixel; noise: relative standard deviation of a white pixel; bits: of its values,
    0: not quantised; blur: standard deviation, pixels; gains: by how much unknown gains are off, 0: they are known.
    """

    azimuths: tuple[float, ...] | None = None
    size: tuple[int, int] | None = None
    walks: int = 256
    noise: float = 0.005
    bits: int = 14
    blur: float = 0.0
    gains: float = 0.0
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Subject:
    """A scene as its file has it. document: all members; lights by their names."""

    path: Path
    document: dict[str, Any]
    body: Path
    material: KnownMaterial
    lights: dict[str, dict[str, Any]] = field(default_factory=dict)


def subject(path: Path) -> Subject:
    """Read a scene. Raises InputError for edits, layers, parallel rays and darkness."""
    scene = core.SceneFile(path).at(0)
    document = json.loads(scene.json())
    material = known_material.of_scene(path, scene)
    if "orthographic" in document["camera"]:
        raise InputError(f"{path}: /camera/orthographic: found, allowed is a perspective camera")
    if not document["lights"]:
        raise InputError(f"{path}: /lights: found none, allowed is one or more")
    lights = {f"light{number}": _placed(light, path.parent) for number, light in enumerate(document["lights"], 1)}
    return Subject(path, document, Path(scene.body), material, lights)


def _placed(light: dict[str, Any], folder: Path) -> dict[str, Any]:
    return light | ({"file": str((folder / light["file"]).absolute())} if "file" in light else {})


def views(found: Subject, options: PhotographOptions) -> dict[str, dict[str, Any]]:
    """Cameras by name, each with eye, look_at, up, fov, width and height."""
    camera, picture = found.document["camera"], found.document["picture"]
    width, height = options.size or (picture["width"], picture["height"])
    common = {"fov": camera["fov"], "up": camera["up"], "width": width, "height": height}
    if "eye" in camera:
        if options.azimuths:
            raise InputError(f"{found.path}: /camera/eye: found with azimuths, allowed is one of them")
        return {"view1": {"eye": camera["eye"], "look_at": camera["look_at"]} | common}
    vertices = core.load(found.body).display["vertices"]
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    radius = float(np.linalg.norm(vertices - middle, axis=1).max())
    half = np.arctan(np.tan(np.radians(camera["fov"]) / 2) * min(1.0, width / height))
    distance = camera.get("distance") or _MARGIN * radius / np.sin(half)
    look_at = middle + np.array(camera.get("target", (0, 0, 0)))
    azimuths = options.azimuths or (camera["azimuth"], camera["azimuth"] + 180)
    result = {}
    for number, azimuth in enumerate(azimuths, 1):
        eye = look_at + distance * backward(azimuth, camera["elevation"], camera["up"])
        places = {"eye": [round(float(x), 4) for x in eye], "look_at": [round(float(x), 4) for x in look_at]}
        result[f"view{number}"] = places | common
    return result


def backward(azimuth: float, elevation: float, up: str) -> np.ndarray:
    """From what is looked at to the eye, as engine/render/display/camera.h has it."""
    a, e = np.radians([azimuth, elevation])
    if up == "y":
        return np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    return np.array([np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)])


Radiances = dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]  # of view and light: (h, w, 3), and its noise


def by_walks(
    found: Subject, cameras: dict[str, dict[str, Any]], options: PhotographOptions, advance: Callable[[float], None]
) -> Radiances:
    """What each camera sees of each light alone, by random walks through the body's mesh. Raises InputError."""
    walker = walker_of(found)
    steps = 3 * len(cameras)
    pictures = []
    for number, camera in enumerate(cameras.values()):
        for channel in range(3):
            done = number * 3 + channel

            def tell(share: float, done: int = done) -> None:
                advance((done + share) / steps)

            seed = options.seed + number
            pictures.append(seen_by(walker, camera, channel, found.material, options.walks, seed, tell))
    return radiances_of(found, cameras, pictures)


def walker_of(found: Subject) -> CameraWalker:
    """What walks through the body and meets its lights. Raises InputError for lights and shapes it cannot have."""
    if found.document.get("deformation"):
        raise InputError(f"{found.path}: /deformation: found, allowed with walks is a body as it lies in its file")
    display = core.load(found.body).display
    surface = Surface(np.array(display["vertices"], np.float64), np.array(display["triangles"], np.int64))
    return CameraWalker(surface, list(found.lights.values()))


def seen_by(
    walker: CameraWalker,
    camera: dict[str, Any],
    channel: int,
    material: KnownMaterial,
    walks: int,
    seed: int,
    tell: Callable[[float], None],
) -> CameraPicture:
    """What one of the cameras of `views` sees in one channel. tell: is called with the share that is done."""
    place, target = (np.array(camera[each], np.float64) for each in ("eye", "look_at"))
    eye = Eye(place, target, camera["fov"], camera["up"], camera["width"], camera["height"])
    return walker.see(eye, channel, material.in_channel(channel), material.eta, walks, seed, tell)


def radiances_of(found: Subject, cameras: dict[str, dict[str, Any]], pictures: Sequence[CameraPicture]) -> Radiances:
    """Of the three channels of each camera, in the order of `cameras`."""
    result: Radiances = {}
    for number, name in enumerate(cameras):
        channels = pictures[3 * number : 3 * number + 3]
        for k, light in enumerate(found.lights):
            radiance = np.stack([each.radiance[k] for each in channels], axis=-1)
            result[name, light] = radiance, np.stack([each.noise[k] for each in channels], axis=-1)
    return result


def by_engine(
    found: Subject,
    cameras: dict[str, dict[str, Any]],
    body: Path,
    device: str,
    advance: Callable[[float], None],
    sweep_points: int = SWEEP_POINTS,
) -> Radiances:
    """The same by the engine, on `body`, in place of the scene's. Raises InputError, SolverError."""
    stage = core.Stage(device)
    result: Radiances = {}
    for number, (light, stated) in enumerate(found.lights.items()):
        solved = False
        for name, camera in cameras.items():
            scene: dict[str, Any] = {
                each: found.document[each] for each in ("material", "deformation") if each in found.document
            }
            around = {each: camera[each] for each in ("eye", "look_at", "up", "fov")}
            size = {each: camera[each] for each in ("width", "height")}
            size |= {"samples": 4, "transmission_roughness": 0}  # as the walks have it
            scene |= {"body": str(body.absolute()), "lights": [stated], "camera": around, "picture": size}
            scene["solver"] = {"sweep_points": sweep_points}
            stage.show(core.scene_file(json.dumps(scene)).at(0))
            if not solved:
                stage.solve()
                solved = True
            radiance = np.array(stage.render().scattered, np.float64)
            result[name, light] = radiance, np.zeros(radiance.shape)
        advance((number + 1) / len(found.lights))
    return result


@dataclass(frozen=True, eq=False)
class Photographed:
    """One photograph: values (h, w, 3), what it is called, and what a capture says of it."""

    name: str
    values: np.ndarray
    stated: dict[str, Any]
    gain: list[float]


def taken(radiances: Radiances, options: PhotographOptions) -> list[Photographed]:
    """Photographs by a camera of this noise; the same seed gives the same. Raises InputError for one that is black."""
    generator = np.random.default_rng([options.seed, 77])
    result = []
    for (camera, light), (radiance, noise) in radiances.items():
        if not radiance.max() > 0:
            raise InputError(f"{light}: brings no light to what {camera} sees; move it, or leave it out")
        exposure = float(f"{WHITE / np.quantile(radiance[radiance > 0], 0.999):.6g}")
        gain = 1 + options.gains * generator.uniform(-1, 1, 3)
        value = exposure * gain * (ndimage.gaussian_filter(radiance, (options.blur, options.blur, 0)))
        read_out = _READ_OUT * options.noise * WHITE
        shot = options.noise**2 * WHITE
        value = value + generator.normal(size=value.shape) * np.sqrt(read_out**2 + shot * value)
        step = SATURATION / 2**options.bits if options.bits else 0.0
        value = np.clip(np.round(value / step) * step if step else value, 0, SATURATION)
        walks = _shot_of(exposure * radiance, exposure * noise)
        stated = {
            "camera": camera,
            "lights": [light],
            "exposure": exposure,
            "saturation": SATURATION,
            "noise": {"read_out": float(np.hypot(read_out, step / np.sqrt(12))), "shot": shot + walks},
        }
        if not options.gains:
            stated["gain"] = 1
        result.append(Photographed(f"{camera}-{light}", value, stated, gain.tolist()))
    return result


def _shot_of(value: np.ndarray, noise: np.ndarray) -> float:
    """Variance of walks over value: like shot noise, since few of many meet the lights."""
    return float((noise**2).sum() / max(value.sum(), 1e-300))


def write(
    path: Path, found: Subject, cameras: dict[str, dict[str, Any]], photographs: list[Photographed], how: dict[str, Any]
) -> None:
    """Write the photographs, the truth beside them, and last the capture. how: was made by, for the truth."""
    from quadgraph.base import atomic_file

    entries = []
    for each in photographs:
        file = photograph_path(path, each.name)
        core.Picture(each.values.astype(np.float32)).write_exr(file)
        entries.append({"file": file.name} | each.stated)
    lights = {name: _beside(light, path.parent) for name, light in found.lights.items()}
    document: dict[str, Any] = {"quadgraph_capture": 1, "body": os.path.relpath(found.body, path.parent)}
    document |= {"eta": round(found.material.eta, 6), "polarised": True}
    if found.document.get("deformation"):
        document["deformation"] = found.document["deformation"]
    document |= {"cameras": cameras, "lights": lights, "photographs": entries}
    gains = {each.name: each.gain for each in photographs}
    truth = {"scene": str(found.path)} | found.material.stated(path.parent) | {"gains": gains}
    atomic_file.write_json(truth_path(path), truth | how)
    atomic_file.write_json(path, document)


def photograph_path(capture: Path, name: str) -> Path:
    """The file of a photograph of a capture."""
    return capture.with_name(f"{capture.stem}-{name}.exr")


def truth_path(capture: Path) -> Path:
    """The file of a capture's truth, which `acquire` never reads."""
    return capture.with_name(f"{capture.stem}-truth.json")


def _beside(light: dict[str, Any], folder: Path) -> dict[str, Any]:
    return light | ({"file": os.path.relpath(light["file"], folder)} if "file" in light else {})
