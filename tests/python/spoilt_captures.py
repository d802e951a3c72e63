"""Ways to spoil a capture, as people do: each changes the document or the photographs of a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from scipy import ndimage

import twin_capture
from baked import write_levels
from quadgraph.file import npz
from quadgraph.mesh.surface import Surface

Document = dict[str, Any]
Spoil = Callable[[Path, Document], None]
ROOM = {"type": "ambient", "irradiance": [0.01, 0.01, 0.01]}


def values_of(folder: Path, photograph: Document) -> np.ndarray:
    """(h, w, 3) of a photograph."""
    return npz.read(folder / photograph["file"], ("photograph",))["photograph"]


def change(folder: Path, photograph: Document, how: Callable[[np.ndarray], np.ndarray]) -> None:
    """Change a photograph's values."""
    np.savez(folder / photograph["file"], photograph=how(values_of(folder, photograph)))


def one(number: int, how: Callable[[np.ndarray], np.ndarray]) -> Spoil:
    """Change values of one photograph."""
    return lambda folder, document: change(folder, document["photographs"][number], how)


def every(how: Callable[[np.ndarray], np.ndarray]) -> Spoil:
    """Change values of all photographs."""

    def spoil(folder: Path, document: Document) -> None:
        for each in document["photographs"]:
            change(folder, each, how)

    return spoil


def member(path: str, how: Callable[[Any], Any]) -> Spoil:
    """Change a member of the document, as `cameras.front.fov`; of lists each item."""

    def spoil(_folder: Path, document: Document) -> None:
        *parents, last = (int(name) if name.isdigit() else name for name in path.split("."))
        at: Any = document
        for name in parents:
            at = at[name]
        at[last] = [how(x) for x in at[last]] if isinstance(at[last], list) else how(at[last])

    return spoil


def both(*spoils: Spoil) -> Spoil:
    """One after the other."""

    def spoil(folder: Path, document: Document) -> None:
        for each in spoils:
            each(folder, document)

    return spoil


def swapped(one_: int, other: int, name: str) -> Spoil:
    """Exchange a member of two photographs."""

    def spoil(_folder: Path, document: Document) -> None:
        first, second = document["photographs"][one_], document["photographs"][other]
        first[name], second[name] = second[name], first[name]

    return spoil


def masked(number: int, shown: int, how: Callable[[np.ndarray], np.ndarray]) -> Spoil:
    """Give a photograph a mask that is made of what another one shows."""

    def spoil(folder: Path, document: Document) -> None:
        values = values_of(folder, document["photographs"][shown]).mean(axis=2)
        body = ndimage.binary_fill_holes(ndimage.binary_opening(values > 0.01, np.ones((3, 3))))
        Image.fromarray(np.where(how(body), 255, 0).astype(np.uint8)).save(folder / "mask.png")
        document["photographs"][number]["mask"] = "mask.png"

    return spoil


def encoded(values: np.ndarray) -> np.ndarray:
    """Values as sRGB has them."""
    light = np.clip(values, 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def eight_bits(folder: Path, document: Document) -> None:
    """A picture as a camera writes it for displays."""
    first = document["photographs"][0]
    Image.fromarray((255 * encoded(values_of(folder, first))).round().astype(np.uint8)).save(folder / "first.png")
    first["file"] = "first.png"


def unlit(values: np.ndarray) -> np.ndarray:
    """A photograph with the lights off."""
    return np.random.default_rng(3).normal(size=values.shape) * twin_capture.READ_OUT


def blurred(values: np.ndarray) -> np.ndarray:
    """Out of focus by two pixels."""
    return ndimage.gaussian_filter(values, (2, 2, 0))


def rotated(_folder: Path, document: Document) -> None:
    """The body stood otherwise than the capture says."""
    document["deformation"] = [{"type": "transform", "axis": [0, 1, 0], "degrees": 20}]


def mirrored(folder: Path, document: Document) -> None:
    """A mesh of the other handedness."""
    body = twin_capture.potato(3)
    write_levels(folder / "mirrored.qgraph", [Surface(body.vertices * [-1, 1, 1], body.triangles[:, ::-1])])
    document["body"] = "mirrored.qgraph"


def in_metres(_folder: Path, document: Document) -> None:
    """A mesh in mm that is said to be in m."""
    document |= {"body": "potato.obj", "unit": "m"}


def lights_exchanged(_folder: Path, document: Document) -> None:
    """Each light is where the other is said to be."""
    lights = document["lights"]
    lights["key"], lights["sun"] = lights["sun"], lights["key"]


def in_a_lit_room(folder: Path, document: Document) -> None:
    """Light from all sides in all photographs."""
    for each in document["photographs"]:
        camera = document["cameras"][each["camera"]]
        [radiance] = twin_capture.photographed(folder / "finer.qgraph", twin_capture.TRUTH, ROOM, [camera])
        change(folder, each, lambda values, more=each["exposure"] * radiance: values + more)


_REVERSED_Z = [member(f"lights.key.{name}.2", lambda x: -x) for name in ("centre", "u", "v")]
_TENTH = [member(f"lights.key.{name}", lambda x: x / 10) for name in ("centre", "u", "v")]

# What was done, and what is to be said of it: each text, in what is refused or in the findings.
QUICK: dict[str, tuple[Spoil, tuple[str, ...]]] = {
    "eight bits": (eight_bits, ("photographs[0].file: first.png has 8 bits a channel",)),
    "body in metres": (in_metres, ("photographs[0].camera: the body covers", "unit (mm)")),
    "cameras in cm": (
        both(*(member(f"cameras.front.{name}", lambda x: x / 10) for name in ("eye", "look_at"))),
        ("photographs[0].camera: the body covers", "cameras.front.eye, [2, 2, 11] mm, lies inside the box", "units"),
    ),
    "lights in cm": (both(*_TENTH), ("lights.key.centre, [6, 6, 6] mm, lies inside the box around the body", "units")),
    "axis of a light": (both(*_REVERSED_Z), ("lights.key shines away from the body", "axes may be flipped")),
    "saturated": (one(1, lambda x: np.minimum(x, 0.4)), ("photographs[1].saturation: not stated",)),
    "saturated lower": (
        both(
            one(1, lambda x: np.minimum(x, 0.4)), lambda _, document: document["photographs"][1].update(saturation=0.9)
        ),
        ("photographs[1].saturation: found 0.9, but", "the same largest value 0.4"),
    ),
    "mask inverted": (masked(1, 1, np.logical_not), ("photographs[1].mask: it leaves out", "inverted")),
}
SLOW: dict[str, tuple[Spoil, tuple[str, ...]]] = {
    "picture flipped": (
        one(0, lambda x: x[:, ::-1]),
        ("probably photographs[0].file: fits much better turned left to right",),
    ),
    "exposure": (
        member("photographs.2.exposure", lambda x: x / 2),
        ("probably photographs[2].exposure (or gain): values are 2.", "times what is predicted"),
    ),
    "mask of another": (
        masked(0, 1, lambda body: np.roll(body, 12, axis=1)),
        ("photographs[0].mask: ", "of another photograph"),
    ),
    "all upside down": (every(lambda x: x[::-1]), ("probably photographs.file: fit much better turned upside down",)),
    "sRGB": (every(encoded), ("probably photographs.file: values go with the power 0.45", "sRGB")),
    "tone curve": (one(1, encoded), ("probably photographs[1].file: values go with the power 0.45", "tone curve")),
    "blue, green, red": (
        every(lambda x: x[..., ::-1]),
        ("probably photographs.file: fit much better with red and blue",),
    ),
    "black level": (every(lambda x: x + 0.05), ("probably photographs.file: fit much better less", "black level")),
    "files swapped": (swapped(0, 2, "file"), ("photographs[0].file, photographs[2].file: ", "are swapped")),
    "lights swapped": (lights_exchanged, ("probably lights: what is said of key and of sun", "are swapped")),
    "field of view": (member("cameras.front.fov", lambda _: 30), ("probably cameras.front.fov: ", "times as large")),
    "power": (member("lights.key.power", lambda x: 3 * x), ("probably lights.key.power or ",)),
    "place of a light": (member("lights.key.centre.0", lambda x: x - 50), ("probably lights.key.centre: ", "about [6")),
    "out of focus": (one(0, blurred), ("probably photographs[0].file: ", "out of focus")),
    "lights off": (one(3, unlit), ("probably photographs[3].file: dark", "the light was off")),
    "lit room": (in_a_lit_room, ("probably photographs.lights: ", "light from all sides")),
    "body turned": (rotated, ("probably deformation: ", "turned by 1")),
    "body mirrored": (mirrored, ("probably body: photographs fit much better with the body mirrored",)),
}
