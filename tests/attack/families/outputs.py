"""Outputs that are inputs, each other, links, pipes or folders, and names that could be foreseen."""

from __future__ import annotations

import json
import os
from dataclasses import replace

from attack import texts
from attack.bodies import ring
from attack.case import Case, Outcome, Place
from attack.child import program
from attack.families.data import PNG, volume
from attack.families.scenes import SCENE
from attack.physics import DEVICE
from attack.texts import Rng

SMALL = ("--size", "32x32", *DEVICE, "--no-correction")
LIGHT = "projector:0,0,60:0,0,-1:40:image.png:1"


def put(place: Place) -> None:
    """A body, a mesh, an image, a material and a scene, and other ways to their folder."""
    place.bodies.put(place.folder)
    (place.folder / "mesh.ply").write_bytes(ring().export(file_type="ply"))
    (place.folder / "image.png").write_bytes(PNG)
    (place.folder / "v.npz").write_bytes(volume())
    (place.folder / "scene.json").write_text(json.dumps(SCENE | {"deformation": []}))
    (place.folder / "below").mkdir()
    (place.folder / "beside").symlink_to(".")


# What is read, and a command that would write onto it.
ONTO = (
    ("mesh.ply", ("quadgraph", "bake", "mesh.ply", "--unit", "mm", "--surface-only", "-o", "{}")),
    ("mesh.ply", ("quadgraph", "shapes", "body.qgraph", "mesh.ply", "mesh.ply", "-o", "{}")),
    ("body.qgraph", ("quadgraph", "solve", "body.qgraph", *DEVICE, "--no-correction", "--json", "{}")),
    ("v.npz", ("quadgraph", "solve", "body.qgraph", *DEVICE, "--material", "v.npz", "--field", "{}")),
    ("image.png", ("quadgraph", "render", "body.qgraph", *SMALL, "--light", LIGHT, "-o", "{}")),
    ("image.png", ("quadgraph-engine", "body.qgraph", "--headless", *SMALL, "--light", LIGHT, "-o", "{}")),
    ("scene.json", ("quadgraph", "render", "scene.json", *DEVICE, "-o", "out.png", "--json", "{}")),
)


def another_way(rng: Rng, place_name: str) -> tuple[str, bool]:
    """Another name of a file, and whether it is a hard link that has to be made."""
    name = texts.pick(rng, ["{}", "./{}", "below/../{}", "beside/{}", ".//{}", "below/../beside/./{}", "hard"])
    stem, _, suffix = place_name.partition(".")
    return (f"hard.{suffix}", True) if name == "hard" else (name.format(f"{stem}.{suffix}"), False)


def onto_input(rng: Rng) -> Case:
    """An output that is read, by whatever name."""
    file, line = texts.pick(rng, ONTO)
    name, hard = another_way(rng, file)

    def prepare(place: Place) -> None:
        put(place)
        if hard:
            os.link(place.folder / file, place.folder / name)

    command = tuple(word.format(name) if word == "{}" else word for word in line)
    return Case(f"{line[0]} {line[1]:.6} onto {name}", command, (name, file), prepare, expect="refused")


def two_outputs(rng: Rng) -> Case:
    """Two outputs of one name."""
    first, second = "o.json", texts.pick(rng, ["below/../o.json", "./o.json", "o.json"])
    lines = [
        ("quadgraph", "solve", "body.qgraph", *DEVICE, "--no-correction", "--json", first, "--json", second),
        ("quadgraph", "render", "body.qgraph", *SMALL, "-o", "o.png", "-o", "below/../o.png"),
        ("quadgraph", "solve", "body.qgraph", *DEVICE, "--json", "o.npz", "--field", "beside/o.npz"),
        ("quadgraph", "render", "body.qgraph", *SMALL, "-o", "o.png", "--json", "./o.png"),
    ]
    line = texts.pick(rng, lines)
    outputs = ("o.json",) if first in line else ()
    expect = "" if outputs else "refused"
    return Case(f"{line[1]} twice onto {second}", line, ("o.png", "o.npz", "o.json"), put, outputs, expect=expect)


WRITERS = {
    "out.json": ("quadgraph", "solve", "body.qgraph", *DEVICE, "--no-correction", "--json", "out.json"),
    "out.npz": ("quadgraph", "solve", "body.qgraph", *DEVICE, "--no-correction", "--field", "out.npz"),
    "out.qgraph": ("quadgraph", "bake", "mesh.ply", "--unit", "mm", "--surface-only", "-o", "out.qgraph"),
    "out.png": ("quadgraph", "render", "body.qgraph", *SMALL, "-o", "out.png"),
    "out.exr": ("quadgraph-engine", "body.qgraph", "--headless", *SMALL, "-o", "out.exr"),
    "out.mp4": ("quadgraph", "render", "scene.json", *DEVICE, "--frames", "2", "-o", "out.mp4"),
}


def irregular(rng: Rng) -> Case:
    """An output that is a link, a pipe, a folder or a device."""
    file = texts.pick(rng, list(WRITERS))
    kind = texts.pick(rng, ["fifo", "link", "dangling", "loop", "folder", "device", "below a file", "no folder"])

    def prepare(place: Place) -> None:
        put(place)
        path = place.folder / file
        (place.folder / "precious").write_text("precious")
        if kind == "fifo":
            os.mkfifo(path)
        elif kind == "folder":
            path.mkdir()
        elif kind in ("link", "dangling", "loop", "device"):
            path.symlink_to({"link": "precious", "dangling": "nowhere", "loop": file, "device": "/dev/null"}[kind])

    name = {"below a file": f"precious/{file}", "no folder": f"nowhere/{file}"}.get(kind, file)
    command = tuple(name if word == file else word for word in WRITERS[file])
    case = Case(f"{command[0]} {file}: {kind}", command, (file,), prepare, expect="refused")
    made = kind == "no folder" and file == "out.mp4"
    return replace(case, outputs=(name,), expect="") if made else case


def foreseen(rng: Rng) -> Case:
    """Links under names that a temporary file could have, made by the process that becomes the program."""
    file = texts.pick(rng, list(WRITERS))
    stem, suffix = file.split(".")
    names = [f"{file}.part$$", f"{file}.part", f".{stem}.part.{suffix}", f"{file}.tmp", f".{file}.$$", f"{file}.$$"]
    links = " ".join(f'ln -s precious "{name}";' for name in names)

    def prepare(place: Place) -> None:
        put(place)
        (place.folder / "precious").write_text("precious")

    def judge(place: Place, outcome: Outcome) -> str:
        kept = (place.folder / "precious").read_text() == "precious"
        return "" if kept and (place.folder / file).is_file() else "written through a link"

    line = WRITERS[file]
    command = ("sh", "-c", f'{links} exec "$@"', "sh", program(line[0]), *line[1:])
    patterns = (file, f"{file}.*", f".{stem}.*")
    return Case(f"links that {file} may meet", command, (), prepare, patterns, judge=judge, expect="fine")


def long_names(rng: Rng) -> Case:
    """Outputs of names that are long, odd, or without an ending."""
    file = texts.pick(rng, list(WRITERS))
    stem, suffix = file.split(".")
    length = int(rng.integers(200, 300))
    name = texts.pick(
        rng,
        [
            "x" * length + f".{suffix}",
            stem,
            f".{suffix}",
            f"{stem}.xyz",
            f"a b'\"$;\u00e9.{suffix}",
            f"{stem}.{suffix.upper()}",
            "",
            "-",
        ],
    )
    command = tuple(name if word == file else word for word in WRITERS[file])
    shown = (name[:20],) if len(name) > 1 else ()
    return Case(f"{command[0]} {file} as {name[:30]!a}", command, shown, put, (name,) if name else ())


RECIPES = (onto_input, two_outputs, irregular, foreseen, long_names)
