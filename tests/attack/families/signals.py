"""Signals at any moment: the program ends at once, and leaves what was there, or all of what it wrote."""

from __future__ import annotations

import json
import signal
import zipfile
from dataclasses import replace

from PIL import Image

from attack import texts
from attack.bodies import ring
from attack.case import Case, Outcome, Place
from attack.families.data import PNG
from attack.families.scenes import SCENE
from attack.physics import DEVICE
from attack.texts import Rng
from quadgraph.file import qgraph_file

OLD = b"what was there"
NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Command, output, and about how long it takes, s.
COMMANDS = {
    "bake": (("bake", "mesh.ply", "--unit", "mm", "-o", "out.qgraph"), "out.qgraph", 2.0),
    "bake for an error": (
        ("bake", "mesh.ply", "--unit", "mm", "--error", "9%", "--material", "marble", *DEVICE, "-o", "out.qgraph"),
        "out.qgraph",
        6.0,
    ),
    "solve": (("solve", "body.qgraph", *DEVICE, "--field", "out.npz", "--sweeps", "20"), "out.npz", 3.0),
    "long solve": (
        ("solve", "body.qgraph", *DEVICE, "--field", "out.npz", "--method", "quadgraph-fv", "--cycles", "1000000"),
        "out.npz",
        1.2,
    ),
    "shortest path": (
        ("render", "surface.qgraph", *DEVICE, "--method", "shortest-path", "--path-cells", "96", "-o", "out.png"),
        "out.png",
        3.0,
    ),
    "render": (("render", "body.qgraph", *DEVICE, "--size", "256x256", "-o", "out.png"), "out.png", 1.5),
    "frames": (("render", "scene.json", *DEVICE, "--frames", "30", "-o", "frame%04d.png"), "frame*.png", 1.8),
    "film": (("render", "scene.json", *DEVICE, "--frames", "30", "-o", "out.mp4"), "out.mp4", 1.8),
    "shapes": (("shapes", "body.qgraph", "mesh.ply", "mesh.ply", "-o", "out.qshapes"), "out.qshapes", 1.0),
}


def put(place: Place) -> None:
    """Bodies, a mesh and a scene."""
    place.bodies.put(place.folder)
    place.bodies.put(place.folder, "surface", "surface.qgraph")
    (place.folder / "mesh.ply").write_bytes(ring().export(file_type="ply"))
    (place.folder / "image.png").write_bytes(PNG)
    (place.folder / "scene.json").write_text(json.dumps(SCENE | {"frames": 30}))


def whole(place: Place, outcome: Outcome) -> str:
    """Judge every output that is there: the old one, or one that can be read."""
    for path in sorted(place.folder.iterdir()):
        if not path.name.startswith(("out.", "frame")) or path.read_bytes() == OLD:
            continue
        try:
            if path.suffix == ".qgraph":
                qgraph_file.read(path)
            elif path.suffix == ".png":
                with Image.open(path) as image:
                    image.load()
            elif path.suffix == ".npz":
                with zipfile.ZipFile(path) as archive:
                    archive.testzip()
            elif path.stat().st_size < 500:
                return f"{path.name} has {path.stat().st_size} bytes"
        except Exception as error:
            return f"{path.name} is half-written: {error}"[:300]
    return ""


def _case(rng: Rng, name: str, sent: tuple[tuple[float, int], ...]) -> Case:
    words, output, _ = COMMANDS[name]
    old = bool(rng.integers(2)) and "*" not in output

    def prepare(place: Place) -> None:
        put(place)
        if old:
            (place.folder / output).write_bytes(OLD)

    said = ", ".join(f"{signal.Signals(number).name} after {delay:.2f} s" for delay, number in sent)
    title = f"{name}{' onto an old file' if old else ''}, {said}"
    line = ("quadgraph", *words)
    return Case(title, line, (), prepare, (output,), partial=True, judge=whole, signals=sent, seconds=40)


def one(rng: Rng) -> Case:
    """One signal at any moment."""
    name = texts.pick(rng, list(COMMANDS))
    return _case(rng, name, ((float(rng.uniform(0, COMMANDS[name][2])), int(texts.pick(rng, NUMBERS))),))


def several(rng: Rng) -> Case:
    """Two or three signals shortly after each other."""
    name = texts.pick(rng, list(COMMANDS))
    first = float(rng.uniform(0, COMMANDS[name][2]))
    times = first + rng.uniform(0, 0.3, int(rng.integers(1, 3))).cumsum()
    sent = ((first, int(texts.pick(rng, NUMBERS))), *((float(t), int(texts.pick(rng, NUMBERS))) for t in times))
    return _case(rng, name, sent)


def early(rng: Rng) -> Case:
    """A signal as soon as it is heeded."""
    name = texts.pick(rng, list(COMMANDS))
    return _case(rng, name, ((float(rng.uniform(0, 0.2)), int(texts.pick(rng, NUMBERS))),))


def executable(rng: Rng) -> Case:
    """A signal to the executable, which the system ends."""
    delay, number = float(rng.uniform(0, 0.6)), int(texts.pick(rng, NUMBERS))
    line = ("quadgraph-engine", "body.qgraph", "--headless", *DEVICE, "--size", "256x256", "-o", "out.png")

    def prepare(place: Place) -> None:
        put(place)
        (place.folder / "out.png").write_bytes(OLD)

    name = f"engine, {signal.Signals(number).name} after {delay:.2f} s"
    sent = ((delay, number),)
    return Case(name, line, (), prepare, ("out.png",), partial=True, judge=whole, signals=sent)


def killed(rng: Rng) -> Case:
    """KILL, which nobody heeds: the output is the old one or whole; temporary files may stay."""
    name = texts.pick(rng, list(COMMANDS))
    case = _case(rng, name, ((float(rng.uniform(0, COMMANDS[name][2])), signal.SIGKILL),))
    return replace(case, outputs=(*case.outputs, "*"), litter=True)


RECIPES = (one, several, early, executable, killed)
