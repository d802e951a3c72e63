"""Files with colours that are broken, or meant to do harm: an error that names file and field, and little memory."""

from __future__ import annotations

import json
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest

from coloured_files import coloured_glb, encoded, ramp_glb, ramp_obj, ramp_pixels, ramp_ply, textured
from quadgraph.base.errors import InputError
from quadgraph.mesh.looks import texture
from quadgraph.mesh.looks.read_looks import read_looks
from shapes import icosphere

BALL = icosphere(1, 10)


def refused(path: Path, *words: str) -> str:
    with pytest.raises(InputError) as error:
        read_looks(path)
    text = str(error.value)
    assert path.name in text
    assert [word for word in words if word not in text] == [], text
    return text


def gltf(tmp_path: Path, change) -> Path:
    """A textured .gltf whose document `change` spoils."""
    path = ramp_glb(tmp_path / "a.gltf", BALL)
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    return path


def huge_png(width: int, height: int) -> bytes:
    """A PNG that says its size, and has next to nothing behind it."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(100))) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("gone.png", "cannot be read beside the mesh"),
        ("../outside.png", "allowed is a picture in the mesh's folder"),
        ("%2e%2e/outside.png", "allowed is a picture in the mesh's folder"),
        ("/etc/passwd", "allowed is a picture in the mesh's folder"),
        ("https://example.org/a.png", "allowed is a picture in the mesh's folder"),
        ("C:\\a.png", "allowed is a picture in the mesh's folder"),
        ("a.gltf", "another kind of file"),
        ("data:image/png;base64,AAAA", "another kind of file"),
        (".", "cannot be read beside the mesh"),
    ],
)
def test_a_picture_that_is_none_of_the_files(tmp_path, uri, words):
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "outside.png").write_bytes(encoded(ramp_pixels()))
    refused(gltf(folder, lambda document: document.update(images=[{"uri": uri}])), "image 0", words)


def test_a_link_that_leads_out_of_the_folder(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "outside.png").write_bytes(encoded(ramp_pixels()))
    (folder / "a.png").symlink_to(tmp_path / "outside.png")
    refused(gltf(folder, lambda document: document.update(images=[{"uri": "a.png"}])), "allowed is a picture in")


@pytest.mark.parametrize(
    ("side", "words"), [(9000, "9000 x 9000 pixels"), (60000, "more than 50000000 pixels")], ids=["ours", "Pillow's"]
)
def test_a_picture_too_large_is_not_decoded(tmp_path, side, words):
    path = coloured_glb(tmp_path / "a.glb", BALL, textured(), huge_png(side, side))
    tracemalloc.start()
    refused(path, "image 0", words, "write it smaller")
    assert tracemalloc.get_traced_memory()[1] < 10e6
    tracemalloc.stop()


def test_pictures_that_are_too_many_together(tmp_path, monkeypatch):
    """Each is small enough; one that is named twice counts once."""
    monkeypatch.setattr(texture, "MOST_TOGETHER", 3000)
    names = [f"{k}.png" for k in range(4)]
    for name in names:
        (tmp_path / name).write_bytes(encoded(ramp_pixels()))
    (tmp_path / "ramp.mtl").write_text("".join(f"newmtl {k}\nmap_Kd {name}\n" for k, name in enumerate(names)))
    (tmp_path / "a.obj").write_text("mtllib ramp.mtl\n")
    refused(tmp_path / "a.obj", "ramp.mtl, line 6", "256 x 4 pixels", "3000 in all pictures of a mesh")
    same = "".join(f"newmtl {k}\nmap_Kd 0.png\n" for k in range(9))
    (tmp_path / "ramp.mtl").write_text(same)
    refused(tmp_path / "a.obj", "no triangles found")


def test_a_picture_cut_short(tmp_path):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), np.uint8)
    refused(coloured_glb(tmp_path / "a.glb", BALL, textured(), encoded(noise)[:4000]), "image 0", "cannot be read")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e30])
def test_coordinates_that_are_no_places(tmp_path, bad):
    uv = np.full((len(BALL.vertices), 2), 0.5)
    uv[7, 1] = bad
    path = coloured_glb(tmp_path / "a.glb", BALL, textured(), encoded(ramp_pixels()), uv)
    refused(path, "material 'skin', texture coordinate 7", "unwrap it again")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(index=4), "textures: index 4"),
        (lambda d: d["textures"][0].update(source=9), "images: index 9 found, there are 1"),
        (lambda d: d["textures"][0].update(source=-1), "images: index -1"),
        (lambda d: d["textures"][0].update(sampler=1), "samplers: index 1 found, there are 1"),
        (lambda d: d.update(textures=[{"extensions": {"KHR_texture_basisu": {"source": 0}}}]), "KHR_texture_basisu"),
        (lambda d: d["meshes"][0]["primitives"][0].update(material=3), "materials: index 3 found, there are 1"),
        (lambda d: d["meshes"][0]["primitives"][0]["attributes"].pop("TEXCOORD_0"), "TEXCOORD_0 found, which a"),
        (lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(TEXCOORD_0=1), "allowed are 2"),
        (lambda d: d["meshes"][0]["primitives"][0].update(mode=5), "only primitives of triangles"),
        (lambda d: d["bufferViews"][d["images"][0]["bufferView"]].update(byteLength=1 << 40), "beyond its buffer"),
        (lambda d: d["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[1, 1, 9, 1]), "baseColorFactor"),
        (lambda d: d["materials"].__setitem__(0, 7), "cannot be read as glTF"),
    ],
)
def test_numbers_that_lead_nowhere(tmp_path, change, words):
    refused(gltf(tmp_path, change), words)


def test_a_sampler_that_there_is_not(tmp_path):
    def spoil(document):
        document["samplers"] = [{"wrapS": 7}]

    refused(gltf(tmp_path, spoil), "sampler, wrapS: 7 found, allowed are 33071, 33648, 10497")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mtllib gone.mtl\nv 0 0 0\n", ("line 1", "gone.mtl", "cannot be read")),
        ("mtllib ../up.mtl\n", ("line 1", "allowed is a picture in")),
        ("mtllib ramp.mtl\nusemtl other\n", ("line 2", "'other' found", "skin")),
        ("mtllib ramp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\n", ("without coordinates (vt)",)),
        ("mtllib ramp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/9\n", ("9 found, there are 1",)),
        ("mtllib ramp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ("4 found, there are 3",)),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", ("line 4", "cannot read 'f 1 2 -4'")),
        ("v 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ("1 of 3 vertices have colours",)),
        ("v 0 0 0 1 1 nan\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n", ("colour 0",)),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ("no colours found",)),
        ("", ("no triangles found",)),
    ],
)
def test_obj_files_that_are_wrong(tmp_path, text, words):
    ramp_obj(tmp_path / "a.obj", BALL)
    (tmp_path / "a.obj").write_text(text)
    refused(tmp_path / "a.obj", *words)


@pytest.mark.parametrize(
    ("line", "words"),
    [("map_Kd", "without a picture"), ("Kd 1 x 1", "cannot read"), ("Kd 1 1 9", "Kd"), ("map_Kd /a.png", "folder")],
)
def test_libraries_that_are_wrong(tmp_path, line, words):
    refused(ramp_obj(tmp_path / "a.obj", BALL, line), "ramp.mtl, line 3", words)


def test_ply_with_two_of_three_channels(tmp_path):
    path = ramp_ply(tmp_path / "a.ply", BALL)
    path.write_text(path.read_text().replace("property uchar blue", "property uchar alpha"))
    refused(path, "element vertex", "'blue' is wanted")


def test_kinds_of_files_without_colours(tmp_path):
    (tmp_path / "a.stl").write_bytes(b"solid")
    refused(tmp_path / "a.stl", "'.stl' found, of colours .glb, .gltf, .obj, .ply are read")
    refused(tmp_path / "gone.glb", "gone.glb")
