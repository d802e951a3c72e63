"""Mesh files that lie, are damaged, or hold what is no body."""

from __future__ import annotations

import base64
import json
import os
import struct
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import trimesh

from attack import texts
from attack.bodies import ring
from attack.case import Case, Outcome, Place
from attack.texts import Rng
from quadgraph.file import qgraph_file

OPTIONS = ("--unit", "mm", "--levels", "1", "--visibility-rays", "0")
VOLUME = 2950.0  # mm3 of the ring, whose chords cut off a few percent
FORMS = ("ply", "ascii.ply", "stl", "ascii.stl", "obj", "off", "glb", "gltf")


def exported(mesh: trimesh.Trimesh, form: str) -> bytes:
    """A mesh as the bytes of a file."""
    if form == "gltf":
        return gltf(mesh)
    if form == "ascii.stl":
        return mesh.export(file_type="stl_ascii").encode()
    data = mesh.export(file_type="ply", encoding="ascii") if form == "ascii.ply" else mesh.export(file_type=form)
    return data.encode() if isinstance(data, str) else data


def document(mesh: trimesh.Trimesh) -> tuple[dict, bytes]:
    """A mesh as the JSON of a glTF file and its buffer."""
    data = mesh.vertices.astype("<f4").tobytes() + mesh.faces.astype("<u4").tobytes()
    split = 12 * len(mesh.vertices)
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": split}]
    views.append({"buffer": 0, "byteOffset": split, "byteLength": len(data) - split})
    low, high = mesh.vertices.min(axis=0).tolist(), mesh.vertices.max(axis=0).tolist()
    place = {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(mesh.vertices)}
    index = {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": 3 * len(mesh.faces)}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0.0, 0.0, 0.0], "children": []}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [place | {"min": low, "max": high, "byteOffset": 0}, index],
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }, data


def gltf(
    mesh: trimesh.Trimesh, change: Callable[[dict], dict] = lambda document: document, binary: bool = False
) -> bytes:
    """A glTF file, its buffer inside, whose JSON is changed."""
    whole, data = document(mesh)
    if not binary:
        whole["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
        return json.dumps(change(whole)).encode()
    text = json.dumps(change(whole)).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def whole(place: Place, outcome: Outcome) -> str:
    """Judge a bake: the file is read again, and has a volume."""
    metadata = qgraph_file.read(place.folder / "out.qgraph").metadata
    volumes = [level["volume_mm3"] for level in metadata["levels"]]
    return "" if all(np.isfinite(volumes)) and min(volumes, default=1) > 0 else f"volumes {volumes}"


def same_ring(place: Place, outcome: Outcome) -> str:
    """Judge a bake that ought to be of the undamaged ring."""
    levels = qgraph_file.read(place.folder / "out.qgraph").metadata["levels"]
    volume = levels[0]["volume_mm3"]
    return "" if abs(volume / VOLUME - 1) < 0.05 else f"a volume of {volume:.0f} mm3 instead of {VOLUME:.0f}"


def bake(rng: Rng, name: str, file: str, data: bytes | Callable[[], bytes], **more: object) -> Case:
    """A bake of a file of these bytes; half of them of the surface alone."""
    alone = bool(rng.integers(2)) and "judge" not in more
    options = ("--unit", "mm", "--surface-only") if alone else OPTIONS

    def prepare(place: Place) -> None:
        (place.folder / file).write_bytes(data() if callable(data) else data)

    command = ("quadgraph", "bake", file, "-o", "out.qgraph", *options)
    more = {"judge": whole, "names": (file,)} | more
    title = f"{name}{', surface alone' if alone else ''}"
    return Case(title, command, prepare=prepare, outputs=("out.qgraph",), **more)  # type: ignore[arg-type]


def ply_counts(rng: Rng) -> Case:
    """A PLY header that promises more or less than there is."""
    form, element = texts.pick(rng, ["ply", "ascii.ply"]), texts.pick(rng, ["vertex", "face"])
    count = texts.pick(rng, [str(int(10 ** rng.uniform(0, 12))), "-1", "1e9", "0", texts.number(rng)[:60]])
    data = exported(ring(), form)
    for number in (288, 576):
        data = data.replace(f"element {element} {number}\n".encode(), f"element {element} {count}\n".encode())
    return bake(rng, f"{form} of {count[:40]!r} {element}", "mesh.ply", data)


def ply_lists(rng: Rng) -> Case:
    """Lists of a binary PLY whose lengths are huge, negative, or no whole numbers."""
    length, index = texts.pick(rng, ["uint", "int", "float", "double", "uchar", "char"]), "int"
    code = {"uint": "I", "int": "i", "float": "f", "double": "d", "uchar": "B", "char": "b"}[length]
    value = {
        "I": int(rng.integers(4, 2**32)),
        "i": int(rng.integers(-(2**31), 2**31)),
        "f": float(10 ** rng.uniform(-3, 38)),
        "d": texts.extreme(rng),
        "B": int(rng.integers(256)),
        "b": int(rng.integers(-128, 128)),
    }[code]
    mesh, spot = ring(), int(rng.integers(576))
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 288\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face 576\nproperty list {length} {index} vertex_indices\nend_header\n"
    rows = [struct.pack(f"<{code}3i", value if row == spot else 3, *face) for row, face in enumerate(mesh.faces)]
    data = head.encode() + mesh.vertices.astype("<f4").tobytes() + b"".join(rows)
    return bake(rng, f"ply, list of {length} {value:.6g} at {spot}", "mesh.ply", data)


def flipped(rng: Rng) -> Case:
    """Some bytes of a mesh file replaced by others."""
    form = texts.pick(rng, FORMS)
    data = texts.random_bytes(rng, exported(ring(), form), texts.pick(rng, [1, 5, 30]))
    if rng.integers(3) == 0:
        data = texts.random_bytes(rng, data[:300], 6) + data[300:]
    return bake(rng, f"{form}, bytes replaced", f"mesh.{form.split('.')[-1]}", data)


def cut(rng: Rng) -> Case:
    """A mesh file that ends early, or goes on."""
    form, share = texts.pick(rng, FORMS), rng.random()
    data = exported(ring(), form)
    data = data[: int(share * len(data))] if rng.integers(4) else data + bytes(rng.integers(0, 256, 100, np.uint8))
    return bake(rng, f"{form}, {len(data)} bytes", f"mesh.{form.split('.')[-1]}", data)


def one_coordinate(rng: Rng) -> Case:
    """One coordinate, of any size or none."""
    form, value = texts.pick(rng, ["ascii.ply", "obj", "off", "ply", "glb", "stl"]), texts.extreme(rng)
    mesh = ring().copy()
    row, axis = int(rng.integers(288)), int(rng.integers(3))
    text = texts.pick(rng, [f"{value!r}", texts.number(rng)[:500]])
    if form in ("ascii.ply", "obj", "off"):
        mesh.vertices[row, axis] = 12345.5
        data = exported(mesh, form).replace(b"12345.50000000", text.encode()).replace(b"12345.5", text.encode())
        return bake(rng, f"{form}, a coordinate {text[:40]!r}", f"mesh.{form.split('.')[-1]}", data)
    with np.errstate(over="ignore"):
        mesh.vertices[row, axis] = value
        data = exported(mesh, form)
    return bake(rng, f"{form}, a coordinate {value:.3g}", f"mesh.{form}", data)


def sizes(rng: Rng) -> Case:
    """A whole body of any size, in any unit."""
    power, form = (
        float(rng.uniform(-40, 40)) if rng.integers(2) else float(rng.uniform(-6, 7)),
        texts.pick(rng, FORMS[:6]),
    )
    mesh = ring().copy()
    mesh.vertices = mesh.vertices * 10.0**power
    with np.errstate(over="ignore"):
        data = exported(mesh, form)
    unit = texts.pick(
        rng, [("--unit", "m"), ("--unit", "cm"), ("--height", "30mm"), ("--height", f"{texts.number(rng)[:40]}mm")]
    )
    case = bake(rng, f"{form} by 1e{power:.1f}, {unit}", f"mesh.{form.split('.')[-1]}", data, names=("mesh", "height"))
    command = tuple(case.command)
    start = command.index("--unit")
    return replace(case, command=(*command[:start], f"{unit[0]}={unit[1]}", *command[start + 2 :]))


def indices(rng: Rng) -> Case:
    """A face of vertices that are not there."""
    form, value = texts.pick(rng, ["ascii.ply", "obj", "off", "ply"]), int(rng.choice([-1, 288, 289, 10**6, 2**31 - 1]))
    text = exported(ring(), "obj" if form == "obj" else form)
    face = int(rng.integers(400))
    if form == "ply":
        mesh = ring()
        start = text.index(b"end_header\n") + 11 + 12 * len(mesh.vertices) + 13 * face + 1
        return bake(rng, f"ply, index {value}", "mesh.ply", text[:start] + struct.pack("<i", value) + text[start + 4 :])
    lines = text.decode().splitlines()
    row = len(lines) - 1 - face
    words = lines[row].split()
    words[-1] = str(value) if form != "obj" else texts.pick(rng, [str(value), "0", "-1", f"{value}/1/x"])
    lines[row] = " ".join(words)
    return bake(rng, f"{form}, index {words[-1]}", f"mesh.{form.split('.')[-1]}", "\n".join(lines).encode())


def stl_counts(rng: Rng) -> Case:
    """An STL that promises more triangles, or a text that breaks off."""
    if rng.integers(2):
        data, count = bytearray(exported(ring(), "stl")), int(rng.integers(0, 2**32))
        data[80:84] = struct.pack("<I", count)
        return bake(rng, f"stl of {count} triangles", "mesh.stl", bytes(data))
    text = exported(ring(), "ascii.stl")
    word = texts.pick(rng, [b"vertex", b"endfacet", b"facet normal", b"outer loop", b"endsolid"])
    spot = text.index(word, int(rng.random() * 0.9 * len(text)))
    return bake(rng, f"stl as text, without {word.decode()}", "mesh.stl", text[:spot] + text[spot + len(word) :])


def gltf_values(rng: Rng) -> Case:
    """A value of a glTF file replaced by one of another kind or size."""
    plain, _ = document(ring())
    path, value = texts.pick(rng, texts.places(plain)), texts.junk(rng)
    form = texts.pick(rng, ["gltf", "glb"])
    data = gltf(ring(), lambda whole: texts.replaced(whole, path, value), form == "glb")
    return bake(rng, f"{form}, {'/'.join(map(str, path))} is {value!r:.50}", f"mesh.{form}", data)


def gltf_additions(rng: Rng) -> Case:
    """Members of a glTF file that say something else than what would be read: refused."""
    size = float(10 ** rng.uniform(13, 307))
    sparse = {"count": 1, "indices": {"bufferView": 1, "componentType": 5125}, "values": {"bufferView": 0}}
    additions = {
        "sparse": (("accessors", 0, "sparse"), sparse),
        "matrix": (("nodes", 0, "matrix"), [size, *[0] * 4, 1, *[0] * 4, 1, *[0] * 4, 1]),
        "scale": (("nodes", 0, "scale"), [size, 1, 1]),
        "cycle": (("nodes", 0, "children"), [0]),
        "uri": (
            ("buffers", 0, "uri"),
            texts.pick(rng, ["../../../etc/passwd", "http://localhost/x", "/dev/zero", "x" * 300]),
        ),
        "count": (("accessors", 0, "count"), int(10 ** rng.uniform(3, 18))),
        "draco": (("meshes", 0, "primitives", 0, "extensions"), {"KHR_draco_mesh_compression": {"bufferView": 0}}),
        "offset": (("bufferViews", 1, "byteOffset"), int(10 ** rng.uniform(4, 18))),
    }
    key = texts.pick(rng, list(additions))
    path, value = additions[key]
    form = "gltf" if key == "uri" else texts.pick(rng, ["gltf", "glb"])
    data = gltf(ring(), lambda whole: texts.replaced(whole, path, value), form == "glb")
    expect = "" if key in ("draco", "scale", "cycle") else "refused"
    return bake(rng, f"{form}, {key} {value!r:.40}", f"mesh.{form}", data, expect=expect)


def glb_chunks(rng: Rng) -> Case:
    """A GLB whose chunks are of other lengths and kinds, or whose JSON is deep."""
    if rng.integers(3) == 0:
        depth = texts.depth(rng)
        text = json.dumps(document(ring())[0])[:-1] + f', "extras": {texts.nested(rng, depth)}}}'
        return bake(rng, f"gltf {depth} deep", "mesh.gltf", text.encode(), expect="refused")
    data = bytearray(gltf(ring(), binary=True))
    spot, value = texts.pick(rng, [4, 8, 12, 16]), int(rng.integers(0, 2**32))
    data[spot : spot + 4] = struct.pack("<I", value)
    return bake(rng, f"glb, {value} at byte {spot}", "mesh.glb", bytes(data))


def no_bodies(rng: Rng) -> Case:
    """Surfaces that enclose nothing, or cross themselves."""
    mesh, kind = (
        ring().copy(),
        texts.pick(rng, ["hole", "flip", "twice", "empty", "one", "sheet", "crossing", "flat", "inside out"]),
    )
    faces = mesh.faces
    if kind == "hole":
        faces = faces[: -int(rng.integers(1, 400))]
    elif kind == "flip":
        faces = np.where(rng.random((len(faces), 1)) < rng.random(), faces[:, ::-1], faces)
    elif kind == "twice":
        faces = np.concatenate([faces, faces])
    elif kind in ("empty", "one"):
        faces = faces[: int(kind == "one")]
    elif kind == "inside out":
        faces = faces[:, ::-1]
    mesh = trimesh.Trimesh(mesh.vertices, faces, process=False)
    if kind == "sheet":
        mesh = trimesh.Trimesh([[0, 0, 0], [9, 0, 0], [0, 9, 0], [9, 9, 0]], [[0, 1, 2], [1, 3, 2]], process=False)
    elif kind == "flat":
        mesh.vertices = mesh.vertices * [1, 1, 10 ** rng.uniform(-12, -1)]
    elif kind == "crossing":
        other = mesh.copy()
        other.apply_translation(rng.uniform(-9, 9, 3))
        mesh = trimesh.util.concatenate([mesh, other])
    form = "obj" if kind == "empty" else texts.pick(rng, FORMS[:6])
    return bake(rng, f"{form}, {kind}", f"mesh.{form.split('.')[-1]}", exported(mesh, form))


def names(rng: Rng) -> Case:
    """A mesh of any name, in another form than its name says, or no file at all."""
    kind = texts.pick(rng, ["other", "long", "none", "control", "folder", "fifo", "zero", "gone", "empty", "foreign"])
    suffix, form = texts.pick(rng, ["ply", "stl", "obj", "off", "glb", "gltf"]), texts.pick(rng, FORMS)
    file = {"long": "x" * 240, "none": "mesh", "control": "me\x1b[31msh\n", "foreign": "m\u00e9sh \u202e%s"}.get(
        kind, "mesh"
    )
    file += "" if kind == "none" else f".{suffix}"
    data = b"" if kind == "empty" else exported(ring(), form)

    def prepare(place: Place) -> None:
        path = place.folder / file
        if kind == "folder":
            path.mkdir()
        elif kind == "fifo":
            os.mkfifo(path)
        elif kind == "zero":
            path.symlink_to("/dev/zero")
        elif kind != "gone":
            path.write_bytes(data)

    command = ("quadgraph", "bake", file, "-o", "out.qgraph", "--unit", "mm", "--surface-only")
    shown = (file[:20],) if kind != "control" else ("me",)
    return Case(f"{form} as {kind}.{suffix}", command, shown, prepare, ("out.qgraph",), judge=whole)


def good(rng: Rng) -> Case:
    """The ring in every form: baked, with its volume."""
    form = texts.pick(rng, FORMS)
    file = f"mesh.{form.split('.')[-1]}"
    return bake(rng, f"{form}, undamaged", file, exported(ring(), form), judge=same_ring, expect="fine")


def frames(rng: Rng) -> Case:
    """Frames of an animation that are not those of the body."""
    mesh, kind = ring(), texts.pick(rng, ["fewer", "nan", "huge", "shuffled", "cut"])
    moved = mesh.vertices * (1 + 0.1 * rng.random())
    if kind == "nan":
        moved[int(rng.integers(288)), 0] = np.nan
    elif kind == "huge":
        moved[int(rng.integers(288))] *= 10 ** rng.uniform(3, 200)
    faces = (
        mesh.faces[:-1] if kind == "fewer" else mesh.faces[rng.permutation(576)] if kind == "shuffled" else mesh.faces
    )
    data = exported(trimesh.Trimesh(moved, faces, process=False), "obj")

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)
        (place.folder / "rest.obj").write_bytes(exported(mesh, "obj"))
        (place.folder / "next.obj").write_bytes(data[: len(data) // 2] if kind == "cut" else data)

    command = ("quadgraph", "shapes", "body.qgraph", "rest.obj", "next.obj", "-o", "out.qshapes")
    expect = "" if kind == "huge" else "refused"
    return Case(f"frame {kind}", command, ("next.obj", "rest.obj"), prepare, ("out.qshapes",), expect=expect)


RECIPES = (
    ply_counts,
    ply_lists,
    flipped,
    cut,
    one_coordinate,
    sizes,
    indices,
    stl_counts,
    gltf_values,
    gltf_additions,
    glb_chunks,
    no_bodies,
    names,
    good,
    frames,
)
