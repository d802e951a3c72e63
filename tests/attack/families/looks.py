"""Colours of mesh files that lie, are damaged, or lead elsewhere, as `quadgraph colours` reads them."""

from __future__ import annotations

import base64
import io
import struct
from collections.abc import Mapping

import numpy as np
from PIL import Image

from attack import texts
from attack.bodies import ring
from attack.case import Case, Outcome, Place
from attack.families.meshes import document, exported, gltf
from attack.texts import Rng
from quadgraph.api.materials import VolumeMaterial

_SIDE = 40  # pixels
_MEMBERS = ("materials", "textures", "images", "samplers", "accessors", "bufferViews", "meshes")
_EXTENSIONS = {
    "KHR_materials_volume": {"thicknessFactor": 1.0, "attenuationDistance": 2.0, "attenuationColor": [0.5, 0.4, 0.3]},
    "KHR_materials_transmission": {"transmissionFactor": 1.0},
    "KHR_materials_volume_scatter": {"multiscatterColor": [0.5, 0.6, 0.7], "scatterAnisotropy": 0.2},
    "KHR_materials_ior": {"ior": 1.4},
}


def picture(rng: Rng) -> bytes:
    """A PNG of noise."""
    stream = io.BytesIO()
    Image.fromarray(rng.integers(0, 256, (_SIDE, _SIDE, 3), np.uint8)).save(stream, "PNG")
    return stream.getvalue()


def painted(whole: dict, uri: str) -> dict:
    """The ring's document with a texture whose coordinates are x and y, and with a medium."""
    transform = {"KHR_texture_transform": {"offset": [0.1, 0.0], "scale": [0.1, 0.1], "rotation": 0.3}}
    texture = {"index": 0, "texCoord": 0, "extensions": transform}
    plain = {"baseColorTexture": texture, "baseColorFactor": [0.9, 0.8, 0.7, 1.0], "roughnessFactor": 0.5}
    whole["materials"] = [{"name": "skin", "pbrMetallicRoughness": plain, "extensions": dict(_EXTENSIONS)}]
    whole["textures"], whole["images"] = [{"source": 0, "sampler": 0}], [{"uri": uri}]
    whole["samplers"] = [{"wrapS": 33648, "wrapT": 10497}]
    whole["bufferViews"].append(whole["bufferViews"][0] | {"byteStride": 12})
    whole["accessors"].append({"bufferView": 2, "componentType": 5126, "type": "VEC2", "count": 288})
    primitive = whole["meshes"][0]["primitives"][0]
    primitive["attributes"]["TEXCOORD_0"], primitive["material"] = 2, 0
    return whole


def case(name: str, file: str, files: Mapping[str, bytes], expect: str = "") -> Case:
    """A run of the command on one of the files, with the ring's body beside it."""

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)
        for other, data in files.items():
            (place.folder / other).write_bytes(data)

    command = ("quadgraph", "colours", file, "--body", "body.qgraph", "--cells", "4000", "-o", "out.npz")
    return Case(name, command, (file, *files), prepare, ("out.npz",), judge=volume, expect=expect)


def volume(place: Place, outcome: Outcome) -> str:
    """Judge what was written: it is read again, which checks its numbers."""
    found = VolumeMaterial.load(place.folder / "out.npz")
    return "" if (np.asarray(found.sigma_a) + found.sigma_s_prime).max() > 0 else "nothing scatters or absorbs"


def data_uri(data: bytes) -> str:
    """A picture as glTF has it within itself."""
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"


def values(rng: Rng) -> Case:
    """A value of a painted glTF file replaced by one of another kind or size."""
    uri = data_uri(picture(rng))
    plain = painted(document(ring())[0], uri)
    path = texts.pick(rng, [path for path in texts.places(plain) if path[0] in _MEMBERS])
    value, form = texts.junk(rng), texts.pick(rng, ["gltf", "glb"])
    data = gltf(ring(), lambda whole: texts.replaced(painted(whole, uri), path, value), form == "glb")
    return case(f"{form}, {'/'.join(map(str, path))} is {value!r:.50}", f"mesh.{form}", {f"mesh.{form}": data})


def pictures(rng: Rng) -> Case:
    """A picture that is cut, damaged, of another size than it says, or none."""
    kind, data = texts.pick(rng, ["cut", "flipped", "large", "none", "good"]), picture(rng)
    if kind == "cut":
        data = data[: int(rng.integers(len(data)))]
    elif kind == "flipped":
        data = texts.random_bytes(rng, data, 30)
    elif kind == "large":
        data = data[:16] + struct.pack(">II", *rng.integers(1, 2**31, 2).tolist()) + data[24:]
    elif kind == "none":
        data = texts.word(rng, 3).encode()
    whole = gltf(ring(), lambda document: painted(document, "skin.png"))
    expect = {"good": "fine", "large": "refused", "none": "refused"}.get(kind, "")
    return case(f"picture {kind}, {len(data)} bytes", "mesh.gltf", {"mesh.gltf": whole, "skin.png": data}, expect)


def elsewhere(rng: Rng) -> Case:
    """A name that leads out of the folder, or to what is no picture: refused."""
    outside = ["../../etc/passwd", "/dev/zero", "file:///etc/passwd", "http://localhost/a.png"]
    uri = texts.pick(rng, [*outside, "mesh.gltf", "", "x" * 300])
    whole = gltf(ring(), lambda document: painted(document, uri))
    return case(f"picture {uri[:40]!r}", "mesh.gltf", {"mesh.gltf": whole}, "refused")


def lines(rng: Rng) -> Case:
    """An OBJ file and its library with words replaced."""
    library = ["newmtl skin", "Kd 0.5 0.6 0.7", "Ni 1.4", "map_Kd -s 1 1 1 -o 0 0 0 -clamp on skin.png", ""]
    rows = ["mtllib skin.mtl", *(f"vt {k % 7 / 7} {k % 5 / 5}" for k in range(288)), "usemtl skin"]
    for line in exported(ring(), "obj").decode().splitlines():
        kind, *words = line.split() or [""]
        corners = [word.split("/")[0] for word in words]
        rows.append(line if kind != "f" else "f " + " ".join(f"{corner}/{corner}" for corner in corners))
    target = library if rng.integers(2) else rows
    for _ in range(int(rng.integers(1, 4))):
        row = int(rng.integers(len(target) - 1)) if target is library else texts.pick(rng, [0, 5, 289, 400, -1])
        words = target[row].split(" ")
        other = texts.pick(rng, [texts.number(rng)[:300], "-1", "0", "usemtl", "-o", ".."])
        words[int(rng.integers(len(words)))] = other
        target[row] = " ".join(words)
    files = {"mesh.obj": "\n".join(rows).encode(), "skin.mtl": "\n".join(library).encode(), "skin.png": picture(rng)}
    return case(f"{'library' if target is library else 'obj'}, words replaced", "mesh.obj", files)


RECIPES = (values, pictures, elsewhere, lines)
