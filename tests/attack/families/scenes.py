"""Scene files of wrong kinds, numbers and texts, and tracks without end."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any

import trimesh

from attack import texts
from attack.case import Case, Place
from attack.families.data import PNG
from attack.physics import DEVICE, engine, rendered
from attack.texts import Rng

SCENE: dict[str, Any] = {
    "quadgraph_scene": 1,
    "body": "body.qgraph",
    "material": {"name": "marble", "eta": 1.4, "sigma_a": [0.01, 0.02, 0.05]},
    "edits": [
        {
            "operation": "multiply",
            "sigma_a": [1, 3, 6],
            "stroke": [[-14, 0, 0], [-10, 0, 4]],
            "radius": 3,
            "softness": 1,
            "depth": [0, 2],
        },
        {
            "operation": "add",
            "sigma_a": 0.1,
            "image": "image.png",
            "placement": {"centre": [10, 0, 4], "direction": [0, 0, -1], "up": [0, 1, 0], "size": [8, 8, 8]},
        },
        {
            "name": "Spots",
            "visible": True,
            "opacity": 0.5,
            "edits": [
                {
                    "operation": "set",
                    "sigma_a": 0.2,
                    "stroke": [[8, 0, 4], [6, 0, 4]],
                    "radius": 2,
                    "mirrored": {"stroke": [[-8, 0, 4], [-6, 0, 4]]},
                },
            ],
        },
    ],
    "lights": [
        {"type": "directional", "direction": [0.5, -0.5, -1], "irradiance": [1, 0.9, 0.7]},
        {"type": "point", "position": [0, 0, 40], "power": 3},
        {"type": "spot", "position": [30, 0, 30], "direction": [-1, 0, -1], "angle": 40, "edge": 0.3, "power": 2},
        {"type": "ambient", "irradiance": 0.02},
    ],
    "deformation": [
        {"type": "twist", "axis": [0, 1, 0], "degrees": 10, "range": [0.1, 0.9]},
        {"type": "transform", "scale": [1, 1.1, 1], "translate": [0, 1, 0], "degrees": 5},
    ],
    "camera": {"azimuth": 20, "elevation": 10, "up": "y", "fov": 30},
    "solver": {"method": "fem", "tolerance": 0.001, "correction": False, "bounces": 2},
    "picture": {"width": 32, "height": 32, "exposure": "auto", "background": [0.1, 0.2, 0.3], "roughness": 0.4},
    "frames": 4,
    "frames_per_second": 24,
    "tracks": [{"path": "/camera/azimuth", "keys": [[0, 0], [4, 360]], "between": "smooth"}],
}
NAMES = ("scene.json", "body.qgraph", "--set", "image.png")


def scene(
    rng: Rng,
    name: str,
    text: str | bytes,
    expect: str = "",
    more: tuple[str, ...] = (),
    extra: Callable[[Place], object] = lambda place: None,
    size: tuple[int, int] | None = None,
    names: tuple[str, ...] = (),
) -> Case:
    """A picture of a scene file, by the executable or by `render`."""
    python = bool(more) or bool(rng.integers(3) == 0)

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)
        (place.folder / "image.png").write_bytes(PNG)
        (place.folder / "scene.json").write_bytes(text if isinstance(text, bytes) else text.encode())
        extra(place)

    if python:
        command: tuple[str, ...] = ("quadgraph", "render", "scene.json", "-o", "out.png", *DEVICE, *more)
    else:
        command = engine("scene.json")
    judge = rendered(size=size if python else None)
    title = f"{'render' if python else 'engine'}, {name}"
    return Case(title, command, (*NAMES, *names), prepare, ("out.png",), judge=judge, expect=expect)


def deep(rng: Rng) -> Case:
    """A member of a scene nested beyond all limits."""
    key, depth = texts.pick(rng, ["material", "lights", "tracks", "unknown", "body", "solver"]), texts.depth(rng)
    text = json.dumps({k: v for k, v in SCENE.items() if k != key})[:-1] + f', "{key}": {texts.nested(rng, depth)}}}'
    return scene(rng, f"{key} {depth} deep", text, "refused")


def wrong_kind(rng: Rng) -> Case:
    """A value of a scene replaced by one of another kind."""
    path, value = texts.pick(rng, texts.places(SCENE)), texts.junk(rng)
    text = json.dumps(texts.replaced(SCENE, path, value))
    return scene(rng, f"/{'/'.join(map(str, path))} is {value!r:.60}", text)


def numbers(rng: Rng) -> Case:
    """A number of a scene replaced by one of any size, or by none."""
    paths = [path for path in texts.places(SCENE) if isinstance(texts.at(SCENE, path), int | float)]
    path = texts.pick(rng, paths)
    value = texts.pick(
        rng, ["1e999", "-1e999", "NaN", "Infinity", "-0.0", "1e-400", repr(texts.extreme(rng)), "1" * 400]
    )
    value = value.replace("inf", "1e999").replace("nan", "NaN")
    text = json.dumps(texts.replaced(SCENE, path, "HERE")).replace('"HERE"', value)
    return scene(rng, f"/{'/'.join(map(str, path))} is {value:.40}", text)


def keys(rng: Rng) -> Case:
    """A member that nobody knows, one twice, or one left out."""
    holders = [path for path in [(), *texts.places(SCENE)] if isinstance(texts.at(SCENE, path), dict)]
    path = texts.pick(rng, holders)
    kind = texts.pick(rng, ["unknown", "long", "out"])
    changed = json.loads(json.dumps(SCENE))
    holder = texts.at(changed, path)
    if kind == "out":
        del holder[texts.pick(rng, list(holder))]
    else:
        holder["unknown" if kind == "unknown" else texts.word(rng, 5)] = 1
    return scene(
        rng, f"key {kind} in /{'/'.join(map(str, path))}", json.dumps(changed), "" if kind == "out" else "refused"
    )


def bytes_of(rng: Rng) -> Case:
    """A scene file in another encoding, cut off, damaged, or no JSON."""
    text = json.dumps(SCENE)
    kinds = {
        "cut": lambda: text[: int(rng.random() * len(text))].encode(),
        "utf-16": lambda: text.encode("utf-16"),
        "latin-1": lambda: text.replace("marble", "m\u00e4rble").encode("latin-1"),
        "bytes": lambda: texts.random_bytes(rng, text.encode(), 10),
        "empty": lambda: b"",
        "nul": lambda: text.replace("marble", "mar\\u0000ble").encode(),
        "surrogate": lambda: text.replace("marble", "mar\\ud800ble").encode(),
        "comma": lambda: (text[:-1] + ",}").encode(),
        "comment": lambda: b"// scene\n" + text.encode(),
        "list": lambda: b"[" + text.encode() + b"]",
        "twice": lambda: (text[:-1] + ', "frames": 7, "frames": 9}').encode(),
        "blanks": lambda: text.encode() + b" " * int(10 ** rng.uniform(3, 7.9)),
        "escape": lambda: text.replace("marble", "\\u001b[31m").encode(),
    }
    kind = texts.pick(rng, list(kinds))
    return scene(
        rng, f"as {kind}", kinds[kind](), "refused" if kind in ("cut", "utf-16", "empty", "list", "nul") else ""
    )


def many_keys(rng: Rng) -> Case:
    """Tracks of many keys, or many tracks."""
    count = int(10 ** rng.uniform(2, 5.5))
    tracks = int(10 ** rng.uniform(0, 3))
    each = max(2, count // tracks)
    keys = [[frame, 1 + frame % 80] for frame in range(each)]
    paths = ["/camera/azimuth", "/camera/elevation", "/camera/fov", "/lights/1/power", "/deformation/0/degrees"]
    listed = [{"path": texts.pick(rng, paths[: 1 + tracks]), "keys": keys} for _ in range(tracks)]
    text = json.dumps(SCENE | {"tracks": listed, "frames": min(each, 1000)})
    return scene(rng, f"{tracks} tracks of {each} keys", text)


def tracks(rng: Rng) -> Case:
    """Tracks of paths that lead nowhere, of frames out of order, and of values that do not fit."""
    path = texts.pick(
        rng, ["/camera", "", "/", "/lights/9/power", "/lights/-1", "/~2", "/body", "/tracks/0", "camera", "/frames"]
    )
    keys = texts.pick(
        rng, [[[0, 1], [0, 2]], [[4, 1], [1, 2]], [[-1, 1]], [[0, "a"], [3, 5]], [[1e300, 1]], [], [[0]], [[0.5, 1]]]
    )
    track = {"path": path if rng.integers(2) else "/camera/azimuth", "keys": keys}
    if rng.integers(3) == 0:
        track["between"] = texts.pick(rng, ["spline", 1, None, ""])
    return scene(rng, f"track {track}", json.dumps(SCENE | {"tracks": [track]}))


def bodies(rng: Rng) -> Case:
    """A body that is no file, or not one."""
    name = texts.pick(
        rng, ["", ".", "/", "scene.json", "/dev/zero", "fifo", "x" * 5000, "a\x1b[1m", "link", "/dev/null", "gone"]
    )

    def extra(place: Place) -> None:
        os.mkfifo(place.folder / "fifo")
        (place.folder / "link").symlink_to("link")

    text, shown = json.dumps(SCENE | {"body": name}), ascii(name)[1:21] if name else "scene.json"
    return scene(rng, f"body {name[:20]!r}", text, "refused", extra=extra, names=(shown.strip("'"),))


def deformers(rng: Rng) -> Case:
    """Deformers of any size and in any number."""
    sizes = [float(texts.extreme(rng)) if rng.integers(2) else float(rng.uniform(-10, 10)) for _ in range(9)]
    sizes = [0.0 if size != size or abs(size) > 1e300 else size for size in sizes]
    steps = [
        {"type": "twist", "axis": sizes[:3], "degrees": sizes[3]},
        {"type": "bend", "axis": [0, 1, 0], "towards": sizes[:3], "degrees": sizes[3]},
        {"type": "taper", "axis": [0, 1, 0], "factor": sizes[0]},
        {"type": "stretch", "axis": [0, 1, 0], "factor": sizes[0], "range": sizes[1:3]},
        {"type": "transform", "scale": sizes[:3]},
        {"type": "transform", "translate": sizes[:3], "centre": sizes[3:6]},
        {"type": "lattice", "size": [2, 2, 2], "displacements": [sizes[:3]] * 8},
        {"type": "cage", "vertices": [sizes[:3]] * 4, "triangles": [[0, 1, 2], [0, 2, 3]], "moved": [sizes[3:6]] * 4},
        {"type": "displaced", "shapes": texts.pick(rng, ["image.png", "gone.qshapes", "body.qgraph"]), "frame": 0},
    ]
    count = int(10 ** rng.uniform(0, 3)) if rng.integers(4) == 0 else 1
    chosen = [texts.pick(rng, steps) for _ in range(count)]
    text = json.dumps(SCENE | {"deformation": chosen, "tracks": []})
    return scene(rng, f"{count} deformers, {json.dumps(chosen[0])[:70]}", text)


def pictures(rng: Rng) -> Case:
    """Cameras and pictures of any size and kind."""
    camera = texts.pick(
        rng,
        [
            {"eye": [0, 0, 0], "look_at": [0, 0, 0]},
            {"eye": [texts.extreme(rng) % 1e300, 0, 30], "look_at": [0, 0, 0]},
            {"eye": [10, 0, 0], "look_at": [11, 0, 0]},
            {"distance": 10 ** float(rng.uniform(-30, 30)), "azimuth": 1e18, "elevation": 90},
            {"orthographic": 10 ** float(rng.uniform(-30, 30))},
            {"fov": float(rng.uniform(-1, 200))},
            {"target": [1e30, 0, 0]},
        ],
    )
    size = texts.pick(rng, [0, 1, -5, 31.5, 16385, 2**31, 2**32 + 32, 32])
    shown = texts.pick(
        rng, ["picture", "q", "phi:z", "tets:x,1e300", "levels:9", "links:y,0,-1", "difference:x", "error", ""]
    )
    exposure = texts.pick(rng, ["auto", 1e30, -1e30, 200, "x", 0])
    picture = {"width": size, "height": 8, "show": shown, "exposure": exposure}
    text = (
        json.dumps(SCENE | {"camera": camera, "picture": picture, "tracks": []})
        .replace("NaN", "0")
        .replace("Infinity", "1e300")
    )
    return scene(rng, f"{camera} {picture}".replace("\x1b", ""), text)


def settings(rng: Rng) -> Case:
    """`--set` of any path and value."""
    path = texts.pick(
        rng,
        ["/" + "/".join(map(str, path)) for path in texts.places(SCENE)] + ["", "/", "/a/b", "//", "/lights/99", "x"],
    )
    value = texts.pick(
        rng, [texts.number(rng), json.dumps(texts.junk(rng)), "{", "[1,", texts.nested(rng, 100), "\x1b[1m"]
    )
    value = value.replace("\0", "")[:100_000]
    return scene(rng, f"--set {path}={value[:40]!r}", json.dumps(SCENE), more=(f"--set={path}={value}",), names=(path,))


MESHES: dict[str, Any] = {
    "bodies": [
        {"name": "left", "mesh": "ball.obj", "unit": "mm", "material": "marble"},
        {"name": "right", "mesh": "ball.obj", "longest": "4mm", "up": "z", "position": [6, 1, 0]}
        | {"rotation": [10, 20, 30], "scale": 1.1, "material": {"name": "marble", "sigma_a": 1}},
    ],
    "materials": {},
    "solver": {"correction": False},
    "picture": {"width": 32, "height": 32},
}


def several(rng: Rng) -> Case:
    """A scene of meshes, a value of which is of another kind, or a number of any size."""
    path = texts.pick(rng, texts.places(MESHES))
    wild = isinstance(texts.at(MESHES, path), int | float) and rng.integers(2)
    value = texts.extreme(rng) if wild else texts.junk(rng)
    text = json.dumps(texts.replaced(MESHES, path, value)).replace("NaN", "0").replace("Infinity", "1e300")

    def ball(place: Place) -> None:
        mesh = trimesh.creation.icosphere(subdivisions=2, radius=2)
        (place.folder / "ball.obj").write_text(mesh.export(file_type="obj"))

    title = f"/{'/'.join(map(str, path))} is {value!r:.60}".replace("\x1b", "")
    return scene(rng, title, text, more=("--frame=0",), extra=ball, names=("ball.obj",))


def good(rng: Rng) -> Case:
    """The scene as it is, in any frame."""
    frame = f"--frame={rng.integers(4)}"
    return scene(rng, f"undamaged, {frame}", json.dumps(SCENE), "fine", (frame,), size=(32, 32))


RECIPES = (
    deep,
    wrong_kind,
    numbers,
    keys,
    bytes_of,
    many_keys,
    tracks,
    bodies,
    deformers,
    pictures,
    settings,
    several,
    good,
)
